"""What the workshop allows, on the command line: errors, the last line, exit codes."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from spheremesh import Mesh
from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.interfaces.cli import GATE_FAILED, main
from spheremesh.kernel.surfaces.circular_nets import roof_net

LIMITS = "--allow-step", "--allow-torsion"


@pytest.fixture(scope="module")
def skew(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A roof without creases, of a third of a metre an edge, its nodes off by a centimetre.

    Its panels step by up to 17 mm, and its beams twist by up to 0.01 degrees.
    """
    net = roof_net(6, 5, 3.0)
    random = np.random.default_rng(1)
    points = net.vertices + 0.01 * random.standard_normal(net.vertices.shape)
    path = tmp_path_factory.mktemp("skew") / "skew.obj"
    write_mesh(Mesh(points, net.faces), path)
    return path


def panel(mesh: Path, out: Path, *options: str) -> Result:
    return CliRunner().invoke(main, ["panel", str(mesh), "-o", str(out), *options])


def test_what_is_not_allowed_is_the_last_line(skew: Path, tmp_path: Path) -> None:
    options = ["--support", "--thickness", "0.02", "--allow-torsion", "0.005", "--strict"]
    result = panel(skew, tmp_path / "a", *options)
    assert result.exit_code == GATE_FAILED
    last = result.stdout.strip().splitlines()[-1]
    assert last.startswith("NOT BUILDABLE: P201 (")
    assert "a step of" in last
    cures = last.partition(". What would do: ")[2]
    assert cures.startswith("vertices on their spheres, which they miss by up to ")
    assert "(--support bisector)" in cures
    step, twist = (float(re.search(f"{option} ([0-9.]+)", cures)[1]) for option in LIMITS)
    report = json.loads((tmp_path / "a" / "report.json").read_text("utf-8"))
    assert not report["buildable"]
    for code, limit in (("P201", step), ("B202", twist)):
        sizes = [found["size"] for found in report["audit"]["errors"] if found["code"] == code]
        assert max(sizes) <= limit <= 1.02 * max(sizes)
    codes = [found["code"] for found in report["audit"]["errors"]]
    shown = [line for line in result.stderr.splitlines() if line.startswith("error P201")]
    assert set(codes) == {"P201", "B202"}
    assert len(shown) == 6
    assert shown[-1].endswith(f"{codes.count('P201') - 5} more, in report.json")


def test_what_is_allowed_can_be_built(skew: Path, tmp_path: Path) -> None:
    options = ["--support", "--thickness", "0.02", "--bearing", "0.004", "--strict"]
    allowed = ["--allow-step", "18", "--allow-gap", "18", "--allow-torsion", "0.02"]
    result = panel(skew, tmp_path / "a", *options, *allowed, "--json")
    assert result.exit_code == 0, result.stderr
    report = json.loads(result.stdout)
    assert report["buildable"]
    assert report["audit"]["errors"] == []
    assert "NOT BUILDABLE" not in result.stderr


def test_a_bearing_needs_beams(skew: Path, tmp_path: Path) -> None:
    result = panel(skew, tmp_path / "a", "--bearing", "0.004")
    assert "without --support there are no beams: --bearing unused" in result.stderr
    assert panel(skew, tmp_path / "b", "--allow-step", "-1").exit_code == 2
