"""
Panels and beams as exact CAD geometry: STEP files, and objects for CadQuery.

OpenCASCADE (the package OCP, which CadQuery brings) is imported when it is first needed.
"""

import os
from collections.abc import Generator
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

from ..kernel.beams import Beams
from ..kernel.colors import BEAM, Color, mould_color, mould_name
from ..kernel.errors import InputError, MissingLibraryError
from ..kernel.panels import Panels
from .files import check_suffix, replacing
from .units import millimeters_per

if TYPE_CHECKING:
    import cadquery

    from . import xcaf

StepSchema = Literal["AP214IS", "AP242DIS"]

STEP_UNITS: Final = {"mm": "MM", "cm": "CM", "m": "M", "in": "INCH", "ft": "FT"}
"""Units that a STEP file can declare, by OpenCASCADE's names."""


def write_step(
    panels: Panels | None,
    path: str | os.PathLike[str],
    units: str = "m",
    step_units: str = "mm",
    schema: StepSchema = "AP214IS",
    title: str = "Spherical panels",
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
        If there is nothing to write, a unit or schema is not known, or the folder does not
        exist.
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
    n_panels, n_beams = panels.n_panels if panels else 0, beams.n_beams if beams else 0
    if n_panels + n_beams == 0:
        raise InputError(f"there are no panels or beams to write to {target}")
    if schema not in ("AP214IS", "AP242DIS"):
        raise InputError(f"unknown STEP schema {schema!r}: use AP214IS or AP242DIS")
    scale = millimeters_per(units)
    millimeters_per(step_units)
    with _opencascade():
        from . import xcaf
    with replacing(target) as temporary:
        parts = [*_panel_parts(panels, scale), *_beam_parts(beams, scale)]
        name = "Model" if n_panels and n_beams else "Panels" if n_panels else "Beams"
        system = f"spheremesh {version('spheremesh')}"
        header = xcaf.StepHeader(schema, STEP_UNITS[step_units], title, system)
        xcaf.write_document(xcaf.assembly_document(name, parts), temporary, header)
    return target


def _panel_parts(panels: Panels | None, scale: float) -> "list[xcaf.Part]":
    if panels is None:
        return []
    from . import brep, xcaf

    shapes = brep.panel_shapes(panels, scale, pcurves=False)
    return [
        xcaf.Part(shape, name, layer, color)
        for shape, name, (layer, color) in zip(shapes, panels.ids, _moulds(panels), strict=True)
    ]


def _beam_parts(beams: Beams | None, scale: float) -> "list[xcaf.Part]":
    if beams is None:
        return []
    from . import beam_brep, xcaf

    shapes = beam_brep.beam_shapes(beams, scale, pcurves=False)
    return [
        xcaf.Part(shape, name, "Beams", BEAM)
        for shape, name in zip(shapes, beams.annuli.ids, strict=True)
    ]


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


def panels_to_cadquery(panels: Panels, units: str = "m") -> "cadquery.Assembly":
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
