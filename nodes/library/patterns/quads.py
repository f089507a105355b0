"""Quads along the lines of curvature, with a support structure."""

from typing import Annotated, Any, NamedTuple

import numpy as np

from ....kernel.meshes.mesh import Mesh
from ....kernel.patterns import quad_pattern as quads
from ....kernel.patterns.net_flaws import PatternJudgement
from ....kernel.remesh.field.guides import BoundaryLines, NetWishes
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ....kernel.surfaces.surface import Surface
from ...graphs.node import node
from ...graphs.ports import Port
from ..arrays import Segments, Vector
from .reports import (
    EdgeLength,
    Expected,
    Outcome,
    PatternReport,
    first_flaws,
    mesh_of,
    pattern_report,
)


class QuadPattern(NamedTuple):
    """A net of quads on a surface, and what it is good for."""

    sphere_mesh: SphereMesh
    report: PatternReport


@node(version="3")
def quad_pattern(
    mesh: Mesh | Surface,
    edge_length: EdgeLength,
    direction: Vector | None = None,
    guides: Segments | None = None,
    boundary: BoundaryLines = "near",
    density: Annotated[float, Port(min=0, max=1)] = 0.0,
    *,
    insist: bool = False,
) -> QuadPattern:
    """Cover a surface with quads whose spheres have a support structure.

    Spheres of a few curvatures are tried; each net follows the lines of curvature, its nodes
    are made free of torsion, and it is judged as a workshop would. The first usable one is the
    result; if there is none, the one that is least bad, with its flaws.

    Parameters
    ----------
    mesh : Mesh or Surface
        A dense mesh of any faces, or a surface as `read_surface` gives it.
    edge_length : float
        Length of the edges, in model units.
    direction : (3,) float array, optional
        Lines run along it instead of the lines of curvature, wherever it lies in the surface.
    guides : (n, 2, 3) float array, optional
        Segments of curves on the surface that lines run along; two edges away the lines of
        curvature come back.
    boundary : {"near", "follow", "free"}
        Sides of the boundary become lines where they lie within 20 degrees of one; or they are
        guides; or lines end at them as they come.
    density : float
        From 0, edges of one length, to 1: edges as the radius of curvature, at most 1.6 times
        longer or shorter, with up to a fifth fewer panels.
    insist : bool
        Whether nodes are made free of torsion even where the surface is all but a sphere, or
        lines leave the lines of curvature on more than 5 % of its area; without, such a net is
        left for upright beams.

    Returns
    -------
    sphere_mesh : SphereMesh
        Mostly quadrilaterals, cut at the boundary.
    report : PatternReport
        What was tried, angles against planes and against what `sphere_gain` expects,
        deviation, and flaws by face and cause.

    Examples
    --------
    >>> from spheremesh.nodes import quad_pattern, triangulated_surface
    >>> surface = triangulated_surface("annulus", edge_length=0.15).mesh
    >>> net, report = quad_pattern(surface, edge_length=0.7)
    >>> report["status"], report["flaws"]["faces"]
    ('usable', 0)
    """
    wishes = NetWishes(direction, guides, boundary)
    found = quads.quad_pattern(mesh, edge_length, wishes, density=density, insists=insist)
    best = found.best
    if best.net is None or best.judgement is None:  # never: the kernel refuses such surfaces
        raise AssertionError(best.message)
    planes = quads.expected_planes(found.curvatures, best.edge)
    tries = [_plain_try(each) for each in found.tries]
    report = pattern_report(
        mesh_of(mesh),
        edge_length,
        best.net,
        best.judgement,
        Expected(planes, best.choice.expected * best.edge / edge_length, found.turn),
        Outcome(best.status, _reason(found, best.judgement, edge_length), tries),
        best.distance,
    )
    return QuadPattern(best.net, report)


def _reason(found: quads.QuadPattern, judgement: PatternJudgement, edge_length: float) -> str:
    """Why a net is not usable, and what would do; empty if it is."""
    if found.best.status == "usable":
        return ""
    if found.best.status == "not planarised":
        return found.best.message
    faces = len(judgement.flawed_faces)
    return (
        f"no net of quads is usable as it is ({len(found.tries)} tried); the best has {faces} "
        f"faces with flaws ({first_flaws(judgement.flaws)}); try edges of "
        f"{0.85 * edge_length:.3g} or {1.15 * edge_length:.3g}, or upright beams "
        "(--support bisector)"
    )


def _plain_try(tried: quads.NetTry) -> dict[str, Any]:
    """A try as plain values."""
    plain: dict[str, Any] = {
        "name": tried.choice.name,
        "curvature": tried.choice.curvature,
        "edge": tried.edge,
        "expected_deg": float(np.degrees(tried.choice.expected)),
        "status": tried.status,
    }
    if tried.judgement is None:
        return plain | {"message": tried.message}
    judgement = tried.judgement
    return plain | {
        "planes_deg": float(np.degrees(judgement.flat_angle)),
        "spheres_deg": float(np.degrees(judgement.angle)),
        "planarity": judgement.planarity,
        "shortest_edge": judgement.shortest,
        "node_axis_p95_deg": float(np.degrees(judgement.lean_p95)),
        "node_distance": tried.distance,
        "turned_share": tried.turned_share,
        "flaws": len(judgement.flaws),
    }


@node
def underlying_mesh(sphere_mesh: SphereMesh) -> Mesh:
    """The mesh under a sphere mesh: its vertices and faces, without the spheres.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        A net, as from `quad_pattern`.

    Returns
    -------
    Mesh
        The same vertices and faces.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, underlying_mesh, vase_mesh
    >>> underlying_mesh(fit_spheres(vase_mesh(12, 6))).n_faces
    72
    """
    return sphere_mesh.mesh
