"""Spheres that meet their neighbours smoothly, or at a given angle."""

from dataclasses import dataclass
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np

from ....kernel.errors import ConvergenceError, name_ids
from ....kernel.meshes.mesh import Mesh, mean_edge_length
from ....kernel.optimization import angle_minimization
from ....kernel.sphere_meshes.planarity_circularity import circularity
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ....kernel.tolerances import CIRCULAR, OPENING, VERTEX_MISS
from ...graphs.node import node, warn
from ...graphs.ports import Port
from ..arrays import CreaseAngle, EdgeWeights
from .outcomes import (
    OptimumReport,
    counted_weights,
    flatten_rejected,
    outcome_of,
    warn_of_losses,
)


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


class AnglesOptimum(NamedTuple):
    """Spheres of smallest angles and how they were reached."""

    sphere_mesh: SphereMesh
    report: AnglesReport


@node(version="3")
def minimize_angles(
    sphere_mesh: SphereMesh,
    target_angle: Annotated[float, Port(unit="deg", min=0, max=90)] = 0.0,
    edge_weights: EdgeWeights | None = None,
    max_miss: Annotated[float | None, Port(min=0)] = None,
    crease: CreaseAngle = 40.0,
    max_opening: Annotated[float | None, Port(unit="deg", min=0, max=180)] = None,
    sides: Literal["both", "one"] = "both",
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
    sides : {"both", "one"}
        Whether panels that meet at a target angle may bulge to both sides, which comes nearest
        to it, or to one, as cushions do. To both, the planes of their arcs lean over the faces,
        and cut by bisectors they leave steps: few such panels can be built.

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
        sphere_mesh, np.radians(target_angle), edge_weights, np.radians(crease), opening, sides
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
        weights = counted_weights(edge_weights, run.is_crease)
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
