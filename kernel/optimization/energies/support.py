"""E_supp: the centres of the spheres around a node lie in a plane, so the node has an axis."""

from ...arrays import FloatArray, dot, gather
from ...solvers.blocks import Block
from .centers import (
    center_line_forms,
    center_line_gradients,
    center_line_jacobians,
    center_lines,
)
from .second_derivatives import SecondDerivatives
from .setting import Group, Setting, Unknowns


def blocks(setting: Setting) -> tuple[Block, ...]:
    """What each residual depends on: the two faces of an edge and the dual normal of a node.

    A row per interior edge and interior vertex at its ends.
    """
    first, second = setting.edge_faces[setting.spoke_edges].T
    return (
        Block(Group.SPHERE, first),
        Block(Group.SPHERE, second),
        Block(Group.NORMAL, setting.spoke_nodes),
    )


def residuals(setting: Setting, unknowns: Unknowns) -> FloatArray:
    """``D·n``, (S,), with D along the line of centres and n the node's dual normal.

    Zero where the plane of the edge's circle contains the node's axis.

    References
    ----------
    Meshes with Spherical Faces, Sec. 4.1.
    """
    lines = gather(center_lines(setting, unknowns), setting.spoke_edges)
    return dot(lines, gather(unknowns.normals, setting.spoke_nodes))


def jacobian(setting: Setting, unknowns: Unknowns) -> tuple[FloatArray, ...]:
    """Derivatives by the rows of the two faces, (S, 5), and by the dual normal, (S, 3)."""
    axes = gather(unknowns.normals, setting.spoke_nodes)
    first, second = center_line_gradients(setting, unknowns, setting.spoke_edges, axes)
    return first, second, gather(center_lines(setting, unknowns), setting.spoke_edges)


def second_derivatives(
    setting: Setting, unknowns: Unknowns, multipliers: FloatArray
) -> SecondDerivatives:
    """Second derivatives of the residuals, each times its multiplier: D·n is trilinear."""
    edges, weights = setting.spoke_edges, multipliers[:, None]
    axes = weights * gather(unknowns.normals, setting.spoke_nodes)
    first, second = center_line_jacobians(setting, unknowns, edges)
    return {
        (0, 1): center_line_forms(setting, edges, axes),
        (0, 2): weights[:, None] * first,
        (1, 2): weights[:, None] * second,
    }
