"""E_dual: dual normals have length one. Steps are normalised: its value is rounding alone."""

import numpy as np

from ...arrays import FloatArray, dot
from ...solvers.blocks import Block
from .second_derivatives import SecondDerivatives
from .setting import Group, Setting, Unknowns


def blocks(setting: Setting) -> tuple[Block, ...]:
    """What each residual depends on: the dual normal of a node; a row per interior vertex."""
    return (Block(Group.NORMAL, np.arange(len(setting.node_vertices))),)


def residuals(setting: Setting, unknowns: Unknowns) -> FloatArray:  # noqa: ARG001 - as all terms
    """``|n|² - 1`` of each node, (N,).

    References
    ----------
    Meshes with Spherical Faces, Sec. 4.1.
    """
    return dot(unknowns.normals, unknowns.normals) - 1


def jacobian(setting: Setting, unknowns: Unknowns) -> tuple[FloatArray, ...]:  # noqa: ARG001
    """Derivatives by the dual normal: ``2 n``, (N, 3)."""
    return (2 * unknowns.normals,)


def second_derivatives(
    setting: Setting,  # noqa: ARG001 - as all terms
    unknowns: Unknowns,  # noqa: ARG001
    multipliers: FloatArray,
) -> SecondDerivatives:
    """Second derivatives of the residuals, each times its multiplier: ``2 I``."""
    return {(0, 0): 2 * multipliers[:, None, None] * np.eye(3)}
