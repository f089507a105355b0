"""Gauss-Newton steps towards planar nodes: the norm of the damping, the elimination of nodes.

A node is planar as well if two of its spheres are one, and two nodes of a short edge may become
one point: such solutions draw all nets near them. So the norm of a step counts the change of
the difference of two neighbouring spheres relative to that difference, and the move of a node
relative to its shortest edge. Measured along a path that makes either vanish, the way has no
end; elsewhere least steps stay least.

Nodes are coupled with faces alone: their unknowns are eliminated in one batch, and a sparse
system of the faces is left. Spheres that meet at small angles hardly hold their node, so the
inverse of its 7 by 7 block is large, and taken times the coupling twice from the blocks of the
faces it would leave their difference to rounding. The same difference is ``Jᵀ P J`` with J the
derivatives by the faces and P what the node leaves of its residuals: a projection, when nothing
is damped. The singular values of the node's own derivatives give P to the last digit.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...arrays import FloatArray, IntArray, batches_by_count, dot, norm, sum_by
from ...meshes.mesh import mean_edge_length
from ...solvers.blocks import block_diagonal
from ...solvers.factorization import SparseArray, factorize_symmetric
from ...solvers.levenberg_marquardt import DampedStep
from ...spheres.minkowski import minkowski
from ...spheres.rows import recenter
from ...tolerances import ALIKE, PLANAR_DAMPING
from .conditions import (
    FACE,
    NODE,
    POINT,
    CornerJacobian,
    NetState,
    PlanarSystem,
    Residuals,
    corner_jacobian,
    planar_residuals,
    split_step,
)

REFINEMENTS = 2
"""How often a step is refined."""


@dataclass(frozen=True)
class StepNorm:
    """What a norm of steps needs at every net.

    Attributes
    ----------
    fairness : float
        Weight of the differences, relative to the spheres themselves.
    differences : (5 E, 5 F) sparse array
        From rows to their differences across interior edges, seen from the middle of the edge,
        in the units of the problem.
    """

    system: PlanarSystem
    fairness: float
    differences: SparseArray


def step_norm(system: PlanarSystem, fairness: float) -> StepNorm:
    """Norm of the steps of a planarisation, which damping multiplies at every net.

    The fairness weighs the differences between neighbouring spheres, relative to the spheres
    themselves.
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


def _sphere_metric(size: StepNorm, net: NetState) -> SparseArray:
    """Squared norm (5 F, 5 F) of the steps of the spheres, in blocks of five."""
    from scipy.sparse import diags_array

    apart = (size.differences @ net.rows.ravel()).reshape(-1, FACE)
    squares = dot(apart, apart)
    mean = squares.mean() if len(squares) else 0.0
    weights = np.ones(len(squares))
    np.divide(mean, squares + ALIKE * mean, out=weights, where=squares + mean > 0)
    spread: SparseArray = diags_array(size.fairness**2 * np.repeat(weights, FACE))
    own: SparseArray = diags_array(np.tile(size.system.scales**2, len(net.rows)))
    result: SparseArray = own + size.differences.T @ spread @ size.differences
    return result.tobsr((FACE, FACE))


def _node_metric(size: StepNorm, net: NetState) -> FloatArray:
    """Factors (V,) of the squared steps of the nodes in their squared norm.

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


def linearize(
    system: PlanarSystem, net: NetState, size: StepNorm
) -> Callable[[float], DampedStep]:
    """Gauss-Newton steps from a net: from a damping, which multiplies the norm, to the step.

    Notes
    -----
    Faces are left coupled where they share a node, nine blocks of 5 by 5 in a row of the matrix
    on quads. What rounding leaves in it would come out as a move along which nothing changes:
    the step is refined by the gradient that the derivatives themselves give.
    """
    from scipy.sparse import bsr_array

    mesh = system.mesh
    jacobian, miss = corner_jacobian(system, net), planar_residuals(system, net)
    held = system.site(net).slopes
    factors = list(_factored_nodes(system, net, jacobian, held))
    mixed = jacobian.by_face.transpose(0, 2, 1) @ jacobian.by_node
    shape = (FACE * mesh.n_faces, NODE * mesh.n_vertices)
    # Corners are stored face after face: they are the compressed rows of the coupling.
    coupling: SparseArray = bsr_array((mixed, mesh.corners, mesh.offsets), shape=shape)
    dual = 2 * _dual(net.rows)
    units, metric = block_diagonal(dual[:, :, None] * dual[:, None]), _sphere_metric(size, net)
    moving = _node_metric(size, net)
    n_rows = shape[0]

    def _step(damping: float) -> DampedStep:
        damping = max(damping, PLANAR_DAMPING)
        inverse = block_diagonal(_node_inverses(factors, damping * moving))
        reduction = coupling @ inverse
        products = _face_products(system, jacobian, factors, damping * moving)
        solve_faces = factorize_symmetric(products + units + damping * metric)
        step, ahead = np.zeros(sum(shape)), miss
        for _ in range(1 + REFINEMENTS):
            face_slope, node_slope = _slopes(system, net, jacobian, held, ahead)
            face_slope += damping * (metric @ step[:n_rows])
            node_slope += damping * np.repeat(moving, NODE) * step[n_rows:]
            rows = solve_faces(reduction @ node_slope - face_slope)
            step[:n_rows] += rows
            step[n_rows:] -= inverse @ (node_slope + coupling.T @ rows)
            ahead = _advanced(system, net, jacobian, miss, held, step)
        return DampedStep(step, float(sum((r**2).sum() for r in ahead)))

    return _step


def _slopes(
    system: PlanarSystem,
    net: NetState,
    jacobian: CornerJacobian,
    held: FloatArray,
    miss: Residuals,
) -> tuple[FloatArray, FloatArray]:
    """Products Jᵀr of the faces (5 F,) and of the nodes (7 V,)."""
    mesh = system.mesh
    by_face = np.einsum("hri,hr->hi", jacobian.by_face, miss.corners)
    by_node = np.einsum("hri,hr->hi", jacobian.by_node, miss.corners)
    faces = sum_by(mesh.topology.corner_faces, by_face, mesh.n_faces)
    faces += 2 * miss.rows[:, None] * _dual(net.rows)
    nodes = sum_by(mesh.corners, by_node, mesh.n_vertices)
    nodes[:, POINT:] += 2 * miss.normals[:, None] * net.normals
    nodes += np.einsum("vki,vk->vi", held, miss.sites)
    return faces.ravel(), nodes.ravel()


def _advanced(
    system: PlanarSystem,
    net: NetState,
    jacobian: CornerJacobian,
    miss: Residuals,
    held: FloatArray,
    step: FloatArray,
) -> Residuals:
    """Residuals after a step, as the linear model has them."""
    mesh = system.mesh
    rows, shifts, common = split_step(step, mesh.n_faces)
    at_faces = rows[mesh.topology.corner_faces]
    at_nodes = np.concatenate([shifts, common], axis=1)[mesh.corners]
    corners = np.einsum("hri,hi->hr", jacobian.by_face, at_faces)
    corners += np.einsum("hri,hi->hr", jacobian.by_node, at_nodes)
    return Residuals(
        miss.corners + corners,
        miss.rows + 2 * minkowski(net.rows, rows),
        miss.normals + 2 * dot(net.normals, common),
        miss.sites + np.einsum("vki,vi->vk", held, np.concatenate([shifts, common], axis=1)),
    )


def _dual(rows: FloatArray) -> FloatArray:
    """Coefficients (F, 5) of the linear forms ``<<S, .>>``."""
    return np.concatenate([-2 * rows[:, 4:], rows[:, 1:4], -2 * rows[:, :1]], axis=1)


class _NodeFactors(NamedTuple):
    """Singular values of the derivatives of n nodes with k corners each."""

    nodes: IntArray
    corners: IntArray
    """Corners (n, k) of the nodes."""
    left: FloatArray
    """Left singular vectors (n, 2 k, 7), their rows of the corners."""
    values: FloatArray
    """Singular values (n, 7)."""
    right: FloatArray
    """Right singular vectors (n, 7, 7), in rows."""


def _factored_nodes(
    system: PlanarSystem, net: NetState, jacobian: CornerJacobian, held: FloatArray
) -> Iterator[_NodeFactors]:
    """Factors of the derivatives of all residuals by the unknowns of each node."""
    mesh, n_sites = system.mesh, held.shape[1]
    for nodes, corners in batches_by_count(mesh.corners, mesh.n_vertices):
        n_corner_rows = 2 * corners.shape[1]
        # At least as many rows as unknowns, so that there are vectors for all of these.
        n_rows = max(n_corner_rows + 1 + n_sites, NODE)
        rows = np.zeros((len(nodes), n_rows, NODE))
        rows[:, :n_corner_rows] = jacobian.by_node[corners].reshape(-1, n_corner_rows, NODE)
        rows[:, n_corner_rows, POINT:] = 2 * net.normals[nodes]
        rows[:, n_corner_rows + 1 : n_corner_rows + 1 + n_sites] = held[nodes]
        left, values, right = np.linalg.svd(rows, full_matrices=False)
        yield _NodeFactors(nodes, corners, left[:, :n_corner_rows], values, right)


def _node_inverses(factors: list[_NodeFactors], weights: FloatArray) -> FloatArray:
    """Inverses (V, 7, 7) of ``JᵀJ + w`` of the nodes, with their damping w above 0."""
    result = np.eye(NODE) / weights[:, None, None]
    for nodes, _, _, values, right in factors:
        scale = 1 / (values**2 + weights[nodes, None])
        result[nodes] = right.transpose(0, 2, 1) @ (scale[..., None] * right)
    return result


def _face_products(
    system: PlanarSystem,
    jacobian: CornerJacobian,
    factors: list[_NodeFactors],
    weights: FloatArray,
) -> SparseArray:
    """What the corners give to the system (5 F, 5 F) of the faces without the nodes."""
    from scipy.sparse import bsr_array

    n_faces = system.mesh.n_faces
    corner_faces = system.mesh.topology.corner_faces
    blocks: list[FloatArray] = []
    pairs: list[IntArray] = []
    for nodes, corners, left, values, _ in factors:
        count, valence = corners.shape
        damped = weights[nodes, None] / (values**2 + weights[nodes, None])
        kept = np.eye(2 * valence) - (left * (1 - damped)[:, None]) @ left.transpose(0, 2, 1)
        by_face = jacobian.by_face[corners]
        spread = kept.reshape(count, valence, 2, valence, 2).transpose(0, 1, 3, 2, 4)
        ahead = by_face.transpose(0, 1, 3, 2)[:, :, None] @ spread @ by_face[:, None]
        faces = corner_faces[corners]
        blocks.append(ahead.reshape(-1, FACE * FACE))
        pairs.append((faces[:, :, None] * n_faces + faces[:, None]).ravel())
    places, ids = np.unique(np.concatenate(pairs), return_inverse=True)
    data = sum_by(ids, np.concatenate(blocks), len(places)).reshape(-1, FACE, FACE)
    ends = np.searchsorted(places, np.arange(n_faces + 1) * n_faces)
    shape = (FACE * n_faces, FACE * n_faces)
    return bsr_array((data, places % n_faces, ends), shape=shape)
