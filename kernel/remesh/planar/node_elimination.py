"""
Elimination of the nodes from a damped Gauss-Newton step, without losing what is left.

Spheres that meet at small angles hardly hold their node, so the inverse of its 7 by 7 block is
large, and taken times the coupling twice from the blocks of the faces it would leave their
difference to rounding. The same difference is ``Jᵀ P J`` with J the derivatives by the faces
and P what the node leaves of its residuals: a projection, when nothing is damped. The singular
values of the node's own derivatives give P to the last digit.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ...arrays import FloatArray, IntArray, batches_by_count, sum_by
from .step_norm import Sparse
from .system import FACE, NODE, POINT, CornerJacobian, Net, PlanarSystem


class NodeFactors(NamedTuple):
    """
    Singular values of the derivatives of nodes with k corners each.

    Attributes
    ----------
    nodes : (n,) int array
        The nodes.
    corners : (n, k) int array
        Their corners.
    left : (n, 2 k, 7) float array
        Left singular vectors, their rows of the corners.
    values : (n, 7) float array
        Singular values.
    right : (n, 7, 7) float array
        Right singular vectors in rows.
    """

    nodes: IntArray
    corners: IntArray
    left: FloatArray
    values: FloatArray
    right: FloatArray


def factor_nodes(
    system: PlanarSystem, net: Net, jacobian: CornerJacobian, held: FloatArray
) -> list[NodeFactors]:
    """
    Factorise the derivatives of all residuals by the unknowns of each node.

    Parameters
    ----------
    system : PlanarSystem
        The problem.
    net : Net
        Where the derivatives are taken.
    jacobian : CornerJacobian
        Derivatives of the residuals of the corners.
    held : (V, s, 3) float array
        Derivatives of the distances of the nodes from where they shall be.

    Returns
    -------
    list of NodeFactors
        One for each number of corners.
    """
    return list(_factored(system, net, jacobian, held))


def _factored(
    system: PlanarSystem, net: Net, jacobian: CornerJacobian, held: FloatArray
) -> Iterator[NodeFactors]:
    mesh, n_sites = system.mesh, held.shape[1]
    for nodes, corners in batches_by_count(mesh.corners, mesh.n_vertices):
        n_corner_rows = 2 * corners.shape[1]
        # At least as many rows as unknowns, so that there are vectors for all of these.
        n_rows = max(n_corner_rows + 1 + n_sites, NODE)
        rows = np.zeros((len(nodes), n_rows, NODE))
        rows[:, :n_corner_rows] = jacobian.by_node[corners].reshape(-1, n_corner_rows, NODE)
        rows[:, n_corner_rows, POINT:] = 2 * net.normals[nodes]
        rows[:, n_corner_rows + 1 : n_corner_rows + 1 + n_sites, :POINT] = held[nodes]
        left, values, right = np.linalg.svd(rows, full_matrices=False)
        yield NodeFactors(nodes, corners, left[:, :n_corner_rows], values, right)


def node_inverses(factors: list[NodeFactors], weights: FloatArray) -> FloatArray:
    """
    Inverses of ``JᵀJ + w`` of the nodes.

    Parameters
    ----------
    factors : list of NodeFactors
        Of the derivatives J.
    weights : (V,) float array
        Damping w of each node, above 0.

    Returns
    -------
    (V, 7, 7) float array
        The inverses.
    """
    result = np.eye(NODE) / weights[:, None, None]
    for nodes, _, _, values, right in factors:
        scale = 1 / (values**2 + weights[nodes, None])
        result[nodes] = right.transpose(0, 2, 1) @ (scale[..., None] * right)
    return result


def face_products(
    system: PlanarSystem,
    jacobian: CornerJacobian,
    factors: list[NodeFactors],
    weights: FloatArray,
) -> Sparse:
    """
    What the corners give to the system of the faces once the nodes are eliminated.

    Parameters
    ----------
    system : PlanarSystem
        The problem.
    jacobian : CornerJacobian
        Derivatives of the residuals of the corners.
    factors : list of NodeFactors
        Of the nodes.
    weights : (V,) float array
        Damping of each node, above 0.

    Returns
    -------
    (5 F, 5 F) sparse array
        Symmetric, positive semidefinite, in blocks of 5 by 5.
    """
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
