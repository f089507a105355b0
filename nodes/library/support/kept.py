"""Spheres that a mesh has already, with the nodes of a support in them."""

from dataclasses import dataclass
from typing import NamedTuple

from ....kernel.analysis import angle_summary
from ....kernel.meshes.mesh import mean_edge_length
from ....kernel.sphere_meshes.fit import face_planes
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh, vertex_error
from ...graphs.node import node, warn
from ..optimise import OptimumReport


@dataclass(frozen=True, eq=False)
class KeptReport(OptimumReport):
    """Spheres that stayed as they were.

    Attributes
    ----------
    converged : bool
        True: there is nothing to be done.
    angles_deg : dict
        ``planar`` and ``spherical``: ``mean`` and ``max`` of the planes and of the spheres.
    vertex_error : dict
        ``max`` in model units and ``relative_to_edge``, the mean edge.
    """

    converged: bool
    angles_deg: dict[str, dict[str, float]]
    vertex_error: dict[str, float]


class KeptSpheres(NamedTuple):
    """The same sphere mesh, and how smooth it is."""

    sphere_mesh: SphereMesh
    report: KeptReport


@node
def keep_spheres(sphere_mesh: SphereMesh) -> KeptSpheres:
    """Keep spheres whose nodes are exact, as those of hexagonal and remeshed nets are.

    In place of an optimum: smaller angles would cost the common axes of the nodes.

    Parameters
    ----------
    sphere_mesh : SphereMesh

    Returns
    -------
    sphere_mesh : SphereMesh
        The same.
    report : KeptReport
        How smooth it is.

    Examples
    --------
    >>> from spheremesh.nodes import ellipsoid_mesh, keep_spheres, model_change
    >>> kept = keep_spheres(model_change(ellipsoid_mesh(12, 6), radius=4.0))
    >>> kept.report["vertex_error"]["max"] < 1e-9
    True
    """
    mesh = sphere_mesh.mesh
    planar, spherical = angle_summary(face_planes(mesh)), angle_summary(sphere_mesh)
    if spherical["mean"] > planar["mean"]:
        warn(
            "the mesh has spheres with exact nodes, which stay: neighbours meet at "
            f"{spherical['mean']:.1f} degrees on average, where planes would at "
            f"{planar['mean']:.1f}; upright beams (--support bisector) let them be smoother"
        )
    miss = float(vertex_error(sphere_mesh).max())
    report = KeptReport(
        converged=True,
        angles_deg={"planar": planar, "spherical": spherical},
        vertex_error={"max": miss, "relative_to_edge": miss / mean_edge_length(mesh)},
    )
    return KeptSpheres(sphere_mesh, report)
