"""Plain reports of nets: how a congruence was remeshed, how its nodes became planar."""

from collections import Counter
from typing import Any

import numpy as np

from ..arrays import FloatArray, dot
from ..meshes.mesh import Mesh, face_vector_areas, mean_edge_length, shortest_edge
from ..sphere_meshes.sphere_mesh import SphereMesh, vertex_error
from .pipeline import Remeshing
from .planar.nodes import Nodes, measure_nodes, node_axis_angles
from .planar.planarize import Planarization


def remeshing_report(done: Remeshing, mesh: Mesh, edge_length: float) -> dict[str, Any]:
    """
    What remeshing reached.

    Parameters
    ----------
    done : Remeshing
        How the net was made.
    mesh : Mesh
        Its mesh in the end, with the same faces.
    edge_length : float
        Length of the edges asked for.

    Returns
    -------
    dict
        Plain values; angles in degrees, None for what is infinite or does not exist.
    """
    degrees: Counter[int] = Counter(mesh.degrees.tolist())
    singular = zip(done.singular_points.tolist(), done.indices.tolist(), strict=True)
    return {
        "faces": {
            "count": mesh.n_faces,
            "degrees": {str(degree): degrees[degree] for degree in sorted(degrees)},
        },
        "irregular_nodes": done.n_irregular,
        "singular": [{"point": point, "half_turns": index} for point, index in singular],
        "complex_share": done.complex_share,
        "umbilic_share": done.umbilic_share,
        "moved_share": done.moved_share,
        "edges": {
            "target": float(edge_length),
            "mean": mean_edge_length(mesh),
            "min": shortest_edge(mesh),
        },
        "folded": done.n_folded,
        "flipped": done.n_flipped,
        "aligned_sides": done.n_aligned,
        "contracted_edges": done.n_contracted,
        "lost_cells": done.n_slivers,
        "digons": done.n_digons,
        "covered_holes": done.n_covered,
        "node_axis_deg": angle_report(done.axis_angles),
        "radius_to_edge": radius_report(sphere_radii(done.curvatures) / edge_length),
    }


def planarization_report(start: SphereMesh, result: Planarization) -> dict[str, Any]:
    """
    What planarisation reached, and what it cost.

    Parameters
    ----------
    start : SphereMesh
        The sphere mesh before.
    result : Planarization
        The sphere mesh after, on the same faces.

    Returns
    -------
    dict
        Plain values, as the node `planarize_p4` explains them.
    """
    after = result.sphere_mesh
    nodes = measure_nodes(after)
    values = [_quality(start, measure_nodes(start)), _quality(after, nodes)]
    angles = np.degrees(node_axis_angles(after, nodes))
    return {
        "status": result.status,
        "iterations": result.iterations,
        **{
            key: {"before": before, "after": values[1][key]}
            for key, before in values[0].items()
        },
        "axis_angles_deg": _spread(angles[np.isfinite(angles)]),
        "moved": {"max": float(result.shifts.max()), "mean": float(result.shifts.mean())},
        "nodes_without_axis": np.flatnonzero(
            nodes.is_inner & np.isnan(nodes.axes[:, 0])
        ).tolist(),
        "turned_faces": _turned_faces(start.mesh, after.mesh),
    }


def _quality(sphere_mesh: SphereMesh, nodes: Nodes) -> dict[str, float]:
    mean = mean_edge_length(sphere_mesh.mesh)
    is_real = nodes.is_real[nodes.is_inner]
    return {
        "planarity": float(nodes.planarity.max()),
        "corner_gap": float(vertex_error(sphere_mesh).max() / mean),
        "real_nodes": float(is_real.mean()) if len(is_real) else 1.0,
        "shortest_edge": shortest_edge(sphere_mesh.mesh) / mean,
    }


def _turned_faces(before: Mesh, after: Mesh) -> list[int]:
    """Faces that turned over."""
    return np.flatnonzero(dot(*map(face_vector_areas, (before, after))) <= 0).tolist()


def _spread(angles: FloatArray) -> dict[str, float | None]:
    if len(angles) == 0:
        return {"p95": None, "max": None}
    return {"p95": float(np.percentile(angles, 95)), "max": float(angles.max())}


def angle_report(angles: FloatArray) -> dict[str, float | None]:
    """
    Median, 95th percentile and largest of the angles that exist.

    Parameters
    ----------
    angles : (n,) float array
        Radians; NaN where there is none.

    Returns
    -------
    dict
        ``median``, ``p95`` and ``max`` in degrees.
    """
    known = np.degrees(angles[np.isfinite(angles)])
    if len(known) == 0:
        return {"median": None, "p95": None, "max": None}
    median, p95, largest = np.quantile(known, [0.5, 0.95, 1.0]).tolist()
    return {"median": median, "p95": p95, "max": largest}


def sphere_radii(curvatures: FloatArray) -> FloatArray:
    """
    Radii of spheres.

    Parameters
    ----------
    curvatures : (n,) float array

    Returns
    -------
    (n,) float array
        Positive; infinite for planes.
    """
    with np.errstate(divide="ignore"):
        return 1 / np.abs(curvatures)


def radius_report(radii: FloatArray) -> dict[str, float | None]:
    """
    Least and median radius.

    Parameters
    ----------
    radii : (n,) float array
        Radii, infinite for planes.

    Returns
    -------
    dict
        ``min`` and ``median``; None where infinite.
    """
    ordered = np.sort(radii)
    return {"min": finite(ordered[0]), "median": finite(ordered[len(ordered) // 2])}


def finite(value: float) -> float | None:
    """
    A value for a report.

    Parameters
    ----------
    value : float

    Returns
    -------
    float or None
        None if it is not finite.
    """
    return float(value) if np.isfinite(value) else None
