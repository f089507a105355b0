"""Meshes on polysurfaces: vertices on the surfaces, faces that meet along common edges."""

from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray, dot, norm
from ..errors import InputError
from ..tolerances import EDGE_MISS, ON_EDGE
from .face_plans import FacePlan, plan_face
from .nurbs import NurbsSurface, evaluate_nurbs, nearest_parameters
from .planar_grids import PlanarMesh, disc_on_boundary, fan_on_sides, grid_on_sides
from .planar_triangles import triangulate_region
from .poles import surface_size
from .row_counts import GridSize, count_rows, edge_lengths_along
from .trimmed_faces import Polysurface, Trim, TrimmedFace, turned_left

_SAMPLES = 65


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
    plans = [plan_face(face, is_even=by_length) for face in faces]
    along = edge_lengths_along(polysurface)
    lengths = np.array([each[-1] for each in along])
    rows = count_rows(polysurface, plans, lengths, size)
    samples = _Samples(polysurface, along, by_length=by_length)
    found: list[FaceMesh] = []
    for i, (face, plan, counts) in enumerate(zip(faces, rows.plans, rows.trims, strict=True)):
        try:
            found.append(_mesh_face(face, plan, counts, samples, size))
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
        even = np.linspace(0, 1, count + 1)
        lengths = self.along[edge]
        if not self.by_length or lengths[-1] == 0:
            return even
        return np.interp(even * lengths[-1], lengths, np.linspace(0, 1, len(lengths)))

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
    samples: _Samples,
    size: GridSize,
) -> FaceMesh:
    sides, ids = [], []
    for loop, numbers in zip(face.loops, counts, strict=True):
        uvs = [
            _trim_parameters(face.surface, trim, int(n), samples)
            for trim, n in zip(loop, numbers, strict=True)
        ]
        sides.append(uvs)
        ids.append([
            samples.trim_vertices(trim, evaluate_nurbs(face.surface, *uv.T).points)
            for trim, uv in zip(loop, uvs, strict=True)
        ])  # fmt: skip
    flat = _grid(plan, sides[0])
    if flat is None:
        rim = [each for loop in ids for each in loop]
        flat = _triangles(face.surface, sides, size)
    else:
        rim = [ids[0][i] for side in plan.sides for i in side]
    boundary = np.concatenate(rim)
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


def _trim_parameters(
    surface: NurbsSurface, trim: Trim, count: int, samples: _Samples
) -> FloatArray:
    """Points (count + 1, 2) of a trim, where the mesh vertices of its edge are."""
    if trim.edge < 0:
        return np.clip(trim.curve(np.linspace(0, 1, count + 1)), *surface.domain.T)
    shares = samples.shares(trim.edge, count)
    points = samples.edges[trim.edge](shares)
    if trim.is_reversed:
        points, shares = points[::-1], 1 - shares[::-1]
    low, high = surface.domain.T
    seeds = np.clip(trim.curve(shares), low, high)
    dense = np.clip(trim.curve(np.linspace(0, 1, _SAMPLES)), low, high)
    near = evaluate_nurbs(surface, *dense.T).points
    tolerance = ON_EDGE * surface_size(surface)
    miss = norm(evaluate_nurbs(surface, *seeds.T).points - points)
    if miss.max() > tolerance:
        away = norm(near[None] - points[:, None])
        best = away.argmin(1)
        is_better = away.min(1) < miss
        is_better[[0, -1]] = False
        seeds = np.where(is_better[:, None], dense[best], seeds)
        miss = norm(evaluate_nurbs(surface, *seeds.T).points - points)
        moved, distances = nearest_parameters(surface, points, seeds)
        is_better = (distances < miss) & (miss > tolerance)
        is_better[[0, -1]] = False
        seeds = np.where(is_better[:, None], moved, seeds)
        miss = np.where(is_better, distances, miss)
    length = samples.along[trim.edge][-1]
    if not miss.max() <= EDGE_MISS * length:
        raise InputError(f"lies {miss.max():.3g} off one of its edges")
    return seeds
