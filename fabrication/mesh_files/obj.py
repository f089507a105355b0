"""Wavefront OBJ: polygons of any degree, groups and objects, vertices counted from 1."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from ...kernel.arrays import BoolArray
from ...kernel.errors import InputError
from ...kernel.meshes.mesh import Mesh
from ..polygons import FileContent, Polygons, drop_unused
from ..text import (
    TextPolygons,
    decode,
    face_words,
    numbered_words,
    significant_digits,
    unended,
)
from .groups import Names, faces_of_groups
from .mending import Source, mended

_FACES: Final = ("f", "fo")
"""Faces; ``fo`` is the older word."""
_SHAPES: Final = {
    "surf": "free-form surface", "curv": "free-form curve",
    "l": "line element", "p": "point element",
}  # fmt: skip
_SKIPPED: Final = frozenset((
    "vt", "vn", "vp", "curv2", "cstype", "deg", "bmat", "step", "parm", "trim", "hole", "scrv",
    "sp", "end", "con", "mg", "s", "lod", "bevel", "c_interp", "d_interp", "ctech", "stech",
    "shadow_obj", "trace_obj", "mtllib", "usemtl", "maplib", "usemap",
))  # fmt: skip
"""Statements that say nothing of polygons."""


@dataclass
class _Statements(TextPolygons):
    """Polygons, and what else an OBJ file states.

    Attributes
    ----------
    vertices_before : list of int
        Vertices that stand before each face.
    names : list of tuple
        Objects and groups, each time that one is named; the first names none.
    face_names : list of int
        Place in `names` for each face.
    others : dict of str to list of int
        Lines of the keywords that are no polygons.
    """

    vertices_before: list[int] = field(default_factory=list[int])
    names: list[Names] = field(default_factory=lambda: [("", "")])
    face_names: list[int] = field(default_factory=list[int])
    others: dict[str, list[int]] = field(default_factory=dict[str, list[int]])

    def add(self, number: int, words: list[str]) -> None:
        """Add a statement; its word may have capitals."""
        keyword = words[0].lower()
        if keyword == "v":
            self.add_vertex(number, words[1:])
        elif keyword in _FACES:
            # The vertex of corners written as vertex/texture/normal.
            self.add_face(number, [word.partition("/")[0] for word in words[1:]])
            self.vertices_before.append(len(self.vertex_lines))
            self.face_names.append(len(self.names) - 1)
        elif keyword == "o":
            self.names.append((" ".join(words[1:]), self.names[-1][1]))
        elif keyword == "g":
            self.names.append((self.names[-1][0], " ".join(words[1:])))
        elif keyword not in _SKIPPED:
            self.others.setdefault(keyword, []).append(number)


def read_obj(data: bytes, layer: str | Sequence[str] = "") -> FileContent:
    """Polygons of an OBJ file.

    Parameters
    ----------
    data : bytes
        Content of the file. Only ``v``, ``f``, ``g`` and ``o`` lines are read.
    layer : str or sequence of str
        Read only the faces in groups and objects of these names, see `faces_of_groups`; a
        string may list several with commas. Empty reads all.

    Returns
    -------
    FileContent
        Faces in the order of the file. All vertices of the file keep their number, used or
        not, unless a layer is asked for, then only the vertices of its faces are kept, or
        every face has vertices of its own.

    Raises
    ------
    InputError
        If a line cannot be read, the file holds no faces or no group or object matches; the
        message names the line, what the file holds, or the groups and objects.
    """
    found = _Statements()
    number, words = 0, [""]
    for number, words in numbered_words(_join_continued(decode(data))):
        found.add(number, words)
    if unended(data) and words[0].lower() in _FACES and found.degrees[-1] < 3:
        raise InputError(
            f"line {number}: the file is cut off in its last face; export the mesh again"
        )
    if not found.degrees:
        raise InputError(_no_faces(found.others))
    polygons = _counted_from_zero(found)
    if layer:
        is_kept = faces_of_groups(found.names, found.face_names, layer)
        polygons = drop_unused(_only(polygons, is_kept))
    source = Source(significant_digits(found.coordinates), has_end=not unended(data))
    return mended(polygons, source, tuple(_left_out(found.others)))


def _counted_from_zero(found: _Statements) -> Polygons:
    """Negative numbers count back from the last vertex before the face."""
    polygons = found.polygons()
    before = np.repeat(np.array(found.vertices_before, np.int64), found.degrees)
    written = polygons.corners
    return replace(polygons, corners=np.where(written < 0, before + written, written - 1))


def _only(polygons: Polygons, is_kept: BoolArray) -> Polygons:
    is_corner_kept = np.repeat(is_kept, polygons.degrees)
    return replace(
        polygons,
        corners=polygons.corners[is_corner_kept],
        degrees=polygons.degrees[is_kept],
        face_lines=np.asarray(polygons.face_lines)[is_kept],
    )


def _shapes(others: dict[str, list[int]]) -> str:
    """How many shapes there are that are no polygons, by kind."""
    counts = {what: len(others[key]) for key, what in _SHAPES.items() if key in others}
    return " and ".join(f"{n} {what}{'s' * (n > 1)}" for what, n in counts.items())


def _no_faces(others: dict[str, list[int]]) -> str:
    cure = "export the model as a polygon mesh"
    held = _shapes(others)
    if not held:
        return "; ".join(["the file has no faces", *_unknown(others), cure])
    first = min(others[key][0] for key in _SHAPES if key in others)
    if "surf" in others:
        cure += ", or the surface as .3dm"
    return f"line {first}: the file has no faces, but {held}; {cure}"


def _left_out(others: dict[str, list[int]]) -> list[str]:
    """Sentences on shapes that are no polygons, and on words that are none of OBJ's."""
    held = _shapes(others)
    said = [f"left out: {held}; only faces (f) are read"] if held else []
    return [*said, *_unknown(others)]


def _unknown(others: dict[str, list[int]]) -> list[str]:
    unknown = {word: lines for word, lines in others.items() if word not in _SHAPES}
    if not unknown:
        return []
    word, lines = next(iter(unknown.items()))
    count = sum(map(len, unknown.values()))
    what = "line was" if count == 1 else "lines were"
    return [
        f"line {lines[0]}: {word[:40]!r} is no statement of an OBJ file that is read; "
        f"{count} such {what} left out"
    ]


def _join_continued(text: str) -> str:
    """Join lines that end in a backslash, and keep the count of the lines."""
    if "\\" not in text:
        return text
    joined: list[str] = []
    held: list[str] = []
    for line in text.split("\n"):
        held.append(line)
        # A comment may end in the name of a folder of Windows.
        if not line.rstrip().endswith("\\") or line.lstrip().startswith("#"):
            joined += [" ".join(part.rstrip().removesuffix("\\") for part in held)]
            joined += [""] * (len(held) - 1)
            held = []
    return "\n".join([*joined, *held])


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
