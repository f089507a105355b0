"""Reads Breps from their bytes: where their numbers stand.

The stream is read as openNURBS reads it (layout: `brep_writer`), independently of how
it was written. Numbers are not looked at here, only found, so that streams of the same layout
can be judged together.
"""

import struct
from collections.abc import Generator
from typing import NamedTuple

import numpy as np

from ...kernel.arrays import BoolArray
from . import stream_codes as codes
from .brep_layout import BrepLayout, Curve, Face, FaceMesh, Side, Surface
from .stream_reader import BufferPlace, StreamReader, UnreadableError

_QUADRATIC = 3
"""Order of a conic."""

_FILE_HEADER = 32


def read_brep_streams(data: bytes) -> list[bytes]:
    """Streams of the Breps in a .3dm file (version 5 or later), without attributes."""
    streams: list[bytes] = []
    for typecode, start, stop in _chunks(data, _FILE_HEADER, len(data)):
        if typecode != codes.OBJECT_TABLE:
            continue
        for record, begin, end in _chunks(data, start, stop):
            if record != codes.OBJECT_RECORD:
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
    """Places of the numbers of a Brep.

    Raises UnreadableError if the stream is cut short, or not a Brep of the kind that panels and
    beams make: trims that are lines, rational quadratics or cubics in Bézier spans, edges that
    are lines, arcs or rational quadratics, planes and rational surfaces in Bézier spans that
    are quadratic in u, in v quadratic or straight.
    """
    reader = StreamReader(stream)
    with reader.object() as uuid:
        if uuid != codes.BREP:
            raise UnreadableError("the stream is not a Brep")
        reader.expect(b"\x33", "Brep version 3.3")
        trim_curves, edge_curves = _curves(reader, 2), _curves(reader, 3)
        surfaces = _surfaces(reader)
        vertices = _vertices(reader)
        edges = _edges(reader)
        flags, trims = _trims(reader)
        loops = _loops(reader)
        faces = _faces(reader)
        reader.doubles(6)
        with reader.chunk(codes.ANONYMOUS):
            meshes = [_face_mesh(reader) for _ in faces]
        with reader.chunk(codes.ANONYMOUS):
            reader.expect(bytes(len(faces)), "faces without analysis meshes")
        reader.ints(1)
        with reader.chunk(codes.ANONYMOUS):
            reader.ints(2)
            reader.expect(b"\0", "a Brep without regions")
    if reader.position != len(stream):
        raise UnreadableError("bytes follow the Brep")
    try:
        sides = [_side(trim, edges, trim_curves, edge_curves, vertices) for trim in trims]
        found = tuple(
            Face(
                surfaces[face.surface],
                tuple(_loop_sides(loops[i], sides, trims, i, own) for i in face.loops),
                face.is_reversed, mesh,
            )
            for own, (face, mesh) in enumerate(zip(faces, meshes, strict=True))
        )  # fmt: skip
    except IndexError as error:
        raise UnreadableError("an index points at nothing") from error
    _check_use(trims, loops, faces, len(surfaces))
    is_closed = _is_closed(trims, len(edges))
    checksums, numbers = tuple(reader.checksums), tuple(reader.numbers)
    fixed = _fixed_bytes(reader, flags, meshes)
    return BrepLayout(found, is_closed, checksums, numbers, fixed)


def _fixed_bytes(
    reader: StreamReader, flags: list[int], meshes: list[FaceMesh | None]
) -> BoolArray:
    fixed = np.ones(len(reader.data), bool)
    for start, count in reader.numbers:
        fixed[start : start + 8 * count] = False
    for place in flags:
        fixed[place : place + 4] = False
    for mesh in meshes:
        for buffer in () if mesh is None else mesh[1:]:
            # Deflated bytes are compared: each stream is then judged on its own.
            if buffer is not None and not buffer.is_deflated:
                fixed[buffer.start : buffer.stop] = False
    for checksum in reader.checksums:
        fixed[checksum.place : checksum.place + codes.CRC.size] = False
    return fixed


def _curves(reader: StreamReader, dimension: int) -> list[Curve]:
    curves: list[Curve] = []
    with reader.table() as count:
        for _ in range(count):
            reader.expect(struct.pack("<i", 1), "a curve")
            with reader.object() as uuid:
                curves.append(_curve(reader, uuid, dimension))
    return curves


def _curve(reader: StreamReader, uuid: bytes, expected: int) -> Curve:
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
    if (dimension, rational) != (expected, 1) or order not in (3, 4):
        raise UnreadableError(f"no rational quadratic or cubic at byte {version}")
    degree = order - 1
    if not n_written == n_points == n_knots - degree + 1 or n_points <= degree:
        raise UnreadableError(f"a curve of other counts at byte {version}")
    if n_points % degree != 1:
        raise UnreadableError(f"the curve at byte {version} is not made of Bézier spans")
    points = reader.doubles((dimension + 1) * n_points)
    if reader.data[version] & 15:
        reader.take(1)
    ends = knots, knots + 8 * (n_knots - 1)
    return Curve(uuid, ends, points, n_points, knots, n_knots, dimension, order)


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
    dimension, rational, order_u, order_v, n_u, n_v, _, _ = reader.ints(8)
    reader.doubles(6)
    if (dimension, rational, order_u) != (3, 1, 3) or order_v not in (2, 3):
        raise UnreadableError("no rational surface that is quadratic in u")
    places: list[int] = []
    for size, order in ((n_u, order_u), (n_v, order_v)):
        (n_knots,) = reader.ints(1)
        if n_knots != size + order - 2 or size % (order - 1) != 1 % (order - 1) or size < order:
            raise UnreadableError("the surface is not made of Bézier spans")
        places.append(reader.doubles(n_knots))
    if reader.ints(1)[0] != n_u * n_v:
        raise UnreadableError("a surface of other counts")
    points = reader.doubles(4 * n_u * n_v)
    return Surface(uuid, (places[0], places[1]), points, (n_u, n_v), (order_u, order_v))


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
    """How a trim or edge uses its curve: curve, edge, vertices, place of the domain.

    A trim may run against its edge; it belongs to a loop.
    """

    curve: int
    edge: int
    ends: tuple[int, int]
    domain: int
    is_reversed: bool = False
    loop: int = 0


class _FaceRecord(NamedTuple):
    loops: tuple[int, ...]
    surface: int
    is_reversed: bool


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


def _trims(reader: StreamReader) -> tuple[list[int], list[_Use]]:
    """Where trims say whether they run along u or v, and trims."""
    flags: list[int] = []
    trims: list[_Use] = []
    with reader.table() as count:
        for _ in range(count):
            index, curve = reader.ints(2)
            domain = reader.doubles(2)
            edge, first, last, is_reversed, kind = reader.ints(5)
            flags.append(reader.position)
            _, loop = reader.ints(2)
            reader.doubles(4)
            reader.expect(bytes(32), f"flags of trim {index}")
            reader.doubles(2)
            if kind not in (codes.BOUNDARY_TRIM, codes.MATED_TRIM, codes.SEAM_TRIM):
                raise UnreadableError(f"trim {index} does not bound the face")
            trims.append(_Use(curve, edge, (first, last), domain, bool(is_reversed), loop))
    return flags, trims


class _LoopRecord(NamedTuple):
    trims: tuple[int, ...]
    kind: int
    face: int


def _loops(reader: StreamReader) -> list[_LoopRecord]:
    loops: list[_LoopRecord] = []
    with reader.table() as count:
        for _ in range(count):
            reader.ints(1)
            trims = reader.counted_ints()
            loops.append(_LoopRecord(trims, *reader.ints(2)))
    return loops


def _faces(reader: StreamReader) -> list[_FaceRecord]:
    faces: list[_FaceRecord] = []
    with reader.chunk(codes.ANONYMOUS):
        version = reader.data[reader.take(1)]
        (count,) = reader.ints(1)
        if version not in (0x11, 0x12):
            raise UnreadableError("faces of unknown version")
        for _ in range(count):
            reader.ints(1)
            loops = reader.counted_ints()
            surface, is_reversed, _ = reader.ints(3)
            faces.append(_FaceRecord(loops, surface, bool(is_reversed)))
        reader.take(16 * count)
        if version == 0x12:
            reader.expect(bytes(count), "faces without colours")
    if not faces:
        raise UnreadableError("a Brep without faces")
    return faces


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
    ends = edge.ends[::-1] if trim.is_reversed else edge.ends
    if ends != trim.ends or min(*ends, trim.edge, trim.curve, edge.curve) < 0:
        raise UnreadableError("a trim and its edge name different vertices")
    curves = trim_curves[trim.curve], edge_curves[edge.curve]
    if curves[0].uuid == codes.ARC_CURVE:
        raise UnreadableError("a trim is neither a line nor rational")
    if curves[1].uuid == codes.NURBS_CURVE and curves[1].order != _QUADRATIC:
        raise UnreadableError("an edge is not an arc, a line or a conic")
    start, end = (vertices[i] for i in ends)
    return Side(*curves, start, end, trim.domain, edge.domain, trim.is_reversed)


def _loop_sides(
    loop: _LoopRecord, sides: list[Side], trims: list[_Use], index: int, face: int
) -> tuple[Side, ...]:
    own = tuple(sides[i] for i in loop.trims)
    if loop.face != face or any(trims[i].loop != index for i in loop.trims) or not own:
        raise UnreadableError("a loop does not bound its face")
    for side, following in zip(own, (*own[1:], own[0]), strict=True):
        if side.end != following.start:
            raise UnreadableError("the trims of the loop do not follow one another")
    return own


def _check_use(
    trims: list[_Use], loops: list[_LoopRecord], faces: list[_FaceRecord], n_surfaces: int
) -> None:
    used = sorted(i for loop in loops for i in loop.trims)
    if used != list(range(len(trims))):
        raise UnreadableError("the loop does not use every trim once")
    if sorted(i for face in faces for i in face.loops) != list(range(len(loops))):
        raise UnreadableError("faces do not use every loop once")
    if sorted(face.surface for face in faces) != list(range(n_surfaces)):
        raise UnreadableError("faces do not use every surface once")
    for face in faces:
        kinds = [loops[i].kind for i in face.loops]
        if kinds != [codes.OUTER_LOOP, *[codes.INNER_LOOP] * (len(kinds) - 1)]:
            raise UnreadableError("the loop does not bound the face from outside")


def _is_closed(trims: list[_Use], n_edges: int) -> bool:
    """Whether every edge has two sides, one each way."""
    senses: list[list[bool]] = [[] for _ in range(n_edges)]
    for trim in trims:
        senses[trim.edge].append(trim.is_reversed)
    return all(sorted(found) == [False, True] for found in senses)
