"""Writes panels into a Rhino model: exact faces or solids, edges as arcs, and user text.

The Breps are written and judged by `fabrication.opennurbs` before they are added. The render
meshes of faces are part of their streams: the setters for them crash rhino3dm at exit.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple, TypeAlias
from uuid import UUID

import numpy as np

from ...kernel.arrays import FloatArray, IntArray
from ...kernel.errors import InputError
from ...kernel.panels.checks import NO_PANEL
from ...kernel.panels.congruent import congruent_panels
from ...kernel.panels.facts import panel_radii
from ...kernel.panels.panels import Panels
from ...kernel.parts.colors import UNLABELLED, mould_color, mould_name
from ...kernel.parts.records import RejectedPart, reject_parts, select_parts
from ...kernel.spheres.incidence import project
from ..audit.panels import panel_subject
from ..opennurbs.brep_audit import verify_breps
from ..opennurbs.brep_writer import edge_streams
from ..opennurbs.render_meshes import MESH_TOLERANCE, panel_meshes
from ..opennurbs.shell_writer import join_panels
from ..schedules.panel_text import panel_text
from ..units import millimeters_per
from .archive import ObjectAttributes, instance_stream
from .block_writer import add_definition, add_mould_blocks
from .model import (
    ModelLayer,
    RhinoModel,
    add_group,
    add_layer,
    model_tolerance,
    object_attributes,
    object_id,
)
from .solids import panel_streams
from .to_check import add_findings, mark

Layer: TypeAlias = Literal["Edges", "Centres", "Moulds"]
Shape: TypeAlias = Literal["panels", "blocks", "shell"]

_BLACK = (0, 0, 0)
_RED = (200, 30, 30)


@dataclass(frozen=True)
class PanelOptions:
    """What of panels goes into a file, and how: see `RhinoOptions`."""

    shape: Shape
    layers: tuple[Layer, ...]
    render_meshes: bool


def add_panels(
    model: RhinoModel,
    panels: Panels,
    units: str,
    options: PanelOptions,
    warnings: Mapping[str, str],
) -> tuple[tuple[RejectedPart, ...], list[str]]:
    """Add panels to a Rhino model: exact solids or faces, and what a workshop must know.

    Parameters
    ----------
    model : RhinoModel
    panels : Panels
    units : str
        Model units.
    options : PanelOptions
        What is added of them, and how.
    warnings : mapping of str to str
        What was found, by the names of panels.

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
    volumes = None
    if panels.thickness > 0:
        volumes = panel_subject(panels, units).facts.volumes / millimeters_per(units) ** 3
    sound, rejected = _judge(panels, volumes, has_meshes=options.render_meshes)
    exact = sound.panels
    moulds = _add_moulds(model, exact)
    attributes = _panel_attributes(exact, sound.volumes, moulds, units, warnings)
    notes: list[str] = []
    if options.shape == "panels":
        for stream, each in zip(sound.streams, attributes, strict=True):
            model.add("Brep", stream, each)
    elif options.shape == "blocks":
        _add_blocks(model, sound, moulds, attributes)
    elif exact.n_panels:
        notes += _add_shell(model, sound, moulds[-1].place, model_tolerance(units))
    middles = exact.origins + _middles(exact)
    add_findings(model, dict(zip(exact.ids, middles, strict=True)), warnings)
    if "Edges" in options.layers:
        _add_edges(model, exact)
    if exact.is_crease.any():
        _add_creases(model, exact)
    if "Centres" in options.layers:
        _add_centers(model, exact)
    if "Moulds" in options.layers:
        notes += add_mould_blocks(model, exact, render_meshes=options.render_meshes)
    return rejected, notes


def _middles(panels: Panels) -> FloatArray:
    """Points (P, 3) of outer faces, local."""
    means = np.add.reduceat(panels.corners, panels.offsets[:-1]) / panels.degrees[:, None]
    return project(panels.spheres, means)


class _Sound(NamedTuple):
    """Panels whose Breps are exact, their Breps, volumes if they have a thickness."""

    panels: Panels
    streams: list[bytes]
    volumes: FloatArray | None
    has_meshes: bool


def _judge(
    panels: Panels, volumes: FloatArray | None, *, has_meshes: bool
) -> tuple[_Sound, tuple[RejectedPart, ...]]:
    """Panels whose Breps are exact, and the others with their reasons."""
    meshes = panel_meshes(panels, MESH_TOLERANCE) if has_meshes and volumes is None else None
    streams = panel_streams(panels, meshes)
    measured = [None] * panels.n_panels if volumes is None else volumes.tolist()
    judged = zip(verify_breps(streams, panels.spheres, panels.origins), measured, strict=True)
    reasons = [errors.reason(volume) for errors, volume in judged]
    broken = {i: reason for i, reason in enumerate(reasons) if reason}
    exact, rejected = reject_parts(panels, broken, NO_PANEL)
    if rejected and len(rejected) == panels.n_panels:
        shown = "; ".join(f"{panel.id}: {panel.reason}" for panel in rejected[:8])
        raise InputError(f"none of the {len(rejected)} panels has an exact Brep: {shown}")
    kept = [i for i in range(panels.n_panels) if i not in broken]
    volumes = None if volumes is None else volumes[kept]
    return _Sound(exact, [streams[i] for i in kept], volumes, has_meshes), rejected


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
    panels: Panels,
    volumes: FloatArray | None,
    moulds: dict[int, _Mould],
    units: str,
    warnings: Mapping[str, str],
) -> list[ObjectAttributes]:
    """Attributes of the object that stands for each panel."""
    labels: list[int] = panels.labels.tolist()
    texts = panel_text(panels, units)
    if volumes is not None:
        pairs = zip(texts, volumes.tolist(), strict=True)
        texts = [{**text, "volume": f"{volume:.12g}"} for text, volume in pairs]
    result: list[ObjectAttributes] = []
    for name, label, text in zip(panels.ids, labels, texts, strict=True):
        place, group = moulds[label]
        attributes = object_attributes(name, "panel", place, text)
        attributes = attributes._replace(groups=() if group is None else (group,))
        result.append(mark(attributes, warnings.get(name, "")))
    return result


def _add_blocks(
    model: RhinoModel,
    sound: _Sound,
    moulds: dict[int, _Mould],
    attributes: list[ObjectAttributes],
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
    volumes = None if sound.volumes is None else sound.volumes[members]
    judged, _ = _judge(local, volumes, has_meshes=sound.has_meshes)
    blocks: dict[str, UUID] = {}
    labels: list[int] = judged.panels.labels.tolist()
    for name, label, stream in zip(judged.panels.ids, labels, judged.streams, strict=True):
        member = object_attributes(name, "block member", moulds[label].place)
        blocks[name] = object_id(name, "block")
        add_definition(model, f"Panel {name}", blocks[name], stream, member)
    for i, each in enumerate(attributes):
        block = blocks.get(panels.ids[int(first[i])])
        if block is None:
            model.add("Brep", sound.streams[i], each)
        else:
            instance = instance_stream(block, found.rotations[i], places[i])
            model.add("InstanceReference", instance, each)


def _add_shell(
    model: RhinoModel, sound: _Sound, place: ModelLayer, largest_gap: float
) -> list[str]:
    """The outer faces of all panels as one Brep; what it leaves open."""
    panels = sound.panels
    meshes = panel_meshes(panels, MESH_TOLERANCE) if sound.has_meshes else None
    shell = join_panels(panels, largest_gap, meshes)
    model.add("Brep", shell.stream, object_attributes("Shell", "shell", place))
    n_open = shell.n_open
    return [f"{n_open} edges of neighbours lie apart and stay open"] if n_open else []


def _add_edges(model: RhinoModel, panels: Panels) -> None:
    place = add_layer(model, "Edges", _BLACK)
    _add_sides(model, panels, place, "edge", np.arange(len(panels.corners)))


def _add_creases(model: RhinoModel, panels: Panels) -> None:
    """The edges that are meant to be sharp; both panels have theirs."""
    place = add_layer(model, "Creases", _RED)
    _add_sides(model, panels, place, "crease", np.flatnonzero(panels.is_crease))


def _add_sides(
    model: RhinoModel, panels: Panels, place: ModelLayer, role: str, corners: IntArray
) -> None:
    streams = edge_streams(panels)
    owners: list[int] = panels.corner_panels.tolist()
    is_plane: list[bool] = (panels.spheres[:, 0] == 0).tolist()
    starts: list[int] = panels.offsets.tolist()
    chosen: list[int] = corners.tolist()
    for corner in chosen:
        owner = owners[corner]
        side = f"{role} {corner - starts[owner]}"
        kind = "LineCurve" if is_plane[owner] else "ArcCurve"
        attributes = object_attributes(panels.ids[owner], side, place)
        model.add(kind, streams[corner], attributes)


def _add_centers(model: RhinoModel, panels: Panels) -> None:
    # Centres lie far away: switched off, they do not shrink the model in a view.
    place = add_layer(model, "Centres", UNLABELLED, visible=False)
    found = panel_radii(panels)
    centers, is_sphere = found.centers.tolist(), np.isfinite(found.radii).tolist()
    for name, center, has_center in zip(panels.ids, centers, is_sphere, strict=True):
        if has_center:
            point = model.library.Point(model.library.Point3d(*center))
            model.add_geometry(point, object_attributes(name, "centre", place))
