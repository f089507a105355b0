"""Spheres that meet smoothly, at a given angle, or along strips."""

from dataclasses import dataclass
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np

from ...kernel.analysis import angle_summary
from ...kernel.arrays import BoolArray, FloatArray
from ...kernel.errors import ConvergenceError, InputError, name_ids
from ...kernel.meshes.creases import crease_edges
from ...kernel.meshes.mesh import Mesh, mean_edge_length
from ...kernel.optimization import angle_minimization, strips
from ...kernel.optimization import whole_energy as optimization
from ...kernel.optimization.energies.table import EnergyWeights
from ...kernel.sphere_meshes.planarity_circularity import circularity
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...kernel.tolerances import CIRCULAR, FLATTENED, LITTLE_GAIN, OPENING, VERTEX_MISS
from ..graphs.node import node, warn
from ..graphs.ports import Port
from .arrays import CreaseAngle, EdgeWeights, FaceRadii, FaceVectors, Vector
from .outcomes import OptimumReport, flatten_rejected, outcome_of, warn_of_losses

Weight = Annotated[float, Port(min=0)]


@dataclass(frozen=True, eq=False)
class AnglesReport(OptimumReport):
    """How the smallest angles were reached.

    Attributes
    ----------
    converged : bool
    iterations : list of int
        Of the two stages; with a target angle of both, and of the descent to it.
    energies : list of float
    angles_deg : dict
        ``planar`` and ``spherical``: ``mean`` and ``max`` of the planes and of the spheres,
        over the edges that are no crease.
    vertex_error : dict
        ``max`` in model units and ``relative_to_edge``, the mean edge.
    creases : dict
        ``angle_deg`` from which on edges stay sharp, the ``edges`` that do, their ``count``,
        and ``mean_deg`` and ``max_deg`` over them, as built.
    circle_miss : float
        How far vertices lie from the circles of their faces, in mean edges.
    taken_back : int
        Faces whose panels are flatter than those of the least energy, because these would be
        rougher than flat ones in the mean, or could not be cut.
    """

    converged: bool
    iterations: list[int]
    energies: list[float]
    angles_deg: dict[str, dict[str, float]]
    vertex_error: dict[str, float]
    creases: dict[str, Any]
    circle_miss: float
    taken_back: int


@dataclass(frozen=True, eq=False)
class EnergyReport(OptimumReport):
    """How the least energy was reached.

    Attributes
    ----------
    converged : bool
    stages : list of dict
        ``name``, ``status``, ``iterations`` and ``energies`` of each term.
    corners : str
        ``soft`` (vertices stay, spheres pass near them), ``common`` (all spheres of a vertex
        pass through it) or ``own`` (each within the tolerance of it).
    vertex_move : float
        In mean edges.
    angles_deg, vertex_error, creases : dict
        As in `AnglesReport`.
    """

    converged: bool
    stages: list[dict[str, Any]]
    corners: str
    vertex_move: float
    angles_deg: dict[str, dict[str, float]]
    vertex_error: dict[str, float]
    creases: dict[str, Any]


class AnglesOptimum(NamedTuple):
    """Spheres of smallest angles and how they were reached."""

    sphere_mesh: SphereMesh
    report: AnglesReport


class EnergyOptimum(NamedTuple):
    """A sphere mesh of least energy and how it was reached."""

    sphere_mesh: SphereMesh
    report: EnergyReport


@node(version="2")
def minimize_angles(
    sphere_mesh: SphereMesh,
    target_angle: Annotated[float, Port(unit="deg", min=0, max=90)] = 0.0,
    edge_weights: EdgeWeights | None = None,
    max_miss: Annotated[float | None, Port(min=0)] = None,
    crease: CreaseAngle = 40.0,
    max_opening: Annotated[float | None, Port(unit="deg", min=0, max=180)] = None,
) -> AnglesOptimum:
    """Choose the spheres through the faces' circles that meet their neighbours most smoothly.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        Mesh and spheres to start from; the result does not depend on the start.
    target_angle : float
        Angle at which neighbours shall meet.
    edge_weights : (E,) float array, optional
        Weight of each interior edge; 1 for all by default. Faces without a weighted edge stay
        flat.
    max_miss : float, optional
        How far a vertex may lie from the circle of its face, in mean edges; farther off it is
        an error, by default a warning.
    crease : float
        Edges at which the flat faces turn by more stay sharp, and count in no mean; 180 for no
        creases.
    max_opening : float, optional
        Largest half opening of the caps, 180 for no bound. By default 60; with a target angle
        there is none, because the target says how far panels bulge.

    Returns
    -------
    sphere_mesh : SphereMesh
        The optimum, in the mean never rougher than flat panels. Faces whose vertices lie on no
        circle keep their best-fit circle.
    report : AnglesReport
        The angles before and after, the creases, and how far vertices lie off.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, minimize_angles, vase_mesh
    >>> report = minimize_angles(fit_spheres(vase_mesh(12, 6))).report
    >>> {kind: round(found["mean"], 1) for kind, found in report["angles_deg"].items()}
    {'planar': 24.9, 'spherical': 15.6}
    """
    opening = float(np.pi) if target_angle > 0 else OPENING
    if max_opening is not None:
        opening = float(np.radians(max_opening))
    result, run = angle_minimization.minimize_angles(
        sphere_mesh,
        np.radians(target_angle),
        edge_weights,
        np.radians(crease),
        opening,
    )
    if not run.converged:
        raise ConvergenceError(
            f"the angles did not converge in {sum(run.iterations)} steps (last step "
            f"{run.step:.1e} rad): look for nearly degenerate faces"
        )
    if max_miss is not None:
        _refuse_far_corners(result.mesh, run.circle_miss, max(max_miss, CIRCULAR))
    flattened: list[int] = []
    if target_angle == 0:
        result, flattened = flatten_rejected(result, run.is_crease)
    if flattened:
        warn(
            f"the panels of faces {name_ids(flattened)} are flat: pieces of their spheres "
            "cannot be cut; smaller or rounder faces there let them bulge"
        )
    found = outcome_of(result, sphere_mesh.mesh, run.is_crease, crease)
    relative = found["vertex_error"]["relative_to_edge"]
    if relative > VERTEX_MISS:
        warn(
            f"vertices miss their spheres by up to {relative:.3g} mean edges: the faces are "
            "not circular; panels are exact, but their corners are off the mesh by as much"
        )
    taken_back = int(run.is_taken_back.sum())
    if taken_back:
        warn(
            f"{taken_back} panels are flatter than those of the least energy, which would be "
            "rougher than flat ones in the mean: the surface is nearly minimal, or bends one "
            "way only; shorter faces across the bend gain more"
        )
    if target_angle == 0:
        weights = _weights(edge_weights, run.is_crease)
        warn_of_losses(result, sphere_mesh.mesh, weights, run.is_crease)
    report = AnglesReport(
        converged=run.converged,
        iterations=list(run.iterations),
        energies=list(run.energies),
        **found,
        circle_miss=run.circle_miss,
        taken_back=taken_back + len(flattened),
    )
    return AnglesOptimum(result, report)


def _refuse_far_corners(mesh: Mesh, miss: float, allowed: float) -> None:
    """Raise an error if corners lie farther from the circles of their faces than allowed."""
    if miss <= allowed:
        return
    faces = np.flatnonzero(circularity(mesh) / mean_edge_length(mesh) > allowed).tolist()
    raise ConvergenceError(
        f"the vertices of faces {name_ids(faces)} lie on no circle: they miss it by up to "
        f"{miss:.3g} mean edges and {allowed:g} is allowed; give a tolerance of about that size"
    )


def _weights(weights: FloatArray | None, is_crease: BoolArray) -> FloatArray:
    """Weight of each edge (E,), 0 on creases."""
    return np.where(is_crease, 0.0, 1.0 if weights is None else weights)


@node
def optimize_spheres(  # noqa: PLR0913, PLR0917 - a node has an input per weight
    sphere_mesh: SphereMesh,
    sphericity: Weight = 1.0,
    angle: Weight = 0.1,
    regularity: Weight = 0.0,
    support: Weight = 0.0,
    fairness: Weight = 0.0,
    closeness: Weight = 0.0,
    target_angle: Annotated[float, Port(unit="deg", min=0, max=90)] = 0.0,
    edge_weights: EdgeWeights | None = None,
    tolerance: Annotated[float, Port(min=0)] = 0.0,
    fixed_radii: FaceRadii | None = None,
    interior: Literal["free", "glide"] = "free",
    boundary: Literal["free", "glide", "fixed"] = "free",
    max_iterations: Annotated[int, Port(min=1)] = 100,
    crease: CreaseAngle = 40.0,
) -> EnergyOptimum:
    """Minimise a weighted sum of what a sphere mesh should fulfil.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        Mesh and spheres to start from; those of `minimize_angles` are a good start.
    sphericity : float
        Weight of vertices lying on the spheres of their faces.
    angle : float
        Weight of neighbours meeting at the target angle.
    regularity : float
        Weight of the planes between neighbours standing upright; 3.5 goes with a support.
    support : float
        Weight of nodes without torsion; 1 asks for them. It is raised until they have none.
        Spheres then miss vertices, by what the report says: `land_nodes` moves the vertices.
    fairness : float
        Weight of moving vertices lying near the mean of their neighbours.
    closeness : float
        Weight of moving vertices staying where they were.
    target_angle : float
        Angle at which neighbours shall meet.
    edge_weights : (E,) float array, optional
        Weight of the angle over each interior edge; 1 for all by default.
    tolerance : float
        How far vertices may move, in mean edges. They move until all spheres of a vertex pass
        through it; where that would be rougher than flat panels, they stay, and each sphere
        passes within the tolerance of them.
    fixed_radii : (F,) float array, optional
        Radius of each face, infinite for a plane, 0 where it is free.
    interior : {"free", "glide"}
        Whether moving vertices may leave the tangent plane of the mesh.
    boundary : {"free", "glide", "fixed"}
        How boundary vertices move; gliding ones along the boundary.
    max_iterations : int
        Largest number of linear systems of each stage.
    crease : float
        Edges at which the flat faces turn by more stay sharp: their angle counts nothing. 180
        for no creases.

    Returns
    -------
    sphere_mesh : SphereMesh
        The optimum, on moved vertices if they may move.
    report : EnergyReport
        The angles before and after, the stages, and how far vertices moved.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, optimize_spheres, vase_mesh
    >>> optimum = optimize_spheres(fit_spheres(vase_mesh(12, 4)), angle=0.01)
    >>> optimum.report["converged"], optimum.report["corners"]
    (True, 'soft')
    """
    weights = EnergyWeights(
        sphericity=sphericity, angle=angle, regularity=regularity, support=support,
        fairness=fairness, closeness=closeness,
    )  # fmt: skip
    is_crease = crease_edges(sphere_mesh.mesh, np.radians(crease))
    smooth = _weights(edge_weights, is_crease)
    conditions = optimization.Conditions(
        np.radians(target_angle), smooth, tolerance, fixed_radii, interior, boundary,
        max_iterations,
    )  # fmt: skip
    result, run = optimization.optimize_spheres(sphere_mesh, weights, conditions)
    outcome = outcome_of(result, sphere_mesh.mesh, is_crease, crease)
    if not run.converged:
        warn(
            f"the optimisation used up its {max_iterations} iterations: the result is its best "
            "so far; raise max_iterations"
        )
    if run.corners == "own":
        warn(
            f"no common spheres within a tolerance of {tolerance:g} mean edges are smoother "
            "than flat panels: vertices stay, and each panel has corners of its own within the "
            "tolerance of them"
        )
    elif support == 0 and outcome["vertex_error"]["relative_to_edge"] > VERTEX_MISS:
        warn(
            f"vertices miss their spheres by up to {run.vertex_miss:.3g} mean edges: allow a "
            "tolerance to let them move"
        )
    if target_angle == 0 and support == 0:
        warn_of_losses(result, sphere_mesh.mesh, smooth, is_crease)
    if support > 0:
        _warn_of_support(sphere_mesh, result, outcome, ~is_crease)
    stages = [_stage(stage) for stage in run.stages]
    report = EnergyReport(run.converged, stages, run.corners, run.vertex_move, **outcome)
    return EnergyOptimum(result, report)


@node
def strip_weights(mesh: Mesh, direction: int | Vector | FaceVectors = 0) -> EdgeWeights:
    """Weights that let spheres join smoothly along strips, and only there.

    Parameters
    ----------
    mesh : Mesh
        Quadrilaterals for a direction of the net; any faces for a direction in space.
    direction : int or float array
        0: strips run as the first quadrilateral does from its first to its second corner, and
        1 across; or a vector (3,), or one per face (F, 3), along which they run.

    Returns
    -------
    (E,) float array
        1 on the edges between neighbours of a strip, 0 on all others: for `minimize_angles`
        and `optimize_spheres`.

    Examples
    --------
    >>> from spheremesh.nodes import strip_weights, vase_mesh
    >>> weights = strip_weights(vase_mesh(12, 6), direction=0)
    >>> len(weights), int(weights.sum())
    (132, 72)
    """
    if not isinstance(direction, int | np.integer):
        return strips.strip_weights_along(mesh, direction)
    if direction not in (0, 1):
        raise InputError(f"a net has the directions 0 and 1, not {direction}")
    return strips.strip_weights(mesh, "second" if direction else "first")


def _stage(stage: optimization.Stage) -> dict[str, Any]:
    return {
        "name": stage.name,
        "status": stage.status,
        "iterations": stage.iterations,
        "energies": {name: list(map(float, e)) for name, e in stage.energies.items()},
    }


def _warn_of_support(
    start: SphereMesh, result: SphereMesh, outcome: dict[str, dict[str, Any]],
    is_smooth: BoolArray,
) -> None:  # fmt: skip
    """Say where nodes without torsion cost what spheres are for."""
    planar, spherical = (
        outcome["angles_deg"][kind]["mean"] for kind in ("planar", "spherical")
    )
    bends = [
        float(np.median(np.abs(each.local_spheres[:, 0]))) * mean_edge_length(each.mesh)
        for each in (start, result)
    ]
    before = angle_summary(start, is_smooth)["mean"]
    found: list[str] = []
    if bends[1] < FLATTENED * bends[0] and spherical > (1 + LITTLE_GAIN) * before:
        share = 100 * bends[1] / bends[0]
        found.append(
            f"flatten to {share:.0f} % of their curvature ({before:.3g} to {spherical:.3g} "
            "degrees)"
        )
    if spherical > planar:
        found.append(f"are rougher than planes ({planar:.3g} to {spherical:.3g} degrees)")
    if found:
        warn(
            f"for nodes without torsion spheres {' and '.join(found)}: the net does not follow "
            "the lines of curvature; let its vertices slide (exact_support), or leave spheres "
            "as they are and take axis_support"
        )
