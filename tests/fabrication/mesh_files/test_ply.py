"""PLY files: their dialects and errors."""

import struct
from collections.abc import Callable
from typing import TypeAlias

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.fabrication.polygons import FileContent

Content: TypeAlias = Callable[..., FileContent]
Read: TypeAlias = Callable[..., Mesh]
ErrorOf: TypeAlias = Callable[..., str]
FacesOf: TypeAlias = Callable[[Mesh], list[list[int]]]


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
        ply("binary_big_endian").replace(b"\n", b"\r") + ply_body(">"),
    ],
)
def test_ply_dialects(read: Read, faces_of: FacesOf, content: str | bytes) -> None:
    mesh = read("a.ply", content)
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
        (PLY.replace("property float y", "proprety float y"), ["line 5", "'proprety float y'"]),
        (PLY.replace("element", "Element", 1), ["line 3", "'Element vertex 3'"]),
        (PLY + "9 0 0 0\n9 1 0 0\n9 0 1 0\n3 0 1 2\n", ["line 10", "4 numbers", "names 3"]),
        (PLY + PLY_POINTS + "3 0 1 2 7\n", ["line 13", "5 numbers", "names 4"]),
        (PLY.replace("element face", "element tristrips") + PLY_POINTS, ["strips"]),
        (PLY.replace("\nend_header", "\ncomment end_header"), ["line 1", "end_header"]),
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
    error_of: ErrorOf, content: str | bytes, parts: list[str]
) -> None:
    message = error_of("a.ply", content)
    assert all(part in message for part in parts), message


def test_ply_rows_that_the_header_does_not_count_are_said(content: Content) -> None:
    found = content("a.ply", PLY + PLY_POINTS + "3 0 1 2\n3 1 0 2\n")
    assert len(found.polygons.degrees) == 1
    assert ["line 14: the file goes on" in each for each in found.remarks] == [True]
    whole = ply("binary_little_endian") + ply_body("<")
    assert content("b.ply", whole + b"\n").remarks[:1] != ("the file goes on",)
    assert any("goes on" in each for each in content("c.ply", whole + b"more").remarks)


def test_ply_counts_that_the_file_does_not_hold_allocate_nothing(error_of: ErrorOf) -> None:
    for count in ("4000000000", "900000000000000"):
        for kind in ("vertex 4", "face 2", "strip 1"):
            header = ply("binary_little_endian").replace(
                f"element {kind}".encode(), f"element {kind[:-1]}{count}".encode()
            )
            assert "cut short" in error_of("a.ply", header + ply_body("<"))
