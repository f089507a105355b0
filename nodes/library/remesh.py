"""Nets of spheres with a support structure, along the conjugate directions of a congruence."""

from collections import Counter
from collections.abc import Mapping
from typing import Annotated, Any, NamedTuple

import numpy as np

from ...kernel import triangulated
from ...kernel.arrays import BoolArray, FloatArray, IntArray
from ...kernel.errors import ConvergenceError, name_ids
from ...kernel.mesh import Mesh, mean_edge_length
from ...kernel.remesh import directions, pipeline, relax
from ...kernel.remesh.planarize import Nodes, axis_angles, measure_nodes, planarize
from ...kernel.remesh.relax import CongruenceQuality
from ...kernel.sphere_mesh import SphereMesh, vertex_error
from ...kernel.tolerances import NODE_ON_SPHERES, TORSION_FREE
from ..node import node, warn
from ..ports import Port

COMPLEX_SHARE = 0.05
"""A share of the area with complex directions that is worth a warning."""

Degree = Annotated[int, Port(min=2, max=6)]
Rings = Annotated[int, Port(min=1, max=10)]


class SampledSurface(NamedTuple):
    """A triangle mesh on a smooth surface, and the normals of that surface."""

    mesh: Mesh
    normals: FloatArray


class Directions(NamedTuple):
    """Conjugate directions at the vertices of a congruence."""

    directions: FloatArray
    is_real: BoolArray
    report: Mapping[str, Any]


class Remeshed(NamedTuple):
    """A net of spheres and how it was reached."""

    sphere_mesh: SphereMesh
    report: Mapping[str, Any]


@node
def triangulated_surface(
    shape: triangulated.SampleShape = "bump",
    edge_length: Annotated[float, Port(min=0)] = 0.1,
    seed: int | None = None,
) -> SampledSurface:
    """
    A triangulated sample surface with exact normals, to try remeshing on.

    Parameters
    ----------
    shape : {"torus", "annulus", "hypar", "bump", "ellipsoid", "waves"}
        A torus, a ring of revolution, a saddle, a hill, a triaxial ellipsoid without its
        poles, a wavy sheet; all measure about 2.
    edge_length : float
        Mean length of the edges along the parameter lines.
    seed : int, optional
        Moves the vertices along the surface at random; a regular grid without.

    Returns
    -------
    mesh : Mesh
        Triangles.
    normals : (V, 3) float array
        Unit normals of the smooth surface.
    """
    return SampledSurface(*triangulated.triangulated_surface(shape, edge_length, seed))


@node
def conjugate_directions(
    mesh: Mesh, spheres: FloatArray, degree: Degree = 5, rings: Rings = 3
) -> Directions:
    """
    The directions that a net of these spheres must follow to have a support structure.

    Parameters
    ----------
    mesh : Mesh
        A connected triangle mesh.
    spheres : (V, 5) float array
        A sphere for every vertex, as from `sphere_congruence`.
    degree : int
        Degree of the polynomials that are fitted to the spheres; 3 for noisy spheres.
    rings : int
        Rings of neighbours that they are fitted to; 5 for noisy spheres.

    Returns
    -------
    directions : (V, 2, 3) float array
        Two unit tangents at every vertex, without sign.
    is_real : (V,) bool array
        False where the directions are complex; the two given ones then coincide.
    report : mapping
        ``complex_share`` of the area, ``singular`` vertices with their ``half_turns``,
        ``node_axis_deg`` (angle between normal and expected node axis: median, p95 and max),
        ``radius_to_edge`` (radii relative to the mean edge of the mesh: min and median) and
        ``largest_edge`` (longest edge of a net whose nodes are real on 95 % of the vertices,
        ``sqrt(2)`` times the radius). None stands for infinite.
    """
    found = directions.conjugate_directions(mesh, spheres, degree, rings)
    _warn_complex(found.complex_share)
    radii = _radii(found.curvatures)
    report = {
        "complex_share": found.complex_share,
        "singular": _singular(found.singular, found.indices),
        "node_axis_deg": _axis_angles(found.axis_angles),
        "radius_to_edge": _radius_report(radii / mean_edge_length(mesh)),
        "largest_edge": _finite(np.sqrt(2) * np.quantile(radii, 0.05, method="lower")),
    }
    return Directions(found.directions, found.is_real, report)


@node
def p4_remesh(
    mesh: Mesh,
    spheres: FloatArray,
    edge_length: Annotated[float, Port(min=0)],
    smoothing: Annotated[float, Port(min=0, max=10)] = 0.5,
    least_angle: Annotated[float, Port(unit="deg", min=0, max=80)] = 20.0,
    degree: Degree = 5,
    rings: Rings = 3,
) -> Remeshed:
    """
    Remesh a congruence of spheres by quadrilaterals along its conjugate directions.

    Parameters
    ----------
    mesh : Mesh
        A connected triangle mesh, finer than the net.
    spheres : (V, 5) float array
        A sphere for every vertex, as from `sphere_congruence`.
    edge_length : float
        Length of the edges of the net.
    smoothing : float
        Distance over which uncertain directions are smoothed, in edge lengths.
    least_angle : float
        Directions that meet at less, or are complex, are moved apart to this angle.
    degree : int
        Degree of the polynomials that are fitted to the spheres; 3 for noisy spheres.
    rings : int
        Rings of neighbours that they are fitted to; 5 for noisy spheres.

    Returns
    -------
    sphere_mesh : SphereMesh
        Mostly quadrilaterals, cut by the boundary where that does not follow the directions;
        around every interior node the spheres meet in two points.
    report : mapping
        ``faces`` (count, and how many of each degree), ``irregular_nodes`` (inner vertices
        whose valence is not 4), ``singular`` points with their ``half_turns``,
        ``complex_share`` and ``moved_share`` of the area, ``edges`` (target, mean and min
        length), ``folded`` and ``flipped`` triangles of the map before and after unfolding,
        ``aligned_sides`` of the boundary, ``contracted_edges`` and ``lost_cells`` along it,
        ``digons`` (cells of two corners around singular points, which became edges),
        ``node_axis_deg`` (angle between normal and expected node axis: median, p95 and max)
        and ``radius_to_edge`` (min and median; below 0.71 nodes are not real). None stands for
        infinite. ``planarized`` is the report of `planarize_p4`, which comes last; None if it
        failed, and the net keeps some torsion.
    """
    done = pipeline.remesh(
        mesh, spheres, edge_length, smoothing, float(np.radians(least_angle)), degree, rings
    )
    _warn_complex(done.complex_share)
    if done.moved_share > 0:
        warn(
            f"on {_percent(done.moved_share)} of the area the smoothed directions are complex "
            f"or meet at less than {least_angle:g} degrees and were moved apart: there the net "
            "is not conjugate"
        )
    if done.n_flipped:
        warn(
            f"{done.n_flipped} triangles of the map are flipped: faces overlap there, near "
            "singular points; choose a smaller edge length or more smoothing"
        )
    if edge_length < mean_edge_length(mesh):
        warn(
            f"the mesh, with edges of {mean_edge_length(mesh):.3g}, is coarser than the net: "
            "subdivide it"
        )
    report = _report(done, edge_length)
    try:
        planar = _planarized(done.sphere_mesh)
    except ConvergenceError as error:
        warn(f"the net keeps some torsion: {error}")
        return Remeshed(done.sphere_mesh, {**report, "planarized": None})
    return Remeshed(planar.sphere_mesh, {**report, "planarized": planar.report})


def _report(done: pipeline.Remeshing, edge_length: float) -> dict[str, Any]:
    degrees: Counter[int] = Counter(done.sphere_mesh.mesh.degrees.tolist())
    return {
        "faces": {
            "count": done.sphere_mesh.mesh.n_faces,
            "degrees": {str(degree): degrees[degree] for degree in sorted(degrees)},
        },
        "irregular_nodes": done.n_irregular,
        "singular": [
            {"point": point, "half_turns": index}
            for point, index in zip(
                done.singular_points.tolist(), done.indices.tolist(), strict=True
            )
        ],
        "complex_share": done.complex_share,
        "moved_share": done.moved_share,
        "edges": {
            "target": float(edge_length),
            "mean": mean_edge_length(done.sphere_mesh.mesh),
            "min": done.shortest_edge,
        },
        "folded": done.n_folded,
        "flipped": done.n_flipped,
        "aligned_sides": done.n_aligned,
        "contracted_edges": done.n_contracted,
        "lost_cells": done.n_slivers,
        "digons": done.n_digons,
        "node_axis_deg": _axis_angles(done.axis_angles),
        "radius_to_edge": _radius_report(_radii(done.curvatures) / edge_length),
    }


def _warn_complex(share: float) -> None:
    if share > COMPLEX_SHARE:
        warn(
            f"the conjugate directions are complex on {_percent(share)} of the area: no real "
            "net follows these spheres there; spheres of constant radius or tangent spheres of "
            "constant offset have real ones"
        )


def _singular(vertices: IntArray, indices: IntArray) -> list[dict[str, int]]:
    pairs = zip(vertices.tolist(), indices.tolist(), strict=True)
    return [{"vertex": vertex, "half_turns": index} for vertex, index in pairs]


def _axis_angles(angles: FloatArray) -> dict[str, float | None]:
    known = np.degrees(angles[np.isfinite(angles)])
    if len(known) == 0:
        return {"median": None, "p95": None, "max": None}
    median, p95, largest = np.quantile(known, [0.5, 0.95, 1.0]).tolist()
    return {"median": median, "p95": p95, "max": largest}


def _radii(curvatures: FloatArray) -> FloatArray:
    with np.errstate(divide="ignore"):
        return 1 / np.abs(curvatures)


def _radius_report(radii: FloatArray) -> dict[str, float | None]:
    ordered = np.sort(radii)
    return {"min": _finite(ordered[0]), "median": _finite(ordered[len(ordered) // 2])}


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _percent(share: float) -> str:
    return f"{100 * share:.3g} %"


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
    return _planarized(sphere_mesh, fairness)


def _planarized(sphere_mesh: SphereMesh, fairness: float = 1.0) -> Planarized:
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


class Relaxed(NamedTuple):
    """A congruence that can be remeshed, and how far it is from the given one."""

    spheres: FloatArray
    report: Mapping[str, Any]


@node
def relax_congruence(
    mesh: Mesh,
    spheres: FloatArray,
    max_complex: Annotated[float, Port(min=0, max=1)] = 0.02,
    max_axis_angle: Annotated[float, Port(unit="deg", min=0, max=90)] = 20.0,
    radius: float | None = None,
) -> Relaxed:
    """
    Change the radii of a congruence as little as gives it a real net and upright node axes.

    Parameters
    ----------
    mesh : Mesh
        Triangles.
    spheres : (V, 5) float array
        Rows of the spheres at the vertices, which touch the surface or nearly so.
    max_complex : float
        Largest share of the area without a real conjugate net.
    max_axis_angle : float
        Largest angle between node axes and normals, over 95 % of the area.
    radius : float, optional
        Signed distance, along the vertex normals, of the centres of the spheres of constant
        radius that are blended in; half of the surface's smallest radius of curvature, on the
        side of the given spheres, by default.

    Returns
    -------
    spheres : (V, 5) float array
        The given spheres if they are fit.
    report : mapping
        ``blend`` (share of the spheres of constant radius), ``radius`` of those,
        ``complex_share`` and ``axis_angle_p95_deg``, each ``before`` and ``after``.
    """
    target = CongruenceQuality(max_complex, float(np.radians(max_axis_angle)))
    result = relax.relax_congruence(
        mesh,
        spheres,
        lambda rows: directions.conjugate_directions(mesh, rows).complex_share,
        target,
        radius,
    )
    before, after = result.before, result.after
    report = {
        "blend": result.blend,
        "radius": result.radius,
        "complex_share": {"before": before.complex_share, "after": after.complex_share},
        "axis_angle_p95_deg": {
            "before": float(np.degrees(before.axis_angle)),
            "after": float(np.degrees(after.axis_angle)),
        },
    }
    return Relaxed(result.spheres, report)
