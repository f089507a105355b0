"""The command line: what it writes, what it says, and how it fails."""

import json
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from click.testing import CliRunner, Result

import spheremesh as sm
from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.interfaces.cli import main
from spheremesh.interfaces.panel import PanelOptions, panel_graph
from spheremesh.kernel.meshes.mesh import Mesh
from spheremesh.kernel.panels.facts import panel_radii
from spheremesh.kernel.surfaces.circular_nets import vase_net

FILES = {
    "panels.step", "model.3dm", "schedule.csv", "schedule.json", "moulds.dxf", "moulds.svg",
    "preview.png", "view.html", "report.html", "graph.json", "report.json",
}  # fmt: skip


Panelled = tuple[Result, Path]


@pytest.fixture(scope="module")
def vase(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("vase") / "vase.obj"
    return write_mesh(vase_net(12, 6, 1.0, 2.0, 0.3), path)


@pytest.fixture(scope="module")
def panelled(vase: Path, tmp_path_factory: pytest.TempPathFactory) -> Panelled:
    out = tmp_path_factory.mktemp("panelled") / "out"
    arguments = ["panel", str(vase), "-o", str(out), "--moulds", "4", "--thickness", "0.01"]
    # Four radii on so coarse a vase leave steps of up to 30 mm.
    result = CliRunner().invoke(main, [*arguments, "--allow-step", "31", "--json"])
    return result, out


def test_panel_writes_every_file(panelled: Panelled) -> None:
    result, out = panelled
    assert result.exit_code == 0, result.stderr
    assert {path.name for path in out.iterdir()} == FILES


def test_json_is_the_report_alone(panelled: Panelled) -> None:
    result, out = panelled
    report = json.loads(result.stdout)
    assert report == json.loads((out / "report.json").read_text(encoding="utf-8"))
    assert report["input"]["faces"] == 72
    assert report["panels"] == {"written": 72, "rejected": []}
    assert report["moulds"]["count"] == 4
    assert sum(report["moulds"]["panels_per_mould"]) == 72
    angles = report["angles_deg"]
    assert angles["spherical"]["mean"] < 0.8 * angles["planar"]["mean"]
    assert 0 < report["edge_gap"]["relative_to_edge"] < 0.1
    assert set(report["seconds"]) == {"total", "optimize", "step"}
    assert report["audit"]["errors"] == []
    assert report["audit"]["counts"] == {}
    blanks = report["moulds"]["blanks"]
    assert [blank["count"] for blank in blanks] == report["moulds"]["panels_per_mould"]
    assert report["thickness"] == {"min": 0.01, "mean": 0.01, "max": 0.01}


def test_schedule_agrees_with_the_report(panelled: Panelled) -> None:
    result, out = panelled
    report = json.loads(result.stdout)
    schedule = json.loads((out / "schedule.json").read_text(encoding="utf-8"))
    radii = [mould["radius_mm"] / 1000 for mould in schedule["moulds"]]
    np.testing.assert_allclose(radii, report["moulds"]["radii"], rtol=1e-12)
    assert len(schedule["panels"]) == 72


def test_graph_of_a_job_runs_again(panelled: Panelled, tmp_path: Path) -> None:
    _, out = panelled
    arguments = ["run", str(out / "graph.json"), "--set", "moulds=2", "-o", str(tmp_path)]
    result = CliRunner().invoke(main, [*arguments, "--target", "moulds.report", "--json"])
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout)["moulds.report"]["count"] == 2
    assert not list(tmp_path.iterdir()), "no file was asked for"


def test_run_writes_the_files_of_a_target(panelled: Panelled, tmp_path: Path) -> None:
    _, out = panelled
    arguments = ["run", str(out / "graph.json"), "-o", str(tmp_path), "--target", "table"]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.stderr
    assert [path.name for path in tmp_path.iterdir() if path.name[0] != "."] == ["schedule.csv"]


def test_a_job_with_moved_sliders_tells_of_itself(panelled: Panelled, tmp_path: Path) -> None:
    _, out = panelled
    arguments = ["run", str(out / "graph.json"), "--set", "moulds=2", "-o", str(tmp_path)]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 0, result.stderr
    assert {path.name for path in tmp_path.iterdir()} == FILES
    report = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    graph = json.loads((tmp_path / "graph.json").read_text(encoding="utf-8"))
    schedule = json.loads((tmp_path / "schedule.json").read_text(encoding="utf-8"))
    assert report["moulds"]["count"] == len(schedule["moulds"]) == 2
    assert graph["params"]["moulds"]["value"] == 2


def test_every_panel_rejected_is_an_error_that_says_why(vase: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    arguments = ["panel", str(vase), "-o", str(out), "--joint-gap", "5"]
    _assert_refused(arguments, out, "none of the 72 panels can be made: P0000: ")


def test_values_of_targets_are_strict_json(tmp_path: Path) -> None:
    graph = sm.Graph("flat")
    planes = graph.add("face_planes", mesh=graph.add("torus_mesh", n_around=8, n_across=6))
    graph.add("cluster_radii", "few", sphere_mesh=planes, k=2)
    graph.save(tmp_path / "flat.json")
    arguments = ["run", str(tmp_path / "flat.json"), "--target", "few.radii", "--json"]
    result = CliRunner().invoke(main, [*arguments, "-o", str(tmp_path / "out")])
    assert result.exit_code == 0, result.stderr
    assert json.loads(result.stdout) == {"few.radii": [None]}
    assert "1 of 2 moulds" in result.stderr


def test_nodes_lists_and_explains() -> None:
    listed = CliRunner().invoke(main, ["nodes"])
    assert "minimize_angles" in listed.stdout
    explained = CliRunner().invoke(main, ["nodes", "minimize_angles"])
    assert "target_angle" in explained.stdout
    explained = CliRunner().invoke(main, ["nodes", "panels"])
    assert "edge_gap : dict" in explained.stdout  # the fields of its report
    unknown = CliRunner().invoke(main, ["nodes", "minimise_angles"])
    assert unknown.exit_code == 3
    assert "minimize_angles" in unknown.stderr


def test_strict_fails_the_gate_and_names_the_panel(tmp_path: Path) -> None:
    bow_tie = Mesh(
        [[0, 0, 0], [1, 0, 0], [0.1, 1, 0], [1, 1.2, 0], [0, -1, 0], [1, -1, 0]],
        [[0, 1, 2, 3], [1, 0, 4, 5]],
    )
    path = write_mesh(bow_tie, tmp_path / "bow_tie.obj")
    out = tmp_path / "out"
    lenient = CliRunner().invoke(main, ["panel", str(path), "-o", str(out)])
    assert lenient.exit_code == 0, lenient.stderr
    assert "P0000" in lenient.stderr
    strict = CliRunner().invoke(main, ["panel", str(path), "-o", str(out), "--strict"])
    assert strict.exit_code == 5
    rejected = json.loads((out / "report.json").read_text(encoding="utf-8"))["panels"][
        "rejected"
    ]
    assert [panel["id"] for panel in rejected] == ["P0000"]
    assert "cross" in rejected[0]["reason"]


SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
BAD_MESHES = {
    "empty": ("", "empty"),
    "nan": (SQUARE.replace("v 1 1 0", "v nan 1 0") + "f 1 2 3 4\n", "line 3"),
    "range": (SQUARE + "f 1 2 3 9\n", "line 5"),
    "repeated": (SQUARE + "f 1 2 3 3\n", "repeated corner"),
    "non_manifold": (SQUARE + "v 0 0 1\nf 1 2 3\nf 1 2 4\nf 2 1 5\n", "1"),
    "zero_area": (SQUARE + "v 2 0 0\nf 1 2 3 4\nf 2 1 5\n", "zero area"),
}


@pytest.mark.parametrize("name", BAD_MESHES)
def test_bad_mesh_is_one_line_and_no_file(name: str, tmp_path: Path) -> None:
    content, expected = BAD_MESHES[name]
    path = tmp_path / f"{name}.obj"
    path.write_text(content, encoding="utf-8")
    _assert_refused(
        ["panel", str(path), "-o", str(tmp_path / "out")], tmp_path / "out", expected
    )


def test_missing_mesh(tmp_path: Path) -> None:
    out = tmp_path / "out"
    _assert_refused(["panel", str(tmp_path / "no.obj"), "-o", str(out)], out, "no.obj")


def test_unreadable_3dm(tmp_path: Path) -> None:
    path = tmp_path / "broken.3dm"
    path.write_bytes(b"3D Geometry File Format, but no more")
    out = tmp_path / "out"
    _assert_refused(["panel", str(path), "-o", str(out)], out, "broken.3dm")


def test_no_moulds(vase: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    arguments = ["panel", str(vase), "-o", str(out), "--moulds", "0"]
    _assert_refused(arguments, out, "moulds")


def test_thickness_beyond_the_smallest_radius(vase: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    arguments = ["panel", str(vase), "-o", str(out), "--thickness", "50"]
    _assert_refused(arguments, out, "the thickness reaches the centre of the sphere")


def test_folder_that_cannot_be_written(vase: Path, tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("in the way", encoding="utf-8")
    _assert_refused(["panel", str(vase), "-o", str(file / "out")], file / "out", "file")


def test_failure_keeps_older_files(vase: Path, tmp_path: Path) -> None:
    older = tmp_path / "panels.step"
    older.write_text("older", encoding="utf-8")
    arguments = ["panel", str(vase), "-o", str(tmp_path), "--thickness", "50"]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 3
    assert [path.name for path in tmp_path.iterdir()] == ["panels.step"]
    assert older.read_text(encoding="utf-8") == "older"


def _assert_refused(arguments: list[str], out: Path, expected: str) -> None:
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code == 3, result.output
    lines = result.stderr.splitlines()
    assert len(lines) == 1, lines
    assert expected in lines[0]
    assert result.stdout == ""
    assert not out.exists()


# Sides of the thickness, and the drawings of moulds


def schedule(out: Path) -> dict[str, Any]:
    return json.loads((out / "schedule.json").read_text(encoding="utf-8"))


def test_side_of_the_thickness(vase: Path, tmp_path: Path) -> None:
    options = ("--thickness", "0.02", "--side", "outward", "--offset", "power")
    result = panel(vase, tmp_path, *options, "--json")
    assert result.exit_code == 0, result.stderr
    rows = schedule(tmp_path)["panels"]
    for row in rows:
        assert row["inner_radius_mm"] == pytest.approx(row["radius_mm"])
    powers = [abs(row["outer_radius_mm"] ** 2 - row["inner_radius_mm"] ** 2) for row in rows]
    np.testing.assert_allclose(powers, powers[0], rtol=1e-6)
    thickness = json.loads(result.stdout)["thickness"]
    assert thickness["min"] < 0.02 < thickness["max"]
    # Without a number of moulds there is nothing to draw.
    assert not list(tmp_path.glob("moulds.*"))


def test_sides_and_offsets_reach_the_panels(vase: Path) -> None:
    sides: tuple[Literal["inward", "outward", "centred"], ...]
    sides = ("inward", "outward", "centred")
    for side, share in zip(sides, (0.0, 1.0, 0.5), strict=True):
        graph = panel_graph(PanelOptions(mesh=vase, thickness=0.02, side=side))
        made = graph.run("panels.panels")
        radii = panel_radii(made)
        outwards = np.abs(radii.outer_radii - radii.radii)
        np.testing.assert_allclose(outwards, 0.02 * share, atol=1e-9)
        np.testing.assert_allclose(made.thicknesses, 0.02, rtol=1e-12)


@pytest.mark.parametrize("option", [("--side", "up"), ("--offset", "none")])
def test_unknown_sides_and_offsets(option: tuple[str, str], vase: Path, tmp_path: Path) -> None:
    result = panel(vase, tmp_path / "out", *option)
    assert result.exit_code == 2
    assert option[1] in result.stderr


def test_drawings_of_moulds_show_every_panel(panelled: Panelled) -> None:
    _, out = panelled
    for name in ("moulds.dxf", "moulds.svg"):
        text = (out / name).read_text(encoding="utf-8")
        assert all(f"Mould {i:02d}: radius" in text for i in range(1, 5))
        assert all(row["id"] in text for row in schedule(out)["panels"])


# Support, tolerance, target


def panel(mesh: Path, out: Path, *options: str) -> Result:
    return CliRunner().invoke(main, ["panel", str(mesh), "-o", str(out), *options])


def noisy_vase(folder: Path) -> Path:
    net = vase_net(12, 6, 1.0, 2.0, 0.3)
    noise = np.random.default_rng(1).normal(size=net.vertices.shape)
    return write_mesh(Mesh(net.vertices + 0.002 * noise, net.faces), folder / "noisy.obj")


def test_support_writes_beams_and_says_how_straight_they_are(
    vase: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    options = ("--support", "--thickness", "0.02", "--depth", "0.1", "--json")
    result = panel(vase, out, *options)
    assert result.exit_code == 0, result.stderr
    report = json.loads(result.stdout)
    assert report["support"]["torsion_deg_max"] <= 0.05
    assert report["support"]["kind"] == "axis"
    assert report["support"]["feasibility"]["verdict"] == "feasible"
    assert report["support"]["beam_tilt_deg_p95"] <= 20
    assert report["beams"]["written"] > 0
    assert report["beams"]["rejected"] == []
    assert report["panels"]["rejected"] == []
    assert (out / "beams.dxf").stat().st_size > 1000
    text = (out / "panels.step").read_text(encoding="utf-8")
    assert "PRODUCT('B0000'" in text
    assert "PRODUCT('P0000'" in text
    steps = json.loads((out / "graph.json").read_text(encoding="utf-8"))["steps"]
    assert {"optimum", "feasibility", "annuli", "beams", "drawing", "beam_table"} <= set(steps)
    rows = (out / "beams.csv").read_text(encoding="utf-8-sig").splitlines()
    assert len(rows) == report["beams"]["written"] + 1
    listed = json.loads((out / "schedule.json").read_text(encoding="utf-8"))
    assert len(listed["beams"]) == report["beams"]["written"]
    assert len(listed["panels"]) == report["panels"]["written"]
    tilts = np.array([beam["tilt_deg"] for beam in listed["beams"]])
    is_inner = np.array([None not in beam["panels"] for beam in listed["beams"]])
    support = report["support"]
    assert support["beam_tilt_deg_p95"] == pytest.approx(np.percentile(tilts[is_inner], 95))
    assert support["beam_tilt_deg_max"] == pytest.approx(tilts.max())


def test_rejected_beams_are_told_with_their_codes(vase: Path, tmp_path: Path) -> None:
    """Nodes as large as the shortest beams: what cannot be cut is listed, and nothing lost."""
    out = tmp_path / "out"
    options = ("--support", "--depth", "0.1", "--node-radius", "0.26", "--strict")
    result = panel(vase, out, *options)
    assert result.exit_code == 5, result.stderr
    report = json.loads((out / "report.json").read_text(encoding="utf-8"))
    rejected = report["beams"]["rejected"]
    assert rejected
    assert {part["code"] for part in rejected} <= {"B100", "B101"}
    for part in rejected:
        assert f"rejected {part['code']}: {part['id']}: {part['reason']}" in result.stderr
    assert sum(line.startswith("error B") for line in result.stderr.splitlines()) == 0
    found = {part["id"] for part in rejected}
    of_beams = {e["id"] for e in report["audit"]["errors"] if e["code"] in {"B100", "B101"}}
    assert of_beams == found
    written = json.loads((out / "schedule.json").read_text(encoding="utf-8"))
    ids = {row["id"] for row in written["beams"]}
    assert len(ids) == report["beams"]["written"]
    assert not ids & found
    assert {name for row in written["nodes"] for name in row["beams"]} == ids
    text = (out / "panels.step").read_text(encoding="utf-8")
    assert all(f"PRODUCT('{row['id']}'" in text for row in written["nodes"])


def test_strict_fails_where_beams_run_into_each_other(vase: Path, tmp_path: Path) -> None:
    """They are made and written, and cannot be built."""
    options = ("--support", "--depth", "0.1", "--beam-thickness", "0.05")
    result = panel(vase, tmp_path / "out", *options, "--node-radius", "0.01", "--strict")
    assert "error B102: B0000: overlaps beam" in result.stderr
    assert "0 rejected" in result.stdout
    assert result.exit_code == 5


def test_no_beam_at_all_is_an_error_that_says_why(vase: Path, tmp_path: Path) -> None:
    result = panel(vase, tmp_path / "out", "--support", "--node-radius", "5")
    assert result.exit_code == 3
    assert "beams can be made" in result.stderr
    assert "make the beams thinner or the node smaller" in result.stderr
    assert not (tmp_path / "out").exists()
    deep = panel(vase, tmp_path / "out", "--support", "--depth", "100")
    assert "rejected B100: B0000: the depth 100 is not less than the radius" in deep.stderr


def test_options_of_beams_without_beams_are_told(vase: Path, tmp_path: Path) -> None:
    options = ("--depth", "0.1", "--node-radius", "0.02", "--json")
    result = panel(vase, tmp_path / "out", *options)
    assert result.exit_code == 0
    assert "without --support there are no beams: --depth, --node-radius" in result.stderr
    assert json.loads(result.stdout)["beams"]["written"] == 0


def test_a_tolerance_brings_vertices_onto_common_spheres(tmp_path: Path) -> None:
    mesh = noisy_vase(tmp_path)
    result = panel(mesh, tmp_path / "out", "--tolerance", "0.1", "--json")
    assert result.exit_code == 0, result.stderr
    report = json.loads(result.stdout)
    assert report["vertex_error"]["relative_to_edge"] <= 1e-6
    assert report["angles_deg"]["spherical"]["mean"] < report["angles_deg"]["planar"]["mean"]


def test_no_tolerance_at_all_refuses_faces_without_a_circle(tmp_path: Path) -> None:
    out = tmp_path / "out"
    result = panel(noisy_vase(tmp_path), out, "--tolerance", "0")
    assert result.exit_code == 4
    assert result.stderr.count("\n") == 1
    assert "lie on no circle" in result.stderr
    assert not out.exists()


def test_target_angle(vase: Path, tmp_path: Path) -> None:
    result = panel(vase, tmp_path / "out", "--target-angle", "30", "--json")
    assert result.exit_code == 0, result.stderr
    assert 20 < json.loads(result.stdout)["angles_deg"]["spherical"]["mean"] < 40


@pytest.mark.parametrize(
    "option", [("--tolerance", "-1"), ("--target-angle", "91"), ("--target-angle", "x")]
)
def test_options_out_of_range(option: tuple[str, str], vase: Path, tmp_path: Path) -> None:
    assert panel(vase, tmp_path / "out", *option).exit_code == 2


def test_an_error_that_no_input_should_cause_is_one_line_with_its_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("no way")

    graph = sm.Graph("broken")
    graph.add("torus_mesh", "ring", n_around=6, n_across=5)
    path = tmp_path / "broken.json"
    graph.save(path)
    monkeypatch.setattr("spheremesh.kernel.surfaces.circular_nets.torus_net", broken)
    result = CliRunner().invoke(main, ["run", str(path), "-o", str(tmp_path / "out")])
    assert result.exit_code == 1, result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert "step 'ring' (node torus_mesh) failed: no way" in result.stderr
    assert "ZeroDivisionError, test_cli.py line" in result.stderr


def test_an_edge_length_without_surfaces_is_told(vase: Path, tmp_path: Path) -> None:
    result = panel(vase, tmp_path / "out", "--edge-length", "1")
    assert result.exit_code == 0
    assert "warning: the edge length is for surfaces, and changes nothing" in result.stderr
