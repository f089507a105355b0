"""Reads surfaces and polysurfaces of a Rhino file as grids of quads with exact positions.

A face that is a whole surface is sampled over its domain. A face trimmed by four edges is
sampled over the rectangle that they span in (u, v), by Coons; one trimmed by more or fewer is
first divided into quads from its middle. rhino3dm shows no curves in (u, v): the points of the
edges are found on the surface.
"""

from typing import Final, NamedTuple

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, norm
from ...kernel.errors import InputError
from ...kernel.surfaces.nurbs import NurbsSurface, evaluate_nurbs, nearest_parameters
from ...kernel.tolerances import CLOSED, EDGE_MISS
from ..polygons import Polygons, join_polygons
from .object_reader import RhinoObject

SURFACES: Final = ("Surface", "NurbsSurface", "PlaneSurface", "RevSurface", "Brep", "Extrusion")
"""Classes of rhino3dm that can be sampled."""


class GridSize(NamedTuple):
    """Quads along u and v of every face."""

    n_u: int
    n_v: int


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


def sample_object(geometry: RhinoObject, size: GridSize) -> list[Polygons]:
    """Quads on a surface, polysurface or extrusion.

    Parameters
    ----------
    geometry : rhino3dm.GeometryBase
        An object of one of the classes `SURFACES`.

    Returns
    -------
    list of Polygons
        One for each face, turning as the face does.

    Raises
    ------
    InputError
        If a trimmed face has holes, a seam or a pole on its boundary, or is not convex enough
        for a grid.
    """
    kind = type(geometry).__name__
    if kind == "Extrusion":
        geometry, kind = geometry.ToBrep(False), "Brep"  # noqa: FBT003
    if kind != "Brep":
        surface = nurbs_surface(geometry)
        return [_quads(surface, _rectangle(surface.domain, size), size)]
    return [_sample_face(geometry, i, size) for i in range(len(geometry.Faces))]


def _sample_face(brep: RhinoObject, index: int, size: GridSize) -> Polygons:
    face = brep.Faces[index]
    surface = nurbs_surface(face.UnderlyingSurface())
    if face.DuplicateFace(False).IsSurface:  # noqa: FBT003
        polygons = _quads(surface, _rectangle(surface.domain, size), size)
    else:
        try:
            polygons = _sample_trimmed(surface, _boundary(brep, face, surface, size), size)
        except InputError as error:
            raise InputError(
                f"face {index} of a polysurface {error}; mesh it in Rhino (Mesh, QuadRemesh) "
                "and save"
            ) from error
    if face.OrientationIsReversed:
        corners = polygons.corners.reshape(-1, 4)[:, ::-1].ravel()
        polygons = Polygons(polygons.vertices, corners, polygons.degrees)
    return polygons


def _rectangle(domain: FloatArray, size: GridSize) -> FloatArray:
    """Parameters (n_u + 1, n_v + 1, 2) over the whole domain."""
    low, high = domain.T
    share = np.meshgrid(*(np.linspace(0, 1, count + 1) for count in size), indexing="ij")
    return np.clip(low + np.stack(share, -1) * (high - low), low, high)


def _quads(surface: NurbsSurface, uv: FloatArray, size: GridSize) -> Polygons:
    """Quads over a grid of parameters, counter-clockwise about x_u × x_v."""
    points = evaluate_nurbs(surface, *uv.reshape(-1, 2).T).points
    ids: IntArray = np.arange(len(points)).reshape(size.n_u + 1, size.n_v + 1)
    quads = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
    return Polygons(points, quads.ravel(), np.full(quads[..., 0].size, 4))


def _boundary(
    brep: RhinoObject, face: RhinoObject, surface: NurbsSurface, size: GridSize
) -> list[FloatArray]:
    """Sides of a face in (u, v), each (m, 2) with both ends, in the order of the loop."""
    if len(face.Loops) != 1:
        raise InputError(f"has {len(face.Loops) - 1} holes")
    trims = list(face.Loops[0].Trims)
    edges = [trim.EdgeIndex for trim in trims]
    if min(edges) < 0 or len(set(edges)) < len(edges):
        raise InputError("has a seam or a pole on its boundary")
    # An even number of steps: a face without four sides uses half a side at a time.
    even = max(size) + max(size) % 2
    sides: list[FloatArray] = []
    for side, (trim, edge) in enumerate(zip(trims, edges, strict=True)):
        steps = size[side % 2] if len(trims) == 4 else even
        points = _edge_points(brep.Edges[edge], steps)
        sides.append(points[::-1] if trim.IsReversed else points)
    uv, distances = nearest_parameters(surface, np.concatenate(sides))
    length = min(norm(np.diff(side, axis=0)).sum() for side in sides)
    if not distances.max() <= EDGE_MISS * length:
        raise InputError(f"lies {distances.max():.3g} off its edges")
    bounds = np.cumsum([len(side) for side in sides])[:-1]
    return off_seams(surface, np.split(uv, bounds))


def _edge_points(curve: RhinoObject, steps: int) -> FloatArray:
    first, last = float(curve.Domain.T0), float(curve.Domain.T1)
    share: list[float] = np.linspace(first, last, steps + 1).tolist()
    return np.array([(p.X, p.Y, p.Z) for p in map(curve.PointAt, share)])


def off_seams(surface: NurbsSurface, sides: list[FloatArray]) -> list[FloatArray]:
    """Sides along the seam of a closed surface, on that end of its domain where the face is.

    Parameters
    ----------
    sides : list of (m, 2) float array
        Points in (u, v); those on the seam may be at either end of the domain.

    Returns
    -------
    list of (m, 2) float array
        The same sides, all of their points at one end.
    """
    domain, size = surface.domain, np.ptp(surface.points[..., :3], axis=(0, 1)).max()
    joined = [side.copy() for side in sides]
    for axis, (low, high) in enumerate(domain):
        opposite = np.tile(domain.mean(1), (2, 1))
        opposite[:, axis] = low, high
        first, last = evaluate_nurbs(surface, *opposite.T).points
        if norm(first - last) > CLOSED * size:
            continue
        values = np.concatenate([side[:, axis] for side in joined])
        margin = CLOSED * (high - low)
        inner = values[(values > low + margin) & (values < high - margin)]
        end = low if inner.mean() < (low + high) / 2 else high
        for side in joined:
            is_on_seam = np.minimum(side[:, axis] - low, high - side[:, axis]) <= margin
            side[is_on_seam, axis] = end
    return joined


def _sample_trimmed(surface: NurbsSurface, sides: list[FloatArray], size: GridSize) -> Polygons:
    if len(sides) == 4:
        return _quads(surface, _unfolded(_coons(sides)), size)
    half = len(sides[0]) // 2
    center = np.mean([side[half] for side in sides], axis=0)
    share = np.linspace(0, 1, half + 1)[:, None]
    parts: list[Polygons] = []
    for side, before in zip(sides, (sides[-1], *sides[:-1]), strict=True):
        inwards = side[half] + share * (center - side[half])
        outwards = center + share * (before[half] - center)
        uv = _coons([side[: half + 1], inwards, outwards, before[half:]])
        parts.append(_quads(surface, _unfolded(uv), GridSize(half, half)))
    return join_polygons(parts)


def _unfolded(uv: FloatArray) -> FloatArray:
    """The grid, if it covers nothing twice: a loop runs counter-clockwise in (u, v)."""
    first, second = uv[1:, 1:] - uv[:-1, :-1], uv[:-1, 1:] - uv[1:, :-1]
    if not (first[..., 0] * second[..., 1] > first[..., 1] * second[..., 0]).all():
        raise InputError("turns inwards at its boundary, where a grid would fold")
    return uv


def _coons(sides: list[FloatArray]) -> FloatArray:
    """The grid of points that four sides in a loop span, (n + 1, m + 1, 2)."""
    bottom, right, top, left = sides[0], sides[1], sides[2][::-1], sides[3][::-1]
    s = np.linspace(0, 1, len(bottom))[:, None, None]
    t = np.linspace(0, 1, len(right))[None, :, None]
    ruled = (1 - t) * bottom[:, None] + t * top[:, None] + (1 - s) * left + s * right
    low = (1 - s) * bottom[0] + s * bottom[-1]
    high = (1 - s) * top[0] + s * top[-1]
    return ruled - (1 - t) * low - t * high
