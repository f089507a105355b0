"""
How large a step of a planarisation is: changes as shares of what changes.

A node is planar as well if two of its spheres are one, and two nodes of a short edge may become
one point: such solutions draw all nets near them. So the norm counts the change of the
difference of two neighbouring spheres relative to that difference, and the move of a node
relative to its shortest edge. Measured along a path that makes either vanish, the way has no
end; elsewhere least steps stay least.
"""

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from ...arrays import FloatArray, IntArray, dot, norm
from ...meshes.mesh import mean_edge_length
from ...spheres.rows import recenter
from ...tolerances import ALIKE
from .system import FACE, Net, PlanarSystem

Sparse: TypeAlias = Any
"""A sparse array of SciPy, which has no types for them."""


@dataclass(frozen=True)
class StepNorm:
    """
    What a norm of steps needs at every net.

    Attributes
    ----------
    system : PlanarSystem
        The problem.
    fairness : float
        Weight of the differences, relative to the spheres themselves.
    differences : (5 E, 5 F) sparse array
        From rows to their differences across interior edges, seen from the middle of the edge,
        in the units of the problem.
    """

    system: PlanarSystem
    fairness: float
    differences: Sparse


def step_norm(system: PlanarSystem, fairness: float) -> StepNorm:
    """
    Norm of the steps of a planarisation.

    Parameters
    ----------
    system : PlanarSystem
        The problem.
    fairness : float
        Weight of the differences between neighbouring spheres, relative to the spheres
        themselves.

    Returns
    -------
    StepNorm
        The norm.
    """
    from scipy.sparse import bsr_array

    topology = system.mesh.topology
    first = topology.edge_corners
    blocks = [
        sign * np.swapaxes(recenter(np.eye(FACE), _middles(system, h)[:, None]), 1, 2)
        for sign, h in ((1, first), (-1, topology.twins[first]))
    ]
    neighbors = topology.edge_faces
    count = len(neighbors)
    stacked = system.scales[:, None] * np.stack(blocks, axis=1).reshape(-1, FACE, FACE)
    places = (neighbors.ravel(), 2 * np.arange(count + 1))
    shape = (FACE * count, FACE * system.mesh.n_faces)
    return StepNorm(system, fairness, bsr_array((stacked, *places), shape=shape).tocsr())


def _middles(system: PlanarSystem, corners: IntArray) -> FloatArray:
    """Middles of the edges that leave corners, local to the face of the corner."""
    following = system.mesh.topology.next_corners[corners]
    return (system.corners[corners] + system.corners[following]) / 2


def sphere_metric(size: StepNorm, net: Net) -> Sparse:
    """
    Squared norm of the steps of the spheres.

    Parameters
    ----------
    size : StepNorm
        The norm.
    net : Net
        Where the step starts.

    Returns
    -------
    (5 F, 5 F) sparse array
        Positive definite, in blocks of five.
    """
    from scipy.sparse import diags_array

    apart = (size.differences @ net.rows.ravel()).reshape(-1, FACE)
    squares = dot(apart, apart)
    mean = squares.mean() if len(squares) else 0.0
    weights = np.ones(len(squares))
    np.divide(mean, squares + ALIKE * mean, out=weights, where=squares + mean > 0)
    spread: Sparse = diags_array(size.fairness**2 * np.repeat(weights, FACE))
    own: Sparse = diags_array(np.tile(size.system.scales**2, len(net.rows)))
    result: Sparse = own + size.differences.T @ spread @ size.differences
    return result.tobsr((FACE, FACE))


def node_metric(size: StepNorm, net: Net) -> FloatArray:
    """
    Factors of the squared steps of the nodes in their squared norm.

    Parameters
    ----------
    size : StepNorm
        The norm.
    net : Net
        Where the step starts.

    Returns
    -------
    (V,) float array
        1, or the inverse square of the shortest edge if that is below the mean edge.
    """
    mesh = size.system.mesh
    points = mesh.vertices / mean_edge_length(mesh) + net.shifts
    tails, heads = mesh.corners, mesh.corners[mesh.topology.next_corners]
    shortest = np.ones(mesh.n_vertices)
    lengths = np.maximum(norm(points[heads] - points[tails]), np.sqrt(ALIKE))
    np.minimum.at(shortest, tails, lengths)
    np.minimum.at(shortest, heads, lengths)
    return shortest**-2
