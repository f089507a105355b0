"""E_unit: every row has norm one. Steps are normalised, so its value is rounding alone."""

import numpy as np

from ...arrays import FloatArray
from ...solvers.blocks import Block
from ...spheres.minkowski import minkowski, minkowski_gradient
from .second_derivatives import SecondDerivatives
from .setting import Group, Setting, Unknowns


def blocks(setting: Setting) -> tuple[Block, ...]:
    """What each residual depends on: a face, with one row."""
    return (Block(Group.SPHERE, np.arange(setting.n_faces)),)


def residuals(setting: Setting, unknowns: Unknowns) -> FloatArray:  # noqa: ARG001 - as all terms
    """``|B|² - 4 A C - 1`` of each face, (F,).

    References
    ----------
    Meshes with Spherical Faces, eq. (8).
    """
    return minkowski(unknowns.spheres, unknowns.spheres) - 1


def jacobian(setting: Setting, unknowns: Unknowns) -> tuple[FloatArray, ...]:  # noqa: ARG001
    """Derivatives by the row of the face: ``(-4 C, 2 B, -4 A)``, (F, 5)."""
    return (2 * minkowski_gradient(unknowns.spheres),)


def second_derivatives(
    setting: Setting,  # noqa: ARG001 - as all terms
    unknowns: Unknowns,  # noqa: ARG001
    multipliers: FloatArray,
) -> SecondDerivatives:
    """Second derivatives of the residuals, each times its multiplier: twice the product's."""
    return {(0, 0): 2 * multipliers[:, None, None] * minkowski_gradient(np.eye(5))}
