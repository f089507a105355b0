"""Marks in a Rhino model what was found: parts to be checked, and parts that are missing.

A part with findings has them as user text and is orange where it stands; a text on the layer
``To check`` names it. Where a part could not be made, the outline of its face or the line of
its edge is on the layer ``Rejected``, red, with the reason.
"""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from ...kernel.arrays import FloatArray
from ...kernel.meshes.mesh import Mesh
from ...kernel.parts.colors import Color
from ...kernel.parts.records import part_ids
from ..opennurbs.brep_writer import line_streams
from .archive import ObjectAttributes
from .model import RhinoModel, add_layer, object_attributes

_ORANGE: Final[Color] = (240, 140, 20)
_RED: Final[Color] = (214, 34, 34)


def mark(attributes: ObjectAttributes, warning: str) -> ObjectAttributes:
    """Attributes of a part with its findings, if there are any.

    Parameters
    ----------
    attributes : ObjectAttributes
    warning : str
        What was found on the part; empty for nothing.

    Returns
    -------
    ObjectAttributes
        With the text ``findings`` and a colour of its own.
    """
    if not warning:
        return attributes
    text = {**attributes.text, "findings": warning}
    return attributes._replace(text=text, color=_ORANGE, material=None)


def add_findings(
    model: RhinoModel, places: Mapping[str, FloatArray], warnings: Mapping[str, str]
) -> None:
    """Name the parts with findings, each where it stands, on the layer ``To check``.

    Parameters
    ----------
    model : RhinoModel
    places : mapping of str to (3,) float array
        Points of the parts that are in the model, by their names.
    warnings : mapping of str to str
        What was found, by the names of parts.
    """
    found = [name for name in places if name in warnings]
    if not found:
        return
    place = add_layer(model, "To check", _ORANGE)
    library = model.library
    for name in found:
        codes = sorted({text.split(" ", 1)[0] for text in warnings[name].split("; ")})
        point = library.Point3d(*places[name].tolist())
        dot = library.TextDot(f"{name} {' '.join(codes)}", point)
        text = {"findings": warnings[name]}
        model.add_geometry(dot, object_attributes(name, "to check", place, text))


def add_rejected(
    model: RhinoModel, mesh: Mesh | None, rejected: Sequence[Mapping[str, str]]
) -> list[str]:
    """Show where parts are missing, on the layer ``Rejected``.

    Parameters
    ----------
    model : RhinoModel
    mesh : Mesh, optional
        The design, whose faces and edges parts are named after.
    rejected : sequence of mapping
        ``id``, ``code`` and ``reason`` of each.

    Returns
    -------
    list of str
        Remarks on those that cannot be shown.
    """
    if not rejected:
        return []
    outlines = {} if mesh is None else _outlines(mesh)
    place = add_layer(model, "Rejected", _RED)
    missing: list[str] = []
    for part in rejected:
        segments = outlines.get(part["id"])
        if segments is None:
            missing.append(part["id"])
            continue
        text = {"id": part["id"], "findings": f"{part['code']} {part['reason']}"}
        for i, stream in enumerate(line_streams(segments)):
            attributes = object_attributes(part["id"], f"rejected {i}", place, text)
            model.add("LineCurve", stream, attributes)
    if not missing:
        return []
    shown = ", ".join(missing[:8])
    return [
        f"where {len(missing)} parts are missing is not shown, as no mesh has them: {shown}"
    ]


def _outlines(mesh: Mesh) -> dict[str, FloatArray]:
    """Segments (n, 2, 3) of what parts were to be made of: faces of panels, edges of beams."""
    points = mesh.vertices[mesh.corners]
    sides = np.stack([points, mesh.vertices[mesh.corners[mesh.topology.next_corners]]], axis=1)
    faces = np.split(sides, mesh.offsets[1:-1])
    edges = mesh.vertices[mesh.topology.edge_vertices][:, None]
    return {
        **dict(zip(part_ids("P", mesh.n_faces), faces, strict=True)),
        **dict(zip(part_ids("B", len(edges)), edges, strict=True)),
    }
