"""The commands that keep results: sweep, and --cache."""

import csv
import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

import spheremesh as sm
from spheremesh.interfaces.cli import main
from spheremesh.nodes import fit_spheres, minimize_angles, panels, roof_mesh, write_schedule


def run(*arguments: object) -> Result:
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def roof(tmp_path_factory: pytest.TempPathFactory) -> Path:
    g = sm.Graph("roof")
    n, t = g.param("n", 4, min=3), g.param("t", 0.02, min=0)
    start = g.add(fit_spheres, mesh=g.add(roof_mesh, n_span=n, n_length=6))
    best = g.add(minimize_angles, "best", sphere_mesh=start)
    cut = g.add(panels, "cut", sphere_mesh=best.sphere_mesh, thickness=t)
    g.add(write_schedule, "list", panels=cut.panels, path="schedule.json")
    path = tmp_path_factory.mktemp("roof") / "roof.json"
    g.save(path)
    return path


def test_a_sweep_writes_a_folder_and_a_row_for_each_point(roof: Path, tmp_path: Path) -> None:
    out, cache = tmp_path / "out", tmp_path / "cache"
    arguments = (
        "sweep", roof, "--set", "n=4,5", "--set", "t=0.01:0.03:3", "-o", out,
        "--target", "best.report", "--target", "list", "--field", "angles_deg.spherical",
        "--cache", cache,
    )  # fmt: skip
    result = run(*arguments)
    assert result.exit_code == 0, result.stderr
    assert result.stdout == f"6 points, 0 failed; {out / 'sweep.csv'}\n"
    with (out / "sweep.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [(row["n"], row["t"]) for row in rows] == [
        (n, t) for n in ("4", "5") for t in ("0.01", "0.02", "0.03")
    ]
    assert list(rows[0])[2:4] == [
        "best.report.angles_deg.spherical.mean",
        "best.report.angles_deg.spherical.max",
    ]
    texts = {(Path(row["folder"]) / "schedule.json").read_text() for row in rows}
    assert len(texts) == 6
    assert [row["steps_run"] for row in rows] == ["5", "2", "2", "5", "2", "2"]
    again = run(*arguments, "--json")
    assert [row["steps_run"] for row in json.loads(again.stdout)] == [0] * 6


def test_what_fails_is_told_beside_what_does_not(roof: Path, tmp_path: Path) -> None:
    arguments = ("sweep", roof, "--set", "t=0.01,1000.0", "-o", tmp_path / "out", "--no-cache")
    result = run(*arguments, "--target", "list")
    assert result.exit_code == 0, result.stderr
    assert "2 points, 1 failed" in result.stdout
    assert result.stderr.startswith("failed: t = 1000.0: step 'list' ")
    assert run(*arguments, "--target", "list", "--strict").exit_code == 5


@pytest.mark.parametrize(
    ("options", "code", "text"),
    [
        (("--set", "k=1"), 3, "no param 'k'"),
        (("--set", "n=1,2"), 3, "param n = 1: must be at least 3"),
        (("--set", "n"), 2, "--set takes NAME=VALUE, not 'n'"),
        (("--set", "t=0:1:0"), 2, "a range is START:STOP:COUNT"),
        (("--set", "n=4", "--target", "lst"), 3, "no step 'lst'; did you mean 'list'"),
        (("--set", "n=4", "--workers", "2", "--dask", "x"), 2, "exclude each other"),
        (
            ("--set", "n=4", "--import", "nobody_has_this"),
            3,
            "--import nobody_has_this: ",
        ),
        (("--set", "n=4", "--field", "x", "--target", "best.report"), 3, "has a field 'x'"),
        (("--set", "n=4", "--cache", "a", "--no-cache"), 2, "exclude each other"),
        ((), 2, "Missing option '--set'"),
    ],
)
def test_mistakes_end_in_one_line(
    roof: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: tuple[str, ...],
    code: int, text: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    result = run("sweep", roof, "-o", tmp_path / "out", *options)
    assert result.exit_code == code, result.output
    assert text in result.stderr
    assert "Traceback" not in result.output


def test_a_folder_of_the_user_is_not_swept_into(roof: Path, tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    result = run("sweep", roof, "--set", "n=4", "-o", tmp_path, "--target", "best.report")
    assert result.exit_code == 3
    assert "it holds other files; choose another folder, or --overwrite" in result.stderr
    options = ("-o", tmp_path, "--target", "best.report", "--overwrite")
    assert run("sweep", roof, "--set", "n=4", *options).exit_code == 0


def test_a_second_run_finds_what_the_first_one_kept(roof: Path, tmp_path: Path) -> None:
    options = ("--target", "best.report", "--json", "--cache", tmp_path / "cache")
    first = run("run", roof, "-o", tmp_path / "a", *options)
    assert first.exit_code == 0, first.stderr
    entries = sorted((tmp_path / "cache" / "entries").rglob("*"))
    assert run("run", roof, "-o", tmp_path / "b", *options).stdout == first.stdout
    assert sorted((tmp_path / "cache" / "entries").rglob("*")) == entries
    assert run("run", roof, "--no-cache", *options[:3]).stdout == first.stdout
    (tmp_path / "file").write_text("")
    result = run("run", roof, "--cache", tmp_path / "file")
    assert result.exit_code == 2


def test_a_job_with_kept_results_writes_the_same_files(tmp_path: Path) -> None:
    mesh = tmp_path / "vase.obj"
    from spheremesh.fabrication.mesh_files.writer import write_mesh
    from spheremesh.kernel.surfaces.circular_nets import vase_net

    write_mesh(vase_net(8, 4, 1.0, 2.0, 0.3), mesh)
    options = ("panel", mesh, "--moulds", "3", "--support", "--cache", tmp_path / "cache")
    for thickness, out in (("0.02", "a"), ("0.01", "b"), ("0.02", "c")):
        result = run(*options, "--thickness", thickness, "-o", tmp_path / out)
        assert result.exit_code == 0, result.stderr
    plain = run(*options[:-2], "--no-cache", "--thickness", "0.02", "-o", tmp_path / "d")
    assert plain.exit_code == 0
    for name in ("schedule.json", "schedule.csv", "beams.csv"):
        texts = {(tmp_path / out / name).read_bytes() for out in "acd"}
        assert len(texts) == 1, name
    reports = [json.loads((tmp_path / out / "report.json").read_text()) for out in "acd"]
    for report in reports:
        del report["seconds"], report["files"]
    assert reports[0] == reports[1] == reports[2]
