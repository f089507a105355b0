"""Curves and directions that a net shall follow, as forms at the vertices of its surface.

One of the two directions runs along a guide, the other across. Which of the two is chosen once
for each smooth stretch of the guides, as the field around it says.
"""

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from ...arrays import BoolArray, ComplexArray, FloatArray, IntArray, dot, norm, unit
from ...errors import InputError
from ...solvers.weighted_graphs import piece_labels
from .congruence_mesh import CongruenceMesh
from .smoothing import Guidance, smooth_forms

GUIDE_REACH = 2.0
"""Distance from a guide, in edges of the net, over which directions turn back."""

SAMPLES = 2
"""Samples of a guide for each mean edge of the surface."""

BENT = np.cos(np.radians(40))
"""Guides that turn by more have a corner: the net may change to the other direction there."""

STEEP = np.sin(np.radians(30))
"""A direction with less of it in the surface says nothing there."""

FIRST_STRETCHES = 8
"""The longest stretches, chosen one after the other; the rest follows the field of these."""

TURNED = np.radians(15)
"""Directions that a guide turns by more leave the conjugate ones."""

BoundaryLines = Literal["near", "follow", "free"]


@dataclass(frozen=True)
class NetWishes:
    """What a net shall follow besides its spheres, in model coordinates.

    Attributes
    ----------
    direction : (3,) float array or None
        Lines run along it where it lies in the surface.
    guides : (n, 2, 3) float array or None
        Segments of curves that lines of the net run along.
    boundary : {"near", "follow", "free"}
        Sides of the boundary become lines where they nearly are; they guide the net; or they
        do neither.
    spacing : (V,) float array or None
        Length of the edges at each vertex of the surface, in edge lengths.
    """

    direction: FloatArray | None = None
    guides: FloatArray | None = None
    boundary: BoundaryLines = "near"
    spacing: FloatArray | None = None

    @property
    def are_guides(self) -> bool:
        """Whether anything but the spheres tells directions."""
        return (
            self.direction is not None or self.guides is not None or self.boundary == "follow"
        )


class _Stretches(NamedTuple):
    """Smooth stretches of guides, seen at the vertices that they pass.

    Of n samples: vertex, doubled direction in its frame, and number of the stretch, 0 for the
    longest.
    """

    vertices: IntArray
    turns: ComplexArray
    labels: IntArray


def guided_forms(
    surface: CongruenceMesh,
    trace: FloatArray,
    deviator: ComplexArray,
    lengths: tuple[float, float],
    wishes: NetWishes,
) -> tuple[FloatArray, ComplexArray]:
    """Smooth a field of forms that also follows guides.

    Parameters
    ----------
    surface : CongruenceMesh
    trace : (V,) float array
    deviator : (V,) complex array
        Of the given forms, in the coordinates of `vertex_frames`.
    lengths : (float, float)
        Distance over which the field is smoothed, and length of the edges of the net, in mean
        edges of the surface.
    wishes : NetWishes

    Returns
    -------
    trace : (V,) float array
        Means of the smooth forms.
    deviator : (V,) complex array
        Their deviators.

    Raises
    ------
    InputError
        If the direction has no length, or no guide lies near the surface.

    Notes
    -----
    A form without trace has the roots ``θ ∓ π/4``: with ``θ = φ ± π/4`` the direction φ is one
    of them. The sign says which, and so which family of lines the guide belongs to.
    """
    smoothing, step = lengths
    if not wishes.are_guides:
        return smooth_forms(surface, trace, deviator, smoothing)
    start = _along_direction(surface, wishes.direction, deviator)
    segments = _segments(surface, wishes)
    if len(segments) == 0:
        return smooth_forms(surface, trace, deviator, smoothing, start)
    found = _stretches(surface, segments, step)
    trust = np.minimum(start.trust, _trust(surface, found.vertices, step))
    wanted = np.zeros(len(trace), complex)
    last = int(found.labels.max())
    for label in range(min(last + 1, FIRST_STRETCHES)):
        is_next = (
            found.labels >= label if label == FIRST_STRETCHES - 1 else found.labels == label
        )
        guidance = Guidance(np.where(wanted != 0, unit_complex(wanted), start.deviators), trust)
        field = smooth_forms(surface, trace, deviator, smoothing, guidance)[1]
        _choose(wanted, found, is_next, field)
    guidance = Guidance(np.where(wanted != 0, unit_complex(wanted), start.deviators), trust)
    return smooth_forms(surface, trace, deviator, smoothing, guidance)


def unit_complex(values: ComplexArray) -> ComplexArray:
    """Numbers of size 1; 0 stays."""
    size = np.abs(values)
    return np.divide(values, size, out=np.zeros_like(values), where=size > 0)


def turned_share(
    surface: CongruenceMesh, given: ComplexArray, guided: ComplexArray, is_sure: BoolArray
) -> float:
    """Share of the area whose directions guides turn away from the conjugate ones.

    Of deviators (V,) before and after; only where the given ones are sure.
    """
    turns = np.abs(np.angle(guided * given.conj())) / 2
    areas = surface.vertex_areas
    return float(areas[(turns > TURNED) & is_sure].sum() / areas.sum())


def _along_direction(
    surface: CongruenceMesh, direction: FloatArray | None, deviator: ComplexArray
) -> Guidance:
    """Guidance by one direction on the whole surface."""
    count = len(surface.points)
    if direction is None:
        return Guidance(np.zeros(count, complex), np.ones(count))
    size = norm(direction)
    if not 0 < size < np.inf:
        raise InputError("the direction that lines shall follow has no length: give a vector")
    tangents = surface.vertex_frames[:, :2] @ (direction / size)
    along = tangents[:, 0] + 1j * tangents[:, 1]
    turns = np.where(np.abs(along) > STEEP, 1j * unit_complex(along) ** 2, 0)
    sign = np.copysign(1.0, (turns.conj() * unit_complex(deviator)).real.sum())
    return Guidance(sign * turns, np.zeros(count))


def _segments(surface: CongruenceMesh, wishes: NetWishes) -> FloatArray:
    """Segments (n, 2, 3) of all guides, in the coordinates of the surface."""
    found: list[FloatArray] = []
    if wishes.guides is not None:
        found.append((np.asarray(wishes.guides, float) - surface.origin) / surface.size)
    if wishes.boundary == "follow":
        rim = np.flatnonzero(surface.topology.twins < 0)
        corners = surface.triangles.ravel()
        ends = np.stack([corners[rim], corners[surface.topology.next_corners[rim]]], 1)
        found.append(surface.points[ends])
    every = np.concatenate(found) if found else np.zeros((0, 2, 3))
    return every[norm(every[:, 1] - every[:, 0]) > 0]


def _stretches(surface: CongruenceMesh, segments: FloatArray, step: float) -> _Stretches:
    """Sample segments at the nearest vertices, no farther than an edge of the net."""
    from scipy.spatial import KDTree

    runs = segments[:, 1] - segments[:, 0]
    lengths = norm(runs)
    counts = np.ceil(SAMPLES * lengths).astype(np.int64)
    owners = np.repeat(np.arange(len(segments)), counts)
    order = np.arange(len(owners)) - np.repeat(np.cumsum(counts) - counts, counts)
    share = (order + 0.5) / counts[owners]
    samples = segments[owners, 0] + share[:, None] * runs[owners]
    near: Any = KDTree(surface.points).query(samples)
    distances: FloatArray = near[0]
    vertices: IntArray = near[1]
    tangents = np.einsum("nij,nj->ni", surface.vertex_frames[vertices, :2], runs[owners])
    along = tangents[:, 0] + 1j * tangents[:, 1]
    is_near = (distances <= step) & (np.abs(along) > STEEP * lengths[owners])
    if not is_near.any():
        raise InputError(
            "the guides lie farther than an edge from the surface, or cross it: draw them on it"
        )
    labels = _stretch_labels(segments)
    sizes = np.bincount(labels, lengths)
    rank = np.empty(len(sizes), np.int64)
    rank[np.argsort(-sizes, kind="stable")] = np.arange(len(sizes))
    return _Stretches(
        vertices[is_near], unit_complex(along[is_near]) ** 2, rank[labels[owners[is_near]]]
    )


def _stretch_labels(segments: FloatArray) -> IntArray:
    """Number of the stretch of each segment: segments that meet two by two, without corners."""
    ends = segments.reshape(-1, 3)
    reach = float(np.abs(ends).max(initial=1.0))
    _, ids = np.unique(np.rint(ends / reach * 1e9), axis=0, return_inverse=True)
    ids = ids.ravel()
    order = np.argsort(ids, kind="stable")
    sizes = np.bincount(ids)
    first = np.cumsum(sizes) - sizes
    pairs = order[first[sizes == 2][:, None] + np.arange(2)]
    out = unit(segments[:, 1] - segments[:, 0])[pairs // 2]
    out = np.where((pairs % 2 == 0)[..., None], out, -out)
    straight = pairs[-dot(out[:, 0], out[:, 1]) > BENT]
    return piece_labels(straight[:, 0] // 2, straight[:, 1] // 2, len(segments))


def _trust(surface: CongruenceMesh, guided: IntArray, step: float) -> FloatArray:
    """How much the given forms count (V,), by the distance from the guides."""
    from scipy.spatial import KDTree

    distances = KDTree(surface.points[np.unique(guided)]).query(surface.points)[0]
    return 1 - np.exp(-((distances / (GUIDE_REACH * step)) ** 2))


def _choose(
    wanted: ComplexArray, found: _Stretches, is_next: BoolArray, field: ComplexArray
) -> None:
    """Add stretches to the forms wanted (V,), with the signs that agree with a field."""
    labels, vertices = found.labels[is_next], found.vertices[is_next]
    turns = 1j * found.turns[is_next]
    votes = np.bincount(labels, (turns.conj() * unit_complex(field[vertices])).real)
    np.add.at(wanted, vertices, np.copysign(1.0, votes[labels]) * turns)
