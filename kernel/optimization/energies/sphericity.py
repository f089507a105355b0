"""E_sphere: every vertex lies on the spheres of its faces."""

import numpy as np

from ...arrays import FloatArray, dot
from ...solvers.blocks import Block
from ...spheres.incidence import evaluate, normals
from .setting import Group, Setting, Unknowns


def blocks(setting: Setting) -> tuple[Block, ...]:
    """What each residual depends on: a face and one of its vertices; a row per corner."""
    return (
        Block(Group.SPHERE, setting.corner_faces),
        Block(Group.VERTEX, setting.corner_vertices),
    )


def residuals(setting: Setting, unknowns: Unknowns) -> FloatArray:
    """What ``A |v|² - B·v + C`` exceeds the allowance by, at each corner, (H,).

    For a unit row it is nearly the signed distance of the vertex from the sphere, in mean
    edges.

    References
    ----------
    Meshes with Spherical Faces, eq. (7) and (8); the last row of φ_sphere as printed has a
    wrong sign.
    """
    misses = _centered_misses(setting, unknowns)
    return misses - np.clip(misses, -setting.allowance, setting.allowance)


def _vertex_misses(setting: Setting, unknowns: Unknowns) -> FloatArray:
    """``A |v|² - B·v + C`` at each corner: nearly the distance of vertex and sphere."""
    return evaluate(unknowns.spheres[setting.corner_faces], _points(setting, unknowns))


def jacobian(setting: Setting, unknowns: Unknowns) -> tuple[FloatArray, ...]:
    """Derivatives by the row of the face, (H, 5), and by the point of the vertex, (H, 3).

    ``(|v|² - a², -v, 1)`` with the allowance a, and ``2 A v - B``; zero within a.
    """
    points = _points(setting, unknowns)
    counts = np.abs(_centered_misses(setting, unknowns)) >= setting.allowance
    squares = dot(points, points) - setting.allowance**2
    by_row = np.column_stack([squares, -points, np.ones(len(points))])
    by_point = -normals(unknowns.spheres[setting.corner_faces], points)
    return by_row * counts[:, None], by_point * counts[:, None]


def _centered_misses(setting: Setting, unknowns: Unknowns) -> FloatArray:
    """Misses shifted such that distances of ± the allowance give ± the allowance.

    A vertex at distance d from a unit row misses by ``d + A d²``.
    """
    curvatures = unknowns.spheres[setting.corner_faces, 0]
    return _vertex_misses(setting, unknowns) - curvatures * setting.allowance**2


def _points(setting: Setting, unknowns: Unknowns) -> FloatArray:
    return setting.corners + unknowns.displacements[setting.corner_vertices]
