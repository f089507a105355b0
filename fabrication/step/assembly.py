"""Named, layered and coloured bodies in a STEP file: assemblies of parts.

Definitions of units, of colours and of the kinds of products stand once in a file and are
shared by all parts. A part may stand in several places.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, Literal, NamedTuple

from ...kernel.parts.colors import Color
from ..dates import file_date
from .bodies import Body
from .values import numbers, real, references, string

StepSchema = Literal["AP214IS", "AP242DIS"]

_UNITS: Final = {
    "mm": "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))",
    "cm": "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.CENTI.,.METRE.))",
    "m": "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.))",
    "in": "INCH",
    "ft": "FOOT",
}
"""Units of length that a file can declare; the last two by their length in millimetres."""

_SCHEMAS: Final[dict[str, tuple[str, str, int, str]]] = {
    "AP214IS": (
        "AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }",
        "automotive_design", 2000,
        "core data for automotive mechanical design processes",
    ),
    "AP242DIS": (
        "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF {1 0 10303 442 1 1 4 }",
        "ap242_managed_model_based_3d_engineering", 2013,
        "Managed model based 3d engineering",
    ),
}  # fmt: skip
"""Name in the header; name, year and subject of the application protocol."""

Place = tuple[float, ...]
"""Origin, z axis and x axis, nine numbers; or the origin alone where nothing is turned."""


@dataclass(frozen=True)
class Instance:
    """The name of an instance, and where it stands in the assembly."""

    name: str
    place: Place


class Measured(NamedTuple):
    """What a reader of a solid should find, in the unit of the file."""

    volume: float
    area: float
    center: tuple[float, ...]


@dataclass(frozen=True)
class Part:
    """A body as it appears in a file, once or several times.

    The body is at its own origin. Its layer is made where it is new; the colour is sRGB, from 0
    to 255; points of the part nearer than the tolerance, in the unit of the file, are one.
    Readers may compare what it is measured with what they find.
    """

    body: Body
    name: str
    layer: str
    color: Color
    tolerance: float
    instances: tuple[Instance, ...]
    measured: Measured | None = None


@dataclass(frozen=True)
class Group:
    """An assembly of parts and of other assemblies."""

    name: str
    members: "Iterable[Part | Group]"


@dataclass(frozen=True)
class StepHeader:
    """What a STEP file says about itself.

    Its unit is ``mm``, ``cm``, ``m``, ``in`` or ``ft``, of so many millimetres; points of
    assemblies nearer than the tolerance, in that unit, are one; the system is the name and
    version of the program that wrote it.
    """

    schema: StepSchema
    unit: str
    millimeters: float
    tolerance: float
    title: str
    system: str


@dataclass(frozen=True)
class _Definition:
    """Numbers of the product definition of a part or group, its shape and representation."""

    product: int
    aspect: int
    shape: int


def assembly_lines(root: Group, header: StepHeader) -> list[str]:
    """Lines of a STEP file in ASCII, in pieces of whole lines.

    The same parts give the same text. The time in the header is that of SOURCE_DATE_EPOCH, or
    the first second of 1970.
    """
    return [*_frame(header), *_Assembler(header).lines(root), _END]


_END: Final = "ENDSEC;\nEND-ISO-10303-21;\n"


def _frame(header: StepHeader) -> Iterable[str]:
    title, system = string(header.title), string(header.system)
    date = file_date()
    stamp = date.strftime("%Y-%m-%dT%H:%M:%S")
    yield "ISO-10303-21;\nHEADER;\n"
    yield f"FILE_DESCRIPTION(({title}),'2;1');\n"
    yield f"FILE_NAME({title},'{stamp}',(''),(''),{system},{system},'');\n"
    yield f"FILE_SCHEMA(('{_SCHEMAS[header.schema][0]}'));\nENDSEC;\nDATA;\n"


class _Assembler:
    """Entities of an assembly as they are numbered; what parts share is written once."""

    def __init__(self, header: StepHeader) -> None:
        self._lines: list[str] = []
        self._count = 0
        self._products: list[int] = []
        self._styled: list[int] = []
        self._layers: dict[str, list[int]] = {}
        self._colors: dict[Color, int] = {}
        self._styles: dict[Color, int] = {}
        self._contexts: dict[float, int] = {}
        self._derived: tuple[int, int] | None = None
        _, protocol, year, subject = _SCHEMAS[header.schema]
        self._application = self._add(f"APPLICATION_CONTEXT('{subject}')")
        self._add(
            f"APPLICATION_PROTOCOL_DEFINITION('international standard','{protocol}',{year},"
            f"#{self._application})"
        )
        application = f"#{self._application}"
        self._product = self._add(f"PRODUCT_CONTEXT('',{application},'mechanical')")
        self._design = self._add(
            f"PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')"
        )
        self._axes = self._directions((0.0, 0.0, 1.0, 1.0, 0.0, 0.0))
        self._origin = self._placement((0.0, 0.0, 0.0))
        self._units = self._declare_units(header)
        self._context = self._representation_context(header.tolerance)

    def lines(self, root: Group) -> list[str]:
        self._add_group(root)
        names = references(self._products)
        self._add(f"PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,({names}))")
        for layer, items in self._layers.items():
            self._add(
                f"PRESENTATION_LAYER_ASSIGNMENT({string(layer)},'visible',"
                f"({references(items)}))"
            )
        if self._styled:
            self._add(
                "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',"
                f"({references(self._styled)}),#{self._context})"
            )
        return self._lines

    def _add(self, text: str) -> int:
        self._count += 1
        return self._write(self._count, text)

    def _write(self, number: int, text: str) -> int:
        self._lines.append(f"#{number}={text};\n")
        return number

    def _directions(self, axes: Place) -> str:
        return references(
            self._add(f"DIRECTION('',({numbers(axes[i : i + 3])}))") for i in (0, 3)
        )

    def _placement(self, place: Place) -> int:
        point = self._add(f"CARTESIAN_POINT('',({numbers(place[:3])}))")
        axes = self._directions(place[3:]) if len(place) > 3 else self._axes
        return self._add(f"AXIS2_PLACEMENT_3D('',#{point},{axes})")

    def _declare_units(self, header: StepHeader) -> tuple[int, int, int]:
        """Numbers of the units of length, angle and solid angle."""
        unit = _UNITS[header.unit]
        if not unit.startswith("("):
            millimeter = self._add(_UNITS["mm"])
            length = self._add(
                f"LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE({real(header.millimeters)}),"
                f"#{millimeter})"
            )
            dimensions = self._add("DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.)")
            unit = (
                f"(CONVERSION_BASED_UNIT('{unit}',#{length})LENGTH_UNIT()"
                f"NAMED_UNIT(#{dimensions}))"
            )
        return (
            self._add(unit),
            self._add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))"),
            self._add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())"),
        )

    def _representation_context(self, tolerance: float) -> int:
        if tolerance not in self._contexts:
            uncertainty = self._add(
                f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({real(tolerance)}),"
                f"#{self._units[0]},'distance_accuracy_value','confusion accuracy')"
            )
            self._contexts[tolerance] = self._add(
                "(GEOMETRIC_REPRESENTATION_CONTEXT(3)"
                f"GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{uncertainty}))"
                f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({references(self._units)}))"
                "REPRESENTATION_CONTEXT('Context #1',"
                "'3D Context with UNIT and UNCERTAINTY'))"
            )
        return self._contexts[tolerance]

    def _define(self, name: str) -> _Definition:
        """A product, whose shape representation is still to be written."""
        quoted = string(name)
        product = self._add(f"PRODUCT({quoted},{quoted},'',(#{self._product}))")
        self._products.append(product)
        formation = self._add(f"PRODUCT_DEFINITION_FORMATION('','',#{product})")
        definition = self._add(f"PRODUCT_DEFINITION('design','',#{formation},#{self._design})")
        shape = self._add(f"PRODUCT_DEFINITION_SHAPE('','',#{definition})")
        self._count += 1
        representation = self._count
        self._add(f"SHAPE_DEFINITION_REPRESENTATION(#{shape},#{representation})")
        return _Definition(definition, shape, representation)

    def _add_group(self, group: Group) -> _Definition:
        definition = self._define(group.name)
        items = [self._origin]
        for member in group.members:
            if isinstance(member, Group):
                here = Instance(member.name, (0.0,) * 3)
                items.append(self._place(definition, self._add_group(member), here))
            else:
                items += self._place_part(definition, member)
        self._write(
            definition.shape, f"SHAPE_REPRESENTATION('',({references(items)}),#{self._context})"
        )
        return definition

    def _place_part(self, whole: _Definition, part: Part) -> list[int]:
        """Numbers of the placements of the instances of a part.

        Many programs show the names of products alone, not those of their occurrences: where a
        shape stands in several places, each of them is an assembly, by its own name, of it.
        """
        definition = self._add_part(part)
        if len(part.instances) == 1:
            return [self._place(whole, definition, part.instances[0])]
        return [self._place_copy(whole, definition, each) for each in part.instances]

    def _place_copy(self, whole: _Definition, shape: _Definition, instance: Instance) -> int:
        copy = self._define(instance.name)
        item = self._place(copy, shape, Instance(instance.name, (0.0,) * 3))
        self._write(
            copy.shape,
            f"SHAPE_REPRESENTATION('',(#{self._origin},#{item}),#{self._context})",
        )
        return self._place(whole, copy, instance)

    def _add_part(self, part: Part) -> _Definition:
        definition = self._define(part.name)
        layout, first = part.body.layout, self._count + 1
        self._count += layout.n_entities
        self._lines.append(part.body.text(first))
        context = self._representation_context(part.tolerance)
        self._write(
            definition.shape,
            f"{layout.representation}('',(#{self._origin},#{first}),#{context})",
        )
        is_line = layout.representation.startswith("GEOMETRICALLY_BOUNDED_WIREFRAME")
        style = self._line_style(part.color) if is_line else self._surface_style(part.color)
        self._styled.append(self._add(f"STYLED_ITEM('color',(#{style}),#{first})"))
        self._layers.setdefault(part.layer, []).append(first)
        if part.measured is not None:
            self._validate(definition.aspect, context, part.measured)
        return definition

    def _validate(self, aspect: int, context: int, measured: Measured) -> None:
        """Geometric validation properties, as the CAx Implementor Forum recommends them."""
        area, volume = self._measures()
        center = ",".join(map(_shortened, measured.center))
        items = {
            "volume": "MEASURE_REPRESENTATION_ITEM('volume measure',"
            f"VOLUME_MEASURE({_shortened(measured.volume)}),#{volume})",
            "surface area": "MEASURE_REPRESENTATION_ITEM('surface area measure',"
            f"AREA_MEASURE({_shortened(measured.area)}),#{area})",
            "centroid": f"CARTESIAN_POINT('centre point',({center}))",
        }
        for name, text in items.items():
            stated = self._add(
                f"PROPERTY_DEFINITION('geometric validation property','{name}',#{aspect})"
            )
            item = self._add(text)
            found = self._add(f"REPRESENTATION('{name}',(#{item}),#{context})")
            self._add(f"PROPERTY_DEFINITION_REPRESENTATION(#{stated},#{found})")

    def _measures(self) -> tuple[int, int]:
        """Numbers of the units of area and volume."""
        if self._derived is None:
            elements = [
                self._add(f"DERIVED_UNIT_ELEMENT(#{self._units[0]},{power})")
                for power in ("2.", "3.")
            ]
            area, volume = (self._add(f"DERIVED_UNIT((#{element}))") for element in elements)
            self._derived = area, volume
        return self._derived

    def _color(self, color: Color) -> int:
        if color not in self._colors:
            shares = numbers(value / 255 for value in color)
            self._colors[color] = self._add(f"COLOUR_RGB('',{shares})")
        return self._colors[color]

    def _line_style(self, color: Color) -> int:
        font = self._add("DRAUGHTING_PRE_DEFINED_CURVE_FONT('continuous')")
        width = "POSITIVE_LENGTH_MEASURE(0.1)"
        style = self._add(f"CURVE_STYLE('',#{font},{width},#{self._color(color)})")
        return self._add(f"PRESENTATION_STYLE_ASSIGNMENT((#{style}))")

    def _surface_style(self, color: Color) -> int:
        if color not in self._styles:
            entity = self._color(color)
            for form in (
                "FILL_AREA_STYLE_COLOUR('',{})", "FILL_AREA_STYLE('',({}))",
                "SURFACE_STYLE_FILL_AREA({})", "SURFACE_SIDE_STYLE('',({}))",
                "SURFACE_STYLE_USAGE(.BOTH.,{})", "PRESENTATION_STYLE_ASSIGNMENT(({}))",
            ):  # fmt: skip
                entity = self._add(form.format(f"#{entity}"))
            self._styles[color] = entity
        return self._styles[color]

    def _place(self, whole: _Definition, part: _Definition, instance: Instance) -> int:
        """Number of the placement in the assembly."""
        name, placement = string(instance.name), self._placement(instance.place)
        motion = self._add(f"ITEM_DEFINED_TRANSFORMATION('','',#{self._origin},#{placement})")
        relation = self._add(
            f"(REPRESENTATION_RELATIONSHIP('','',#{part.shape},#{whole.shape})"
            f"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{motion})"
            "SHAPE_REPRESENTATION_RELATIONSHIP())"
        )
        usage = self._add(
            f"NEXT_ASSEMBLY_USAGE_OCCURRENCE({name},{name},'',#{whole.product},"
            f"#{part.product},$)"
        )
        shape = self._add(
            f"PRODUCT_DEFINITION_SHAPE('Placement','Placement of an item',#{usage})"
        )
        self._add(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{relation},#{shape})")
        return placement


def _shortened(number: float) -> str:
    """Twelve digits: what is measured has no more."""
    return real(float(f"{number:.12g}"))
