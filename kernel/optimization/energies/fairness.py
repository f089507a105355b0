"""E_fair: every interior vertex lies near the mean of its neighbours."""

import numpy as np

from ...arrays import FloatArray
from ...solvers.blocks import Block
from .second_derivatives import SecondDerivatives
from .setting import Group, Setting, Unknowns


def blocks(setting: Setting) -> tuple[Block, ...]:
    """What each residual depends on: an interior vertex and its neighbours; three rows each."""
    rings = (setting.node_vertices, *setting.ring_vertices.T)
    return tuple(Block(Group.VERTEX, np.repeat(ids, 3)) for ids in rings)


def residuals(setting: Setting, unknowns: Unknowns) -> FloatArray:
    """Umbrella vector of each interior vertex: the vertex minus the mean of its neighbours.

    (3 N,), in mean edges.

    References
    ----------
    Kobbelt, Campagna, Vorsatz, Seidel 1998, Interactive multi-resolution modeling on arbitrary
    meshes, Sec. 3.
    """
    moved = unknowns.displacements
    weights = _weights(setting)
    change = moved[setting.node_vertices] - np.einsum(
        "nk,nkc->nc", weights, moved[setting.ring_vertices]
    )
    return (setting.node_umbrellas + change).ravel()


def jacobian(setting: Setting, unknowns: Unknowns) -> tuple[FloatArray, ...]:  # noqa: ARG001
    """Derivatives by the points of the vertex and of its neighbours, (3 N, 3).

    The identity, and minus one over the valence times it.
    """
    identity = np.eye(3)
    count = len(setting.node_vertices)
    own = np.tile(identity, (count, 1))
    others = (
        (-column[:, None, None] * identity).reshape(3 * count, 3)
        for column in _weights(setting).T
    )
    return own, *others


def second_derivatives(
    setting: Setting,  # noqa: ARG001 - as all terms
    unknowns: Unknowns,  # noqa: ARG001
    multipliers: FloatArray,  # noqa: ARG001
) -> SecondDerivatives:
    """None: the residuals are linear."""
    return {}


def _weights(setting: Setting) -> FloatArray:
    """One over the valence for neighbours, zero where the table is filled up."""
    is_neighbour = setting.ring_vertices != setting.node_vertices[:, None]
    return is_neighbour / np.maximum(is_neighbour.sum(axis=1, keepdims=True), 1)
