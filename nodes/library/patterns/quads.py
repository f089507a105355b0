"""Quads along the lines of curvature, with a support structure."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ....kernel.meshes.mesh import Mesh, mean_edge_length
from ....kernel.patterns import quad_pattern as quads
from ....kernel.patterns.deviations import deviations
from ....kernel.patterns.net_flaws import NetJudgement, flaw_counts
from ....kernel.reports import Report
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ....kernel.surfaces.surface import Surface
from ...graphs.node import node, warn
from .reports import EdgeLength, face_counts, first_flaws, warn_of_ribs


@dataclass(frozen=True, eq=False)
class QuadPatternReport(Report):
    """A net of quads, how it was found and what it is good for.

    Attributes
    ----------
    status : {"usable", "flawed", "not planarised"}
        Whether panels and beams of all faces can be made.
    reason : str
        Why it is not usable, and what would do; empty if it is.
    faces : dict
        ``count``, and ``degrees``: how many of each.
    edges : dict
        ``target`` and ``mean`` length, and the shortest, ``min``, in mean edges.
    curvature : float
        Of the spheres, before planarising; positive where they bend to the normals.
    tries : list of dict
        ``name``, ``curvature``, ``expected_deg`` and ``status`` of each curvature tried; of
        nets that were judged also the measures below.
    angles_deg : dict
        Mean angle between neighbours: ``planes`` (of the same faces), ``spheres``, and
        ``expected`` beforehand.
    gain : dict
        Share by which spheres lessen the angle of planes: ``measured`` and ``expected``.
    planarity : float
        Of the worst node; below 1e-6 nodes are free of torsion.
    node_axis_deg : dict
        Angles of node axes with the normals: ``p95`` and ``max``.
    largest_cap_deg : float
        Half opening of the widest panel.
    rejected : dict
        Numbers of ``panels`` and ``beams`` that cannot be made.
    deviation : dict
        Largest distances in mean edges: of the ``nodes`` inside and of the ``panels`` from the
        surface, and of the ``surface`` from the panels.
    turn_p95_deg : float
        Turn of the surface over an edge, at 95 % of its area.
    flaws : dict
        Number of ``faces`` with flaws, and ``list``: ``face`` and ``cause`` of each.
    """

    status: str
    reason: str
    faces: dict[str, Any]
    edges: dict[str, float]
    curvature: float
    tries: list[dict[str, Any]]
    angles_deg: dict[str, float]
    gain: dict[str, float]
    planarity: float
    node_axis_deg: dict[str, float]
    largest_cap_deg: float
    rejected: dict[str, int]
    deviation: dict[str, float]
    turn_p95_deg: float
    flaws: dict[str, Any]


class QuadPattern(NamedTuple):
    """A net of quads on a surface, and what it is good for."""

    sphere_mesh: SphereMesh
    report: QuadPatternReport


@node
def quad_pattern(mesh: Mesh | Surface, edge_length: EdgeLength) -> QuadPattern:
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

    Returns
    -------
    sphere_mesh : SphereMesh
        Mostly quadrilaterals, cut at the boundary.
    report : QuadPatternReport
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
    found = quads.quad_pattern(mesh, edge_length)
    best = found.best
    if best.net is None or best.judgement is None:  # never: the kernel refuses such surfaces
        raise AssertionError(best.message)
    surface = mesh.mesh if isinstance(mesh, Surface) else mesh
    reason = _reason(found, best.judgement, edge_length)
    if reason:
        warn(reason)
    warn_of_ribs(found.turn, edge_length)
    report = _quad_report(found, best.net, best.judgement, surface, edge_length, reason)
    return QuadPattern(best.net, report)


def _reason(found: quads.QuadPattern, judgement: NetJudgement, edge_length: float) -> str:
    """Why a net is not usable, and what would do; empty if it is."""
    if found.best.status == "usable":
        return ""
    if found.best.status == "not planarised":
        return found.best.message
    faces = len({flaw.face for flaw in judgement.flaws if flaw.face is not None})
    return (
        f"no net of quads is usable as it is ({len(found.tries)} tried); the best has {faces} "
        f"faces with flaws ({first_flaws(judgement.flaws)}); try edges of "
        f"{0.85 * edge_length:.3g} or {1.15 * edge_length:.3g}, or upright beams "
        "(--support bisector)"
    )


def _quad_report(
    found: quads.QuadPattern,
    net: SphereMesh,
    judgement: NetJudgement,
    surface: Mesh,
    edge_length: float,
    reason: str,
) -> QuadPatternReport:
    best, mesh = found.best, net.mesh
    planes = quads.expected_planes(found.curvatures, edge_length)
    panels_off, surface_off = deviations(net, surface)
    return QuadPatternReport(
        status=best.status,
        reason=reason,
        faces=face_counts(mesh),
        edges={
            "target": float(edge_length),
            "mean": mean_edge_length(mesh),
            "min": judgement.shortest,
        },
        curvature=best.choice.curvature,
        tries=[_plain_try(each) for each in found.tries],
        angles_deg={
            "planes": float(np.degrees(judgement.flat_angle)),
            "spheres": float(np.degrees(judgement.angle)),
            "expected": float(np.degrees(best.choice.expected)),
        },
        gain={
            "measured": 1 - judgement.roughness,
            "expected": 1 - best.choice.expected / planes if planes > 0 else 0.0,
        },
        planarity=judgement.planarity,
        node_axis_deg={
            "p95": float(np.degrees(judgement.lean_p95)),
            "max": float(np.degrees(judgement.lean_max)),
        },
        largest_cap_deg=float(np.degrees(judgement.cap)),
        rejected={"panels": judgement.rejected_panels, "beams": judgement.rejected_beams},
        deviation={"nodes": best.distance, "panels": panels_off, "surface": surface_off},
        turn_p95_deg=float(np.degrees(found.turn)),
        flaws=flaw_counts(judgement.flaws),
    )


def _plain_try(tried: quads.NetTry) -> dict[str, Any]:
    """A try as plain values."""
    plain: dict[str, Any] = {
        "name": tried.choice.name,
        "curvature": tried.choice.curvature,
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
