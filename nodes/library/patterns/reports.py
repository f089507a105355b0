"""What is said of every pattern."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from ....kernel.arrays import norm
from ....kernel.meshes.mesh import Mesh, face_vector_areas, mean_edge_length
from ....kernel.patterns.deviations import deviations
from ....kernel.patterns.gain_report import SHARP_TURN, GainMap, gain_map, turn_p95
from ....kernel.patterns.net_flaws import FaceJudgement, Flaw, flaw_counts
from ....kernel.patterns.surface_curvatures import surface_curvatures
from ....kernel.reports import Report
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ....kernel.surfaces.surface import Surface
from ...graphs.node import warn
from ...graphs.ports import Port

EdgeLength = Annotated[float, Port(min=0)]

SMALLER = 0.75
"""Share of the length asked for below which panels are smaller, which is told."""

REGULAR_AREAS = {"hexagons": 1.5 * np.sqrt(3), "triangles": np.sqrt(3) / 4}
"""Areas of regular panels with edges of 1."""

TOLD = 3
"""Flaws that a warning names; all are in the report."""


@dataclass(frozen=True, eq=False)
class PatternReport(Report):
    """A pattern of hexagons or triangles, and what it is good for.

    Attributes
    ----------
    status : {"usable", "flawed"}
        Whether panels of all faces can be made.
    reason : str
        Why it is not usable, or rougher than planes; empty if neither.
    faces : dict
        ``count``, and ``degrees``: how many of each.
    edges : dict
        ``target`` and ``mean`` length, and the shortest, ``min``, in mean edges.
    tries : list of dict
        Of hexagons, each bound tried: ``bound_deg``, ``spheres_deg``, ``node_axis_p95_deg``,
        ``shortest_edge`` and number of ``flaws``.
    angles_deg : dict
        Mean angle between neighbours: ``planes`` (of the same faces), ``spheres``, and
        ``expected`` of panels of their size.
    gain : float
        Share by which spheres lessen the angle of planes.
    convex_share : float
        Share of the faces that are visually convex.
    node_axis_deg : dict
        Of hexagons, angles of node axes with the normals: ``p95`` and ``max``.
    largest_cap_deg : float
        Half opening of the widest panel.
    rejected : dict
        Number of ``panels`` that cannot be made.
    deviation : dict
        Largest distances in mean edges: of ``panels`` from the surface, of the ``surface``
        from the panels.
    turn_p95_deg : float
        Turn of the surface over an edge, at 95 % of its area.
    flaws : dict
        Number of ``faces`` with flaws, and ``list``: ``face`` and ``cause`` of each.
    """

    status: str
    reason: str
    faces: dict[str, Any]
    edges: dict[str, float]
    tries: list[dict[str, float]]
    angles_deg: dict[str, float]
    gain: float
    convex_share: float
    node_axis_deg: dict[str, float]
    largest_cap_deg: float
    rejected: dict[str, int]
    deviation: dict[str, float]
    turn_p95_deg: float
    flaws: dict[str, Any]


def face_counts(mesh: Mesh) -> dict[str, Any]:
    """``count`` of the faces, and ``degrees``: how many of each."""
    degrees, counts = np.unique(mesh.degrees, return_counts=True)
    pairs = zip(degrees.tolist(), counts.tolist(), strict=True)
    return {"count": mesh.n_faces, "degrees": {str(degree): n for degree, n in pairs}}


def first_flaws(flaws: Sequence[Flaw]) -> str:
    """The first flaws, for a sentence."""
    shown = "; ".join(
        flaw.cause if flaw.face is None else f"face {flaw.face}: {flaw.cause}"
        for flaw in flaws[:TOLD]
    )
    return f"{shown}; ..." if len(flaws) > TOLD else shown


def warn_of_ribs(turn: float, edge_length: float) -> None:
    """Warn where a surface turns more sharply than an edge can span."""
    if turn > SHARP_TURN:
        warn(
            f"the surface turns by {np.degrees(turn):.0f} degrees over an edge at 5 % of its "
            "area: panels are larger than its ribs; choose edges of "
            f"{edge_length * SHARP_TURN / turn:.3g} or less"
        )


def pattern_report(
    source: Mesh | Surface,
    edge_length: float,
    which: GainMap,
    net: SphereMesh,
    judgement: FaceJudgement,
    tries: list[dict[str, float]],
    axes: dict[str, float],
) -> PatternReport:
    """The report of a pattern; warns of flaws, of ribs, and where planes are smoother."""
    surface = source.mesh if isinstance(source, Surface) else source
    found = surface_curvatures(source)
    size = _panel_edge(net.mesh, which)
    if size < SMALLER * edge_length:
        warn(
            f"panels have edges of about {size:.3g}, not {edge_length:g}: larger ones would "
            "leave the surface, which bends too much or is cut too finely at its boundary"
        )
    expected = found.mean(gain_map(found, size, which))
    turn = turn_p95(found, edge_length)
    warn_of_ribs(turn, edge_length)
    reason = _reason(judgement)
    if reason:
        warn(reason)
    panels_off, surface_off = deviations(net, surface)
    flat, bent = judgement.flat_angle, judgement.angle
    return PatternReport(
        status="flawed" if judgement.flaws else "usable",
        reason=reason,
        faces=face_counts(net.mesh),
        edges={
            "target": float(edge_length),
            "mean": mean_edge_length(net.mesh),
            "min": judgement.shortest,
        },
        tries=tries,
        angles_deg={
            "planes": float(np.degrees(flat)),
            "spheres": float(np.degrees(bent)),
            "expected": float(np.degrees(expected)),
        },
        gain=1 - bent / flat if flat > 0 else 0.0,
        convex_share=judgement.convex_share,
        node_axis_deg=axes,
        largest_cap_deg=float(np.degrees(judgement.cap)),
        rejected={"panels": judgement.rejected_panels},
        deviation={"panels": panels_off, "surface": surface_off},
        turn_p95_deg=float(np.degrees(turn)),
        flaws=flaw_counts(judgement.flaws),
    )


def _panel_edge(mesh: Mesh, which: GainMap) -> float:
    """Edge of regular panels of the same mean area."""
    area = float(norm(face_vector_areas(mesh)).mean())
    return float(np.sqrt(area / REGULAR_AREAS[which]))


def _reason(judgement: FaceJudgement) -> str:
    """Why a pattern is not usable, or no better than planes."""
    reasons: list[str] = []
    if judgement.flaws:
        faces = len({flaw.face for flaw in judgement.flaws})
        reasons.append(f"{faces} faces have flaws ({first_flaws(judgement.flaws)})")
    if judgement.angle > judgement.flat_angle:
        reasons.append(
            f"neighbours meet at {np.degrees(judgement.angle):.1f} degrees on average, planes "
            f"would at {np.degrees(judgement.flat_angle):.1f}: convex panels need spheres "
            "smaller than the surface bends, and here that costs more than it gains; quads or "
            "planes are smoother, or looser node axes"
        )
    return "; ".join(reasons)
