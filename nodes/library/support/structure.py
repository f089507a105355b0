"""Nodes of a support structure where spheres meet, and the annuli between them."""

from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from ....kernel.errors import name_ids
from ....kernel.meshes.mesh import mean_edge_length
from ....kernel.remesh.planar.landing import planarize_near
from ....kernel.reports import Report
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ....kernel.support import annulus_construction as annulus
from ....kernel.support import node_axes as support
from ....kernel.support.annuli import Annuli
from ...graphs.node import node, warn
from ...graphs.ports import Port
from ..arrays import VertexAngles, VertexAxes, VertexMarks
from .rejected import warn_of_rejected


@dataclass(frozen=True, eq=False)
class LandingReport(Report):
    """Whether nodes landed, and what it takes.

    Attributes
    ----------
    landed : bool
    moved : dict
        ``max`` and ``mean`` in mean edges, of what landing takes.
    iterations : int
    """

    landed: bool
    moved: dict[str, float]
    iterations: int


class LandedNodes(NamedTuple):
    """A sphere mesh whose beams meet exactly, if that was near."""

    sphere_mesh: SphereMesh
    report: LandingReport


class Nodes(NamedTuple):
    """The nodes of a support structure, one per vertex."""

    axes: VertexAxes
    torsion: VertexAngles
    is_valid: VertexMarks
    report: support.NodesReport


@node
def land_nodes(
    sphere_mesh: SphereMesh, max_move: Annotated[float, Port(min=0)] = 0.05
) -> LandedNodes:
    """Move nodes and spheres by a hair, until beams of every inner node share an axis exactly.

    An optimum balances torsion against angles and vertices: its nodes are good to a hundredth
    of an edge, and beams end as far from each other. Here all spheres of a node get two points
    in common, and the node is one of them. Radii change by as little: land before there are
    moulds, whose radii no net of quadrilaterals can keep; after them take `axis_support`.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh, as from `optimize_spheres` with a weight on the support.
    max_move : float
        How far nodes may move, in mean edges; if they would have to move farther, the mesh is
        returned as it is.

    Returns
    -------
    sphere_mesh : SphereMesh
        The mesh; its vertices lie on their spheres if it landed.
    report : LandingReport
        Whether it landed, and how far nodes move.

    Examples
    --------
    >>> from spheremesh.nodes import ellipsoid_mesh, land_nodes, model_change
    >>> land_nodes(model_change(ellipsoid_mesh(8, 4), radius=4.0)).report["landed"]
    True
    """
    result, is_near = planarize_near(sphere_mesh, max_move)
    farthest = float(result.shifts.max())
    moved = {"max": farthest, "mean": float(result.shifts.mean())}
    report = LandingReport(is_near, moved, result.iterations)
    if is_near:
        return LandedNodes(result.sphere_mesh, report)
    warn(
        f"beams do not meet exactly: nodes would have to move by {farthest:.2g} edges or more, "
        f"where {max_move:g} are allowed, or turn faces over, or spheres are too large to tell "
        "from planes"
    )
    return LandedNodes(sphere_mesh, report)


@node
def support_structure(sphere_mesh: SphereMesh) -> Nodes:
    """Find the axis of every node and how far its beams miss it.

    Parameters
    ----------
    sphere_mesh : SphereMesh

    Returns
    -------
    axes : (V, 2, 3) float array
        Two points of each node axis: the vertex and its mirror image in the plane of the
        centres of its spheres. Where that is farther than 100,000 mean edges (planes) or
        at the vertex itself, the point of the axis one mean edge inside. On the boundary the
        axis lies in the planes of the beams from inside, as near to the normal as they let, or
        turned until the beams of the boundary are flat.
    torsion : (V,) float array
        Largest angle between the plane of a beam and the axis, in degrees.
    is_valid : (V,) bool array
        Where the torsion is at most 0.1 degrees and the axis leans at most 60 degrees from
        the normal.
    report : NodesReport
        Torsion, tilt, and the nodes that are not valid.

    Examples
    --------
    >>> from spheremesh.nodes import ellipsoid_mesh, model_change, support_structure
    >>> nodes = support_structure(model_change(ellipsoid_mesh(12, 6), radius=4.0))
    >>> nodes.axes.shape, nodes.report["torsion_deg"]["max"] < 1e-6, nodes.report["invalid"]
    ((84, 2, 3), True, [])
    """
    found = support.support_structure(sphere_mesh)
    report = support.support_report(sphere_mesh, found)
    is_valid = np.ones(len(found.torsion), bool)
    if report["invalid"]:
        bad = [entry["vertex"] for entry in report["invalid"]]
        is_valid[bad] = False
        warn(
            f"{len(bad)} of {len(is_valid)} nodes are not valid: vertices {name_ids(bad)} "
            f"({report['invalid'][0]['id']}: {report['invalid'][0]['reason']})"
        )
    return Nodes(found.axes, np.degrees(found.torsion), is_valid, report)


class AnnulusSet(NamedTuple):
    """The annuli that can be made, and what was found on the way."""

    annuli: Annuli
    report: annulus.AnnuliReport


@node
def annulus_support(
    sphere_mesh: SphereMesh,
    depth: Annotated[float | None, Port(min=0)] = None,
    kappa: float | None = None,
    max_tilt: Annotated[float, Port(unit="deg", min=0, max=90)] = 60.0,
) -> AnnulusSet:
    """Put a flat annulus under every edge, in the plane in which its two spheres meet.

    Parameters
    ----------
    sphere_mesh : SphereMesh
    depth : float, optional
        Depth of the annuli, measured on the node axes; without this and `kappa`, a quarter of
        the mean edge.
    kappa : float, optional
        Power R² - r² of the two circles of every annulus: all are concentric. The ends reach
        from a vertex towards its mirror point; the flatter the arc, the less deep.
    max_tilt : float
        Annuli whose plane tilts more from the plane that bisects the faces are rejected.

    Returns
    -------
    annuli : Annuli
        One per edge, the boundary included, named ``B0000`` and on.
    report : AnnuliReport
        Tilt, depth, and the annuli that cannot be made.

    Examples
    --------
    >>> from spheremesh.nodes import annulus_support, ellipsoid_mesh, model_change
    >>> sphere_mesh = model_change(ellipsoid_mesh(12, 6), radius=4.0)
    >>> annuli, report = annulus_support(sphere_mesh, depth=0.1)
    >>> annuli.n_annuli, report["rejected"]
    (156, [])
    """
    edge = mean_edge_length(sphere_mesh.mesh)
    if depth is None and kappa is None:
        depth = edge / 4
    found = annulus.annulus_support(sphere_mesh, depth, kappa, np.radians(max_tilt))
    report = annulus.annulus_report(found, edge)
    warn_of_rejected(found.rejected, "annuli")
    return AnnulusSet(found.annuli, report)
