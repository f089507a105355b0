"""Object File Format (OFF): polygons of any degree, vertices counted from 0."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice, product
from typing import Final

from ...kernel.errors import InputError
from ...kernel.meshes.mesh import Mesh
from ..polygons import FileContent, Polygons
from ..text import (
    TextPolygons,
    decode,
    face_words,
    numbered_words,
    significant_digits,
    to_count,
    unended,
)
from .mending import Source, mended

_KEYWORD: Final = re.compile(r"(ST)?(C)?(N)?(4)?(n)?(OFF|off)")
"""What follows the point on its line: texture coordinates, colours, normals."""

_HEADER_ROWS: Final = 5
"""Keyword, three counts, and one more row, at most."""

_Row = tuple[int, list[str]]


@dataclass(frozen=True)
class _Header:
    n_vertices: int
    n_faces: int
    line: int
    n_rows: int
    widths: tuple[int, ...]  # numbers of a vertex, where rows are broken
    behind: tuple[str, ...]  # what stands behind the counts on their line
    has_edges: bool  # whether the number of edges was among them


def read_off(data: bytes) -> FileContent:
    """Polygons of an ascii OFF file (also COFF, NOFF, STOFF).

    Parameters
    ----------
    data : bytes
        Content of the file: keyword, counts, vertices, faces. One row a line, or numbers
        broken over lines anywhere; the keyword may run into the counts. Colours, normals and
        texture coordinates are left out.

    Returns
    -------
    FileContent
        Faces in the order of the file; all vertices, used or not, unless every face has
        vertices of its own.

    Raises
    ------
    InputError
        If a line cannot be read or lines are missing; the message names the line.
    """
    text = decode(data)
    header = _read_header(list(islice(numbered_words(text), _HEADER_ROWS)))
    found, fault, behind = _read_rows(islice(numbered_words(text), header.n_rows, None), header)
    polygons = None if fault or behind else _tidy(found, header)
    if polygons is None:
        # Perhaps not one row a line, but numbers wherever lines end.
        broken = _read_stream(list(islice(numbered_words(text), header.n_rows, None)), header)
        if broken is None and fault:
            raise InputError(fault)
        found, behind = (broken, 0) if broken else (found, behind)
        polygons = found.polygons()
    remarks: tuple[str, ...] = ()
    if behind:
        remarks = (
            f"line {behind}: the file goes on after the {header.n_faces} faces that it counts; "
            f"what follows is left out: check the counts on line {header.line}",
        )
    source = Source(significant_digits(found.coordinates), has_end=not unended(data))
    return mended(polygons, source, remarks)


def _read_header(rows: list[_Row]) -> _Header:
    """Counts behind the keyword or below it."""
    number, words = rows[0] if rows else (1, [""])
    keyword = _KEYWORD.match(words[0])
    widths = (3,)
    if keyword:
        if keyword[4] or keyword[5]:
            raise InputError(
                f"line {number}: {keyword[0]} holds points of other than three coordinates; "
                "save as ascii OFF"
            )
        widths = _widths(keyword)
        glued = words[0][keyword.end() :]
        words = [*([glued] if glued else []), *words[1:]]
    elif to_count(words[0]) < 0:
        raise InputError(f"line {number}: expected OFF, not {words[0]!r}; save as ascii OFF")
    at = 1
    counts, behind = words[:3], words[3:]
    while len(counts) < 3 and at < len(rows) and _has_more_counts(counts, rows[at]):
        number, words = rows[at]
        at += 1
        counts, behind = [*counts, *words][:3], words[3 - len(counts) :]
    numbers = [to_count(word) for word in counts[:2]]
    if len(numbers) < 2 or min(numbers) < 0:
        raise InputError(
            f"line {number}: expected the numbers of vertices, faces and edges, not "
            f"{' '.join(counts)[:60]!r}; save as ascii OFF"
        )
    return _Header(numbers[0], numbers[1], number, at, widths, tuple(behind), len(counts) > 2)


def _has_more_counts(counts: list[str], row: _Row) -> bool:
    """The number of edges may be missing: then the next line is a point."""
    return len(counts) < 2 or len(row[1]) == 1


def _widths(keyword: re.Match[str]) -> tuple[int, ...]:
    known = 3 + 2 * bool(keyword[1]) + 3 * bool(keyword[3])
    return (known + 4, known + 3) if keyword[2] else (known,)


def _read_rows(rows: Iterator[_Row], header: _Header) -> tuple[TextPolygons, str, int]:
    """One row a line: what could be read, what is wrong with the row after it, and its line."""
    n_vertices, n_faces = header.n_vertices, header.n_faces
    found = TextPolygons()
    line = header.line
    for line, words in islice(rows, n_vertices):
        if len(words) < 3:
            return found, f"line {line}: a vertex needs three coordinates", line
        found.add_vertex(line, words)
    for line, words in islice(rows, n_faces):
        degree = to_count(words[0])
        if not 0 <= degree < len(words):
            fault = (
                f"line {line}: a face is its number of corners and so many vertices, not "
                f"{' '.join(words)[:60]!r}; export the mesh again"
            )
            return found, fault, line
        found.add_face(line, words[1 : 1 + degree])
    if len(found.vertex_lines) + len(found.face_lines) == n_vertices + n_faces:
        return found, "", next((number for number, _ in rows), 0)
    fault = (
        f"line {line}: the file ends after {len(found.vertex_lines)} of {n_vertices} vertices "
        f"and {len(found.face_lines)} of {n_faces} faces; export the mesh again"
    )
    return found, fault, line


def _tidy(found: TextPolygons, header: _Header) -> Polygons | None:
    """The polygons, if they are what rows on lines of their own give."""
    try:
        polygons = found.polygons()
    except InputError:
        return None
    corners, degrees = polygons.corners, polygons.degrees
    is_sound = ((corners >= 0) & (corners < header.n_vertices)).all() and (degrees > 2).all()
    return polygons if is_sound else None


def _read_stream(rows: list[_Row], header: _Header) -> TextPolygons | None:
    """Numbers wherever lines end, if they can be read so in full.

    A face may be followed by its colour to the end of the line, or no face is.
    """
    rest = [(header.line, header.behind), *rows]
    flat = [word for _, words in rest for word in words]
    lines = [number for number, words in rest for _ in words]
    starts = (0,) if header.has_edges else (0, 1)
    for start, width, has_colors in product(starts, header.widths, (False, True)):
        found = _read_numbers(flat[start:], lines[start:], header, width, has_colors=has_colors)
        if found:
            return found
    return None


def _read_numbers(
    flat: list[str], lines: list[int], header: _Header, width: int, *, has_colors: bool
) -> TextPolygons | None:
    found = TextPolygons()
    at = header.n_vertices * width
    if at > len(flat):
        return None
    for start in range(0, at, width):
        found.add_vertex(lines[start], flat[start : start + 3])
    for _ in range(header.n_faces):
        degree = to_count(flat[at]) if at < len(flat) else -1
        corners = flat[at + 1 : at + 1 + degree]
        if degree < 3 or len(corners) < degree:
            return None
        if not all(0 <= to_count(word) < header.n_vertices for word in corners):
            return None
        found.add_face(lines[at], corners)
        at += 1 + degree
        while has_colors and at < len(flat) and lines[at] == lines[at - 1]:
            at += 1
    return found if at == len(flat) else None


def format_off(mesh: Mesh) -> bytes:
    """A mesh as an OFF file.

    Returns
    -------
    bytes
        Content of the file; coordinates with all the digits that a float64 needs.
    """
    vertices = [f"{x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    rows = zip(mesh.degrees.tolist(), face_words(mesh, first=0), strict=True)
    faces = [f"{degree} {words}" for degree, words in rows]
    header = ["OFF", f"{mesh.n_vertices} {mesh.n_faces} 0"]
    return "\n".join([*header, *vertices, *faces, ""]).encode()
