"""The kinds of support of the main job: how they are asked for, and what becomes of them."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.interfaces.cli import main
from spheremesh.interfaces.option_values import spell_support
from spheremesh.interfaces.panel import PanelOptions, feasible_panel_graph, run_job
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import Mesh, mean_edge_length
from spheremesh.kernel.meshes.triangulation import triangulate
from spheremesh.kernel.surfaces.circular_nets import vase_net
from spheremesh.nodes import ellipsoid_mesh, evolve_spheres, roof_mesh, tangent_sphere_shex


def grid(heights: Any) -> Mesh:  # noqa: ANN401
    n, m = heights.shape
    x, y = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    ids = np.arange(n * m).reshape(n, m)
    faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], 2)
    return Mesh(np.stack([x, y, heights], 2).reshape(-1, 3), faces.reshape(-1, 4))


@pytest.fixture(scope="module")
def vase(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("vase") / "vase.obj"
    return write_mesh(vase_net(12, 6, 1.0, 2.0, 0.3), path)


@pytest.fixture(scope="module")
def bumps(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Triangles on which no axes please the edges."""
    x, y = np.meshgrid(np.arange(7.0), np.arange(7.0), indexing="ij")
    mesh = triangulate(grid(4.0 * np.exp(-((x - 3) ** 2 + (y - 3) ** 2) / 4)))
    return write_mesh(mesh, tmp_path_factory.mktemp("bumps") / "bumps.obj")


def panel(*arguments: str | Path) -> Result:
    return CliRunner().invoke(main, ["panel", *map(str, arguments)])


def report_of(mesh: Path, **options: Any) -> dict[str, Any]:  # noqa: ANN401
    allowed = {"allow_step": 200.0, "allow_gap": 200.0}  # of edges of about a metre
    graph = feasible_panel_graph(PanelOptions(mesh=mesh, **{**allowed, **options}))
    report = graph.run("report")
    texts = [text for messages in graph.messages.values() for text in messages]
    return {**report, "warnings": texts}


# Nodes warn, and the messages of the graph are what is looked at here.
pytestmark = pytest.mark.filterwarnings("ignore::spheremesh.nodes.graphs.node.NodeWarning")


# How they are asked for


@pytest.mark.parametrize(
    ("given", "spelt"),
    [
        (["--support"], ["--support=axis"]),
        (["--support", "roof.obj"], ["--support=axis", "roof.obj"]),
        (["--support", "bisector", "roof.obj"], ["--support=bisector", "roof.obj"]),
        (["--support", "--depth", "1"], ["--support=axis", "--depth", "1"]),
        (["--support=exact", "axis"], ["--support=exact", "axis"]),
        (["--", "--support", "axis"], ["--", "--support", "axis"]),
    ],
)
def test_support_takes_a_word_of_its_own_alone(given: list[str], spelt: list[str]) -> None:
    assert spell_support(given) == spelt


def test_the_mesh_may_follow_support(vase: Path, tmp_path: Path) -> None:
    result = panel("-o", tmp_path / "out", "--support", vase, "--json")
    assert result.exit_code == 0, result.stderr
    report = json.loads(result.stdout)
    assert report["input"]["faces"] == 72
    assert report["support"]["kind"] == "axis"
    assert "support feasible: beams on node axes tilt" not in result.stderr


@pytest.mark.parametrize("kind", ["axis", "exact", "bisector"])
def test_edges_and_support_are_one_question(vase: Path, tmp_path: Path, kind: str) -> None:
    result = panel(vase, "-o", tmp_path / "out", "--support", kind, "--edges", "bisector")
    assert result.exit_code == 2
    assert "--edges and --support exclude each other" in result.stderr
    assert not (tmp_path / "out").exists()


def test_other_words_after_an_equals_sign_are_refused(vase: Path, tmp_path: Path) -> None:
    assert panel(vase, "-o", tmp_path / "out", "--support=beams").exit_code == 2


# What becomes of them


@pytest.mark.parametrize("kind", ["axis", "bisector"])
def test_moulds_do_not_move_beams(vase: Path, kind: str) -> None:
    few, many = (report_of(vase, support=kind, moulds=k) for k in (1, None))
    assert few["support"]["torsion_deg_max"] == pytest.approx(
        # upright beams of the boundary follow the spheres of their faces
        many["support"]["torsion_deg_max"],
        abs=1e-9 if kind == "axis" else 0.01,
    )
    assert few["support"]["beam_tilt_deg_p95"] == pytest.approx(
        many["support"]["beam_tilt_deg_p95"], abs=1e-6
    )
    for report in (few, many):
        assert report["support"]["kind"] == kind
        assert report["panels"] == {"written": 72, "rejected": []}
        assert report["beams"] == {"written": 156, "rejected": []}
        assert report["audit"]["errors"] == []
        assert report["support"]["feasibility"]["verdict"] == "feasible"


def test_where_no_axes_stand_beams_are_upright_and_it_is_said(bumps: Path) -> None:
    report = report_of(bumps, support="axis", moulds=4, thickness=0.05)
    assert report["support"]["feasibility"]["verdict"] == "no"
    assert report["support"]["asked"] == "axis"
    assert report["support"]["kind"] == "bisector"
    assert report["support"]["node_radius"] > 0
    assert report["support"]["beam_tilt_deg_max"] < 1e-6
    assert report["beams"]["rejected"] == report["panels"]["rejected"] == []
    assert report["audit"]["errors"] == []
    said = [text for text in report["warnings"] if text.startswith("support no")]
    assert len(said) == 1
    assert "Lemma 5.1" in said[0]
    assert "upright beams with node cylinders instead" in said[0]


def test_upright_beams_that_were_asked_for_are_no_matter_of_a_warning(bumps: Path) -> None:
    report = report_of(bumps, support="bisector")
    assert report["support"]["asked"] == "bisector"
    assert not any(text.startswith("support") for text in report["warnings"])


def test_beams_on_top_of_panels_are_said(tmp_path: Path) -> None:
    roof = roof_mesh(4, 6)
    over = Mesh(roof.vertices, [face[::-1] for face in roof.faces])
    for mesh, is_said in ((roof, False), (over, True), (vase_net(12, 6, 1.0, 2.0, 0.3), False)):
        path = write_mesh(mesh, tmp_path / "mesh.obj")
        warned = report_of(path, support="axis")["warnings"]
        assert any("on top of the panels" in text for text in warned) == is_said
        plain = report_of(path, moulds=3)["warnings"]
        assert not any("on top of the panels" in text for text in plain)


@pytest.mark.parametrize("moulds", [None, 2])
def test_hexagons_keep_their_exact_nodes(tmp_path: Path, moulds: int | None) -> None:
    """The spheres of the file stay, and beams stand where they meet; moulds open gaps alone."""
    grown = evolve_spheres(triangulate(ellipsoid_mesh(12, 6)))
    hexagons = tangent_sphere_shex(grown.mesh, grown.spheres).sphere_mesh
    path = write_mesh(hexagons.mesh, tmp_path / "hexagons.obj")
    report = report_of(path, support="axis", moulds=moulds, repair=moulds is None)
    assert report["support"]["torsion_deg_max"] < 1e-3
    assert report["support"]["beam_tilt_deg_p95"] < 15
    if moulds is None:
        assert report["edge_gap"]["relative_to_edge"] < 1e-9
    said = [text for text in report["warnings"] if "spheres with exact nodes" in text]
    rougher = (
        report["angles_deg"].get("unclustered", report["angles_deg"]["spherical"])["mean"]
        > report["angles_deg"]["planar"]["mean"]
    )
    assert bool(said) == rougher


def test_a_given_node_radius_is_taken(bumps: Path) -> None:
    graph = feasible_panel_graph(PanelOptions(mesh=bumps, support="bisector", node_radius=0.2))
    assert graph.run("beams.beams").node_radius == 0.2


def test_nothing_is_written_where_neither_kind_can_be_made(tmp_path: Path) -> None:
    """A crumpled sheet: its beams cannot stand on axes, and many not upright either."""
    rng = np.random.default_rng(2)
    path = write_mesh(grid(2.5 * rng.normal(size=(7, 7))), tmp_path / "crumpled.obj")
    options = PanelOptions(mesh=path, support="axis")
    graph = feasible_panel_graph(options)
    with pytest.raises(InputError, match="no support for this mesh: beams on node axes tilt"):
        run_job(graph, tmp_path / "out", lambda _step, _state: None)
    assert not (tmp_path / "out").exists()


def test_beams_know_no_units(tmp_path: Path) -> None:
    """The same roof in metres and in feet: the same shape, to the last digits but a few."""
    roof = roof_mesh(6, 8)
    found: list[dict[str, Any]] = []
    for factor, units in ((1.0, "m"), (1 / 0.3048, "ft")):
        path = tmp_path / f"roof_{units}.obj"
        write_mesh(Mesh(factor * roof.vertices, roof.faces), path)
        size = factor * mean_edge_length(roof)
        report = report_of(
            path, support="axis", moulds=3, units=units, depth=size / 4, thickness=size / 50
        )
        report["moulds"]["radii"] = [radius / factor for radius in report["moulds"]["radii"]]
        found.append(report)
    np.testing.assert_allclose(
        found[0]["moulds"]["radii"], found[1]["moulds"]["radii"], rtol=1e-6
    )
    for key in ("torsion_deg_max", "beam_tilt_deg_p95", "lean_deg_max"):
        assert found[0]["support"][key] == pytest.approx(found[1]["support"][key], rel=1e-6)
