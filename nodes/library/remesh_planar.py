"""Sphere meshes that can be built: nodes free of torsion."""

from collections.abc import Mapping
from typing import Annotated, Any, NamedTuple

import numpy as np

from ...kernel.arrays import FloatArray
from ...kernel.errors import ConvergenceError, name_ids
from ...kernel.mesh import mean_edge_length
from ...kernel.remesh.planarize import Nodes, axis_angles, measure_nodes, planarize
from ...kernel.sphere_mesh import SphereMesh, vertex_error
from ...kernel.tolerances import NODE_ON_SPHERES, TORSION_FREE
from ..node import node, warn
from ..ports import Port


class Planarized(NamedTuple):
    """A torsion-free sphere mesh and how it was reached."""

    sphere_mesh: SphereMesh
    report: Mapping[str, Any]


@node
def planarize_p4(
    sphere_mesh: SphereMesh, fairness: Annotated[float, Port(min=0)] = 1.0
) -> Planarized:
    """
    Give a sphere mesh torsion-free nodes: planar faces in the point model of Möbius geometry.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        A mesh of any face degrees that nearly has such nodes, as `p4_remesh` makes them.
    fairness : float
        How much it counts that neighbouring spheres change differently, relative to how much
        changes count; larger for rough nets.

    Returns
    -------
    sphere_mesh : SphereMesh
        Moved nodes and changed spheres on the same faces: around every interior node the
        spheres pass through the node and through one more common point.
    report : mapping
        ``status``, ``iterations``; ``planarity`` (largest fourth singular
        value of the spheres around a node, relative to the first), ``corner_gap`` (largest
        distance of a node from its spheres, in mean edges) and ``real_nodes`` (share of the
        interior nodes whose spheres meet in two real points), each ``before`` and ``after``;
        ``axis_angles_deg`` (``p95`` and ``max`` of the angles between node axes and normals,
        null if there is no axis), ``moved`` (``max`` and ``mean`` over the nodes, in mean
        edges) and ``nodes_without_axis`` (ids).
    """
    result = planarize(sphere_mesh, fairness)
    nodes = measure_nodes(result.sphere_mesh)
    before = _quality(sphere_mesh, measure_nodes(sphere_mesh))
    after = _quality(result.sphere_mesh, nodes)
    if after["planarity"] > TORSION_FREE or after["corner_gap"] > NODE_ON_SPHERES:
        worst = np.argsort(-nodes.planarity, kind="stable")[:3].tolist()
        raise ConvergenceError(
            f"the nodes are not free of torsion after {result.iterations} steps: "
            f"planarity {after['planarity']:.1e} (from {before['planarity']:.1e}), worst at "
            f"vertices {name_ids(worst)}; try more fairness, a finer net of conjugate "
            "directions, or relax the congruence first"
        )
    angles = np.degrees(axis_angles(result.sphere_mesh, nodes))
    lost = np.flatnonzero(nodes.is_inner & np.isnan(angles)).tolist()
    if lost:
        warn(
            f"the nodes at vertices {name_ids(lost)} have no axis: their spheres share a "
            "circle (then try more fairness), or all of them are planes"
        )
    report = {
        "status": result.status,
        "iterations": result.iterations,
        **{key: {"before": before[key], "after": after[key]} for key in before},
        "axis_angles_deg": _spread(angles[np.isfinite(angles)]),
        "moved": {"max": float(result.shifts.max()), "mean": float(result.shifts.mean())},
        "nodes_without_axis": lost,
    }
    return Planarized(result.sphere_mesh, report)


def _quality(sphere_mesh: SphereMesh, nodes: Nodes) -> dict[str, float]:
    gap = vertex_error(sphere_mesh).max() / mean_edge_length(sphere_mesh.mesh)
    is_real = nodes.is_real[nodes.is_inner]
    return {
        "planarity": float(nodes.planarity.max()),
        "corner_gap": float(gap),
        "real_nodes": float(is_real.mean()) if len(is_real) else 1.0,
    }


def _spread(angles: FloatArray) -> dict[str, float | None]:
    if len(angles) == 0:
        return {"p95": None, "max": None}
    return {"p95": float(np.percentile(angles, 95)), "max": float(angles.max())}
