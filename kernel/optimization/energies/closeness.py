"""E_close: vertices stay where they were."""

import numpy as np

from ...arrays import FloatArray
from ...solvers.blocks import Block
from .second_derivatives import SecondDerivatives
from .setting import Group, Setting, Unknowns


def blocks(setting: Setting) -> tuple[Block, ...]:
    """What each residual depends on: a vertex, with three rows."""
    return (Block(Group.VERTEX, np.repeat(np.arange(setting.n_vertices), 3)),)


def residuals(setting: Setting, unknowns: Unknowns) -> FloatArray:  # noqa: ARG001 - as all terms
    """Displacement of each vertex, (3 V,), in mean edges."""
    return unknowns.displacements.ravel()


def jacobian(setting: Setting, unknowns: Unknowns) -> tuple[FloatArray, ...]:  # noqa: ARG001
    """Derivatives by the point of the vertex: identities (3 V, 3)."""
    return (np.tile(np.eye(3), (setting.n_vertices, 1)),)


def second_derivatives(
    setting: Setting,  # noqa: ARG001 - as all terms
    unknowns: Unknowns,  # noqa: ARG001
    multipliers: FloatArray,  # noqa: ARG001
) -> SecondDerivatives:
    """None: the residuals are linear."""
    return {}
