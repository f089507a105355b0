"""The nodes of hexagonal sphere meshes, as functions and in a graph."""

import json
import warnings

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.surfaces.circular_nets import catenoid_net, ellipsoid_net, torus_net
from spheremesh.nodes import NodeWarning
from spheremesh.nodes.library.congruence import sphere_congruence
from spheremesh.nodes.library.fabricate import panels
from spheremesh.nodes.library.shex import (
    classify_hexagons,
    evolve_spheres,
    shifted_rows,
    tangent_sphere_shex,
    tangent_spheres,
)


@pytest.fixture(scope="module")
def catenoid() -> Mesh:
    return shifted_rows(catenoid_net(44, 16, 1.0, 1.2))


@pytest.mark.parametrize(
    ("net", "offset"),
    [(catenoid_net(80, 16, 1.0, 1.2), 0.35), (ellipsoid_net(80, 16, 1.0, 1.6, 0.85), -0.35)],
    ids=["catenoid", "ellipsoid"],
)
def test_small_spheres_give_convex_hexagons_and_central_ones_bow_ties(
    net: Mesh, offset: float
) -> None:
    warnings.filterwarnings("ignore", "80 faces reach far", NodeWarning)
    mesh = shifted_rows(net)
    for spheres, shape in (
        (tangent_spheres(mesh, offset), "convex"),
        (sphere_congruence(mesh), "bow_tie"),
    ):
        made = tangent_sphere_shex(mesh, spheres)
        assert made.report["faces"] == made.report[shape] == 40 * 15
        assert made.report["imaginary"] == 0
        assert made.report["left_out"] == made.report["crossing_faces"] == []
        assert made.report["vertex_error"]["max"] < 1e-9
        assert set(classify_hexagons(made.sphere_mesh)) == {shape.replace("_", "-")}


def test_tangent_spheres_take_offsets_by_vertex_and_planes(catenoid: Mesh) -> None:
    offsets = np.linspace(0.2, 0.4, catenoid.n_vertices)
    rows = tangent_spheres(catenoid, offsets)
    np.testing.assert_allclose(rows[:, 0], 0.5 / offsets)
    assert (tangent_spheres(catenoid, float("inf"))[:, 0] == 0).all()


def test_evolution_reports_what_it_did() -> None:
    mesh = shifted_rows(torus_net(72, 16, 2.0, 0.8))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        grown = evolve_spheres(mesh, max_axis_angle=15)
        made = tangent_sphere_shex(grown.mesh, grown.spheres)
    report = grown.report
    assert report["converged"] is True
    assert report["side"] == "minus"
    assert report["axis_angle_deg"]["max"] < 15.5
    assert report["lambda_over_rho"]["mean"] > 0.8
    assert report["bad_faces"] == report["tilted_triangles"] == report["outer_vertices"] == []
    assert report["flips"] > 0
    assert sum(report["valences"].values()) == 576
    irregular = sum(len(ids) for ids in report["irregular"].values())
    assert irregular == 576 - report["valences"]["6"] > 0
    assert made.report["convex"] == made.report["faces"] == 576
    assert made.report["degrees"] == report["valences"]
    json.dumps([dict(report), dict(made.report)], allow_nan=False)
    cut = panels(made.sphere_mesh, edges="intersection")
    assert cut.report["written"] == 576


def test_bad_faces_are_listed_and_warned_of(catenoid: Mesh) -> None:
    spheres = tangent_spheres(catenoid, 0.75)
    with pytest.warns(NodeWarning) as caught:
        made = tangent_sphere_shex(catenoid, spheres)
    texts = " ".join(str(warning.message) for warning in caught)
    report = made.report
    assert report["crossing"] == len(report["crossing_faces"]) > 0
    assert "cross themselves" in texts
    assert ("left out" in texts) == bool(report["left_out"])
    labels = classify_hexagons(made.sphere_mesh)
    for entry in report["crossing_faces"]:
        assert labels[entry["face"]] == "crossing"
        assert report["vertex_ids"][entry["face"]] == entry["vertex"]
    listed = {entry["vertex"] for entry in report["left_out"]}
    inner = np.flatnonzero(~catenoid.topology.is_boundary_vertex).tolist()
    assert listed | set(report["vertex_ids"]) == set(inner)
    json.dumps(dict(report), allow_nan=False)


def test_corners_far_beyond_the_boundary_are_listed() -> None:
    """A triangle on the rim of a flat sheet with an angle of 160 degrees."""
    turns = np.radians([0.0, 160.0, 260.0])
    rim = np.stack([np.cos(turns), np.sin(turns), 0 * turns], 1)
    mesh = Mesh(np.vstack([rim, np.zeros(3)]), [[0, 1, 3], [1, 2, 3], [2, 0, 3]])
    with pytest.warns(NodeWarning, match="1 faces reach far beyond the boundary"):
        made = tangent_sphere_shex(mesh, tangent_spheres(mesh, 20.0))
    assert made.report["far_corners"] == [{"face": 0, "vertex": 3}]


def test_a_hopeless_mesh_is_told_not_refused() -> None:
    mesh = shifted_rows(catenoid_net(16, 40, 1.0, 1.0))
    with pytest.warns(NodeWarning):
        grown = evolve_spheres(mesh)
    assert len(grown.report["bad_faces"]) > 0
    assert grown.report["converged"] is False


def test_what_evolution_cannot_reach_is_told(catenoid: Mesh) -> None:
    with pytest.warns(NodeWarning, match="node axes tilt by more than 0.2 degrees"):
        grown = evolve_spheres(catenoid, max_axis_angle=0.2)
    assert grown.report["converged"] is False
    assert len(grown.report["tilted_triangles"]) > 0
    dome = shifted_rows(ellipsoid_net(32, 12, 1.0, 1.6, 0.85))
    with pytest.warns(NodeWarning, match="bends away from the centres"):
        grown = evolve_spheres(dome, side="plus")
    assert len(grown.report["outer_vertices"]) == dome.n_vertices


def test_clipped_faces() -> None:
    dome = shifted_rows(ellipsoid_net(72, 16, 1.0, 1.6, 0.85))
    spheres = tangent_spheres(dome, -0.35)
    dropped = tangent_sphere_shex(dome, spheres)
    clipped = tangent_sphere_shex(dome, spheres, boundary="clip")
    assert dropped.report["faces"] == 36 * 15
    assert clipped.report["faces"] == dome.n_vertices == 36 * 17
    assert clipped.report["vertex_error"]["max"] < 1e-9
    assert clipped.report["crossing"] == 0
