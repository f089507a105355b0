"""A design surface in, panels of a pattern out, in one command."""

import json
from pathlib import Path

import numpy as np
import pytest
import rhino3dm
from click.testing import CliRunner

from spheremesh import Mesh
from spheremesh.interfaces.cli import main
from spheremesh.interfaces.panel import PanelOptions, feasible_panel_graph, panel_graph
from spheremesh.nodes import NodeWarning, ellipsoid_mesh, write_mesh


def write_hill(path: Path) -> Path:
    """A cubic surface of 8 by 6 metres, more than twice as curved one way as the other."""
    surface = rhino3dm.NurbsSurface.Create(
        dimension=3, isRational=False, order0=4, order1=4, controlPointCount0=4,
        controlPointCount1=4,
    )  # fmt: skip
    for knots in (surface.KnotsU, surface.KnotsV):
        for i, knot in enumerate([0, 0, 0, 1, 1, 1]):
            knots[i] = knot
    for i in range(4):
        for j in range(4):
            x, y = 8 * i / 3 - 4, 2 * j - 3
            height = -0.08 * x**2 - 0.03 * y**2
            surface.Points[i, j] = rhino3dm.Point4d(x, y, height, 1)
    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Meters
    model.Objects.AddSurface(surface)
    model.Write(str(path), 8)
    return path


def run(*arguments: object) -> tuple[int, str, str]:
    result = CliRunner().invoke(main, ["panel", *map(str, arguments)])
    return result.exit_code, result.stdout, result.stderr


def test_a_drawn_surface_becomes_panels_and_beams(tmp_path: Path) -> None:
    hill, out = write_hill(tmp_path / "hill.3dm"), tmp_path / "out"
    code, said, told = run(
        hill, "--pattern", "quads", "--edge-length", 2.0, "--moulds", 3, "--support",
        "--no-cache", "-o", out,
    )  # fmt: skip
    assert code == 0, told
    assert told.startswith("expected angle between neighbours")
    assert "pattern usable" in said
    report = json.loads((out / "report.json").read_text())
    assert report["panels"]["rejected"] == report["beams"]["rejected"] == []
    assert report["panels"]["written"] == report["pattern"]["net"]["faces"]["count"] >= 10
    assert report["pattern"]["gain"]["quads"]["gain"] > 0.3
    assert report["support"]["kind"] == "axis"
    assert report["support"]["torsion_deg_max"] < 0.1
    assert report["input"]["path"].endswith("hill.3dm")
    assert {"panels.step", "model.3dm", "beams.dxf", "moulds.dxf"} <= set(report["files"])
    graph = json.loads((out / "graph.json").read_text())
    assert "pattern" in json.dumps(graph)


def test_a_round_surface_gets_upright_beams(tmp_path: Path) -> None:
    mesh = write_mesh(ellipsoid_mesh(24, 12, 1.0, 1.02), tmp_path / "ball.obj")
    options = PanelOptions(
        mesh=Path(mesh), pattern="quads", edge_length=0.5, support="axis", units="m"
    )
    with pytest.warns(NodeWarning, match="nearly the same"):
        graph = feasible_panel_graph(options)
    assert graph.steps["annuli"].node.name == "bisector_support"
    assert graph.steps["optimum"].node.name == "minimize_angles"


def test_wishes_for_more_optimise_the_net(tmp_path: Path) -> None:
    hill = write_hill(tmp_path / "hill.3dm")
    options = PanelOptions(mesh=hill, pattern="quads", edge_length=2.0, tolerance=0.05)
    graph = feasible_panel_graph(options)
    assert graph.steps["mesh"].node.name == "read_surface"
    assert graph.steps["optimum"].node.name == "optimize_spheres"


def test_wishes_for_lines_reach_the_pattern(tmp_path: Path) -> None:
    options = PanelOptions(
        mesh=write_hill(tmp_path / "hill.3dm"), pattern="quads", edge_length=2.0,
        direction=(1, 1, 0), density=0.5, insist=True,
    )  # fmt: skip
    wishes = panel_graph(options).steps["pattern"].inputs
    assert [wishes[name] for name in ("direction", "density", "insist")] == [
        [1, 1, 0],
        0.5,
        True,
    ]


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--pattern", "quads"], "add --edge-length"),
        (["--pattern", "quads", "--rows", "4,4", "--edge-length", "1"], "exclude"),
        (["--pattern", "pentagons"], "pentagons"),
        (["--direction", "1,0,0"], "--direction need lines of quads"),
        (["--pattern", "quads", "--edge-length", "1", "--direction", "0,0,0"], "a vector is"),
        (["--pattern", "quads", "--edge-length", "1", "--density", "2"], "range"),
    ],
)
def test_options_that_do_not_fit_are_refused(
    tmp_path: Path, arguments: list[str], reason: str
) -> None:
    code, _, told = run(*arguments, "-o", tmp_path / "out")
    assert code == 2
    assert reason in told


def test_surfaces_that_tell_no_curvature_are_refused(tmp_path: Path) -> None:
    square = np.array([[0.0, 0, 0], [1, 0, 0.1], [1, 1, 0], [0, 1, 0.1]])
    mesh = write_mesh(Mesh(square, [[0, 1, 2, 3]]), tmp_path / "square.obj")
    code, _, told = run(
        mesh, "--pattern", "quads", "--edge-length", 3, "--no-cache", "-o", tmp_path / "out"
    )
    assert code == 3
    assert "too few faces" in told
