"""Rows of the schedule for beams and their nodes, with all that a workshop asks for.

In millimetres and degrees. The same ids stand in STEP, Rhino, drawings and report files.
"""

from typing import Any

import numpy as np

from ...kernel.beams.beams import Beams
from ...kernel.beams.node_cylinders import node_cylinders
from ...kernel.support.node_axes import node_name
from ..audit.beams import BeamSubject, beam_subject, check_beams
from ..audit.subjects import warning_texts
from ..tables import finite_or_none
from ..units import CUBIC_METER


def beam_tables(beams: Beams, units: str) -> dict[str, list[dict[str, Any]]]:
    """What the schedule says of beams and node cylinders, as plain values.

    ``Beams``: B rows of the columns ``id``, ``edge``, ``panels`` (ids left and right; None
    beyond the boundary), ``nodes`` (ids at both ends), ``thickness_mm``, ``depths_mm`` (on the
    node axes of both ends), ``width_mm`` (in the middle), ``outer_length_mm`` and
    ``inner_length_mm`` (along the arcs of the contour), ``outer_radius_mm`` and
    ``inner_radius_mm`` (None for straight arcs), ``chord_mm`` and ``sagitta_mm`` (of the outer
    arc, positive to the outer side), ``length_mm`` (longest chord of the piece), ``size_mm``
    (length and width of the rectangle about the piece in its plane), ``volume_m3``,
    ``bevels_deg`` (of the cuts at both ends, on the lower and the upper side; 90 is square),
    ``tilt_deg`` (against the surface), ``twists_deg`` (against the node axes),
    ``mismatches_mm`` (between the ends at a node), ``clearances_mm`` (to neighbours that are
    cut alike; None where there is none), ``ends_mm`` (outer corners on the node axes),
    ``holes`` (number of drilling marks) and ``warnings`` (findings of the audit).

    ``Nodes``: rows of ``id``, ``vertex``, ``radius_mm``, ``height_mm``, ``outer_mm`` (centre of
    the outer disc), ``direction`` (unit vector to the inner side) and ``beams`` (ids); empty
    where beams are mitred.
    """
    subject = beam_subject(beams, units)
    return {"Beams": _beam_rows(subject), "Nodes": _node_rows(subject.parts)}


def _beam_rows(subject: BeamSubject) -> list[dict[str, Any]]:
    made, annuli, facts = subject.parts, subject.parts.annuli, subject.facts
    warnings = warning_texts(check_beams(subject))
    bevels, twists = np.degrees(facts.bevels), np.degrees(facts.twists)
    holes = _holes(made)
    return [
        {
            "id": name,
            "edge": int(annuli.edge_ids[i]),
            "panels": list(annuli.panel_ids[i]),
            "nodes": [node_name(vertex) for vertex in annuli.edge_vertices[i].tolist()],
            "thickness_mm": made.thickness,
            "depths_mm": facts.depths[i].tolist(),
            "width_mm": float(facts.widths[i]),
            "outer_length_mm": float(facts.outer_lengths[i]),
            "inner_length_mm": float(facts.inner_lengths[i]),
            "outer_radius_mm": finite_or_none(facts.outer_radii[i]),
            "inner_radius_mm": finite_or_none(facts.inner_radii[i]),
            "chord_mm": float(facts.chords[i]),
            "sagitta_mm": float(facts.sagittas[i]),
            "length_mm": float(facts.lengths[i]),
            "size_mm": facts.sizes[i].tolist(),
            "volume_m3": float(facts.volumes[i]) / CUBIC_METER,
            "bevels_deg": bevels[i].tolist(),
            "tilt_deg": float(np.degrees(facts.tilts[i])),
            "twists_deg": twists[i].tolist(),
            "mismatches_mm": facts.mismatches[i].tolist(),
            "clearances_mm": [finite_or_none(gap) for gap in facts.clearances[i]],
            "ends_mm": facts.ends[i].tolist(),
            "holes": holes[i],
            "warnings": warnings.get(name, ""),
        }
        for i, name in enumerate(annuli.ids)
    ]


def _holes(beams: Beams) -> list[int]:
    """Number of drilling marks of each beam."""
    if beams.marks is None:
        return [0] * beams.n_beams
    count = beams.marks.holes.shape[1]
    return [count if fits else 0 for fits in beams.marks.fits.tolist()]


def _node_rows(made: Beams) -> list[dict[str, Any]]:
    found = node_cylinders(made)
    return [
        {
            "id": name,
            "vertex": vertex,
            "radius_mm": found.radius,
            "height_mm": float(found.heights[i]),
            "outer_mm": found.origins[i].tolist(),
            "direction": found.directions[i].tolist(),
            "beams": list(found.beam_ids[i]),
        }
        for i, (name, vertex) in enumerate(zip(found.ids, found.vertices.tolist(), strict=True))
    ]
