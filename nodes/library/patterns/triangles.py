"""Triangles of nearly one size, with spheres of smallest angles."""

from typing import NamedTuple

from ....kernel.meshes.mesh import Mesh
from ....kernel.patterns import dual_patterns
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ....kernel.surfaces.surface import Surface
from ...graphs.node import node
from .reports import EdgeLength, PatternReport, dual_report


class TrianglePattern(NamedTuple):
    """Triangles on a surface, and what they are good for."""

    sphere_mesh: SphereMesh
    report: PatternReport


@node(version=2)
def triangle_pattern(mesh: Mesh | Surface, edge_length: EdgeLength) -> TrianglePattern:
    """Cover a surface with triangles of nearly one size, and spheres that meet smoothly.

    Their nodes have torsion: beams stand upright before node cylinders (`bisector_support`).

    Parameters
    ----------
    mesh : Mesh or Surface
        A dense mesh of any faces, or a surface as `read_surface` gives it.
    edge_length : float
        Length of the edges, in model units.

    Returns
    -------
    sphere_mesh : SphereMesh
        Triangles with their vertices on the surface.
    report : PatternReport
        Angles against planes and against what `sphere_gain` expects, deviation, and flaws.

    Examples
    --------
    >>> from spheremesh.nodes import ellipsoid_mesh, triangle_pattern
    >>> report = triangle_pattern(ellipsoid_mesh(24, 12), edge_length=0.5).report
    >>> report["status"], report["gain"]["measured"] > 0.3
    ('usable', True)
    """
    net, judgement = dual_patterns.triangle_pattern(mesh, edge_length)
    report = dual_report(mesh, edge_length, "triangles", net, judgement, [])
    return TrianglePattern(net, report)
