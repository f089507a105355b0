"""E_dual: dual normals have length one. Steps are normalised: its value is rounding alone."""

import numpy as np

from ...arrays import FloatArray, dot
from ...solvers.blocks import Block
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
