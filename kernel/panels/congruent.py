"""Identical panels: those that a rigid motion carries onto each other."""

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray, norm
from ..errors import InputError
from ..spheres.arcs import arc_points
from ..tolerances import SAME_PANEL
from .panels import Panels, panel_arcs


@dataclass(frozen=True)
class CongruentPanels:
    """Panels gathered by shape.

    Attributes
    ----------
    labels : (P,) int array
        Shape of each panel, numbered in the order in which they first occur.
    representatives : (K,) int array
        First panel of each shape.
    rotations : (P, 3, 3) float array
        Rotation Q of the motion ``x ↦ Q x + t`` that carries the representative, in its local
        coordinates, onto the panel in those of the panel.
    translations : (P, 3) float array
        Translation t of that motion.
    misses : (P,) float array
        Largest distance of a corner or of the middle of an edge that the motion leaves.
    """

    labels: IntArray
    representatives: IntArray
    rotations: FloatArray
    translations: FloatArray
    misses: FloatArray


def congruent_panels(panels: Panels, tolerance: float = SAME_PANEL) -> CongruentPanels:
    """Find panels that are the same up to a rigid motion.

    The tolerance is how far corners and middles of edges of the same shape may lie apart, in
    mean edges of all panels. Mirror images differ, and so do panels of different moulds.

    Raises
    ------
    InputError
        If the tolerance is not positive.

    Notes
    -----
    Panels are first told apart by their degree, mould, mean edge and moments of inertia. What
    remains together is compared with the first of its kind over all turns of the corners;
    those that miss it are compared with the first among them, and so on.
    """
    if not tolerance > 0:
        raise InputError(f"the tolerance must be positive, not {tolerance}")
    count = panels.n_panels
    representatives = np.full(count, -1)
    rotations = np.tile(np.eye(3), (count, 1, 1))
    translations, misses = np.zeros((count, 3)), np.zeros(count)
    points = _marks(panels)
    reach = tolerance * _mean_edge(panels)
    for degree in np.unique(panels.degrees).tolist():
        left = np.flatnonzero(panels.degrees == degree)
        marks = points[panels.offsets[left][:, None] + np.arange(degree)]
        kinds = _kinds(panels.labels[left], marks, reach)
        while len(left):
            # The first panel of each kind, for every panel.
            _, first, which = np.unique(kinds, return_index=True, return_inverse=True)
            model = first[which]
            turns, shifts, miss = _best_motion(marks[model], marks)
            same = miss <= reach
            same[first] = True
            members = left[same]
            representatives[members] = left[model[same]]
            rotations[members], translations[members] = turns[same], shifts[same]
            misses[members] = miss[same]
            left, marks, kinds = left[~same], marks[~same], kinds[~same]
    found, labels = np.unique(representatives, return_inverse=True)
    # Symmetric panels lie on themselves in several turns.
    rotations[found], translations[found], misses[found] = np.eye(3), 0.0, 0.0
    return CongruentPanels(
        labels.astype(np.int64), found.astype(np.int64), rotations, translations, misses
    )


def _marks(panels: Panels) -> FloatArray:
    """Points (H, 3, 3) of each corner: outer and inner, and the middle of its outer edge."""
    middles = arc_points(panel_arcs(panels), np.zeros(1))[:, 0]
    return np.stack([panels.corners, panels.inner_corners, middles], 1)


def _mean_edge(panels: Panels) -> float:
    chords = norm(panels.corners[panels.next_corners] - panels.corners)
    return float(chords.mean()) if len(chords) else 0.0


def _kinds(labels: IntArray, marks: FloatArray, reach: float) -> IntArray:
    """Numbers that tell most panels of one degree apart; those of equal shape agree."""
    chords = norm(np.roll(marks[:, :, 0], -1, axis=1) - marks[:, :, 0])
    flat = marks.reshape(len(marks), -1, 3)
    centered = flat - flat.mean(axis=1, keepdims=True)
    moments = np.linalg.eigvalsh(np.einsum("nij,nik->njk", centered, centered))
    sizes = np.sqrt(np.maximum(moments[:, -1:], 0.0))
    # Lengths, each of which changes by less than the reach times the number of points when
    # every point moves by the reach.
    lengths = np.divide(moments, sizes, out=np.zeros_like(moments), where=sizes > 0)
    features = np.column_stack([chords.sum(axis=1), lengths])
    kinds = np.unique(labels, return_inverse=True)[1].astype(np.int64)
    for feature in features.T:
        order = np.lexsort((feature, kinds))
        breaks = (np.diff(kinds[order]) > 0) | (
            np.diff(feature[order]) > 4 * flat.shape[1] * reach
        )
        kinds[order] = np.concatenate([[0], np.cumsum(breaks)])
    return kinds


def _best_motion(
    models: FloatArray, marks: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Rigid motions of models onto panels, over all turns of their corners.

    Returns rotations (n, 3, 3), translations (n, 3) and the largest misses (n,).
    """
    count = len(marks)
    turns, shifts = np.tile(np.eye(3), (count, 1, 1)), np.zeros((count, 3))
    misses = np.full(count, np.inf)
    targets = marks.reshape(count, -1, 3)
    middle = targets.mean(axis=1)
    for start in range(marks.shape[1]):
        source = np.roll(models, -start, axis=1).reshape(count, -1, 3)
        pivot = source.mean(axis=1)
        spread = np.einsum("nij,nik->njk", targets - middle[:, None], source - pivot[:, None])
        left, _, right = np.linalg.svd(spread)
        # A rotation, not a mirror image: the least axis gives way.
        left[:, :, 2] *= np.sign(np.linalg.det(left @ right))[:, None]
        turn = left @ right
        shift = middle - np.einsum("njk,nk->nj", turn, pivot)
        moved = np.einsum("njk,nik->nij", turn, source) + shift[:, None]
        miss = norm(moved - targets).max(axis=1)
        better = miss < misses
        turns[better], shifts[better] = turn[better], shift[better]
        misses[better] = miss[better]
    return turns, shifts, misses
