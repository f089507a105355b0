"""Checks of parts against each other: what overlaps, and corners of panels off their axes."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, dot, norm
from ...kernel.beams.beams import Beams, scale_beams
from ...kernel.beams.cutting import node_points
from ...kernel.beams.layers import rest_clearances
from ...kernel.beams.node_cylinders import NodeCylinders, node_cylinders
from ...kernel.clearances.bodies import (
    Bodies,
    beam_bodies,
    cylinder_bodies,
    panel_bodies,
    select_bodies,
)
from ...kernel.clearances.near_pairs import near_pairs
from ...kernel.clearances.overlaps import overlap_depths, part_pairs, separated_by_planes
from ...kernel.panels.joints import unjointed_corners
from ...kernel.panels.panels import Panels, scale_panels
from ...kernel.parts.findings import Finding
from ..units import millimeters_per
from .subjects import USUAL_LIMITS, AuditLimits


@dataclass(frozen=True)
class Assembly:
    """Panels and beams that stand together, in millimetres, and the limits."""

    panels: Panels | None
    beams: Beams | None
    limits: AuditLimits

    @cached_property
    def cylinders(self) -> NodeCylinders | None:
        """Node cylinders; None without any."""
        found = node_cylinders(self.beams) if self.beams is not None else None
        return found if found is not None and found.n_nodes else None


def assembly(
    panels: Panels | None,
    beams: Beams | None,
    units: str = "m",
    limits: AuditLimits = USUAL_LIMITS,
) -> Assembly:
    """Parts in millimetres: what `check_assembly` looks at. Empty ones count as none."""
    factor = millimeters_per(units)
    return Assembly(
        scale_panels(panels, factor) if panels is not None and panels.ids else None,
        scale_beams(beams, factor) if beams is not None and beams.ids else None,
        limits,
    )


def check_assembly(subject: Assembly) -> list[Finding]:
    """Run every check of parts against each other: P205 to P208, B102 and B103.

    The numbers of the parts are finite.
    """
    return [*_overlaps(subject), *_corners_off_axes(subject)]


def _overlaps(subject: Assembly) -> list[Finding]:
    """Parts that are in each other's place, each with the part that it overlaps most."""
    panels, beams, cylinders = subject.panels, subject.beams, subject.cylinders
    has_bodies = panels is not None and panels.thickness > 0
    plates = panel_bodies(panels) if panels is not None and has_bodies else None
    bars = beam_bodies(beams) if beams is not None else None
    posts = cylinder_bodies(cylinders) if cylinders is not None else None
    names: dict[str, tuple[str, ...]] = {
        "panel": panels.ids if panels is not None else (),
        "beam": beams.ids if beams is not None else (),
        "node": cylinders.ids if cylinders is not None else (),
    }
    findings: list[Finding] = []
    for code, (first, kind), (second, other), advice in (
        ("P206", (plates, "panel"), (plates, "panel"), "a wider joint, or larger panels"),
        ("P207", (plates, "panel"), (bars, "beam"), "let panels rest on the beams (bearing)"),
        ("P208", (plates, "panel"), (posts, "node"), "let panels rest on the beams (bearing)"),
        ("B102", (bars, "beam"), (bars, "beam"), "larger nodes or thinner beams"),
        ("B103", (bars, "beam"), (posts, "node"), "a gap at the nodes, or smaller ones"),
    ):
        if first is None or second is None:
            continue
        clear = _resting(subject) if code == "P207" else frozenset[tuple[int, int]]()
        rows, others, depths = overlapping_parts(
            first, second, subject.limits.overlap_mm, clear
        )
        message = f"overlaps {other} {{1}} by {{0:.3g}} mm: {advice}"
        pairs = list(zip(rows, others, depths, strict=True))
        if first is second:
            pairs += list(zip(others, rows, depths, strict=True))
        findings += _worst(code, names[kind], names[other], pairs, message)
    return findings


def _resting(subject: Assembly) -> frozenset[tuple[int, int]]:
    """Panels and beams beside them of which a closed formula tells that they do not overlap."""
    if subject.panels is None or subject.beams is None:
        return frozenset()
    bars, plates, clearances = rest_clearances(subject.beams, subject.panels)
    clear = clearances >= -subject.limits.overlap_mm
    return frozenset(zip(plates[clear].tolist(), bars[clear].tolist(), strict=True))


def overlapping_parts(
    first: Bodies, second: Bodies, least: float, clear: frozenset[tuple[int, int]]
) -> tuple[list[int], list[int], list[float]]:
    """Parts of two kinds that overlap by more than a depth, each pair once, and by how much.

    Pairs of parts that are known to be clear of each other are not looked at.
    """
    rows, others = near_pairs(first.boxes, second.boxes, 0.0)
    if first is second:
        keep = first.parts[rows] < first.parts[others]
        rows, others = rows[keep], others[keep]
    if clear:
        pairs = zip(first.parts[rows].tolist(), second.parts[others].tolist(), strict=True)
        keep = np.array([pair not in clear for pair in pairs], bool)
        rows, others = rows[keep], others[keep]
    apart = separated_by_planes(first, second, rows, others, least)
    rows, others = rows[~apart], others[~apart]
    depths = overlap_depths(select_bodies(first, rows), select_bodies(second, others))
    found = depths > least
    parts = part_pairs(depths[found], first.parts[rows[found]], second.parts[others[found]])
    a, b, deep = parts
    return a.tolist(), b.tolist(), deep.tolist()


def _worst(
    code: str,
    names: tuple[str, ...],
    others: tuple[str, ...],
    pairs: Iterable[tuple[int, int, float]],
    message: str,
) -> list[Finding]:
    """A finding for each part, on the other that it overlaps most."""
    worst: dict[int, tuple[int, float]] = {}
    for part, other, depth in pairs:
        if part not in worst or depth > worst[part][1]:
            worst[part] = other, depth
    return [
        Finding(code, names[part], message.format(depth, others[other]), depth)
        for part, (other, depth) in sorted(worst.items())
    ]


def _corners_off_axes(subject: Assembly) -> list[Finding]:
    """Corners of panels that are not on the axes of the nodes of the beams beside them."""
    panels, beams, limit = subject.panels, subject.beams, subject.limits.gap_mm
    if panels is None or beams is None:
        return []
    distances = corner_distances(panels, beams)
    message = (
        f"a corner is {{0:.3g}} mm off its node axis, more than {limit:g}: cut panels in the "
        "planes of their beams"
    )
    # Before node cylinders no end of a beam is at the axis either.
    severity = "note" if beams.node_radius > 0 else "error"
    return [
        Finding(
            "P205", panels.ids[i], message.format(distances[i]), float(distances[i]), severity
        )
        for i in np.flatnonzero(distances > limit).tolist()
    ]


def corner_distances(panels: Panels, beams: Beams) -> FloatArray:
    """Greatest distances (P,) of corners, without joints, from the node axes of their beams."""
    annuli = beams.annuli
    rows = _rows_of_faces(panels, annuli.edge_faces)
    carried, sides = np.nonzero(rows >= 0)
    found = rows[carried, sides]
    points = node_points(annuli)[carried] + annuli.origins[carried, None]
    corners = np.stack(unjointed_corners(panels), 1)
    degrees = panels.degrees[found]
    pairs = np.repeat(np.arange(len(found)), degrees)
    starts = np.cumsum(degrees) - degrees
    members = np.arange(len(pairs)) - starts[pairs] + panels.offsets[found][pairs]
    result = np.zeros(panels.n_panels)
    for end in (0, 1):
        local = points[:, end] - panels.origins[found]
        apart = norm(corners[members, 0] - local[pairs])
        nearest = members[np.lexsort((apart, pairs))[starts]]
        steps = corners[nearest] - local[:, None]
        axes = annuli.node_axes[carried, end][:, None]
        across = norm(steps - dot(steps, axes)[..., None] * axes).max(axis=1)
        np.maximum.at(result, found, across)
    return result


def _rows_of_faces(panels: Panels, faces: IntArray) -> IntArray:
    """Row of the panel of each face; -1 where there is none."""
    size = max(int(faces.max(initial=0)), int(panels.face_ids.max(initial=0)))
    rows = np.full(size + 2, -1)
    rows[panels.face_ids] = np.arange(panels.n_panels)
    return rows[faces]
