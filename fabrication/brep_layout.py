"""
Where the numbers of a one-faced Brep stand in its stream: parsed from the bytes alone.

The stream is read as openNURBS reads it (layout: `fabrication.opennurbs`), independently of how
it was written. Numbers are not looked at here, only found, so that streams of the same layout
can be judged together.
"""

import struct
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..kernel.arrays import BoolArray
from .opennurbs import (
    ANONYMOUS,
    ARC_CURVE,
    BOUNDARY_TRIM,
    BREP,
    CHUNK_HEADER,
    CLASS,
    CLASS_DATA,
    CLASS_END,
    CLASS_UUID,
    CRC,
    CRC_FLAG,
    LINE_CURVE,
    NURBS_CURVE,
    NURBS_SURFACE,
    OUTER_LOOP,
    PLANE_SURFACE,
    SHORT_FLAG,
    Checksum,
)

_OBJECT_TABLE = 0x10000013
_OBJECT_RECORD = 0x20008070
_FILE_HEADER = 32


class UnreadableError(Exception):
    """A stream that is not a sound `ON_Brep` of one face; the message says where."""


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
    checksums: tuple[Checksum, ...]
    numbers: tuple[tuple[int, int], ...]
    fixed: BoolArray


class _Cursor:
    """Reads a stream from front to back and notes where numbers and checksums stand."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.position = 0
        self.limit = len(data)
        self.checksums: list[Checksum] = []
        self.own: list[tuple[int, int]] = []
        self.begin = 0
        self.numbers: list[tuple[int, int]] = []

    def take(self, count: int) -> int:
        start = self.position
        if not 0 <= count <= self.limit - start:
            raise UnreadableError(f"the stream is cut short at byte {start}")
        self.position += count
        return start

    def ints(self, count: int) -> tuple[int, ...]:
        start = self.take(4 * count)
        return struct.unpack_from(f"<{count}i", self.data, start)

    def doubles(self, count: int) -> int:
        start = self.take(8 * count)
        self.numbers.append((start, count))
        return start

    def counted_ints(self) -> tuple[int, ...]:
        return self.ints(self.ints(1)[0])

    def expect(self, expected: bytes, name: str) -> None:
        start = self.take(len(expected))
        if self.data[start : self.position] != expected:
            raise UnreadableError(f"{name} expected at byte {start}")

    @contextmanager
    def chunk(self, typecode: int) -> Generator[None]:
        start = self.take(CHUNK_HEADER.size)
        found, length = CHUNK_HEADER.unpack_from(self.data, start)
        if found != typecode:
            raise UnreadableError(f"chunk {typecode:#x} expected at byte {start}")
        tail = CRC.size if typecode & CRC_FLAG else 0
        if not tail <= length <= self.limit - self.position:
            raise UnreadableError(f"the chunk at byte {start} reaches beyond its end")
        outer_limit, outer_own = self.limit, [*self.own, (self.begin, start)]
        self.limit = self.position + length - tail
        self.own, self.begin = [], self.position
        yield
        if self.position != self.limit:
            raise UnreadableError(f"the chunk at byte {start} has bytes left over")
        if tail:
            ranges = (*self.own, (self.begin, self.position))
            self.checksums.append(Checksum(self.position, ranges))
        self.limit, self.own = outer_limit, outer_own
        self.take(tail)
        self.begin = self.position

    @contextmanager
    def object(self) -> Generator[bytes]:
        with self.chunk(CLASS):
            with self.chunk(CLASS_UUID):
                start = self.take(16)
            with self.chunk(CLASS_DATA):
                yield self.data[start : start + 16]
            self.expect(CHUNK_HEADER.pack(CLASS_END, 0), "the end of an object")

    @contextmanager
    def table(self, minor: int = 0) -> Generator[int]:
        with self.chunk(ANONYMOUS):
            version = self.data[self.take(1)]
            if version not in range(16, 17 + minor):
                raise UnreadableError(f"a table of unknown version before {self.position}")
            yield self.ints(1)[0]


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
    cursor = _Cursor(stream)
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
        for _ in range(2):
            with cursor.chunk(ANONYMOUS):
                cursor.expect(b"\0", "a face without mesh")
        cursor.ints(1)
        with cursor.chunk(ANONYMOUS):
            cursor.ints(2)
            cursor.expect(b"\0", "a Brep without regions")
    if cursor.position != len(stream):
        raise UnreadableError("bytes follow the Brep")
    fixed = np.ones(len(stream), bool)
    for start, count in cursor.numbers:
        fixed[start : start + 8 * count] = False
    for checksum in cursor.checksums:
        fixed[checksum.place : checksum.place + CRC.size] = False
    try:
        sides = tuple(_side(trims[i], edges, trim_curves, edge_curves, vertices) for i in loop)
    except IndexError as error:
        raise UnreadableError("an index points at nothing") from error
    _check_chain(sides, trims, loop, len(surfaces))
    checksums, numbers = tuple(cursor.checksums), tuple(cursor.numbers)
    return BrepLayout(surfaces[0], sides, is_reversed, checksums, numbers, fixed)


def _curves(cursor: _Cursor) -> list[Curve]:
    curves: list[Curve] = []
    with cursor.table() as count:
        for _ in range(count):
            cursor.expect(struct.pack("<i", 1), "a curve")
            with cursor.object() as uuid:
                curves.append(_curve(cursor, uuid))
    return curves


def _curve(cursor: _Cursor, uuid: bytes) -> Curve:
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


def _surfaces(cursor: _Cursor) -> list[Surface]:
    surfaces: list[Surface] = []
    with cursor.table() as count:
        for _ in range(count):
            cursor.expect(struct.pack("<i", 1), "a surface")
            with cursor.object() as uuid:
                cursor.take(1)
                surfaces.append(_surface(cursor, uuid))
    return surfaces


def _surface(cursor: _Cursor, uuid: bytes) -> Surface:
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


def _vertices(cursor: _Cursor) -> list[int]:
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


def _edges(cursor: _Cursor) -> list[_Use]:
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


def _trims(cursor: _Cursor) -> list[_Use]:
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


def _loop(cursor: _Cursor) -> tuple[int, ...]:
    with cursor.table() as count:
        if count != 1:
            raise UnreadableError(f"{count} loops instead of one")
        cursor.ints(1)
        trims = cursor.counted_ints()
        kind, face = cursor.ints(2)
        if kind != OUTER_LOOP or face != 0:
            raise UnreadableError("the loop does not bound the face from outside")
    return trims


def _face(cursor: _Cursor) -> bool:
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
