"""Wavefront OBJ files: their dialects, layers and errors."""

from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import pytest

from spheremesh import Mesh
from spheremesh.fabrication.mesh_files.reader import read_content
from spheremesh.fabrication.polygons import FileContent
from spheremesh.kernel.errors import InputError

Content: TypeAlias = Callable[..., FileContent]
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


NAMED_OBJ = """v 0 0 0
v 1 0 0
v 0 1 0
v 5 5 5
v 5 0 5
g Roof
f 1 2 3
g RoofGlass
f 2 1 4
g roof
f 3 2 4
g Door, left
f 2 4 5
"""


@pytest.mark.parametrize(
    ("layer", "lines"),
    [
        ("Roof", [7]),
        ("roof", [11]),
        ("ROOF", [7, 11]),
        ("RoofG", [9]),
        ("Ro", [7, 9, 11]),
        ("Roof,RoofGlass", [7, 9]),
        ("roof , RoofGlass", [9, 11]),
        ("Door, left", [13]),
        (["Door, left", "Roof"], [7, 13]),
        (("Roof",), [7]),
    ],
)
def test_obj_a_name_in_full_comes_before_its_start_and_several_do(
    tmp_path: Path, layer: str | list[str], lines: list[int]
) -> None:
    (tmp_path / "a.obj").write_text(NAMED_OBJ)
    content = read_content(tmp_path / "a.obj", layer)
    assert list(content.polygons.face_lines) == lines


def test_obj_of_several_names_each_must_fit(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(
        NAMED_OBJ + "".join(f"g n{i}\nf 1 4 5\n" for i in range(30))
    )
    with pytest.raises(InputError, match=r"'Wall'; the file names 'Roof', .* and 14 more"):
        read_content(tmp_path / "a.obj", "Roof,Wall")


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
        (TRIANGLE + "f 1 2 3\nf # 1 2\n", ["line 5", "0 corners", "needs 3"]),
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


def test_obj_numbers_of_fortran_are_read(read: Read) -> None:
    text = "v 0.1D+01 0 0\nv 1.5d0 0 -2D-1\nv 0 1 0\nf 1 2 3\n"
    assert read("a.obj", text).vertices.tolist() == [[1, 0, 0], [1.5, 0, -0.2], [0, 1, 0]]


@pytest.mark.parametrize("word", ["1_0", "\u0663", "1d", "D5", "0x1", "1.0D1.5"])
def test_obj_numbers_that_only_python_reads_are_none(error_of: ErrorOf, word: str) -> None:
    assert "line 2" in error_of("a.obj", f"v 0 0 0\nv {word} 0 0\nv 0 1 0\nf 1 2 3\n")
    assert "line 4" in error_of("b.obj", TRIANGLE + f"f 1 2 {word}\n")


CURVED = "cstype bspline\ndeg 1 1\nsurf 0 1 0 1 1 2 3 4\nparm u 0 0 1 1\nparm v 0 0 1 1\nend\n"


def test_obj_free_form_surfaces_are_named(content: Content, error_of: ErrorOf) -> None:
    points = TRIANGLE + "v 1 1 0\n"
    message = error_of("a.obj", points + CURVED)
    assert "line 7" in message
    assert "1 free-form surface;" in message
    assert ".3dm" in message
    message = error_of("b.obj", points + "cstype bezier\ndeg 1\ncurv 0 1 1 2\nend\n")
    assert "1 free-form curve" in message
    found = content("c.obj", points + CURVED + "f 1 2 4 3\n")
    assert found.polygons.degrees.tolist() == [4]
    assert found.remarks == ("left out: 1 free-form surface; only faces (f) are read",)


def test_obj_lines_and_points_are_counted(content: Content, error_of: ErrorOf) -> None:
    found = content("a.obj", TRIANGLE + "l 1 2 3\nl 2 3\np 1\nf 1 2 3\n")
    assert found.remarks == (
        "left out: 2 line elements and 1 point element; only faces (f) are read",
    )
    message = error_of("b.obj", TRIANGLE + "l 1 2 3\n")
    assert "line 4: the file has no faces, but 1 line element; export" in message


def test_obj_words_that_are_no_statements_are_said(content: Content) -> None:
    found = content("a.obj", TRIANGLE + "vx 1 2 3\nfoo\nf 1 2 3\n")
    assert len(found.remarks) == 1
    assert "line 4: 'vx'" in found.remarks[0]
    assert "2 such lines" in found.remarks[0]


@pytest.mark.parametrize("end", ["f 1 2", "f", "f 1"])
def test_obj_cut_off_in_its_last_face_is_refused(error_of: ErrorOf, end: str) -> None:
    assert "line 5: the file is cut off" in error_of("a.obj", TRIANGLE + "f 1 2 3\n" + end)
    assert "needs 3" in error_of("b.obj", TRIANGLE + "f 1 2 3\n" + end + "\n")


def test_obj_backslashes_join_lines_but_not_comments(read: Read, faces_of: FacesOf) -> None:
    text = "# from C:\\models\\\n" + TRIANGLE + "f 1 \\ \n 2\\\n 3\n"
    assert faces_of(read("a.obj", text)) == [[0, 1, 2]]
    long = TRIANGLE + "f 1 2 3\n" + "x" * 200_000 + "\ny \\\nz\n"
    assert read("b.obj", long).n_faces == 1


def test_obj_old_faces_and_capitals_are_faces(read: Read, faces_of: FacesOf) -> None:
    assert faces_of(read("a.obj", TRIANGLE + "fo 1 2 3\n")) == [[0, 1, 2]]
    assert faces_of(read("b.obj", TRIANGLE.upper() + "F 1 2 3\n")) == [[0, 1, 2]]


def test_obj_without_faces_names_the_first_word_that_is_not_known(error_of: ErrorOf) -> None:
    assert "no faces; line 4: 'face' is no" in error_of("a.obj", TRIANGLE + "face 1 2 3\n")
