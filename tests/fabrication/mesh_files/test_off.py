"""OFF files: their dialects and errors."""

from collections.abc import Callable
from typing import TypeAlias

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spheremesh import Mesh
from spheremesh.fabrication.mesh_files.off import read_off
from spheremesh.fabrication.polygons import FileContent

Content: TypeAlias = Callable[..., FileContent]
Read: TypeAlias = Callable[..., Mesh]
ErrorOf: TypeAlias = Callable[..., str]
FacesOf: TypeAlias = Callable[[Mesh], list[list[int]]]


@pytest.mark.parametrize(
    "content",
    [
        "OFF\n3 1 3\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "OFF 3 1 0\n# a comment\n\n0 0 0\n1 0 0 # another\n0 1 0\n3 0 1 2 255 0 0\n",
        "3 1 0\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n3  0 1 2\r\n",
        "COFF\n3 1\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2\n",
        "STCNOFF\n3 1\n0 0 0 9 9\n1 0 0 9 9\n0 1 0 9 9\n3 0 1 2\nsomething more",
        "OFF3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "OFF 3\n1\n0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "off\n3 1 0\n0 0 0 1 0 0\n0 1 0 3 0 1 2\n",
        "OFF 3 1 0 0 0 0 1 0 0 0 1 0 3 0 1 2",
        "OFF\n3 1 0\n0 0\n0 1 # half\n0 0\n0 1 0\n3 0\n1 2\n",
        "OFF\n3 1 0\n0 0\n0 1 0 0\n0 1 0\n3 0\n1 2 0.5 0.5 0.5\n",
        "COFF\n3 1 0\n0 0 0\n1 1 1 1\n1 0 0\n1 1 1 1\n0 1 0\n1 1 1 1\n3 0 1 2\n",
        "COFF\n3 1 0\n0 0 0\n9 9 9\n1 0 0\n9 9 9\n0 1 0\n9 9 9\n3 0 1 2\n",
        "NOFF\n3 1 0\n0 0 0\n0 0 1\n1 0 0\n0 0 1\n0 1 0\n0 0 1\n3 0 1 2\n",
    ],
)
def test_off_dialects(read: Read, faces_of: FacesOf, content: str | bytes) -> None:
    mesh = read("a.off", content)
    assert mesh.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    assert faces_of(mesh) == [[0, 1, 2]]


OFF = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n"


@pytest.mark.parametrize(
    ("content", "parts"),
    [
        ("hello\n", ["line 1", "expected OFF", "'hello'", "save as"]),
        ("# nothing\n", ["line 1", "expected OFF"]),
        ("4OFF\n3 1 0\n", ["line 1", "4OFF", "three coordinates"]),
        ("OFF BINARY\n", ["line 1", "'BINARY'", "ascii"]),
        ("OFF\n", ["line 1", "numbers of vertices"]),
        ("OFF\nmany 1 0\n", ["line 2", "numbers of vertices"]),
        ("OFF\n" + "9" * 30 + " 1 0\n", ["line 2", "numbers of vertices"]),
        (OFF.replace("3 1 0", "999999999999 1 0"), ["line 5", "3 of 999999999999"]),
        (OFF.replace("3 1 0", "3 999999999999 0") + "3 0 1 2\n", ["1 of 999999999999 faces"]),
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
    error_of: ErrorOf, content: str | bytes, parts: list[str]
) -> None:
    message = error_of("a.off", content)
    assert all(part in message for part in parts), message


NET = [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 5]]
POINTS = [[0.5 * i, 1.25 * j, 0.125 * i * j] for j in range(2) for i in range(3)]


@settings(max_examples=100, deadline=None)
@given(data=st.data())
def test_off_numbers_may_be_broken_over_lines_anywhere(data: st.DataObject) -> None:
    words = ["6", "3", "0", *(repr(x) for point in POINTS for x in point)]
    words += [str(x) for face in NET for x in (len(face), *face)]
    spaces = data.draw(
        st.lists(
            st.sampled_from([" ", "\n", "\t", "\r\n", " # 7\n", "\n\n"]),
            min_size=len(words), max_size=len(words),
        )
    )  # fmt: skip
    text = "OFF\n" + "".join(map("".join, zip(words, spaces, strict=True))) + "\n"
    found = read_off(text.encode()).polygons
    assert found.vertices.tolist() == POINTS
    assert found.degrees.tolist() == [4, 4, 3]
    assert found.corners.tolist() == [corner for face in NET for corner in face]


def test_off_that_goes_on_after_its_faces_is_said(content: Content) -> None:
    found = content("a.off", OFF + "3 0 1 2\n3 1 0 2\n")
    assert len(found.polygons.degrees) == 1
    assert ["line 7: the file goes on" in each for each in found.remarks] == [True]
    assert content("b.off", OFF + "3 0 1 2\n\n# the end\n").remarks == ()


@pytest.mark.parametrize("n_rows", range(5))
def test_off_with_rows_missing_is_refused(error_of: ErrorOf, n_rows: int) -> None:
    whole = OFF.replace("3 1 0", "3 2 0") + "3 0 1 2\n3 1 0 2\n"
    cut = "\n".join(whole.split("\n")[: 2 + n_rows]) + "\n"
    assert "the file ends after" in error_of("a.off", cut)
