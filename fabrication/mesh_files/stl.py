"""STL: separate triangles, ascii or binary; coordinates of binary files are float32."""

import re
from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import FloatArray, IntArray, norm
from ...kernel.errors import InputError, name_ids
from ...kernel.meshes.mesh import Mesh
from ..polygons import FileContent, Polygons, weld
from ..text import decode, numbered_words, significant_digits, to_floats
from ..triangles import fan_triangles
from .mending import SINGLE, Source, mended

_AGAIN = "export the mesh again"
_HEADER = 80
_SOLID: Final = re.compile(rb"\s*solid\b", re.IGNORECASE)
_KEYWORDS: Final = frozenset(
    ("facet", "outer", "vertex", "endloop", "endfacet", "endsolid", "solid")
)
_RECORD = np.dtype(
    [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")], align=False
)


def read_stl(data: bytes) -> FileContent:
    """Triangles of an ascii or binary STL file, joined where their corners are equal.

    Parameters
    ----------
    data : bytes
        Content of the file; keywords may have capitals.

    Returns
    -------
    FileContent
        Triangles in the order of the file; vertices in order of first appearance.

    Raises
    ------
    InputError
        If a line cannot be read or the file is cut short.
    """
    count = int.from_bytes(data[_HEADER : _HEADER + 4], "little")
    size = _HEADER + 4 + count * _RECORD.itemsize
    # Binary files may start with "solid" too: the exact size tells, or a byte of no text.
    if _SOLID.match(data) and len(data) != size and b"\0" not in data:
        return _read_ascii(data)
    if len(data) < size or len(data) < _HEADER + 4:
        raise InputError(
            f"the file is cut short: {count} triangles need {size} bytes, it has {len(data)}; "
            f"{_AGAIN}"
        )
    records = np.frombuffer(data, _RECORD, count, _HEADER + 4)
    with np.errstate(invalid="ignore"):  # a signalling NaN; refused below
        points = records["corners"].reshape(-1, 3).astype(np.float64)
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        faces = name_ids(np.unique(bad // 3).tolist())
        raise InputError(f"faces {faces} have coordinates that are not finite; {_AGAIN}")
    remarks: tuple[str, ...] = ()
    if len(data) - size >= _RECORD.itemsize:
        remarks = (
            f"the file counts {count} triangles and has bytes for "
            f"{(len(data) - size) // _RECORD.itemsize} more, which are left out; {_AGAIN}",
        )
    source = Source(SINGLE, is_soup=True)
    return mended(_triangles(points, np.zeros(0, np.int64)), source, remarks)


def _read_ascii(data: bytes) -> FileContent:
    words: list[str] = []
    lines: list[int] = []
    number = n_joined = 0
    is_open = {"facet": False, "solid": False}
    for number, keyword, rest in _statements(data):
        if keyword == "vertex":
            if len(rest) != 3:
                raise InputError(f"line {number}: a vertex needs three coordinates")
            words += rest
            lines.append(number)
        elif keyword == "endloop":
            if len(lines) != n_joined + 3:
                raise InputError(f"line {number}: the loop has not three vertices; {_AGAIN}")
            n_joined = len(lines)
        elif keyword.removeprefix("end") in is_open:
            is_open[keyword.removeprefix("end")] = not keyword.startswith("end")
    if len(lines) != n_joined:
        raise InputError(f"line {number}: the file ends inside a facet; {_AGAIN}")
    points = _finite_points(words, lines)
    for what, is_cut in is_open.items():
        if is_cut:
            raise InputError(f"line {number}: the file is cut short before end{what}; {_AGAIN}")
    source = Source(significant_digits(words), is_soup=True)
    return mended(_triangles(points, np.array(lines[::3], np.int64)), source)


def _finite_points(words: list[str], lines: list[int]) -> FloatArray:
    points = to_floats(words, lines, 3)
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        raise InputError(f"line {lines[bad[0]]}: the coordinates are not finite; {_AGAIN}")
    return points


def _statements(data: bytes) -> Iterator[tuple[int, str, list[str]]]:
    """Line, keyword in small letters and words behind it; a line may hold several."""
    for number, row in numbered_words(decode(data)):
        keyword = row[0].lower()
        if len(row) == 1 or keyword in ("solid", "endsolid"):
            starts = [0]  # the name of a solid may be any words
        elif keyword == "vertex" and len(row) == 4:
            starts = [0]
        else:
            starts = [i for i, word in enumerate(row) if word.lower() in _KEYWORDS]
        for start, end in zip(starts, [*starts[1:], len(row)], strict=False):
            yield number, row[start].lower(), row[start + 1 : end]


def _triangles(points: FloatArray, lines: IntArray) -> Polygons:
    """Each with vertices of its own."""
    n_triangles = len(points) // 3
    return Polygons(points, np.arange(3 * n_triangles), np.full(n_triangles, 3), (), lines)


def format_stl(mesh: Mesh) -> bytes:
    """A mesh as a binary STL file; faces with more than three corners are cut into triangles.

    Returns
    -------
    bytes
        Content of the file.

    Raises
    ------
    InputError
        If vertices that differ would become one in float32.
    """
    triangles, _ = fan_triangles(mesh)
    with np.errstate(over="ignore"):
        rounded = mesh.vertices.astype("<f4")
    if not np.isfinite(rounded).all() or _n_distinct(rounded) < _n_distinct(mesh.vertices):
        raise InputError(
            "STL keeps 7 digits, too few for this mesh: move it to the origin, or write "
            ".obj, .off, .ply or .3dm"
        )
    corners = mesh.vertices[triangles]
    crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = norm(crosses)[:, None]
    records = np.zeros(len(triangles), _RECORD)
    # A triangle without area has the normal (0, 0, 0), by the convention of the format.
    records["normal"] = crosses / np.where(lengths > 0, lengths, 1)
    records["corners"] = rounded[triangles]
    return bytes(_HEADER) + len(triangles).to_bytes(4, "little") + records.tobytes()


def _n_distinct(points: NDArray[np.floating]) -> int:
    return len(weld(points.astype(np.float64))[0])
