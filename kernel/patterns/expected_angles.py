"""Angles between neighbours that the curvatures of a surface foretell.

For a surface with the principal curvatures k1 >= k2 and panels whose edges measure E. Angles
are means over the edges around a place, in radians; they are exact to the first order of E.
"""

from collections.abc import Callable

import numpy as np

from ..arrays import FloatArray, norm

DIRECTIONS = 24
"""Directions, over half a turn, that angles of hexagons and triangles are averaged over."""

LATTICE_TURNS = 12
"""Turns, over a sixth of a full one, that even triangles are averaged over."""

MOST_FLIPS = 12
"""Flips of an edge; each halves about what a metric is stretched by."""


def quad_angles(
    first: FloatArray, second: FloatArray, edge: float, curvature: FloatArray | float
) -> FloatArray:
    """Quads along the lines of curvature, with spheres of given curvature that touch.

    Notes
    -----
    The normals of neighbours in the direction i differ by ``k_i E``; towards their common edge
    each sphere turns back by ``K E / 2``: what is left is ``|k_i - K| E``.
    """
    return (np.abs(curvature - first) + np.abs(curvature - second)) * edge / 2


def hexagon_angles(
    first: FloatArray,
    second: FloatArray,
    edge: float,
    curvature: FloatArray | float,
    grown: FloatArray | None = None,
) -> FloatArray:
    """Hexagons of touching spheres; their centres are √3 edges apart.

    The spheres that the hexagons are cut by may be `grown` (V,); those of the curvature, as
    planes, then have the same faces.

    Notes
    -----
    Spheres of the same curvature K that touch at a distance d have an angle of
    ``|(K - S) d|``, S the shape operator: the twist of the surface counts as well. Faces are
    convex where triangles are Delaunay in the metric ``|K - S|``. Where it is far from round,
    edges are flipped, and hexagons are long where neighbours are alike.
    """
    if grown is None:
        return mixed_angles(first, second, np.sqrt(3) * edge, curvature)
    factors = np.stack([curvature - first, curvature - second], -1)[:, None]
    total = np.zeros(len(first))
    for turn in np.pi / 3 * (np.arange(LATTICE_TURNS) + 0.5) / LATTICE_TURNS:
        steps = _reduced_edges(grown - first, grown - second, turn)
        total += norm(steps * factors).mean(axis=1)
    return np.sqrt(3) * edge * total / LATTICE_TURNS


def _reduced_edges(one: FloatArray, other: FloatArray, turn: float) -> FloatArray:
    """Edges (V, 3, 2) of even triangles, turned, once they are Delaunay in a metric.

    The metric has the given sizes along the two axes; where their signs differ it is none, and
    edges stay as they are.

    Notes
    -----
    Selling's reduction: while two of three vectors, whose sum is 0, meet at less than a right
    angle, the edge between them is flipped.
    """
    angles = turn + 2 * np.pi / 3 * np.arange(3)
    edges = np.tile(np.stack([np.cos(angles), np.sin(angles)], -1), (len(one), 1, 1))
    metric = (np.abs(np.stack([one, other], -1)) * (one * other > 0)[:, None])[:, None]
    for _ in range(MOST_FLIPS):
        products = (edges * metric * np.roll(edges, -1, axis=1)).sum(axis=-1)
        worst = products.argmax(axis=1)
        rows = np.flatnonzero(products.max(axis=1) > 0)
        if len(rows) == 0:
            break
        left, right = edges[rows, worst[rows]], edges[rows, (worst[rows] + 1) % 3]
        edges[rows] = np.stack([-left, right, left - right], axis=1)
    return edges


def mixed_angles(
    first: FloatArray, second: FloatArray, distance: float, curvature: FloatArray | float
) -> FloatArray:
    """Touching spheres of given curvature whose neighbours lie at a distance to all sides."""
    one, other = curvature - first, curvature - second
    return distance * _mean_over_directions(
        lambda turn: np.hypot(one * np.cos(turn), other * np.sin(turn))
    )


def triangle_angles(
    first: FloatArray, second: FloatArray, edge: float, curvature: FloatArray | float
) -> FloatArray:
    """Equilateral triangles with vertices on the surface, and spheres through these.

    Notes
    -----
    Planes of neighbours differ by ``(3 k_n - k_t) E / 2√3``, where n lies across the common
    edge and t along it; spheres of curvature K take ``K E / √3`` away.
    """
    mean, half = (first + second) / 2, (first - second) / 2
    return edge / np.sqrt(3) * _mean_over_directions(
        lambda turn: np.abs(mean - curvature + 2 * half * np.cos(2 * turn))
    )  # fmt: skip


def _mean_over_directions(angle: Callable[[float], FloatArray]) -> FloatArray:
    turns = np.pi * (np.arange(DIRECTIONS) + 0.5) / DIRECTIONS
    return sum((angle(float(turn)) for turn in turns[1:]), angle(float(turns[0]))) / DIRECTIONS


def smoothest(first: FloatArray, second: FloatArray) -> FloatArray:
    """Curvature (V,) of the spheres that meet most smoothly: the mean curvature.

    In quads any K between the two gives the same sum of angles.
    """
    return (first + second) / 2


def convex_side(first: FloatArray, second: FloatArray, side: int) -> FloatArray:
    """Curvature (V,) of the largest spheres to one side whose hexagons are convex.

    The side is 1 for centres where the normals point, -1 for those beyond. On that side spheres
    have to bend at least as much as the surface does.
    """
    return np.maximum(first, 0.0) if side > 0 else np.minimum(second, 0.0)
