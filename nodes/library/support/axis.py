"""Beams in planes of their edge and its node axes: vertices and spheres stay."""

from typing import Annotated, NamedTuple

import numpy as np

from ....kernel.meshes.mesh import mean_edge_length
from ....kernel.panels.edge_axes import check_axes
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ....kernel.support import beam_supports
from ....kernel.support.annuli import Annuli
from ....kernel.support.annulus_construction import annuli_in_planes
from ...graphs.node import node
from ...graphs.ports import Port
from ..arrays import VertexAxes
from .rejected import warn_of_rejected


class AxisSupport(NamedTuple):
    """Annuli between node axes, these axes, and what was found on the way."""

    annuli: Annuli
    axes: VertexAxes
    report: beam_supports.SupportReport


@node
def node_axes(sphere_mesh: SphereMesh) -> VertexAxes:
    """Find node axes between which beams are flat, for `axis_support` after moulds.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh before moulds: where all of its nodes are exact, their axes are taken.

    Returns
    -------
    (V, 2, 3) float array
        The vertex, and a point of the axis one mean edge inside.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, node_axes, vase_mesh
    >>> node_axes(fit_spheres(vase_mesh(12, 6))).shape
    (84, 2, 3)
    """
    return beam_supports.support_axes(sphere_mesh).points


@node
def axis_support(
    sphere_mesh: SphereMesh,
    depth: Annotated[float | None, Port(min=0)] = None,
    kappa: float | None = None,
    max_tilt: Annotated[float, Port(unit="deg", min=0, max=90)] = 60.0,
    axes: VertexAxes | None = None,
) -> AxisSupport:
    """Put a flat beam under every edge, in the plane of its chord and its two node axes.

    Vertices and spheres stay. The axes are as near to the normals as flat beams let them, and
    do not depend on radii: spheres may come from any number of moulds. Cut the panels with
    ``edges="axis"`` and the same axes, and their walls stand on the beams.

    Parameters
    ----------
    sphere_mesh : SphereMesh
    depth : float, optional
        Depth of the beams, measured on the node axes; without this and `kappa`, a quarter of
        the mean edge.
    kappa : float, optional
        Power R² - r² of the two circles of every beam, as in `annulus_support`.
    max_tilt : float
        Beams whose plane tilts more from the plane that bisects the faces are rejected.
    axes : (V, 2, 3) float array, optional
        Two points of each node axis, as `node_axes` and `support_structure` give them; by
        default those of the spheres where all nodes are exact already (hexagons, remeshed
        nets), else the best for the mesh.

    Returns
    -------
    annuli : Annuli
        One per edge, the boundary included, named ``B0000`` and on. Each outer circle is the
        mean of those in which the two panels meet the plane.
    axes : (V, 2, 3) float array
        The vertex, and a point of the axis one mean edge inside.
    report : SupportReport
        Torsion, tilt, gaps, and the beams that cannot be made.

    Examples
    --------
    >>> from spheremesh.nodes import axis_support, fit_spheres, vase_mesh
    >>> annuli, axes, report = axis_support(fit_spheres(vase_mesh(12, 6)), depth=0.1)
    >>> annuli.n_annuli, axes.shape, report["rejected"]
    (156, (84, 2, 3), [])
    """
    mesh = sphere_mesh.mesh
    edge = mean_edge_length(mesh)
    if axes is None:
        chosen = beam_supports.support_axes(sphere_mesh)
    else:
        check_axes(mesh, "axis", axes)
        chosen = beam_supports.NodeAxes(axes, is_exact=False)
    if depth is None and kappa is None:
        depth = edge / 4
    found = annuli_in_planes(
        sphere_mesh, "axis", chosen.points, depth, kappa, float(np.radians(max_tilt))
    )
    warn_of_rejected(found.rejected, "beams")
    report = beam_supports.beam_support_report(sphere_mesh, found, "axis", chosen)
    return AxisSupport(found.annuli, chosen.points, report)
