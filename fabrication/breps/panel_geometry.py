"""Where panels stand, their tolerances and axes: for all solids alike."""

from collections.abc import Sequence

import numpy as np

from ...kernel.arrays import BoolArray, FloatArray, IntArray, dot, norm, unit
from ...kernel.errors import InputError
from ...kernel.panels.congruent import CongruentPanels
from ...kernel.panels.panels import Panels, move_origins, scale_panels
from ...kernel.spheres.arcs import Arcs
from ...kernel.spheres.incidence import signed_distance
from ...kernel.tolerances import EPSILON

CONFUSION = 1e-7
"""Distance below which OpenCASCADE takes points for one; meant for millimetres."""


def rounded_origins(origins: FloatArray) -> FloatArray:
    """Origins (n, 3) with the decimals that leave the farthest ten digits: short in a file."""
    farthest = float(np.abs(origins).max(initial=0.0))
    decimals = 10 - int(np.ceil(np.log10(farthest))) if farthest > 0 else 0
    return np.round(origins, decimals)


def panels_in_place(panels: Panels, scale: float) -> Panels:
    """Panels in another unit, `scale` per model unit, about rounded origins.

    The remainders of their origins are in the local numbers.
    """
    panels = scale_panels(panels, scale)
    return move_origins(panels, rounded_origins(panels.origins))


def copy_places(panels: Panels, same: CongruentPanels, scale: float) -> FloatArray:
    """Where the body of the first of identical panels stands for each of them.

    Origins, z and x axes (P, 9) for the bodies of the representatives, made about the rounded
    origins of all panels (`panels_in_place`); the scale is new units per model unit.
    """
    origins = panels.origins * scale
    models = same.representatives[same.labels]
    remainders = (rounded_origins(origins) - origins)[models]
    shifts = same.translations * scale + np.einsum("pij,pj->pi", same.rotations, remainders)
    turns = same.rotations
    return np.concatenate([origins + shifts, turns[:, :, 2], turns[:, :, 0]], axis=1)


def panel_tolerances(panels: Panels, confusion: float = CONFUSION) -> FloatArray:
    """Tolerances (P,) of panels: how far corners miss surfaces, or large numbers are rounded.

    At least the confusion, in the unit of the panels. Raises InputError if a panel has numbers
    that are not finite.
    """
    owners, previous = panels.corner_panels, np.empty(len(panels.corners), np.int64)
    previous[panels.next_corners] = np.arange(len(previous))
    misses = np.zeros(len(previous))
    for rows, corners in (
        (panels.spheres, panels.corners),
        (panels.inner_spheres, panels.inner_corners),
    ):
        misses = np.maximum(misses, np.abs(signed_distance(rows[owners], corners)))
        for planes in (np.arange(len(previous)), previous):
            level = dot(panels.plane_normals[planes], corners) - panels.plane_offsets[planes]
            misses = np.maximum(misses, np.abs(level))
    curvature = np.abs(panels.spheres[:, 0])
    radius = np.divide(0.5, curvature, out=np.zeros_like(curvature), where=curvature > 0)
    rounding = 8 * EPSILON * np.maximum(radius, norm(panels.origins))
    missing = 2 * np.maximum.reduceat(misses, panels.offsets[:-1])
    tolerances = np.maximum(confusion, np.maximum(rounding, missing))
    check_finite("panel", panels.ids, np.isfinite(tolerances))
    return tolerances


def check_finite(kind: str, ids: Sequence[str], is_finite: BoolArray) -> None:
    """Refuse parts that are not finite, at which OpenCASCADE would crash, by an InputError."""
    broken = [ids[i] for i in np.flatnonzero(~is_finite).tolist()]
    if broken:
        raise InputError(f"{kind} {broken[0]} ({len(broken)} in all) is not finite")


def surface_frames(rows: FloatArray, arcs: Arcs, offsets: IntArray) -> FloatArray:
    """Axes x, y, z of the surfaces of panels, unit vectors in rows: (P, 3, 3).

    From their unit rows (P, 5), H edges on them, and the bounds (P + 1,) of the edges of each.
    The axes of a sphere point from the panel to the centre, along the first edge of the panel,
    and across: the patch lies about u = π, v = 0, away from the seam and the poles. Those of a
    plane: along the first edge, across, along N.
    """
    first = offsets[:-1]
    chords = arcs.ends[first] - arcs.starts[first]
    is_plane = rows[:, 0] == 0
    inward = unit(rows[:, 1:4]) * np.where(rows[:, :1] < 0, -1.0, 1.0)
    along = unit(chords - dot(chords, inward)[:, None] * inward)
    across = np.cross(inward, along)
    spherical = np.stack([inward, along, across], 1)
    plane = np.stack([along, across, inward], 1)
    return np.where(is_plane[:, None, None], plane, spherical)
