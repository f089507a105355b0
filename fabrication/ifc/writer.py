"""Writes IFC4 files of panels and beams: a curtain wall for building models."""

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from itertools import repeat
from pathlib import Path
from typing import Final, Literal, get_args

from ...kernel.beams.beams import Beams, scale_beams
from ...kernel.beams.node_cylinders import node_cylinders
from ...kernel.errors import InputError
from ...kernel.panels.panels import Panels
from ...kernel.parts.colors import BEAM_COLOR, NODE_COLOR, Color, mould_color, mould_name
from ..breps.beam_geometry import beam_geometry
from ..breps.beams import beam_batches
from ..breps.nodes import cylinder_batch
from ..breps.panel_geometry import CONFUSION, panels_in_place, rounded_origins
from ..breps.panels import panel_batches
from ..dates import file_date
from ..files import check_suffix, check_target, replacing
from ..model import Model, Written, check_model
from ..step.bodies import Body, step_bodies
from ..step.values import numbers, real, references, string
from ..units import millimeters_per
from .bodies import BodyWriter, IfcSpheres, add_triangles
from .entities import Entities
from .properties import Properties, beam_properties, panel_properties
from .triangles import Triangles, beam_triangles, cylinder_bodies, panel_triangles

IfcShapes = Literal["exact", "triangles", "both"]
IfcUnits = Literal["mm", "m"]


@dataclass(frozen=True)
class IfcOptions:
    """How an IFC file is written.

    It declares ``mm`` or ``m``; the title names the project and is part of all GlobalIds.
    Shapes are exact solids, triangles, or exact solids with triangles beside them for programs
    that have no exact solids. Spheres are polynomial patches, within a billionth of the size
    of a panel and read as they are; rational ones, exact, whose weights IfcOpenShell drops; or
    spherical surfaces, which few programs know.
    """

    units: IfcUnits = "mm"
    title: str = "Spherical panels"
    shapes: IfcShapes = "both"
    spheres: IfcSpheres = "polynomial"


_BOTH_IN_MM: Final = IfcOptions()


def write_ifc(
    model: Model, path: str | os.PathLike[str], options: IfcOptions = _BOTH_IN_MM
) -> Written:
    """Write panels and beams to an IFC4 file.

    The file is replaced when the new one is complete. It holds a project with a site, a
    building and in it a curtain wall, of a plate per panel, a member per beam and an accessory
    per node cylinder, all named by their ids; panels of one mould have one type. Plates and
    members have their measures as properties and quantities, a layer and a colour.

    Solids are those of STEP files: spheres, planes, cylinders and their curves, all exact, as
    representation ``Body``; the triangles are its ``Body-Fallback``. Panels without thickness
    are surfaces.

    Raises InputError if there is nothing to write, two parts have one name or one is not
    finite, an option is not known, or the folder does not exist.
    """
    target = Path(path)
    check_suffix(target, ".ifc")
    check_model(model, target)
    check_target(target)
    for name, value, kind in (
        ("units", options.units, IfcUnits), ("shapes", options.shapes, IfcShapes),
        ("spheres", options.spheres, IfcSpheres),
    ):  # fmt: skip
        if value not in get_args(kind):
            known = ", ".join(get_args(kind))
            raise InputError(f"{name} of an IFC file must be one of {known}, not {value!r}")
    lines = _File(model, options).lines()
    with (
        replacing(target) as temporary,
        temporary.open("w", encoding="ascii", newline="\n") as file,
    ):
        file.writelines(_header(options))
        file.writelines(lines)
        file.write("ENDSEC;\nEND-ISO-10303-21;\n")
    return Written(target)


def _header(options: IfcOptions) -> Iterator[str]:
    title, system = string(options.title), string(f"spheremesh {version('spheremesh')}")
    now = file_date().strftime("%Y-%m-%dT%H:%M:%S")
    yield "ISO-10303-21;\nHEADER;\n"
    yield "FILE_DESCRIPTION(('ViewDefinition [ReferenceView]'),'2;1');\n"
    yield f"FILE_NAME({title},'{now}',(''),(''),{system},{system},'');\n"
    yield "FILE_SCHEMA(('IFC4'));\nENDSEC;\nDATA;\n"


@dataclass(frozen=True)
class _Kind:
    """What parts of a kind are: entity of a part and of its type, their set of quantities."""

    entity: str
    type_entity: str
    predefined: str
    own_set: str
    quantity_set: str


_PLATE: Final = _Kind(
    "IFCPLATE", "IFCPLATETYPE", ".CURTAIN_PANEL.", "Spheremesh_Panel", "Qto_PlateBaseQuantities"
)
_MEMBER: Final = _Kind(
    "IFCMEMBER", "IFCMEMBERTYPE", ".MULLION.", "Spheremesh_Beam", "Qto_MemberBaseQuantities"
)
_NODE: Final = _Kind(
    "IFCDISCRETEACCESSORY", "IFCDISCRETEACCESSORYTYPE", ".USERDEFINED.", "Spheremesh_Node", ""
)


@dataclass(frozen=True)
class _Parts:
    """Parts of a kind: name, type (and layer) and colour of each, and where it stands."""

    kind: _Kind
    ids: Sequence[str]
    types: Sequence[tuple[str, Color]]
    places: Sequence[list[float]]
    bodies: Sequence[Body]
    triangles: Iterable[Triangles | None]
    properties: Iterable[Properties | None]
    is_solid: bool = True


class _File:
    """Entities of a file, those that parts share first."""

    def __init__(self, model: Model, options: IfcOptions) -> None:
        self._model, self._options = model, options
        self._entities = Entities(options.title)
        self._styles: dict[Color, int] = {}
        self._types: dict[tuple[str, str], list[int]] = {}
        self._type_kinds: dict[tuple[str, str], _Kind] = {}
        self._layers: dict[str, list[int]] = {}
        self._millimeters = millimeters_per(options.units)
        self._scale = millimeters_per(model.units) / self._millimeters

    def lines(self) -> list[str]:
        add = self._entities.add
        origin = self._entities.point((0.0, 0.0, 0.0))
        axes = add(f"IFCAXIS2PLACEMENT3D(#{origin},$,$)")
        precision = real(CONFUSION / self._millimeters)
        whole = add(f"IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,{precision},#{axes},$)")
        self._contexts = {
            name: add(
                f"IFCGEOMETRICREPRESENTATIONSUBCONTEXT('{name}','Model',*,*,*,*,#{whole},$,"
                ".MODEL_VIEW.,$)"
            )
            for name in ("Body", "Body-Fallback")
        }
        self._bodies = BodyWriter(self._entities, self._options.spheres)
        self._place = add(f"IFCLOCALPLACEMENT($,#{axes})")
        wall = self._spatial(whole)
        parts = [part for each in self._parts() for part in self._add_parts(each)]
        self._entities.assign_to("IFCRELAGGREGATES", "Curtain wall", wall, parts)
        for (kind, name), members in self._types.items():
            self._add_type(self._type_kinds[kind, name], name, members)
        for name, shapes in self._layers.items():
            add(f"IFCPRESENTATIONLAYERASSIGNMENT({string(name)},$,({references(shapes)}),$)")
        return self._entities.lines

    def _spatial(self, context: int) -> int:
        """Number of the curtain wall in its building."""
        entities, add = self._entities, self._entities.add
        prefix = ".MILLI." if self._options.units == "mm" else "$"
        units = [
            add(f"IFCSIUNIT(*,{kind},{prefix},{unit})")
            for kind, prefix, unit in (
                (".LENGTHUNIT.", prefix, ".METRE."), (".AREAUNIT.", "$", ".SQUARE_METRE."),
                (".VOLUMEUNIT.", "$", ".CUBIC_METRE."), (".PLANEANGLEUNIT.", "$", ".RADIAN."),
            )
        ]  # fmt: skip
        assigned = add(f"IFCUNITASSIGNMENT(({references(units)}))")
        title, place = self._options.title, self._place
        project = entities.rooted(
            "IFCPROJECT", title, f"$,$,$,(#{context}),#{assigned}", role="project"
        )
        site = entities.rooted("IFCSITE", "Site", f"$,#{place},$,$,.ELEMENT.,$,$,$,$,$")
        building = entities.rooted("IFCBUILDING", "Building", f"$,#{place},$,$,.ELEMENT.,$,$,$")
        wall = entities.rooted("IFCCURTAINWALL", "Curtain wall", f"$,#{place},$,$,$")
        entities.assign_to("IFCRELAGGREGATES", "Project", project, [site])
        entities.assign_to("IFCRELAGGREGATES", "Site", site, [building])
        entities.relation(
            "IFCRELCONTAINEDINSPATIALSTRUCTURE", "Building", f"(#{wall}),#{building}"
        )
        return wall

    def _parts(self) -> Iterator[_Parts]:
        panels, beams = self._model.panels, self._model.beams
        if panels is not None and panels.n_panels:
            yield self._panels(panels)
        if beams is not None and beams.n_beams:
            yield from self._support(beams)

    def _panels(self, panels: Panels) -> _Parts:
        placed = panels_in_place(panels, self._scale)
        count = int(panels.labels.max(initial=-1)) + 1
        labels = panels.labels.tolist()
        return _Parts(
            _PLATE, panels.ids,
            [(mould_name(label, count), mould_color(label, count)) for label in labels],
            placed.origins.tolist(),
            step_bodies(panel_batches(placed), CONFUSION / self._millimeters, "none"),
            self._if_wanted(panel_triangles(placed)),
            panel_properties(panels, self._scale, self._meters),
            is_solid=bool(panels.thickness > 0),
        )  # fmt: skip

    def _support(self, beams: Beams) -> Iterator[_Parts]:
        scaled, confusion = scale_beams(beams, self._scale), CONFUSION / self._millimeters
        geometry = beam_geometry(scaled, confusion)
        yield _Parts(
            _MEMBER, beams.annuli.ids, [("Beams", BEAM_COLOR)] * beams.n_beams,
            geometry.places.tolist(), step_bodies(beam_batches(geometry), confusion),
            self._if_wanted(beam_triangles(geometry)),
            beam_properties(beams, self._scale, self._meters),
        )  # fmt: skip
        nodes = node_cylinders(scaled)
        if not nodes.n_nodes:
            return
        places = rounded_origins(nodes.origins)
        numbers = nodes.origins - places, nodes.directions, nodes.heights, nodes.radius
        yield _Parts(
            _NODE, nodes.ids, [("Nodes", NODE_COLOR)] * nodes.n_nodes, places.tolist(),
            step_bodies([cylinder_batch(*numbers)], confusion),
            self._if_wanted(list(cylinder_bodies(*numbers))), repeat(None),
        )  # fmt: skip

    @property
    def _meters(self) -> float:
        return millimeters_per(self._model.units) / 1000

    def _if_wanted(self, triangles: list[Triangles]) -> Iterable[Triangles | None]:
        return repeat(None) if self._options.shapes == "exact" else triangles

    def _add_parts(self, parts: _Parts) -> Iterator[int]:
        kind, entities = parts.kind, self._entities
        for name, (type_name, color), place, body, triangles, properties in zip(
            parts.ids, parts.types, parts.places, parts.bodies, parts.triangles,
            parts.properties, strict=False,
        ):  # fmt: skip
            shapes = self._shapes(body, triangles, color, type_name, is_solid=parts.is_solid)
            point = entities.point(place)
            axes = entities.add(f"IFCAXIS2PLACEMENT3D(#{point},$,$)")
            stand = entities.add(f"IFCLOCALPLACEMENT(#{self._place},#{axes})")
            shape = entities.add(f"IFCPRODUCTDEFINITIONSHAPE($,$,({references(shapes)}))")
            quoted = string(name)
            object_type = "'Node'" if kind is _NODE else "$"
            part = entities.rooted(
                kind.entity, name,
                f"{object_type},#{stand},#{shape},{quoted},{kind.predefined}",
            )  # fmt: skip
            key = kind.type_entity, type_name
            self._types.setdefault(key, []).append(part)
            self._type_kinds[key] = kind
            if properties is not None:
                self._add_properties(kind, name, part, properties)
            yield part

    def _shapes(
        self, body: Body, triangles: Triangles | None, color: Color, layer: str, *,
        is_solid: bool,
    ) -> list[int]:  # fmt: skip
        """Numbers of the representations of a part."""
        entities, found = self._entities, list[int]()
        if self._options.shapes != "triangles":
            kind = "AdvancedBrep" if is_solid else "SurfaceModel"
            found.append(self._shape("Body", kind, self._bodies.add(body), color))
        if triangles is not None:
            name = "Body-Fallback" if found else "Body"
            item = add_triangles(
                entities, triangles.points, triangles.triangles, is_closed=is_solid
            )
            found.append(self._shape(name, "Tessellation", item, color))
        self._layers.setdefault(layer, []).extend(found)
        return found

    def _shape(self, name: str, kind: str, item: int, color: Color) -> int:
        self._entities.add(f"IFCSTYLEDITEM(#{item},(#{self._style(color)}),$)")
        context = self._contexts[name]
        return self._entities.add(
            f"IFCSHAPEREPRESENTATION(#{context},'{name}','{kind}',(#{item}))"
        )

    def _style(self, color: Color) -> int:
        if color not in self._styles:
            add = self._entities.add
            rgb = add(f"IFCCOLOURRGB($,{numbers(value / 255 for value in color)})")
            shading = add(f"IFCSURFACESTYLESHADING(#{rgb},0.)")
            self._styles[color] = add(f"IFCSURFACESTYLE($,.BOTH.,(#{shading}))")
        return self._styles[color]

    def _add_properties(
        self, kind: _Kind, name: str, part: int, properties: Properties
    ) -> None:
        entities = self._entities
        values = [
            entities.add(f"IFCPROPERTYSINGLEVALUE('{each}',$,{value},$)")
            for each, value in properties.own.items()
        ]
        amounts = [entities.add(text % each) for each, text in properties.quantities.items()]
        for entity, title, rest in (
            ("IFCPROPERTYSET", kind.own_set, f"({references(values)})"),
            ("IFCELEMENTQUANTITY", kind.quantity_set, f"$,({references(amounts)})"),
        ):
            definition = entities.rooted(entity, title, rest, role=f"{title} of {name}")
            entities.assign("IFCRELDEFINESBYPROPERTIES", f"{title} {name}", [part], definition)

    def _add_type(self, kind: _Kind, name: str, members: list[int]) -> None:
        quoted = "'Node'" if kind is _NODE else "$"
        entity = self._entities.rooted(
            kind.type_entity, name, f"$,$,$,$,{quoted},{kind.predefined}"
        )
        self._entities.assign("IFCRELDEFINESBYTYPE", f"{kind.entity} {name}", members, entity)
