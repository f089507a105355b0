"""Spheres that meet smoothly."""

from collections.abc import Mapping
from typing import Annotated, Any, NamedTuple

import numpy as np

from ...kernel import pencil
from ...kernel.arrays import FloatArray
from ...kernel.errors import ConvergenceError
from ...kernel.fit import face_planes
from ...kernel.mesh import mean_edge_length
from ...kernel.sphere_mesh import SphereMesh, intersection_angles, vertex_error
from ...kernel.tolerances import LITTLE_GAIN, VERTEX_MISS
from ..node import node, warn
from ..ports import Port


class Optimum(NamedTuple):
    """An optimised sphere mesh and how it was reached."""

    sphere_mesh: SphereMesh
    report: Mapping[str, Any]


@node
def minimize_angles(
    sphere_mesh: SphereMesh,
    target_angle: Annotated[float, Port(unit="deg", min=0, max=90)] = 0.0,
    edge_weights: FloatArray | None = None,
) -> Optimum:
    """
    Choose the spheres through the faces' circles that meet their neighbours most smoothly.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        Mesh and spheres to start from; the result does not depend on the start.
    target_angle : float
        Angle at which neighbours shall meet.
    edge_weights : (E,) float array, optional
        Weight of each interior edge; 1 for all by default.

    Returns
    -------
    sphere_mesh : SphereMesh
        The optimum. Faces whose vertices lie on no circle keep their best-fit circle.
    report : mapping
        ``converged``, ``iterations`` of the two stages, ``energies``, ``angles_deg`` (mean and
        max, of the planes and of the spheres), ``vertex_error`` (max, and relative to the mean
        edge) and ``circle_miss`` (relative to the mean edge).
    """
    result, run = pencil.minimize_angles(sphere_mesh, np.radians(target_angle), edge_weights)
    if not run.converged:
        raise ConvergenceError(
            f"the angles did not come to rest in {sum(run.iterations)} steps (last step "
            f"{run.step:.1e} rad): look for nearly degenerate faces"
        )
    planar = _angles(face_planes(result.mesh))
    spherical = _angles(result)
    miss = float(vertex_error(result).max())
    relative = miss / mean_edge_length(result.mesh)
    if relative > VERTEX_MISS:
        warn(
            f"vertices miss their spheres by up to {relative:.3g} mean edges: the faces are "
            "not circular; panels are exact, but their corners move off the mesh by as much"
        )
    if target_angle == 0 and spherical["mean"] > (1 - LITTLE_GAIN) * planar["mean"]:
        warn(
            f"spheres gain little over planes here ({planar['mean']:.3g} to "
            f"{spherical['mean']:.3g} degrees): the surface is nearly minimal or flat"
        )
    report = {
        "converged": run.converged,
        "iterations": list(run.iterations),
        "energies": list(run.energies),
        "angles_deg": {"planar": planar, "spherical": spherical},
        "vertex_error": {"max": miss, "relative_to_edge": relative},
        "circle_miss": run.circle_miss,
    }
    return Optimum(result, report)


def _angles(sphere_mesh: SphereMesh) -> dict[str, float]:
    angles = np.degrees(intersection_angles(sphere_mesh))
    if len(angles) == 0:
        return {"mean": 0.0, "max": 0.0}
    return {"mean": float(angles.mean()), "max": float(angles.max())}
