"""
Named, layered and coloured shapes in a STEP file, through OpenCASCADE's XCAF documents.

This module imports OCP, which takes more than a second: others import it inside functions.
"""

import io
import re
from collections.abc import Generator, Iterable
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
from OCP.BRep import BRep_Builder
from OCP.Interface import Interface_Static
from OCP.Message import Message
from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
from OCP.StepAP214 import StepAP214
from OCP.STEPCAFControl import STEPCAFControl_Controller, STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_StepModelType
from OCP.StepData import StepData_StepModel, StepData_StepWriter
from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape, TopoDS_Shell
from OCP.XCAFApp import XCAFApp_Application
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool

from ..kernel.colors import Color


@dataclass(frozen=True)
class Instance:
    """
    Where a part stands.

    Attributes
    ----------
    name : str
        Name of the instance.
    place : TopLoc_Location
        Its place in the assembly.
    """

    name: str
    place: TopLoc_Location


@dataclass(frozen=True)
class Part:
    """
    A shape as it appears in a file, once or several times.

    Attributes
    ----------
    shape : TopoDS_Shape
        Shape in millimetres, at its own origin.
    name : str
        Name of the part.
    layer : str
        Layer, made where it is new.
    color : Color
        Red, green and blue from 0 to 255 (sRGB).
    instances : tuple of Instance
        Where it stands.
    """

    shape: TopoDS_Shape
    name: str
    layer: str
    color: Color
    instances: tuple[Instance, ...]


@dataclass(frozen=True)
class Group:
    """
    An assembly.

    Attributes
    ----------
    name : str
        Name of the assembly.
    members : iterable of Part and Group
        What it consists of.
    """

    name: str
    members: "Iterable[Part | Group]"


@dataclass(frozen=True)
class StepHeader:
    """
    What a STEP file says about itself.

    Attributes
    ----------
    schema : str
        ``AP214IS`` or ``AP242DIS``.
    unit : str
        Unit of length by OpenCASCADE's name, such as ``MM``.
    title : str
        Title of the file.
    system : str
        Name and version of the program that wrote it.
    """

    schema: str
    unit: str
    title: str
    system: str


def assembly_document(root: Group) -> TDocStd_Document:
    """
    A document of one assembly.

    Parameters
    ----------
    root : Group
        Parts, and assemblies within.

    Returns
    -------
    TDocStd_Document
        The document. Layers and colours belong to the definitions: on components the STEP
        writer would drop layers without a word.
    """
    document = TDocStd_Document(_text("BinXCAF"))
    XCAFApp_Application.GetApplication_s().InitDocument(document)
    assembler = _Assembler(document)
    assembler.add_group(root)
    assembler.shapes.UpdateAssemblies()
    return document


class _Assembler:
    """Adds parts to a document; layers and colours once each."""

    def __init__(self, document: TDocStd_Document) -> None:
        self.shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
        self._colors = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
        self._layers = XCAFDoc_DocumentTool.LayerTool_s(document.Main())
        self._layer_labels: dict[str, TDF_Label] = {}
        self._color_labels: dict[Color, TDF_Label] = {}

    def add_group(self, group: Group) -> TDF_Label:
        assembly = self.shapes.NewShape()
        TDataStd_Name.Set_s(assembly, _text(group.name))
        for member in group.members:
            if isinstance(member, Group):
                self._place(assembly, self.add_group(member), member.name, TopLoc_Location())
                continue
            definition = self._add_part(member)
            for instance in member.instances:
                self._place(assembly, definition, instance.name, instance.place)
        return assembly

    def _add_part(self, part: Part) -> TDF_Label:
        if part.layer not in self._layer_labels:
            self._layer_labels[part.layer] = self._layers.AddLayer(_text(part.layer))
        if part.color not in self._color_labels:
            self._color_labels[part.color] = self._colors.AddColor(_color(part.color))
        definition = self.shapes.AddShape(_definition(part.shape), makeAssembly=False)
        TDataStd_Name.Set_s(definition, _text(part.name))
        self._layers.SetLayer(definition, self._layer_labels[part.layer])
        self._colors.SetColor(
            definition, self._color_labels[part.color], _color_type(part.shape)
        )
        return definition

    def _place(
        self, assembly: TDF_Label, definition: TDF_Label, name: str, place: TopLoc_Location
    ) -> None:
        component = self.shapes.AddComponent(assembly, definition, place)
        TDataStd_Name.Set_s(component, _text(name))


def _color_type(shape: TopoDS_Shape) -> XCAFDoc_ColorType:
    """Of faces; or of curves, where a shape has no faces."""
    has_faces = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_FACE).More()
    kinds = XCAFDoc_ColorType
    return kinds.XCAFDoc_ColorSurf if has_faces else kinds.XCAFDoc_ColorCurv


def _definition(shape: TopoDS_Shape) -> TopoDS_Shape:
    """The shape; a face as a shell, or layer and colour would miss the part."""
    if shape.ShapeType() != TopAbs_ShapeEnum.TopAbs_FACE:
        return shape
    shell, builder = TopoDS_Shell(), BRep_Builder()
    builder.MakeShell(shell)
    builder.Add(shell, shape)
    return shell


def write_document(document: TDocStd_Document, path: Path, header: StepHeader) -> None:
    """
    Write a document to a STEP file.

    Parameters
    ----------
    document : TDocStd_Document
        The document.
    path : Path
        File to write.
    header : StepHeader
        Schema, unit and names.

    Raises
    ------
    OSError
        If the file cannot be written, or OpenCASCADE cannot translate the shapes.

    Notes
    -----
    Curves in the parameters of surfaces are left out: they are not needed where the geometry is
    elementary, and take two thirds of a file. OpenCASCADE's settings are global; they are set
    for the call and put back.
    """
    settings = {
        "write.step.schema": header.schema,
        "write.step.unit": header.unit,
        "write.surfacecurve.mode": "0",
        "xstep.cascade.unit": "MM",
    }
    STEPCAFControl_Controller.Init_s()  # registers the settings
    with _quiet(), _settings(settings):
        writer = STEPCAFControl_Writer()
        # One overload takes a type that OCP does not bind, and pyright cannot see.
        transfer = writer.Transfer  # pyright: ignore[reportUnknownMemberType, reportUnknownVariableType]
        if not transfer(document, STEPControl_StepModelType.STEPControl_AsIs):
            raise OSError(f"OpenCASCADE could not translate the shapes for {path}")
        model = writer.ChangeWriter().Model(newone=False)
        _fill_header(model, header)
        path.write_bytes(_part21(model))


_INSTANCE: Final = re.compile(rb"(NEXT_ASSEMBLY_USAGE_OCCURRENCE\(')\d+',\s*'((?:[^']|'')*)'")
"""Identifier and name of an instance: OpenCASCADE numbers them on and on within a process."""

_BEYOND_ASCII: Final = re.compile(rb"[\x80-\xff]+")
"""Names in UTF-8, as OpenCASCADE writes them, which a file of this edition must not hold."""


def _part21(model: StepData_StepModel) -> bytes:
    """
    Text of a STEP file with all digits.

    OpenCASCADE's own format has 12 decimals in a direction: arcs of more than 100 m radius miss
    their corners by more than its tolerance, and a valid solid is read back as an invalid one.
    Its way to drop zeros cuts longer numbers short; here the usual ones go by replacement.
    Instances are identified by their names, so that equal parts give equal text.
    """
    writer = StepData_StepWriter(model)
    numbers = writer.FloatWriter()
    numbers.SetFormat("%.15E")
    numbers.SetZeroSuppress(False)  # noqa: FBT003
    numbers.SetFormatForRange("%.14f", 0.0, 1000.0)
    writer.SendModel(StepAP214.Protocol_s())
    stream = io.BytesIO()
    writer.Print(stream)
    header, separator, data = stream.getvalue().partition(b"DATA;")
    for number in (b"0.", b"1."):
        for end in (b",", b")"):
            data = data.replace(number + 14 * b"0" + end, number + end)
    data = _INSTANCE.sub(rb"\1\2','\2'", data)
    if not data.isascii():
        data = _BEYOND_ASCII.sub(lambda run: _directives(run[0].decode()).encode(), data)
    return header + separator + data.replace(b" = ", b"=")


def _fill_header(model: StepData_StepModel, header: StepHeader) -> None:
    section = APIHeaderSection_MakeHeader(model)
    section.SetName(_ascii(header.title))
    section.SetDescriptionValue(1, _ascii(header.title))
    section.SetAuthorValue(1, _ascii(""))
    section.SetOrganizationValue(1, _ascii(""))
    section.SetOriginatingSystem(_ascii(header.system))
    section.SetAuthorisation(_ascii(""))


@contextmanager
def _settings(values: dict[str, str]) -> Generator[None]:
    before = {name: Interface_Static.CVal_s(name) for name in values}
    try:
        _set(values)
        yield
    finally:
        _set(before)


def _set(values: dict[str, str]) -> None:
    for name, value in values.items():
        if not Interface_Static.SetCVal_s(name, value):
            raise ValueError(f"OpenCASCADE does not know {name} = {value}")


@contextmanager
def _quiet() -> Generator[None]:
    """Keep OpenCASCADE from printing statistics on standard output."""
    messenger = Message.DefaultMessenger_s()
    printers = list(messenger.Printers())
    for printer in printers:
        messenger.RemovePrinter(printer)
    try:
        yield
    finally:
        for printer in printers:
            messenger.AddPrinter(printer)


def _text(text: str) -> TCollection_ExtendedString:
    return TCollection_ExtendedString(text, isMultiByte=True)


def _ascii(text: str) -> TCollection_HAsciiString:
    """Text of a STEP header."""
    return TCollection_HAsciiString(_directives(text.replace("\\", "\\\\")))


def _directives(text: str) -> str:
    """Text with the characters beyond ASCII as the directives of ISO 10303-21."""
    return "".join(
        character if character.isascii() else f"\\X4\\{ord(character):08X}\\X0\\"
        for character in text
    )


def _color(color: Color) -> Quantity_Color:
    red, green, blue = (value / 255 for value in color)
    return Quantity_Color(red, green, blue, Quantity_TypeOfColor.Quantity_TOC_sRGB)
