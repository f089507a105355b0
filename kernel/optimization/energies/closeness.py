"""E_close: vertices stay where they were."""

import numpy as np

from ...arrays import FloatArray
from ...solvers.blocks import Block
from .setting import Group, Setting, Unknowns


def blocks(setting: Setting) -> tuple[Block, ...]:
    """What each residual depends on: a vertex.

    Returns
    -------
    tuple of Block
        Three rows per vertex.
    """
    return (Block(Group.VERTEX, np.repeat(np.arange(setting.n_vertices), 3)),)


def residuals(setting: Setting, unknowns: Unknowns) -> FloatArray:  # noqa: ARG001 - as all terms
    """Displacement of each vertex.

    Returns
    -------
    (3 V,) float array
        Residuals, in mean edges.
    """
    return unknowns.displacements.ravel()


def jacobian(setting: Setting, unknowns: Unknowns) -> tuple[FloatArray, ...]:  # noqa: ARG001
    """Derivatives by the point of the vertex.

    Returns
    -------
    tuple of one (3 V, 3) float array
        Identities.
    """
    return (np.tile(np.eye(3), (setting.n_vertices, 1)),)
