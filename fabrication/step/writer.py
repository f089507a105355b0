"""
Panels and beams as exact CAD geometry: STEP files, and objects for CadQuery.

Files are written as text, without a CAD kernel. CadQuery and OpenCASCADE (the package OCP) are
imported when objects are asked for.
"""

import os
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal, get_args

import numpy as np

from ...kernel.arrays import FloatArray
from ...kernel.beams.beams import Beams, node_axis_segments, scale_beams
from ...kernel.beams.node_cylinders import node_cylinders
from ...kernel.errors import InputError, MissingLibraryError
from ...kernel.panels.congruent import congruent_panels
from ...kernel.panels.panels import Panels
from ...kernel.parts.colors import AXIS, BEAM, NODE, Color, mould_color, mould_name
from ..files import check_suffix, check_target, replacing
from ..model import Model, Written, check_model
from ..solids.beam_numbers import beam_numbers
from ..solids.panel_numbers import (
    CONFUSION,
    copy_places,
    panel_tolerances,
    panels_in_place,
    rounded_origins,
)
from ..units import millimeters_per
from .assembly import Group, Instance, Part, StepHeader, StepSchema, assembly_lines
from .beam_bodies import beam_bodies
from .bodies import line_body
from .node_bodies import cylinder_bodies
from .panel_bodies import panel_bodies

if TYPE_CHECKING:
    import cadquery

StepCopies = Literal["shapes", "instances"]


@dataclass(frozen=True)
class StepOptions:
    """
    How a STEP file is written.

    Attributes
    ----------
    units : str
        Unit that the file declares: ``mm``, ``cm``, ``m``, ``in`` or ``ft``.
    schema : {"AP214IS", "AP242DIS"}
        Application protocol.
    title : str
        Title in the header of the file.
    copies : {"shapes", "instances"}
        ``shapes``: a shape of its own for every panel. ``instances``: identical panels (see
        `congruent_panels`) are instances of one shape, named after the first of them.
    """

    units: str = "mm"
    schema: StepSchema = "AP214IS"
    title: str = "Spherical panels"
    copies: StepCopies = "shapes"


_SHAPES_IN_MM: Final = StepOptions()


def write_step(
    model: Model, path: str | os.PathLike[str], options: StepOptions = _SHAPES_IN_MM
) -> Written:
    """
    Write panels and beams to a STEP file as exact solids, or faces without thickness.

    Parameters
    ----------
    model : Model
        At least one panel or beam.
    path : path
        File to write. It is replaced when the new one is complete.
    options : StepOptions
        How.

    Returns
    -------
    Written
        The file. It holds one assembly ``Panels`` with a component per panel, named by its id,
        on the layer and in the colour of its mould. With beams, it is part of an assembly
        ``Model``, together with an assembly ``Beams``, an assembly ``Nodes`` of the node
        cylinders if beams have a node radius, and a part ``Axes`` of the node axes as lines:
        each on the layer of that name.

    Raises
    ------
    InputError
        If there is nothing to write, two panels have one name or one is not finite, a unit,
        schema or way of copies is not known, or the folder does not exist.

    Notes
    -----
    The only geometry is spheres, planes, circles and lines, and for beams cylinders and
    ellipses. Names of curves get lost in STEP, so the axes are one part of many lines; a Rhino
    file has them by name. Every number is read back as it was.

    Instances stand within 1e-6 mean edges of the panels that they stand for (`SAME_PANEL`):
    0.001 mm where edges are 1 m long.
    """
    target = Path(path)
    check_suffix(target, ".step", ".stp")
    check_model(model, target)
    check_target(target)
    panels, beams = model.panels, model.beams
    if options.schema not in get_args(StepSchema):
        raise InputError(f"unknown STEP schema {options.schema!r}: use AP214IS or AP242DIS")
    if options.copies not in get_args(StepCopies):
        raise InputError(f"copies must be shapes or instances, not {options.copies!r}")
    millimeters = millimeters_per(options.units)
    scale, confusion = millimeters_per(model.units) / millimeters, CONFUSION / millimeters
    build = _panel_parts if options.copies == "shapes" else _shared_parts
    parts = build(panels, scale, confusion) if panels is not None and panels.n_panels else []
    root = Group("Panels", parts)
    if beams is not None and beams.n_beams:
        support = _support_parts(beams, scale, confusion)
        root = Group("Model", [root, *support] if parts else support)
    system = f"spheremesh {version('spheremesh')}"
    header = StepHeader(
        options.schema, options.units, millimeters, confusion, options.title, system
    )
    lines = assembly_lines(root, header)
    with (
        replacing(target) as temporary,
        temporary.open("w", encoding="ascii", newline="\n") as file,
    ):
        file.writelines(lines)
    return Written(target)


def _panel_parts(panels: Panels, scale: float, confusion: float) -> list[Part]:
    """A part per panel, where it stands."""
    panels = panels_in_place(panels, scale)
    tolerances = _file_tolerances(panel_tolerances(panels, confusion), confusion)
    return [
        Part(body, name, *mould, tolerance, (Instance(name, tuple(place)),))
        for body, name, mould, tolerance, place in zip(
            panel_bodies(panels), panels.ids, _moulds(panels), tolerances,
            panels.origins.tolist(), strict=True,
        )
    ]  # fmt: skip


def _shared_parts(panels: Panels, scale: float, confusion: float) -> list[Part]:
    """A part per shape, wherever it stands."""
    same = congruent_panels(panels)
    parts = _panel_parts(panels, scale, confusion)
    places = copy_places(panels, same, scale).tolist()
    copies = [
        Instance(name, tuple(place)) for name, place in zip(panels.ids, places, strict=True)
    ]
    order: list[int] = np.argsort(same.labels, kind="stable").tolist()
    ends: list[int] = np.cumsum(np.bincount(same.labels)).tolist()
    models: list[int] = same.representatives.tolist()
    return [
        replace(parts[model], instances=tuple(copies[i] for i in order[start:end]))
        for model, start, end in zip(models, [0, *ends], ends, strict=False)
    ]


def _beam_parts(beams: Beams, scale: float, confusion: float) -> list[Part]:
    """A part per beam, where it stands."""
    numbers = beam_numbers(scale_beams(beams, scale), confusion)
    tolerances = _file_tolerances(numbers.tolerances, confusion)
    return [
        Part(body, name, "Beams", BEAM, tolerance, (Instance(name, tuple(place)),))
        for body, name, tolerance, place in zip(
            beam_bodies(numbers), beams.annuli.ids, tolerances, numbers.places.tolist(),
            strict=True,
        )
    ]  # fmt: skip


def _support_parts(beams: Beams, scale: float, confusion: float) -> list[Group | Part]:
    """Beams, node cylinders where they have a radius, and node axes."""
    groups: list[Group | Part] = [Group("Beams", _beam_parts(beams, scale, confusion))]
    scaled = scale_beams(beams, scale)
    found = node_cylinders(scaled)
    if found.n_nodes:
        places = rounded_origins(found.origins)
        made = cylinder_bodies(
            found.origins - places, found.directions, found.heights, found.radius
        )
        nodes = [
            Part(body, name, "Nodes", NODE, confusion, (Instance(name, tuple(place)),))
            for body, name, place in zip(made, found.ids, places.tolist(), strict=True)
        ]
        groups.append(Group("Nodes", nodes))
    _, segments = node_axis_segments(scaled)
    place = rounded_origins(segments[:1, 0])
    axes = line_body(segments - place)
    here = (Instance("Axes", tuple(place[0].tolist())),)
    return [*groups, Part(axes, "Axes", "Axes", AXIS, confusion, here)]


def _file_tolerances(tolerances: FloatArray, confusion: float) -> list[float]:
    """Tolerances rounded up to the next of few: parts that share one share its definition."""
    steps = np.ceil(np.log10(tolerances / confusion))
    return [float(f"{confusion * 10**step:.3g}") for step in steps.tolist()]


def beams_to_cadquery(beams: Beams, units: str = "m") -> "cadquery.Assembly":
    """
    Beams as a CadQuery assembly, for further modelling.

    Parameters
    ----------
    beams : Beams
        The beams.
    units : str
        Unit of the model: ``mm``, ``cm``, ``m``, ``in`` or ``ft``.

    Returns
    -------
    cadquery.Assembly
        Assembly in millimetres, with a `cadquery.Solid` per beam, named by its id.

    Raises
    ------
    InputError
        If the unit is not known.
    MissingLibraryError
        If CadQuery or a library of the system that it needs is missing.
    """
    scale = millimeters_per(units)
    with _opencascade():
        import cadquery

        from ..solids import beam_shapes as beam_brep
    assembly = cadquery.Assembly(name="Beams")
    color = cadquery.Color(*(value / 255 for value in BEAM))
    for shape, name in zip(beam_brep.beam_shapes(beams, scale), beams.annuli.ids, strict=True):
        assembly.add(cadquery.Solid(shape), name=name, color=color)
    return assembly


def to_cadquery(panels: Panels, units: str = "m") -> "cadquery.Assembly":
    """
    Panels as a CadQuery assembly, for further modelling.

    Parameters
    ----------
    panels : Panels
        The panels.
    units : str
        Unit of the model: ``mm``, ``cm``, ``m``, ``in`` or ``ft``.

    Returns
    -------
    cadquery.Assembly
        Assembly in millimetres, with a `cadquery.Solid` (`cadquery.Face` without thickness)
        per panel, named by its id and in the colour of its mould.

    Raises
    ------
    InputError
        If the unit is not known.
    MissingLibraryError
        If CadQuery or a library of the system that it needs is missing.
    """
    scale = millimeters_per(units)
    with _opencascade():
        import cadquery

        from ..solids import panel_shapes as brep
    kind = cadquery.Solid if panels.thickness > 0 else cadquery.Face
    assembly = cadquery.Assembly(name="Panels")
    for shape, name, (_, color) in zip(
        brep.panel_shapes(panels, scale), panels.ids, _moulds(panels), strict=True
    ):
        red, green, blue = (value / 255 for value in color)
        assembly.add(kind(shape), name=name, color=cadquery.Color(red, green, blue))
    return assembly


def _moulds(panels: Panels) -> list[tuple[str, Color]]:
    """Name and colour of the mould of each panel."""
    count = int(panels.labels.max(initial=-1)) + 1
    return [
        (mould_name(label, count), mould_color(label, count))
        for label in panels.labels.tolist()
    ]


@contextmanager
def _opencascade() -> Generator[None]:
    """Turn the failure to import OpenCASCADE into an error that names the remedy."""
    try:
        yield
    except ImportError as error:
        if "libGL" in str(error) or "libX" in str(error):
            remedy = (
                "install the packages libgl1 and libx11-6 (Debian, Ubuntu) or mesa-libGL and "
                "libX11 (Fedora)"
            )
        else:
            remedy = "install the package cadquery, which brings it"
        raise MissingLibraryError(f"STEP needs OpenCASCADE: {error}; {remedy}") from error
