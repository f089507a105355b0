"""Volume, area and centre that solids state of themselves, against those OpenCASCADE finds."""

from pathlib import Path

import numpy as np
import pytest
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDF import TDF_AttributeIterator, TDF_Label, TDF_LabelSequence
from OCP.TDocStd import TDocStd_Document
from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool

from spheremesh.fabrication.breps.measures import brep_measures
from spheremesh.fabrication.breps.nodes import cylinder_batch
from spheremesh.fabrication.model import Model
from spheremesh.fabrication.step.check import check_part21
from spheremesh.fabrication.step.writer import StepOptions, write_step
from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import torus_net


def model() -> Model:
    torus = central_spheres(torus_net(6, 4, 3.0, 1.0))
    panels, _ = cut_panels(torus, thickness=0.02)
    beams, _ = cut_beams(
        annulus_support(torus, 0.2).annuli, 0.02, node_gap=0.01, node_radius=0.05
    )
    return Model(
        *(select_parts(each, np.arange(len(each.ids)) % 9 == 0) for each in (panels, beams))
    )


def stated(label: TDF_Label) -> list[float]:
    """Volume, area and centre that a reader attaches to a shape; empty if it has none."""
    found: dict[str, list[float]] = {}
    attributes = TDF_AttributeIterator(label)
    while attributes.More():
        each = attributes.Value()
        kind = each.DynamicType().Name()
        if kind in {"XCAFDoc_Volume", "XCAFDoc_Area"}:
            found[kind] = [each.Get()]  # pyright: ignore
        elif kind == "XCAFDoc_Centroid":
            point = each.Get()  # pyright: ignore
            found[kind] = [point.X(), point.Y(), point.Z()]
        attributes.Next()
    order = ("XCAFDoc_Volume", "XCAFDoc_Area", "XCAFDoc_Centroid")
    return [value for kind in order for value in found.get(kind, [])]


def measured(label: TDF_Label) -> list[float]:
    """The same of the shape itself."""
    shape = XCAFDoc_ShapeTool.GetShape_s(label)
    solid, faces = GProp_GProps(), GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, solid, 1e-9)
    BRepGProp.SurfaceProperties_s(shape, faces, 1e-9)
    center = solid.CentreOfMass()
    return [solid.Mass(), faces.Mass(), center.X(), center.Y(), center.Z()]


@pytest.mark.parametrize("unit", ["mm", "m"])
def test_law_solids_state_what_a_reader_measures(tmp_path: Path, unit: str) -> None:
    options = StepOptions(unit, validation=True)
    path = write_step(model(), tmp_path / "m.step", options).path
    assert check_part21(path) == ()
    reader = STEPCAFControl_Reader()
    reader.SetPropsMode(True)  # noqa: FBT003
    reader.ReadFile(str(path))
    document, labels = TDocStd_Document(TCollection_ExtendedString("XCAF")), TDF_LabelSequence()
    reader.Transfer(document)
    XCAFDoc_DocumentTool.ShapeTool_s(document.Main()).GetShapes(labels)
    rows = [labels.Value(i) for i in range(1, labels.Length() + 1)]
    pairs = [(stated(label), measured(label)) for label in rows if stated(label)]
    nodes = path.read_text("ascii").count("=PRODUCT('N") - 1
    both = model()
    assert both.panels is not None
    assert both.beams is not None
    assert len(pairs) == len(both.panels.ids) + len(both.beams.ids) + nodes
    said, found = np.array(pairs).transpose(1, 0, 2)
    np.testing.assert_allclose(said[:, :2], found[:, :2], rtol=1e-7)
    np.testing.assert_allclose(said[:, 2:], found[:, 2:], atol=1e-4)


def test_a_cylinder_has_the_measures_of_its_formula() -> None:
    axis: FloatArray = np.array([[0.6, 0.0, 0.8]])
    found = brep_measures([cylinder_batch(np.ones((1, 3)), axis, np.array([3.0]), 2.0)])
    np.testing.assert_allclose(found.volumes, 12 * np.pi, rtol=1e-12)
    np.testing.assert_allclose(found.areas, 20 * np.pi, rtol=1e-12)
    np.testing.assert_allclose(found.centers, 1 + 1.5 * axis, atol=1e-7)


def test_the_other_engine_states_nothing(tmp_path: Path) -> None:
    options = StepOptions(engine="cadquery", validation=True)
    with pytest.raises(InputError, match="states no measures"):
        write_step(model(), tmp_path / "m.step", options)
