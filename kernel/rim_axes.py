"""
Node axes along the boundary: where one plane is given at a node, and edges ask for more.

A beam on the boundary is flat if the axes at its two ends lie in one plane with its edge. At a
node where one beam comes from inside, the axis lies in the plane of that beam, so an axis at
one node leaves one direction at the next: along a side, from corner to corner, all follow from
the first, which is chosen such that none leans more than needed.
"""

import numpy as np

from .arrays import BoolArray, FloatArray, IntArray, dot, norm, unit
from .mesh import Mesh
from .tolerances import RIM_LEAN

TRIALS = 361
"""Directions of the first axis that are tried, twice: over all, then around the best."""


def rim_axes(mesh: Mesh, directions: FloatArray, planes: FloatArray) -> FloatArray:
    """
    Turn the axes of sides of the boundary until their beams are flat.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    directions : (V, 3) float array
        Unit axes; where one plane is given, the direction of it nearest to the normal.
    planes : (V, 3) float array
        Unit normal of the only plane of a node; zero where there is none, NaN where several
        leave one direction.

    Returns
    -------
    (V, 3) float array
        Axes. Sides that would need an axis to lean by more than `RIM_LEAN` from the direction
        given, and boundaries without corners, stay as they are.
    """
    result = directions.copy()
    is_given = np.asarray(planes.any(axis=1))
    for side in _sides(mesh, ~is_given):
        inner = side[1:-1]
        if len(inner) == 0 or not np.isfinite(planes[inner]).all():
            continue
        along = mesh.vertices[side[2:-1]] - mesh.vertices[side[1:-2]]
        turned = _turned(directions[inner], planes[inner], along)
        if turned is not None:
            result[inner] = turned
    return _corner_axes(mesh, result, is_given)


def _next_on_boundary(mesh: Mesh) -> IntArray:
    """Next vertex along the boundary; -1 inside."""
    outer = np.flatnonzero(mesh.topology.twins < 0)
    result = np.full(mesh.n_vertices, -1)
    result[mesh.corners[outer]] = mesh.corners[mesh.topology.next_corners[outer]]
    return result


def _sides(mesh: Mesh, is_corner: BoolArray) -> list[IntArray]:
    """Vertices of the boundary from corner to corner."""
    following = _next_on_boundary(mesh)
    steps: list[int] = following.tolist()
    ends: list[bool] = is_corner.tolist()
    sides: list[IntArray] = []
    for start in np.flatnonzero(is_corner & (following >= 0)).tolist():
        side = [start, steps[start]]
        while not ends[side[-1]]:
            side.append(steps[side[-1]])
        sides.append(np.array(side))
    return sides


def _turned(given: FloatArray, planes: FloatArray, along: FloatArray) -> FloatArray | None:
    """Axes (n, 3) of the nodes of a side that are coplanar one after the other."""
    across = np.cross(planes, given)
    low, high, best = -RIM_LEAN, RIM_LEAN, 0.0
    for _ in range(2):
        first = np.linspace(low, high, TRIALS)
        angles = _followed(first, given, across, planes, along)
        worst = np.abs(angles).max(axis=0)
        best = float(first[worst.argmin()])
        step = (high - low) / (TRIALS - 1)
        low, high = best - step, best + step
    angles = _followed(np.array([best]), given, across, planes, along)[:, 0]
    if np.abs(angles).max() > RIM_LEAN:
        return None
    return np.cos(angles)[:, None] * given + np.sin(angles)[:, None] * across


def _followed(
    first: FloatArray,
    given: FloatArray,
    across: FloatArray,
    planes: FloatArray,
    along: FloatArray,
) -> FloatArray:
    """Angles (n, m) by which the axes of a side turn in their planes, for m first ones."""
    angles = [first]
    for i, edge in enumerate(along):
        turn = angles[-1][:, None]
        axis = np.cos(turn) * given[i] + np.sin(turn) * across[i]
        found = np.cross(planes[i + 1], np.cross(edge, axis))
        found *= np.where(dot(found, given[i + 1]) < 0, -1.0, 1.0)[:, None]
        angles.append(np.arctan2(dot(found, across[i + 1]), dot(found, given[i + 1])))
    return np.array(angles)


def _corner_axes(mesh: Mesh, directions: FloatArray, is_given: BoolArray) -> FloatArray:
    """At corners the axis is the line in which the planes of the two beams meet."""
    following = _next_on_boundary(mesh)
    corners = np.flatnonzero(~is_given & (following >= 0))
    previous = np.full(mesh.n_vertices, -1)
    on_rim = np.flatnonzero(following >= 0)
    previous[following[on_rim]] = on_rim
    beside = np.stack([previous[corners], following[corners]])
    edges = mesh.vertices[beside] - mesh.vertices[corners]
    normals = unit(np.cross(edges, directions[beside]))
    lines = np.cross(normals[0], normals[1])
    use = is_given[beside].all(axis=0) & (norm(lines) > np.sin(RIM_LEAN))
    lines = unit(lines)
    lines *= np.where(dot(lines, directions[corners]) < 0, -1.0, 1.0)[:, None]
    use &= dot(lines, directions[corners]) > np.cos(RIM_LEAN)
    result = directions.copy()
    result[corners[use]] = lines[use]
    return result
