"""Cost, flat panels and the curve over moulds, as a notebook and a job use them."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

import spheremesh as sm
from spheremesh import SphereMesh
from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.interfaces.cli import main
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.spheres.circles import face_circles
from spheremesh.nodes import (
    cluster_radii,
    cost,
    cost_curve,
    fit_spheres,
    flat_panels,
    minimize_angles,
    panels,
    roof_mesh,
)

PRICES: dict[str, Any] = {
    "currency": "EUR",
    "moulds": {"each": 1000.0},
    "blanks": {"per_m2": 50.0, "flat_per_m2": 20.0},
    "panels": {"per_m2": 100.0, "flat_per_m2": 60.0},
}
FILE = """currency = "EUR"
moulds = { each = 1000 }
blanks = { per_m2 = 50, flat_per_m2 = 20 }
panels = { per_m2 = 100, flat_per_m2 = 60 }
"""


@pytest.fixture(scope="module")
def spheres() -> SphereMesh:
    return minimize_angles(fit_spheres(roof_mesh(8, 9))).sphere_mesh


def rises(sphere_mesh: SphereMesh) -> np.ndarray:
    """Heights of the caps over the circles of the faces, from their radii alone."""
    rims = np.sqrt(face_circles(sphere_mesh.mesh)[0].radii_squared)
    curvatures = 2 * np.abs(sphere_mesh.local_spheres[:, 0])
    return curvatures * rims**2 / (1 + np.sqrt(np.maximum(1 - (curvatures * rims) ** 2, 0)))


@pytest.mark.filterwarnings("ignore")
def test_panels_below_the_bound_are_flat_and_no_others(spheres: SphereMesh) -> None:
    heights = 1000 * rises(spheres)
    for bound in (0.0, *np.quantile(heights, [0.2, 0.7]), 1e4):
        found = flat_panels(spheres, flat_below=float(bound))
        assert np.array_equal(found.is_flattened, heights < bound)
        assert found.report["count"] == (heights < bound).sum()
        rows = found.sphere_mesh.local_spheres
        assert not rows[found.is_flattened, 0].any()
        kept = spheres.local_spheres[~found.is_flattened]
        assert rows[~found.is_flattened] == pytest.approx(kept, abs=1e-14)
    again = flat_panels(found.sphere_mesh, flat_below=1e4)
    assert again.report["count"] == 0
    with pytest.raises(InputError, match="not inf"):
        flat_panels(spheres, flat_below=float("inf"))


@pytest.mark.filterwarnings("ignore")
def test_the_curve_is_the_cost_of_each_number(spheres: SphereMesh, tmp_path: Path) -> None:
    counts = (1, 2, 5)
    bound = float(1000 * np.quantile(rises(spheres), 0.3))
    found = cost_curve(spheres, PRICES, counts, flat_below=bound, thickness=0.02)
    assert [row["moulds"] for row in found["rows"][:-1]] == list(counts)
    for row in found["rows"][:-1]:
        few = cluster_radii(spheres, row["moulds"])
        made = panels(few.sphere_mesh, thickness=0.02, labels=few.labels).panels
        assert row["total"] == pytest.approx(cost(made, prices=PRICES)["total"])
        assert row["mean_deg"] == few.report["angles_deg"]["mean"]
    assert found["rows"][-1]["moulds"] > 50
    assert found["rows"][-1]["parts"]["moulds"] == 1000 * found["rows"][-1]["moulds"]
    for row, flat in zip(found["rows"], found["flat_rows"], strict=True):
        assert flat["saved"] == pytest.approx(row["total"] - flat["total"])
        assert flat["saved"] > 0
        assert flat["flat_panels"] >= 0.2 * spheres.mesh.n_faces
    assert json.loads(json.dumps(dict(found), allow_nan=False))["currency"] == "EUR"
    path = tmp_path / "prices.toml"
    path.write_text(FILE, encoding="utf-8")
    assert (
        cost_curve(spheres, path, (2,))["rows"][0]
        == cost_curve(spheres, PRICES, (2,))["rows"][0]
    )
    with pytest.raises(InputError, match="of at least 1"):
        cost_curve(spheres, PRICES, (0, 3))


def test_flat_panels_that_cost_smoothness_say_so(spheres: SphereMesh) -> None:
    with pytest.warns(sm.nodes.NodeWarning, match="72 flat panels make neighbours meet at"):
        flat_panels(spheres, flat_below=1e4)


@pytest.mark.filterwarnings("ignore")
def test_a_flat_mould_is_none_of_those_counted() -> None:
    """Panels that are flat already, or for the workshop, leave so many moulds that curve."""
    mesh = roof_mesh(8, 9)
    smooth = minimize_angles(fit_spheres(mesh)).sphere_mesh
    middle = float(1000 * np.median(rises(smooth)))
    level = flat_panels(smooth, flat_below=middle).sphere_mesh
    for spheres, same in ((level, 0.0), (smooth, 0.2 * middle)):
        found = cost_curve(spheres, PRICES, (1, 2, 3), same_sagitta=same)
        assert [row["moulds"] for row in found["rows"][:-1]] == [1, 2, 3]
        assert found["rows"][0]["parts"]["moulds"] == 1000


def test_a_graph_prices_anew_when_the_file_changes(tmp_path: Path) -> None:
    path = tmp_path / "prices.toml"
    graph = sm.Graph()
    start = graph.add("fit_spheres", mesh=graph.add("roof_mesh", n_span=4, n_length=4))
    made = graph.add("panels", sphere_mesh=start)
    step = graph.add("cost", panels=made.panels, prices=str(path))
    totals = []
    for each in (5, 70):
        path.write_text(f"[panels]\neach = {each}\n[moulds]\neach = 0\n", encoding="utf-8")
        totals.append(graph.run(step)["total"])
    assert totals == [16 * 5, 16 * 70]


def test_what_has_no_price_is_said(spheres: SphereMesh) -> None:
    with pytest.warns(sm.nodes.NodeWarning, match="no price for moulds: the total is without"):
        cost(panels(spheres).panels, prices={"panels": {"each": 1}})


def panel(path: Path, out: Path, *options: str) -> Result:
    return CliRunner().invoke(main, ["panel", str(path), "-o", str(out), *options])


def test_the_job_prices_what_it_makes(tmp_path: Path) -> None:
    prices, roof = tmp_path / "prices.toml", write_mesh(roof_mesh(6, 7), tmp_path / "roof.obj")
    prices.write_text(FILE, encoding="utf-8")
    options = ("--prices", str(prices), "--moulds", "3", "--flat-below", "20")
    result = panel(roof, tmp_path / "out", *options)
    assert result.exit_code == 0, result.stderr
    report = json.loads((tmp_path / "out" / "report.json").read_text(encoding="utf-8"))
    found = report["cost"]
    assert found["total"] == pytest.approx(sum(found["parts"].values()))
    assert found["quantities"]["moulds"] <= 3
    assert f"cost {found['total']:,.0f} EUR (" in result.stdout
    one = panel(roof, tmp_path / "one", "--moulds", "1", "--flat-below", "2")
    assert one.exit_code == 2
    prices.write_text(FILE.replace("per_m2 = 50", "per_ft2 = 50"), encoding="utf-8")
    bad = panel(roof, tmp_path / "bad", "--prices", str(prices))
    assert bad.exit_code == 3
    assert bad.stderr.count("\n") == 1
    assert "unknown key 'per_ft2' in [blanks]" in bad.stderr
    assert not (tmp_path / "bad").exists()
