"""Panels, beams and nodes as assemblies of CadQuery, for further modelling."""

from collections.abc import Generator, Iterable
from contextlib import contextmanager
from typing import TYPE_CHECKING

from ...kernel.beams.beams import Beams, node_axis_segments, scale_beams
from ...kernel.beams.node_cylinders import node_cylinders
from ...kernel.errors import MissingLibraryError
from ...kernel.panels.panels import Panels
from ...kernel.parts.colors import (
    AXIS_COLOR,
    BEAM_COLOR,
    NODE_COLOR,
    Color,
    mould_color,
    mould_name,
)
from ..breps.panel_geometry import rounded_origins
from ..model import Model
from ..units import millimeters_per

if TYPE_CHECKING:
    import cadquery


def to_cadquery(model: Model) -> "cadquery.Assembly":
    """A model in any unit as a CadQuery assembly in millimetres, laid out as a STEP file.

    An assembly ``Panels``; with beams one ``Model`` of it (if there are panels) and of
    ``Beams``, ``Nodes`` of the node cylinders if there are any, and one object ``Axes`` of the
    node axes as lines. A `cadquery.Solid` (`cadquery.Face` without thickness) per part, named
    by its id and in the colour of its mould, whose layer is in its metadata.

    Raises InputError if the unit is not known, MissingLibraryError if CadQuery or a library of
    the system that it needs is missing.
    """
    scale = millimeters_per(model.units)
    with _opencascade():
        import cadquery

    panels, beams = model.panels, model.beams
    assembly = (
        _panels(panels, scale) if panels is not None else cadquery.Assembly(name="Panels")
    )
    if beams is None or not beams.n_beams:
        return assembly
    whole = cadquery.Assembly(name="Model")
    if assembly.children:
        whole.add(assembly)
    for part in _support(beams, scale):
        whole.add(part)
    return whole


def _panels(panels: Panels, scale: float) -> "cadquery.Assembly":
    import cadquery

    from .opencascade_panels import panel_shapes

    kind = cadquery.Solid if panels.thickness > 0 else cadquery.Face
    count = int(panels.labels.max(initial=-1)) + 1
    moulds = [
        (mould_name(label, count), mould_color(label, count))
        for label in panels.labels.tolist()
    ]
    shapes = [kind(shape) for shape in panel_shapes(panels, scale)]
    return _assembly("Panels", zip(shapes, panels.ids, moulds, strict=True))


def _support(beams: Beams, scale: float) -> "Iterable[cadquery.Assembly]":
    import cadquery

    from .opencascade_beams import beam_shapes

    shapes = [cadquery.Solid(shape) for shape in beam_shapes(beams, scale)]
    look = [("Beams", BEAM_COLOR)] * len(shapes)
    yield _assembly("Beams", zip(shapes, beams.annuli.ids, look, strict=True))
    scaled = scale_beams(beams, scale)
    nodes = node_cylinders(scaled)
    if nodes.n_nodes:
        places = rounded_origins(nodes.origins)
        bases = (nodes.origins - places).tolist()
        cylinders = [
            cadquery.Solid.makeCylinder(
                nodes.radius, height, cadquery.Vector(*base), cadquery.Vector(*axis)
            ).moved(cadquery.Location(cadquery.Vector(*place)))
            for height, base, axis, place in zip(
                nodes.heights.tolist(), bases, nodes.directions.tolist(), places.tolist(),
                strict=True,
            )
        ]  # fmt: skip
        look = [("Nodes", NODE_COLOR)] * len(cylinders)
        yield _assembly("Nodes", zip(cylinders, nodes.ids, look, strict=True))
    _, segments = node_axis_segments(scaled)
    place = rounded_origins(segments[:1, 0])
    lines = [
        cadquery.Edge.makeLine(cadquery.Vector(*start), cadquery.Vector(*end))
        for start, end in (segments - place).tolist()
    ]
    axes = cadquery.Compound.makeCompound(lines)
    yield cadquery.Assembly(
        axes.moved(cadquery.Location(cadquery.Vector(*place[0].tolist()))), name="Axes",
        color=_color(AXIS_COLOR), metadata={"layer": "Axes"},
    )  # fmt: skip


def _assembly(
    name: str, parts: "Iterable[tuple[cadquery.Shape, str, tuple[str, Color]]]"
) -> "cadquery.Assembly":
    """An assembly of shapes with their names, layers and colours."""
    import cadquery

    assembly = cadquery.Assembly(name=name)
    for shape, part, (layer, color) in parts:
        assembly.add(shape, name=part, color=_color(color), metadata={"layer": layer})
    return assembly


def _color(color: Color) -> "cadquery.Color":
    import cadquery

    red, green, blue = (value / 255 for value in color)
    return cadquery.Color(red, green, blue)


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
