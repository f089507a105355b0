"""Only regular files are read, and what is no mesh file is named by its content."""

import gzip
import os
import socket
from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import pytest

from spheremesh import Mesh
from spheremesh.fabrication.mesh_files.reader import SUFFIXES, read_mesh
from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.kernel.errors import InputError

ErrorOf: TypeAlias = Callable[..., str]

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes in the file system")
def test_a_pipe_is_refused_and_not_waited_for(error_of: ErrorOf, tmp_path: Path) -> None:
    for suffix in SUFFIXES:
        os.mkfifo(tmp_path / f"a{suffix}")
        assert "a pipe" in error_of(f"a{suffix}")


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no devices in the file system")
def test_a_device_is_refused_and_a_link_followed(error_of: ErrorOf, tmp_path: Path) -> None:
    (tmp_path / "zero.obj").symlink_to("/dev/zero")
    assert "a device" in error_of("zero.obj")
    (tmp_path / "real.obj").write_text(TRIANGLE)
    (tmp_path / "link.obj").symlink_to(tmp_path / "real.obj")
    assert read_mesh(tmp_path / "link.obj").n_faces == 1


@pytest.mark.skipif(not hasattr(socket, "AF_UNIX"), reason="no sockets in the file system")
def test_a_socket_is_refused(
    error_of: ErrorOf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # names of sockets are short
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind("a.obj")
        assert "a socket" in error_of("a.obj")


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be", "utf-32"])
@pytest.mark.parametrize("suffix", [".obj", ".off", ".stl", ".ply"])
def test_wide_text_is_named_with_the_cure(
    error_of: ErrorOf, encoding: str, suffix: str
) -> None:
    message = error_of(f"a{suffix}", ("# roof\n" + TRIANGLE).encode(encoding))
    assert "UTF-16" in message
    assert "UTF-8" in message


@pytest.mark.parametrize(
    ("content", "part"),
    [
        (gzip.compress(TRIANGLE.encode(), mtime=0), "compressed"),
        (b"PK\x03\x04" + bytes(30), "compressed"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:1\n", "Git LFS"),
        (b"<!DOCTYPE html>\n<html></html>", "web page"),
        (b"3D Geometry File Format        8", "rename it to .3dm"),
        (b"ply\nformat ascii 1.0\n", "rename it to .ply"),
        (b"OFF\n3 1 0\n", "rename it to .off"),
        (b"solid x\nfacet normal 0 0 1\n", "rename it to .stl"),
        (b"glTF\x02\0\0\0", "rename it to .glb"),
    ],
)
def test_content_of_another_kind_is_named(error_of: ErrorOf, content: bytes, part: str) -> None:
    assert part in error_of("a.obj", content)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_is_written_is_of_its_own_kind(tmp_path: Path, suffix: str) -> None:
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    path = write_mesh(mesh, tmp_path / f"a{suffix}")
    assert read_mesh(path).n_faces == 1
    others = [each for each in SUFFIXES if each != suffix]
    for other in others:
        wrong = tmp_path / f"wrong{other}"
        wrong.write_bytes(path.read_bytes())
        with pytest.raises(InputError):
            read_mesh(wrong)
