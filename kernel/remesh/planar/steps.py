"""
Gauss-Newton steps towards planar nodes, by elimination of the nodes.

Nodes are coupled with faces alone: their unknowns are eliminated in one batch, and a sparse
system of the faces is left.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from ...arrays import FloatArray, dot, sum_by
from ...solvers.levenberg_marquardt import DampedStep
from ...spheres.minkowski import minkowski
from ...tolerances import PLANAR_DAMPING
from .node_elimination import face_products, factor_nodes, node_inverses
from .step_norm import Sparse, StepNorm, node_metric, sphere_metric
from .system import (
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
)

REFINEMENTS = 2
"""How often a step is refined."""


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
    The nodes are eliminated (`node_elimination`). Faces are left coupled where they share a
    node, nine blocks of 5 by 5 in a row of the matrix on quads. What rounding leaves in it
    would come out as a move along which nothing changes: the step is refined by the gradient
    that the derivatives themselves give.
    """
    from scipy.sparse import bsr_array

    mesh = system.mesh
    jacobian, miss = corner_jacobian(system, net), residuals(system, net)
    held = system.site(net.shifts).slopes
    factors = factor_nodes(system, net, jacobian, held)
    mixed = jacobian.by_face.transpose(0, 2, 1) @ jacobian.by_node
    shape = (FACE * mesh.n_faces, NODE * mesh.n_vertices)
    # Corners are stored face after face: they are the compressed rows of the coupling.
    coupling: Sparse = bsr_array((mixed, mesh.corners, mesh.offsets), shape=shape)
    dual = 2 * _dual(net.rows)
    units, metric = _block_diagonal(dual[:, :, None] * dual[:, None]), sphere_metric(size, net)
    moving = node_metric(size, net)
    n_rows = shape[0]

    def _step(damping: float) -> DampedStep:
        damping = max(damping, PLANAR_DAMPING)
        inverse = _block_diagonal(node_inverses(factors, damping * moving))
        reduction = coupling @ inverse
        products = face_products(system, jacobian, factors, damping * moving)
        reduced = _factorized(products + units + damping * metric)
        step, ahead = np.zeros(sum(shape)), miss
        for _ in range(1 + REFINEMENTS):
            face_slope, node_slope = _slopes(system, net, jacobian, held, ahead)
            face_slope += damping * (metric @ step[:n_rows])
            node_slope += damping * np.repeat(moving, NODE) * step[n_rows:]
            rows = reduced.solve(reduction @ node_slope - face_slope)
            step[:n_rows] += rows
            step[n_rows:] -= inverse @ (node_slope + coupling.T @ rows)
            ahead = _advanced(system, net, jacobian, miss, held, step)
        return DampedStep(step, float(sum((r**2).sum() for r in ahead)))

    return _step


def _slopes(
    system: PlanarSystem,
    net: Net,
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
    nodes[:, :POINT] += np.einsum("vki,vk->vi", held, miss.sites)
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


def _factorized(matrix: Sparse) -> Any:  # noqa: ANN401
    """Factors of a definite matrix: without pivots, in an order that keeps them sparse."""
    from scipy.sparse import linalg

    solver: Any = linalg
    return solver.splu(
        matrix.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
