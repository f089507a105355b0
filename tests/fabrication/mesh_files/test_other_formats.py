"""Formats read through meshio and trimesh: polygons kept, faults in one line."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.fabrication.mesh_files import other_formats
from spheremesh.fabrication.mesh_files.library_process import read_with_library
from spheremesh.fabrication.mesh_files.other_formats import OTHER_SUFFIXES
from spheremesh.fabrication.mesh_files.reader import read_content, read_mesh
from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.fabrication.polygons import Polygons
from spheremesh.kernel.errors import InputError, MissingLibraryError

ErrorOf: TypeAlias = Callable[..., str]

meshio: Any = pytest.importorskip("meshio")
trimesh: Any = pytest.importorskip("trimesh")

POINTS = np.array(
    [[0, 0, 0], [1, 0, 0.1], [2, 0, 0], [0, 1, 1 / 3], [1, 1, 0.5], [2, 1, 0], [1, 2, 0.1]]
)
QUADS = [[0, 1, 4, 3], [1, 2, 5, 4]]
TRIANGLES = [[3, 4, 6], [4, 5, 6]]


def faces_of(polygons: Polygons) -> list[list[int]]:
    ends = np.cumsum(polygons.degrees)[:-1]
    return [face.tolist() for face in np.split(polygons.corners, ends)]


@pytest.mark.parametrize("suffix", [".vtk", ".vtu", ".msh", ".mesh", ".inp", ".bdf", ".avs"])
def test_triangles_and_quads_come_back(tmp_path: Path, suffix: str) -> None:
    cells = [("quad", QUADS), ("triangle", TRIANGLES)]
    path = tmp_path / f"a{suffix}"
    meshio.Mesh(POINTS, cells).write(path)
    polygons, _ = read_with_library(path, suffix)
    digits = 1e-5 if suffix == ".bdf" else 1e-15
    assert np.allclose(polygons.vertices, POINTS, rtol=0, atol=digits)
    assert sorted(faces_of(polygons)) == sorted(QUADS + TRIANGLES)


def test_polygons_are_kept_through_the_process(tmp_path: Path) -> None:
    hexagon = [[np.cos(a), np.sin(a), 0.0] for a in np.arange(6) * np.pi / 3]
    cells = [("line", [[0, 1], [1, 2]]), ("polygon", [[0, 1, 2, 3, 4, 5]])]
    cells += [("triangle", [[1, 0, 6]])]
    meshio.Mesh([*hexagon, [2, 2, 0]], cells).write(tmp_path / "a.vtu")
    content = read_content(tmp_path / "a.vtu")
    assert sorted(content.polygons.degrees.tolist()) == [3, 6]
    assert content.remarks == ("left out: 2 line; only faces are read",)


def test_a_model_without_faces_says_what_it_holds(tmp_path: Path, error_of: ErrorOf) -> None:
    meshio.Mesh(POINTS, [("tetra", [[0, 1, 3, 6]])]).write(tmp_path / "b.vtu")
    message = error_of("b.vtu")
    assert "1 tetra" in message
    assert "surface" in message


def test_nodes_on_sides_are_left_out(tmp_path: Path) -> None:
    middles = [(POINTS[i] + POINTS[j]) / 2 for i, j in ((3, 4), (4, 6), (6, 3))]
    points = [*POINTS, *middles]
    meshio.Mesh(points, [("triangle6", [[3, 4, 6, 7, 8, 9]])]).write(tmp_path / "a.vtu")
    assert faces_of(read_with_library(tmp_path / "a.vtu", ".vtu")[0]) == [[3, 4, 6]]


def test_plane_points_have_z_0(tmp_path: Path) -> None:
    (tmp_path / "a.su2").write_text(
        "NDIME= 2\nNELEM= 1\n5 0 1 2 0\nNPOIN= 3\n0 0 0\n1 0 1\n0 1 2\nNMARK= 0\n"
    )
    polygons, _ = read_with_library(tmp_path / "a.su2", ".su2")
    assert polygons.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


@pytest.mark.parametrize("suffix", OTHER_SUFFIXES)
@pytest.mark.parametrize("data", [b"not a mesh\n", b"\x00\x01\xfe", b"{}\n", b"1 2\n3"])
def test_what_a_library_cannot_read_is_one_line(
    tmp_path: Path, suffix: str, data: bytes
) -> None:
    (tmp_path / f"a{suffix}").write_bytes(data)
    try:
        polygons, _ = read_with_library(tmp_path / f"a{suffix}", suffix)
    except InputError as error:
        message = str(error)
        assert "\n" not in message
        assert len(message) < 300
    else:  # words that mean nothing may be no cells
        assert not len(polygons.degrees)


def test_what_the_process_says_is_one_line(
    error_of: ErrorOf, capfd: pytest.CaptureFixture[str]
) -> None:
    assert "meshio says" in error_of("a.vtk", b"# vtk DataFile Version 2.0\nx\ny\n")
    assert capfd.readouterr() == ("", "")


def test_a_file_on_which_a_library_never_ends_is_refused(
    error_of: ErrorOf, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(other_formats, "SPARE_SECONDS", 1.0)
    assert "damaged" in error_of("a.msh", b'(1 "a file that is cut off")\n(2 3)\n(39 (1')


@pytest.mark.parametrize(("suffix", "library"), [(".vtu", "meshio"), (".glb", "trimesh")])
def test_without_the_library_the_message_says_how_to_install_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str, library: str
) -> None:
    monkeypatch.setitem(sys.modules, library, None)
    (tmp_path / f"a{suffix}").write_bytes(b"x")
    with pytest.raises(MissingLibraryError, match=rf"{library}.*spheremesh\[formats\]"):
        read_mesh(tmp_path / f"a{suffix}")


def test_gltf_stands_up_and_is_welded(tmp_path: Path) -> None:
    mesh = trimesh.Trimesh(POINTS, [[0, 1, 4], [0, 4, 3], *TRIANGLES], process=False)
    scene = trimesh.Scene()
    # A writer that turns z up into y up, and repeats vertices.
    turn = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
    mesh.unmerge_vertices()
    scene.add_geometry(mesh, geom_name="roof", transform=turn)
    scene.export(tmp_path / "a.glb")
    content = read_content(tmp_path / "a.glb")
    assert content.units == "m"
    assert content.sources == (("mesh 'roof'", 4),)
    back = read_mesh(tmp_path / "a.glb")
    assert (back.n_vertices, back.n_faces) == (6, 4)
    assert np.allclose(
        back.vertices[back.corners], mesh.vertices[mesh.faces.ravel()], atol=1e-6
    )


def test_other_formats_are_read_and_not_written(tmp_path: Path) -> None:
    mesh = Mesh(POINTS, QUADS)
    with pytest.raises(InputError, match="not a mesh format"):
        write_mesh(mesh, tmp_path / "a.vtu")
