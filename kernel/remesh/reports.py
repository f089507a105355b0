"""Reports of nets: conjugate directions, how a net was made, how its nodes became planar."""

from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray, dot
from ..meshes.mesh import Mesh, face_vector_areas, mean_edge_length, shortest_edge
from ..reports import Report
from ..sphere_meshes.sphere_mesh import SphereMesh, vertex_error
from .field.conjugate_directions import ConjugateDirections
from .field.relax import Relaxation
from .pipeline import Remeshing
from .planar.node_planarity import Nodes, measure_nodes, node_axis_angles
from .planar.planarize import Planarization


@dataclass(frozen=True, eq=False)
class DirectionsReport(Report):
    """Conjugate directions of a congruence; None stands for infinite.

    Attributes
    ----------
    complex_share, umbilic_share : float
        Shares of the area where the directions are complex, and where all are all but
        conjugate.
    singular : list of dict
        ``vertex`` and ``half_turns`` of the directions around it.
    node_axis_deg : dict
        Angle between normal and expected node axis: ``median``, ``p95`` and ``max``.
    radius_to_edge : dict
        Radii relative to the mean edge of the mesh: ``min`` and ``median``.
    largest_edge : float or None
        Longest edge of a net whose nodes are real at 95 % of the vertices: √2 times the radius.
    degree : int
        Of the polynomials fitted to the spheres.
    """

    complex_share: float
    umbilic_share: float
    singular: list[dict[str, Any]]
    node_axis_deg: dict[str, float | None]
    radius_to_edge: dict[str, float | None]
    largest_edge: float | None
    degree: int


@dataclass(frozen=True, eq=False)
class RemeshingReport(Report):
    """What remeshing reached; None stands for what is infinite or does not exist.

    Attributes
    ----------
    faces : dict
        ``count``, and ``degrees``: how many of each.
    irregular_nodes : int
        Inner vertices whose valence is not 4.
    singular : list of dict
        ``point`` and ``half_turns`` of the directions around it.
    complex_share, umbilic_share, moved_share : float
        Shares of the area: as in `DirectionsReport`, and where directions were moved apart.
    edges : dict
        ``target``, ``mean`` and ``min`` length.
    folded, flipped : int
        Triangles of the map that are turned over, before and after unfolding.
    aligned_sides, contracted_edges, lost_cells : int
        Along the boundary.
    digons : int
        Cells of two corners around singular points, which became edges.
    covered_holes : int
        Holes of the mesh that are too small for the edges.
    node_axis_deg : dict
        Angle between normal and expected node axis: ``median``, ``p95`` and ``max``.
    radius_to_edge : dict
        ``min`` and ``median``; below 0.71 nodes are not real.
    planarized : dict or None
        A `PlanarizationReport`; None if it failed, and the net keeps some torsion.
    distance : dict
        In mean edges of the net: of ``nodes`` inside and of ``boundary_nodes`` from the smooth
        surface through the vertices, and of ``panels`` (``panels_p95``: of 95 % of them) from
        the mesh.
    """

    faces: dict[str, Any]
    irregular_nodes: int
    singular: list[dict[str, Any]]
    complex_share: float
    umbilic_share: float
    moved_share: float
    edges: dict[str, float]
    folded: int
    flipped: int
    aligned_sides: int
    contracted_edges: int
    lost_cells: int
    digons: int
    covered_holes: int
    node_axis_deg: dict[str, float | None]
    radius_to_edge: dict[str, float | None]
    planarized: dict[str, Any] | None
    distance: dict[str, float]


@dataclass(frozen=True, eq=False)
class PlanarizationReport(Report):
    """What planarisation reached, and what it cost; four measures ``before`` and ``after``.

    Attributes
    ----------
    planarity : dict
        Largest fourth singular value of the spheres around a node, relative to the first.
    corner_gap : dict
        Largest distance of a node from its spheres, in mean edges.
    real_nodes : dict
        Share of the interior nodes whose spheres meet in two real points.
    shortest_edge : dict
        In mean edges.
    axis_angles_deg : dict
        ``p95`` and ``max`` of the angles between node axes and normals; None without an axis.
    moved : dict
        ``max`` and ``mean`` over the nodes, in mean edges.
    nodes_without_axis, turned_faces : list of int
        Vertices, and faces that were turned over.
    """

    status: str
    iterations: int
    planarity: dict[str, float]
    corner_gap: dict[str, float]
    real_nodes: dict[str, float]
    shortest_edge: dict[str, float]
    axis_angles_deg: dict[str, float | None]
    moved: dict[str, float]
    nodes_without_axis: list[int]
    turned_faces: list[int]


@dataclass(frozen=True, eq=False)
class RelaxationReport(Report):
    """How much a congruence was changed.

    Attributes
    ----------
    blend, radius : float
        Share of the spheres of constant radius, and their radius.
    complex_share, axis_angle_p95_deg : dict
        ``before`` and ``after``.
    """

    blend: float
    radius: float
    complex_share: dict[str, float]
    axis_angle_p95_deg: dict[str, float]


def directions_report(found: ConjugateDirections, mesh: Mesh) -> DirectionsReport:
    """The report of conjugate directions: lengths relative to the edges of `mesh`."""
    radii = sphere_radii(found.curvatures)
    return DirectionsReport(
        complex_share=found.complex_share,
        umbilic_share=found.umbilic_share,
        singular=_singular("vertex", found.singular, found.indices),
        node_axis_deg=angle_report(found.axis_angles),
        radius_to_edge=radius_report(radii / mean_edge_length(mesh)),
        largest_edge=finite(np.sqrt(2) * np.quantile(radii, 0.05, method="lower")),
        degree=found.degree,
    )


def remeshing_report(
    done: Remeshing,
    mesh: Mesh,
    edge_length: float,
    planarized: PlanarizationReport | None,
    distance: dict[str, float],
) -> RemeshingReport:
    """The report of a net whose mesh in the end has the same faces."""
    degrees: Counter[int] = Counter(mesh.degrees.tolist())
    return RemeshingReport(
        faces={
            "count": mesh.n_faces,
            "degrees": {str(degree): degrees[degree] for degree in sorted(degrees)},
        },
        irregular_nodes=done.n_irregular,
        singular=_singular("point", done.singular_points, done.indices),
        complex_share=done.complex_share,
        umbilic_share=done.umbilic_share,
        moved_share=done.moved_share,
        edges={
            "target": float(edge_length),
            "mean": mean_edge_length(mesh),
            "min": shortest_edge(mesh),
        },
        folded=done.n_folded,
        flipped=done.n_flipped,
        aligned_sides=done.n_aligned,
        contracted_edges=done.n_contracted,
        lost_cells=done.n_slivers,
        digons=done.n_digons,
        covered_holes=done.n_covered,
        node_axis_deg=angle_report(done.axis_angles),
        radius_to_edge=radius_report(sphere_radii(done.curvatures) / edge_length),
        planarized=None if planarized is None else dict(planarized),
        distance=distance,
    )


def planarization_report(start: SphereMesh, result: Planarization) -> PlanarizationReport:
    """The report of a planarisation: both meshes have the same faces."""
    after = result.sphere_mesh
    nodes = measure_nodes(after)
    values = [_quality(start, measure_nodes(start)), _quality(after, nodes)]
    angles = np.degrees(node_axis_angles(after, nodes))
    return PlanarizationReport(
        status=result.status,
        iterations=result.iterations,
        **{
            key: {"before": before, "after": values[1][key]}
            for key, before in values[0].items()
        },
        axis_angles_deg=_spread(angles[np.isfinite(angles)]),
        moved={"max": float(result.shifts.max()), "mean": float(result.shifts.mean())},
        nodes_without_axis=np.flatnonzero(nodes.is_inner & np.isnan(nodes.axes[:, 0])).tolist(),
        turned_faces=_turned_faces(start.mesh, after.mesh),
    )


def relaxation_report(result: Relaxation) -> RelaxationReport:
    """The report of a relaxed congruence."""
    before, after = result.before, result.after
    return RelaxationReport(
        result.blend,
        result.radius,
        {"before": before.complex_share, "after": after.complex_share},
        {
            "before": float(np.degrees(before.axis_angle)),
            "after": float(np.degrees(after.axis_angle)),
        },
    )


def _singular(
    key: str, where: IntArray | FloatArray, indices: IntArray
) -> list[dict[str, Any]]:
    pairs = zip(where.tolist(), indices.tolist(), strict=True)
    return [{key: at, "half_turns": index} for at, index in pairs]


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
    """Median, 95th percentile and largest of the angles that exist: from radians to degrees.

    Keys ``median``, ``p95`` and ``max``. Angles (n,) that do not exist are NaN.
    """
    known = np.degrees(angles[np.isfinite(angles)])
    if len(known) == 0:
        return {"median": None, "p95": None, "max": None}
    median, p95, largest = np.quantile(known, [0.5, 0.95, 1.0]).tolist()
    return {"median": median, "p95": p95, "max": largest}


def sphere_radii(curvatures: FloatArray) -> FloatArray:
    """Radii of spheres (n,) of given curvatures: positive; infinite for planes."""
    with np.errstate(divide="ignore"):
        return 1 / np.abs(curvatures)


def radius_report(radii: FloatArray) -> dict[str, float | None]:
    """Least and median radius, ``min`` and ``median``; None where infinite, as for planes."""
    ordered = np.sort(radii)
    return {"min": finite(ordered[0]), "median": finite(ordered[len(ordered) // 2])}


def finite(value: float) -> float | None:
    """A value for a report: None if it is not finite."""
    return float(value) if np.isfinite(value) else None
