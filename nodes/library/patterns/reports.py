"""What is said of every pattern."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np

from ....kernel.arrays import norm
from ....kernel.meshes.mesh import (
    Mesh,
    face_centroids,
    face_vector_areas,
    mean_edge_length,
)
from ....kernel.patterns.deviations import deviations
from ....kernel.patterns.gain_report import SHARP_TURN, gain_maps, turn_p95
from ....kernel.patterns.net_flaws import Flaw, PatternJudgement, flaw_counts
from ....kernel.patterns.panel_scale import USUAL_BOUND, at_panel_scale
from ....kernel.reports import Report
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ....kernel.surfaces.surface import Surface
from ...graphs.node import warn
from ...graphs.ports import Port

EdgeLength = Annotated[float, Port(min=0)]

DualPattern = Literal["hexagons", "triangles"]

SMALLER = 0.75
"""Share of the length asked for below which panels are smaller, which is told."""

REGULAR_AREAS = {"hexagons": 1.5 * np.sqrt(3), "triangles": np.sqrt(3) / 4}
"""Areas of regular panels with edges of 1."""

TOLD = 3
"""Flaws that a warning names; all are in the report."""


@dataclass(frozen=True, eq=False)
class PatternReport(Report):
    """A pattern of panels, how it was found and what it is good for.

    Attributes
    ----------
    status : {"usable", "flawed", "not planarised"}
        Whether all panels, and in quads all beams, can be made.
    reason : str
        Why it is not usable, or rougher than planes, and what would do; empty if neither.
    faces : dict
        ``count``, and ``degrees``: how many of each.
    edges : dict
        ``target`` and ``mean`` length, and the shortest, ``min``, in mean edges.
    tries : list of dict
        What was tried: of quads the curvatures, of hexagons the bounds on node axes.
    angles_deg : dict
        Mean angle between neighbours: ``planes`` (of the same faces), ``spheres``, and
        ``expected`` of panels of their size.
    gain : dict
        Share by which spheres lessen the angle of planes: ``measured`` and ``expected``.
    convex_share : float
        Share of the faces that are visually convex.
    planarity : float
        Of the worst node; below 1e-6 nodes are free of torsion. 0 where no nodes are exact.
    node_axis_deg : dict
        Angles of node axes with the normals: ``p95`` and ``max``; 0 where there are none.
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
    tries: list[dict[str, Any]]
    angles_deg: dict[str, float]
    gain: dict[str, float]
    convex_share: float
    planarity: float
    node_axis_deg: dict[str, float]
    largest_cap_deg: float
    rejected: dict[str, int]
    deviation: dict[str, float]
    turn_p95_deg: float
    flaws: dict[str, Any]


class Expected(NamedTuple):
    """What curvatures foretell: mean angles, and the turn of the surface over an edge.

    All in radians.
    """

    planes: float
    spheres: float
    turn: float


class Outcome(NamedTuple):
    """How a search for a pattern ended: status, reason and tries of its report."""

    status: str
    reason: str
    tries: list[dict[str, Any]]


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
    surface: Mesh,
    edge_length: float,
    net: SphereMesh,
    judgement: PatternJudgement,
    expected: Expected,
    outcome: Outcome,
    node_distance: float | None = None,
) -> PatternReport:
    """The report of a pattern; warns of the reason, and of ribs.

    The distance of nodes is that from the smooth surface where it is known.
    """
    warn_of_ribs(expected.turn, edge_length)
    if outcome.reason:
        warn(outcome.reason)
    found = deviations(net, surface)
    off = found if node_distance is None else found._replace(nodes=node_distance)
    gained = 1 - expected.spheres / expected.planes if expected.planes > 0 else 0.0
    return PatternReport(
        status=outcome.status,
        reason=outcome.reason,
        faces=face_counts(net.mesh),
        edges={
            "target": float(edge_length),
            "mean": mean_edge_length(net.mesh),
            "min": judgement.shortest,
        },
        tries=outcome.tries,
        angles_deg={
            "planes": float(np.degrees(judgement.flat_angle)),
            "spheres": float(np.degrees(judgement.angle)),
            "expected": float(np.degrees(expected.spheres)),
        },
        gain={"measured": 1 - judgement.roughness, "expected": gained},
        convex_share=judgement.convex_share,
        planarity=judgement.planarity,
        node_axis_deg={
            "p95": float(np.degrees(judgement.lean_p95)),
            "max": float(np.degrees(judgement.lean_max)),
        },
        largest_cap_deg=float(np.degrees(judgement.cap)),
        rejected={"panels": judgement.rejected_panels, "beams": judgement.rejected_beams},
        deviation=off._asdict(),
        turn_p95_deg=float(np.degrees(expected.turn)),
        flaws=flaw_counts(judgement.flaws),
    )


def dual_report(
    source: Mesh | Surface,
    edge_length: float,
    which: DualPattern,
    net: SphereMesh,
    judgement: PatternJudgement,
    tries: list[dict[str, Any]],
    bound: float = USUAL_BOUND,
) -> PatternReport:
    """The report of triangles or hexagons; warns where they came out smaller than asked for.

    The bound is that on the node axes of hexagons, in radians.
    """
    size = _panel_edge(net.mesh, which)
    scale = at_panel_scale(source, size, bound)
    found = scale.curvatures
    if size < SMALLER * edge_length:
        warn(
            f"panels have edges of about {size:.3g}, not {edge_length:g}: larger ones would "
            "leave the surface, which bends too much or is cut too finely at its boundary"
        )
    planes, spheres = gain_maps(found, size, which, scale.convex)
    expected = Expected(found.mean(planes), found.mean(spheres), turn_p95(found, edge_length))
    status = "usable" if judgement.is_usable else "flawed"
    outcome = Outcome(status, _dual_reason(judgement, which), tries)
    return pattern_report(mesh_of(source), edge_length, net, judgement, expected, outcome)


def mesh_of(source: Mesh | Surface) -> Mesh:
    """The mesh of a surface, or the mesh itself."""
    return source.mesh if isinstance(source, Surface) else source


def _panel_edge(mesh: Mesh, which: DualPattern) -> float:
    """Edge of regular panels of the same mean area."""
    area = float(norm(face_vector_areas(mesh)).mean())
    return float(np.sqrt(area / REGULAR_AREAS[which]))


def neighbor_distance(mesh: Mesh) -> float:
    """Mean distance of the centres of neighbouring faces."""
    left, right = face_centroids(mesh)[mesh.topology.edge_faces].transpose(1, 0, 2)
    return float(norm(left - right).mean())


def flaw_reason(judgement: PatternJudgement) -> str:
    """How many faces have flaws, and the first of these; empty if none has."""
    if not judgement.flaws:
        return ""
    faces = len({flaw.face for flaw in judgement.flaws})
    return f"{faces} faces have flaws ({first_flaws(judgement.flaws)})"


def _dual_reason(judgement: PatternJudgement, which: DualPattern) -> str:
    """Why a pattern is not usable, or no better than planes."""
    reasons = [flaw_reason(judgement)] if judgement.flaws else []
    if judgement.angle > judgement.flat_angle:
        why = (
            "convex panels need spheres smaller than the surface bends, and here that costs "
            "more than it gains; quads or planes are smoother, or looser node axes"
            if which == "hexagons"
            else "the surface is too uneven for panels of this size; choose shorter edges"
        )
        reasons.append(
            f"neighbours meet at {np.degrees(judgement.angle):.1f} degrees on average, planes "
            f"would at {np.degrees(judgement.flat_angle):.1f}: {why}"
        )
    return "; ".join(reasons)
