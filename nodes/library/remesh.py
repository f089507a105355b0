"""Nets of spheres with a support structure, along the conjugate directions of a congruence."""

from typing import Annotated, NamedTuple

import numpy as np

from ...kernel.analysis import deviation
from ...kernel.errors import ConvergenceError, name_ids
from ...kernel.meshes.mesh import Mesh, mean_edge_length
from ...kernel.remesh import pipeline, reports
from ...kernel.remesh.field import conjugate_directions as directions
from ...kernel.remesh.field import relax
from ...kernel.remesh.field.relax import CongruenceQuality
from ...kernel.remesh.field.smooth_surface import SmoothSurface
from ...kernel.remesh.planar.conditions import node_distances
from ...kernel.remesh.planar.node_planarity import measure_nodes
from ...kernel.remesh.planar.planarize import (
    SHORT_EDGE,
    Planarization,
    planarize,
    planarize_held,
)
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...kernel.tolerances import NODE_ON_SPHERES, TORSION_FREE
from ..graphs.node import node, warn
from ..graphs.ports import Port
from .arrays import VertexDirections, VertexMarks, VertexSpheres

COMPLEX_SHARE = 0.05
"""A share of the area with complex directions, or none, that is worth a warning."""

LEANING = 30.0
"""Angle of the node axes with the normals, in degrees, that is worth a warning."""

Degree = Annotated[int | None, Port(min=2, max=7)]
Rings = Annotated[int, Port(min=1, max=10)]


class Directions(NamedTuple):
    """Conjugate directions at the vertices of a congruence."""

    directions: VertexDirections
    is_real: VertexMarks
    report: reports.DirectionsReport


class Remeshed(NamedTuple):
    """A net of spheres and how it was reached."""

    sphere_mesh: SphereMesh
    report: reports.RemeshingReport


@node
def conjugate_directions(
    mesh: Mesh, spheres: VertexSpheres, degree: Degree = None, rings: Rings = 4
) -> Directions:
    """The directions that a net of these spheres must follow to have a support structure.

    Parameters
    ----------
    mesh : Mesh
        A connected triangle mesh.
    spheres : (V, 5) float array
        A sphere for every vertex, as from `sphere_congruence`.
    degree : int, optional
        Degree of the polynomials that are fitted to the spheres; by default 3, 5 or 7, the
        lower the noisier the spheres.
    rings : int
        Rings of neighbours that they are fitted to, or more if the degree needs more; larger
        for noisy spheres.

    Returns
    -------
    directions : (V, 2, 3) float array
        Two unit tangents at every vertex, without sign.
    is_real : (V,) bool array
        False where the directions are complex; the two given ones then coincide.
    report : DirectionsReport
        Where they are complex or turn, and how large the edges of a net may be.

    Examples
    --------
    >>> from spheremesh.nodes import conjugate_directions, tangent_spheres, triangulated_surface
    >>> mesh = triangulated_surface("annulus", edge_length=0.3).mesh
    >>> found = conjugate_directions(mesh, tangent_spheres(mesh, -2.0))
    >>> found.directions.shape, found.report["singular"]
    ((140, 2, 3), [])
    """
    found = directions.conjugate_directions(mesh, spheres, degree, rings)
    _warn_of_directions(found.complex_share, found.umbilic_share)
    report = reports.directions_report(found, mesh)
    return Directions(found.directions, found.is_real, report)


@node
def p4_remesh(
    mesh: Mesh,
    spheres: VertexSpheres,
    edge_length: Annotated[float, Port(min=0)],
    smoothing: Annotated[float, Port(min=0, max=10)] = 0.5,
    least_angle: Annotated[float, Port(unit="deg", min=0, max=80)] = 20.0,
    degree: Degree = None,
    rings: Rings = 4,
    fairness: Annotated[float, Port(min=0)] = 1.0,
) -> Remeshed:
    """Remesh a congruence of spheres by quadrilaterals along its conjugate directions.

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
    degree : int, optional
        Degree of the polynomials that are fitted to the spheres; by default 3, 5 or 7, the
        lower the noisier the spheres.
    rings : int
        Rings of neighbours that they are fitted to, or more if the degree needs more; larger
        for noisy spheres.
    fairness : float
        As in `planarize_p4`, which ends the remeshing.

    Returns
    -------
    sphere_mesh : SphereMesh
        Mostly quadrilaterals, cut by the boundary where that does not follow the directions;
        around every interior node the spheres meet in two points.
    report : RemeshingReport
        Faces, edges and nodes of the net, and how near it is to the surface.

    Examples
    --------
    >>> from spheremesh.nodes import p4_remesh, tangent_spheres, triangulated_surface
    >>> mesh = triangulated_surface("annulus", edge_length=0.3).mesh
    >>> net, report = p4_remesh(mesh, tangent_spheres(mesh, -2.0), edge_length=0.8)
    >>> report["faces"]
    {'count': 22, 'degrees': {'4': 22}}
    """
    done = pipeline.remesh(
        mesh, spheres, edge_length, smoothing, float(np.radians(least_angle)), degree, rings
    )
    _warn_of_directions(done.complex_share, done.umbilic_share)
    _warn_of_nodes(done, edge_length)
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
    if done.n_covered:
        warn(
            f"the net covers {done.n_covered} of the holes of the mesh, which are too small "
            "for its edges: choose a smaller edge length"
        )
    if edge_length < mean_edge_length(mesh):
        warn(
            f"the mesh, with edges of {mean_edge_length(mesh):.3g}, is coarser than the net: "
            "subdivide it"
        )
    net, planar, is_held = done.sphere_mesh, None, True
    try:
        result, is_held = planarize_held(done.sphere_mesh, done.surface, fairness)
        net, planar = _planarized(done.sphere_mesh, result)
    except ConvergenceError as error:
        warn(f"the net keeps some torsion: {error}")
    distances = _distances(net, mesh, done.surface)
    if planar and not is_held:
        warn(
            f"the nodes inside are up to {distances['nodes']:.2g} edges from the surface: held "
            "on it, edges would shrink or faces turn over; choose a smaller edge length or "
            "larger spheres"
        )
    report = reports.remeshing_report(done, net.mesh, edge_length, planar, distances)
    return Remeshed(net, report)


def _distances(sphere_mesh: SphereMesh, mesh: Mesh, surface: SmoothSurface) -> dict[str, float]:
    """How far a net is from the surface, in mean edges."""
    net = sphere_mesh.mesh
    nodes, is_rim = node_distances(surface, net), net.topology.is_boundary_vertex
    panels = deviation(sphere_mesh, mesh) / mean_edge_length(net)
    return {
        "nodes": float(nodes[~is_rim].max(initial=0.0)),
        "boundary_nodes": float(nodes[is_rim].max(initial=0.0)),
        "panels_p95": float(np.percentile(panels, 95)),
        "panels": float(panels.max()),
    }


def _warn_of_directions(complex_share: float, umbilic_share: float) -> None:
    if umbilic_share > COMPLEX_SHARE:
        warn(
            f"on {_percent(umbilic_share)} of the area the spheres do not determine the "
            "conjugate directions (they nearly touch one sphere), and noise does: set "
            "smoothing to 5 or more"
        )
    if complex_share > COMPLEX_SHARE:
        warn(
            f"the conjugate directions are complex on {_percent(complex_share)} of the area: "
            "these spheres have no real net there; relax the spheres with relax_congruence, or "
            "use tangent spheres of constant offset"
        )


def _warn_of_nodes(done: pipeline.Remeshing, edge_length: float) -> None:
    """Whether nodes will be real, and their axes upright."""
    smallest = edge_length / np.sqrt(2)
    radii = reports.sphere_radii(done.curvatures)
    small = float((radii < smallest).mean())
    if small > 0:
        warn(
            f"the spheres at {_percent(small)} of the vertices have radii below "
            f"{smallest:.3g}, 0.71 edges: they do not meet around a node; choose larger "
            f"spheres, or an edge length of {np.sqrt(2) * radii.min():.3g} at most"
        )
    lean = reports.angle_report(done.axis_angles)["p95"]
    if lean is not None and lean > LEANING:
        warn(
            f"node axes will lean from the normals by more than {lean:.3g} degrees at 5 % of "
            "the vertices, and beams will lie flat: relax_congruence makes them upright"
        )


def _percent(share: float) -> str:
    return f"{100 * share:.3g} %"


class Planarized(NamedTuple):
    """A torsion-free sphere mesh and how it was reached."""

    sphere_mesh: SphereMesh
    report: reports.PlanarizationReport


@node
def planarize_p4(
    sphere_mesh: SphereMesh, fairness: Annotated[float, Port(min=0)] = 1.0
) -> Planarized:
    """Give a sphere mesh torsion-free nodes: planar faces in Möbius geometry's point model.

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
    report : PlanarizationReport
        How planar the nodes are, and how far they moved.

    Examples
    --------
    >>> from spheremesh.nodes import ellipsoid_mesh, model_change, planarize_p4
    >>> report = planarize_p4(model_change(ellipsoid_mesh(12, 6), radius=4.0)).report
    >>> report["planarity"]["after"] < 1e-9, report["real_nodes"]["after"]
    (True, 1.0)
    """
    return _planarized(sphere_mesh, planarize(sphere_mesh, fairness))


def _planarized(sphere_mesh: SphereMesh, result: Planarization) -> Planarized:
    report = reports.planarization_report(sphere_mesh, result)
    planarity, gap = report["planarity"], report["corner_gap"]
    if planarity["after"] > TORSION_FREE or gap["after"] > NODE_ON_SPHERES:
        worst = np.argsort(-measure_nodes(result.sphere_mesh).planarity, kind="stable")
        raise ConvergenceError(
            f"the nodes are not free of torsion after {result.iterations} steps: "
            f"planarity {planarity['after']:.1e} (from {planarity['before']:.1e}), worst at "
            f"vertices {name_ids(worst[:3].tolist())}; try more fairness, a finer net of "
            "conjugate directions, or relax the congruence first"
        )
    _warn_of_damage(report)
    return Planarized(result.sphere_mesh, report)


def _warn_of_damage(report: reports.PlanarizationReport) -> None:
    """What planar nodes cost."""
    if report["nodes_without_axis"]:
        warn(
            f"the nodes at vertices {name_ids(report['nodes_without_axis'])} have no axis: "
            "their spheres share a circle (then try more fairness), or all of them are planes"
        )
    shortest = report["shortest_edge"]["after"]
    if shortest < SHORT_EDGE or report["turned_faces"]:
        warn(
            f"the shortest edge measures {shortest:.2g} of the mean, and the number of faces "
            f"that turned over is {len(report['turned_faces'])}: nodes moved by up to "
            f"{report['moved']['max']:.2g} edges to become planar; choose larger spheres "
            "of more even size, or a coarser net where singular points are close to each other"
        )


class Relaxed(NamedTuple):
    """A congruence that can be remeshed, and how far it is from the given one."""

    spheres: VertexSpheres
    report: reports.RelaxationReport


@node
def relax_congruence(
    mesh: Mesh,
    spheres: VertexSpheres,
    max_complex: Annotated[float, Port(min=0, max=1)] = 0.02,
    max_axis_angle: Annotated[float, Port(unit="deg", min=0, max=90)] = 20.0,
    radius: float | None = None,
) -> Relaxed:
    """Change the radii of a congruence as little as gives it a real net and upright node axes.

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
    report : RelaxationReport
        How much was blended in, and what it mended.

    Examples
    --------
    >>> from spheremesh.nodes import relax_congruence, tangent_spheres, triangulated_surface
    >>> mesh = triangulated_surface("annulus", edge_length=0.3).mesh
    >>> relax_congruence(mesh, tangent_spheres(mesh, -2.0)).report["blend"]
    0.0
    """
    target = CongruenceQuality(max_complex, float(np.radians(max_axis_angle)))
    result = relax.relax_congruence(
        mesh, spheres, lambda rows: directions.complex_share(mesh, rows), target, radius
    )
    return Relaxed(result.spheres, reports.relaxation_report(result))
