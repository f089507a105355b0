"""Arcs in the parameters of their spheres.

A STEP file need not have them, and readers make their own: OpenCASCADE lays a cubic spline
through 23 points of an arc and takes it for exact to 1e-7 mm, whatever the file says of its
accuracy. On sharply curved panels it is not: these are read as solids that are no good for
Boolean operations (`BOPAlgo_InvalidCurveOnSurface`), and curves in the file are the cure.
"""

from collections.abc import Iterator
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import Final, Literal

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

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
    pairs = tuple(
        (edge, f)
        for f, face in enumerate(batch.faces)
        if face.kind == "SPHERICAL_SURFACE"
        for edge, _ in face.ring
        if batch.edges[edge].kind == "CIRCLE"
    )
    members = np.arange(len(shared.members))
    if pairs and curves != "none":
        bound = _SHARE * confusion
        arcs = _arcs(batch, shared, pairs)
        is_needed = np.ones(len(members), bool)
        if curves == "needed":
            is_needed = arcs.misses(*_readers_checks()) > bound
        rest = members[is_needed]
        members = members[~is_needed]
        for n_poles in _POLES:
            is_enough = np.ones(len(rest), bool)
            if n_poles != _POLES[-1]:
                is_enough = arcs.of(rest).misses(*_spline_checks(n_poles)) < bound
            found = rest[is_enough]
            if len(found):
                numbers = arcs.of(found).numbers(
                    n_poles, last_places(shared.sizes[found], confusion)
                )
                yield ArcsOnFaces(found, pairs, n_poles, numbers)
            rest = rest[~is_enough]
    if len(members):
        yield ArcsOnFaces(members, (), 0, np.zeros((len(members), 0)))


def spline_degree(n_poles: int) -> int:
    """Degree of a spline with so many poles: a polynomial as long as there are few."""
    return min(_DEGREE, n_poles - 1)


@dataclass(frozen=True)
class _Arcs:
    """Arcs (m, p) on spheres, in the frames of these: z along the poles, x to the seam.

    They begin at angles and sweep others about centres, from which cosines and sines lead to
    angles 0 and π/2; radii are those of the spheres.
    """

    firsts: FloatArray
    sweeps: FloatArray
    centers: FloatArray
    cosines: FloatArray
    sines: FloatArray
    radii: FloatArray

    def of(self, members: IntArray) -> "_Arcs":
        """Arcs of some of the parts."""
        return _Arcs(*(getattr(self, each.name)[members] for each in fields(self)))

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
        change = weights @ self.parameters(nodes) - exact
        change[..., 0] *= np.cos(exact[..., 1])
        return (norm(change) * self.radii[..., None]).max(axis=(1, 2))

    def numbers(self, n_poles: int, places: FloatArray) -> FloatArray:
        """Poles and knots of one spline after another, with digits down to places."""
        knots, nodes, to_poles = _spline(n_poles)
        poles = to_poles @ self.parameters(nodes)
        ends = self.firsts[..., None] + self.sweeps[..., None] * knots
        numbers = np.concatenate([poles.reshape(*poles.shape[:2], -1), ends], axis=2)
        turns = places[:, None] / self.radii
        return rounded(numbers, turns[..., None]).reshape(len(places), -1)


def _arcs(
    batch: BrepBatch, shared: SharedGeometry, pairs: tuple[tuple[int, int], ...]
) -> _Arcs:
    edges = [batch.edges[edge] for edge, _ in pairs]
    centers, circles = _frames(shared, [shared.plan.curves[edge][1] for edge, _ in pairs])
    origins, spheres = _frames(shared, [shared.plan.surfaces[face][1] for _, face in pairs])
    starts, ends = (
        shared.points[:, corners] - centers
        for corners in ([edge.start for edge in edges], [edge.end for edge in edges])
    )
    first, last = (
        np.arctan2(dot(ray, circles[..., 1, :]), dot(ray, circles[..., 0, :]))
        for ray in (starts, ends)
    )
    middles = np.einsum("mpij,mpj->mpi", spheres, centers - origins)
    turned = np.einsum("mpij,mpkj->mpki", spheres, circles[..., :2, :])
    cosines, sines = (norm(starts)[..., None] * turned[..., i, :] for i in (0, 1))
    full = 2 * np.pi
    return _Arcs(
        first % full, (last - first) % full, middles, cosines, sines, norm(middles + cosines)
    )


def _frames(shared: SharedGeometry, ids: list[int]) -> tuple[FloatArray, FloatArray]:
    """Origins (m, p, 3) of placements, and their axes x, y, z in rows."""
    origin, axis, start = np.transpose([shared.plan.placements[i] for i in ids])
    z, x = unit(shared.directions[:, axis]), shared.directions[:, start]
    x = unit(x - dot(x, z)[..., None] * z)
    return shared.points[:, origin], np.stack([x, np.cross(z, x), z], axis=2)


@lru_cache
def _spline(n_poles: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Knots from 0 to 1, nodes, and the matrix from values at nodes to poles."""
    degree = spline_degree(n_poles)
    knots = np.linspace(0.0, 1.0, n_poles - degree + 1)
    # The means of neighbouring knots; both ends are among them.
    nodes = sliding_window_view(_clamped(knots, degree)[1:-1], degree).mean(axis=1)
    return knots, nodes, np.linalg.inv(_basis(nodes, knots, degree))


@lru_cache
def _spline_checks(n_poles: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Nodes, checks between them, and the matrix from values at nodes to values there."""
    knots, nodes, to_poles = _spline(n_poles)
    checks = (nodes[1:] + nodes[:-1]) / 2
    return nodes, checks, _basis(checks, knots, spline_degree(n_poles)) @ to_poles


@lru_cache
def _readers_checks() -> tuple[FloatArray, FloatArray, FloatArray]:
    """As `_spline_checks`, of the spline that OpenCASCADE makes where a file has none."""
    nodes = np.linspace(0.0, 1.0, _READERS_POINTS)
    knots = np.delete(nodes, [1, -2])
    checks = (nodes[1:] + nodes[:-1]) / 2
    to_poles = np.linalg.inv(_basis(nodes, knots, 3))
    return nodes, checks, _basis(checks, knots, 3) @ to_poles


def _clamped(knots: FloatArray, degree: int) -> FloatArray:
    return np.pad(knots, degree, mode="edge")


def _basis(places: FloatArray, knots: FloatArray, degree: int) -> FloatArray:
    """Values of the B-splines at places, a row each: the recursion of de Boor."""
    full = _clamped(knots, degree)
    last = len(knots) - 2
    spans = np.minimum(np.searchsorted(knots, places, side="right") - 1, last) + degree
    values = np.eye(len(full) - 1)[spans]
    for k in range(1, degree + 1):
        widths = full[k:] - full[:-k]
        shares = np.divide(
            places[:, None] - full[:-k], widths, out=np.zeros((len(places), len(widths))),
            where=widths > 0,
        )  # fmt: skip
        rests = np.where(widths > 0, 1 - shares, 0.0)
        values = shares[:, :-1] * values[:, :-1] + rests[:, 1:] * values[:, 1:]
    return values
