"""Writes STEP files of panels and beams: exact solids and faces, without a CAD kernel."""

import os
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Final, Literal, get_args

import numpy as np

from ...kernel.arrays import FloatArray
from ...kernel.beams.beams import Beams, node_axis_segments, scale_beams
from ...kernel.beams.node_cylinders import node_cylinders
from ...kernel.errors import InputError
from ...kernel.panels.congruent import congruent_panels
from ...kernel.panels.panels import Panels
from ...kernel.parts.colors import (
    AXIS_COLOR,
    BEAM_COLOR,
    NODE_COLOR,
    Color,
    mould_color,
    mould_name,
)
from ..breps.beam_geometry import beam_geometry
from ..breps.beams import beam_batches
from ..breps.measures import brep_measures
from ..breps.nodes import cylinder_batch
from ..breps.panel_geometry import (
    CONFUSION,
    copy_places,
    panel_tolerances,
    panels_in_place,
    rounded_origins,
)
from ..breps.panels import panel_batches
from ..breps.records import BrepBatch
from ..files import check_suffix, check_target, replacing
from ..model import Model, Written, check_model
from ..solids.cadquery_assembly import to_cadquery
from ..units import millimeters_per
from .assembly import Group, Instance, Measured, Part, StepHeader, StepSchema, assembly_lines
from .bodies import line_body, step_bodies
from .parameter_curves import ParameterCurves

StepCopies = Literal["shapes", "instances"]
StepEngine = Literal["text", "cadquery"]


@dataclass(frozen=True)
class StepOptions:
    """How a STEP file is written.

    It declares the units ``mm``, ``cm``, ``m``, ``in`` or ``ft``; the title is in its header.
    Copies are ``shapes``, a shape of its own for every panel, or ``instances``: identical
    panels (see `congruent_panels`) are instances of one shape, named after the first of them.
    Arcs get curves in the parameters of their spheres where readers need them, all of them or
    none. The engine is our own text, or OpenCASCADE by an assembly of CadQuery, ten times as
    slow: shapes alone, with all curves. With validation every solid states its volume, area
    and centre, for readers to compare; the file is a tenth larger.
    """

    units: str = "mm"
    schema: StepSchema = "AP214IS"
    title: str = "Spherical panels"
    copies: StepCopies = "shapes"
    parameter_curves: ParameterCurves = "needed"
    engine: StepEngine = "text"
    validation: bool = False


_SHAPES_IN_MM: Final = StepOptions()


def write_step(
    model: Model, path: str | os.PathLike[str], options: StepOptions = _SHAPES_IN_MM
) -> Written:
    """Write panels and beams to a STEP file as exact solids, or faces without thickness.

    The file is replaced when the new one is complete. It holds one assembly ``Panels`` with a
    component per panel, named by its id, on the layer and in the colour of its mould. With
    beams, it is part of an assembly ``Model``, together with an assembly ``Beams``, an assembly
    ``Nodes`` of the node cylinders if beams have a node radius, and a part ``Axes`` of the node
    axes as lines: each on the layer of that name.

    The only geometry is spheres, planes, circles and lines, and for beams cylinders and
    ellipses. Names of curves get lost in STEP, so the axes are one part of many lines; a Rhino
    file has them by name. Numbers are read back within 1e-12 of the size of their part and
    1e-9 mm. Instances stand within 1e-6 mean edges of the panels that they stand for
    (`SAME_PANEL`): 0.001 mm where edges are 1 m long.

    Raises InputError if there is nothing to write, two panels have one name or one is not
    finite, an option is not known, or the folder does not exist; MissingLibraryError if the
    engine cadquery is asked for and missing.
    """
    target = Path(path)
    check_suffix(target, ".step", ".stp")
    check_model(model, target)
    check_target(target)
    _check_options(options)
    if options.engine == "cadquery":
        assembly = to_cadquery(model)
        from .opencascade_writer import write_assembly

        with replacing(target) as temporary:
            write_assembly(assembly, temporary, options.schema, options.units, options.title)
        return Written(target)
    lines = assembly_lines(_root(model, options), _header(options))
    with (
        replacing(target) as temporary,
        temporary.open("w", encoding="ascii", newline="\n") as file,
    ):
        file.writelines(lines)
    return Written(target)


def _check_options(options: StepOptions) -> None:
    for name, value, kind in (
        ("schema", options.schema, StepSchema), ("copies", options.copies, StepCopies),
        ("parameter_curves", options.parameter_curves, ParameterCurves),
        ("engine", options.engine, StepEngine),
    ):  # fmt: skip
        allowed = get_args(kind)
        if value not in allowed:
            known = f"{', '.join(allowed[:-1])} or {allowed[-1]}"
            raise InputError(f"{name} of a STEP file must be {known}, not {value!r}")
    if options.engine == "cadquery" and options.copies != "shapes":
        raise InputError(
            "the engine cadquery writes shapes alone: instances need the engine text"
        )
    if options.engine == "cadquery" and options.validation:
        raise InputError("the engine cadquery states no measures: they need the engine text")


def _header(options: StepOptions) -> StepHeader:
    millimeters = millimeters_per(options.units)
    system = f"spheremesh {version('spheremesh')}"
    confusion = CONFUSION / millimeters
    return StepHeader(
        options.schema, options.units, millimeters, confusion, options.title, system
    )


def _root(model: Model, options: StepOptions) -> Group:
    """Panels, and with beams the assembly of both."""
    millimeters = millimeters_per(options.units)
    scale, confusion = millimeters_per(model.units) / millimeters, CONFUSION / millimeters
    panels, beams = model.panels, model.beams
    build = _panel_parts if options.copies == "shapes" else _shared_parts
    parts: list[Part] = []
    if panels is not None and panels.n_panels:
        parts = build(panels, scale, confusion, options)
    root = Group("Panels", parts)
    if beams is None or not beams.n_beams:
        return root
    support = _support_parts(beams, scale, confusion, options)
    return Group("Model", [root, *support] if parts else support)


def _panel_parts(
    panels: Panels, scale: float, confusion: float, options: StepOptions
) -> list[Part]:
    """A part per panel, where it stands."""
    panels = panels_in_place(panels, scale)
    tolerances = _file_tolerances(panel_tolerances(panels, confusion), confusion)
    batches = panel_batches(panels)
    return [
        Part(body, name, layer, color, tolerance, (Instance(name, tuple(place)),), measured)
        for body, name, (layer, color), tolerance, place, measured in zip(
            step_bodies(batches, confusion, options.parameter_curves), panels.ids,
            _moulds(panels), tolerances, panels.origins.tolist(),
            _measured(batches, options), strict=True,
        )
    ]  # fmt: skip


def _shared_parts(
    panels: Panels, scale: float, confusion: float, options: StepOptions
) -> list[Part]:
    """A part per shape, wherever it stands."""
    same = congruent_panels(panels)
    parts = _panel_parts(panels, scale, confusion, options)
    places = copy_places(panels, same, scale).tolist()
    copies = [
        Instance(name, tuple(place)) for name, place in zip(panels.ids, places, strict=True)
    ]
    order: list[int] = np.argsort(same.labels, kind="stable").tolist()
    ends: list[int] = np.cumsum(np.bincount(same.labels)).tolist()
    models: list[int] = same.representatives.tolist()
    return [
        _shared(parts[model], [copies[i] for i in order[start:end]])
        for model, start, end in zip(models, [0, *ends], ends, strict=False)
    ]


def _measured(batches: list[BrepBatch], options: StepOptions) -> list[Measured] | list[None]:
    """What each solid states of itself, if it shall."""
    if not (options.validation and batches and batches[0].is_solid):
        return [None] * sum(len(batch.rows) for batch in batches)
    found = brep_measures(batches)
    return [
        Measured(volume, area, tuple(center))
        for volume, area, center in zip(
            found.volumes.tolist(), found.areas.tolist(), found.centers.tolist(), strict=True
        )
    ]


def _beam_parts(
    beams: Beams, scale: float, confusion: float, options: StepOptions
) -> list[Part]:
    """A part per beam, where it stands."""
    numbers = beam_geometry(scale_beams(beams, scale), confusion)
    tolerances = _file_tolerances(numbers.tolerances, confusion)
    batches = beam_batches(numbers)
    return [
        Part(
            body, name, "Beams", BEAM_COLOR, tolerance, (Instance(name, tuple(place)),), stated
        )
        for body, name, tolerance, place, stated in zip(
            step_bodies(batches, confusion), beams.annuli.ids, tolerances,
            numbers.places.tolist(), _measured(batches, options), strict=True,
        )
    ]  # fmt: skip


def _support_parts(
    beams: Beams, scale: float, confusion: float, options: StepOptions
) -> list[Group | Part]:
    """Beams, node cylinders where they have a radius, and node axes."""
    groups: list[Group | Part] = [Group("Beams", _beam_parts(beams, scale, confusion, options))]
    scaled = scale_beams(beams, scale)
    found = node_cylinders(scaled)
    if found.n_nodes:
        places = rounded_origins(found.origins)
        made = cylinder_batch(
            found.origins - places, found.directions, found.heights, found.radius
        )
        nodes = [
            Part(
                body,
                name,
                "Nodes",
                NODE_COLOR,
                confusion,
                (Instance(name, tuple(place)),),
                stated,
            )
            for body, name, place, stated in zip(
                step_bodies([made], confusion),
                found.ids,
                places.tolist(),
                _measured([made], options),
                strict=True,
            )
        ]
        groups.append(Group("Nodes", nodes))
    _, segments = node_axis_segments(scaled)
    place = rounded_origins(segments[:1, 0])
    axes = line_body(segments - place)
    here = (Instance("Axes", tuple(place[0].tolist())),)
    return [*groups, Part(axes, "Axes", "Axes", AXIS_COLOR, confusion, here)]


def _file_tolerances(tolerances: FloatArray, confusion: float) -> list[float]:
    """Tolerances rounded up to the next of few: parts that share one share its definition."""
    steps = np.ceil(np.log10(tolerances / confusion))
    return [float(f"{confusion * 10**step:.3g}") for step in steps.tolist()]


def _moulds(panels: Panels) -> list[tuple[str, Color]]:
    """Name and colour of the mould of each panel."""
    count = int(panels.labels.max(initial=-1)) + 1
    return [
        (mould_name(label, count), mould_color(label, count))
        for label in panels.labels.tolist()
    ]


def _shared(part: Part, copies: list[Instance]) -> Part:
    """A part in several places: its name is free for the first of them."""
    name = part.name if len(copies) == 1 else f"Shape of {part.name}"
    return replace(part, name=name, instances=tuple(copies))
