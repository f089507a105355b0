"""The line of centres of two spheres, without dividing by a curvature.

``D = A B' - A' B`` is the vector between the centres times ``2 A A'``; it does not depend on
the origin and vanishes for two planes.
"""

import numpy as np

from ...arrays import FloatArray, IntArray, dot, gather
from ...spheres.incidence import normals
from .setting import Setting, Unknowns


def center_lines(setting: Setting, unknowns: Unknowns) -> FloatArray:
    """Vectors ``D = A B' - A' B`` across the interior edges, (E, 3).

    Normals of the planes in which neighbours meet, not of unit length.
    """
    first, second = (gather(unknowns.spheres, faces) for faces in setting.edge_faces.T)
    b, c = setting.edge_middles
    return first[:, :1] * normals(second, c) - second[:, :1] * normals(first, b)


def center_line_gradients(
    setting: Setting, unknowns: Unknowns, edges: IntArray, directions: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Derivatives of ``D·a``, for vectors a (m, 3), by the rows of the two faces, (m, 5).

    Those by C are zero.
    """
    first, second = (gather(unknowns.spheres, faces[edges]) for faces in setting.edge_faces.T)
    b, c = (gather(middles, edges) for middles in setting.edge_middles)
    return (
        _gradient(normals(second, c) + 2 * second[:, :1] * b, -second[:, :1], directions),
        _gradient(-normals(first, b) - 2 * first[:, :1] * c, first[:, :1], directions),
    )


def center_line_forms(setting: Setting, edges: IntArray, directions: FloatArray) -> FloatArray:
    """Matrices K (m, 5, 5) with ``D·a = Sᵀ K S'``, for vectors a (m, 3)."""
    b, c = (gather(middles, edges) for middles in setting.edge_middles)
    form = np.zeros((len(edges), 5, 5))
    form[:, 0, 0] = 2 * dot(b - c, directions)
    form[:, 0, 1:4] = directions
    form[:, 1:4, 0] = -directions
    return form


def center_line_jacobians(
    setting: Setting, unknowns: Unknowns, edges: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Derivatives of the vectors D by the rows of the two faces, (m, 5, 3)."""
    first, second = (gather(unknowns.spheres, faces[edges]) for faces in setting.edge_faces.T)
    b, c = (gather(middles, edges) for middles in setting.edge_middles)
    results = np.zeros((2, len(edges), 5, 3))
    results[0, :, 0] = normals(second, c) + 2 * second[:, :1] * b
    results[1, :, 0] = -normals(first, b) - 2 * first[:, :1] * c
    results[0, :, 1:4] = -second[:, 0, None, None] * np.eye(3)
    results[1, :, 1:4] = first[:, 0, None, None] * np.eye(3)
    return results[0], results[1]


def _gradient(by_a: FloatArray, by_b: FloatArray, directions: FloatArray) -> FloatArray:
    result = np.zeros((5, len(directions))).T
    result[:, 0] = dot(by_a, directions)
    result[:, 1:4] = by_b * directions
    return result
