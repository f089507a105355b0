"""Triangulated beams: closed, on their arcs, and as large as the beams."""

from collections import Counter

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, dot, norm
from spheremesh.kernel.beams.beams import Beams, section_arcs
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.beams.triangles import beam_triangles, cylinder_triangles
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.spheres.arcs import arc_lengths, segment_areas
from spheremesh.kernel.spheres.incidence import evaluate
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import roof_net, torus_net


def make(sphere_mesh: SphereMesh, kappa: float | None = None) -> Beams:
    size = mean_edge_length(sphere_mesh.mesh)
    depth = 0.3 * size if kappa is None else None
    power = None if kappa is None else kappa * size**2
    annuli = annulus_support(sphere_mesh, depth, power).annuli
    return cut_beams(annuli, 0.05 * size)[0]


TORUS = central_spheres(torus_net(7, 5, 3.0, 1.0))
CASES = {
    "round": make(TORUS),
    "to the outer side": make(TORUS, -0.2),
    "straight": make(face_planes(roof_net(4, 3, 40.0))),
    "1 mm": make(central_spheres(torus_net(7, 5, 5e-4, 1.5e-4))),
}


def prism_volumes(beams: Beams) -> FloatArray:
    """Section between chords and arcs, times the thickness."""
    outer, inner = section_arcs(beams)
    rim = [outer.starts, outer.ends, inner.ends, inner.starts]
    quad = np.cross(rim[2] - rim[0], rim[3] - rim[1]) / 2
    up = beams.annuli.frames[:, 1]
    outside = np.sign(dot(outer.starts + outer.ends - inner.starts - inner.ends, up))
    bulges = [
        np.sign(dot(arcs.rises, up) * arcs.sagittas) * np.abs(segment_areas(arcs))
        for arcs in (outer, inner)
    ]
    return (norm(quad) + outside * (bulges[0] - bulges[1])) * beams.thickness


@pytest.mark.parametrize("case", CASES)
def test_triangles_close_up_and_hold_the_volume(case: str) -> None:
    beams = CASES[case]
    found = np.zeros(beams.n_beams)
    for group in beam_triangles(beams, 1e-3):
        corners = group.points[:, group.triangles]
        middle = group.points.mean(1)[:, None, None]
        a, b, c = (corners - middle).transpose(2, 0, 1, 3)
        found[group.beams] += dot(a, np.cross(b, c)).sum(1) / 6
        areas = np.cross(b - a, c - a)
        assert (dot(areas, group.normals[:, group.triangles[:, 0]]) > 0).all()
        assert np.abs(norm(group.normals) - 1).max() < 1e-12
        # Every edge between two points of space is met once each way.
        size = float(arc_lengths(section_arcs(beams)[0]).max())
        rounded = np.round((group.points[0] - group.points[0].mean(0)) / size, 9) + 0.0
        names = {tuple(point): i for i, point in enumerate(rounded.tolist())}
        ids = np.array([names[tuple(point)] for point in rounded.tolist()])[group.triangles]
        edges = Counter((int(t[i]), int(t[i - 2])) for t in ids for i in range(3))
        assert set(edges.values()) == {1}
        assert all((second, first) in edges for first, second in edges)
    np.testing.assert_allclose(found, prism_volumes(beams), rtol=0.01)


def test_points_lie_on_the_circles_and_normals_are_theirs() -> None:
    beams = CASES["round"]
    for group in beam_triangles(beams, 1e-2):
        count = group.points.shape[1] // 2 - 4
        steps = count // 4
        outer = slice(4 * steps, 6 * steps)
        points = group.points[:, outer] - beams.annuli.origins[group.beams][:, None]
        across = beams.annuli.frames[group.beams, 2][:, None]
        flat = points - dot(points, across)[..., None] * across
        rows = beams.annuli.outer[group.beams][:, None]
        assert np.abs(evaluate(rows, flat)).max() < 1e-12
        exact = rows[..., 1:4] - 2 * rows[..., :1] * flat
        assert np.abs(group.normals[:, outer] - exact).max() < 1e-12


def test_cylinders_close_up_and_hold_the_volume() -> None:
    rng = np.random.default_rng(3)
    origins, directions = rng.normal(size=(2, 6, 3))
    directions /= norm(directions)[:, None]
    heights = rng.uniform(0.5, 2, 6)
    for tolerance in (0.5, 0.05, 1e-4):
        found = cylinder_triangles(origins, directions, heights, 0.3, tolerance)
        relative = found.points - origins[:, None]
        along = dot(relative, directions[:, None])
        flat = relative - along[..., None] * directions[:, None]
        np.testing.assert_allclose(norm(flat), 0.3)
        assert np.minimum(np.abs(along), np.abs(along - heights[:, None])).max() < 1e-12
        a, b, c = relative[:, found.triangles].transpose(2, 0, 1, 3)
        areas = np.cross(b - a, c - a)
        assert (dot(areas, found.normals[:, found.triangles[:, 0]]) > 0).all()
        volumes = dot(a, np.cross(b, c)).sum(1) / 6
        n_sides = found.points.shape[1] // 4
        polygon = n_sides / 2 * np.sin(2 * np.pi / n_sides) * 0.3**2
        np.testing.assert_allclose(volumes, polygon * heights)
        assert 1 - np.cos(np.pi / n_sides) <= tolerance * (1 + 1e-9)


def test_law_scale_and_place_change_nothing() -> None:
    beams, moved = CASES["round"], Mesh(1e3 * TORUS.mesh.vertices + 1e6, TORUS.mesh.faces)
    rows = TORUS.local_spheres * (1e-3, 1, 1, 1, 1e3)
    again = make(SphereMesh.from_local(moved, rows))
    pairs = zip(beam_triangles(beams, 1e-3), beam_triangles(again, 1e-3), strict=True)
    for first, second in pairs:
        assert np.array_equal(first.triangles, second.triangles)
        assert np.abs(1e3 * first.points + 1e6 - second.points).max() < 1e-6
        assert np.abs(first.normals - second.normals).max() < 1e-8
