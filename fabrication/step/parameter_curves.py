"""Arcs in the parameters of their spheres.

A STEP file need not have them, and readers make their own: OpenCASCADE lays a cubic spline
through 23 points of an arc and takes it for exact to 1e-7 mm, whatever the file says of its
accuracy. On sharply curved panels it is not: these are read as solids that are no good for
Boolean operations (`BOPAlgo_InvalidCurveOnSurface`), and curves in the file are the cure.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, Literal

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, dot, norm, unit
from ..breps.records import BrepBatch
from .digits import last_places, rounded
from .sharing import SharedGeometry

ParameterCurves = Literal["needed", "all", "none"]

_DEGREE: Final = 7
"""Highest of the splines: over the usual arc one polynomial is enough."""

_POLES: Final = (5, 6, 7, 8, 10, 12, 16, 24, 40, 64)
"""How many poles a spline may have; the last are for caps that nearly reach the poles."""

_READERS_POINTS: Final = 23
"""Of the cubic spline that OpenCASCADE makes where a file has none."""

_SHARE: Final = 0.2
"""Of what readers bear, in which splines have to keep to their arcs."""


@dataclass(frozen=True)
class ArcsOnFaces:
    """Splines with so many poles for members of parts that share alike.

    Pairs are edges and the spherical faces that they bound; the numbers (m, n) are poles (u, v)
    and knots of one after another. Without poles there are none.
    """

    members: IntArray
    pairs: tuple[tuple[int, int], ...]
    n_poles: int
    numbers: FloatArray


def arcs_on_faces(
    batch: BrepBatch, shared: SharedGeometry, confusion: float, curves: ParameterCurves
) -> Iterator[ArcsOnFaces]:
    """Splines where they are needed, for all arcs or for none, by their numbers of poles."""
    count = len(shared.members)
    pairs = tuple(
        (edge, f)
        for f, face in enumerate(batch.faces)
        if face.kind == "SPHERICAL_SURFACE"
        for edge, _ in face.ring
        if batch.edges[edge].kind == "CIRCLE"
    )
    counts = np.zeros(count, np.int64)
    if pairs and curves != "none":
        arcs = _Arcs(batch, shared, pairs, confusion)
        bound = _SHARE * confusion
        counts = arcs.pole_counts(bound)
        if curves == "needed":
            counts = np.where(arcs.readers_misses() > bound, counts, 0)
    for n_poles in np.unique(counts).tolist():
        members = np.flatnonzero(counts == n_poles)
        if n_poles:
            yield ArcsOnFaces(members, pairs, n_poles, arcs.numbers(members, n_poles))
        else:
            yield ArcsOnFaces(members, (), 0, np.zeros((len(members), 0)))


def spline_degree(n_poles: int) -> int:
    """Degree of a spline with so many poles: a polynomial as long as there are few."""
    return min(_DEGREE, n_poles - 1)


class _Arcs:
    """Arcs (m, p) on spheres, in the frames of these: z along the poles, x to the seam."""

    def __init__(
        self,
        batch: BrepBatch,
        shared: SharedGeometry,
        pairs: tuple[tuple[int, int], ...],
        confusion: float,
    ) -> None:
        plan, points, directions = shared.plan, shared.points, shared.directions

        def frames(ids: list[int]) -> tuple[FloatArray, FloatArray]:
            origin, axis, start = (
                list(column) for column in zip(*(plan.placements[i] for i in ids), strict=True)
            )
            z = unit(directions[:, axis])
            x = directions[:, start]
            x = unit(x - dot(x, z)[..., None] * z)
            return points[:, origin], np.stack([x, np.cross(z, x), z], axis=2)

        edges, faces = zip(*pairs, strict=True)
        centers, circles = frames([plan.curves[e][1] for e in edges])
        origins, spheres = frames([plan.surfaces[f][1] for f in faces])
        starts, ends = (
            points[:, [getattr(batch.edges[e], end) for e in edges]] - centers
            for end in ("start", "end")
        )
        radii = norm(starts)
        angles = [
            np.arctan2(dot(ray, circles[..., 1, :]), dot(ray, circles[..., 0, :]))
            for ray in (starts, ends)
        ]
        self.firsts = angles[0] % (2 * np.pi)
        self.sweeps = (angles[1] - angles[0]) % (2 * np.pi)
        self.centers = np.einsum("mpij,mpj->mpi", spheres, centers - origins)
        turned = np.einsum("mpij,mpkj->mpki", spheres, circles[..., :2, :])
        self.cosines, self.sines = (radii[..., None] * turned[..., i, :] for i in (0, 1))
        self.radii = norm(self.centers + self.cosines)
        self.places = last_places(shared.sizes, confusion)

    def parameters(self, shares: FloatArray) -> FloatArray:
        """Parameters (m, p, n, 2) at shares (n,) of the arcs."""
        angles = self.firsts[..., None] + self.sweeps[..., None] * shares
        cosine, sine = np.cos(angles)[..., None], np.sin(angles)[..., None]
        x, y, z = np.moveaxis(
            self.centers[..., None, :] + cosine * self.cosines[..., None, :]
            + sine * self.sines[..., None, :],
            -1, 0,
        )  # fmt: skip
        # The arcs lie about u = π.
        u = np.pi + np.arctan2(-y, -x)
        return np.stack([u, np.arctan2(z, np.hypot(x, y))], axis=-1)

    def misses(self, nodes: FloatArray, checks: FloatArray, weights: FloatArray) -> FloatArray:
        """How far splines through nodes miss the arcs of each part, (m,), at their checks."""
        exact = self.parameters(checks)
        change = np.einsum("cn,mpnk->mpck", weights, self.parameters(nodes)) - exact
        change[..., 0] *= np.cos(exact[..., 1])
        return (norm(change) * self.radii[..., None]).max(axis=(1, 2))

    def readers_misses(self) -> FloatArray:
        """How far the spline that a reader makes misses the arcs of each part."""
        return self.misses(*_readers_checks())

    def pole_counts(self, bound: float) -> FloatArray:
        """The fewest poles with which splines keep to the bound; else the most."""
        counts = np.full(len(self.radii), _POLES[-1])
        for n_poles in reversed(_POLES[:-1]):
            counts[self.misses(*_spline_checks(n_poles)) < bound] = n_poles
        return counts

    def numbers(self, members: IntArray, n_poles: int) -> FloatArray:
        knots, nodes, to_poles = _spline(n_poles)
        poles = np.einsum("cn,mpnk->mpck", to_poles, self.parameters(nodes)[members])
        firsts, sweeps = self.firsts[members, :, None], self.sweeps[members, :, None]
        parts = [poles.reshape(*poles.shape[:2], -1), firsts + sweeps * knots]
        numbers = np.concatenate(parts, axis=2)
        turns = self.places[members, None] / self.radii[members]
        return rounded(numbers, turns[..., None]).reshape(len(members), -1)


@lru_cache
def _spline(n_poles: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Knots from 0 to 1, nodes, and the matrix from values at nodes to poles."""
    knots = np.linspace(0.0, 1.0, n_poles - spline_degree(n_poles) + 1)
    # The means of neighbouring knots; both ends are among them.
    degree, full = spline_degree(n_poles), _clamped(knots, n_poles)
    nodes = np.array([full[i + 1 : i + degree + 1].mean() for i in range(n_poles)])
    return knots, nodes, np.linalg.inv(_basis(nodes, knots, n_poles))


def _clamped(knots: FloatArray, n_poles: int) -> FloatArray:
    degree = spline_degree(n_poles)
    return np.concatenate([np.zeros(degree), knots, np.ones(degree)])


def _basis(places: FloatArray, knots: FloatArray, n_poles: int) -> FloatArray:
    from scipy.interpolate import BSpline

    full = _clamped(knots, n_poles)
    return BSpline.design_matrix(places, full, spline_degree(n_poles)).toarray()


@lru_cache
def _spline_checks(n_poles: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Nodes, checks between them, and the matrix from values at nodes to values there."""
    knots, nodes, to_poles = _spline(n_poles)
    checks = (nodes[1:] + nodes[:-1]) / 2
    return nodes, checks, _basis(checks, knots, n_poles) @ to_poles


@lru_cache
def _readers_checks() -> tuple[FloatArray, FloatArray, FloatArray]:
    """As `_spline_checks`, of the spline that OpenCASCADE makes where a file has none."""
    from scipy.interpolate import make_interp_spline

    nodes = np.linspace(0.0, 1.0, _READERS_POINTS)
    checks = (nodes[1:] + nodes[:-1]) / 2
    return nodes, checks, make_interp_spline(nodes, np.eye(_READERS_POINTS), 3)(checks)
