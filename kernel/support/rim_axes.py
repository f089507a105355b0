"""Node axes along the boundary: where one plane is given at a node, and edges ask for more.

A beam on the boundary is flat if the axes at its two ends lie in one plane with its edge. At a
node where one beam comes from inside, the axis lies in the plane of that beam, so an axis at
one node leaves one direction at the next: along a side, from corner to corner, all follow from
the first, which is chosen such that none leans more than needed. Around a boundary without
corners the last must lead to the first again: as each step is linear in the axis, the first is
an eigenvector of all steps together, and there are two of them or none, or all will do.
"""

from typing import NamedTuple

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, unit
from ..meshes.mesh import Mesh
from ..tolerances import RIM_CLOSED, RIM_LEAN

TRIALS = 361
"""Directions of the first axis that are tried: over all, then around the best."""

SCANS = 4
"""How often they are tried: to a billionth of a radian."""


def rim_axes(mesh: Mesh, directions: FloatArray, planes: FloatArray) -> FloatArray:
    """Turn the axes of sides of the boundary until their beams are flat.

    Unit axes (V, 3): where one plane is given, the direction of it nearest to the normal. The
    planes (V, 3) are unit normals of the only plane of a node; zero where there is none, NaN
    where several leave one direction. Sides that would need an axis to lean by more than
    `RIM_LEAN` from the direction given, sides with an edge of no length, and boundaries without
    corners that no axes fit, stay as they are.
    """
    result = directions.copy()
    is_given = np.asarray(planes.any(axis=1))
    following = _next_on_boundary(mesh)
    sides = [(side[1:-1], _side_angles) for side in _sides(following, ~is_given)]
    loops = [(loop, _loop_angles) for loop in _loops(following, is_given)]
    for nodes, find in (*sides, *loops):
        given, along = directions[nodes], mesh.vertices[following[nodes]] - mesh.vertices[nodes]
        has_lengths = along.any(axis=1).all()
        if len(nodes) == 0 or not (has_lengths and np.isfinite(planes[nodes]).all()):
            continue
        across = np.cross(planes[nodes], given)
        angles = find(_Side(given, across, planes[nodes], along))
        if angles is not None and np.abs(angles).max() <= RIM_LEAN:
            result[nodes] = np.cos(angles)[:, None] * given + np.sin(angles)[:, None] * across
    return _corner_axes(mesh, result, is_given, following)


class _Side(NamedTuple):
    """Nodes of a side, one after the other.

    Attributes
    ----------
    given, across : (n, 3) float array
        Unit vectors of the plane of each node: the axis given, and the direction across it.
    planes : (n, 3) float array
        Unit normals of these planes.
    along : (n, 3) float array
        Edges to the next node.
    """

    given: FloatArray
    across: FloatArray
    planes: FloatArray
    along: FloatArray


def _next_on_boundary(mesh: Mesh) -> IntArray:
    """Next vertex along the boundary; -1 inside."""
    outer = np.flatnonzero(mesh.topology.twins < 0)
    result = np.full(mesh.n_vertices, -1)
    result[mesh.corners[outer]] = mesh.corners[mesh.topology.next_corners[outer]]
    return result


def _sides(following: IntArray, is_corner: BoolArray) -> list[IntArray]:
    """Vertices of the boundary from corner to corner."""
    steps: list[int] = following.tolist()
    ends: list[bool] = is_corner.tolist()
    sides: list[IntArray] = []
    for start in np.flatnonzero(is_corner & (following >= 0)).tolist():
        side = [start, steps[start]]
        while not ends[side[-1]]:
            side.append(steps[side[-1]])
        sides.append(np.array(side))
    return sides


def _loops(following: IntArray, is_given: BoolArray) -> list[IntArray]:
    """Vertices of each boundary that has no corner."""
    steps: list[int] = following.tolist()
    left = set(np.flatnonzero(is_given & (following >= 0)).tolist())
    loops: list[IntArray] = []
    while left:
        loop = [left.pop()]
        while (ahead := steps[loop[-1]]) in left:
            left.remove(ahead)
            loop.append(ahead)
        if steps[loop[-1]] == loop[0]:
            loops.append(np.array(loop))
    return loops


def _side_angles(side: _Side) -> FloatArray:
    """Angles (n,) by which the axes of a side turn, the largest as small as can be."""
    low, high, best = -RIM_LEAN, RIM_LEAN, 0.0
    for _ in range(SCANS):
        first = np.linspace(low, high, TRIALS)
        worst = np.abs(_followed(first, side)).max(axis=0)
        best = float(first[worst.argmin()])
        step = (high - low) / (TRIALS - 1)
        low, high = best - step, best + step
    return _followed(np.array([best]), side)[:, 0]


def _loop_angles(loop: _Side) -> FloatArray | None:
    """Angles (n,) by which the axes of a closed side turn; None where no axes fit."""
    around = np.eye(2)
    for i in range(len(loop.along)):
        around = _step(loop, i) @ around
        around /= np.abs(around).max()
    mean = around.trace() / 2
    if np.abs(around - mean * np.eye(2)).max() <= RIM_CLOSED * abs(mean):
        # Whatever the first axis is, it returns: as on a surface of revolution.
        return _side_angles(loop)
    values, vectors = np.linalg.eig(around)
    if np.iscomplex(values).any():
        return None
    first = np.arctan2(vectors[1].real, vectors[0].real)
    angles = _followed((first + np.pi / 2) % np.pi - np.pi / 2, loop)
    return angles[:, np.abs(angles).max(axis=0).argmin()]


def _step(side: _Side, i: int) -> FloatArray:
    """The linear map (2, 2) from the axis at a node to the axis at the next."""
    ahead = (i + 1) % len(side.along)
    bases = np.stack([side.given, side.across], 1)
    found = np.cross(side.planes[ahead], np.cross(side.along[i], bases[i]))
    return bases[ahead] @ found.T


def _followed(first: FloatArray, side: _Side) -> FloatArray:
    """Angles (n, m) by which the axes of a side turn in their planes, for m first ones."""
    axes = np.stack([np.cos(first), np.sin(first)])
    angles = [first]
    for i in range(len(side.along) - 1):
        axes = _step(side, i) @ axes
        axes *= np.where(axes[0] < 0, -1.0, 1.0) / np.hypot(*axes)
        angles.append(np.arctan2(axes[1], axes[0]))
    return np.array(angles)


def _corner_axes(
    mesh: Mesh, directions: FloatArray, is_given: BoolArray, following: IntArray
) -> FloatArray:
    """At corners the axis is the line in which the planes of the two beams meet."""
    corners = np.flatnonzero(~is_given & (following >= 0))
    previous = np.full(mesh.n_vertices, -1)
    on_rim = np.flatnonzero(following >= 0)
    previous[following[on_rim]] = on_rim
    beside = np.stack([previous[corners], following[corners]])
    edges = mesh.vertices[beside] - mesh.vertices[corners]
    normals = unit(np.cross(edges, directions[beside]))
    lines: FloatArray = unit(np.asarray(np.cross(normals[0], normals[1]), np.float64))
    lines *= np.where(dot(lines, directions[corners]) < 0, -1.0, 1.0)[:, None]
    use = is_given[beside].all(axis=0) & (dot(lines, directions[corners]) > np.cos(RIM_LEAN))
    result = directions.copy()
    result[corners[use]] = lines[use]
    return result
