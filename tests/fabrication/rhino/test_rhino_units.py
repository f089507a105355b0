"""One roof drawn in any unit is the same roof in millimetres, in every file."""

import json
import re
import warnings
from pathlib import Path

import numpy as np
import pytest
import rhino3dm

from spheremesh import Graph, Mesh, nodes
from spheremesh.fabrication.mesh_files.reader import read_content
from spheremesh.fabrication.rhino.mesh_writer import to_rhino_mesh
from spheremesh.fabrication.units import MILLIMETERS
from spheremesh.interfaces.panel import PanelOptions, model_units, panel_graph
from spheremesh.kernel.errors import InputError
from spheremesh.nodes.graphs.errors import NodeError

SYSTEMS = {
    "mm": "Millimeters", "cm": "Centimeters", "m": "Meters", "in": "Inches", "ft": "Feet",
}  # fmt: skip
NUMBER = re.compile(r"-?\d+\.\d*(?:E[+-]?\d+)?")


def drawn(path: Path, system: str, scale: float = 1.0) -> Path:
    """A small roof, 1 mm at scale 1, in a unit of Rhino."""
    roof = nodes.roof_mesh(2, 3, length=12000.0)
    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = getattr(rhino3dm.UnitSystem, system)
    model.Objects.AddMesh(to_rhino_mesh(Mesh(roof.vertices * scale, roof.faces)))
    assert model.Write(str(path), 8)
    return path


def coordinates(step: Path) -> np.ndarray:
    """All the numbers of the points in a STEP file."""
    lines = [x for x in step.read_text().splitlines() if "CARTESIAN_POINT" in x]
    return np.array([float(number) for x in lines for number in NUMBER.findall(x)])


def test_one_roof_in_five_units_gives_the_same_millimetres(tmp_path: Path) -> None:
    points: dict[str, np.ndarray] = {}
    for units, system in SYSTEMS.items():
        path = drawn(tmp_path / f"{units}.3dm", system, 1 / MILLIMETERS[units])
        graph = panel_graph(PanelOptions(mesh=path))
        assert graph.units == units
        (tmp_path / units).mkdir()
        _, report, _, _, _ = graph.run(
            "step", "report", "rhino", "table", "list", write_to=tmp_path / units
        )
        assert report["input"]["units"] == units
        points[units] = coordinates(tmp_path / units / "panels.step")
        model = rhino3dm.File3dm.Read(str(tmp_path / units / "model.3dm"))
        assert model.Settings.ModelUnitSystem.name == system
        assert json.loads((tmp_path / units / "schedule.json").read_text())["units"] == "mm"
    size = np.abs(points["mm"]).max()
    assert len(points["mm"]) > 100
    for units in SYSTEMS:
        assert np.abs(points[units] - points["mm"]).max() < 1e-9 * size


@pytest.mark.parametrize(
    ("system", "units", "scale"),
    [
        ("Yards", "ft", 3),
        ("Microns", "mm", 1e-3),
        ("Decimeters", "m", 0.1),
        ("Miles", "ft", 5280),
    ],
)
def test_other_units_are_converted_and_said(
    tmp_path: Path, system: str, units: str, scale: float
) -> None:
    content = read_content(drawn(tmp_path / "a.3dm", system))
    expected = nodes.roof_mesh(2, 3, length=12000.0).vertices * scale
    assert content.units == units
    assert f"drawn in {system.lower()}; it is read in {units}" in content.remarks[0]
    assert np.abs(content.polygons.vertices - expected).max() < 1e-12 * np.abs(expected).max()


def test_units_that_no_one_builds_in_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="drawn in Parsecs; choose mm, cm, m, in or ft"):
        read_content(drawn(tmp_path / "a.3dm", "Parsecs"))


def test_files_without_units(tmp_path: Path) -> None:
    for system in ("None", "CustomUnits"):
        path = drawn(tmp_path / "a.3dm", system)
        assert read_content(path).units == ""
        assert panel_graph(PanelOptions(mesh=path)).units == "m"
        assert panel_graph(PanelOptions(mesh=path, units="cm")).units == "cm"
    assert "custom units" in read_content(path).remarks[0]
    assert model_units(PanelOptions(mesh=path)) == ("m", True)
    assert model_units(PanelOptions(mesh=Path("any.obj"))) == ("m", True)
    assert model_units(PanelOptions(mesh=Path("any.obj"), units="ft")) == ("ft", False)
    assert panel_graph(PanelOptions()).units == "m"


def test_units_that_contradict_the_file_are_refused(tmp_path: Path) -> None:
    path = drawn(tmp_path / "a.3dm", "Millimeters")
    assert panel_graph(PanelOptions(mesh=path, units="mm")).units == "mm"
    with pytest.raises(InputError, match="is drawn in mm, which contradicts --units m;"):
        model_units(PanelOptions(mesh=path, units="m"))
    assert model_units(PanelOptions(mesh=path)) == ("mm", False)


def test_graphs_refuse_files_in_other_units(tmp_path: Path) -> None:
    path = drawn(tmp_path / "a.3dm", "Millimeters")
    for units in ("m", "mm"):
        graph = Graph(units=units)
        mesh = graph.add("read_mesh", path=str(path))
        if units == "mm":
            assert graph.run(mesh).n_faces == 6
        else:
            with pytest.raises(NodeError, match="it is drawn in mm, not in m; use units 'mm'"):
                graph.run(mesh)


@pytest.mark.parametrize(
    ("system", "is_doubted"), [("Millimeters", False), ("Meters", True), ("Microns", True)]
)
def test_sizes_that_no_building_has(tmp_path: Path, system: str, is_doubted: bool) -> None:  # noqa: FBT001
    path = drawn(tmp_path / "a.3dm", system)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        nodes.read_mesh(path)
    texts = [str(each.message) for each in caught]
    assert any("no building has panels of this size" in text for text in texts) == is_doubted
