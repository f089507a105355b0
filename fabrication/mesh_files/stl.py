"""STL: separate triangles, ascii or binary; coordinates of binary files are float32."""

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import FloatArray, IntArray, norm
from ...kernel.errors import InputError, name_ids
from ...kernel.meshes.mesh import Mesh
from ..polygons import Polygons, weld
from ..text import decode, numbered_words, to_floats
from ..triangles import fan_triangles

_AGAIN = "export the mesh again"
_HEADER = 80
_RECORD = np.dtype(
    [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")], align=False
)


def read_stl(data: bytes) -> Polygons:
    """Triangles of an ascii or binary STL file, joined where their corners are equal.

    Parameters
    ----------
    data : bytes
        Content of the file.

    Returns
    -------
    Polygons
        Triangles in the order of the file; vertices in order of first appearance.

    Raises
    ------
    InputError
        If a line cannot be read or the file is cut short.
    """
    count = int.from_bytes(data[_HEADER : _HEADER + 4], "little")
    size = _HEADER + 4 + count * _RECORD.itemsize
    # Binary files may start with "solid" too: the exact size tells.
    if data.lstrip().startswith(b"solid") and len(data) != size:
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
    return _joined(points, np.zeros(0, np.int64))


def _read_ascii(data: bytes) -> Polygons:
    words: list[str] = []
    lines: list[int] = []
    number = n_joined = 0
    for number, row in numbered_words(decode(data)):
        if row[0] == "vertex":
            if len(row) != 4:
                raise InputError(f"line {number}: a vertex needs three coordinates")
            words += row[1:]
            lines.append(number)
        elif row[0] == "endloop":
            if len(lines) != n_joined + 3:
                raise InputError(f"line {number}: the loop has not three vertices; {_AGAIN}")
            n_joined = len(lines)
    if len(lines) != n_joined:
        raise InputError(f"line {number}: the file ends inside a facet; {_AGAIN}")
    points = to_floats(words, lines, 3)
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        raise InputError(f"line {lines[bad[0]]}: the coordinates are not finite; {_AGAIN}")
    return _joined(points, np.array(lines[::3], np.int64))


def _joined(points: FloatArray, lines: IntArray) -> Polygons:
    vertices, corners = weld(points)
    return Polygons(vertices, corners, np.full(len(corners) // 3, 3), (), lines)


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
