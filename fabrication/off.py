"""Object File Format (OFF): polygons of any degree, vertices counted from 0."""

import re

import numpy as np

from ..kernel.errors import InputError
from ..kernel.mesh import Mesh
from .polygons import Polygons, decode, face_words, numbered_words, to_floats, to_integers

_KEYWORD = re.compile(r"(ST)?C?N?OFF")
"""Texture coordinates, colours and normals follow the point on its line and are ignored."""


def read_off(data: bytes) -> Polygons:
    """
    Polygons of an ascii OFF file (also COFF, NOFF, STOFF).

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
    rows = list(numbered_words(decode(data)))
    if not rows:
        raise InputError("the file is blank; export the mesh again")
    number, words = rows[0]
    if _KEYWORD.fullmatch(words[0]):
        rows[:1] = [(number, words[1:])] if words[1:] else []
    elif not words[0].isdigit():
        raise InputError(f"line {number}: expected OFF, not {words[0]!r}; save as ascii 3D OFF")
    n_vertices, n_faces = _read_counts(rows, number)
    vertex_rows = rows[1 : 1 + n_vertices]
    face_rows = rows[1 + n_vertices : 1 + n_vertices + n_faces]
    if len(face_rows) < n_faces:
        raise InputError(
            f"line {rows[-1][0]}: the file ends after {len(rows) - 1} of {n_vertices} vertices "
            f"and {n_faces} faces; export the mesh again"
        )
    for number, words in vertex_rows:
        if len(words) < 3:
            raise InputError(f"line {number}: a vertex needs three coordinates")
    vertex_lines = [number for number, _ in vertex_rows]
    face_lines = [number for number, _ in face_rows]
    coordinates = [word for _, words in vertex_rows for word in words[:3]]
    first_words = [words[0] for _, words in face_rows]
    degrees = to_integers(first_words, face_lines, np.ones(n_faces, np.int64))
    corner_words: list[str] = []
    for degree, (number, words) in zip(degrees.tolist(), face_rows, strict=True):
        if not 0 <= degree < len(words):
            raise InputError(
                f"line {number}: the face announces {degree} corners and lists {len(words) - 1}"
                "; export the mesh again"
            )
        corner_words += words[1 : 1 + degree]
    return Polygons(
        to_floats(coordinates, vertex_lines, 3),
        to_integers(corner_words, face_lines, degrees),
        degrees,
        vertex_lines,
        face_lines,
    )


def _read_counts(rows: list[tuple[int, list[str]]], line: int) -> tuple[int, int]:
    number, words = rows[0] if rows else (line, [])
    if len(words) < 2 or not all(word.isdigit() for word in words[:2]):
        raise InputError(f"line {number}: expected the numbers of vertices, faces and edges")
    return int(words[0]), int(words[1])


def format_off(mesh: Mesh) -> bytes:
    """
    A mesh as an OFF file.

    Parameters
    ----------
    mesh : Mesh
        The mesh.

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
