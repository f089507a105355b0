"""How finely surfaces of a Rhino file are panelled, from the command line."""

import json
from pathlib import Path

import pytest
import rhino3dm
from click.testing import CliRunner

from spheremesh.interfaces.cli import main


@pytest.fixture(scope="module")
def dome(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A bent sheet, 8 by 5."""
    curves = []
    for y, z in ((0.0, 1.0), (5.0, 2.0)):
        points = [
            rhino3dm.Point3d(x, y, z + h) for x, h in ((0, 0), (3, 1.5), (5, 1.5), (8, 0))
        ]
        curves.append(rhino3dm.NurbsCurve.CreateControlPointCurve(points, 3))
    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Meters
    model.Objects.AddSurface(rhino3dm.NurbsSurface.CreateRuledSurface(*curves))
    path = tmp_path_factory.mktemp("dome") / "dome.3dm"
    assert model.Write(str(path), 8)
    return path


def n_faces(path: Path, out: Path, *options: str) -> int:
    arguments = ["panel", str(path), "-o", str(out), "--json", "--units", "m", *options]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.stderr
    return int(json.loads(result.stdout)["input"]["faces"])


def test_rows_and_edge_length(dome: Path, tmp_path: Path) -> None:
    assert n_faces(dome, tmp_path / "rows", "--rows", "4,3") == 12
    out = tmp_path / "length"
    assert n_faces(dome, out, "--edge-length", "1") == 40
    graph = json.loads((out / "graph.json").read_text(encoding="utf-8"))
    assert '"edge_length": 1.0' in json.dumps(graph)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--rows", "4"], "'4' are not two numbers such as 12,20"),
        (["--rows", "0,3"], "numbers of rows are from 1 to 2000, not 0,3"),
        (["--rows", "a,b"], "'a,b' are not two numbers"),
        (["--edge-length", "0"], "0.0 is not in the range"),
        (["--edge-length", "1", "--rows", "2,2"], "exclude each other; drop one"),
    ],
)
def test_wrong_values_are_usage(
    dome: Path, tmp_path: Path, options: list[str], message: str
) -> None:
    result = CliRunner().invoke(main, ["panel", str(dome), "-o", str(tmp_path), *options])
    assert result.exit_code == 2
    assert message in result.stderr
