"""Reads the faces of surfaces, polysurfaces and extrusions of a Rhino file, with their trims.

rhino3dm shows no curves in (u, v): they are taken from the bytes of the Brep, as
`ON_Brep::Write` lays them out (`opennurbs_brep_io.cpp`), and decoded one by one.
"""

import base64
from typing import Final, NamedTuple

import numpy as np

from ...kernel.arrays import FloatArray
from ...kernel.errors import InputError
from ...kernel.surfaces.nurbs import NurbsSurface
from ...kernel.surfaces.smooth_pieces import kink_shares, split_edges, whole_surface
from ...kernel.surfaces.trimmed_faces import (
    Polysurface,
    ShareCurve,
    Trim,
    TrimmedFace,
    transformed_surface,
)
from ..opennurbs import stream_codes as codes
from ..opennurbs.stream_reader import StreamReader, UnreadableError
from .object_reader import RhinoObject

_OUTER_AND_HOLES: Final = (1, 2)
_TRIM_REST: Final = 80
_SAME_PARAMETERS: Final = ("NurbsSurface", "PlaneSurface")


def read_polysurface(geometry: RhinoObject, transform: FloatArray) -> Polysurface:
    """Faces of an object, moved to its place.

    Parameters
    ----------
    geometry : rhino3dm.GeometryBase
        A surface, Brep or extrusion.
    transform : (4, 4) float array
        An affine map. One that mirrors turns faces over, so that they look to the same side.

    Returns
    -------
    Polysurface
        The faces in the order of the file.

    Raises
    ------
    InputError
        If a surface has no NURBS form, or a Brep is damaged.
    """
    kind = type(geometry).__name__
    if kind == "Extrusion":
        brep = geometry.ToBrep(True)  # noqa: FBT003
        if brep is None:
            raise InputError("the extrusion has no faces; mesh it in Rhino and save")
        geometry, kind = brep, "Brep"
    if kind == "Brep" and geometry.IsSurface:
        face = geometry.Faces[0]
        form = nurbs_surface(face.UnderlyingSurface())
        polysurface = whole_surface(form, is_reversed=bool(face.OrientationIsReversed))
    elif kind == "Brep":
        polysurface = _read_brep(geometry)
    else:
        polysurface = whole_surface(nurbs_surface(geometry))
    if np.array_equal(transform, np.eye(4)):
        return polysurface
    is_mirror = bool(np.linalg.det(transform[:3, :3]) < 0)
    faces = [
        TrimmedFace(
            transformed_surface(face.surface, transform), face.loops,
            face.is_reversed != is_mirror,
        )
        for face in polysurface.faces
    ]  # fmt: skip
    return Polysurface(faces, [_moved(edge, transform) for edge in polysurface.edges])


def _moved(curve: ShareCurve, transform: FloatArray) -> ShareCurve:
    return lambda share: curve(share) @ transform[:3, :3].T + transform[:3, 3]


def nurbs_surface(surface: RhinoObject) -> NurbsSurface:
    """A surface of rhino3dm as a record of the kernel, for exact points and curvatures.

    Parameters
    ----------
    surface : rhino3dm.Surface
        A surface of any kind.

    Raises
    ------
    InputError
        If it has none.
    """
    form = surface.ToNurbsSurface()
    if form is None:
        raise InputError("a surface has no NURBS form; mesh it in Rhino and save")
    net = form.Points
    points = np.array([
        [
            (p.X, p.Y, p.Z, p.W)
            for p in (net.GetControlPoint(i, j) for j in range(net.CountV))
        ]
        for i in range(net.CountU)
    ])  # fmt: skip
    # openNURBS leaves out the first and the last knot, which no point depends on.
    knots = (np.array(form.KnotsU.ToList()), np.array(form.KnotsV.ToList()))
    full = [np.concatenate([each[:1], each, each[-1:]]) for each in knots]
    return NurbsSurface(full[0], full[1], points)


class _TrimRecord(NamedTuple):
    curve: int
    domain: tuple[float, float]
    edge: int
    ends: tuple[int, int]
    is_reversed: bool


class _Tables(NamedTuple):
    """Of a Brep: its trims, its loops (trims, kind) and its faces (loops, is_reversed)."""

    curves: list[RhinoObject]
    trims: list[_TrimRecord]
    loops: list[tuple[tuple[int, ...], int]]
    faces: list[tuple[tuple[int, ...], bool]]


def _read_brep(brep: RhinoObject) -> Polysurface:
    encoded = brep.Encode()
    try:
        tables = _read_tables(encoded)
        _check_tables(tables, len(brep.Edges))
        surfaces = [brep.Faces[i].UnderlyingSurface() for i in range(len(tables.faces))]
        edges = [_space_curve(brep.Edges[i]) for i in range(len(brep.Edges))]
        polysurface = Polysurface([], edges)
        for surface, (loops, is_reversed) in zip(surfaces, tables.faces, strict=True):
            form = nurbs_surface(surface)
            kept = [tables.loops[i][0] for i in loops if tables.loops[i][1] in _OUTER_AND_HOLES]
            if not kept:
                raise InputError("a face has no boundary; mesh it in Rhino and save")
            trims = [[_trim(tables, i, surface) for i in loop] for loop in kept]
            polysurface.faces.append(TrimmedFace(form, trims, is_reversed))
    except (UnreadableError, IndexError, ValueError) as error:
        raise InputError(f"the polysurface is damaged ({error}); repair it in Rhino") from error
    kinks = [
        kink_shares(edge, _knot_shares(curve))
        for edge, curve in zip(edges, brep.Edges, strict=True)
    ]
    return split_edges(polysurface, kinks)


def _check_tables(tables: _Tables, n_edges: int) -> None:
    for i, trim in enumerate(tables.trims):
        is_there = 0 <= trim.curve < len(tables.curves) and -1 <= trim.edge < n_edges
        if not is_there or min(trim.ends) < 0 or not trim.domain[0] < trim.domain[1]:
            raise UnreadableError(f"trim {i} has no curve, edge or vertex")
    for i, (trims, _) in enumerate(tables.loops):
        if not trims or any(not 0 <= each < len(tables.trims) for each in trims):
            raise UnreadableError(f"loop {i} has no trims")


def _knot_shares(curve: RhinoObject) -> FloatArray:
    """Shares of an edge where a kink may be: at knots as often repeated as the degree."""
    form = curve.ToNurbsCurve()
    if form is None:
        return np.empty(0)
    knots, counts = np.unique(np.array(form.Knots.ToList()), return_counts=True)
    first, last = float(curve.Domain.T0), float(curve.Domain.T1)
    inner = knots[(counts >= form.Degree) & (knots > knots[0]) & (knots < knots[-1])]
    found = [curve.GetCurveParameterFromNurbsFormParameter(t)[-1] for t in inner.tolist()]
    return (np.array(found, np.float64) - first) / (last - first)


def _trim(tables: _Tables, index: int, surface: RhinoObject) -> Trim:
    record = tables.trims[index]
    curve = _plane_curve(tables.curves[record.curve], record.domain, surface)
    return Trim(record.edge, record.is_reversed, record.ends, curve)


def _space_curve(curve: RhinoObject) -> ShareCurve:
    return _evaluator(curve, (float(curve.Domain.T0), float(curve.Domain.T1)))


def _evaluator(curve: RhinoObject, domain: tuple[float, float]) -> ShareCurve:
    first, last = domain

    def _points(share: FloatArray) -> FloatArray:
        places = map(curve.PointAt, ((1 - share) * first + share * last).tolist())
        return np.array([(p.X, p.Y, p.Z) for p in places]).reshape(-1, 3)

    kind = type(curve).__name__
    is_line = kind == "LineCurve" or (
        kind == "NurbsCurve" and len(curve.Points) == 2 and not curve.IsRational
    )
    if not is_line:
        return _points
    start, end = _points(np.array([0.0, 1.0]))
    return lambda share: (1 - share)[:, None] * start + share[:, None] * end


def _plane_curve(
    curve: RhinoObject, domain: tuple[float, float], surface: RhinoObject
) -> ShareCurve:
    """A trim in the parameters of the NURBS form of its surface."""
    places = _evaluator(curve, domain)
    is_same = type(surface).__name__ in _SAME_PARAMETERS

    def _points(share: FloatArray) -> FloatArray:
        uv = places(share)[:, :2]
        if is_same:
            return uv
        pairs = [surface.GetNurbsFormParameterFromSurfaceParameter(*p) for p in uv.tolist()]
        return np.array([pair[-2:] for pair in pairs], np.float64).reshape(-1, 2)

    return _points


def _read_tables(encoded: dict[str, object]) -> _Tables:
    reader = StreamReader(base64.b64decode(str(encoded["data"])))
    with reader.chunk(codes.CLASS):
        with reader.chunk(codes.CLASS_UUID):
            reader.take(16)
        with reader.chunk(codes.CLASS_DATA):
            if reader.data[reader.take(1)] >> 4 != 3:
                raise UnreadableError("not a Brep of version 3")
            curves = _read_curves(reader, encoded)
            for _ in ("edge curves", "surfaces", "vertices", "edges"):
                _skip_chunk(reader)
            trims = _read_trims(reader)
            loops = _read_loops(reader)
            faces = _read_faces(reader, len(loops))
            reader.take(reader.limit - reader.position)
        reader.take(reader.limit - reader.position)
    return _Tables(curves, trims, loops, faces)


def _skip_chunk(reader: StreamReader) -> int:
    """Pass a chunk: where it begins."""
    start = reader.take(codes.CHUNK_HEADER.size)
    typecode, length = codes.CHUNK_HEADER.unpack_from(reader.data, start)
    if not typecode & codes.SHORT_FLAG:
        reader.take(length)
    return start


def _read_curves(reader: StreamReader, encoded: dict[str, object]) -> list[RhinoObject]:
    import rhino3dm

    rhino: RhinoObject = rhino3dm
    curves: list[RhinoObject] = []
    with reader.table() as count:
        for _ in range(count):
            if not reader.ints(1)[0]:
                raise UnreadableError("a trim has no curve")
            start = _skip_chunk(reader)
            data = base64.b64encode(reader.data[start : reader.position]).decode()
            curve: RhinoObject = rhino.CommonObject.Decode({**encoded, "data": data})
            if curve is None or not hasattr(curve, "PointAt"):
                raise UnreadableError("a trim is no curve")
            curves.append(curve)
    return curves


def _read_trims(reader: StreamReader) -> list[_TrimRecord]:
    trims: list[_TrimRecord] = []
    with reader.table() as count:
        for _ in range(count):
            _, curve = reader.ints(2)
            domain = np.frombuffer(reader.data, "<f8", 2, reader.doubles(2))
            edge, first, last, is_reversed, *_ = reader.ints(7)
            reader.take(_TRIM_REST)
            ends = float(domain[0]), float(domain[1])
            trims.append(_TrimRecord(curve, ends, edge, (first, last), bool(is_reversed)))
    return trims


def _read_loops(reader: StreamReader) -> list[tuple[tuple[int, ...], int]]:
    loops: list[tuple[tuple[int, ...], int]] = []
    with reader.table() as count:
        for _ in range(count):
            reader.ints(1)
            trims = reader.counted_ints()
            kind, _ = reader.ints(2)
            loops.append((trims, kind))
    return loops


def _read_faces(reader: StreamReader, n_loops: int) -> list[tuple[tuple[int, ...], bool]]:
    faces: list[tuple[tuple[int, ...], bool]] = []
    with reader.chunk(codes.ANONYMOUS):
        reader.take(1)
        (count,) = reader.ints(1)
        for _ in range(count):
            reader.ints(1)
            loops = reader.counted_ints()
            _, is_reversed, _ = reader.ints(3)
            if any(not 0 <= i < n_loops for i in loops):
                raise UnreadableError("a face names a loop that is not there")
            faces.append((loops, bool(is_reversed)))
        # What follows are ids and colours.
        reader.take(reader.limit - reader.position)
    return faces
