"""Wavefront OBJ: polygons of any degree, groups and objects, vertices counted from 1."""

import re

import numpy as np

from ...kernel.errors import InputError
from ...kernel.meshes.mesh import Mesh
from ..polygons import Polygons, drop_unused
from ..text import decode, face_words, numbered_words, to_floats, to_integers


def read_obj(data: bytes, layer: str = "") -> Polygons:
    """
    Polygons of an OBJ file.

    Parameters
    ----------
    data : bytes
        Content of the file. Only ``v``, ``f``, ``g`` and ``o`` lines are read.
    layer : str
        Read only the faces in groups and objects whose name starts so; empty reads all.

    Returns
    -------
    Polygons
        Faces in the order of the file. All vertices of the file keep their number, used or
        not, unless a layer is asked for: then only the vertices of its faces are kept.

    Raises
    ------
    InputError
        If a line cannot be read or no group or object matches; the message names the line,
        or the groups and objects that there are.
    """
    coordinates: list[str] = []
    vertex_lines: list[int] = []
    corner_words: list[str] = []
    degrees: list[int] = []
    face_lines: list[int] = []
    vertices_before: list[int] = []
    names = {"g": "", "o": ""}
    all_names: list[str] = []
    is_selected = not layer
    for number, words in numbered_words(_join_continued(decode(data))):
        keyword = words[0]
        if keyword == "v":
            if len(words) < 4:
                raise InputError(f"line {number}: a vertex needs three coordinates")
            coordinates += words[1:4]
            vertex_lines.append(number)
        elif keyword == "f" and is_selected:
            corner_words += words[1:]
            degrees.append(len(words) - 1)
            face_lines.append(number)
            vertices_before.append(len(vertex_lines))
        elif keyword in names:
            names[keyword] = " ".join(words[1:])
            all_names.append(names[keyword])
            is_selected = any(_has_prefix(name, layer) for name in names.values())
    if layer and not degrees:
        raise InputError(
            f"no face is in a group or object whose name starts with {layer!r}; the file names "
            + (", ".join(map(repr, dict.fromkeys(filter(None, all_names)))) or "none")
        )
    written = to_integers(_vertex_words(corner_words), face_lines, degrees)
    # Negative numbers count back from the last vertex before the face.
    before = np.repeat(np.array(vertices_before, np.int64), degrees)
    polygons = Polygons(
        to_floats(coordinates, vertex_lines, 3),
        np.where(written < 0, before + written, written - 1),
        np.array(degrees, np.int64),
        vertex_lines,
        face_lines,
    )
    return drop_unused(polygons) if layer else polygons


def _join_continued(text: str) -> str:
    """Join lines that end in a backslash, and keep the count of the lines."""
    if "\\\n" not in text:
        return text

    def join(statement: re.Match[str]) -> str:
        return statement[0].replace("\\\n", " ") + "\n" * statement[0].count("\n")

    return re.sub(r"(?:[^\n]*\\\n)+[^\n]*", join, text)


def _has_prefix(name: str, prefix: str) -> bool:
    # A group line may list several groups, or be one name that holds spaces.
    return any(each.startswith(prefix) for each in (name, *name.split()))


def _vertex_words(corner_words: list[str]) -> list[str]:
    """The vertex of corners written as vertex/texture/normal."""
    if any("/" in word for word in corner_words):
        return [word.partition("/")[0] for word in corner_words]
    return corner_words


def format_obj(mesh: Mesh) -> bytes:
    """
    A mesh as an OBJ file.

    Parameters
    ----------
    mesh : Mesh
        The mesh.

    Returns
    -------
    bytes
        Content of the file; coordinates with all the digits that a float64 needs.
    """
    vertices = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    faces = [f"f {words}" for words in face_words(mesh, first=1)]
    return "\n".join([*vertices, *faces, ""]).encode()
