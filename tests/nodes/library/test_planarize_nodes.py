"""Planarisation as a node: its report, its warnings, and what it refuses."""

import json

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.congruences.curvature_spheres import sphere_congruence
from spheremesh.kernel.errors import ConvergenceError
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.remesh.field.conjugate_directions import conjugate_directions
from spheremesh.kernel.remesh.planar import planarize
from spheremesh.kernel.surfaces.triangulated import triangulated_surface
from spheremesh.nodes import planarize_p4, relax_congruence
from spheremesh.nodes.library.input import torus_mesh
from spheremesh.nodes.library.spheres import central_spheres, face_planes


def shaken(size: float) -> SphereMesh:
    """Central spheres of a torus, with vertices moved and curvatures changed."""
    net = central_spheres(torus_mesh(16, 10, 3.0, 1.0))
    rng = np.random.default_rng(0)
    moves = size * mean_edge_length(net.mesh) * rng.normal(size=net.mesh.vertices.shape)
    rows = net.local_spheres.copy()
    rows[:, 0] *= 1 + size * rng.normal(size=len(rows))
    return SphereMesh.from_local(Mesh(net.mesh.vertices + moves, net.mesh.faces), rows)


def test_the_report_says_what_was_reached() -> None:
    start = shaken(0.01)
    result = planarize_p4(start)
    report = json.loads(json.dumps(dict(result.report), allow_nan=False))
    assert report["status"] == "converged"
    assert 2 < report["iterations"] < 30
    assert report["planarity"]["before"] > 1e-4
    assert report["planarity"]["after"] < 1e-9
    assert report["corner_gap"]["before"] > 1e-3
    assert report["corner_gap"]["after"] < 1e-6
    assert report["real_nodes"]["after"] == 1
    angles = report["axis_angles_deg"]
    assert 0 < angles["p95"] <= angles["max"] <= 90
    moved = report["moved"]
    assert 0.001 < moved["mean"] < moved["max"] < 0.2
    assert report["nodes_without_axis"] == []


def test_planes_stay_and_have_no_axes() -> None:
    start = face_planes(torus_mesh(12, 6, 3.0, 1.0))
    with pytest.warns(UserWarning, match="have no axis"):
        result = planarize_p4(start)
    assert result.report["axis_angles_deg"] == {"p95": None, "max": None}
    assert len(result.report["nodes_without_axis"]) == start.mesh.n_vertices
    np.testing.assert_array_equal(result.sphere_mesh.mesh.vertices, start.mesh.vertices)


def test_too_few_steps_are_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(planarize, "STEPS", 2)
    with pytest.raises(ConvergenceError, match="not free of torsion after 2 steps"):
        planarize_p4(shaken(0.05))


def test_central_spheres_of_a_bump_are_relaxed() -> None:
    mesh, _ = triangulated_surface("bump", 0.1)
    spheres, _ = sphere_congruence(mesh, "central")
    result = relax_congruence(mesh, spheres)
    report = json.loads(json.dumps(dict(result.report), allow_nan=False))
    assert report["complex_share"]["before"] > 0.2
    assert report["complex_share"]["after"] <= 0.02
    assert report["axis_angle_p95_deg"]["before"] > 60
    assert report["axis_angle_p95_deg"]["after"] <= 20
    assert 0 < report["blend"] < 1
    share = conjugate_directions(mesh, result.spheres).complex_share
    assert share == report["complex_share"]["after"]
