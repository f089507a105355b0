"""Panels and beams as assemblies of CadQuery, for further modelling."""

from collections.abc import Generator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from ...kernel.beams.beams import Beams
from ...kernel.errors import MissingLibraryError
from ...kernel.panels.panels import Panels
from ...kernel.parts.colors import BEAM_COLOR, Color, mould_color
from ..units import millimeters_per

if TYPE_CHECKING:
    import cadquery


def beams_to_cadquery(beams: Beams, units: str = "m") -> "cadquery.Assembly":
    """Beams in any unit as a CadQuery assembly in millimetres: solids named by their ids.

    Raises InputError if the unit is not known, MissingLibraryError if CadQuery or a library of
    the system that it needs is missing.
    """
    scale = millimeters_per(units)
    with _opencascade():
        import cadquery

        from .opencascade_beams import beam_shapes
    assembly = cadquery.Assembly(name="Beams")
    for shape, name in zip(beam_shapes(beams, scale), beams.annuli.ids, strict=True):
        _add(assembly, cadquery.Solid(shape), name, BEAM_COLOR)
    return assembly


def to_cadquery(panels: Panels, units: str = "m") -> "cadquery.Assembly":
    """Panels in any unit as a CadQuery assembly in millimetres.

    A `cadquery.Solid` (`cadquery.Face` without thickness) per panel, named by its id and in the
    colour of its mould. Raises as `beams_to_cadquery`.
    """
    scale = millimeters_per(units)
    with _opencascade():
        import cadquery

        from .opencascade_panels import panel_shapes
    kind = cadquery.Solid if panels.thickness > 0 else cadquery.Face
    assembly = cadquery.Assembly(name="Panels")
    count = int(panels.labels.max(initial=-1)) + 1
    for shape, name, label in zip(
        panel_shapes(panels, scale), panels.ids, panels.labels.tolist(), strict=True
    ):
        _add(assembly, kind(shape), name, mould_color(label, count))
    return assembly


def _add(
    assembly: "cadquery.Assembly", shape: "cadquery.Shape", name: str, color: Color
) -> None:
    import cadquery

    red, green, blue = (value / 255 for value in color)
    assembly.add(shape, name=name, color=cadquery.Color(red, green, blue))


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
        raise MissingLibraryError(f"CadQuery needs OpenCASCADE: {error}; {remedy}") from error
