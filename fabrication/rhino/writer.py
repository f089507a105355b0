"""
Panels as a Rhino model: exact trimmed spheres, edges as arcs, and what a workshop must know.

The Breps are written by `fabrication.opennurbs` and judged by `fabrication.brep_audit` before
they are added; rhino3dm makes the file around them. Their render meshes are part of their
streams: the setters for them crash rhino3dm at exit.
"""

import os
from dataclasses import dataclass, replace
from importlib.metadata import version as installed_version
from pathlib import Path
from typing import Final, Literal, NamedTuple, TypeAlias, get_args
from uuid import UUID

import numpy as np

from ...kernel.arrays import FloatArray
from ...kernel.beams.beams import Beams
from ...kernel.errors import InputError
from ...kernel.meshes.mesh import Mesh
from ...kernel.panels.checks import NO_PANEL
from ...kernel.panels.congruent import congruent_panels
from ...kernel.panels.facts import panel_radii
from ...kernel.panels.panels import Panels
from ...kernel.parts.colors import UNLABELLED, mould_color, mould_name
from ...kernel.parts.records import RejectedPart, reject_parts, select_parts
from ..files import check_suffix, replacing
from ..model import Model, Written, check_model
from ..opennurbs.brep_audit import verify_breps
from ..opennurbs.brep_reader import read_brep_streams
from ..opennurbs.brep_writer import brep_streams, edge_streams
from ..opennurbs.render_meshes import MESH_TOLERANCE, panel_meshes
from ..opennurbs.shell_writer import join_panels
from ..schedules.panel_text import panel_text
from .beam_writer import add_beams
from .block_writer import add_definition, add_instance, add_mould_blocks
from .mesh_writer import to_rhino_mesh
from .model import (
    ModelLayer,
    RhinoModel,
    Untyped,
    add_group,
    add_layer,
    add_surface_layer,
    add_views,
    count_objects,
    encode_model,
    model_tolerance,
    new_model,
    object_attributes,
    object_id,
)

VERSIONS: Final = (6, 7, 8)
"""Versions of Rhino whose files can be written."""

Layer: TypeAlias = Literal["Edges", "Centres", "Moulds"]
Shape: TypeAlias = Literal["panels", "blocks", "shell"]

_BLACK = (0, 0, 0)
_NOTE = (
    "bulge: out for domes, in for dishes, seen along the panel's outward normal. "
    "radius: of the mould, which the outer face differs from by the side of the thickness. "
    "neighbors: beyond each edge in order, - where there is no panel."
)


@dataclass(frozen=True)
class RhinoOptions:
    """
    What a Rhino file holds, and how.

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
    render_meshes : bool
        Whether Breps and extrusions carry triangles for viewers that cannot mesh them.
    version : int
        Version of Rhino: 6, 7 or 8.
    title, graph_json : str
        Title of the model, and the graph that made it: kept in the document strings
        ``spheremesh::title`` and ``spheremesh::graph``.
    """

    shape: Shape = "panels"
    layers: tuple[Layer, ...] = ("Edges",)
    reference: Mesh | None = None
    render_meshes: bool = True
    version: int = 8
    title: str = ""
    graph_json: str = ""


_PANELS_AND_EDGES: Final = RhinoOptions()


def write_3dm(
    model: Model, path: str | os.PathLike[str], options: RhinoOptions = _PANELS_AND_EDGES
) -> Written:
    """
    Write panels and beams to a Rhino file.

    Parameters
    ----------
    model : Model
        At least one panel or beam. Of panels the outer faces are written. Beams are capped
        extrusions of their flat contours on the layer ``Beams``, with the node axes as lines on
        the layer ``Axes``, node cylinders on the layer ``Nodes`` and drilling marks on the
        layer ``Drilling``.
    path : path
        The file; an older one is replaced when the new one is whole.
    options : RhinoOptions
        What the file holds, and how.

    Returns
    -------
    Written
        The path; panels whose Breps are not exact, which are not in the file, with their
        reasons; the numbers of objects by openNURBS's names (``Brep``, ``ArcCurve``, ...);
        notes on edges that the shell leaves open, moulds whose blocks are not exact, a
        reference mesh that Rhino refuses.

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
    ``Centres``, ``Moulds`` and ``Reference`` are switched off. Each mould has its colour on
    its layer and as a material, and is a group. Named views: Top and Perspective. User text:
    `panel_text`. Object ids depend on the panel's id and the object's role only. Two runs
    differ in the time of day alone.
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
    panels, beams, units = model.panels, model.beams, model.units
    document = new_model(units)
    _set_strings(document, options.graph_json, options.title)
    rejected: tuple[RejectedPart, ...] = ()
    notes: list[str] = []
    if panels is not None:
        rejected, notes = _add_panels(document, panels, options, units)
    if beams is not None:
        add_beams(document, beams, units, render_meshes=options.render_meshes)
    add_views(document, _points(panels, beams))
    if options.reference is not None:
        notes += _add_reference(document, options.reference)
    data, objects = encode_model(document, options.version), count_objects(document)
    if len(read_brep_streams(data)) != objects.get("Brep", 0):
        raise InputError(f"cannot write {path}: rhino3dm did not encode the model")
    target = Path(path)
    with replacing(target) as temporary:
        temporary.write_bytes(data)
    return Written(target, rejected, tuple(notes), objects)


class _Sound(NamedTuple):
    """Panels whose Breps are exact, their Breps, and whether these hold render meshes."""

    panels: Panels
    breps: list[Untyped]
    render_meshes: bool


def _streams(panels: Panels, *, render_meshes: bool) -> list[bytes]:
    meshes = panel_meshes(panels, MESH_TOLERANCE) if render_meshes else None
    return brep_streams(panels, meshes)


def _judge(
    model: RhinoModel, panels: Panels, *, render_meshes: bool
) -> tuple[_Sound, tuple[RejectedPart, ...]]:
    """Panels whose Breps are exact and valid, and the others with their reasons."""
    streams = _streams(panels, render_meshes=render_meshes)
    reasons = [e.reason() for e in verify_breps(streams, panels.spheres, panels.origins)]
    breps: list[Untyped] = []
    for i, stream in enumerate(streams):
        brep = None if reasons[i] else model.decode(stream)
        if brep is not None and brep.IsValid:
            breps.append(brep)
        elif not reasons[i]:
            reasons[i] = "openNURBS cannot read the Brep or finds it invalid"
    broken = {i: reason for i, reason in enumerate(reasons) if reason}
    exact, rejected = reject_parts(panels, broken, NO_PANEL)
    if rejected and len(rejected) == panels.n_panels:
        shown = "; ".join(f"{panel.id}: {panel.reason}" for panel in rejected[:8])
        raise InputError(f"none of the {len(rejected)} panels has an exact Brep: {shown}")
    return _Sound(exact, breps, render_meshes), rejected


def _set_strings(model: RhinoModel, graph_json: str, title: str) -> None:
    version = installed_version("spheremesh")
    strings = {"version": version, "title": title, "note": _NOTE, "graph": graph_json}
    for key, text in strings.items():
        if text:
            # A path may hold bytes that are no text; a document string may not.
            model.file.Strings[f"spheremesh::{key}"] = text.encode(errors="replace").decode()


class _Mould(NamedTuple):
    """Where the panels of a mould go: their layer, and their group if they have one."""

    place: ModelLayer
    group: int | None


def _add_moulds(model: RhinoModel, panels: Panels) -> dict[int, _Mould]:
    """Layers and groups of the moulds by label, under the layer of panels without, -1."""
    root = add_surface_layer(model, "Panels", UNLABELLED)
    moulds = {-1: _Mould(root, None)}
    count = int(panels.labels.max(initial=-1)) + 1
    for label in range(count):
        name, color = mould_name(label, count), mould_color(label, count)
        place = add_surface_layer(model, name, color, root)
        moulds[label] = _Mould(place, add_group(model, name))
    return moulds


def _panel_attributes(
    model: RhinoModel, panels: Panels, moulds: dict[int, _Mould], units: str
) -> list[Untyped]:
    """Attributes of the object that stands for each panel."""
    labels: list[int] = panels.labels.tolist()
    result: list[Untyped] = []
    for name, label, text in zip(panels.ids, labels, panel_text(panels, units), strict=True):
        place, group = moulds[label]
        attributes = object_attributes(model, name, "panel", place)
        for key, value in text.items():
            attributes.SetUserString(key, value)
        if group is not None:
            attributes.AddToGroup(group)
        result.append(attributes)
    return result


def _add_panels(
    model: RhinoModel, panels: Panels, options: RhinoOptions, units: str
) -> tuple[tuple[RejectedPart, ...], list[str]]:
    """All that is known of panels; those rejected, and what else is not as asked for."""
    sound, rejected = _judge(model, panels, render_meshes=options.render_meshes)
    exact = sound.panels
    moulds = _add_moulds(model, exact)
    attributes = _panel_attributes(model, exact, moulds, units)
    notes: list[str] = []
    if options.shape == "panels":
        for brep, each in zip(sound.breps, attributes, strict=True):
            model.file.Objects.AddBrep(brep, each)
    elif options.shape == "blocks":
        _add_blocks(model, sound, moulds, attributes)
    elif exact.n_panels:
        notes += _add_shell(model, sound, moulds[-1].place, model_tolerance(units))
    if "Edges" in options.layers:
        _add_edges(model, exact)
    if "Centres" in options.layers:
        _add_centers(model, exact)
    if "Moulds" in options.layers:
        notes += add_mould_blocks(model, exact, render_meshes=sound.render_meshes)
    return rejected, notes


def _points(panels: Panels | None, beams: Beams | None) -> FloatArray:
    """All corners (n, 3), in model coordinates."""
    points: list[FloatArray] = []
    if panels is not None:
        points.append(panels.corners + panels.origins[panels.corner_panels])
    if beams is not None:
        corners = beams.annuli.corners + beams.annuli.origins[:, None, None]
        points.append(corners.reshape(-1, 3))
    return np.concatenate(points)


def _add_blocks(
    model: RhinoModel, sound: _Sound, moulds: dict[int, _Mould], attributes: list[Untyped]
) -> None:
    """Identical panels as instances of a block of their first; single ones as Breps."""
    panels = sound.panels
    found = congruent_panels(panels)
    is_single = np.bincount(found.labels)[found.labels] == 1
    first = found.representatives[found.labels]
    places = panels.origins + found.translations
    members = np.flatnonzero(~is_single & (first == np.arange(panels.n_panels)))
    chosen = select_parts(panels, np.isin(np.arange(panels.n_panels), members))
    local = replace(chosen, origins=np.zeros_like(chosen.origins))
    # What is not exact about its own origin has no block.
    judged, _ = _judge(model, local, render_meshes=sound.render_meshes)
    blocks: dict[str, UUID] = {}
    labels: list[int] = judged.panels.labels.tolist()
    for name, label, brep in zip(judged.panels.ids, labels, judged.breps, strict=True):
        member = object_attributes(model, name, "block member", moulds[label].place)
        blocks[name] = object_id(name, "block")
        add_definition(model, f"Panel {name}", blocks[name], brep, member)
    for i, each in enumerate(attributes):
        block = blocks.get(panels.ids[int(first[i])])
        if block is None:
            model.file.Objects.AddBrep(sound.breps[i], each)
        else:
            add_instance(model, block, found.rotations[i], places[i], each)


def _add_shell(
    model: RhinoModel, sound: _Sound, place: ModelLayer, largest_gap: float
) -> list[str]:
    """All panels as one Brep; what it leaves open."""
    panels = sound.panels
    meshes = panel_meshes(panels, MESH_TOLERANCE) if sound.render_meshes else None
    shell = join_panels(panels, largest_gap, meshes)
    brep = model.decode(shell.stream)
    if brep is None or not brep.IsValid:
        raise InputError("openNURBS cannot join the panels; write them one by one")
    attributes = object_attributes(model, "Shell", "shell", place)
    model.file.Objects.AddBrep(brep, attributes)
    n_open = shell.n_open
    return [f"{n_open} edges of neighbours lie apart and stay open"] if n_open else []


def _add_edges(model: RhinoModel, panels: Panels) -> None:
    place = add_layer(model, "Edges", _BLACK)
    owners: list[int] = panels.corner_panels.tolist()
    sides: list[int] = (np.arange(len(owners)) - panels.offsets[owners]).tolist()
    for stream, owner, side in zip(edge_streams(panels), owners, sides, strict=True):
        attributes = object_attributes(model, panels.ids[owner], f"edge {side}", place)
        model.file.Objects.AddCurve(model.decode(stream), attributes)


def _add_centers(model: RhinoModel, panels: Panels) -> None:
    # Centres lie far away: switched off, they do not shrink the model in a view.
    place = add_layer(model, "Centres", UNLABELLED, visible=False)
    found = panel_radii(panels)
    centers, is_sphere = found.centers.tolist(), np.isfinite(found.radii).tolist()
    for name, center, has_center in zip(panels.ids, centers, is_sphere, strict=True):
        if has_center:
            attributes = object_attributes(model, name, "centre", place)
            model.file.Objects.AddPoint(model.library.Point3d(*center), attributes)


def _add_reference(model: RhinoModel, mesh: Mesh) -> list[str]:
    """The design; or why it is left out."""
    try:
        rhino_mesh = to_rhino_mesh(mesh)
    except InputError as error:
        return [f"the reference is left out: {error}"]
    # It would flicker through the panels: it is there to be switched on.
    place = add_surface_layer(model, "Reference", UNLABELLED, visible=False)
    model.file.Objects.AddMesh(rhino_mesh, object_attributes(model, "Reference", "mesh", place))
    return []
