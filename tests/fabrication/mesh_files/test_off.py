"""OFF files: their dialects and errors."""

from collections.abc import Callable
from typing import TypeAlias

import pytest

from spheremesh import Mesh

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
    error_of: ErrorOf, content: str | bytes, parts: list[str]
) -> None:
    message = error_of("a.off", content)
    assert all(part in message for part in parts), message
