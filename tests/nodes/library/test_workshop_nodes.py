"""Nodes of the workshop, as a notebook and a graph use them."""

import json
from pathlib import Path

import numpy as np
import pytest

import spheremesh as sm
from spheremesh.fabrication.step.check import check_part21
from spheremesh.nodes import (
    annulus_support,
    audit,
    beams,
    cluster_radii,
    fit_spheres,
    identical_panels,
    minimize_angles,
    mould_blanks,
    panel_report,
    panels,
    roof_mesh,
    torus_mesh,
    write_schedule,
)


@pytest.fixture(scope="module")
def graph() -> sm.Graph:
    """A torus of 96 panels in three moulds, and all that a workshop asks of it."""
    graph = sm.Graph("ring", units="ft")
    side = graph.param("side", "centred")
    mesh = graph.add("torus_mesh", n_around=16, n_across=6)
    best = graph.add("minimize_angles", sphere_mesh=graph.add("fit_spheres", mesh=mesh))
    few = graph.add("cluster_radii", "few", sphere_mesh=best.sphere_mesh, k=3, relax=False)
    made = graph.add(
        "panels", "panels", sphere_mesh=few.sphere_mesh, thickness=0.1, labels=few.labels,
        side=side,
    )  # fmt: skip
    blanks = graph.add("mould_blanks", "blanks", panels=made.panels)
    found = graph.add("audit", "audit", panels=made.panels, cut=made.report, max_step=20.0)
    graph.add("identical_panels", "same", panels=made.panels)
    graph.add(
        "panel_report", "report", sphere_mesh=few.sphere_mesh, optimum=best.report,
        cut=made.report, moulds=few.report, blanks=blanks, audit=found.report,
    )  # fmt: skip
    graph.add("write_step", "step", panels=made.panels, path="p.step", copies="instances")
    graph.add("write_mould_drawings", "drawings", panels=made.panels, path="m.svg")
    return graph


def test_the_report_is_plain_and_agrees_with_its_parts(graph: sm.Graph) -> None:
    report, blanks, same = graph.run("report", "blanks", "same.report")
    assert json.loads(json.dumps(dict(report), allow_nan=False)) == report
    assert report["input"] | {"vertices": 96, "faces": 96, "units": "ft"} == report["input"]
    assert report["input"]["size"] == pytest.approx([6, 6, 3**0.5])
    assert report["panels"] == {"written": 96, "rejected": []}
    assert report["moulds"]["count"] == 3
    assert report["moulds"]["blanks"] == blanks["blanks"]
    assert report["thickness"]["max"] == pytest.approx(0.1, rel=1e-12)
    assert report["audit"]["errors"] == []
    assert report["buildable"]
    counts = [row["count"] for row in blanks["blanks"]]
    assert counts == report["moulds"]["panels_per_mould"]
    assert sum(row["shapes"] for row in blanks["blanks"]) == same["shapes"] == 3
    assert same["panels_per_shape"] == [32, 32, 32]
    assert same["first"][0] == "P0000"


def test_files_are_written_from_the_graph(
    graph: sm.Graph, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    graph.run("step", "drawings")
    assert check_part21(tmp_path / "p.step") == ()
    assert (tmp_path / "m.svg").read_text("utf-8").count("<circle") == 96


def test_units_are_those_of_the_graph(graph: sm.Graph) -> None:
    """Edges of some feet are no short edges; of some millimetres they are."""
    assert "P103" not in graph.run("audit.report")["counts"]
    made = graph.run("panels.panels")
    assert audit(made, units="mm").report["counts"]["P103"] == 96


def test_panels_without_moulds_are_counted_and_warned_about() -> None:
    optimum = minimize_angles(fit_spheres(torus_mesh(8, 6)))
    made = panels(optimum.sphere_mesh, thickness=0.02)
    with pytest.warns(UserWarning, match="48 of 48 panels belong to no mould"):
        blanks = mould_blanks(made.panels)
    assert blanks == {"blanks": [], "without_mould": 48}
    report = panel_report(optimum.sphere_mesh, optimum.report, made.report)
    assert report["moulds"] == {"count": 0, "radii": [], "panels_per_mould": [], "blanks": []}
    assert report["audit"] is None


def test_rejected_panels_are_errors_of_the_audit() -> None:
    optimum = minimize_angles(fit_spheres(torus_mesh(8, 6)))
    with pytest.warns(UserWarning, match="cannot be made"):
        made = panels(optimum.sphere_mesh, thickness=2.5)
    assert made.report["rejected"]
    found = audit(made.panels, made.report)
    refused = [error for error in found.report["errors"] if error["code"] == "P100"]
    assert [error["id"] for error in refused] == [r["id"] for r in made.report["rejected"]]
    assert made.panels.n_panels + len(refused) == 48


def test_limits_are_inputs() -> None:
    optimum = minimize_angles(fit_spheres(torus_mesh(8, 6)))
    clusters = cluster_radii(optimum.sphere_mesh, k=2)
    made = panels(clusters.sphere_mesh, labels=clusters.labels).panels
    loose = audit(made, min_corner=0, min_edge=0, max_wall_tilt=90, max_step=1e9)
    assert loose.findings == ()
    strict = audit(made, min_corner=180, min_edge=1e9, max_step=0, max_blank=1)
    assert set(strict.report["counts"]) == {"P102", "P103", "P107", "P201"}


def test_shapes_are_told_apart_by_tolerance() -> None:
    optimum = minimize_angles(fit_spheres(torus_mesh(8, 6)))
    made = panels(optimum.sphere_mesh).panels
    assert identical_panels(made).report["shapes"] == 3
    coarse = identical_panels(made, tolerance=10.0)
    assert coarse.report["shapes"] == 1
    assert np.bincount(coarse.labels).tolist() == [48]


def test_beams_and_what_was_rejected_are_audited(tmp_path: Path) -> None:
    optimum = minimize_angles(fit_spheres(torus_mesh(8, 6)), crease=180)
    cut = panels(optimum.sphere_mesh, thickness=0.02)
    with pytest.warns(UserWarning, match="annuli cannot be made"):
        annuli = annulus_support(optimum.sphere_mesh, depth=0.3, max_tilt=2)
    with pytest.warns(UserWarning, match="beams cannot be made"):
        made = beams(annuli.annuli, 0.05, node_radius=0.3)
    found = audit(
        cut.panels, cut.report, beams=made.beams, annuli_report=annuli.report,
        beams_report=made.report, max_wall_tilt=1, max_length=600,
    )  # fmt: skip
    codes = {"B100", "B101"}
    refused = [error["id"] for error in found.report["errors"] if error["code"] in codes]
    counts = found.report["counts"]
    assert counts["B100"] == len(annuli.report["rejected"]) > 0
    assert counts["B101"] == len(made.report["rejected"]) > 0
    assert {"B207", "P105"} <= set(counts)
    # Every edge is a beam or has a code.
    assert sorted([*refused, *made.beams.annuli.ids]) == [f"B{i:04d}" for i in range(96)]
    alone = audit(beams=made.beams, max_wall_tilt=1, max_length=600).report["counts"]
    assert alone == {code: counts[code] for code in alone}
    report = panel_report(
        optimum.sphere_mesh, optimum.report, cut.report, audit=found.report,
        annuli=annuli.report, beams=made.report,
    )  # fmt: skip
    assert {part["code"] for part in report["beams"]["rejected"]} == {"B100", "B101"}
    path = write_schedule(cut.panels, str(tmp_path / "s.json"), beams=made.beams)
    rows = json.loads(Path(path).read_text("utf-8"))["beams"]
    assert len(rows) == report["beams"]["written"] == made.beams.n_beams


def test_moulds_move_nothing_unless_allowed() -> None:
    spheres = minimize_angles(fit_spheres(roof_mesh(6, 12))).sphere_mesh
    fixed = cluster_radii(spheres, k=3)
    np.testing.assert_array_equal(fixed.sphere_mesh.mesh.vertices, spheres.mesh.vertices)
    assert fixed.report["vertex_move"] == 0
    with pytest.warns(UserWarning, match="the moulds moved vertices by up to"):
        moved = cluster_radii(spheres, k=3, tolerance=0.02)
    assert 0 < moved.report["vertex_move"] <= 0.02
    assert moved.report["angles_deg"]["mean"] < fixed.report["angles_deg"]["mean"]


def test_what_a_workshop_cannot_tell_apart_depends_on_the_unit() -> None:
    """A roof of 2 m has eight moulds; one of 2 mm is flat."""
    spheres = minimize_angles(fit_spheres(roof_mesh(6, 12, length=2.0))).sphere_mesh
    assert cluster_radii(spheres, k=8, units="m").report["count"] == 8
    with pytest.warns(UserWarning, match="1 of 8 moulds: no more can be told apart by 0.1 mm"):
        flat = cluster_radii(spheres, k=8, units="mm")
    assert flat.report["radii"] == [None]
