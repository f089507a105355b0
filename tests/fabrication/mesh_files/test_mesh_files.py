"""Mesh files: what is written comes back, what is broken is named."""

import contextlib
import os
import struct
from pathlib import Path

import numpy as np
import pytest
import rhino3dm
from hypothesis import given, settings
from hypothesis import strategies as st

from spheremesh import Mesh
from spheremesh.fabrication.mesh_files.formats import SUFFIXES, read_mesh, write_mesh
from spheremesh.fabrication.rhino.meshes import _with_ngons
from spheremesh.fabrication.triangles import fan_triangles
from spheremesh.kernel.errors import InputError

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


def quad_and_triangle() -> Mesh:
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0.1], [0, 1, 1 / 3], [2, 0.5, 0]]
    return Mesh(points, [[1, 4, 2], [0, 1, 2, 3]])


def faces_of(mesh: Mesh) -> list[list[int]]:
    return [face.tolist() for face in mesh.faces]


def corners_of(mesh: Mesh) -> list[list[list[float]]]:
    return [mesh.vertices[face].tolist() for face in mesh.faces]


def written(path: Path, content: str | bytes) -> Path:
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def error_of(path: Path, content: str | bytes | None = None, **options: str) -> str:
    if content is not None:
        written(path, content)
    with pytest.raises(InputError) as caught:
        read_mesh(path, **options)
    message = str(caught.value)
    assert "\n" not in message
    assert message.startswith(f"cannot read {path}: ")
    return message


# --- round trips


@pytest.mark.parametrize("suffix", EXACT)
@settings(max_examples=30, deadline=None)
@given(mesh=mixed_meshes())
def test_a_mesh_comes_back_with_all_digits_and_its_faces_in_order(
    tmp_path_factory: pytest.TempPathFactory, suffix: str, mesh: Mesh
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
def test_a_capital_suffix_and_a_str_path_will_do(tmp_path: Path, suffix: str) -> None:
    mesh = quad_and_triangle()
    path = str(tmp_path / f"Mesh{suffix.upper()}")
    assert read_mesh(write_mesh(mesh, path)).n_faces == (3 if suffix == ".stl" else 2)


@pytest.mark.parametrize("suffix", [".obj", ".off", ".ply"])
def test_unused_vertices_keep_the_numbers_of_the_others(tmp_path: Path, suffix: str) -> None:
    mesh = Mesh([[9, 9, 9], [0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1, 2, 3]])
    back = read_mesh(write_mesh(mesh, tmp_path / f"mesh{suffix}"))
    assert np.array_equal(back.vertices, mesh.vertices)
    assert faces_of(back) == [[1, 2, 3]]


def test_a_ply_face_may_have_more_corners_than_a_byte_counts(tmp_path: Path) -> None:
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


# --- OBJ


def test_obj_dialects(tmp_path: Path) -> None:
    content = (
        b"\xef\xbb\xbf# caf\xe9, not UTF-8\r\nmtllib a.mtl\r\no roof\r\n"
        b"v 0 0 0 # a comment\r\n  v\t1 0 0 1.0\r\nv 1 1 0 0.5 0.5 0.5\r\nv 0 1e0 -0.\r\n"
        b"vt 0 0\r\nvn 0 0 1\r\nl 1 2\r\np 1\r\ns off\r\nusemtl steel\r\n"
        b"f 1/1/1 2/1/1 \\\r\n 3/1/1\r\nf -4//1 -2//1 -1//1\r\nv 7 7 7\r\n"
    )
    mesh = read_mesh(written(tmp_path / "a.obj", content))
    assert faces_of(mesh) == [[0, 1, 2], [0, 2, 3]]
    assert mesh.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [7, 7, 7]]


def test_obj_negative_numbers_count_from_the_face_that_uses_them(tmp_path: Path) -> None:
    content = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 1 1 0\nf 3 -3 -1\n"
    assert faces_of(read_mesh(written(tmp_path / "a.obj", content))) == [[0, 1, 2], [2, 1, 3]]


def test_obj_faces_may_come_before_their_vertices_and_lines_end_in_cr(tmp_path: Path) -> None:
    content = "f 1 2 3\rv 0 0 0\rv 1 0 0\rv 0 1 0"
    assert faces_of(read_mesh(written(tmp_path / "a.obj", content))) == [[0, 1, 2]]


LAYERED_OBJ = """o Roof
v 0 0 0
v 1 0 0
v 0 1 0
v 5 5 5
f 1 2 3
g Panels North
f 2 1 4
o Wall
g
f 3 2 4
"""


@pytest.mark.parametrize(
    ("layer", "faces", "n_vertices"),
    [
        ("", [[0, 1, 2], [1, 0, 3], [2, 1, 3]], 4),
        ("Roof", [[0, 1, 2], [1, 0, 3]], 4),
        ("Pan", [[1, 0, 2]], 3),
        ("North", [[1, 0, 2]], 3),
        ("Panels North", [[1, 0, 2]], 3),
        ("Wall", [[1, 0, 2]], 3),
    ],
)
def test_obj_layer_is_the_start_of_a_group_or_object_name(
    tmp_path: Path, layer: str, faces: list, n_vertices: int
) -> None:
    mesh = read_mesh(written(tmp_path / "a.obj", LAYERED_OBJ), layer=layer)
    assert faces_of(mesh) == faces
    assert mesh.n_vertices == n_vertices


def test_obj_layer_that_matches_nothing(tmp_path: Path) -> None:
    message = error_of(tmp_path / "a.obj", LAYERED_OBJ, layer="Floor")
    assert "'Floor'" in message
    assert "'Roof', 'Panels North', 'Wall'" in message
    assert "none" in error_of(tmp_path / "a.obj", "v 0 0 0\nf 1 1 1\n", layer="Floor")


TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"


@pytest.mark.parametrize(
    ("content", "parts"),
    [
        ("v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", ["line 2", "finite", "export"]),
        ("v 0 0 0\nv 1 0 -inf\nv 0 1 0\nf 1 2 3\n", ["line 2", "finite"]),
        ("v 0 0\n", ["line 1", "three coordinates"]),
        ("v 0 0 0\nv 1,5 0 0\n" + "f 1 2 3\n", ["line 2", "'1,5'", "decimal point"]),
        (TRIANGLE + "f 1 2 3\nf 1 2 4\n", ["line 5", "out of range", "3 vertices"]),
        (TRIANGLE + "f 1 2 0\n", ["line 4", "out of range"]),
        (TRIANGLE + "f 1 2 -4\n", ["line 4", "out of range"]),
        (TRIANGLE + "\n# c\nf 1 2\n", ["line 6", "2 corners", "needs 3"]),
        (TRIANGLE + "f 1 2 2\n", ["line 4", "repeated corner", "remove"]),
        (TRIANGLE + "f 1 2 \\\n 3\nf 1 2 two\n", ["line 6", "'two'", "integers"]),
        (TRIANGLE + f"f 1 2 {'9' * 6000}\n", ["line 4", f"'{'9' * 40}' is not"]),
        (TRIANGLE + "f 1 2 99999999999999999999\n", ["line 4", "not a usable number"]),
        (TRIANGLE, ["no faces", "polygon mesh"]),
        (TRIANGLE + "v 1 1 0\nf 1 2 3\nf 1 2 4\n", ["faces [0, 1]", "same direction"]),
        (TRIANGLE + "v 1 1 0\nv 2 2 2\nf 1 2 3\nf 2 1 4\nf 1 2 5\n", ["non-manifold"]),
        (b"\x00\xff\x80\x13binary\n", ["no faces"]),
    ],
)
def test_obj_errors_name_the_line_and_the_remedy(
    tmp_path: Path, content: str | bytes, parts: list[str]
) -> None:
    message = error_of(tmp_path / "a.obj", content)
    assert all(part in message for part in parts), message


# --- OFF


@pytest.mark.parametrize(
    "content",
    [
        "OFF\n3 1 3\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "OFF 3 1 0\n# a comment\n\n0 0 0\n1 0 0 # another\n0 1 0\n3 0 1 2 255 0 0\n",
        "3 1 0\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n3  0 1 2\r\n",
        "COFF\n3 1\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2\n",
        "STCNOFF\n3 1\n0 0 0 9 9\n1 0 0 9 9\n0 1 0 9 9\n3 0 1 2\nsomething more",
    ],
)
def test_off_dialects(tmp_path: Path, content: str | bytes) -> None:
    mesh = read_mesh(written(tmp_path / "a.off", content))
    assert mesh.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    assert faces_of(mesh) == [[0, 1, 2]]


OFF = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n"


@pytest.mark.parametrize(
    ("content", "parts"),
    [
        ("hello\n", ["line 1", "expected OFF", "'hello'", "save as"]),
        ("# nothing\n", ["line 1", "expected OFF"]),
        ("4OFF\n3 1 0\n", ["line 1", "expected OFF"]),
        ("OFF BINARY\n", ["line 1", "'BINARY'", "ascii"]),
        ("OFF\n", ["line 1", "numbers of vertices"]),
        ("OFF\nmany 1 0\n", ["line 2", "numbers of vertices"]),
        ("OFF\n" + "9" * 30 + " 1 0\n", ["line 2", "numbers of vertices"]),
        (OFF, ["line 5", "3 of 3 vertices", "0 of 1 faces", "export"]),
        ("OFF\n3 1 0\n0 0 0\n1 0\n", ["line 4", "three coordinates"]),
        ("OFF\n3 1 0\n0 0 0\n1 0 inf\n0 1 0\n3 0 1 2", ["line 4", "finite"]),
        ("OFF\n3 1 0\n0 0 0\n1 x 0\n0 1 0\n3 0 1 2", ["line 4", "'x'"]),
        (OFF + "4 0 1 2\n", ["line 6", "number of corners"]),
        (OFF + "x 0 1 2\n", ["line 6", "number of corners"]),
        (OFF + "3 0 1 3\n", ["line 6", "out of range"]),
        (OFF + "3 0 1 1.5\n", ["line 6", "'1.5'"]),
        (OFF + "2 0 1\n", ["line 6", "2 corners"]),
        (OFF + "3 0 1 1\n", ["line 6", "repeated corner"]),
        ("OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", ["no faces"]),
    ],
)
def test_off_errors_name_the_line_and_the_remedy(
    tmp_path: Path, content: str | bytes, parts: list[str]
) -> None:
    message = error_of(tmp_path / "a.off", content)
    assert all(part in message for part in parts), message


# --- PLY


def ply(order: str, vertex: str = "double", count: str = "uchar", index: str = "int") -> bytes:
    return (
        f"ply\nformat {order} 1.0\ncomment caf\u00e9\nelement camera 1\nproperty float angle\n"
        f"element vertex 4\nproperty uchar red\nproperty {vertex} x\nproperty {vertex} y\n"
        f"property {vertex} z\nelement strip 1\nproperty list uchar short ids\n"
        f"element face 2\nproperty float quality\nproperty list {count} {index} vertex_index\n"
        f"property list uchar float texcoord\nend_header\n"
    ).encode("latin-1")


POINTS = [(0, 0, 0), (1, 0, 0), (1, 1, 0.5), (0, 1, 0)]
FACES = [(0, 1, 2), (0, 2, 3)]


def ply_body(order: str, vertex: str = "d", count: str = "B", index: str = "i") -> bytes:
    body = struct.pack(f"{order}f", 30)
    for point in POINTS:
        body += struct.pack(f"{order}B3{vertex}", 255, *point)
    body += struct.pack(f"{order}B2h", 2, -1, -1)
    for face in FACES:
        body += struct.pack(f"{order}f{count}3{index}", 0.5, len(face), *face)
        body += struct.pack(f"{order}B2f", 2, 0, 0)
    return body


@pytest.mark.parametrize(
    "content",
    [
        ply("ascii") + b"30\n255 0 0 0\n255 1 0 0\n\n255 1 1 .5\n255 0 1 0\n2 -1 -1\n"
        b"0.5 3 0 1 2 2 0 0\n0.5 3 0 2 3 2 0 0\n",
        ply("binary_little_endian") + ply_body("<"),
        ply("binary_big_endian") + ply_body(">"),
        ply("binary_little_endian", "float", "int", "ushort") + ply_body("<", "f", "i", "H"),
        ply("binary_big_endian", "float32", "uint8", "uint8") + ply_body(">", "f", "B", "B"),
        ply("binary_little_endian").replace(b"\n", b"\r\n") + ply_body("<"),
    ],
)
def test_ply_dialects(tmp_path: Path, content: str | bytes) -> None:
    mesh = read_mesh(written(tmp_path / "a.ply", content))
    assert mesh.vertices.tolist() == [list(point) for point in POINTS]
    assert faces_of(mesh) == [list(face) for face in FACES]


PLY = (
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
)
PLY_POINTS = "0 0 0\n1 0 0\n0 1 0\n"


@pytest.mark.parametrize(
    ("content", "parts"),
    [
        ("plain text\n", ["line 1", "header", "export"]),
        ("ply\nformat ascii 1.0\nelement vertex 3\n", ["line 1", "end_header"]),
        ("ply\nformat xml 1.0\nend_header\n", ["line 2", "'format xml 1.0'"]),
        ("ply\nend_header\n", ["names no format"]),
        (PLY.replace("float z", "quad z"), ["line 6", "'property quad z'"]),
        (PLY.replace("float z", "float w"), ["x, y and z"]),
        (PLY.replace("list uchar", "list float"), ["line 8", "'property list float int"]),
        (PLY.replace("uchar int", "uchar float"), ["line 8", "'property list uchar float"]),
        (PLY.replace("vertex 3", "vertex many"), ["line 3", "'element vertex many'"]),
        (PLY.replace("vertex_indices", "ids") + PLY_POINTS + "3 0 1 2\n", ["vertex_indices"]),
        (PLY + "0 0 0\n1 0 0\n", ["line 11", "2 of 3 rows of element vertex"]),
        (PLY, ["line 9", "0 of 3 rows"]),
        (PLY + "0 0 0\n1 0\n", ["line 11", "three coordinates"]),
        (PLY + "0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", ["line 11", "finite"]),
        (PLY + "0 0 0\n1 0 o\n0 1 0\n3 0 1 2\n", ["line 11", "'o'"]),
        (PLY + PLY_POINTS + "4 0 1 2\n", ["line 13", "list vertex_indices"]),
        (PLY + PLY_POINTS + "3 0 1 3\n", ["line 13", "out of range"]),
        (PLY + PLY_POINTS + "3 0 1 1\n", ["line 13", "repeated corner"]),
        (PLY + PLY_POINTS + "2 0 1\n", ["line 13", "2 corners"]),
        (PLY.replace("face 1", "face 0") + PLY_POINTS, ["no faces"]),
        (ply("binary_little_endian") + ply_body("<")[:-1], ["cut short", "element face"]),
        (ply("binary_little_endian") + ply_body("<")[:-20], ["cut short", "element face"]),
        (ply("binary_little_endian") + ply_body("<")[:40], ["cut short", "element vertex"]),
        (
            PLY.replace("ascii", "binary_little_endian").replace("uchar", "char").encode()
            + bytes(36)
            + b"\xff",
            ["list of -1"],
        ),
        (
            PLY.replace("ascii", "binary_little_endian").encode()
            + struct.pack("<9fB3i", 0, 0, 0, 1, np.nan, 0, 0, 1, 0, 3, 0, 1, 2),
            ["vertices [1]", "finite"],
        ),
        (
            PLY.replace("ascii", "binary_little_endian").encode()
            + struct.pack("<9fB3i", 0, 0, 0, 1, 0, 0, 0, 1, 0, 3, 0, 1, 7),
            ["faces [0]", "out of range"],
        ),
        (
            PLY.replace("ascii", "binary_little_endian")
            .replace("vertex_indices", "ids")
            .encode()
            + struct.pack("<9fB3i", 0, 0, 0, 1, 0, 0, 0, 1, 0, 3, 0, 1, 2),
            ["vertex_indices"],
        ),
    ],
)
def test_ply_errors_name_the_line_or_the_element(
    tmp_path: Path, content: str | bytes, parts: list[str]
) -> None:
    message = error_of(tmp_path / "a.ply", content)
    assert all(part in message for part in parts), message


# --- STL

FACET = (
    "facet normal 0 0 1\n outer loop\n  vertex {} 0 0\n  vertex 1 0 0\n  vertex 0 1 -0.0\n"
    " endloop\nendfacet\n"
)
SOLID = (
    "solid part\n"
    + FACET.format("0")
    + "facet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\n"
    "endfacet\nendsolid part\n"
)


def test_stl_ascii_corners_are_shared(tmp_path: Path) -> None:
    mesh = read_mesh(written(tmp_path / "a.stl", SOLID))
    assert mesh.n_vertices == 4
    assert faces_of(mesh) == [[0, 1, 2], [1, 3, 2]]


def test_a_binary_stl_may_start_with_solid(tmp_path: Path) -> None:
    data = write_mesh(quad_and_triangle(), tmp_path / "a.stl").read_bytes()
    mesh = read_mesh(written(tmp_path / "b.stl", b"solid lie".ljust(80) + data[80:]))
    assert (mesh.n_vertices, mesh.n_faces) == (5, 3)


@pytest.mark.parametrize(
    ("content", "parts"),
    [
        ("solid part\n" + FACET.format("zero"), ["line 4", "'zero'"]),
        ("solid part\n" + FACET.format("nan"), ["line 4", "finite"]),
        ("solid part\n" + FACET.format("0 0"), ["line 4", "three coordinates"]),
        (SOLID.replace("vertex 1 1 0\n", ""), ["line 13", "three vertices"]),
        (SOLID[: SOLID.index("vertex 1 1")], ["line 11", "inside a facet"]),
        ("solid part\n" + FACET.format("1"), ["line 4", "repeated corner"]),
        ("solid part\nendsolid part\n", ["no faces"]),
        (b"cut", ["cut short"]),
        (
            bytes(80) + struct.pack("<I12f2x", 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, np.inf, 0),
            ["faces [0]", "finite"],
        ),
        (bytes(80) + struct.pack("<I", 2) + bytes(50), ["cut short", "2 triangles"]),
        (bytes(80) + struct.pack("<I", 1) + bytes(50), ["faces [0]", "repeated corner"]),
    ],
)
def test_stl_errors_name_the_line_and_the_remedy(
    tmp_path: Path, content: str | bytes, parts: list[str]
) -> None:
    message = error_of(tmp_path / "a.stl", content)
    assert all(part in message for part in parts), message


def test_stl_refuses_to_merge_vertices_that_float32_cannot_tell_apart(tmp_path: Path) -> None:
    mesh = quad_and_triangle()
    for vertices in (mesh.vertices + 1e9, mesh.vertices * 1e39):
        with pytest.raises(InputError, match=r"far\.stl: STL keeps 7 digits.* \.3dm"):
            write_mesh(Mesh(vertices, mesh.faces), tmp_path / "far.stl")
    assert list(tmp_path.iterdir()) == []


# --- Rhino


def rhino_mesh(points: list, faces: list, *, double: bool = True) -> rhino3dm.Mesh:
    mesh = rhino3dm.Mesh()
    for point in points:
        (mesh.Vertices.AddPoint3d if double else mesh.Vertices.Add)(*point)
    for face in faces:
        mesh.Faces.AddFace(*face)
    return mesh


def add_layer(model: rhino3dm.File3dm, name: str, parent: int | None = None) -> int:
    layer = rhino3dm.Layer()
    layer.Name = name
    if parent is not None:
        layer.ParentLayerId = model.Layers[parent].Id
    return model.Layers.Add(layer)


def on_layer(index: int) -> rhino3dm.ObjectAttributes:
    attributes = rhino3dm.ObjectAttributes()
    attributes.LayerIndex = index
    return attributes


SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 1 / 3), (0, 1, 0)]


def hexagons_quad_triangle() -> Mesh:
    angles = np.arange(6) * np.pi / 3
    ring = np.stack([np.cos(angles), np.sin(angles), angles / 7], axis=1)
    outside = [[2, 0, 0.1], [1.5, 1.2, 0], [-2, 0, 1 / 3]]
    return Mesh(np.concatenate([ring, outside]), [[0, 6, 7, 1], range(6), [3, 2, 8]])


def test_rhino_reads_our_file_as_we_wrote_it(tmp_path: Path) -> None:
    mesh = hexagons_quad_triangle()
    model = rhino3dm.File3dm.Read(str(write_mesh(mesh, tmp_path / "a.3dm")))
    (entry,) = model.Objects
    seen = entry.Geometry
    assert seen.IsValidWithLog == (True, "")
    assert seen.Vertices.UseDoublePrecisionVertices
    points = [(point.X, point.Y, point.Z) for point in seen.Vertices.ToPoint3dArray()]
    assert np.array_equal(points, mesh.vertices)
    assert (seen.Faces.QuadCount, seen.Faces.TriangleCount) == (1, 4 + 1)
    assert model.Settings.ModelUnitSystem.name == "None"


@pytest.mark.parametrize("version", [6, 7, 8])
def test_ngons_survive_what_rhino_itself_writes(tmp_path: Path, version: int) -> None:
    mesh = hexagons_quad_triangle()
    model = rhino3dm.File3dm.Read(str(write_mesh(mesh, tmp_path / "a.3dm")))
    assert model.Write(str(tmp_path / "b.3dm"), version)
    assert corners_of(read_mesh(tmp_path / "b.3dm")) == corners_of(mesh)


def test_normals_colours_and_user_text_do_no_harm(tmp_path: Path) -> None:
    mesh = hexagons_quad_triangle()
    model = rhino3dm.File3dm.Read(str(write_mesh(mesh, tmp_path / "a.3dm")))
    geometry = model.Objects[0].Geometry
    geometry.SetUserString("note", "caf\u00e9")
    geometry.Normals.ComputeNormals()
    for _ in range(mesh.n_vertices):
        geometry.VertexColors.Add(1, 2, 3)
    decorated = rhino3dm.File3dm()
    decorated.Objects.AddMesh(geometry)
    assert decorated.Write(str(tmp_path / "b.3dm"), 8)
    assert corners_of(read_mesh(tmp_path / "b.3dm")) == corners_of(mesh)


def test_an_ngon_stands_for_its_faces_and_drops_its_inner_vertices(tmp_path: Path) -> None:
    inner = rhino_mesh(
        [(0.5, 0.5, 1), *SQUARE, (2, 0, 0), (2, 1, 0)],
        [(0, 1, 2), (2, 5, 6, 3), (0, 2, 3), (0, 3, 4), (0, 4, 1)],
    )
    model = rhino3dm.File3dm()
    model.Objects.AddMesh(_with_ngons(rhino3dm, inner, [[4, 4, 1, 2, 3, 4, 0, 2, 3, 4]]))
    model.Write(str(tmp_path / "a.3dm"), 8)
    mesh = read_mesh(tmp_path / "a.3dm")
    assert faces_of(mesh) == [[0, 1, 2, 3], [1, 4, 5, 2]]
    assert mesh.vertices[:4].tolist() == [list(point) for point in SQUARE]


def test_the_creases_of_an_unwelded_mesh_are_joined(tmp_path: Path) -> None:
    model = rhino3dm.File3dm()
    crease = [SQUARE[0], SQUARE[1], SQUARE[2], SQUARE[0], SQUARE[2], SQUARE[3]]
    model.Objects.AddMesh(rhino_mesh(crease, [(0, 1, 2), (3, 4, 5)]))
    model.Write(str(tmp_path / "a.3dm"), 8)
    assert faces_of(read_mesh(tmp_path / "a.3dm")) == [[0, 1, 2], [0, 2, 3]]


def test_float32_vertices_are_read_as_they_are_stored(tmp_path: Path) -> None:
    model = rhino3dm.File3dm()
    model.Objects.AddMesh(rhino_mesh(SQUARE, [(0, 1, 2, 3)], double=False))
    model.Write(str(tmp_path / "a.3dm"), 8)
    mesh = read_mesh(tmp_path / "a.3dm")
    assert np.array_equal(mesh.vertices, np.array(SQUARE, np.float32))


def layered_model(path: Path) -> Path:
    """Two squares with a common side on sublayers, a decoy, a block and a sphere."""
    model = rhino3dm.File3dm()
    roof = add_layer(model, "Roof")
    panels = add_layer(model, "Panels", roof)
    north = add_layer(model, "North", panels)
    decoy = add_layer(model, "Panels old", roof)
    right = [(x + 1, y, z) for x, y, z in SQUARE]
    right[0], right[3] = (1 + 1e-9, 0, 0), SQUARE[2]
    model.Objects.AddMesh(rhino_mesh(right, [(0, 1, 2, 3)]), on_layer(north))
    model.Objects.AddMesh(rhino_mesh(SQUARE, [(0, 1, 2, 3)]), on_layer(panels))
    model.Objects.AddMesh(rhino_mesh(SQUARE, [(0, 1, 2)]), on_layer(decoy))
    model.Objects.AddSphere(rhino3dm.Sphere(rhino3dm.Point3d(0, 0, 0), 1), on_layer(roof))
    model.InstanceDefinitions.Add(
        "block", "", "", "", rhino3dm.Point3d(0, 0, 0),
        (rhino_mesh(SQUARE, [(0, 1, 2, 3)]),), (on_layer(panels),),
    )  # fmt: skip
    model.Write(str(path), 8)
    return path


def test_meshes_on_a_layer_and_below_are_joined_in_order(tmp_path: Path) -> None:
    mesh = read_mesh(layered_model(tmp_path / "a.3dm"), layer="Roof::Panels")
    assert mesh.n_vertices == 6
    assert faces_of(mesh) == [[0, 1, 2, 3], [4, 0, 3, 5]]
    assert mesh.vertices[0].tolist() == [1 + 1e-9, 0, 0]
    assert len(mesh.topology.edge_faces) == 1
    assert read_mesh(tmp_path / "a.3dm", layer="Roof::Panels old").n_faces == 1


def test_3dm_errors_say_what_the_file_holds(tmp_path: Path) -> None:
    path = layered_model(tmp_path / "a.3dm")
    message = error_of(path, layer="Wall")
    assert "'Wall'" in message
    assert "'Roof', 'Roof::Panels', 'Roof::Panels::North', 'Roof::Panels old'" in message
    assert "non-manifold" in error_of(path)

    model = rhino3dm.File3dm()
    model.Objects.AddCircle(rhino3dm.Circle(1.0))
    model.Objects.AddMesh(rhino3dm.Mesh())
    model.Objects.AddCircle(rhino3dm.Circle(2.0))
    model.Write(str(tmp_path / "b.3dm"), 8)
    message = error_of(tmp_path / "b.3dm")
    assert "no meshes and no surfaces" in message
    assert "2 NurbsCurve" in message
    assert "1 Mesh" in message

    rhino3dm.File3dm().Write(str(tmp_path / "c.3dm"), 8)
    assert "no objects" in error_of(tmp_path / "c.3dm")
    assert "damaged" in error_of(tmp_path / "d.3dm", path.read_bytes()[:-200])
    assert "damaged" in error_of(tmp_path / "d.3dm", "not Rhino")


# --- any format


@settings(max_examples=150, deadline=None)
@given(
    suffix=st.sampled_from([".obj", ".off", ".ply", ".stl"]),
    changes=st.lists(st.tuples(st.integers(0, 2000), st.binary(max_size=3)), max_size=4),
    cut=st.integers(0, 2000),
)
def test_a_damaged_file_is_x(
    tmp_path_factory: pytest.TempPathFactory,
    suffix: str,
    changes: list[tuple[int, bytes]],
    cut: int,
) -> None:
    path = tmp_path_factory.mktemp("damaged") / f"a{suffix}"
    data = bytearray(write_mesh(quad_and_triangle(), path).read_bytes())
    for place, patch in changes:
        start = place % len(data)
        data[start : start + len(patch)] = patch
    path.write_bytes(data[: cut % (2 * len(data))])
    with contextlib.suppress(InputError):
        read_mesh(path)


def test_files_that_are_not_there_or_not_files(tmp_path: Path) -> None:
    assert "no such file" in error_of(tmp_path / "none.obj")
    (tmp_path / "folder.obj").mkdir()
    assert "folder" in error_of(tmp_path / "folder.obj")
    assert "folder" in error_of(tmp_path)
    assert ".obj, .off, .ply, .stl, .3dm" in error_of(tmp_path / "a.fbx", "x")
    assert "no suffix" in error_of(tmp_path / "mesh", "x")
    for suffix in SUFFIXES:
        assert "empty" in error_of(tmp_path / f"empty{suffix}", " \n")
    for suffix in (".off", ".ply", ".stl"):
        assert "no layers" in error_of(tmp_path / f"a{suffix}", "x", layer="Roof")


@pytest.mark.parametrize("name", ["a\0.obj", "x" * 300 + ".obj"])
def test_names_that_no_file_can_have(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match=r"cannot read .*; check the path"):
        read_mesh(tmp_path / name)
    with pytest.raises(InputError, match="cannot write"):
        write_mesh(quad_and_triangle(), tmp_path / name)


def test_a_file_that_may_not_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path / "a.obj", TRIANGLE)

    def refuse(_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("pathlib.Path.read_bytes", refuse)
    assert "permissions" in error_of(path)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_failed_write_leaves_the_old_file_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str
) -> None:
    path = written(tmp_path / f"a{suffix}", "precious")

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(InputError, match=f"cannot write .*a{suffix}: No space"):
        write_mesh(quad_and_triangle(), path)
    assert path.read_text() == "precious"
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


def test_places_that_cannot_be_written_to(tmp_path: Path) -> None:
    mesh = quad_and_triangle()
    with pytest.raises(InputError, match=r"a\.fbx.*\.3dm"):
        write_mesh(mesh, tmp_path / "a.fbx")
    with pytest.raises(InputError, match="no folder"):
        write_mesh(mesh, tmp_path / "none" / "a.obj")
    (tmp_path / "b.obj").mkdir()
    with pytest.raises(InputError, match="folder"):
        write_mesh(mesh, tmp_path / "b.obj")


def test_a_mesh_that_rhino_calls_invalid_is_not_written(tmp_path: Path) -> None:
    degenerate = Mesh([[0, 0, 0], [1, 0, 0], [1, 0, 0]], [[0, 1, 2]])
    with pytest.raises(InputError, match="invalid"):
        write_mesh(degenerate, tmp_path / "a.3dm")
    assert list(tmp_path.iterdir()) == []
