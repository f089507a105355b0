"""Convex hexagons, the smoothest over a grid of bounds."""

from typing import Annotated, Literal, NamedTuple

import numpy as np

from ....kernel.meshes.mesh import Mesh
from ....kernel.patterns import dual_patterns
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ....kernel.surfaces.surface import Surface
from ...graphs.node import node
from ...graphs.ports import Port
from .reports import EdgeLength, PatternReport, dual_report


class HexagonPattern(NamedTuple):
    """Hexagons on a surface, and what they are good for."""

    sphere_mesh: SphereMesh
    report: PatternReport


@node(version="3")
def hexagon_pattern(
    mesh: Mesh | Surface,
    edge_length: EdgeLength,
    max_axis_angle: Annotated[float, Port(unit="deg", min=0, max=90)] = 15.0,
    boundary: Literal["drop", "clip"] = "drop",
) -> HexagonPattern:
    """Cover a surface with visually convex hexagons whose beams have no torsion.

    Spheres are grown with each bound of 3, 5, 9, 15, 20 and 30 degrees that is allowed; the
    smoothest result without flaws is taken, so a looser bound is never rougher.

    Parameters
    ----------
    mesh : Mesh or Surface
        A dense mesh of any faces, or a surface as `read_surface` gives it.
    edge_length : float
        Length of the edges, in model units.
    max_axis_angle : float
        Largest angle of a node axis with the surface normal, between 0 and 90.
    boundary : {"drop", "clip"}
        Faces inside only, or also those of the boundary, cut off by planes.

    Returns
    -------
    sphere_mesh : SphereMesh
        Hexagons, and a few pentagons and heptagons; three spheres meet in each vertex.
    report : PatternReport
        What was tried, angles against planes and against what `sphere_gain` expects,
        deviation, and flaws.

    Examples
    --------
    >>> from spheremesh.nodes import ellipsoid_mesh, hexagon_pattern
    >>> report = hexagon_pattern(ellipsoid_mesh(48, 24), 0.13, max_axis_angle=5).report
    >>> report["convex_share"], sorted({each["bound_deg"] for each in report["tries"]})
    (1.0, [2.0, 3.0, 5.0])
    """
    best, tries = dual_patterns.hexagon_pattern(mesh, edge_length, max_axis_angle, boundary)
    if best.net is None or best.judgement is None:  # never: the kernel refuses such surfaces
        raise AssertionError(best.message)
    told = [
        {
            "bound_deg": each.bound,
            "spheres_deg": float(np.degrees(each.judgement.angle)),
            "node_axis_p95_deg": float(np.degrees(each.judgement.lean_p95)),
            "shortest_edge": each.judgement.shortest,
            "flaws": float(len(each.judgement.flaws)),
        }
        for each in tries
        if each.judgement is not None
    ]
    bound = float(np.radians(max_axis_angle))
    report = dual_report(mesh, edge_length, "hexagons", best.net, best.judgement, told, bound)
    return HexagonPattern(best.net, report)
