"""What spheres will gain on a surface, and where."""

from typing import NamedTuple

import numpy as np

from ....kernel.meshes.mesh import Mesh
from ....kernel.patterns import gain_report as gains
from ....kernel.patterns.gain_report import GainMap, GainReport
from ....kernel.patterns.panel_scale import at_panel_scale, spread_to
from ....kernel.surfaces.surface import Surface
from ...graphs.node import node
from ..arrays import VertexAngles
from .reports import EdgeLength, mesh_of


class SphereGain(NamedTuple):
    """What spheres gain on a surface, and where."""

    report: GainReport
    angles: VertexAngles


@node(version=2)
def sphere_gain(
    mesh: Mesh | Surface, edge_length: EdgeLength, pattern: GainMap = "spheres"
) -> SphereGain:
    """Say before anything is made how smoothly panels will meet on a surface.

    Parameters
    ----------
    mesh : Mesh or Surface
        A dense mesh of any faces, whose curvature is estimated, or a surface as
        `read_surface` gives it, with exact curvatures.
    edge_length : float
        Length of the edges of the panels, in model units.
    pattern : {"spheres", "one-radius", "planes", "hexagons", "triangles"}
        What the angles of the vertices are for: quads with spheres of smallest angles, of one
        radius, or planes; convex hexagons; triangles with spheres of smallest angles.

    Returns
    -------
    report : GainReport
        Expected mean angles with planes and spheres in each pattern, and the gain.
    angles : (V,) float array
        Expected mean angle between neighbours around each vertex, in degrees.

    Examples
    --------
    >>> from spheremesh.nodes import sphere_gain, torus_mesh
    >>> report, angles = sphere_gain(torus_mesh(96, 48, 3.0, 1.0), edge_length=0.2)
    >>> round(report["quads"]["gain"], 2), angles.shape
    (0.18, (4608,))
    """
    gains.check_edge(edge_length)
    scale = at_panel_scale(mesh, edge_length)
    found, convex = scale.curvatures, scale.convex
    report = gains.gain_report(found, edge_length, convex)
    angles = np.degrees(gains.gain_map(found, edge_length, pattern, convex))
    places = mesh_of(mesh).vertices
    return SphereGain(report, spread_to(places, scale.mesh.vertices, angles))
