"""E_sphere: every vertex lies on the spheres of its faces."""

import numpy as np

from ...arrays import FloatArray, dot, gather
from ...solvers.blocks import Block
from ...spheres.incidence import evaluate, normals
from .second_derivatives import SecondDerivatives
from .setting import Group, Setting, Unknowns


def blocks(setting: Setting) -> tuple[Block, ...]:
    """What each residual depends on: a face and one of its vertices; a row per corner."""
    return (
        Block(Group.SPHERE, setting.corner_faces),
        Block(Group.VERTEX, setting.corner_vertices),
    )


def residuals(setting: Setting, unknowns: Unknowns) -> FloatArray:
    """``A |v|² - B·v + C`` at each corner, (H,), shifted for an allowance a by ``-A a²``.

    For a unit row it is nearly the signed distance of the vertex from the sphere, in mean
    edges: at distance d it is ``d + A d²``, so ± a gives ± a after the shift.

    References
    ----------
    Meshes with Spherical Faces, eq. (7) and (8); the last row of φ_sphere as printed has a
    wrong sign.
    """
    rows = gather(unknowns.spheres, setting.corner_faces)
    return evaluate(rows, _points(setting, unknowns)) - rows[:, 0] * setting.allowance**2


def jacobian(setting: Setting, unknowns: Unknowns) -> tuple[FloatArray, ...]:
    """Derivatives by the row of the face, (H, 5), and by the point of the vertex, (H, 3).

    ``(|v|² - a², -v, 1)`` with the allowance a, and ``2 A v - B``.
    """
    points = _points(setting, unknowns)
    squares = dot(points, points) - setting.allowance**2
    by_row = np.ones((5, len(points))).T
    by_row[:, 0] = squares
    by_row[:, 1:4] = -points
    return by_row, -normals(gather(unknowns.spheres, setting.corner_faces), points)


def second_derivatives(
    setting: Setting, unknowns: Unknowns, multipliers: FloatArray
) -> SecondDerivatives:
    """Second derivatives of the residuals, each times its multiplier."""
    mixed = np.zeros((len(multipliers), 5, 3))
    mixed[:, 0] = 2 * _points(setting, unknowns)
    mixed[:, 1:4] = -np.eye(3)
    curvatures = unknowns.spheres[setting.corner_faces, 0]
    return {
        (0, 1): multipliers[:, None, None] * mixed,
        (1, 1): (2 * multipliers * curvatures)[:, None, None] * np.eye(3),
    }


def _points(setting: Setting, unknowns: Unknowns) -> FloatArray:
    return setting.corners + gather(unknowns.displacements, setting.corner_vertices)
