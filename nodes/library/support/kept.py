"""Spheres that a mesh has already, with the nodes of a support in them."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ....kernel.meshes.creases import crease_edges
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...graphs.node import node, warn
from ..arrays import CreaseAngle
from ..optimise.outcomes import OptimumReport, outcome_of


@dataclass(frozen=True, eq=False)
class KeptReport(OptimumReport):
    """Spheres that stayed as they were.

    Attributes
    ----------
    converged : bool
        True: there is nothing to be done.
    angles_deg, vertex_error, creases : dict
        As in `AnglesReport`.
    """

    converged: bool
    angles_deg: dict[str, dict[str, float]]
    vertex_error: dict[str, float]
    creases: dict[str, Any]


class KeptSpheres(NamedTuple):
    """The same sphere mesh, and how smooth it is."""

    sphere_mesh: SphereMesh
    report: KeptReport


@node
def keep_spheres(sphere_mesh: SphereMesh, crease: CreaseAngle = 40.0) -> KeptSpheres:
    """Keep spheres whose nodes are exact, as those of hexagonal and remeshed nets are.

    In place of an optimum: smaller angles would cost the common axes of the nodes.

    Parameters
    ----------
    sphere_mesh : SphereMesh
    crease : float
        Edges at which the flat faces turn by more count in no mean; 180 for none.

    Returns
    -------
    sphere_mesh : SphereMesh
        The same.
    report : KeptReport
        How smooth it is.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, keep_spheres, vase_mesh
    >>> kept = keep_spheres(fit_spheres(vase_mesh(12, 6)))
    >>> round(kept.report["vertex_error"]["max"], 9)
    0.0
    """
    mesh = sphere_mesh.mesh
    is_crease = crease_edges(mesh, np.radians(crease))
    found = outcome_of(sphere_mesh, mesh, is_crease, crease)
    planar, spherical = found["angles_deg"]["planar"], found["angles_deg"]["spherical"]
    if spherical["mean"] > planar["mean"]:
        warn(
            "the mesh has spheres with exact nodes, which stay: neighbours meet at "
            f"{spherical['mean']:.1f} degrees on average, where planes would at "
            f"{planar['mean']:.1f}; upright beams (--support bisector) let them be smoother"
        )
    return KeptSpheres(sphere_mesh, KeptReport(converged=True, **found))
