"""Writes panels into a Rhino model: exact trimmed spheres, edges as arcs, and user text.

The Breps are written and judged by `fabrication.opennurbs` before they are added. Their render
meshes are part of their streams: the setters for them crash rhino3dm at exit.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, NamedTuple, TypeAlias
from uuid import UUID

import numpy as np

from ...kernel.errors import InputError
from ...kernel.panels.checks import NO_PANEL
from ...kernel.panels.congruent import congruent_panels
from ...kernel.panels.facts import panel_radii
from ...kernel.panels.panels import Panels
from ...kernel.parts.colors import UNLABELLED, mould_color, mould_name
from ...kernel.parts.records import RejectedPart, reject_parts, select_parts
from ..opennurbs.brep_audit import verify_breps
from ..opennurbs.brep_writer import brep_streams, edge_streams
from ..opennurbs.render_meshes import MESH_TOLERANCE, panel_meshes
from ..opennurbs.shell_writer import join_panels
from ..schedules.panel_text import panel_text
from .block_writer import add_definition, add_instance, add_mould_blocks
from .model import (
    ModelLayer,
    RhinoModel,
    Untyped,
    add_group,
    add_layer,
    model_tolerance,
    object_attributes,
    object_id,
)

Layer: TypeAlias = Literal["Edges", "Centres", "Moulds"]
Shape: TypeAlias = Literal["panels", "blocks", "shell"]

_BLACK = (0, 0, 0)
_RED = (200, 30, 30)


def add_panels(
    model: RhinoModel,
    panels: Panels,
    units: str,
    shape: Shape,
    layers: Sequence[Layer],
    *,
    render_meshes: bool,
) -> tuple[tuple[RejectedPart, ...], list[str]]:
    """Add panels to a Rhino model: exact trimmed spheres, and what a workshop must know.

    Parameters
    ----------
    units : str
        Model units.
    shape : {"panels", "blocks", "shell"}
    layers : sequence of {"Edges", "Centres", "Moulds"}
        See `RhinoOptions`.
    render_meshes : bool
        Whether Breps carry triangles for viewers that cannot mesh them.

    Returns
    -------
    rejected : tuple of RejectedPart
        Panels whose Breps are not exact: they are left out.
    notes : list of str
        What else is not as asked for.

    Raises
    ------
    InputError
        If no panel is exact, or panels that are to be joined leave gaps.
    """
    sound, rejected = _judge(model, panels, render_meshes=render_meshes)
    exact = sound.panels
    moulds = _add_moulds(model, exact)
    attributes = _panel_attributes(model, exact, moulds, units)
    notes: list[str] = []
    if shape == "panels":
        for brep, each in zip(sound.breps, attributes, strict=True):
            model.file.Objects.AddBrep(brep, each)
    elif shape == "blocks":
        _add_blocks(model, sound, moulds, attributes)
    elif exact.n_panels:
        notes += _add_shell(model, sound, moulds[-1].place, model_tolerance(units))
    if "Edges" in layers:
        _add_edges(model, exact)
    if exact.is_crease.any():
        _add_creases(model, exact)
    if "Centres" in layers:
        _add_centers(model, exact)
    if "Moulds" in layers:
        notes += add_mould_blocks(model, exact, render_meshes=sound.render_meshes)
    return rejected, notes


class _Sound(NamedTuple):
    """Panels whose Breps are exact, their Breps, and whether these hold render meshes."""

    panels: Panels
    breps: list[Untyped]
    render_meshes: bool


def _judge(
    model: RhinoModel, panels: Panels, *, render_meshes: bool
) -> tuple[_Sound, tuple[RejectedPart, ...]]:
    """Panels whose Breps are exact and valid, and the others with their reasons."""
    meshes = panel_meshes(panels, MESH_TOLERANCE) if render_meshes else None
    streams = brep_streams(panels, meshes)
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


class _Mould(NamedTuple):
    """Where the panels of a mould go: their layer, and their group if they have one."""

    place: ModelLayer
    group: int | None


def _add_moulds(model: RhinoModel, panels: Panels) -> dict[int, _Mould]:
    """Layers and groups of the moulds by label, under the layer of panels without, -1."""
    root = add_layer(model, "Panels", UNLABELLED, has_material=True)
    moulds = {-1: _Mould(root, None)}
    count = int(panels.labels.max(initial=-1)) + 1
    for label in range(count):
        name, color = mould_name(label, count), mould_color(label, count)
        place = add_layer(model, name, color, root, has_material=True)
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


def _add_creases(model: RhinoModel, panels: Panels) -> None:
    """The edges that are meant to be sharp; both panels have theirs."""
    place = add_layer(model, "Creases", _RED)
    owners: list[int] = panels.corner_panels.tolist()
    streams = edge_streams(panels)
    for corner in np.flatnonzero(panels.is_crease).tolist():
        owner = owners[corner]
        name = f"crease {corner - int(panels.offsets[owner])}"
        attributes = object_attributes(model, panels.ids[owner], name, place)
        model.file.Objects.AddCurve(model.decode(streams[corner]), attributes)


def _add_centers(model: RhinoModel, panels: Panels) -> None:
    # Centres lie far away: switched off, they do not shrink the model in a view.
    place = add_layer(model, "Centres", UNLABELLED, visible=False)
    found = panel_radii(panels)
    centers, is_sphere = found.centers.tolist(), np.isfinite(found.radii).tolist()
    for name, center, has_center in zip(panels.ids, centers, is_sphere, strict=True):
        if has_center:
            attributes = object_attributes(model, name, "centre", place)
            model.file.Objects.AddPoint(model.library.Point3d(*center), attributes)
