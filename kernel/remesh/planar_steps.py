"""
Gauss-Newton steps towards planar nodes, by elimination of the nodes.

Nodes are coupled with faces alone: their unknowns are eliminated in one batch, and a sparse
system of the faces is left.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from ..arrays import FloatArray, dot, sum_by
from ..solvers.levenberg_marquardt import DampedStep
from ..spheres import minkowski
from .planar_system import (
    FACE,
    NODE,
    POINT,
    CornerJacobian,
    Net,
    PlanarSystem,
    Residuals,
    corner_jacobian,
    residuals,
    split_step,
    sum_blocks,
)
from .step_norm import Sparse, StepNorm, node_metric, sphere_metric


def linearize(system: PlanarSystem, net: Net, size: StepNorm) -> Callable[[float], DampedStep]:
    """
    Gauss-Newton steps from a net.

    Parameters
    ----------
    system : PlanarSystem
        The problem.
    net : Net
        The net.
    size : StepNorm
        The norm that the damping multiplies.

    Returns
    -------
    callable
        From a damping to the step.

    Notes
    -----
    The nodes are eliminated by the inverses of their 7 by 7 blocks. Faces are left coupled
    where they share a node or an edge, nine blocks of 5 by 5 in a row of the matrix on quads.
    """
    from scipy.sparse import bsr_array

    mesh = system.mesh
    jacobian, miss = corner_jacobian(system, net), residuals(system, net)
    held = system.site(net.shifts).slopes
    face_blocks, node_blocks = _diagonal_blocks(system, net, jacobian)
    node_blocks[:, :POINT, :POINT] += held.transpose(0, 2, 1) @ held
    face_slope, node_slope = _slopes(system, net, jacobian, miss)
    node_slope.reshape(-1, NODE)[:, :POINT] += np.einsum("vki,vk->vi", held, miss.sites)
    mixed = jacobian.by_face.transpose(0, 2, 1) @ jacobian.by_node
    shape = (FACE * mesh.n_faces, NODE * mesh.n_vertices)
    # Corners are stored face after face: they are the compressed rows of the coupling.
    coupling: Sparse = bsr_array((mixed, mesh.corners, mesh.offsets), shape=shape)
    faces, metric = _block_diagonal(face_blocks), sphere_metric(size, net)
    moving = node_metric(size, net)[:, None, None] * np.eye(NODE)

    def _step(damping: float) -> DampedStep:
        nodes = np.linalg.inv(node_blocks + damping * moving)
        inverse = _block_diagonal(np.asarray(nodes, np.float64))
        reduction = coupling @ inverse
        matrix = faces + damping * metric - reduction @ coupling.T
        rows = _solve(matrix, reduction @ node_slope - face_slope)
        step = np.concatenate([rows, -(inverse @ (node_slope + coupling.T @ rows))])
        ahead = _advanced(system, net, jacobian, miss, held, step)
        return DampedStep(step, float(sum((r**2).sum() for r in ahead)))

    return _step


def _diagonal_blocks(
    system: PlanarSystem, net: Net, jacobian: CornerJacobian
) -> tuple[FloatArray, FloatArray]:
    """Blocks of JᵀJ of the faces (F, 5, 5) and of the nodes (V, 7, 7)."""
    mesh, by_face, by_node = system.mesh, *jacobian
    products = by_face.transpose(0, 2, 1) @ by_face
    faces = sum_blocks(mesh.topology.corner_faces, products, mesh.n_faces)
    dual = _dual(net.rows)
    faces += 4 * dual[:, :, None] * dual[:, None]
    nodes = sum_blocks(mesh.corners, by_node.transpose(0, 2, 1) @ by_node, mesh.n_vertices)
    nodes[:, POINT:, POINT:] += 4 * net.normals[:, :, None] * net.normals[:, None]
    return faces, nodes


def _slopes(
    system: PlanarSystem, net: Net, jacobian: CornerJacobian, miss: Residuals
) -> tuple[FloatArray, FloatArray]:
    """Products Jᵀr of the faces (5 F,) and of the nodes (7 V,)."""
    mesh = system.mesh
    by_face = np.einsum("hri,hr->hi", jacobian.by_face, miss.corners)
    by_node = np.einsum("hri,hr->hi", jacobian.by_node, miss.corners)
    faces = sum_by(mesh.topology.corner_faces, by_face, mesh.n_faces)
    faces += 2 * miss.rows[:, None] * _dual(net.rows)
    nodes = sum_by(mesh.corners, by_node, mesh.n_vertices)
    nodes[:, POINT:] += 2 * miss.normals[:, None] * net.normals
    return faces.ravel(), nodes.ravel()


def _advanced(
    system: PlanarSystem,
    net: Net,
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
        miss.sites + np.einsum("vki,vi->vk", held, shifts),
    )


def _dual(rows: FloatArray) -> FloatArray:
    """Coefficients (F, 5) of the linear forms ``<<S, .>>``."""
    return np.concatenate([-2 * rows[:, 4:], rows[:, 1:4], -2 * rows[:, :1]], axis=1)


def _block_diagonal(blocks: FloatArray) -> Sparse:
    from scipy.sparse import bsr_array

    count, size = blocks.shape[:2]
    starts = np.arange(count + 1, dtype=np.int64)
    return bsr_array((blocks, starts[:-1], starts), shape=(count * size, count * size))


def _solve(matrix: Sparse, right: FloatArray) -> FloatArray:
    """Solve a definite system: without pivots, in an order that keeps the factors sparse."""
    from scipy.sparse import linalg

    solver: Any = linalg
    factors = solver.splu(
        matrix.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    return np.asarray(factors.solve(right), np.float64)
