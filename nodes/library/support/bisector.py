"""Upright beams for any mesh: their planes bisect the faces, cylinders take up the torsion."""

from typing import Annotated, Final, Literal, NamedTuple

import numpy as np

from ....kernel.beams.layers import lowered_annuli
from ....kernel.beams.node_radius import least_node_radius as least_radius
from ....kernel.meshes.mesh import mean_edge_length
from ....kernel.panels.panels import Panels
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ....kernel.support import beam_supports, clear_joints
from ....kernel.support.annuli import Annuli, mean_end_depth
from ....kernel.support.annulus_construction import annuli_in_planes
from ...graphs.node import node, warn
from ...graphs.ports import Length, Port
from ..arrays import VertexAxes
from .rejected import warn_of_rejected

WORTH_SAYING: Final = 1e-3
"""Joints wider than this, in mean edges, that nobody asked for are said."""


class BisectorSupport(NamedTuple):
    """Upright annuli, the axes of their nodes, and what was found on the way."""

    annuli: Annuli
    axes: VertexAxes
    report: beam_supports.SupportReport


@node
def bisector_support(
    sphere_mesh: SphereMesh,
    depth: Annotated[float | None, Port(min=0)] = None,
    kappa: float | None = None,
    thickness: Annotated[float | None, Port(min=0)] = None,
) -> BisectorSupport:
    """Put an upright beam under every edge of any mesh, in the plane that bisects its faces.

    Vertices and spheres stay. The beams of a node have no axis in common: by how much they miss
    it is the torsion, and node cylinders take it up, at which beams end square. Cut the panels
    with ``edges="bisector"``, and their walls stand on the beams.

    Parameters
    ----------
    sphere_mesh : SphereMesh
    depth : float, optional
        Depth of the beams, measured on the node axes; without this and `kappa`, a quarter of
        the mean edge.
    kappa : float, optional
        Power R² - r² of the two circles of every beam, as in `annulus_support`.
    thickness : float, optional
        Thickness of the beams, for the least radius of the node cylinders; by default a tenth
        of the mean depth.

    Returns
    -------
    annuli : Annuli
        One per edge, the boundary included, named ``B0000`` and on. Each outer circle is the
        mean of those in which the two panels meet the plane.
    axes : (V, 2, 3) float array
        The vertex, and a point of the axis one mean edge inside: as near as can be to the
        planes of the beams.
    report : SupportReport
        Torsion, gaps, the least radius of node cylinders, and the beams that cannot be made.

    Examples
    --------
    >>> from spheremesh.nodes import bisector_support, fit_spheres, triangulate, vase_mesh
    >>> annuli, axes, report = bisector_support(fit_spheres(triangulate(vase_mesh(12, 6))))
    >>> annuli.n_annuli, report["rejected"], report["node_radius"] > 0
    (228, [], True)
    """
    if depth is None and kappa is None:
        depth = mean_edge_length(sphere_mesh.mesh) / 4
    axes = beam_supports.NodeAxes(beam_supports.bisector_axes(sphere_mesh), is_exact=False)
    found = annuli_in_planes(
        sphere_mesh, "bisector", axes.points, depth, kappa, float(np.pi / 2)
    )
    warn_of_rejected(found.rejected, "beams")
    if thickness is None:
        thickness = mean_end_depth(found.annuli) / 10
    radius = least_radius(found.annuli, thickness)
    report = beam_supports.beam_support_report(sphere_mesh, found, "bisector", axes, radius)
    return BisectorSupport(found.annuli, axes.points, report)


@node
def least_node_radius(
    annuli: Annuli,
    thickness: Annotated[float | None, Port(min=0)] = None,
    node_gap: Length = 0.0,
    panels: Panels | None = None,
    bearing: Length = 0.0,
) -> float:
    """Find the least radius of node cylinders at which no two beams run into each other.

    Parameters
    ----------
    annuli : Annuli
    thickness : float, optional
        Thickness of the beams, in model units; by default a tenth of the mean depth, as in
        `beams`.
    node_gap : float
        Width of the gap between beams and node cylinders.
    panels : Panels, optional
        Panels that rest on the beams: these begin below, as in `beams`.
    bearing : float
        Clear distance from panel to beam, in model units.

    Returns
    -------
    float
        The radius, in model units.

    Examples
    --------
    >>> from spheremesh.nodes import bisector_support, fit_spheres, least_node_radius
    >>> from spheremesh.nodes import triangulate, vase_mesh
    >>> annuli = bisector_support(fit_spheres(triangulate(vase_mesh(12, 6))), depth=0.1).annuli
    >>> round(least_node_radius(annuli, thickness=0.01), 4)
    0.0681
    """
    if thickness is None:
        thickness = mean_end_depth(annuli) / 10
    if panels is not None:
        annuli = lowered_annuli(annuli, panels, thickness, bearing)
    return least_radius(annuli, thickness, node_gap)


@node
def least_joint(
    sphere_mesh: SphereMesh,
    axes: VertexAxes,
    thickness: Length = 0.0,
    joint_gap: Length = 0.0,
    edges: Literal["bisector", "axis"] = "bisector",
) -> float:
    """Find the least joint at which panels on beams clear each other at the nodes.

    Parameters
    ----------
    sphere_mesh : SphereMesh
    axes : (V, 2, 3) float array
        Two points of each node axis, as `bisector_support` or `axis_support` gives them.
    thickness : float
        Thickness of the panels, in model units; surfaces need no joint.
    joint_gap : float
        Width that is asked for: the result is at least that.
    edges : {"bisector", "axis"}
        How the panels will be cut.

    Returns
    -------
    float
        Width of the joints, in model units.

    Examples
    --------
    >>> from spheremesh.nodes import axis_support, fit_spheres, least_joint, vase_mesh
    >>> spheres = fit_spheres(vase_mesh(12, 6))
    >>> axes = axis_support(spheres).axes
    >>> least_joint(spheres, axes, thickness=0.02, joint_gap=0.005, edges="axis")
    0.005
    """
    width = clear_joints.least_joint(sphere_mesh, edges, axes, thickness)
    if width <= joint_gap:
        return joint_gap
    if width > WORTH_SAYING * mean_edge_length(sphere_mesh.mesh):
        warn(
            f"joints are {width:.3g} wide, so that panels which are no neighbours clear each "
            "other at nodes with torsion"
        )
    return width
