"""Spheres, and vertices where they may move, of the least energy."""

from dataclasses import dataclass
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np

from ....kernel.meshes.creases import crease_edges
from ....kernel.optimization import whole_energy as optimization
from ....kernel.optimization.comparison import Smoothness
from ....kernel.optimization.energies.table import EnergyWeights
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ....kernel.tolerances import VERTEX_MISS
from ...graphs.node import node, warn
from ...graphs.ports import Port
from ..arrays import CreaseAngle, EdgeWeights, FaceRadii
from .outcomes import (
    OptimumReport,
    counted_weights,
    outcome_of,
    warn_of_losses,
    warn_of_support,
)

Weight = Annotated[float, Port(min=0)]


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
        ``optimum``, or ``planes`` or the spheres at the ``start`` where these are smoother.
    optimum_angles_deg, start_angles_deg : dict
        ``mean`` and ``max`` of the optimum, kept or not, and of the spheres at the start.
    angles_deg, vertex_error, creases : dict
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
    creases: dict[str, Any]


class EnergyOptimum(NamedTuple):
    """A sphere mesh of least energy and how it was reached."""

    sphere_mesh: SphereMesh
    report: EnergyReport


@node(version="4")
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
    crease : float
        Edges at which the flat faces turn by more stay sharp: their angle counts nothing. 180
        for no creases.

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
    >>> optimum = optimize_spheres(fit_spheres(vase_mesh(12, 4)), angle=0.01)
    >>> optimum.report["converged"], optimum.report["corners"]
    (True, 'soft')
    """
    weights = EnergyWeights(
        sphericity=sphericity, angle=angle, regularity=regularity, support=support,
        fairness=fairness, closeness=closeness,
    )  # fmt: skip
    is_crease = crease_edges(sphere_mesh.mesh, np.radians(crease))
    smooth = counted_weights(edge_weights, is_crease)
    conditions = optimization.Conditions(
        np.radians(target_angle), smooth, tolerance, fixed_radii, interior, boundary,
        max_iterations,
    )  # fmt: skip
    result, run = optimization.optimize_spheres(sphere_mesh, weights, conditions)
    outcome = outcome_of(result, sphere_mesh.mesh, is_crease, crease)
    _warn_of_energy(run, outcome, conditions, support)
    if support > 0:
        warn_of_support(sphere_mesh, result, outcome, ~is_crease)
    elif target_angle == 0 and run.kept == "optimum":
        warn_of_losses(result, sphere_mesh.mesh, smooth, is_crease)
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
    if run.stages[-1].status == "exhausted":
        warn(
            f"the optimisation used up its {conditions.max_iterations} iterations: the result "
            "is its best so far; raise max_iterations"
        )
    elif not run.is_held:
        warn(
            "what has to hold does not: vertices miss their spheres by up to "
            f"{run.vertex_miss:.3g} mean edges; allow a larger tolerance"
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


def _stage(stage: optimization.Stage) -> dict[str, Any]:
    return {
        "name": stage.name,
        "status": stage.status,
        "iterations": stage.iterations,
        "energies": {name: list(map(float, e)) for name, e in stage.energies.items()},
    }
