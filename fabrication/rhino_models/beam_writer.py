"""Writes beams into a Rhino model: exact solids, drilling marks, nodes.

Nodes are lines along their axes, and cylinders where beams end square before them.
"""

from collections.abc import Mapping

import numpy as np

from ...kernel.beams.beams import Beams, DrillMarks, node_axis_segments
from ...kernel.beams.facts import BeamFacts
from ...kernel.beams.node_cylinders import node_cylinders
from ...kernel.errors import InputError
from ...kernel.parts.colors import AXIS_COLOR, BEAM_COLOR, NODE_COLOR
from ...kernel.parts.records import RejectedPart, reject_parts
from ...kernel.support.annulus_checks import NO_CUT
from ...kernel.support.node_axes import node_name
from ..audit.beams import beam_subject
from ..opennurbs.brep_audit import verify_breps
from ..opennurbs.brep_writer import circle_streams, line_streams
from ..units import millimeters_per
from .model import RhinoModel, add_layer, object_attributes
from .solids import beam_streams, cylinder_streams
from .to_check import add_findings, mark


def add_beams(
    model: RhinoModel, beams: Beams, units: str, warnings: Mapping[str, str]
) -> tuple[RejectedPart, ...]:
    """Add beams and their nodes.

    Beams lie on the layer ``Beams``, the node axes on the layer ``Axes``; where there are any,
    node cylinders on the layer ``Nodes`` and drilling marks on the layer ``Drilling``.

    Parameters
    ----------
    model : RhinoModel
    beams : Beams
    units : str
        Model units.
    warnings : mapping of str to str
        What was found, by the names of beams.

    Returns
    -------
    tuple of RejectedPart
        Beams whose Breps are not exact: they are left out.
    """
    streams, facts = beam_streams(beams), beam_subject(beams, units).facts
    texts = _beam_text(beams, facts, units)
    volumes = facts.volumes / millimeters_per(units) ** 3
    judged = zip(verify_breps(streams), volumes.tolist(), strict=True)
    reasons = [errors.reason(volume) for errors, volume in judged]
    place = add_layer(model, "Beams", BEAM_COLOR, has_material=True)
    rows = zip(beams.ids, streams, reasons, texts, strict=True)
    for name, stream, reason, text in rows:
        if not reason:
            attributes = object_attributes(name, "beam", place, text)
            model.add("Brep", stream, mark(attributes, warnings.get(name, "")))
    broken = {i: reason for i, reason in enumerate(reasons) if reason}
    made, rejected = reject_parts(beams, broken, NO_CUT)
    middles = beams.annuli.origins + beams.sections.mean(axis=(1, 2))
    add_findings(model, dict(zip(made.ids, middles, strict=False)), warnings)
    _add_nodes(model, beams)
    if beams.marks is not None:
        _add_marks(model, beams, beams.marks)
    return rejected


def _beam_text(beams: Beams, facts: BeamFacts, units: str) -> list[dict[str, str]]:
    """User text of each beam; ``-`` is beyond the boundary, `tilt` in degrees."""
    annuli, unit = beams.annuli, millimeters_per(units)
    lengths = np.stack([facts.outer_radii, facts.inner_radii, facts.lengths]) / unit
    volumes, tilts = facts.volumes / unit**3, np.degrees(facts.tilts)
    rows = zip(
        annuli.ids, annuli.edge_ids.tolist(), annuli.edge_vertices.tolist(),
        annuli.edge_faces.tolist(), *lengths.tolist(), volumes.tolist(), tilts.tolist(),
        strict=True,
    )  # fmt: skip
    return [
        {
            "id": name,
            "edge": str(edge),
            "nodes": " ".join(map(str, nodes)),
            "faces": " ".join("-" if face < 0 else str(face) for face in faces),
            "outer_radius": _radius(outer),
            "inner_radius": _radius(inner),
            "thickness": f"{beams.thickness:.12g}",
            "length": f"{length:.12g}",
            "volume": f"{volume:.12g}",
            "tilt": f"{tilt:.6g}",
            "units": units,
        }
        for name, edge, nodes, faces, outer, inner, length, volume, tilt in rows
    ]


def _radius(value: float) -> str:
    return f"{value:.12g}" if np.isfinite(value) else "straight"


def _add_nodes(model: RhinoModel, beams: Beams) -> None:
    """The axes, between the outer and the inner corners of beams, and cylinders."""
    place = add_layer(model, "Axes", AXIS_COLOR)
    vertices, segments = node_axis_segments(beams)
    for vertex, stream in zip(vertices, line_streams(segments), strict=True):
        model.add("LineCurve", stream, object_attributes(node_name(vertex), "axis", place))
    cylinders = node_cylinders(beams)
    if not cylinders.n_nodes:
        return
    place = add_layer(model, "Nodes", NODE_COLOR, has_material=True)
    streams = cylinder_streams(cylinders)
    for name, stream, errors in zip(cylinders.ids, streams, verify_breps(streams), strict=True):
        if errors.reason():
            raise InputError(f"node {name} has no exact Brep: {errors.reason()}")
        model.add("Brep", stream, object_attributes(name, "node", place))


def _add_marks(model: RhinoModel, beams: Beams, marks: DrillMarks) -> None:
    """A circle for each hole, on the side of the normal, numbered along its beam."""
    annuli, fits = beams.annuli, np.flatnonzero(marks.fits)
    lifts = annuli.origins + annuli.frames[:, 2] * beams.thickness / 2
    centers = (marks.holes + lifts[:, None])[fits]
    count = centers.shape[1]
    x, axes = (np.repeat(annuli.frames[fits, i], count, axis=0) for i in (0, 2))
    radii = np.full(len(x), marks.diameter / 2)
    place = add_layer(model, "Drilling", AXIS_COLOR)
    names = [(annuli.ids[i], number) for i in fits.tolist() for number in range(count)]
    streams = circle_streams(centers.reshape(-1, 3), x, axes, radii)
    for (name, number), stream in zip(names, streams, strict=True):
        attributes = object_attributes(name, f"mark {number}", place)
        model.add("ArcCurve", stream, attributes)
