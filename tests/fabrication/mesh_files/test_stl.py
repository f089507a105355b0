"""STL files: shared corners, lost digits and errors."""

import re
import struct
from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.fabrication.polygons import FileContent
from spheremesh.kernel.errors import InputError

Content: TypeAlias = Callable[..., FileContent]
Read: TypeAlias = Callable[..., Mesh]
ErrorOf: TypeAlias = Callable[..., str]
FacesOf: TypeAlias = Callable[[Mesh], list[list[int]]]


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


def test_stl_ascii_corners_are_shared(read: Read, faces_of: FacesOf) -> None:
    mesh = read("a.stl", SOLID)
    assert mesh.n_vertices == 4
    assert faces_of(mesh) == [[0, 1, 2], [1, 3, 2]]


def test_a_binary_stl_may_start_with_solid(
    read: Read, quad_and_triangle: Mesh, tmp_path: Path
) -> None:
    data = write_mesh(quad_and_triangle, tmp_path / "a.stl").read_bytes()
    mesh = read("b.stl", b"solid lie".ljust(80) + data[80:])
    assert (mesh.n_vertices, mesh.n_faces) == (5, 3)


@pytest.mark.parametrize(
    ("content", "parts"),
    [
        ("solid part\n" + FACET.format("zero"), ["line 4", "'zero'"]),
        ("solid part\n" + FACET.format("nan"), ["line 4", "finite"]),
        ("solid part\n" + FACET.format("0 0"), ["line 4", "three coordinates"]),
        (SOLID.replace("vertex 1 1 0\n", ""), ["line 13", "three vertices"]),
        (SOLID[: SOLID.index("vertex 1 1")], ["line 11", "inside a facet"]),
        ("solid part\n" + FACET.format("1") + "endsolid\n", ["line 4", "repeated corner"]),
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
    error_of: ErrorOf, content: str | bytes, parts: list[str]
) -> None:
    message = error_of("a.stl", content)
    assert all(part in message for part in parts), message


def test_stl_refuses_to_merge_vertices_that_float32_cannot_tell_apart(
    quad_and_triangle: Mesh, tmp_path: Path
) -> None:
    mesh = quad_and_triangle
    for vertices in (mesh.vertices + 1e9, mesh.vertices * 1e39):
        with pytest.raises(InputError, match=r"far\.stl: STL keeps 7 digits.* \.3dm"):
            write_mesh(Mesh(vertices, mesh.faces), tmp_path / "far.stl")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "text",
    [
        SOLID.upper(),
        SOLID.replace("\n", " ").replace("solid part ", "solid part\n", 1),
        SOLID.replace("solid part", "Solid vertex facet"),
        SOLID.replace("endsolid part\n", "endsolid"),
        SOLID.replace("\n", "\r\n"),
        SOLID.replace("endfacet", "color 1 0 0\nendfacet"),
    ],
)
def test_stl_capitals_and_line_ends_do_not_matter(
    read: Read, faces_of: FacesOf, text: str
) -> None:
    if "endsolid" not in text.lower().splitlines()[-1]:
        text += "\nendsolid"
    assert faces_of(read("a.stl", text)) == [[0, 1, 2], [1, 3, 2]]


def test_stl_several_solids_are_one_mesh(read: Read) -> None:
    other = re.sub(r"vertex (\S+)", r"vertex 9\1", SOLID)
    assert read("a.stl", SOLID + other).n_faces == 4


def test_stl_text_cut_anywhere_is_refused(error_of: ErrorOf) -> None:
    whole = SOLID[: SOLID.rindex("endsolid") + len("endsolid")]
    for size in range(1, len(whole)):
        assert "a.stl" in error_of("a.stl", whole[:size]), whole[:size]


def test_stl_bytes_cut_anywhere_are_refused(
    quad_and_triangle: Mesh, error_of: ErrorOf, tmp_path: Path
) -> None:
    data = write_mesh(quad_and_triangle, tmp_path / "b.stl").read_bytes()
    for header in (data[:80], b"solid".ljust(80)):
        whole = header + data[80:]
        for size in range(1, len(whole)):
            error_of("a.stl", whole[:size])


def test_stl_bytes_that_the_count_leaves_out_are_said(
    content: Content, quad_and_triangle: Mesh, tmp_path: Path
) -> None:
    data = bytearray(write_mesh(quad_and_triangle, tmp_path / "b.stl").read_bytes())
    data[80] = 2
    found = content("a.stl", bytes(data))
    assert len(found.polygons.degrees) == 2
    assert ["1 more" in each for each in found.remarks] == [True]
