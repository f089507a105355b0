"""`panel --max-angle`: the fewest moulds that are smooth enough, or a sentence."""

from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.interfaces.cli import main
from spheremesh.interfaces.panel import PanelOptions, panel_graph
from spheremesh.nodes import roof_mesh


@pytest.fixture(scope="module")
def roof(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_mesh(roof_mesh(6, 7), tmp_path_factory.mktemp("roof") / "roof.obj")


def panel(path: Path, out: Path, *options: str) -> Result:
    return CliRunner().invoke(main, ["panel", str(path), "-o", str(out), *options])


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    ("mean", "largest", "tolerance"),
    [(16.45, None, None), (None, 52, 0.05), (16.5, 28.95, None)],
)
def test_the_job_takes_the_fewest_moulds(
    roof: Path, mean: float | None, largest: float | None, tolerance: float | None
) -> None:
    options = PanelOptions(
        roof, max_angle=mean, max_angle_largest=largest, tolerance=tolerance, units="m"
    )
    found, fewest = panel_graph(options).run("report", "fewest.report")
    built = found["angles_deg"]["spherical"]
    assert built["mean"] <= (mean or 180)
    assert built["max"] <= (largest or 180)
    assert 1 < found["moulds"]["count"] <= fewest["count"]
    assert (fewest["max_angle"], fewest["max_angle_largest"]) == (mean, largest)


def test_wrong_uses(roof: Path, tmp_path: Path) -> None:
    both = panel(roof, tmp_path / "a", "--max-angle", "9", "--moulds", "3")
    assert both.exit_code == 2
    assert "--moulds and --max-angle exclude each other" in both.stderr
    for bad in ("-1", "181", "two"):
        assert panel(roof, tmp_path / "b", "--max-angle", bad).exit_code == 2, bad
    low = panel(roof, tmp_path / "c", "--max-angle-largest", "0.5")
    assert low.exit_code == 3
    assert low.stderr.startswith("spheremesh: no number of moulds keeps neighbours at 0.5 deg")
    assert low.stderr.count("\n") == 1
    assert not (tmp_path / "c").exists()
