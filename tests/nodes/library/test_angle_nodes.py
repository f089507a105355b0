"""Nodes of the smallest angles: creases, caps, and what is said of them."""

import importlib
import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.optimization import angle_minimization
from spheremesh.nodes import (
    catenoid_mesh,
    cluster_radii,
    enneper_mesh,
    face_planes,
    fit_spheres,
    intersection_angles,
    minimize_angles,
    optimize_spheres,
    panel_report,
    panels,
    roof_mesh,
    strip_weights,
    torus_mesh,
    triangulate,
    vase_mesh,
    write_3dm,
    write_schedule,
)


def house() -> Mesh:
    """A vault that bends along its ridge, too, with an eaves and a wall on either side."""
    x = np.array([-2.2, -2.0, -1.4, -0.7, 0.0, 0.7, 1.4, 2.0, 2.2])
    z = np.array([-1.2, 0.0, 0.45, 0.72, 0.8, 0.72, 0.45, 0.0, -1.2])
    rows = 5
    points = np.concatenate(
        [np.c_[x, np.full(9, float(y)), z - 0.1 * (y - 2) ** 2] for y in range(rows)]
    )
    first = np.arange(rows - 1)[:, None] * 9 + np.arange(8)
    return Mesh(points, first.reshape(-1, 1) + np.array([0, 1, 10, 9]))


def said(*arguments: Any, **options: Any) -> list[str]:  # noqa: ANN401
    """Warnings of a run of `minimize_angles`."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        minimize_angles(*arguments, **options)
    return [str(each.message) for each in caught]


@pytest.mark.filterwarnings("ignore:vertices miss", "ignore:.* panels are flatter")
def test_creases_are_counted_apart() -> None:
    mesh = house()
    report = minimize_angles(fit_spheres(mesh)).report
    creases = report["creases"]
    assert creases["count"] == len(creases["edges"]) == 8
    assert creases["angle_deg"] == 40
    assert 30 < creases["mean_deg"] <= creases["max_deg"] < 80
    angles = intersection_angles(minimize_angles(fit_spheres(mesh)).sphere_mesh)
    is_smooth = np.ones(len(angles), bool)
    is_smooth[creases["edges"]] = False
    assert report["angles_deg"]["spherical"]["mean"] == pytest.approx(angles[is_smooth].mean())
    assert report["angles_deg"]["planar"]["max"] < 40
    json.dumps(dict(report))
    free = minimize_angles(fit_spheres(mesh), crease=180).report
    assert free["creases"]["count"] == 0
    assert free["creases"]["mean_deg"] == 0


@pytest.mark.filterwarnings("ignore:vertices miss", "ignore:.* panels are flatter")
def test_creases_reach_panels_files_and_reports(tmp_path: Path) -> None:
    optimum = minimize_angles(fit_spheres(house()))
    moulds = cluster_radii(optimum.sphere_mesh, k=3, relax=False)
    cut = panels(moulds.sphere_mesh, thickness=0.02, labels=moulds.labels)
    assert cut.report["rejected"] == []
    report = panel_report(moulds.sphere_mesh, optimum.report, cut.report, moulds.report)
    assert report["creases"]["count"] == 8
    assert report["angles_deg"]["spherical"]["max"] < report["creases"]["max_deg"]
    assert report["angles_deg"]["spherical"] == moulds.report["angles_deg"]
    library: Any = importlib.import_module("rhino3dm")
    file = library.File3dm.Read(write_3dm(cut.panels, str(tmp_path / "house.3dm")))
    layers = {layer.Index: layer.Name for layer in file.Layers}
    names = [layers[each.Attributes.LayerIndex] for each in file.Objects]
    assert names.count("Creases") == 2 * 8
    path = write_schedule(cut.panels, str(tmp_path / "panels.json"))
    rows = json.loads(Path(path).read_text(encoding="utf-8"))["panels"]
    kinds = [kind for row in rows for kind in row["edge_kinds"]]
    assert kinds.count("crease") == 2 * 8
    assert set(kinds) == {"crease", "smooth", "rim"}
    plain = panels(moulds.sphere_mesh, crease=180)
    assert not plain.panels.is_crease.any()


@pytest.mark.filterwarnings("ignore")
def test_the_whole_energy_keeps_creases() -> None:
    """Creases count nothing: as with weights of 0, and sharper than if they counted."""
    mesh = house()
    start = fit_spheres(mesh)
    found = optimize_spheres(start, angle=1.0)
    creases = found.report["creases"]
    assert found.report["kept"] == "optimum"
    assert creases["count"] == 8
    assert creases["max_deg"] > 40
    planar, spherical = (found.report["angles_deg"][k] for k in ("planar", "spherical"))
    assert spherical["mean"] < planar["mean"] / 2
    weights = np.ones(len(mesh.topology.edge_corners))
    weights[creases["edges"]] = 0.0
    same = optimize_spheres(start, angle=1.0, edge_weights=weights, crease=180)
    np.testing.assert_array_equal(same.sphere_mesh.spheres, found.sphere_mesh.spheres)
    rounded = optimize_spheres(start, angle=1.0, crease=180).sphere_mesh
    angles = intersection_angles(rounded)
    assert angles[creases["edges"]].max() < 20
    assert angles[weights > 0].mean() > 1.5 * spherical["mean"]


@pytest.mark.filterwarnings("ignore")
def test_a_smoother_start_is_kept_with_its_creases() -> None:
    start = minimize_angles(fit_spheres(house())).sphere_mesh
    found = optimize_spheres(start, angle=1.0)
    assert found.report["kept"] == "start"
    np.testing.assert_array_equal(found.sphere_mesh.spheres, start.spheres)


def test_cushions_of_one_side_are_cut_by_their_arcs() -> None:
    """What is nearest to a target bulges to both sides: its arcs lean over the faces."""
    start = fit_spheres(catenoid_mesh(18, 7))
    nearest = minimize_angles(start, target_angle=60)
    cushions = minimize_angles(start, target_angle=60, sides="one")
    assert panels(nearest.sphere_mesh, thickness=0.01).report["written"] == 126
    with pytest.warns(UserWarning, match="cut it by bisectors"):
        panels(nearest.sphere_mesh, edges="intersection", thickness=0.01)
    bulges = cushions.sphere_mesh.spheres[:, 0]
    assert (bulges > 0).all() or (bulges < 0).all()
    cut = panels(cushions.sphere_mesh, edges="intersection", thickness=0.01)
    assert cut.report["written"] == 126
    reached = [each.report["angles_deg"]["spherical"]["mean"] for each in (nearest, cushions)]
    np.testing.assert_allclose(reached, 60, atol=5)


def test_messages_about_strips_speak_of_their_edges() -> None:
    """Across strips spheres need not meet smoothly: that is no loss."""
    net = torus_mesh(24, 12)
    weights = strip_weights(net, 0)
    assert not [text for text in said(fit_spheres(net), edge_weights=weights) if "gain" in text]
    flat = enneper_mesh(8, 0.9)
    texts = said(fit_spheres(flat), edge_weights=strip_weights(flat, 0))
    assert all("along the weighted edges" in text for text in texts if "degrees" in text)
    assert any("gain little" in text for text in said(fit_spheres(enneper_mesh(20, 0.6))))


def test_sharper_edges_are_told() -> None:
    """The mean falls, and one edge pays for it."""
    for mesh in (vase_mesh(20, 12), roof_mesh(8, 12), enneper_mesh(12, 1.2)):
        texts = said(fit_spheres(mesh), crease=180)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            report = minimize_angles(fit_spheres(mesh), crease=180).report
        planar, spherical = (report["angles_deg"][k] for k in ("planar", "spherical"))
        assert any("sharpest edge" in text for text in texts) == (
            spherical["max"] > planar["max"] * 1.05
        )


@pytest.mark.parametrize("opening", [20, 45, 60])
def test_openings_are_bounded_in_degrees(opening: float) -> None:
    pair = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0.3], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    found = minimize_angles(fit_spheres(pair), max_opening=opening).sphere_mesh
    # The rim of a cap of half opening t lies on a circle of radius sin t / curvature.
    radii = np.array([np.sqrt(2) / 2, 0.5 * np.sqrt(2.09)])
    sines = np.abs(2 * found.spheres[:, 0]) * radii
    assert sines.max() <= np.sin(np.radians(opening)) * 1.05
    assert panels(found).report["rejected"] == []


def test_targets_have_no_bound_unless_asked_for() -> None:
    squares = Mesh([[x, y, 0] for x in range(4) for y in range(4)],
                   [[4 * i + j, 4 * i + j + 4, 4 * i + j + 5, 4 * i + j + 1]
                    for i in range(3) for j in range(3)])  # fmt: skip
    free = minimize_angles(face_planes(squares), target_angle=90)
    assert free.report["angles_deg"]["spherical"]["mean"] == pytest.approx(90, abs=0.01)
    bound = minimize_angles(face_planes(squares), target_angle=90, max_opening=60)
    assert bound.report["converged"]
    assert bound.report["angles_deg"]["spherical"]["max"] < 89


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("seed", range(3))
def test_spheres_cost_no_panel(seed: int) -> None:
    """On noise, faces that cannot be cut from spheres are flat."""
    net = roof_mesh(6, 8)
    ends = net.vertices[net.topology.edge_vertices]
    edge = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).mean()
    rng = np.random.default_rng(seed)
    noise = rng.normal(size=(net.n_vertices, 3))
    mesh = triangulate(Mesh(net.vertices + 0.25 * edge * noise, net.faces))
    found = minimize_angles(fit_spheres(mesh))
    lost = {part["id"] for part in panels(found.sphere_mesh).report["rejected"]}
    assert lost <= {part["id"] for part in panels(face_planes(mesh)).report["rejected"]}
    planar, spherical = (found.report["angles_deg"][k] for k in ("planar", "spherical"))
    assert spherical["mean"] <= planar["mean"] * (1 + 1e-9)
    free = angle_minimization.minimize_angles(fit_spheres(mesh), crease=np.radians(40))
    assert panels(free[0]).report["rejected"]
