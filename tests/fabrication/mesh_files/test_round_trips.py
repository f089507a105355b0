"""Mesh files: what is written comes back, what is no mesh file is named."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spheremesh import Mesh
from spheremesh.fabrication.mesh_files.reader import SUFFIXES, read_mesh
from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.fabrication.triangles import fan_triangles
from spheremesh.kernel.errors import InputError

Read: TypeAlias = Callable[..., Mesh]
ErrorOf: TypeAlias = Callable[..., str]
FacesOf: TypeAlias = Callable[[Mesh], list[list[int]]]
CornersOf: TypeAlias = Callable[[Mesh], list[list[list[float]]]]


EXACT = [".obj", ".off", ".ply", ".3dm"]


@st.composite
def mixed_meshes(draw: st.DrawFn) -> Mesh:
    """A rectangular net of triangles, quads and hexagons in random order, anywhere."""
    n_rows, n_columns = draw(st.integers(1, 5)), draw(st.integers(1, 5))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    scale = draw(st.sampled_from([1e-6, 1.0, 1000.0 / 3]))
    origin = draw(st.sampled_from([0.0, -1.0, 1e5 / 7])) * scale
    ids = np.arange((n_rows + 1) * (n_columns + 1)).reshape(n_rows + 1, n_columns + 1)
    faces = []
    for i in range(n_rows):
        j = 0
        while j < n_columns:
            a, b, c, d = ids[i, j], ids[i + 1, j], ids[i + 1, j + 1], ids[i, j + 1]
            kind = draw(st.integers(0, 2))
            if kind == 2 and j + 1 < n_columns:
                faces.append([a, b, c, ids[i + 1, j + 2], ids[i, j + 2], d])
                j += 2
                continue
            faces += [[a, b, c], [a, c, d]] if kind == 1 else [[a, b, c, d]]
            j += 1
    rng.shuffle(faces)
    rows, columns = np.divmod(np.arange(ids.size), n_columns + 1)
    grid = np.stack([rows, columns, np.zeros(ids.size)], axis=1)
    return Mesh(origin + scale * (grid + rng.uniform(-0.2, 0.2, grid.shape)), faces)


@pytest.mark.parametrize("suffix", EXACT)
@settings(max_examples=30, deadline=None)
@given(mesh=mixed_meshes())
def test_a_mesh_comes_back_with_all_digits_and_its_faces_in_order(
    faces_of: FacesOf,
    corners_of: CornersOf,
    tmp_path_factory: pytest.TempPathFactory,
    suffix: str,
    mesh: Mesh,
) -> None:
    path = tmp_path_factory.mktemp("round") / f"mesh{suffix}"
    assert write_mesh(mesh, path) == path
    back = read_mesh(path)
    assert corners_of(back) == corners_of(mesh)
    if suffix != ".3dm":
        assert np.array_equal(back.vertices, mesh.vertices)
        assert faces_of(back) == faces_of(mesh)


@settings(max_examples=30, deadline=None)
@given(mesh=mixed_meshes())
def test_stl_gives_the_triangles_of_each_face_in_order(
    tmp_path_factory: pytest.TempPathFactory, mesh: Mesh
) -> None:
    path = write_mesh(mesh, tmp_path_factory.mktemp("round") / "mesh.stl")
    triangles, owners = fan_triangles(mesh)
    assert np.array_equal(np.bincount(owners), mesh.degrees - 2)
    back = read_mesh(path)
    assert np.array_equal(
        back.vertices[back.corners], mesh.vertices.astype(np.float32)[triangles.ravel()]
    )
    assert back.n_vertices == mesh.n_vertices


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_capital_suffix_and_a_str_path_will_do(
    quad_and_triangle: Mesh, tmp_path: Path, suffix: str
) -> None:
    mesh = quad_and_triangle
    path = str(tmp_path / f"Mesh{suffix.upper()}")
    assert read_mesh(write_mesh(mesh, path)).n_faces == (3 if suffix == ".stl" else 2)


@pytest.mark.parametrize("suffix", [".obj", ".off", ".ply"])
def test_unused_vertices_keep_the_numbers_of_the_others(
    faces_of: FacesOf, tmp_path: Path, suffix: str
) -> None:
    mesh = Mesh([[9, 9, 9], [0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1, 2, 3]])
    back = read_mesh(write_mesh(mesh, tmp_path / f"mesh{suffix}"))
    assert np.array_equal(back.vertices, mesh.vertices)
    assert faces_of(back) == [[1, 2, 3]]


def test_a_ply_face_may_have_more_corners_than_a_byte_counts(
    corners_of: CornersOf, tmp_path: Path
) -> None:
    angles = np.linspace(0, 2 * np.pi, 300, endpoint=False)
    circle = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
    mesh = Mesh(circle, [range(300)])
    for suffix in EXACT:
        back = read_mesh(write_mesh(mesh, tmp_path / f"mesh{suffix}"))
        assert corners_of(back) == corners_of(mesh)


def test_fans_cover_faces_with_a_reflex_corner_without_overlap() -> None:
    arrow = [[0, 0, 0], [2, -2, 0], [0, 3, 0], [-2, -2, 0]]
    bow = [[10, 0, 0], [12, 0, 0], [11.2, 1, 0], [12, 2, 0], [10, 2, 0], [10.8, 1, 0]]
    mesh = Mesh(arrow + bow, [range(4), range(4, 10)])
    triangles, owners = fan_triangles(mesh)
    corners = mesh.vertices[triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] / 2
    assert (areas > 0).all()
    assert np.allclose(np.bincount(owners, areas), [6, 2.4])


@settings(max_examples=150, deadline=None)
@given(
    suffix=st.sampled_from([".obj", ".off", ".ply", ".stl"]),
    changes=st.lists(st.tuples(st.integers(0, 2000), st.binary(max_size=3)), max_size=4),
    cut=st.integers(0, 2000),
)
def test_a_damaged_file_is_refused_in_one_line_or_holds_a_mesh(
    quad_and_triangle: Mesh,
    tmp_path_factory: pytest.TempPathFactory,
    suffix: str,
    changes: list[tuple[int, bytes]],
    cut: int,
) -> None:
    path = tmp_path_factory.mktemp("damaged") / f"a{suffix}"
    data = bytearray(write_mesh(quad_and_triangle, path).read_bytes())
    for place, patch in changes:
        start = place % len(data)
        data[start : start + len(patch)] = patch
    path.write_bytes(data[: cut % (2 * len(data))])
    message, mesh = "", None
    try:
        mesh = read_mesh(path)
    except InputError as error:
        message = str(error)
    if mesh is None:
        assert message.startswith(f"cannot read {path}: ")
        assert "\n" not in message
    else:
        assert mesh.n_faces
        assert mesh.corners.max() < mesh.n_vertices
        assert np.isfinite(mesh.vertices).all()


def test_files_that_are_not_there_or_not_files(error_of: ErrorOf, tmp_path: Path) -> None:
    assert "no such file" in error_of("none.obj")
    (tmp_path / "folder.obj").mkdir()
    assert "folder" in error_of("folder.obj")
    assert "folder" in error_of("")
    assert ".obj, .off, .ply, .stl, .3dm" in error_of("a.fbx", "x")
    assert "no suffix" in error_of("mesh", "x")
    for suffix in SUFFIXES:
        assert "empty" in error_of(f"empty{suffix}", " \n")
    for suffix in (".off", ".ply", ".stl"):
        assert "no layers" in error_of(f"a{suffix}", "x", layer="Roof")


@pytest.mark.parametrize("name", ["a\0.obj", "x" * 300 + ".obj"])
def test_names_that_no_file_can_have(
    quad_and_triangle: Mesh, tmp_path: Path, name: str
) -> None:
    with pytest.raises(InputError, match=r"cannot read .*; check the path"):
        read_mesh(tmp_path / name)
    with pytest.raises(InputError, match="cannot write"):
        write_mesh(quad_and_triangle, tmp_path / name)


def test_a_file_that_may_not_be_read(
    error_of: ErrorOf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")

    def refuse(_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("pathlib.Path.read_bytes", refuse)
    assert "permissions" in error_of(path.name)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_failed_write_leaves_the_old_file_alone(
    quad_and_triangle: Mesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str
) -> None:
    path = tmp_path / f"a{suffix}"
    path.write_text("precious")

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(InputError, match=f"cannot write .*a{suffix}: No space"):
        write_mesh(quad_and_triangle, path)
    assert path.read_text() == "precious"
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


def test_places_that_cannot_be_written_to(quad_and_triangle: Mesh, tmp_path: Path) -> None:
    mesh = quad_and_triangle
    with pytest.raises(InputError, match=r"a\.fbx.*\.3dm"):
        write_mesh(mesh, tmp_path / "a.fbx")
    with pytest.raises(InputError, match="no folder"):
        write_mesh(mesh, tmp_path / "none" / "a.obj")
    (tmp_path / "b.obj").mkdir()
    with pytest.raises(InputError, match="folder"):
        write_mesh(mesh, tmp_path / "b.obj")
