"""Seamless maps to the plane whose coordinate lines follow two given directions.

The coordinates u and v are two scalar problems: u grows by 1 per edge length along the first
direction and not along the second, v the other way round. Only signs and whole-number shifts
tie the faces across the seams, and they are the same for both.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...arrays import BoolArray, FloatArray
from ...errors import InputError
from ...meshes.vertex_fans import VertexFans
from ..field.congruence_mesh import CongruenceMesh
from ..field.frames import CombedFrames
from .boundary_alignment import Alignment, align_boundary, no_alignment
from .coordinate import Coordinate, eliminate, solve_coordinate
from .injectivity import ChartGradients, untangle
from .integer_rounding import ContradictionError, IntegerSolutions, integer_solutions
from .seams import Seams
from .singularity_separation import singular_differences

FOLDED = 0.3
"""A map with more of its faces folded has no room for the steps asked for."""


@dataclass(frozen=True)
class Parametrization:
    """Coordinates at the corners, continuous across all edges up to signs and whole numbers.

    Attributes
    ----------
    charts : ChartGradients
        Coordinates of the corners from those of the vertices.
    values : (V, 2) float array
        Coordinates u and v of every vertex in the chart of its first corner.
    is_flipped : (F,) bool array
        Faces whose image is turned over or has no area.
    n_aligned : int
        Sides of the boundary that are lines of the map.
    n_folded : int
        Faces that were flipped before they were unfolded.
    """

    charts: ChartGradients
    values: FloatArray
    is_flipped: BoolArray
    n_aligned: int
    n_folded: int


def parametrize(
    surface: CongruenceMesh,
    fans: VertexFans,
    frames: CombedFrames,
    seams: Seams,
    edge_length: float,
    spacing: FloatArray | None = None,
    *,
    aligns: bool = True,
) -> Parametrization:
    """Map the cut mesh so that unit steps, in mean edges, follow the directions.

    Singular vertices lie at whole numbers, aligned boundaries half-way between. The spacing
    (V,) is the length of steps at the vertices in that of all; sides of the boundary may be
    left as they are.

    Raises
    ------
    InputError
        If the steps are too long for the surface.

    Notes
    -----
    Least squares of ``|grad u · t1 h - 1|² + w |grad u · t2 h|²``, the same for v. The real
    unknowns are eliminated once; what is left is a small quadratic function of the integers.

    References
    ----------
    Bommes, Zimmer, Kobbelt, Mixed-integer quadrangulation, 2009, for the greedy rounding.
    """
    gradients = _chart_gradients(surface, frames, _steps(surface, edge_length, spacing))
    n_integers = seams.shifts.shape[1]
    found = align_boundary(surface, fans, frames, seams, edge_length) if aligns else ()
    alignments = [_consistent(seams, alignment) for alignment in found] or [
        no_alignment(n_integers), no_alignment(n_integers)
    ]  # fmt: skip
    first, second = gradients.along_first, gradients.along_second
    coordinates = [
        eliminate(surface, seams, alignment, *slopes)
        for alignment, slopes in zip(
            alignments, ((first, second), (second, first)), strict=True
        )
    ]
    differences = singular_differences(surface, seams, edge_length)
    vectors = _solve_apart(coordinates, alignments, seams, differences)
    count = len(surface.points)
    start = np.stack([vector[:count] for vector in vectors], 1)
    is_fixed = np.stack([coordinate.is_fixed for coordinate in coordinates], 1)
    shifts = [
        coordinate.corner_map[:, count:] @ vector[count:]
        for coordinate, vector in zip(coordinates, vectors, strict=True)
    ]
    charts = replace(gradients, signs=seams.signs, shifts=np.stack(shifts, 1))
    folded = charts.determinants(start) <= 0
    if folded.mean() > FOLDED:
        raise InputError(
            f"an edge length of {edge_length * surface.size:g} is too large for the surface: "
            "the net has no room for its steps; choose a smaller one"
        )
    values = untangle(surface, charts, start, is_fixed, edge_length)
    return Parametrization(
        charts, values, charts.determinants(values) <= 0,
        sum(alignment.n_sides for alignment in alignments), int(folded.sum()),
    )  # fmt: skip


def _steps(
    surface: CongruenceMesh, edge_length: float, spacing: FloatArray | None
) -> FloatArray:
    """Length of a step on each face (F,), in mean edges."""
    if spacing is None:
        return np.full(len(surface.triangles), edge_length)
    return edge_length * spacing[surface.triangles].mean(axis=1)


def _chart_gradients(
    surface: CongruenceMesh, frames: CombedFrames, steps: FloatArray
) -> ChartGradients:
    """Derivatives along the two directions, per edge length; signs and shifts are trivial."""
    points = surface.points[surface.triangles]
    opposite = np.roll(points, -2, axis=1) - np.roll(points, -1, axis=1)
    normals = surface.face_frames[:, None, 2]
    slopes = np.cross(normals, opposite) / (2 * surface.face_areas)[:, None, None]
    along: list[FloatArray] = []
    for angles in (frames.first, frames.second):
        circle = np.stack([np.cos(angles), np.sin(angles)], 1)
        directions = np.einsum("fi,fij->fj", circle, surface.face_frames[:, :2])
        along.append(steps[:, None] * np.einsum("fcj,fj->fc", slopes, directions))
    count = 3 * len(surface.triangles)
    return ChartGradients(
        surface.triangles, along[0], along[1], surface.face_areas, np.ones(count),
        np.zeros((count, 2)),
    )  # fmt: skip


def _solve_apart(
    coordinates: list[Coordinate],
    alignments: list[Alignment],
    seams: Seams,
    differences: FloatArray,
) -> list[FloatArray]:
    """Solve both coordinates; singular vertices that fall together are moved a step apart."""
    n_seams, n_singular = seams.shifts.shape[1], len(seams.singular)
    count = len(coordinates[0].is_fixed)
    ties: list[list[tuple[FloatArray, float]]] = [[], []]
    solved = [
        solve_coordinate(coordinate, _allowed(seams, alignment), n_singular)
        for coordinate, alignment in zip(coordinates, alignments, strict=True)
    ]
    for _ in range(len(differences)):
        places = [differences @ vector[count : count + n_seams] for vector, _ in solved]
        together = np.flatnonzero((places[0] == 0) & (places[1] == 0))
        if len(together) == 0:
            break
        wanted = np.stack([differences @ relaxed[:n_seams] for _, relaxed in solved], 1)
        pair = int(together[np.argmax(np.abs(wanted[together]).max(axis=1))])
        axis = int(np.argmax(np.abs(wanted[pair])))
        tie = (differences[pair], float(np.copysign(1.0, wanted[pair, axis])))
        try:
            allowed = _allowed(seams, alignments[axis], [*ties[axis], tie])
        except ContradictionError:
            break
        ties[axis].append(tie)
        solved[axis] = solve_coordinate(coordinates[axis], allowed, n_singular)
    return [vector for vector, _ in solved]


def _allowed(
    seams: Seams, alignment: Alignment, ties: Sequence[tuple[FloatArray, float]] = ()
) -> IntegerSolutions:
    """Integers that satisfy the relations of the seams and sides, and the given differences."""
    n_seams, n_sides = seams.shifts.shape[1], alignment.n_sides
    rows = np.zeros((len(seams.relations) + len(ties), n_seams + n_sides))
    constants = np.zeros(len(rows))
    rows[: len(seams.relations), :n_seams] = seams.relations
    for k, (row, value) in enumerate(ties, len(seams.relations)):
        rows[k, :n_seams], constants[k] = row, value
    return integer_solutions(
        np.concatenate([rows, alignment.relations]),
        np.concatenate([constants, alignment.relation_constants]),
    )


def _consistent(seams: Seams, alignment: Alignment) -> Alignment:
    """The alignment, or none where it contradicts itself or the seams."""
    try:
        _allowed(seams, alignment)
    except ContradictionError:
        return no_alignment(seams.shifts.shape[1])
    return alignment
