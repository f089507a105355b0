"""Whole files or none, and what killed processes leave."""

import errno
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from spheremesh.fabrication.files import check_target, replacing
from spheremesh.kernel.errors import InputError

DAY = 86400


def test_what_killed_processes_left_goes_after_a_day(
    tmp_path: Path, leave: Callable[[Path, float], Path]
) -> None:
    target = tmp_path / "panels [1].step"
    old = leave(tmp_path / ".panels [1]-spheremesh-abc_12ef.step", 2 * DAY)
    kept = [
        leave(tmp_path / ".panels [1]-spheremesh-abcdefgh.step", 0.5 * DAY),
        leave(tmp_path / ".panels [1]-spheremesh-abcdefgh.stp", 2 * DAY),
        leave(tmp_path / ".panels [1]-original.step", 2 * DAY),
        leave(tmp_path / ".roof-spheremesh-abcdefgh.step", 2 * DAY),
        leave(tmp_path / ".spheremesh-abcdefgh", 2 * DAY),
    ]
    with replacing(target) as temporary:
        assert temporary.suffix == ".step"
        temporary.write_text("new")
    assert target.read_text() == "new"
    assert not old.exists()
    assert set(tmp_path.iterdir()) == {target, *kept}


def test_a_target_that_cannot_be(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="it is a folder"):
        check_target(tmp_path)
    with pytest.raises(InputError, match="no folder"):
        check_target(tmp_path / "none" / "p.step")
    check_target(tmp_path / "p.step")


def test_windows_syncs_only_what_is_open_for_writing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fcntl = pytest.importorskip("fcntl", reason="this may be Windows itself")
    fsync = os.fsync
    synced: list[int] = []

    def fsync_there(descriptor: int) -> None:
        if fcntl.fcntl(descriptor, fcntl.F_GETFL) & os.O_ACCMODE == os.O_RDONLY:
            raise OSError(errno.EBADF, os.strerror(errno.EBADF))
        fsync(descriptor)
        synced.append(os.fstat(descriptor).st_ino)

    monkeypatch.setattr(os, "fsync", fsync_there)
    target = tmp_path / "p.step"
    for text in ("old", "new"):
        with replacing(target) as temporary:
            temporary.write_text(text)
        assert target.read_text() == text
        assert synced.pop() == target.stat().st_ino


def test_names_that_no_file_can_have(tmp_path: Path) -> None:
    for name in ("a\0.step", "x" * 300 + ".step"):
        with (
            pytest.raises(InputError, match=r"cannot write .*check the name"),
            replacing(tmp_path / name),
        ):
            pass
    longest = tmp_path / ("ä" * 125 + ".step")
    with replacing(longest) as temporary:
        temporary.write_text("new")
    assert longest.read_text() == "new"
    assert list(tmp_path.iterdir()) == [longest]


def test_a_read_only_file_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "p.step"
    target.write_text("released")
    target.chmod(0o444)

    def access(path: Path, _: int) -> bool:
        """Nothing is read-only for an administrator, who may run this."""
        return bool(path.stat().st_mode & 0o200)

    monkeypatch.setattr(os, "access", access)
    with pytest.raises(InputError, match="it is read-only"), replacing(target):
        pass
    assert target.read_text() == "released"


@pytest.mark.parametrize("place", ["write_bytes", "replace"])
def test_a_full_disk_and_a_file_that_is_held_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: str
) -> None:
    target = tmp_path / "p.step"
    target.write_text("old")

    def fail(*_: object) -> None:
        raise PermissionError(13, "The process cannot access the file")

    monkeypatch.setattr(Path, place, fail)
    with (
        pytest.raises(InputError, match=r"cannot write .*p\.step: The process cannot access"),
        replacing(target) as temporary,
    ):
        temporary.write_bytes(b"new")
    assert [path.read_text() for path in tmp_path.iterdir()] == ["old"]


def test_a_temporary_file_that_is_held_is_no_other_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Windows neither renames nor removes what a scanner has open."""

    def fail(*_: object, **__: object) -> None:
        raise PermissionError(13, "The process cannot access the file")

    monkeypatch.setattr(Path, "replace", fail)
    monkeypatch.setattr(Path, "unlink", fail)
    with (
        pytest.raises(InputError, match=r"cannot write .*p\.step: The process cannot access"),
        replacing(tmp_path / "p.step") as temporary,
    ):
        temporary.write_bytes(b"new")
