"""`panel --crease`: sharp edges stay sharp unless the user says otherwise."""

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from spheremesh import Mesh
from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.interfaces.cli import main

CUBE = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


@pytest.fixture(scope="module")
def cube(tmp_path_factory: pytest.TempPathFactory) -> Path:
    corners = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    return write_mesh(Mesh(corners, CUBE), tmp_path_factory.mktemp("cube") / "cube.obj")


def panel(path: Path, out: Path, *options: str) -> tuple[Result, dict[str, Any]]:
    result = CliRunner().invoke(main, ["panel", str(path), "-o", str(out), *options])
    assert result.exit_code == 0, result.stderr
    return result, json.loads((out / "report.json").read_text(encoding="utf-8"))


def test_a_cube_is_flat_panels(cube: Path, tmp_path: Path) -> None:
    result, report = panel(cube, tmp_path / "out")
    assert report["creases"]["count"] == 12
    assert report["creases"]["max_deg"] == pytest.approx(90)
    assert report["angles_deg"]["spherical"] == {"mean": 0.0, "max": 0.0}
    assert "creases of more than 40 degrees, not counted: 12, at 90.00 (90.0)" in result.stdout
    rows = json.loads((tmp_path / "out" / "schedule.json").read_text(encoding="utf-8"))
    assert {row["shape"] for row in rows["panels"]} == {"plane"}
    assert {kind for row in rows["panels"] for kind in row["edge_kinds"]} == {"crease"}


def test_a_cube_is_one_sphere_if_asked_for(cube: Path, tmp_path: Path) -> None:
    result, report = panel(cube, tmp_path / "out", "--crease", "180")
    assert report["creases"]["count"] == 0
    assert report["angles_deg"]["spherical"]["max"] < 1e-3
    assert "creases" not in result.stdout
    rows = json.loads((tmp_path / "out" / "schedule.json").read_text(encoding="utf-8"))
    radii = [row["radius_mm"] for row in rows["panels"]]
    assert radii == pytest.approx([500 * 3**0.5] * 6, rel=1e-6)


@pytest.mark.parametrize("angle", ["-1", "181", "steep"])
def test_crease_angles_are_degrees(cube: Path, tmp_path: Path, angle: str) -> None:
    arguments = ["panel", str(cube), "-o", str(tmp_path / "out"), "--crease", angle]
    assert CliRunner().invoke(main, arguments).exit_code == 2
    assert not (tmp_path / "out").exists()
