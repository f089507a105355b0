"""
Panels and beams as exact CAD geometry: STEP files, and objects for CadQuery.

OpenCASCADE (the package OCP, which CadQuery brings) is imported when it is first needed.
"""

import os
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal, get_args

import numpy as np

from ..kernel.beam_checks import check_writable_beams
from ..kernel.beams import Beams
from ..kernel.colors import BEAM, Color, mould_color, mould_name
from ..kernel.congruent_panels import congruent_panels
from ..kernel.errors import InputError, MissingLibraryError
from ..kernel.panel_checks import check_writable
from ..kernel.panels import Panels, select_panels
from .files import check_suffix, replacing
from .units import millimeters_per

if TYPE_CHECKING:
    import cadquery
    from OCP.TopoDS import TopoDS_Shape

    from . import xcaf

StepSchema = Literal["AP214IS", "AP242DIS"]
StepCopies = Literal["shapes", "instances"]

STEP_UNITS: Final = {"mm": "MM", "cm": "CM", "m": "M", "in": "INCH", "ft": "FT"}
"""Units that a STEP file can declare, by OpenCASCADE's names."""


def write_step(
    panels: Panels | None,
    path: str | os.PathLike[str],
    units: str = "m",
    step_units: str = "mm",
    schema: StepSchema = "AP214IS",
    title: str = "Spherical panels",
    copies: StepCopies = "shapes",
    beams: Beams | None = None,
) -> Path:
    """
    Write panels to a STEP file as exact faces, or solids where they have a thickness.

    Parameters
    ----------
    panels : Panels or None
        The panels; at least one, unless there are beams.
    path : path
        File to write. It is replaced when the new one is complete.
    units : str
        Unit of the model: ``mm``, ``cm``, ``m``, ``in`` or ``ft``.
    step_units : str
        Unit that the file declares, of the same.
    schema : {"AP214IS", "AP242DIS"}
        Application protocol.
    title : str
        Title in the header of the file.
    copies : {"shapes", "instances"}
        ``shapes``: a shape of its own for every panel. ``instances``: identical panels (see
        `congruent_panels`) are instances of one shape, named after the first of them.
    beams : Beams, optional
        Beams to write as exact solids, with or without panels.

    Returns
    -------
    Path
        The file. It holds one assembly ``Panels`` with a component per panel, named by its id,
        on the layer and in the colour of its mould. Beams lie on the layer ``Beams``, and the
        assembly is called ``Beams``, or ``Model`` with both.

    Raises
    ------
    InputError
        If there is nothing to write, two panels have one name or one is not finite, a unit,
        schema or way of copies is not known, or the folder does not exist.
    MissingLibraryError
        If OpenCASCADE or a library of the system that it needs is missing.

    Notes
    -----
    The only geometry is spheres, planes, circles and lines, and for beams cylinders and
    ellipses. Numbers are written with 16 digits and directions with 14 decimals: an arc of
    radius R meets its corners within ``R / 10¹⁴``.
    """
    target = Path(path)
    check_suffix(target, ".step", ".stp")
    n_beams = beams.n_beams if beams else 0
    if panels is not None and (panels.n_panels or not n_beams):
        check_writable(panels, target)
    elif not n_beams:
        raise InputError(f"there are no panels or beams to write to {target}")
    if beams is not None and n_beams:
        check_writable_beams(beams, target)
    if schema not in get_args(StepSchema):
        raise InputError(f"unknown STEP schema {schema!r}: use AP214IS or AP242DIS")
    if copies not in get_args(StepCopies):
        raise InputError(f"copies must be shapes or instances, not {copies!r}")
    scale = millimeters_per(units)
    millimeters_per(step_units)
    with _opencascade():
        from . import xcaf
    with replacing(target) as temporary:
        build = _panel_parts if copies == "shapes" else _shared_parts
        groups: list[xcaf.Group] = []
        if panels is not None and panels.n_panels:
            groups.append(xcaf.Group("Panels", build(panels, scale)))
        if beams is not None and n_beams:
            groups.append(xcaf.Group("Beams", _beam_parts(beams, scale)))
        system = f"spheremesh {version('spheremesh')}"
        header = xcaf.StepHeader(schema, STEP_UNITS[step_units], title, system)
        root = groups[0] if len(groups) == 1 else xcaf.Group("Model", groups)
        xcaf.write_document(xcaf.assembly_document(root), temporary, header)
    return target


def _panel_parts(panels: Panels, scale: float) -> "list[xcaf.Part]":
    """A part per panel, where it stands."""
    from . import brep

    shapes = brep.panel_shapes(panels, scale, pcurves=False)
    return [
        _placed_part(shape, name, *mould)
        for shape, name, mould in zip(shapes, panels.ids, _moulds(panels), strict=True)
    ]


def _shared_parts(panels: Panels, scale: float) -> "list[xcaf.Part]":
    """A part per shape, wherever it stands."""
    same = congruent_panels(panels)
    is_model = np.zeros(panels.n_panels, bool)
    is_model[same.representatives] = True
    models = _panel_parts(select_panels(panels, is_model), scale)

    from . import brep, xcaf

    places = brep.copy_places(panels, same, scale)
    copies = [
        xcaf.Instance(name, place) for name, place in zip(panels.ids, places, strict=True)
    ]
    order: list[int] = np.argsort(same.labels, kind="stable").tolist()
    ends: list[int] = np.cumsum(np.bincount(same.labels)).tolist()
    return [
        replace(model, instances=tuple(copies[i] for i in order[start:end]))
        for model, start, end in zip(models, [0, *ends], ends, strict=False)
    ]


def _beam_parts(beams: Beams, scale: float) -> "list[xcaf.Part]":
    """A part per beam, where it stands."""
    from . import beam_brep

    shapes = beam_brep.beam_shapes(beams, scale, pcurves=False)
    names = beams.annuli.ids
    return [
        _placed_part(shape, name, "Beams", BEAM)
        for shape, name in zip(shapes, names, strict=True)
    ]


def _placed_part(shape: "TopoDS_Shape", name: str, layer: str, color: Color) -> "xcaf.Part":
    """A part made at its origin, and where the shape stands as its instance."""
    from OCP.TopLoc import TopLoc_Location

    from . import xcaf

    place = xcaf.Instance(name, shape.Location())
    return xcaf.Part(shape.Located(TopLoc_Location()), name, layer, color, (place,))


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

        from . import beam_brep
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

        from . import brep
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
