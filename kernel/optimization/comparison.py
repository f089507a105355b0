"""Is an optimum better than doing nothing? Angles and misses beside those of other spheres."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..arrays import FloatArray
from ..meshes.mesh import mean_edge_length
from ..sphere_meshes.sphere_mesh import SphereMesh, intersection_angles, vertex_error
from ..tolerances import COMMON_VERTEX, SAME_ANGLES

Kept = Literal["optimum", "planes", "start"]


@dataclass(frozen=True)
class Smoothness:
    """How smoothly spheres meet, and how near they pass to the vertices.

    Attributes
    ----------
    mean, largest : float
        How far angles lie from the target, in radians; the mean by the weights of the edges,
        the largest of edges that have a weight.
    miss : float
        Largest distance of a vertex from one of its spheres, in mean edges.
    """

    mean: float
    largest: float
    miss: float


def smoothness(
    sphere_mesh: SphereMesh, edge_weights: FloatArray, target_angle: float = 0.0
) -> Smoothness:
    """Measure spheres against a target, with (E,) weights."""
    off = np.abs(intersection_angles(sphere_mesh) - target_angle)
    total = float(edge_weights.sum())
    return Smoothness(
        float(edge_weights @ off) / total if total > 0 else 0.0,
        float(off[edge_weights > 0].max(initial=0.0)),
        float(vertex_error(sphere_mesh).max()) / mean_edge_length(sphere_mesh.mesh),
    )


def smoother(
    found: Smoothness, planes: Smoothness, start: Smoothness, allowed_miss: float
) -> Kept:
    """Whether what was found is worse than doing nothing, and what is better.

    Planes are if they meet more smoothly on average, the start if besides its largest angle is
    no larger: an energy of fourth powers may trade one for the other. What misses vertices by
    more than twice what was found misses, and by more than is allowed, is no better.
    """
    limit = max(2 * found.miss, allowed_miss) + COMMON_VERTEX
    same = 1 - SAME_ANGLES
    kept: Kept = "optimum"
    least = found.mean * same
    if planes.miss <= limit and planes.mean < least:
        kept, least = "planes", planes.mean * same
    if start.miss <= limit and start.mean < least and start.largest * same <= found.largest:
        kept = "start"
    return kept
