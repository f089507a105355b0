"""E_reg: the planes in which neighbouring spheres meet stand upright on the surface."""

import numpy as np

from ...arrays import FloatArray, dot
from ...solvers.blocks import Block
from .centers import center_line_forms, center_line_gradients, center_lines
from .second_derivatives import SecondDerivatives
from .setting import Group, Setting, Unknowns


def blocks(setting: Setting) -> tuple[Block, ...]:
    """What each residual depends on: the two faces of an edge; two rows per interior edge."""
    first, second = np.concatenate([setting.edge_faces, setting.edge_faces]).T
    return Block(Group.SPHERE, first), Block(Group.SPHERE, second)


def residuals(setting: Setting, unknowns: Unknowns) -> FloatArray:
    """``D·n_e`` and ``D·e`` over each edge, (2 E,), with D along the line of centres.

    n_e is the sum of the face normals, e the unit vector of the edge. Zero where the plane of
    the circle bisects the two faces, or both spheres are planes.

    References
    ----------
    Meshes with Spherical Faces, Sec. 4.1, with unit edge vectors.
    """
    lines = center_lines(setting, unknowns)
    return np.concatenate(
        [dot(lines, setting.edge_normals), dot(lines, setting.edge_directions)]
    )


def jacobian(setting: Setting, unknowns: Unknowns) -> tuple[FloatArray, ...]:
    """Derivatives by the rows of the two faces, (2 E, 5), in the order of the residuals."""
    edges = np.tile(np.arange(len(setting.edge_faces)), 2)
    directions = np.concatenate([setting.edge_normals, setting.edge_directions])
    return center_line_gradients(setting, unknowns, edges, directions)


def second_derivatives(
    setting: Setting,
    unknowns: Unknowns,  # noqa: ARG001 - as all terms
    multipliers: FloatArray,
) -> SecondDerivatives:
    """Second derivatives of the residuals, each times its multiplier: D is bilinear."""
    edges = np.tile(np.arange(len(setting.edge_faces)), 2)
    directions = np.concatenate([setting.edge_normals, setting.edge_directions])
    return {(0, 1): center_line_forms(setting, edges, multipliers[:, None] * directions)}
