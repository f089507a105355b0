"""Sides of faces, and which of them are one edge where any number of faces meet."""

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray, batches_by_count, dot, sum_by, unit
from ..tolerances import SAME_LENGTH
from .raw_mesh import RawMesh


@dataclass(frozen=True)
class Sides:
    """The sides of faces, gathered by edges.

    Attributes
    ----------
    edges : (H,) int array
        Edge that leaves each corner, from 0.
    counts : (E,) int array
        How many sides each edge has.
    """

    edges: IntArray
    counts: IntArray


def find_sides(raw: RawMesh) -> Sides:
    """Gather the sides by their two vertices."""
    heads = raw.corners[raw.next_corners]
    key = np.minimum(raw.corners, heads) * len(raw.vertices) + np.maximum(raw.corners, heads)
    _, edges, counts = np.unique(key, return_inverse=True, return_counts=True)
    return Sides(edges.reshape(-1), counts)


def paired_sides(raw: RawMesh, sides: Sides) -> IntArray:
    """Pairs of sides across which the surface goes on.

    Parameters
    ----------
    raw : RawMesh
        Faces without repeated corners.

    Returns
    -------
    (n, 2) int array
        Corners that the two sides leave. Where an edge has more than two faces those two are a
        pair that continue each other best, then of the others those two, and so on.
    """
    pairs = [np.zeros((0, 2), np.int64)]
    directions = _inward(raw) if (sides.counts > 2).any() else np.zeros((0, 3))
    for _, rows in batches_by_count(sides.edges, len(sides.counts)):
        if rows.shape[1] == 2:
            pairs.append(rows)
        elif rows.shape[1] > 2:
            pairs += _straightest_pairs(rows, directions[rows])
    return np.concatenate(pairs)


def _inward(raw: RawMesh) -> FloatArray:
    """Unit vectors (H, 3) across each side into its face."""
    faces = raw.corner_faces
    points = raw.vertices[raw.corners]
    first = points[raw.offsets[:-1]]
    mean = sum_by(faces, points - first[faces], raw.n_faces) / raw.degrees[:, None]
    along = unit(points[raw.next_corners] - points)
    inward = mean[faces] - (points - first[faces])
    return unit(inward - dot(inward, along)[:, None] * along)


def _straightest_pairs(rows: IntArray, inward: FloatArray) -> list[IntArray]:
    """Pairs of the sides (n, k) of crowded edges, the straightest first."""
    count = rows.shape[1]
    edges = np.arange(len(rows))
    cosines = np.einsum("nic,njc->nij", inward, inward)
    cosines[:, *np.tril_indices(count)] = np.inf
    pairs: list[IntArray] = []
    for _ in range(count // 2):
        flat = cosines.reshape(len(rows), -1)
        # Of equally straight pairs the first.
        best = np.argmax(flat <= flat.min(axis=1)[:, None] + SAME_LENGTH, axis=1)
        for chosen in (i := best // count, j := best % count):
            cosines[edges, chosen] = np.inf
            cosines[edges, :, chosen] = np.inf
        pairs.append(np.stack([rows[edges, i], rows[edges, j]], 1))
    return pairs
