"""Cylinders about node axes as boundary representations."""

import numpy as np

from ...kernel.arrays import FloatArray, unit
from .records import BrepBatch, EdgeBatch, FaceBatch, Ring, brep_batch


def cylinder_batch(
    bases: FloatArray, directions: FloatArray, heights: FloatArray, radius: float
) -> BrepBatch:
    """Closed solids of n cylinders: a cylinder, whose two ends meet in a line, and two discs.

    They begin at discs about the bases (n, 3) and run along unit directions (n, 3).
    """
    x = perpendiculars(directions)
    discs = [bases, bases + heights[:, None] * directions]
    corners = [disc + radius * x for disc in discs]
    radii = np.full((len(bases), 1), radius)
    around = np.concatenate([directions, x], axis=1)
    circles = [np.concatenate([disc, around, radii], axis=1) for disc in discs]
    edges = [
        EdgeBatch(0, 0, "CIRCLE", circles[0]), EdgeBatch(1, 1, "CIRCLE", circles[1]),
        EdgeBatch(0, 1, "LINE", directions),
    ]  # fmt: skip
    ring: Ring = ((0, True), (2, True), (1, False), (2, False))
    faces = [
        FaceBatch("CYLINDRICAL_SURFACE", circles[0], ring),
        FaceBatch("PLANE", np.concatenate([-directions, x], axis=1), ((0, False),), corner=0),
        FaceBatch("PLANE", around, ((1, True),), corner=1),
    ]
    return brep_batch(np.arange(len(bases)), corners, edges, faces)


def perpendiculars(directions: FloatArray) -> FloatArray:
    """Unit vectors at right angles to others."""
    least = np.eye(3)[np.abs(directions).argmin(axis=1)]
    return unit(np.cross(directions, least))
