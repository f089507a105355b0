"""
Where the numbers of a one-faced Brep stand in its stream: parsed from the bytes alone.

The stream is read as openNURBS reads it (layout: `fabrication.opennurbs`), independently of how
it was written. Numbers are not looked at here, only found, so that streams of the same layout
can be judged together.
"""

import struct
from collections.abc import Generator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import BoolArray
from .chunks import ANONYMOUS, CHUNK_HEADER, CLASS, CRC, SHORT_FLAG, Checksum
from .cursor import Buffer, Cursor, UnreadableError
from .panel_breps import (
    ARC_CURVE,
    BOUNDARY_TRIM,
    BREP,
    LINE_CURVE,
    NURBS_CURVE,
    NURBS_SURFACE,
    OUTER_LOOP,
    PLANE_SURFACE,
)
from .render_meshes import MESH, MESH_VERSION

_OBJECT_TABLE = 0x10000013
_OBJECT_RECORD = 0x20008070
_FILE_HEADER = 32


class Curve(NamedTuple):
    """A curve: its class and the places of its domain, points and knots (of NURBS only)."""

    uuid: bytes
    domain: tuple[int, int]
    points: int
    n_points: int
    knots: int = 0
    n_knots: int = 0


class Surface(NamedTuple):
    """A surface: its class and the places of its two knot vectors and of its points."""

    uuid: bytes
    knots: tuple[int, int]
    points: int
    n_points: tuple[int, int]


class Side(NamedTuple):
    """One side of the loop: its trim, its edge, the places of its vertices and domains."""

    trim: Curve
    edge: Curve
    start: int
    end: int
    trim_domain: int
    edge_domain: int


class FaceMesh(NamedTuple):
    """A render mesh: its triangles, the buffers of points and normals, and of exact points."""

    triangles: NDArray[np.unsignedinteger]
    floats: Buffer
    normals: Buffer
    points: Buffer | None


@dataclass(frozen=True)
class BrepLayout:
    """
    Where the numbers of a Brep stand.

    Attributes
    ----------
    surface : Surface
        Its surface.
    sides : tuple of Side
        The sides in the order of the loop.
    is_reversed : bool
        Whether the face looks against the normal of its surface.
    mesh : FaceMesh, optional
        The render mesh.
    checksums : tuple of Checksum
        Its checksums.
    numbers : tuple of (int, int)
        Places and counts of all float64 numbers.
    fixed : (n,) bool array
        The bytes that are neither numbers nor checksums.
    """

    surface: Surface
    sides: tuple[Side, ...]
    is_reversed: bool
    mesh: FaceMesh | None
    checksums: tuple[Checksum, ...]
    numbers: tuple[tuple[int, int], ...]
    fixed: BoolArray


def read_brep_streams(data: bytes) -> list[bytes]:
    """
    Streams of the Breps in a .3dm file, in their order.

    Parameters
    ----------
    data : bytes
        The file; version 5 or later.

    Returns
    -------
    list of bytes
        One stream per Brep, without attributes.
    """
    streams: list[bytes] = []
    for typecode, start, stop in _chunks(data, _FILE_HEADER, len(data)):
        if typecode != _OBJECT_TABLE:
            continue
        for record, begin, end in _chunks(data, start, stop):
            if record != _OBJECT_RECORD:
                continue
            for inner, first, last in _chunks(data, begin, end):
                named = first + CHUNK_HEADER.size
                if inner == CLASS and data[named : named + len(BREP)] == BREP:
                    streams.append(data[first - CHUNK_HEADER.size : last])
    return streams


def _chunks(data: bytes, start: int, stop: int) -> Generator[tuple[int, int, int]]:
    """Type, begin and end of the bodies of consecutive chunks."""
    while start + CHUNK_HEADER.size <= stop:
        typecode, length = CHUNK_HEADER.unpack_from(data, start)
        start += CHUNK_HEADER.size
        length = 0 if typecode & SHORT_FLAG else length
        yield typecode, start, start + length
        start += length


def parse_brep(stream: bytes) -> BrepLayout:
    """
    Layout of a Brep of one face and one loop.

    Parameters
    ----------
    stream : bytes
        The object, as written by `brep_streams` or encoded by openNURBS.

    Returns
    -------
    BrepLayout
        Places of its numbers.

    Raises
    ------
    UnreadableError
        If the stream is cut short, or not a Brep of the kind that spherical panels make:
        trims that are lines or rational quadratics in Bézier spans, edges that are lines or
        arcs, a plane or a rational biquadratic surface in Bézier spans.
    """
    cursor = Cursor(stream)
    with cursor.object() as uuid:
        if uuid != BREP:
            raise UnreadableError("the stream is not a Brep")
        cursor.expect(b"\x33", "Brep version 3.3")
        trim_curves = _curves(cursor)
        edge_curves = _curves(cursor)
        surfaces = _surfaces(cursor)
        vertices = _vertices(cursor)
        edges = _edges(cursor)
        trims = _trims(cursor)
        loop = _loop(cursor)
        is_reversed = _face(cursor)
        cursor.doubles(6)
        with cursor.chunk(ANONYMOUS):
            mesh = _face_mesh(cursor)
        with cursor.chunk(ANONYMOUS):
            cursor.expect(b"\0", "a face without analysis mesh")
        cursor.ints(1)
        with cursor.chunk(ANONYMOUS):
            cursor.ints(2)
            cursor.expect(b"\0", "a Brep without regions")
    if cursor.position != len(stream):
        raise UnreadableError("bytes follow the Brep")
    fixed = np.ones(len(stream), bool)
    for start, count in cursor.numbers:
        fixed[start : start + 8 * count] = False
    for buffer in () if mesh is None else mesh[1:]:
        # Deflated bytes are compared: each stream is then judged on its own.
        if buffer is not None and not buffer.is_deflated:
            fixed[buffer.start : buffer.stop] = False
    for checksum in cursor.checksums:
        fixed[checksum.place : checksum.place + CRC.size] = False
    try:
        sides = tuple(_side(trims[i], edges, trim_curves, edge_curves, vertices) for i in loop)
    except IndexError as error:
        raise UnreadableError("an index points at nothing") from error
    _check_chain(sides, trims, loop, len(surfaces))
    checksums, numbers = tuple(cursor.checksums), tuple(cursor.numbers)
    return BrepLayout(surfaces[0], sides, is_reversed, mesh, checksums, numbers, fixed)


def _curves(cursor: Cursor) -> list[Curve]:
    curves: list[Curve] = []
    with cursor.table() as count:
        for _ in range(count):
            cursor.expect(struct.pack("<i", 1), "a curve")
            with cursor.object() as uuid:
                curves.append(_curve(cursor, uuid))
    return curves


def _curve(cursor: Cursor, uuid: bytes) -> Curve:
    version = cursor.take(1)
    if uuid in (LINE_CURVE, ARC_CURVE):
        count = 6 if uuid == LINE_CURVE else 28
        points = cursor.doubles(count)
        domain = cursor.doubles(2)
        cursor.ints(1)
        return Curve(uuid, (domain, domain + 8), points, count)
    if uuid != NURBS_CURVE:
        raise UnreadableError(f"a curve of unknown class before byte {version}")
    dimension, rational, order, n_points, *_ = cursor.ints(6)
    cursor.doubles(6)
    (n_knots,) = cursor.ints(1)
    knots = cursor.doubles(n_knots)
    (n_written,) = cursor.ints(1)
    if (dimension, rational, order) != (2, 1, 3) or not n_written == n_points == n_knots - 1:
        raise UnreadableError(f"no rational quadratic trim at byte {version}")
    if n_points % 2 == 0 or n_points < 3:
        raise UnreadableError(f"the trim at byte {version} is not made of Bézier spans")
    points = cursor.doubles(3 * n_points)
    if cursor.data[version] & 15:
        cursor.take(1)
    ends = knots, knots + 8 * (n_knots - 1)
    return Curve(uuid, ends, points, n_points, knots, n_knots)


def _surfaces(cursor: Cursor) -> list[Surface]:
    surfaces: list[Surface] = []
    with cursor.table() as count:
        for _ in range(count):
            cursor.expect(struct.pack("<i", 1), "a surface")
            with cursor.object() as uuid:
                cursor.take(1)
                surfaces.append(_surface(cursor, uuid))
    return surfaces


def _surface(cursor: Cursor, uuid: bytes) -> Surface:
    if uuid == PLANE_SURFACE:
        points = cursor.doubles(16)
        domains = cursor.doubles(8)
        return Surface(uuid, (domains, domains + 16), points, (0, 0))
    if uuid != NURBS_SURFACE:
        raise UnreadableError("a surface of unknown class")
    dimension, rational, *orders, n_u, n_v, _, _ = cursor.ints(8)
    cursor.doubles(6)
    places: list[int] = []
    for size in (n_u, n_v):
        (n_knots,) = cursor.ints(1)
        if n_knots != size + 1 or size % 2 == 0 or size < 3:
            raise UnreadableError("the surface is not made of Bézier spans")
        places.append(cursor.doubles(n_knots))
    if (dimension, rational, *orders) != (3, 1, 3, 3) or cursor.ints(1)[0] != n_u * n_v:
        raise UnreadableError("no rational biquadratic surface")
    return Surface(uuid, (places[0], places[1]), cursor.doubles(4 * n_u * n_v), (n_u, n_v))


def _vertices(cursor: Cursor) -> list[int]:
    places: list[int] = []
    with cursor.table() as count:
        for _ in range(count):
            cursor.ints(1)
            places.append(cursor.doubles(3))
            cursor.counted_ints()
            cursor.doubles(1)
    return places


class _Use(NamedTuple):
    """How a trim or edge uses its curve: curve, edge, vertices, place of the domain."""

    curve: int
    edge: int
    ends: tuple[int, int]
    domain: int


def _edges(cursor: Cursor) -> list[_Use]:
    edges: list[_Use] = []
    with cursor.table() as count:
        for _ in range(count):
            index, curve, is_reversed = cursor.ints(3)
            domain = cursor.doubles(2)
            first, last = cursor.ints(2)
            cursor.counted_ints()
            cursor.doubles(3)
            if is_reversed:
                raise UnreadableError(f"edge {index} is reversed")
            edges.append(_Use(curve, index, (first, last), domain))
    return edges


def _trims(cursor: Cursor) -> list[_Use]:
    trims: list[_Use] = []
    with cursor.table() as count:
        for _ in range(count):
            index, curve = cursor.ints(2)
            domain = cursor.doubles(2)
            edge, first, last, is_reversed, kind, _, loop = cursor.ints(7)
            cursor.doubles(4)
            cursor.expect(bytes(32), f"flags of trim {index}")
            cursor.doubles(2)
            if is_reversed or kind != BOUNDARY_TRIM or loop != 0:
                raise UnreadableError(f"trim {index} does not bound the face")
            trims.append(_Use(curve, edge, (first, last), domain))
    return trims


def _loop(cursor: Cursor) -> tuple[int, ...]:
    with cursor.table() as count:
        if count != 1:
            raise UnreadableError(f"{count} loops instead of one")
        cursor.ints(1)
        trims = cursor.counted_ints()
        kind, face = cursor.ints(2)
        if kind != OUTER_LOOP or face != 0:
            raise UnreadableError("the loop does not bound the face from outside")
    return trims


def _face(cursor: Cursor) -> bool:
    with cursor.chunk(ANONYMOUS):
        version = cursor.data[cursor.take(1)]
        (count,) = cursor.ints(1)
        if count != 1 or version not in (0x11, 0x12):
            raise UnreadableError(f"{count} faces instead of one")
        index = cursor.ints(1)
        loops = cursor.counted_ints()
        surface, is_reversed, _ = cursor.ints(3)
        if (*index, *loops, surface) != (0, 0, 0):
            raise UnreadableError("the face does not use the loop and the surface")
        cursor.take(16)
        if version == 0x12:
            cursor.expect(b"\0", "a face without colour")
    return bool(is_reversed)


def _face_mesh(cursor: Cursor) -> FaceMesh | None:
    """Follow ON_Mesh::Read; every part that render meshes of panels lack must be empty."""
    if cursor.data[cursor.take(1)] == 0:
        return None
    with cursor.object() as uuid:
        if uuid != MESH:
            raise UnreadableError("the render mesh is no mesh")
        cursor.expect(MESH_VERSION, "mesh version 3.8")
        n_points, n_faces = cursor.ints(2)
        cursor.take(64 + 16 + 64 + 4)
        cursor.expect(bytes(5), "a mesh without parameters and curvatures")
        (size,) = cursor.ints(1)
        if size not in (1, 2, 4):
            raise UnreadableError(f"vertex ids of {size} bytes in the render mesh")
        place = cursor.take(4 * size * n_faces)
        faces = np.frombuffer(cursor.data, f"<u{size}", 4 * n_faces, place).reshape(-1, 4)
        floats, normals = cursor.buffer(12 * n_points), cursor.buffer(12 * n_points)
        for _ in range(3):
            cursor.buffer(0)
        cursor.take(4 + 16)
        cursor.buffer(0)
        with cursor.chunk(ANONYMOUS):
            cursor.take(160)
        cursor.take(3)
        cursor.expect(b"\0", "a mesh without ngons")
        points = _precise_points(cursor, n_points)
        cursor.take(48)
    if n_faces < 1 or faces.max() >= n_points or (faces[:, 2] != faces[:, 3]).any():
        raise UnreadableError("the render mesh is not made of triangles of its vertices")
    return FaceMesh(faces[:, :3], floats, normals, points)


def _precise_points(cursor: Cursor, n_points: int) -> Buffer | None:
    """The vertices as float64, if they are there."""
    if cursor.data[cursor.take(1)] == 0:
        return None
    with cursor.chunk(ANONYMOUS):
        if cursor.ints(3) != (1, 0, n_points):
            raise UnreadableError("the render mesh has another number of precise vertices")
        return cursor.buffer(24 * n_points)


def _side(
    trim: _Use,
    edges: list[_Use],
    trim_curves: list[Curve],
    edge_curves: list[Curve],
    vertices: list[int],
) -> Side:
    edge = edges[trim.edge]
    if edge.ends != trim.ends or min(*edge.ends, trim.edge, trim.curve, edge.curve) < 0:
        raise UnreadableError("a trim and its edge name different vertices")
    start, end = (vertices[i] for i in edge.ends)
    curves = trim_curves[trim.curve], edge_curves[edge.curve]
    return Side(*curves, start, end, trim.domain, edge.domain)


def _check_chain(
    sides: tuple[Side, ...], trims: list[_Use], loop: tuple[int, ...], n_surfaces: int
) -> None:
    if n_surfaces != 1 or sorted(loop) != list(range(len(trims))) or len(loop) < 2:
        raise UnreadableError("the loop does not use every trim once")
    for side, following in zip(sides, (*sides[1:], sides[0]), strict=True):
        if side.end != following.start:
            raise UnreadableError("the trims of the loop do not follow one another")
        if side.trim.uuid == ARC_CURVE or side.edge.uuid == NURBS_CURVE:
            raise UnreadableError("an edge is not an arc or a line")
