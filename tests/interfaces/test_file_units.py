"""The command line takes the units and layers of the file, and says the size."""

import json
from pathlib import Path

import pytest
import rhino3dm
from click.testing import CliRunner

from spheremesh import nodes
from spheremesh.fabrication.rhino.mesh_writer import to_rhino_mesh
from spheremesh.interfaces.cli import main


def panel(*arguments: str) -> tuple[int, str, str]:
    done = CliRunner().invoke(main, ["panel", *arguments])
    return done.exit_code, done.stdout, done.stderr


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A roof in metres as OBJ, and the same numbers in feet on two layers of a .3dm."""
    roof = nodes.roof_mesh(2, 3, length=12.0)
    nodes.write_mesh(roof, tmp_path / "roof.obj")
    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Feet
    for name, x in (("Roof", 0.0), ("Copy", 50.0)):
        layer = rhino3dm.Layer()
        layer.Name = name
        attributes = rhino3dm.ObjectAttributes()
        attributes.LayerIndex = model.Layers.Add(layer)
        mesh = to_rhino_mesh(roof)
        mesh.Translate(rhino3dm.Vector3d(x, 0, 0))
        model.Objects.Add(mesh, attributes)
    assert model.Write(str(tmp_path / "roof.3dm"), 8)
    return tmp_path


def test_files_without_units_say_their_size(folder: Path) -> None:
    path, out = str(folder / "roof.obj"), str(folder / "out")
    code, printed, _ = panel(path, "-o", out)
    assert code == 0
    assert " m, mean edge " in printed.splitlines()[0]
    assert printed.splitlines()[0].endswith("; --units to change")
    code, printed, errors = panel(path, "-o", out, "--units", "mm", "--json")
    assert json.loads(printed)["input"]["units"] == "mm"
    assert "no building has panels of this size" in errors


def test_units_and_layers_of_a_3dm(folder: Path) -> None:
    path, out = str(folder / "roof.3dm"), str(folder / "out")
    code, printed, _ = panel(path, "-o", out, "--layer", "ROOF", "--layer", "copy")
    assert code == 0
    assert " ft, mean edge " in printed.splitlines()[0]
    assert "--units to change" not in printed
    assert json.loads((folder / "out/report.json").read_text())["input"]["faces"] == 12
    assert json.loads((folder / "out/graph.json").read_text())["units"] == "ft"
    code, _, errors = panel(path, "-o", out, "--units", "m")
    assert code == 3
    assert len(errors.splitlines()) == 1
    assert "is drawn in ft, which contradicts --units m" in errors
