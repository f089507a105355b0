"""Wavefront OBJ files: their dialects, layers and errors."""

from collections.abc import Callable
from typing import TypeAlias

import pytest

from spheremesh import Mesh

Read: TypeAlias = Callable[..., Mesh]
ErrorOf: TypeAlias = Callable[..., str]
FacesOf: TypeAlias = Callable[[Mesh], list[list[int]]]


def test_obj_dialects(read: Read, faces_of: FacesOf) -> None:
    content = (
        b"\xef\xbb\xbf# caf\xe9, not UTF-8\r\nmtllib a.mtl\r\no roof\r\n"
        b"v 0 0 0 # a comment\r\n  v\t1 0 0 1.0\r\nv 1 1 0 0.5 0.5 0.5\r\nv 0 1e0 -0.\r\n"
        b"vt 0 0\r\nvn 0 0 1\r\nl 1 2\r\np 1\r\ns off\r\nusemtl steel\r\n"
        b"f 1/1/1 2/1/1 \\\r\n 3/1/1\r\nf -4//1 -2//1 -1//1\r\nv 7 7 7\r\n"
    )
    mesh = read("a.obj", content)
    assert faces_of(mesh) == [[0, 1, 2], [0, 2, 3]]
    assert mesh.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [7, 7, 7]]


def test_obj_negative_numbers_count_from_the_face_that_uses_them(
    read: Read, faces_of: FacesOf
) -> None:
    content = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 1 1 0\nf 3 -3 -1\n"
    assert faces_of(read("a.obj", content)) == [[0, 1, 2], [2, 1, 3]]


def test_obj_faces_may_come_before_their_vertices_and_lines_end_in_cr(
    read: Read, faces_of: FacesOf
) -> None:
    content = "f 1 2 3\rv 0 0 0\rv 1 0 0\rv 0 1 0"
    assert faces_of(read("a.obj", content)) == [[0, 1, 2]]


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
    read: Read, faces_of: FacesOf, layer: str, faces: list, n_vertices: int
) -> None:
    mesh = read("a.obj", LAYERED_OBJ, layer=layer)
    assert faces_of(mesh) == faces
    assert mesh.n_vertices == n_vertices


def test_obj_layer_that_matches_nothing(error_of: ErrorOf) -> None:
    message = error_of("a.obj", LAYERED_OBJ, layer="Floor")
    assert "'Floor'" in message
    assert "'Roof', 'Panels North', 'Wall'" in message
    assert "none" in error_of("a.obj", "v 0 0 0\nf 1 1 1\n", layer="Floor")


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
        (TRIANGLE + "v 1 1 0\nf 1 2 3\nf 1 2 4\n", ["(line 5), 1 (line 6)", "same direction"]),
        (TRIANGLE + "v 1 1 0\nv 2 2 2\nf 1 2 3\nf 2 1 4\nf 1 2 5\n", ["non-manifold"]),
        (b"\x00\xff\x80\x13binary\n", ["no faces"]),
    ],
)
def test_obj_errors_name_the_line_and_the_remedy(
    error_of: ErrorOf, content: str | bytes, parts: list[str]
) -> None:
    message = error_of("a.obj", content)
    assert all(part in message for part in parts), message
