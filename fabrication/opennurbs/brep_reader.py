"""Reads one-faced Breps from their bytes: where their numbers stand.

The stream is read as openNURBS reads it (layout: `brep_writer`), independently of how
it was written. Numbers are not looked at here, only found, so that streams of the same layout
can be judged together.
"""

import struct
from collections.abc import Generator
from typing import NamedTuple

import numpy as np

from . import stream_codes as codes
from .brep_layout import BrepLayout, Curve, FaceMesh, Side, Surface
from .stream_reader import BufferPlace, StreamReader, UnreadableError

_OBJECT_TABLE = 0x10000013
_OBJECT_RECORD = 0x20008070
_FILE_HEADER = 32


def read_brep_streams(data: bytes) -> list[bytes]:
    """Streams of the Breps in a .3dm file (version 5 or later), without attributes."""
    streams: list[bytes] = []
    for typecode, start, stop in _chunks(data, _FILE_HEADER, len(data)):
        if typecode != _OBJECT_TABLE:
            continue
        for record, begin, end in _chunks(data, start, stop):
            if record != _OBJECT_RECORD:
                continue
            for inner, first, last in _chunks(data, begin, end):
                named = first + codes.CHUNK_HEADER.size
                if inner == codes.CLASS and data[named : named + len(codes.BREP)] == codes.BREP:
                    streams.append(data[first - codes.CHUNK_HEADER.size : last])
    return streams


def _chunks(data: bytes, start: int, stop: int) -> Generator[tuple[int, int, int]]:
    """Type, begin and end of the bodies of consecutive chunks."""
    while start + codes.CHUNK_HEADER.size <= stop:
        typecode, length = codes.CHUNK_HEADER.unpack_from(data, start)
        start += codes.CHUNK_HEADER.size
        length = 0 if typecode & codes.SHORT_FLAG else length
        yield typecode, start, start + length
        start += length


def parse_brep(stream: bytes) -> BrepLayout:
    """Places of the numbers of a Brep of one face and one loop.

    Raises UnreadableError if the stream is cut short, or not a Brep of the kind that spherical
    panels make: trims that are lines or rational quadratics in Bézier spans, edges that are
    lines or arcs, a plane or a rational biquadratic surface in Bézier spans.
    """
    reader = StreamReader(stream)
    with reader.object() as uuid:
        if uuid != codes.BREP:
            raise UnreadableError("the stream is not a Brep")
        reader.expect(b"\x33", "Brep version 3.3")
        trim_curves = _curves(reader)
        edge_curves = _curves(reader)
        surfaces = _surfaces(reader)
        vertices = _vertices(reader)
        edges = _edges(reader)
        trims = _trims(reader)
        loop = _loop(reader)
        is_reversed = _face(reader)
        reader.doubles(6)
        with reader.chunk(codes.ANONYMOUS):
            mesh = _face_mesh(reader)
        with reader.chunk(codes.ANONYMOUS):
            reader.expect(b"\0", "a face without analysis mesh")
        reader.ints(1)
        with reader.chunk(codes.ANONYMOUS):
            reader.ints(2)
            reader.expect(b"\0", "a Brep without regions")
    if reader.position != len(stream):
        raise UnreadableError("bytes follow the Brep")
    fixed = np.ones(len(stream), bool)
    for start, count in reader.numbers:
        fixed[start : start + 8 * count] = False
    for buffer in () if mesh is None else mesh[1:]:
        # Deflated bytes are compared: each stream is then judged on its own.
        if buffer is not None and not buffer.is_deflated:
            fixed[buffer.start : buffer.stop] = False
    for checksum in reader.checksums:
        fixed[checksum.place : checksum.place + codes.CRC.size] = False
    try:
        sides = tuple(_side(trims[i], edges, trim_curves, edge_curves, vertices) for i in loop)
    except IndexError as error:
        raise UnreadableError("an index points at nothing") from error
    _check_chain(sides, trims, loop, len(surfaces))
    checksums, numbers = tuple(reader.checksums), tuple(reader.numbers)
    return BrepLayout(surfaces[0], sides, is_reversed, mesh, checksums, numbers, fixed)


def _curves(reader: StreamReader) -> list[Curve]:
    curves: list[Curve] = []
    with reader.table() as count:
        for _ in range(count):
            reader.expect(struct.pack("<i", 1), "a curve")
            with reader.object() as uuid:
                curves.append(_curve(reader, uuid))
    return curves


def _curve(reader: StreamReader, uuid: bytes) -> Curve:
    version = reader.take(1)
    if uuid in (codes.LINE_CURVE, codes.ARC_CURVE):
        count = 6 if uuid == codes.LINE_CURVE else 28
        points = reader.doubles(count)
        domain = reader.doubles(2)
        reader.ints(1)
        return Curve(uuid, (domain, domain + 8), points, count)
    if uuid != codes.NURBS_CURVE:
        raise UnreadableError(f"a curve of unknown class before byte {version}")
    dimension, rational, order, n_points, *_ = reader.ints(6)
    reader.doubles(6)
    (n_knots,) = reader.ints(1)
    knots = reader.doubles(n_knots)
    (n_written,) = reader.ints(1)
    if (dimension, rational, order) != (2, 1, 3) or not n_written == n_points == n_knots - 1:
        raise UnreadableError(f"no rational quadratic trim at byte {version}")
    if n_points % 2 == 0 or n_points < 3:
        raise UnreadableError(f"the trim at byte {version} is not made of Bézier spans")
    points = reader.doubles(3 * n_points)
    if reader.data[version] & 15:
        reader.take(1)
    ends = knots, knots + 8 * (n_knots - 1)
    return Curve(uuid, ends, points, n_points, knots, n_knots)


def _surfaces(reader: StreamReader) -> list[Surface]:
    surfaces: list[Surface] = []
    with reader.table() as count:
        for _ in range(count):
            reader.expect(struct.pack("<i", 1), "a surface")
            with reader.object() as uuid:
                reader.take(1)
                surfaces.append(_surface(reader, uuid))
    return surfaces


def _surface(reader: StreamReader, uuid: bytes) -> Surface:
    if uuid == codes.PLANE_SURFACE:
        points = reader.doubles(16)
        domains = reader.doubles(8)
        return Surface(uuid, (domains, domains + 16), points, (0, 0))
    if uuid != codes.NURBS_SURFACE:
        raise UnreadableError("a surface of unknown class")
    dimension, rational, *orders, n_u, n_v, _, _ = reader.ints(8)
    reader.doubles(6)
    places: list[int] = []
    for size in (n_u, n_v):
        (n_knots,) = reader.ints(1)
        if n_knots != size + 1 or size % 2 == 0 or size < 3:
            raise UnreadableError("the surface is not made of Bézier spans")
        places.append(reader.doubles(n_knots))
    if (dimension, rational, *orders) != (3, 1, 3, 3) or reader.ints(1)[0] != n_u * n_v:
        raise UnreadableError("no rational biquadratic surface")
    return Surface(uuid, (places[0], places[1]), reader.doubles(4 * n_u * n_v), (n_u, n_v))


def _vertices(reader: StreamReader) -> list[int]:
    places: list[int] = []
    with reader.table() as count:
        for _ in range(count):
            reader.ints(1)
            places.append(reader.doubles(3))
            reader.counted_ints()
            reader.doubles(1)
    return places


class _Use(NamedTuple):
    """How a trim or edge uses its curve: curve, edge, vertices, place of the domain."""

    curve: int
    edge: int
    ends: tuple[int, int]
    domain: int


def _edges(reader: StreamReader) -> list[_Use]:
    edges: list[_Use] = []
    with reader.table() as count:
        for _ in range(count):
            index, curve, is_reversed = reader.ints(3)
            domain = reader.doubles(2)
            first, last = reader.ints(2)
            reader.counted_ints()
            reader.doubles(3)
            if is_reversed:
                raise UnreadableError(f"edge {index} is reversed")
            edges.append(_Use(curve, index, (first, last), domain))
    return edges


def _trims(reader: StreamReader) -> list[_Use]:
    trims: list[_Use] = []
    with reader.table() as count:
        for _ in range(count):
            index, curve = reader.ints(2)
            domain = reader.doubles(2)
            edge, first, last, is_reversed, kind, _, loop = reader.ints(7)
            reader.doubles(4)
            reader.expect(bytes(32), f"flags of trim {index}")
            reader.doubles(2)
            if is_reversed or kind != codes.BOUNDARY_TRIM or loop != 0:
                raise UnreadableError(f"trim {index} does not bound the face")
            trims.append(_Use(curve, edge, (first, last), domain))
    return trims


def _loop(reader: StreamReader) -> tuple[int, ...]:
    with reader.table() as count:
        if count != 1:
            raise UnreadableError(f"{count} loops instead of one")
        reader.ints(1)
        trims = reader.counted_ints()
        kind, face = reader.ints(2)
        if kind != codes.OUTER_LOOP or face != 0:
            raise UnreadableError("the loop does not bound the face from outside")
    return trims


def _face(reader: StreamReader) -> bool:
    with reader.chunk(codes.ANONYMOUS):
        version = reader.data[reader.take(1)]
        (count,) = reader.ints(1)
        if count != 1 or version not in (0x11, 0x12):
            raise UnreadableError(f"{count} faces instead of one")
        index = reader.ints(1)
        loops = reader.counted_ints()
        surface, is_reversed, _ = reader.ints(3)
        if (*index, *loops, surface) != (0, 0, 0):
            raise UnreadableError("the face does not use the loop and the surface")
        reader.take(16)
        if version == 0x12:
            reader.expect(b"\0", "a face without colour")
    return bool(is_reversed)


def _face_mesh(reader: StreamReader) -> FaceMesh | None:
    """Follow ON_Mesh::Read; every part that render meshes of panels lack must be empty."""
    if reader.data[reader.take(1)] == 0:
        return None
    with reader.object() as uuid:
        if uuid != codes.MESH:
            raise UnreadableError("the render mesh is no mesh")
        reader.expect(codes.MESH_VERSION, "mesh version 3.8")
        n_points, n_faces = reader.ints(2)
        reader.take(64 + 16 + 64 + 4)
        reader.expect(bytes(5), "a mesh without parameters and curvatures")
        (size,) = reader.ints(1)
        if size not in (1, 2, 4):
            raise UnreadableError(f"vertex ids of {size} bytes in the render mesh")
        place = reader.take(4 * size * n_faces)
        faces = np.frombuffer(reader.data, f"<u{size}", 4 * n_faces, place).reshape(-1, 4)
        floats, normals = reader.buffer(12 * n_points), reader.buffer(12 * n_points)
        for _ in range(3):
            reader.buffer(0)
        reader.take(4 + 16)
        reader.buffer(0)
        with reader.chunk(codes.ANONYMOUS):
            reader.take(160)
        reader.take(3)
        reader.expect(b"\0", "a mesh without ngons")
        points = _precise_points(reader, n_points)
        reader.take(48)
    if n_faces < 1 or faces.max() >= n_points or (faces[:, 2] != faces[:, 3]).any():
        raise UnreadableError("the render mesh is not made of triangles of its vertices")
    return FaceMesh(faces[:, :3], floats, normals, points)


def _precise_points(reader: StreamReader, n_points: int) -> BufferPlace | None:
    """The vertices as float64, if they are there."""
    if reader.data[reader.take(1)] == 0:
        return None
    with reader.chunk(codes.ANONYMOUS):
        if reader.ints(3) != (1, 0, n_points):
            raise UnreadableError("the render mesh has another number of precise vertices")
        return reader.buffer(24 * n_points)


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
        if side.trim.uuid == codes.ARC_CURVE or side.edge.uuid == codes.NURBS_CURVE:
            raise UnreadableError("an edge is not an arc or a line")
