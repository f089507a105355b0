"""The nodes of remeshing: reports for people, warnings, and use in a graph."""

import json
import warnings

import numpy as np
import pytest

import spheremesh as sm
from spheremesh.kernel.arrays import norm
from spheremesh.kernel.errors import InputError
from spheremesh.nodes import (
    NodeWarning,
    conjugate_directions,
    p4_remesh,
    relax_congruence,
    sphere_congruence,
    torus_mesh,
    triangulated_surface,
)


def test_directions_come_with_a_report_of_what_to_expect() -> None:
    surface = triangulated_surface("hypar", 0.15, seed=1)
    spheres = sphere_congruence(surface.mesh, "tangent", 0.5)
    found = conjugate_directions(surface.mesh, spheres)
    assert found.directions.shape == (surface.mesh.n_vertices, 2, 3)
    np.testing.assert_allclose(norm(found.directions), 1)
    assert found.is_real.shape == (surface.mesh.n_vertices,)
    report = json.loads(json.dumps(dict(found.report), allow_nan=False))
    assert report["complex_share"] < 0.02
    assert report["largest_edge"] == pytest.approx(np.sqrt(2) * 0.5)
    assert report["radius_to_edge"]["min"] == pytest.approx(0.5 / 0.17, rel=0.2)
    assert 0 < report["node_axis_deg"]["median"] < 10


def test_planes_determine_no_directions() -> None:
    surface = triangulated_surface("hypar", 0.2)
    spheres = sphere_congruence(surface.mesh, "tangent", np.inf)
    with pytest.raises(ValueError, match="they are planes"):
        conjugate_directions(surface.mesh, spheres)


def test_a_few_planes_among_spheres_are_infinite_radii_in_the_report() -> None:
    surface = triangulated_surface("hypar", 0.2)
    x = surface.mesh.vertices[:, 0]
    with np.errstate(divide="ignore"):
        offset = 1 / np.where(np.abs(x) < 0.1, 0.0, x**2)
    spheres = sphere_congruence(surface.mesh, "tangent", offset)
    assert (spheres[:, 0] == 0).any()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        report = conjugate_directions(surface.mesh, spheres).report
    json.dumps(dict(report), allow_nan=False)
    assert report["radius_to_edge"]["median"] is not None


def test_a_net_and_its_report() -> None:
    surface = triangulated_surface("annulus", 0.12, seed=1)
    spheres = sphere_congruence(surface.mesh, "tangent", 0.5)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        net, report = p4_remesh(surface.mesh, spheres, 0.25)
    report = json.loads(json.dumps(dict(report), allow_nan=False))
    assert report["faces"]["count"] == net.mesh.n_faces
    assert report["faces"]["degrees"] == {"4": net.mesh.n_faces}
    assert report["irregular_nodes"] == report["flipped"] == 0
    assert report["singular"] == []
    assert report["aligned_sides"] == 2
    assert report["edges"]["target"] == 0.25
    assert report["edges"]["mean"] == pytest.approx(0.25, rel=0.1)
    assert 0 < report["edges"]["min"] < report["edges"]["mean"]
    assert report["radius_to_edge"]["min"] == pytest.approx(2)
    assert report["planarized"]["planarity"]["after"] < 1e-8
    assert report["planarized"]["corner_gap"]["after"] < 1e-6
    assert report["planarized"]["real_nodes"]["after"] == 1
    assert report["distance"]["nodes"] < 1e-3
    assert report["distance"]["boundary_nodes"] < 0.03
    assert 0.01 < report["distance"]["panels_p95"] <= report["distance"]["panels"] < 0.3


def test_complex_directions_are_said_with_their_share() -> None:
    surface = triangulated_surface("bump", 0.12, seed=1)
    spheres = sphere_congruence(surface.mesh, "central")
    with pytest.warns(NodeWarning, match=r"complex on [0-9.]+ % of the area"):
        report = conjugate_directions(surface.mesh, spheres).report
    assert report["complex_share"] > 0.05
    with pytest.warns(NodeWarning) as caught:
        again = p4_remesh(surface.mesh, spheres, 0.3).report
    assert again["complex_share"] == pytest.approx(report["complex_share"])
    assert again["moved_share"] > 0
    texts = " ".join(str(entry.message) for entry in caught)
    assert "less than 20 degrees" in texts


def test_a_mesh_coarser_than_the_net_is_said() -> None:
    surface = triangulated_surface("hypar", 0.25)
    spheres = sphere_congruence(surface.mesh, "tangent", 0.7)
    with pytest.warns(NodeWarning, match="coarser than the net"):
        p4_remesh(surface.mesh, spheres, 0.15)


def test_remeshing_in_a_graph() -> None:
    graph = sm.Graph("net")
    surface = graph.add(triangulated_surface, shape="hypar", edge_length=0.2)
    spheres = graph.add(sphere_congruence, mesh=surface.mesh, kind="tangent", offset=0.5)
    net = graph.add(p4_remesh, mesh=surface.mesh, spheres=spheres, edge_length=0.4)
    assert graph.run(net.sphere_mesh).mesh.n_faces >= 16


def test_small_spheres_and_leaning_axes_are_said() -> None:
    surface = triangulated_surface("hypar", 0.2)
    small = sphere_congruence(surface.mesh, "tangent", 0.25)
    with pytest.warns(NodeWarning, match=r"100 % of the vertices have radii below 0\.283"):
        p4_remesh(surface.mesh, small, 0.4)
    x = surface.mesh.vertices[:, 0]
    leaning = sphere_congruence(surface.mesh, "tangent", 0.8 + 0.4 * x)
    with pytest.warns(NodeWarning, match="lean from .* relax_congruence"):
        p4_remesh(surface.mesh, leaning, 0.4)


def test_nets_that_fall_together_are_said() -> None:
    """Spheres much smaller than the steps of the net do not meet around its nodes."""
    surface = triangulated_surface("waves", 0.12, seed=1)
    spheres = sphere_congruence(surface.mesh, "tangent", 0.08)
    with pytest.warns(NodeWarning) as caught:
        report = p4_remesh(surface.mesh, spheres, 0.3).report
    texts = " ".join(str(entry.message) for entry in caught)
    assert "radii below" in texts
    planar = report["planarized"]
    assert planar is None or planar["shortest_edge"]["after"] < 0.2
    assert "the shortest edge measures" in texts or "keeps some torsion" in texts


def strip(n: int, twists: int) -> list[list[int]]:
    """Triangles of a band, closed after half turns."""
    heads = [[0, 1], [1, 0]][twists % 2]
    ends = [*([2 * i, 2 * i + 1] for i in range(1, n)), heads]
    starts = [[2 * i, 2 * i + 1] for i in range(n)]
    pairs = zip(starts, ends, strict=True)
    return [t for (a, b), (c, d) in pairs for t in ([a, c, d], [a, d, b])]


def test_a_mesh_that_cannot_be_remeshed_is_one_clear_error() -> None:
    mesh = triangulated_surface("hypar", 0.3).mesh
    spheres = sphere_congruence(mesh, "tangent", 0.7)
    quads = torus_mesh(12, 8)
    around = sphere_congruence(quads, "tangent", -0.5)
    shifted = mesh.vertices + np.array([9.0, 0, 0])
    faces = mesh.corners.reshape(-1, 3)
    two = sm.Mesh(
        np.concatenate([mesh.vertices, shifted]), np.concatenate([faces, faces + len(shifted)])
    )
    imaginary = spheres.copy()
    imaginary[[3, 7]] = [1.0, 0, 0, 0, 50.0]
    cases = [
        (quads, around, "no triangles: triangulate the mesh first"),
        (mesh, imaginary, r"vertices \[3, 7\] are imaginary"),
        (two, np.tile(spheres, (2, 1)), "2 separate pieces: remesh them one by one"),
    ]
    for given, rows, words in cases:
        with pytest.raises(InputError, match=words):
            p4_remesh(given, rows, 0.5)
        with pytest.raises(InputError, match=words):
            conjugate_directions(given, rows)
    band = np.random.default_rng(1).normal(size=(12, 3))
    assert sm.Mesh(band, strip(6, 0)).n_faces == 12
    with pytest.raises(InputError, match="the mesh is non-orientable"):
        sm.Mesh(band, strip(6, 1))


def test_bad_input_is_one_clear_error() -> None:
    surface = triangulated_surface("hypar", 0.3)
    spheres = sphere_congruence(surface.mesh, "tangent", 0.7)
    with pytest.raises(ValueError, match="too large for the surface"):
        p4_remesh(surface.mesh, spheres, 5.0)
    with pytest.raises(ValueError, match="too large"):
        triangulated_surface("hypar", 2.0)
    with pytest.raises(ValueError, match="shape must be one of"):
        triangulated_surface("moebius", 0.1)


def test_holes_that_the_net_covers_are_said() -> None:
    mesh = triangulated_surface("hypar", 0.2, seed=1).mesh
    triangles = mesh.corners.reshape(-1, 3)
    centers = mesh.vertices[triangles].mean(axis=1)[:, :2]
    hole = int(norm(centers - [0.03, 0.28]).argmin())
    holed = sm.Mesh(mesh.vertices, np.delete(triangles, hole, axis=0))
    spheres = sphere_congruence(holed, "tangent", 0.9)
    with pytest.warns(NodeWarning, match="covers 1 of the holes"):
        assert p4_remesh(holed, spheres, 0.4).report["covered_holes"] == 1


def test_edges_in_the_report_are_those_of_the_net() -> None:
    surface = triangulated_surface("hypar", 0.12, seed=1)
    spheres = sphere_congruence(surface.mesh, "tangent", 0.6)
    net, report = p4_remesh(surface.mesh, spheres, 0.25)
    corners, following = net.mesh.corners, net.mesh.topology.next_corners
    ends = net.mesh.vertices[corners[following]]
    shortest = norm(ends - net.mesh.vertices[corners]).min()
    assert report["edges"]["min"] == pytest.approx(shortest, rel=1e-12)
    after = report["planarized"]["shortest_edge"]["after"]
    assert shortest == pytest.approx(after * report["edges"]["mean"], rel=1e-12)


def test_spheres_too_small_to_blend_are_one_clear_error() -> None:
    surface = triangulated_surface("hypar", 0.12, seed=1)
    tiny = sphere_congruence(surface.mesh, "tangent", 0.02)
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        with pytest.raises(InputError, match=r"so small.*choose larger spheres"):
            p4_remesh(surface.mesh, tiny, 0.25)


def test_planes_relax_to_spheres_that_have_a_net() -> None:
    surface = triangulated_surface("bump", 0.12, seed=1)
    planes = sphere_congruence(surface.mesh, "tangent", np.inf)
    relaxed = relax_congruence(surface.mesh, planes)
    assert relaxed.report["complex_share"]["before"] == 1
    assert relaxed.report["axis_angle_p95_deg"]["before"] == pytest.approx(90)
    assert 0 < relaxed.report["blend"] < 0.1
    assert conjugate_directions(surface.mesh, relaxed.spheres).report["complex_share"] <= 0.02


def spherical_cap() -> sm.Mesh:
    flat = triangulated_surface("hypar", 0.1, seed=1).mesh
    x, y, _ = flat.vertices.T
    return sm.Mesh(np.stack([x, y, np.sqrt(4 - x * x - y * y)], 1), flat.faces)


def test_spheres_that_do_not_tell_directions_are_said() -> None:
    cap = spherical_cap()
    spheres = sphere_congruence(cap, "tangent", -0.5)
    with pytest.warns(NodeWarning, match="on 100 % of the area the spheres do not determine"):
        assert conjugate_directions(cap, spheres).report["umbilic_share"] == 1
    with pytest.warns(NodeWarning, match="set smoothing to 5 or more"):
        _, report = p4_remesh(cap, spheres, 0.24, smoothing=5)
    assert report["singular"] == []
    assert report["irregular_nodes"] == 0
    assert report["distance"]["nodes"] < 0.01
    # Half way to a cylinder they do.
    bent = sm.Mesh(cap.vertices * [1, 0.7, 1], cap.faces)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = conjugate_directions(bent, sphere_congruence(bent, "tangent", -0.5))
    assert found.report["umbilic_share"] < 0.01
