"""Assemblies of CadQuery as STEP files, written by OpenCASCADE.

The names, layers and colours are those of the files that are written as text: one judges the
other. CadQuery's own export has no layers, and puts every solid into a compound.

This module imports OCP, which takes more than a second: others import it inside functions.
"""

from pathlib import Path

import cadquery
from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.Interface import Interface_Static
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_StepModelType
from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.TopLoc import TopLoc_Location
from OCP.XCAFApp import XCAFApp_Application
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool

from ...kernel.errors import InputError

_UNITS = {"in": "INCH"}

_DEFAULTS = {"write.step.schema": "AP214IS", "write.step.unit": "MM"}
"""Settings of OpenCASCADE, which belong to the process, as others find them."""


def write_assembly(
    assembly: cadquery.Assembly, path: Path, schema: str, units: str, title: str
) -> None:
    """Write an assembly in millimetres to a STEP file in other units."""
    document = TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
    XCAFApp_Application.GetApplication_s().InitDocument(document)
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    tool.SetAutoNaming_s(False)  # noqa: FBT003 - a parameter without a name
    _add_group(document, assembly)
    tool.UpdateAssemblies()
    writer = STEPCAFControl_Writer()
    for switch in (writer.SetColorMode, writer.SetNameMode, writer.SetLayerMode):
        switch(True)  # noqa: FBT003
    try:
        Interface_Static.SetCVal_s("write.step.schema", schema)
        Interface_Static.SetCVal_s("write.step.unit", _UNITS.get(units, units.upper()))
        writer.Transfer(document, STEPControl_StepModelType.STEPControl_AsIs)
        header = APIHeaderSection_MakeHeader(writer.ChangeWriter().Model())
        header.SetName(TCollection_HAsciiString(title))
        status = writer.Write(str(path))
    finally:
        for name, value in _DEFAULTS.items():
            Interface_Static.SetCVal_s(name, value)
    if status != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise InputError(f"OpenCASCADE cannot write {path}")


def _add_group(document: TDocStd_Document, assembly: cadquery.Assembly) -> TDF_Label:
    """Label of an assembly, whose members are its components."""
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    label = tool.NewShape()
    _name(label, assembly.name)
    for child in assembly.children:
        if child.children:
            part, place = _add_group(document, child), TopLoc_Location()
        else:
            part, place = _add_part(document, child)
        _name(tool.AddComponent(label, part, place), child.name)
    return label


def _add_part(
    document: TDocStd_Document, assembly: cadquery.Assembly
) -> tuple[TDF_Label, TopLoc_Location]:
    """Label of a shape at its own origin, with name, layer and colour; and its place."""
    main = document.Main()
    (shape,) = assembly.shapes
    place = shape.wrapped.Location()
    label = XCAFDoc_DocumentTool.ShapeTool_s(main).AddShape(
        shape.wrapped.Located(TopLoc_Location()), makeAssembly=False
    )
    _name(label, assembly.name)
    layers = XCAFDoc_DocumentTool.LayerTool_s(main)
    layers.SetLayer(label, TCollection_ExtendedString(str(assembly.metadata["layer"])))
    if assembly.color is not None:
        kind = XCAFDoc_ColorType.XCAFDoc_ColorGen
        if shape.ShapeType() != "Compound":
            kind = XCAFDoc_ColorType.XCAFDoc_ColorSurf
        XCAFDoc_DocumentTool.ColorTool_s(main).SetColor(
            label, assembly.color.wrapped.GetRGB(), kind
        )
    return label, place


def _name(label: TDF_Label, name: str) -> None:
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name, isMultiByte=True))
