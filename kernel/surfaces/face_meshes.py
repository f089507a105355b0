"""Meshes on polysurfaces: vertices on the surfaces, faces that meet along common edges."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm
from ..errors import InputError
from ..tolerances import EDGE_MISS, EPSILON, ON_EDGE
from .face_plans import FacePlan, RimSamples, plan_face, sample_rim
from .nurbs import NurbsSurface, evaluate_nurbs, nearest_parameters
from .planar_grids import PlanarMesh, disc_on_boundary, fan_on_sides, grid_on_sides
from .planar_triangles import triangulate_region
from .poles import surface_size
from .row_counts import GridSize, count_rows, edge_lengths_along
from .trimmed_faces import Polysurface, Trim, TrimmedFace, turned_left


class FaceMesh(NamedTuple):
    """The mesh on one face of a polysurface.

    Attributes
    ----------
    vertices : (n,) int array
        The vertex of the whole mesh for each point of the face.
    uv : (n, 2) float array
        Where the points are on the surface of the face.
    faces : (m, 3) or (m, 4) int array
        Vertices of the whole mesh, turning as the face does; at a pole some are repeated.
    """

    vertices: IntArray
    uv: FloatArray
    faces: IntArray


class PolysurfaceMesh(NamedTuple):
    """Meshes on the faces of a polysurface, with common vertices on common edges.

    Attributes
    ----------
    points : (V, 3) float array
        The vertices.
    faces : list of FaceMesh
        One for each face.
    """

    points: FloatArray
    faces: list[FaceMesh]


def mesh_polysurface(polysurface: Polysurface, size: GridSize) -> PolysurfaceMesh:
    """Quads, and triangles where there is no better way, on all faces.

    Returns
    -------
    PolysurfaceMesh
        Vertices lie on the surfaces; those on a common edge on that of one of its faces.

    Raises
    ------
    InputError
        If a face cannot be meshed; the message names it by its index.
    """
    faces = [turned_left(face) for face in polysurface.faces]
    polysurface = polysurface._replace(faces=faces)
    by_length = size.edge_length is not None
    rims = [sample_rim(face) for face in faces]
    plans = [
        plan_face(face, rim, is_even=by_length) for face, rim in zip(faces, rims, strict=True)
    ]
    along = edge_lengths_along(polysurface)
    lengths = np.array([each[-1] for each in along])
    rows = count_rows(polysurface, plans, lengths, size)
    samples = _Samples(polysurface, along, by_length=by_length)
    found: list[FaceMesh] = []
    for i, (face, rim) in enumerate(zip(faces, rims, strict=True)):
        try:
            found.append(_mesh_face(face, rows.plans[i], rows.trims[i], (rim, samples), size))
        except InputError as error:
            raise InputError(f"face {i} {error}") from error
    return PolysurfaceMesh(samples.points(), found)


class _Samples:
    """Vertices of the whole mesh: numbered as faces come, each placed by its first face."""

    def __init__(
        self, polysurface: Polysurface, along: list[FloatArray], *, by_length: bool
    ) -> None:
        self.edges, self.along, self.by_length = polysurface.edges, along, by_length
        self.corners: dict[int, int] = {}
        self.inner: dict[int, IntArray] = {}
        self.places: list[FloatArray] = []
        self.count = 0

    def add(self, points: FloatArray) -> IntArray:
        """Add vertices: their ids."""
        ids: IntArray = np.arange(self.count, self.count + len(points))
        self.places.append(points)
        self.count += len(points)
        return ids

    def points(self) -> FloatArray:
        return np.concatenate(self.places)

    def shares(self, edge: int, count: int) -> FloatArray:
        """Shares of the parameters of an edge where its mesh vertices are."""
        lengths = self.along[edge]
        if not self.by_length or lengths[-1] == 0:
            return np.linspace(0, 1, count + 1)
        targets = np.linspace(0, float(lengths[-1]), count + 1)
        steps = np.linspace(0, 1, len(lengths))
        return np.asarray(np.interp(targets, lengths, steps), np.float64)

    def trim_vertices(self, trim: Trim, points: FloatArray) -> IntArray:
        """Ids of the vertices along a trim, its first end included, its last not."""
        start = self.corner(trim.ends[0], points[0])
        if trim.edge < 0:
            return np.full(len(points) - 1, start)
        if trim.edge not in self.inner:
            inner = points[1:-1][::-1] if trim.is_reversed else points[1:-1]
            self.inner[trim.edge] = self.add(inner)
        inner = self.inner[trim.edge]
        if trim.is_reversed:
            inner = inner[::-1]
        return np.concatenate([[start], inner])

    def corner(self, vertex: int, place: FloatArray) -> int:
        if vertex not in self.corners:
            self.corners[vertex] = int(self.add(place[None])[0])
        return self.corners[vertex]


def _mesh_face(
    face: TrimmedFace,
    plan: FacePlan,
    counts: list[IntArray],
    known: tuple[RimSamples, _Samples],
    size: GridSize,
) -> FaceMesh:
    samples = known[1]
    trims = [trim for loop in face.loops for trim in loop]
    uvs, places = _rim_parameters(face.surface, trims, np.concatenate(counts), known)
    ids = [
        samples.trim_vertices(trim, points) for trim, points in zip(trims, places, strict=True)
    ]
    flat = _grid(plan, uvs)
    if flat is None:
        bounds = np.cumsum([0, *map(len, face.loops)])
        flat = _triangles(face.surface, [uvs[a:b] for a, b in pairwise(bounds)], size)
        boundary = np.concatenate(ids)
    else:
        boundary = np.concatenate([ids[i] for side in plan.sides for i in side])
    uv = np.clip(flat.points, *face.surface.domain.T)
    inside = evaluate_nurbs(face.surface, *uv[len(boundary) :].T).points
    vertices = np.concatenate([boundary, samples.add(inside)])
    faces = vertices[flat.faces]
    return FaceMesh(vertices, uv, faces[:, ::-1] if face.is_reversed else faces)


def _grid(plan: FacePlan, uvs: list[FloatArray]) -> PlanarMesh | None:
    """Quads as planned; None where they fold or triangles are planned."""
    sides = [
        np.concatenate([*(uvs[i][:-1] for i in side), uvs[side[-1]][-1:]])
        for side in plan.sides
    ]
    if plan.kind == "grid":
        return grid_on_sides(sides)
    if plan.kind == "fan":
        return fan_on_sides(sides)
    if plan.kind == "disc":
        return disc_on_boundary(np.concatenate([side[:-1] for side in sides]))
    return None


def _triangles(
    surface: NurbsSurface, sides: list[list[FloatArray]], size: GridSize
) -> PlanarMesh:
    """Triangles in the plane to which the mean metric of the surface maps (u, v)."""
    loops = [np.concatenate([uv[:-1] for uv in loop]) for loop in sides]
    jet = evaluate_nurbs(surface, *np.concatenate(loops).T)
    e, f, g = (dot(a, b).mean() for a, b in ((jet.u, jet.u), (jet.u, jet.v), (jet.v, jet.v)))
    if not e * g - f * f > 0:
        raise InputError("has no area")
    metric = np.linalg.cholesky(np.array([[e, f], [f, g]]))
    flat = [loop @ metric for loop in loops]
    steps = np.concatenate([norm(np.roll(loop, -1, 0) - loop) for loop in flat])
    spacing = size.edge_length or float(steps.mean())
    found = triangulate_region(flat, spacing)
    n_rim = sum(map(len, loops))
    inside = found.points[n_rim:] @ np.linalg.inv(metric)
    return PlanarMesh(np.concatenate([*loops, inside]), found.faces)


def _rim_parameters(
    surface: NurbsSurface,
    trims: list[Trim],
    counts: IntArray,
    known: tuple[RimSamples, _Samples],
) -> tuple[list[FloatArray], list[FloatArray]]:
    """Points in (u, v) and in space of all trims, where the mesh vertices of edges are."""
    rim, samples = known
    seeds: list[FloatArray] = []
    points: list[FloatArray] = []
    is_end: list[BoolArray] = []
    lengths: list[FloatArray] = []
    for trim, count in zip(trims, counts.tolist(), strict=True):
        shares = np.linspace(0, 1, count + 1)
        if trim.edge >= 0:
            shares = samples.shares(trim.edge, count)
            along = samples.edges[trim.edge](shares)
            if trim.is_reversed:
                along, shares = along[::-1], 1 - shares[::-1]
        else:
            along = np.full((count + 1, 3), np.nan)
        seeds.append(trim.curve(shares))
        points.append(along)
        ends = np.full(len(shares), trim.edge < 0, np.bool_)
        ends[[0, -1]] = True
        is_end.append(ends)
        length = float(samples.along[trim.edge][-1]) if trim.edge >= 0 else 0.0
        lengths.append(np.full(len(shares), length, np.float64))
    uv, miss, found = _nearest_of_seeds(
        surface,
        rim,
        counts,
        np.clip(np.concatenate(seeds), *surface.domain.T),
        np.concatenate(points),
        np.concatenate(is_end),
    )
    if (miss > EDGE_MISS * np.concatenate(lengths)).any():
        raise InputError(f"lies {np.nanmax(miss):.3g} off one of its edges")
    bounds = np.cumsum(counts + 1)[:-1]
    return np.split(uv, bounds), np.split(found, bounds)


def _nearest_of_seeds(
    surface: NurbsSurface,
    rim: RimSamples,
    counts: IntArray,
    seeds: FloatArray,
    points: FloatArray,
    is_end: BoolArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Parameters of points on edges, their distances from the edges, and their places.

    The curves of an edge and of its trims are the same, but not always their parameters.
    """
    places = evaluate_nurbs(surface, *seeds.T).points
    miss = norm(places - points)
    tolerance = ON_EDGE * surface_size(surface) + 16 * EPSILON * np.abs(places).max()
    is_off = (miss > tolerance) & ~is_end
    if not is_off.any():
        return seeds, miss, places
    # Only its own trim: the other side of a seam is as near.
    owners = np.repeat(np.arange(len(counts)), counts + 1)[is_off]
    away = norm(rim.points[owners] - points[is_off, None])
    is_nearer = away.min(1) < miss[is_off]
    starts = np.where(is_nearer[:, None], rim.uv[owners, away.argmin(1)], seeds[is_off])
    moved, distances = nearest_parameters(surface, points[is_off], starts)
    is_better = distances < miss[is_off]
    seeds[is_off] = np.where(is_better[:, None], moved, seeds[is_off])
    places = evaluate_nurbs(surface, *seeds.T).points
    return seeds, norm(places - points), places
