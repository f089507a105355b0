"""The node `exact_support`, what follows it, and the main job with it."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from spheremesh import Mesh
from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.interfaces.cli import main
from spheremesh.nodes import (
    axis_support,
    beams,
    cluster_radii,
    common_axes,
    exact_support,
    panels,
)
from spheremesh.nodes.graphs.node import NodeWarning
from spheremesh.nodes.library.support.exact import ExactSupport


def dome(n: int = 4, m: int = 5, shear: float = 0.1) -> Mesh:
    """A net on an elliptic paraboloid, off its lines of curvature; edges of about a metre."""
    u, v = np.meshgrid(np.linspace(-2, 2, n + 1), np.linspace(-2, 2, m + 1), indexing="ij")
    x, y = (u + shear * v).ravel(), (v + 0.5 * shear * u).ravel()
    vertices = np.stack([x, y, -0.11 * x**2 - 0.15 * y**2], 1)
    ids = np.arange(len(x)).reshape(n + 1, m + 1)
    quads = [ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]]
    return Mesh(vertices, np.stack(quads, -1).reshape(-1, 4))


def folded(n: int = 4) -> Mesh:
    """Skew ridges without any sense: no net near it has common axes and stays a net."""
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij")
    z = 0.9 * np.random.default_rng(2).uniform(-1, 1, x.size)
    ids = np.arange(x.size).reshape(n + 1, n + 1)
    quads = [ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]]
    return Mesh(np.stack([x.ravel(), y.ravel(), z], 1), np.stack(quads, -1).reshape(-1, 4))


@pytest.fixture(scope="module")
def found() -> ExactSupport:
    return exact_support(dome())


def test_the_report_says_what_was_found(found: ExactSupport) -> None:
    report = found.report
    assert report.verdict == "feasible"
    assert report.landed
    assert report.converged
    assert not report.reason
    assert report.torsion_deg["max"] < 1e-9
    assert report.gap["relative_to_edge"] < 1e-10
    assert report.height["max"] <= 0.06
    assert report.slide["max"] <= 0.7
    assert report.design_move["height"] == report.height["max"]
    assert report.design_move["relative_to_edge"] >= report.slide["max"] - 1e-12
    assert report.angles_deg["spherical"]["mean"] < report.angles_deg["planar"]["mean"]
    assert json.loads(json.dumps(dict(report)))["attempts"][0]["landed"]


def test_panels_and_beams_of_it_are_whole(found: ExactSupport) -> None:
    spheres = found.sphere_mesh
    annuli, axes, report = axis_support(spheres, depth=0.2, axes=common_axes(spheres))
    assert report.torsion_deg["max"] < 1e-9
    assert max(report.gap.values()) < 1e-10
    cut = panels(spheres, edges="axis", axes=axes, thickness=0.02)
    assert cut.report["written"] == spheres.mesh.n_faces
    assert cut.report["edge_gap"]["relative_to_edge"] < 1e-10
    made = beams(annuli, thickness=0.02)
    assert made.report["rejected"] == []


def test_few_moulds_keep_the_planes_of_the_beams(found: ExactSupport) -> None:
    spheres = found.sphere_mesh
    moulds = cluster_radii(spheres, k=2, same_sagitta=0.0)
    report = axis_support(moulds.sphere_mesh, axes=common_axes(spheres)).report
    assert report.torsion_deg["max"] < 1e-9
    assert report.gap["max"] < 0.02


def test_one_radius_is_one_mould_as_it_is() -> None:
    spheres, report = exact_support(dome(3, 4), one_radius=True)
    assert report.verdict == "feasible"
    low, high = report.radii["min"], report.radii["max"]
    assert low is not None
    assert high is not None
    assert high / low - 1 <= 1e-12
    moulds = cluster_radii(spheres, k=1)
    assert moulds.sphere_mesh is spheres
    assert moulds.report["panels_per_mould"] == [spheres.mesh.n_faces]
    np.testing.assert_allclose(moulds.radii, [low], rtol=1e-12)


def test_where_there_is_none_panels_stay_flat_and_the_reason_is_told() -> None:
    mesh = folded()
    with pytest.warns(NodeWarning, match=r"no exact support: .*axis_support") as caught:
        found = exact_support(mesh)
    assert len(caught) == 1
    assert found.report.verdict == "no"
    assert not found.report.landed
    np.testing.assert_array_equal(found.sphere_mesh.mesh.vertices, mesh.vertices)
    np.testing.assert_array_equal(found.sphere_mesh.local_spheres[:, 0], 0)


def panel(*arguments: str | Path) -> Result:
    return CliRunner().invoke(main, ["panel", *map(str, arguments)])


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_mesh(dome(), tmp_path_factory.mktemp("exact") / "dome.obj")


@pytest.mark.parametrize("moulds", [[], ["--moulds", "1"]])
def test_the_main_job_writes_an_exact_support(
    file: Path, tmp_path: Path, moulds: list[str]
) -> None:
    result = panel(
        file, "-o", tmp_path / "out", "--support", "exact", "--thickness", "0.01", "--json",
        *moulds,
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    report = json.loads(result.stdout)
    assert report["support"]["kind"] == "exact"
    assert report["support"]["landed"]
    assert report["support"]["torsion_deg_max"] < 1e-9
    assert report["edge_gap"]["relative_to_edge"] < 1e-9
    assert report["panels"]["rejected"] == []
    assert report["beams"]["rejected"] == []
    assert set(report["design_move"]) == {"max", "relative_to_edge", "height", "slide"}
    assert report["moulds"]["count"] == len(moulds) / 2


def test_bounds_go_with_exact_supports_alone(file: Path, tmp_path: Path) -> None:
    for arguments, text in (
        (["--max-slide", "0.5"], "--max-slide bounds --support exact"),
        (["--support", "exact", "--tolerance", "0.1"], "--max-height and --max-slide"),
        (["--support", "exact", "--target-angle", "5"], "--target-angle does not go with"),
    ):
        result = panel(file, "-o", tmp_path / "out", *arguments)
        assert result.exit_code == 2
        assert text in " ".join(result.stderr.split())


def test_a_job_without_exact_support_ends_with_the_reason(tmp_path: Path) -> None:
    file = write_mesh(folded(), tmp_path / "folded.obj")
    result = panel(file, "-o", tmp_path / "out", "--support", "exact")
    assert result.exit_code == 4
    assert "no exact support" in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1
    assert not (tmp_path / "out" / "panels.step").exists()


def test_triangles_are_refused_by_the_job(tmp_path: Path) -> None:
    net = dome()
    split = [part for a, b, c, d in net.faces for part in ([a, b, c], [a, c, d])]
    file = write_mesh(Mesh(net.vertices, split), tmp_path / "triangles.obj")
    result = panel(file, "-o", tmp_path / "out", "--support", "exact")
    assert result.exit_code == 3
    assert "triangles" in result.stderr
