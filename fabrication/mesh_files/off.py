"""Object File Format (OFF): polygons of any degree, vertices counted from 0."""

import re
from collections.abc import Iterator
from itertools import islice

from ...kernel.errors import InputError
from ...kernel.meshes.mesh import Mesh
from ..polygons import Polygons
from ..text import TextPolygons, decode, face_words, numbered_words, to_count

_KEYWORD = re.compile(r"(ST)?C?N?OFF")
"""Texture coordinates, colours and normals follow the point on its line and are ignored."""


def read_off(data: bytes) -> Polygons:
    """Polygons of an ascii OFF file (also COFF, NOFF, STOFF).

    Parameters
    ----------
    data : bytes
        Content of the file: keyword, counts, one vertex a line, one face a line. Colours are
        ignored.

    Returns
    -------
    Polygons
        Faces in the order of the file; all vertices, used or not.

    Raises
    ------
    InputError
        If a line cannot be read or lines are missing; the message names the line.
    """
    rows = numbered_words(decode(data))
    n_vertices, n_faces = _read_counts(rows)
    found = TextPolygons()
    for number, words in islice(rows, n_vertices):
        found.add_vertex(number, words)
    for number, words in islice(rows, n_faces):
        degree = to_count(words[0])
        if not 0 <= degree < len(words):
            raise InputError(
                f"line {number}: a face is its number of corners and so many vertices, not "
                f"{' '.join(words)!r}; export the mesh again"
            )
        found.add_face(number, words[1 : 1 + degree])
    vertex_lines, face_lines = found.vertex_lines, found.face_lines
    if len(vertex_lines) + len(face_lines) < n_vertices + n_faces:
        raise InputError(
            f"line {[1, *vertex_lines, *face_lines][-1]}: the file ends after "
            f"{len(vertex_lines)} of {n_vertices} vertices and {len(face_lines)} of {n_faces} "
            "faces; export the mesh again"
        )
    return found.polygons()


def _read_counts(rows: Iterator[tuple[int, list[str]]]) -> tuple[int, int]:
    """Numbers of vertices and faces, behind the keyword or on the line below it."""
    number, words = next(rows, (1, [""]))
    if _KEYWORD.fullmatch(words[0]):
        words = words[1:]
        if not words:
            number, words = next(rows, (number, words))
    elif to_count(words[0]) < 0:
        raise InputError(f"line {number}: expected OFF, not {words[0]!r}; save as ascii OFF")
    counts = [to_count(word) for word in words[:2]]
    if len(counts) < 2 or min(counts) < 0:
        raise InputError(
            f"line {number}: expected the numbers of vertices, faces and edges, not "
            f"{' '.join(words)!r}; save as ascii OFF"
        )
    return counts[0], counts[1]


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
