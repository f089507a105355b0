"""Spheres that meet smoothly, at a given angle, or along strips."""

from dataclasses import dataclass
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np

from ...kernel.analysis import angle_summary
from ...kernel.errors import ConvergenceError, InputError, name_ids
from ...kernel.meshes.mesh import Mesh, mean_edge_length
from ...kernel.optimization import angle_minimization, strips
from ...kernel.optimization import whole_energy as optimization
from ...kernel.optimization.comparison import Smoothness
from ...kernel.optimization.energies.table import EnergyWeights
from ...kernel.reports import Report
from ...kernel.sphere_meshes.fit import face_planes
from ...kernel.sphere_meshes.planarity_circularity import circularity
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh, vertex_error
from ...kernel.tolerances import CIRCULAR, LITTLE_GAIN, VERTEX_MISS
from ..graphs.node import node, warn
from ..graphs.ports import Port
from .arrays import EdgeWeights, FaceRadii, FaceVectors, Vector

Weight = Annotated[float, Port(min=0)]


@dataclass(frozen=True, eq=False)
class OptimumReport(Report):
    """How an optimum was reached: the kinds of report that `panel_report` starts from."""


@dataclass(frozen=True, eq=False)
class AnglesReport(OptimumReport):
    """How the smallest angles were reached.

    Attributes
    ----------
    converged : bool
    iterations : list of int
        Of the two stages.
    energies : list of float
    angles_deg : dict
        ``planar`` and ``spherical``: ``mean`` and ``max`` of the planes and of the spheres.
    vertex_error : dict
        ``max`` in model units and ``relative_to_edge``, the mean edge.
    circle_miss : float
        How far vertices lie from the circles of their faces, in mean edges.
    """

    converged: bool
    iterations: list[int]
    energies: list[float]
    angles_deg: dict[str, dict[str, float]]
    vertex_error: dict[str, float]
    circle_miss: float


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
    held : bool
        Whether what had to hold exactly does: nodes with axes, vertices on their spheres.
    lowest_eigenvalue : float or None
        Of the second derivatives at rest; not below -1e-8 at a minimum.
    kept : str
        ``optimum``, or what was smoother on average: ``planes`` or the spheres at the
        ``start``.
    optimum_angles_deg, start_angles_deg : dict
        ``mean`` and ``max`` of the optimum, kept or not, and of the spheres at the start.
    angles_deg, vertex_error : dict
        As in `AnglesReport`.
    """

    converged: bool
    stages: list[dict[str, Any]]
    corners: str
    vertex_move: float
    held: bool
    lowest_eigenvalue: float | None
    kept: str
    optimum_angles_deg: dict[str, float]
    start_angles_deg: dict[str, float]
    angles_deg: dict[str, dict[str, float]]
    vertex_error: dict[str, float]


class AnglesOptimum(NamedTuple):
    """Spheres of smallest angles and how they were reached."""

    sphere_mesh: SphereMesh
    report: AnglesReport


class EnergyOptimum(NamedTuple):
    """A sphere mesh of least energy and how it was reached."""

    sphere_mesh: SphereMesh
    report: EnergyReport


@node
def minimize_angles(
    sphere_mesh: SphereMesh,
    target_angle: Annotated[float, Port(unit="deg", min=0, max=90)] = 0.0,
    edge_weights: EdgeWeights | None = None,
    max_miss: Annotated[float | None, Port(min=0)] = None,
) -> AnglesOptimum:
    """Choose the spheres through the faces' circles that meet their neighbours most smoothly.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        Mesh and spheres to start from; the result does not depend on the start.
    target_angle : float
        Angle at which neighbours shall meet.
    edge_weights : (E,) float array, optional
        Weight of each interior edge; 1 for all by default.
    max_miss : float, optional
        How far a vertex may lie from the circle of its face, in mean edges; farther off it is
        an error, by default a warning.

    Returns
    -------
    sphere_mesh : SphereMesh
        The optimum. Faces whose vertices lie on no circle keep their best-fit circle.
    report : AnglesReport
        The angles before and after, and how far vertices lie off.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, minimize_angles, vase_mesh
    >>> report = minimize_angles(fit_spheres(vase_mesh(12, 6))).report
    >>> {kind: round(found["mean"], 1) for kind, found in report["angles_deg"].items()}
    {'planar': 24.9, 'spherical': 15.6}
    """
    result, run = angle_minimization.minimize_angles(
        sphere_mesh, np.radians(target_angle), edge_weights
    )
    if not run.converged:
        raise ConvergenceError(
            f"the angles did not converge in {sum(run.iterations)} steps (last step "
            f"{run.step:.1e} rad): look for nearly degenerate faces"
        )
    if max_miss is not None and run.circle_miss > max(max_miss, CIRCULAR):
        misses = circularity(result.mesh) / mean_edge_length(result.mesh)
        faces = np.flatnonzero(misses > max(max_miss, CIRCULAR)).tolist()
        raise ConvergenceError(
            f"the vertices of faces {name_ids(faces)} lie on no circle: they miss it by up to "
            f"{run.circle_miss:.3g} mean edges and {max_miss:g} is allowed; give a tolerance "
            "of about that size"
        )
    outcome = _outcome(result, sphere_mesh.mesh)
    relative = outcome["vertex_error"]["relative_to_edge"]
    if relative > VERTEX_MISS:
        warn(
            f"vertices miss their spheres by up to {relative:.3g} mean edges: the faces are "
            "not circular; panels are exact, but their corners are off the mesh by as much"
        )
    if target_angle == 0:
        _warn_of_little_gain(outcome)
    report = AnglesReport(
        converged=run.converged,
        iterations=list(run.iterations),
        energies=list(run.energies),
        **outcome,
        circle_miss=run.circle_miss,
    )
    return AnglesOptimum(result, report)


@node(version="2")
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
        Weight of nodes without torsion; with any, they have none in the end. Spheres then miss
        vertices, by what the report says: allow a tolerance, or let `land_nodes` move them.
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
        passes within the tolerance of them. Of optima that are equal, the one that moves
        vertices least is found.
    fixed_radii : (F,) float array, optional
        Radius of each face, infinite for a plane, 0 where it is free.
    interior : {"free", "glide"}
        Whether moving vertices may leave the tangent plane of the mesh.
    boundary : {"free", "glide", "fixed"}
        How boundary vertices move; gliding ones along the boundary.
    max_iterations : int
        Largest number of steps of each stage.

    Returns
    -------
    sphere_mesh : SphereMesh
        The optimum, on moved vertices if they may move. Where nothing but angles was asked for
        and flat panels or the spheres at the start meet more smoothly, these.
    report : EnergyReport
        The angles before and after, the stages, and how far vertices moved.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, optimize_spheres, vase_mesh
    >>> optimum = optimize_spheres(fit_spheres(vase_mesh(8, 4)), angle=0.01)
    >>> optimum.report["converged"], optimum.report["corners"]
    (True, 'soft')
    """
    weights = EnergyWeights(
        sphericity=sphericity, angle=angle, regularity=regularity, support=support,
        fairness=fairness, closeness=closeness,
    )  # fmt: skip
    conditions = optimization.Conditions(
        np.radians(target_angle), edge_weights, tolerance, fixed_radii, interior, boundary,
        max_iterations,
    )  # fmt: skip
    result, run = optimization.optimize_spheres(sphere_mesh, weights, conditions)
    outcome = _outcome(result, sphere_mesh.mesh)
    _warn_of_energy(run, outcome, conditions, support)
    lowest = run.lowest_eigenvalue
    report = EnergyReport(
        run.converged,
        [_stage(stage) for stage in run.stages],
        run.corners,
        run.vertex_move,
        run.is_held,
        lowest if np.isfinite(lowest) else None,
        run.kept,
        _degrees(run.figures["optimum"]),
        _degrees(run.figures["start"]),
        **outcome,
    )
    return EnergyOptimum(result, report)


def _degrees(found: Smoothness) -> dict[str, float]:
    return {"mean": float(np.degrees(found.mean)), "max": float(np.degrees(found.largest))}


def _warn_of_energy(
    run: optimization.Optimization,
    outcome: dict[str, dict[str, Any]],
    conditions: optimization.Conditions,
    support: float,
) -> None:
    """Say what did not come out, and what the optimum costs."""
    if any(stage.status == "exhausted" for stage in run.stages[-1:]):
        warn(
            f"the optimisation used up its {conditions.max_iterations} iterations: the result "
            "is its best so far; raise max_iterations"
        )
    elif not run.is_held:
        warn(
            "what has to hold does not within what is allowed: vertices miss their spheres by "
            f"up to {run.vertex_miss:.3g} mean edges; allow a larger tolerance, or ask for less"
        )
    found = {name: float(np.degrees(each.mean)) for name, each in run.figures.items()}
    if run.kept != "optimum":
        kept = "flat panels" if run.kept == "planes" else "the spheres at the start"
        warn(
            f"{kept} are kept: they meet at {found[run.kept]:.3g} degrees on average, the "
            f"optimum at {found['optimum']:.3g}; allow a tolerance for smoother panels"
        )
    elif run.corners == "own":
        warn(
            f"no common spheres within a tolerance of {conditions.tolerance:g} mean edges are "
            "smoother than flat panels: vertices stay, and each panel has corners of its own "
            "within the tolerance of them"
        )
    elif support == 0 and outcome["vertex_error"]["relative_to_edge"] > VERTEX_MISS:
        warn(
            f"vertices miss their spheres by up to {run.vertex_miss:.3g} mean edges: allow a "
            "tolerance to let them move"
        )
    if support > 0 and found["optimum"] > min(found["planes"], found["start"]):
        warn(
            f"the support costs smoothness: neighbours meet at {found['optimum']:.3g} degrees "
            f"on average, {found['start']:.3g} without it and {found['planes']:.3g} with flat "
            "panels; beams along the bisectors or the node axes leave the spheres as they are"
        )
    elif conditions.target_angle == 0 and support == 0 and run.kept == "optimum":
        _warn_of_little_gain(outcome)


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


def _outcome(sphere_mesh: SphereMesh, design: Mesh) -> dict[str, dict[str, Any]]:
    """What came out, against flat panels on the mesh as it was designed."""
    miss = float(vertex_error(sphere_mesh).max())
    return {
        "angles_deg": {
            "planar": angle_summary(face_planes(design)),
            "spherical": angle_summary(sphere_mesh),
        },
        "vertex_error": {
            "max": miss,
            "relative_to_edge": miss / mean_edge_length(sphere_mesh.mesh),
        },
    }


def _warn_of_little_gain(outcome: dict[str, dict[str, Any]]) -> None:
    planar, spherical = (
        outcome["angles_deg"][kind]["mean"] for kind in ("planar", "spherical")
    )
    if spherical > (1 - LITTLE_GAIN) * planar:
        warn(
            f"spheres gain little over planes here ({planar:.3g} to {spherical:.3g} degrees): "
            "the surface is nearly minimal or flat"
        )
