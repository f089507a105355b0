"""Wavefront OBJ: polygons of any degree, groups and objects, vertices counted from 1."""

import re
from dataclasses import replace

import numpy as np

from ...kernel.errors import InputError
from ...kernel.meshes.mesh import Mesh
from ..polygons import Polygons, drop_unused
from ..text import TextPolygons, decode, face_words, numbered_words


def read_obj(data: bytes, layer: str = "") -> Polygons:
    """Polygons of an OBJ file.

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
    found = TextPolygons()
    vertices_before: list[int] = []
    names = {"g": "", "o": ""}
    all_names: list[str] = []
    is_selected = not layer
    for number, words in numbered_words(_join_continued(decode(data))):
        keyword = words[0]
        if keyword == "v":
            found.add_vertex(number, words[1:])
        elif keyword == "f" and is_selected:
            # The vertex of corners written as vertex/texture/normal.
            found.add_face(number, [word.partition("/")[0] for word in words[1:]])
            vertices_before.append(len(found.vertex_lines))
        elif keyword in names:
            names[keyword] = " ".join(words[1:])
            all_names.append(names[keyword])
            is_selected = any(_has_prefix(name, layer) for name in names.values())
    if layer and not found.degrees:
        raise InputError(
            f"no face is in a group or object whose name starts with {layer!r}; the file names "
            + (", ".join(map(repr, dict.fromkeys(filter(None, all_names)))) or "none")
        )
    polygons = found.polygons()
    # Negative numbers count back from the last vertex before the face.
    before = np.repeat(np.array(vertices_before, np.int64), found.degrees)
    written = polygons.corners
    polygons = replace(polygons, corners=np.where(written < 0, before + written, written - 1))
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


def format_obj(mesh: Mesh) -> bytes:
    """A mesh as an OBJ file.

    Returns
    -------
    bytes
        Content of the file; coordinates with all the digits that a float64 needs.
    """
    vertices = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    faces = [f"f {words}" for words in face_words(mesh, first=1)]
    return "\n".join([*vertices, *faces, ""]).encode()
