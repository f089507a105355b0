"""Writes Rhino .3dm files of panels and beams, which rhino3dm reads back."""

import os
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib.metadata import version as installed_version
from pathlib import Path
from typing import Final, get_args

import numpy as np

from ...kernel.arrays import FloatArray
from ...kernel.beams.beams import Beams
from ...kernel.errors import InputError
from ...kernel.meshes.mesh import Mesh
from ...kernel.panels.checks import NO_PANEL
from ...kernel.panels.panels import Panels
from ...kernel.parts.colors import UNLABELLED
from ...kernel.parts.findings import Finding
from ...kernel.parts.records import RejectedPart, reject_parts
from ...kernel.support.annulus_checks import NO_CUT
from ..audit.subjects import warning_texts
from ..files import check_suffix, replacing
from ..model import Model, Written, check_model
from ..rhino.mesh_writer import to_rhino_mesh
from .archive import FileObject, is_sound, refused_objects, write_archive
from .beam_writer import add_beams
from .model import (
    RhinoModel,
    add_layer,
    add_views,
    encode_model,
    new_model,
    object_attributes,
)
from .panel_writer import Layer, PanelOptions, Shape, add_panels
from .to_check import add_rejected

VERSIONS: Final = (6, 7, 8)
"""Versions of Rhino whose files can be written."""

_NOTE = (
    "bulge: out for domes, in for dishes, seen along the panel's outward normal. "
    "radius: of the mould, which the outer face differs from by the side of the thickness. "
    "neighbors: beyond each edge in order, - where there is no panel."
)


@dataclass(frozen=True)
class RhinoOptions:
    """What a Rhino file holds, and how.

    Attributes
    ----------
    shape : {"panels", "blocks", "shell"}
        One Brep per panel; the same with a block definition and instances wherever panels are
        identical (to `SAME_PANEL` of their size); or all panels joined into one Brep.
    layers : tuple of {"Edges", "Centres", "Moulds"}
        Further layers: an arc or line for every edge of every panel; the centres of spheres; a
        block for every mould, its blank, set under each of its panels.
    reference : Mesh, optional
        The design, for the layer ``Reference``.
    findings : tuple of Finding
        What an audit found: user text and a colour of the parts, texts on ``To check``.
    rejected : tuple of mapping
        ``id``, ``code`` and ``reason`` of parts that could not be made, for ``Rejected``.
    render_meshes : bool
        Whether faces without thickness carry triangles for viewers that cannot mesh them.
    version : int
        Version of Rhino: 6, 7 or 8.
    title, graph_json : str
        Title of the model, and the graph that made it: kept in the document strings
        ``spheremesh::title`` and ``spheremesh::graph``.
    """

    shape: Shape = "panels"
    layers: tuple[Layer, ...] = ("Edges",)
    reference: Mesh | None = None
    findings: tuple[Finding, ...] = ()
    rejected: tuple[Mapping[str, str], ...] = ()
    render_meshes: bool = True
    version: int = 8
    title: str = ""
    graph_json: str = ""


_REFUSED: Final = "openNURBS cannot read the Brep or finds it invalid"

_PANELS_AND_EDGES: Final = RhinoOptions()


def write_3dm(
    model: Model, path: str | os.PathLike[str], options: RhinoOptions = _PANELS_AND_EDGES
) -> Written:
    """Write panels and beams to a Rhino file.

    Parameters
    ----------
    model : Model
        At least one panel or beam. Panels are closed solids if they have a thickness, else
        their outer faces. Beams are closed solids on the layer ``Beams``, with the node axes as
        lines on the layer ``Axes``, node cylinders as solids on the layer ``Nodes`` and
        drilling marks on the layer ``Drilling``: the solids of STEP files.
    path : path
        The file; an older one is replaced when the new one is whole.
    options : RhinoOptions
        What the file holds, and how.

    Returns
    -------
    Written
        The path; panels and beams whose Breps are not exact, or that openNURBS refuses, which
        are not in the file, with their reasons; the numbers of objects by openNURBS's names
        (``Brep``, ``ArcCurve``, ...); notes on edges that the shell leaves open, moulds whose
        blocks are not exact, a reference mesh that Rhino refuses.

    Raises
    ------
    InputError
        If there are neither panels nor beams, two of them have the same name or one is not
        finite, units or version are not known, the file cannot be written, no panel is exact,
        or panels that are to be joined leave gaps.

    Notes
    -----
    Layers: ``Panels`` with a sub-layer ``Mould 01``, ... for every label (panels without a
    mould lie on ``Panels`` itself), ``Edges`` with one arc or line for every edge of every
    panel: neighbours' arcs differ by the joint and the edge gap, so both are there;
    ``Creases`` with those on creases, if there are any; ``To check`` with a text for every
    part with findings, ``Rejected`` with the outlines of what is missing; ``Centres``,
    ``Moulds`` and ``Reference`` are switched off. Each mould has its colour on its layer and
    as a material, and is a group. Named views: Top and Perspective. User text: `panel_text`,
    the volume of solids, findings. Object ids depend on the panel's id and the object's role
    only, and the date is that of SOURCE_DATE_EPOCH, or 1970: two runs give the same bytes.
    """
    check_suffix(path, ".3dm")
    if options.version not in VERSIONS:
        raise InputError(f"unknown Rhino version {options.version}: use one of {VERSIONS}")
    if options.shape not in get_args(Shape) or not set(options.layers) <= {*get_args(Layer)}:
        raise InputError(
            f"unknown shape {options.shape!r} or one of the layers {options.layers}: use "
            f"{', '.join(get_args(Shape))}, and {', '.join(get_args(Layer))}"
        )
    check_model(model, path)
    target = Path(path)
    rejected: tuple[RejectedPart, ...] = ()
    with replacing(target) as temporary:
        while True:
            document, found, notes = _document(model, options)
            rejected += found
            data = encode_model(document, options.version)
            write_archive(document.library, data, document.objects, temporary)
            ids = [each.attributes.id for each in document.objects]
            counts = Counter(each.kind for each in document.objects)
            # The streams are as large as the file: what reads it back needs the room.
            document.objects.clear()
            if is_sound(document.library, temporary, ids):
                break
            model, missing = _without(model, _refused(model, options, temporary))
            rejected += missing
    return Written(target, rejected, tuple(notes), dict(counts))


def _refused(model: Model, options: RhinoOptions, path: Path) -> list[FileObject]:
    """The objects of a model that openNURBS refuses, which were written to a file."""
    document, _, _ = _document(model, options)
    return refused_objects(document.library, path, document.objects)


def _document(
    model: Model, options: RhinoOptions
) -> tuple[RhinoModel, tuple[RejectedPart, ...], list[str]]:
    """The model as Rhino's, the parts that are left out, and notes."""
    panels, beams, units = model.panels, model.beams, model.units
    document = new_model(units)
    _set_strings(document, options.graph_json, options.title)
    warnings = warning_texts(options.findings)
    rejected: tuple[RejectedPart, ...] = ()
    notes: list[str] = []
    if panels is not None and panels.ids:
        chosen = PanelOptions(options.shape, options.layers, options.render_meshes)
        rejected, notes = add_panels(document, panels, units, chosen, warnings)
    if beams is not None and beams.ids:
        rejected += add_beams(document, beams, units, warnings)
    notes += add_rejected(document, options.reference, options.rejected)
    add_views(document, _points(panels, beams))
    if options.reference is not None:
        notes += _add_reference(document, options.reference)
    return document, rejected, notes


def _without(model: Model, refused: list[FileObject]) -> tuple[Model, tuple[RejectedPart, ...]]:
    """The model without the panels and beams whose Breps openNURBS refuses."""
    names = {each.attributes.name for each in refused}
    others = [each for each in refused if each.kind != "Brep"]
    if others:
        raise InputError(f"openNURBS refuses the {others[0].kind} {others[0].attributes.name}")
    panels, beams = model.panels, model.beams
    rejected: tuple[RejectedPart, ...] = ()
    if panels is not None:
        rows = [i for i, name in enumerate(panels.ids) if name in names]
        panels, rejected = reject_parts(panels, dict.fromkeys(rows, _REFUSED), NO_PANEL)
        if rejected and not panels.ids:
            raise InputError(
                f"none of the {len(rejected)} panels has an exact Brep: {_REFUSED}"
            )
    if beams is not None:
        rows = [i for i, name in enumerate(beams.ids) if name in names]
        beams, missing = reject_parts(beams, dict.fromkeys(rows, _REFUSED), NO_CUT)
        rejected += missing
    if not rejected:
        raise InputError(f"openNURBS refuses {', '.join(sorted(names)[:8])}")
    return replace(model, panels=panels, beams=beams), rejected


def _set_strings(model: RhinoModel, graph_json: str, title: str) -> None:
    version = installed_version("spheremesh")
    strings = {"version": version, "title": title, "note": _NOTE, "graph": graph_json}
    for key, text in strings.items():
        if text:
            # A path may hold bytes that are no text; a document string may not.
            model.file.Strings[f"spheremesh::{key}"] = text.encode(errors="replace").decode()


def _points(panels: Panels | None, beams: Beams | None) -> FloatArray:
    """All corners (n, 3), in model coordinates."""
    points: list[FloatArray] = []
    if panels is not None:
        points.append(panels.corners + panels.origins[panels.corner_panels])
    if beams is not None:
        corners = beams.annuli.corners + beams.annuli.origins[:, None, None]
        points.append(corners.reshape(-1, 3))
    return np.concatenate(points)


def _add_reference(model: RhinoModel, mesh: Mesh) -> list[str]:
    """The design; or why it is left out."""
    try:
        rhino_mesh = to_rhino_mesh(mesh)
    except InputError as error:
        return [f"the reference is left out: {error}"]
    # It would flicker through the panels: it is there to be switched on.
    place = add_layer(model, "Reference", UNLABELLED, has_material=True, visible=False)
    model.add_geometry(rhino_mesh, object_attributes("Reference", "mesh", place))
    return []
