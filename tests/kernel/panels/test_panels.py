"""Panels: exact corners and planes, joints, thickness, and what cannot be made."""

from dataclasses import fields

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, dot, norm, unit
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import (
    face_normals,
    face_vector_areas,
    local_corners,
    mean_edge_length,
)
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.optimization.radius_clustering import cluster_radii
from spheremesh.kernel.panels.cutting import (
    EdgeMode,
    cut_panels,
    cutting_planes,
    edge_gaps,
    flatten_nearly_plane,
    gap_report,
)
from spheremesh.kernel.panels.facts import panel_volumes
from spheremesh.kernel.panels.panels import (
    Panels,
    move_origins,
    panel_arcs,
    panel_areas,
    scale_panels,
)
from spheremesh.kernel.parts.records import part_ids
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.spheres.arcs import arc_points
from spheremesh.kernel.spheres.circles import (
    circle_pencils,
    face_circles,
    intersection_circles,
    pencil_spheres,
)
from spheremesh.kernel.spheres.incidence import evaluate, normals
from spheremesh.kernel.spheres.rows import center_radius, recenter
from spheremesh.kernel.surfaces.circular_nets import enneper_net

NETS = ["torus", "ellipsoid", "egg", "vase", "roof"]
MODES: list[EdgeMode] = ["bisector", "intersection"]


@pytest.fixture(scope="module")
def optimum(nets: dict[str, Mesh]) -> dict[str, SphereMesh]:
    """What panels are cut from in practice."""
    return {name: minimize_angles(face_planes(nets[name]))[0] for name in NETS}


def on_sphere(mesh: Mesh, radius: float) -> SphereMesh:
    """One sphere about the origin for all faces, N outwards."""
    row = np.array([-0.5 / radius, 0, 0, 0, radius / 2])
    return SphereMesh(mesh, np.tile(row, (mesh.n_faces, 1)))


def fold(dihedral: float) -> Mesh:
    """Two unit squares that meet along the y axis, a roof falling by `dihedral`."""
    c, s = np.cos(dihedral / 2), np.sin(dihedral / 2)
    points = [[-c, 0, -s], [0, 0, 0], [c, 0, -s], [-c, 1, -s], [0, 1, 0], [c, 1, -s]]
    return Mesh(points, [[0, 1, 4, 3], [1, 2, 5, 4]])


def pairs(panels: Panels) -> list[tuple[int, int]]:
    """Corners whose edges two written panels share."""
    owner = panels.face_ids[panels.corner_panels]
    of_edge: dict[tuple[int, int], list[int]] = {}
    for h, (a, b) in enumerate(zip(owner, panels.neighbors, strict=True)):
        if b >= 0:
            of_edge.setdefault((min(a, b), max(a, b)), []).append(h)
    return [(h[0], h[1]) for h in of_edge.values() if len(h) == 2]


def model_offsets(panels: Panels) -> FloatArray:
    """Offsets of the cutting planes in model coordinates."""
    return panels.plane_offsets + dot(
        panels.plane_normals, panels.origins[panels.corner_panels]
    )


# Corners and planes


@pytest.mark.parametrize("name", NETS)
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("gap", [0.0, 0.02])
def test_law_corners_lie_on_sphere_and_both_planes(
    optimum: dict[str, SphereMesh], name: str, mode: EdgeMode, gap: float
) -> None:
    edge = mean_edge_length(optimum[name].mesh)
    panels, rejected = cut_panels(optimum[name], mode, 0.02 * edge, gap * edge)
    assert panels.n_panels + len(rejected) == optimum[name].mesh.n_faces
    assert panels.n_panels > 0
    owner = panels.corner_panels
    before = np.empty_like(owner)
    before[panels.next_corners] = np.arange(len(owner))
    for rows, corners in (
        (panels.spheres, panels.corners),
        (panels.inner_spheres, panels.inner_corners),
    ):
        np.testing.assert_allclose(evaluate(rows[owner], corners) / edge, 0, atol=1e-11)
        for ids in (slice(None), before):
            miss = dot(panels.plane_normals[ids], corners) - panels.plane_offsets[ids]
            np.testing.assert_allclose(
                miss / edge, 0, atol=1e-8 if mode == "intersection" else 1e-11
            )
    np.testing.assert_allclose(norm(panels.plane_normals), 1, atol=1e-12)


@pytest.mark.parametrize("name", NETS)
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("gap", [0.0, 0.02])
def test_law_neighbours_share_their_cutting_plane(
    optimum: dict[str, SphereMesh], name: str, mode: EdgeMode, gap: float
) -> None:
    edge = mean_edge_length(optimum[name].mesh)
    panels, _ = cut_panels(optimum[name], mode, joint_gap=gap * edge)
    first, second = np.array(pairs(panels)).T
    assert len(first) > panels.n_panels / 2
    n, m = panels.plane_normals[first], panels.plane_normals[second]
    np.testing.assert_allclose(n, -m, atol=1e-7 if mode == "intersection" else 1e-12)
    distance = model_offsets(panels)[first] + model_offsets(panels)[second]
    np.testing.assert_allclose(distance / edge, gap, atol=1e-6)


@pytest.mark.parametrize("name", NETS)
def test_corners_of_circular_nets_are_their_vertices(
    optimum: dict[str, SphereMesh], name: str
) -> None:
    mesh = optimum[name].mesh
    panels, rejected = cut_panels(optimum[name])
    assert not rejected
    np.testing.assert_allclose(panels.corners, local_corners(mesh), atol=1e-10)
    np.testing.assert_allclose(panels.corners, panels.inner_corners, atol=1e-14)
    corners = panels.corners + panels.origins[panels.corner_panels]
    np.testing.assert_allclose(corners, mesh.vertices[mesh.corners], atol=1e-10)


@pytest.mark.parametrize("name", NETS)
def test_planes_point_into_their_panel(optimum: dict[str, SphereMesh], name: str) -> None:
    bisectors, plane_offsets = cutting_planes(optimum[name], "bisector")
    # The local origin is the mean of the corners.
    assert (plane_offsets < 0).all()
    # However tilted, an intersection plane has the same side of the edge inside.
    assert (dot(cutting_planes(optimum[name], "intersection")[0], bisectors) > 0).all()


@pytest.mark.parametrize("name", NETS)
def test_bisector_planes_bisect(optimum: dict[str, SphereMesh], name: str) -> None:
    """Mirrored in the plane, the normal of one face is that of the other."""
    found = optimum[name]
    topology, corners = found.mesh.topology, local_corners(found.mesh)
    plane_normals, plane_offsets = cutting_planes(found, "bisector")
    chords = corners[topology.next_corners] - corners
    middles = corners + chords / 2
    np.testing.assert_allclose(dot(plane_normals, chords), 0, atol=1e-11)
    np.testing.assert_allclose(dot(plane_normals, middles), plane_offsets, atol=1e-11)
    left, right = face_normals(found.mesh)[topology.edge_faces].transpose(1, 0, 2)
    p = plane_normals[topology.edge_corners]
    along = unit(chords[topology.edge_corners])
    n, m = (unit(side - dot(side, along)[:, None] * along) for side in (left, right))
    np.testing.assert_allclose(n - 2 * dot(n, p)[:, None] * p, m, atol=1e-9)
    boundary = topology.twins < 0
    upright = unit(normals(found.local_spheres[topology.corner_faces], middles))
    np.testing.assert_allclose(dot(plane_normals, upright)[boundary], 0, atol=1e-11)


@pytest.mark.parametrize("name", NETS)
def test_intersection_planes_carry_the_circles(
    optimum: dict[str, SphereMesh], name: str
) -> None:
    found = optimum[name]
    topology, corners = found.mesh.topology, local_corners(found.mesh)
    plane_normals, plane_offsets = cutting_planes(found, "intersection")
    first = topology.edge_corners
    twin = topology.twins[first]
    rows = recenter(found.local_spheres[topology.corner_faces], corners)
    next_of_twin = topology.next_corners[twin]
    other = recenter(found.local_spheres[topology.corner_faces[twin]], corners[next_of_twin])
    circles = intersection_circles(rows[first], other)
    is_clear = np.abs(rows[first, 0] - other[:, 0]) * mean_edge_length(found.mesh) > 1e-3
    cosine = dot(circles.normals, plane_normals[first])
    assert is_clear.sum() > 10
    np.testing.assert_allclose(np.abs(cosine[is_clear]), 1, atol=1e-9)
    miss = dot(plane_normals[first], corners[first]) - plane_offsets[first]
    np.testing.assert_allclose(miss[is_clear], 0, atol=1e-8)
    boundary = topology.twins < 0
    expected, _ = cutting_planes(found, "bisector")
    np.testing.assert_array_equal(plane_normals[boundary], expected[boundary])


def test_spheres_that_are_the_same_are_cut_by_the_bisector(ball: Mesh) -> None:
    for found in (on_sphere(ball, 2.0), face_planes(ball)):
        for n, m in zip(
            cutting_planes(found, "bisector"),
            cutting_planes(found, "intersection"),
            strict=True,
        ):
            np.testing.assert_array_equal(n, m)


# Gaps


@pytest.mark.parametrize("name", NETS)
def test_law_intersection_edges_are_watertight(
    optimum: dict[str, SphereMesh], name: str
) -> None:
    found, edge = optimum[name], mean_edge_length(optimum[name].mesh)
    gaps = edge_gaps(found, "intersection") / edge
    # The smaller the angle, the worse the plane of the circle is defined, not the circle.
    assert np.median(gaps) < 1e-13
    assert gaps.max() < 1e-11
    report = gap_report(found, "intersection", np.arange(found.mesh.n_faces))
    assert report["relative_to_edge"] == pytest.approx(gaps.max(), abs=1e-9)
    panels, _ = cut_panels(found, "intersection")
    first, second = np.array(pairs(panels)).T
    middles = arc_points(panel_arcs(panels), np.array([0.0]))[:, 0]
    middles += panels.origins[panels.corner_panels]
    np.testing.assert_allclose(middles[first], middles[second], atol=1e-7 * edge)


@pytest.mark.parametrize("name", NETS)
def test_bisector_gaps_are_those_of_the_arcs(optimum: dict[str, SphereMesh], name: str) -> None:
    found = optimum[name]
    panels, rejected = cut_panels(found)
    assert not rejected
    topology = found.mesh.topology
    middles = arc_points(panel_arcs(panels), np.array([0.0]))[:, 0]
    middles += panels.origins[panels.corner_panels]
    first = topology.edge_corners
    expected = norm(middles[first] - middles[topology.twins[first]])
    gaps = edge_gaps(found, "bisector")
    np.testing.assert_allclose(gaps, expected, atol=1e-9)
    report = gap_report(found, "bisector", np.arange(found.mesh.n_faces))
    assert report["max"] == pytest.approx(gaps.max(), rel=1e-3, abs=1e-7)
    assert report["mean"] == pytest.approx(gaps.mean(), rel=1e-3, abs=1e-7)


def test_gaps_vanish_on_planes_and_mirror_pairs(nets: dict[str, Mesh], ball: Mesh) -> None:
    for found in (face_planes(nets["roof"]), on_sphere(ball, 2.0)):
        for mode in MODES:
            assert edge_gaps(found, mode).max() < 1e-11
    mesh = fold(0.5)
    rows = face_planes(mesh).local_spheres.copy()
    outward = rows[:, 1:4].copy()
    # Corners half a diagonal from the centroid: A / 2 + C = 0.
    rows[:, 0], rows[:, 1:4], rows[:, 4] = -0.2, outward * np.sqrt(1 - 0.08), 0.1
    assert edge_gaps(SphereMesh.from_local(mesh, rows), "bisector").max() < 1e-12
    rows[0] = [0, *outward[0], 0]
    assert edge_gaps(SphereMesh.from_local(mesh, rows), "bisector").max() > 1e-3


def test_plane_panels_among_curved_ones_are_cut_upright(nets: dict[str, Mesh]) -> None:
    """The circle in which a sphere meets a plane lies in that plane, which cannot cut itself.

    Enneper's net has plane panels on its diagonals: there the bisector takes over, with its
    small gap, and nothing is lost.
    """
    found = flatten_nearly_plane(minimize_angles(face_planes(nets["enneper"]))[0])
    edge = mean_edge_length(found.mesh)
    is_plane = found.local_spheres[:, 0] == 0
    assert 0 < is_plane.sum() < found.mesh.n_faces
    beside_plane = is_plane[found.mesh.topology.edge_faces].any(axis=1)
    gaps = edge_gaps(found, "intersection")
    assert gaps[~beside_plane].max() < 1e-11 * edge
    bisector = edge_gaps(found, "bisector")
    np.testing.assert_array_equal(gaps[beside_plane], bisector[beside_plane])
    panels, rejected = cut_panels(found, "intersection")
    assert not rejected
    flat = norm(face_vector_areas(found.mesh))
    np.testing.assert_allclose(panel_areas(panels)[is_plane], flat[is_plane], rtol=1e-9)


def test_meshes_without_interior_edges_have_no_gap() -> None:
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    report = gap_report(face_planes(mesh), "bisector", np.arange(mesh.n_faces))
    assert report["edges"] == 0
    assert not any(report.values())


def test_edges_that_only_a_joint_lets_exist_have_no_gap() -> None:
    """The sphere does not reach the corners of its square, but those that a joint leaves."""
    points = [[i, j, 0] for i in range(4) for j in range(4)]
    corners = [4 * i + j for i in range(3) for j in range(3)]
    mesh = Mesh(points, [[k, k + 4, k + 5, k + 1] for k in corners])
    rows = face_planes(mesh).spheres.copy()
    radius, center = 0.706, np.array([1.5, 1.5, -0.2])
    rows[4] = [-0.5 / radius, *-center / radius, (radius**2 - center @ center) / (2 * radius)]
    found = SphereMesh(mesh, rows)
    panels, rejected = cut_panels(found, joint_gap=0.03)
    assert not rejected
    report = gap_report(found, "bisector", panels.face_ids)
    assert report.pop("edges") == 8
    assert not any(report.values())


# Joints, thickness, measures


def test_joint_gap_keeps_corners_on_the_sphere_and_shrinks_panels(ball: Mesh) -> None:
    areas = []
    closed = model_offsets(cut_panels(on_sphere(ball, 2.0))[0])
    for gap in (0.0, 0.01, 0.05):
        panels, rejected = cut_panels(on_sphere(ball, 2.0), joint_gap=gap)
        assert not rejected
        assert panels.joint_gap == gap
        corners = panels.corners + panels.origins[panels.corner_panels]
        np.testing.assert_allclose(norm(corners), 2, rtol=1e-13)
        np.testing.assert_allclose(model_offsets(panels) - closed, gap / 2, atol=1e-13)
        areas.append(panel_areas(panels))
    lengths = norm(local_corners(ball) - np.roll(local_corners(ball), -1, axis=0))
    assert lengths.min() > 0.1
    assert (areas[0] > areas[1]).all()
    assert (areas[1] > areas[2]).all()


def test_joint_gap_of_flat_squares() -> None:
    """Every side of a unit square moves in by half of the gap, boundary or not."""
    points = [[x, y, 7.0] for x in range(4) for y in range(3)]
    faces = [
        [3 * x + y, 3 * x + 3 + y, 3 * x + 4 + y, 3 * x + 1 + y]
        for x in range(3)
        for y in (0, 1)
    ]
    panels, rejected = cut_panels(face_planes(Mesh(points, faces)), "intersection", 0.3, 0.1)
    assert not rejected
    np.testing.assert_allclose(panel_areas(panels), 0.81, rtol=1e-12)
    np.testing.assert_allclose(panel_volumes(panels), 0.81 * 0.3, rtol=1e-12)
    np.testing.assert_allclose(
        panels.inner_corners - panels.corners, [[0, 0, -0.3]] * 24, atol=1e-13
    )


@pytest.mark.parametrize("thickness", [0.01, 0.3, 0.9])
def test_law_shells_of_octants(octahedron: Mesh, thickness: float) -> None:
    panels, rejected = cut_panels(on_sphere(octahedron, 1.0), thickness=thickness)
    assert not rejected
    inner = 1 - thickness
    np.testing.assert_allclose(panel_areas(panels), np.pi / 2, rtol=1e-11)
    expected = np.pi / 6 * (1 - inner**3)
    np.testing.assert_allclose(panel_volumes(panels), expected, rtol=1e-9)
    center, square = center_radius(panels.inner_spheres)
    np.testing.assert_allclose(center + panels.origins, 0, atol=1e-13)
    np.testing.assert_allclose(square, inner**2, rtol=1e-12)
    np.testing.assert_allclose(
        panels.inner_corners + panels.origins[panels.corner_panels],
        inner * octahedron.vertices[octahedron.corners],
        atol=1e-12,
    )


@pytest.mark.parametrize("name", NETS)
def test_inner_faces_are_parallel(optimum: dict[str, SphereMesh], name: str) -> None:
    thickness = 0.1 * mean_edge_length(optimum[name].mesh)
    panels, _ = cut_panels(optimum[name], thickness=thickness)
    owner = panels.corner_panels
    summits = arc_points(panel_arcs(panels), np.array([-1.0, -0.3, 0.6]))
    rows = np.repeat(panels.spheres[owner][:, None], 3, 1)
    inner = np.repeat(panels.inner_spheres[owner][:, None], 3, 1)
    below = summits - thickness * normals(rows, summits)
    np.testing.assert_allclose(evaluate(inner, below) / thickness, 0, atol=1e-10)
    np.testing.assert_allclose(normals(inner, below), normals(rows, summits), atol=1e-10)
    volumes, areas = panel_volumes(panels), panel_areas(panels)
    inner_area = panel_areas(cut_panels(optimum[name], thickness=thickness)[0])
    np.testing.assert_allclose(areas, inner_area)
    assert (np.abs(volumes / (thickness * areas) - 1) < 0.25).all()
    arcs = panel_arcs(panels, "inner")
    np.testing.assert_allclose(arcs.starts, panels.inner_corners)


@pytest.mark.parametrize("dihedral", [0.6, -0.6, 1.2])
def test_wedges_between_bisectors(dihedral: float) -> None:
    """Below a roof the inner faces are shorter by t tan(δ/2), below a valley longer."""
    t = 0.2
    panels, rejected = cut_panels(face_planes(fold(dihedral)), thickness=t)
    assert not rejected
    np.testing.assert_allclose(panel_areas(panels), 1, rtol=1e-12)
    expected = t * (1 - t * np.tan(dihedral / 2) / 2)
    np.testing.assert_allclose(panel_volumes(panels), expected, rtol=1e-11)


def test_volumes_without_thickness_are_zero(ball: Mesh) -> None:
    panels, _ = cut_panels(on_sphere(ball, 2.0))
    assert (panel_volumes(panels) == 0).all()


def test_areas_of_a_closed_body_add_up_to_the_sphere(octahedron: Mesh) -> None:
    panels, _ = cut_panels(on_sphere(octahedron, 1.0), "intersection")
    assert panel_areas(panels).sum() == pytest.approx(4 * np.pi, rel=1e-11)


@pytest.mark.parametrize("scale", [1e-3, 1e3])
@pytest.mark.parametrize("mode", MODES)
def test_law_panels_are_covariant(
    optimum: dict[str, SphereMesh], rotation: FloatArray, scale: float, mode: EdgeMode
) -> None:
    before = optimum["roof"]
    edge = mean_edge_length(before.mesh)
    rows = before.local_spheres * [1 / scale, 1, 1, 1, scale]
    rows[:, 1:4] = rows[:, 1:4] @ rotation.T
    mesh = Mesh(scale * before.mesh.vertices @ rotation.T, before.mesh.faces)
    after = SphereMesh.from_local(mesh, rows)
    t, gap = 0.05 * edge, 0.01 * edge
    expected, dropped = cut_panels(before, mode, t, gap)
    found, rejected = cut_panels(after, mode, scale * t, scale * gap)
    assert [r.id for r in rejected] == [r.id for r in dropped]
    np.testing.assert_allclose(
        found.corners / scale, expected.corners @ rotation.T, atol=1e-8 * edge
    )
    np.testing.assert_allclose(panel_areas(found), scale**2 * panel_areas(expected), rtol=1e-7)
    np.testing.assert_allclose(
        panel_volumes(found), scale**3 * panel_volumes(expected), rtol=1e-7
    )


def test_law_panels_survive_a_far_site(optimum: dict[str, SphereMesh]) -> None:
    before = optimum["roof"]
    edge = mean_edge_length(before.mesh)
    far = Mesh(before.mesh.vertices + 1e6 * edge, before.mesh.faces)
    after = SphereMesh.from_local(far, before.local_spheres)
    expected, _ = cut_panels(before, "bisector", 0.05 * edge, 0.01 * edge)
    found, rejected = cut_panels(after, "bisector", 0.05 * edge, 0.01 * edge)
    assert not rejected
    np.testing.assert_allclose(found.corners, expected.corners, atol=1e-8 * edge)
    np.testing.assert_allclose(panel_areas(found), panel_areas(expected), rtol=1e-8)


# Planes


def test_panels_in_another_unit(optimum: dict[str, SphereMesh]) -> None:
    found = optimum["vase"]
    size = mean_edge_length(found.mesh)
    panels, _ = cut_panels(found, thickness=0.01 * size, joint_gap=0.01 * size)
    scaled = scale_panels(panels, 1000.0)
    np.testing.assert_allclose(panel_areas(scaled), 1e6 * panel_areas(panels), rtol=1e-12)
    np.testing.assert_allclose(panel_volumes(scaled), 1e9 * panel_volumes(panels), rtol=1e-11)
    radii = [np.sqrt(center_radius(p.inner_spheres)[1]) for p in (panels, scaled)]
    np.testing.assert_allclose(radii[1], 1000 * radii[0], rtol=1e-12)


def test_panels_about_other_origins(optimum: dict[str, SphereMesh]) -> None:
    found = optimum["vase"]
    size = mean_edge_length(found.mesh)
    panels, _ = cut_panels(found, thickness=0.01 * size)
    shift = size * np.array([0.3, -0.2, 0.1])
    moved = move_origins(panels, panels.origins + shift)
    owner = panels.corner_panels
    np.testing.assert_allclose(
        moved.corners + moved.origins[owner], panels.corners + panels.origins[owner],
        rtol=0, atol=1e-14 * norm(panels.origins).max(),
    )  # fmt: skip
    misses = dot(moved.plane_normals, moved.inner_corners) - moved.plane_offsets
    assert np.abs(misses).max() < 1e-14 * size * 10
    assert np.abs(evaluate(moved.spheres[owner], moved.corners)).max() < 1e-14 * size * 10
    np.testing.assert_allclose(panel_volumes(moved), panel_volumes(panels), rtol=1e-10)


def test_nearly_flat_spheres_become_planes_exactly(nets: dict[str, Mesh]) -> None:
    mesh = nets["roof"]
    corners = local_corners(mesh)
    size = 2 * np.maximum.reduceat(norm(corners), mesh.offsets[:-1])
    planes = face_planes(mesh).local_spheres
    for bulge, is_flat in ((1e-7, True), (9e-7, True), (1.1e-6, False), (1e-4, False)):
        rows = planes.copy()
        # Bulge L²/8r relative to L; the corners stay on the sphere to first order.
        rows[:, 0] = -4 * bulge / size
        heights = np.add.reduceat(
            rows[mesh.topology.corner_faces, 0] * dot(corners, corners), mesh.offsets[:-1]
        )
        rows[:, 4] -= heights / mesh.degrees
        found = flatten_nearly_plane(SphereMesh.from_local(mesh, rows)).local_spheres
        assert ((found[:, 0] == 0) == is_flat).all()
        if is_flat:
            np.testing.assert_allclose(found, planes, atol=2e-6 * size.max())


def test_planes_off_the_centroid_stay_where_they_are(ball: Mesh) -> None:
    rows = face_planes(ball).local_spheres.copy()
    rows[:, 4] = 0.01
    found = flatten_nearly_plane(SphereMesh.from_local(ball, rows))
    np.testing.assert_allclose(found.local_spheres, rows, atol=1e-15)


def test_cut_panels_flattens_before_it_cuts(nets: dict[str, Mesh]) -> None:
    rows = face_planes(nets["vase"]).local_spheres.copy()
    rows[:, 0] = 1e-9
    panels, _ = cut_panels(SphereMesh.from_local(nets["vase"], rows), "intersection", 0.01)
    assert (panels.spheres[:, 0] == 0).all()
    assert (panel_arcs(panels).sagittas == 0).all()


# What cannot be made


def only_reason(found: SphereMesh, mode: EdgeMode = "bisector", **lengths: float) -> str:
    """Reason for a mesh whose only panel, or every panel, is rejected."""
    panels, rejected = cut_panels(found, mode, **lengths)
    assert panels.n_panels == 0
    assert len(panels.corners) == len(panels.ids) == 0
    assert panel_areas(panels).shape == panel_volumes(panels).shape == (0,)
    assert [r.element_id for r in rejected] == list(range(found.mesh.n_faces))
    assert len({r.reason for r in rejected}) == 1
    return rejected[0].reason


SQUARE = Mesh([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]], [[0, 1, 2, 3]])


@pytest.mark.parametrize("mode", MODES)
def test_self_crossing_faces_are_rejected(mode: EdgeMode) -> None:
    mesh = Mesh([[0, 0, 0], [2, 0, 0], [0.5, 1, 0], [1.5, 1.2, 0]], [[0, 1, 2, 3]])
    assert "crosses itself" in only_reason(face_planes(mesh), mode)


def test_self_crossing_curved_faces_are_rejected() -> None:
    points = unit(np.array([[0.1, 0.1, 1], [0.5, 0, 1], [0.15, 0.4, 1], [0.4, 0.45, 1]]))
    mesh = Mesh(points, [[0, 1, 2, 3]])
    assert "crosses itself" in only_reason(on_sphere(mesh, 1.0))


@pytest.mark.parametrize("gap", [1.5, 3.0, 100.0])
def test_joints_that_swallow_an_edge_are_rejected(gap: float) -> None:
    assert "vanishes or runs backwards" in only_reason(face_planes(SQUARE), joint_gap=gap)


@pytest.mark.parametrize("radius", [1.0, 1 + 1e-9, 1.01])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_caps_beyond_80_degrees_are_rejected(radius: float, sign: float) -> None:
    """The half sphere too, whose centre is the origin of its panel."""
    height = np.sqrt(radius**2 - 1)
    row = [sign * 0.5 / radius, 0, 0, height / radius, -sign * 0.5 / radius]
    found = SphereMesh(SQUARE, [row])
    for mode in MODES:
        assert "80 degrees" in only_reason(found, mode)
    # 79 degrees are a panel.
    radius = 1 / np.sin(np.radians(79))
    height = np.sqrt(radius**2 - 1)
    row = [sign * 0.5 / radius, 0, 0, height / radius, -sign * 0.5 / radius]
    assert not cut_panels(SphereMesh(SQUARE, [row]))[1]


def test_caps_of_inner_faces_are_rejected_too() -> None:
    """A joint cuts the larger of two concentric spheres nearer to its great circle."""
    turns = np.arange(6) * np.pi / 3
    hexagon = Mesh(np.stack([np.cos(turns), np.sin(turns), 0 * turns], 1), [range(6)])
    planes, great_spheres = circle_pencils(face_circles(hexagon)[0])
    cap = np.array([np.radians(82)])
    found = SphereMesh.from_local(hexagon, pencil_spheres(planes, great_spheres, cap))
    assert not cut_panels(found, joint_gap=0.1)[1]
    assert "inner face reaches" in only_reason(found, joint_gap=0.1, thickness=1.0)


def test_walls_that_lean_over_are_rejected(nets: dict[str, Mesh]) -> None:
    """Spheres of random curvature meet in planes of any tilt; without walls that is no harm."""
    mesh = nets["torus"]
    planes, great_spheres = circle_pencils(face_circles(mesh)[0])
    angles = np.random.default_rng(0).uniform(-0.3, 0.3, mesh.n_faces)
    found = SphereMesh.from_local(mesh, pencil_spheres(planes, great_spheres, angles))
    size = mean_edge_length(mesh)
    for lengths in ({"thickness": 0.01 * size}, {"joint_gap": 0.01 * size}):
        panels, rejected = cut_panels(found, "intersection", **lengths)
        assert any("leans over" in r.reason for r in rejected)
        for rows, arcs in (
            (panels.spheres, panel_arcs(panels)),
            (panels.inner_spheres, panel_arcs(panels, "inner")),
        ):
            upwards = normals(rows[panels.corner_panels], (arcs.starts + arcs.ends) / 2)
            assert (dot(upwards, arcs.rises) > 0).all()
    _, rejected = cut_panels(found, "intersection")
    assert not any("leans over" in r.reason for r in rejected)


def test_a_mould_as_small_as_its_face_is_rejected_not_warned_about() -> None:
    """One mould for all: the largest face becomes half a sphere."""
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]])
    mesh = Mesh(np.concatenate([points, 4 * points + 9]), [[0, 1, 2, 3], [4, 5, 6, 7]])
    rows = face_planes(mesh).local_spheres.copy()
    rows[:, 0], rows[:, 4] = [-0.6, -0.1], [0.3, 0.8]
    clustered, _ = cluster_radii(SphereMesh.from_local(mesh, rows), 1)
    panels, rejected = cut_panels(clustered)
    assert [r.id for r in rejected] == ["P0001"]
    assert panels.ids == ("P0000",)


def test_faces_folded_back_are_rejected() -> None:
    """No plane bisects a fold of 180 degrees."""
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [0.3, 1, 0], [0.6, 1, 0]], [[0, 1, 2], [1, 0, 3]])
    for mode in MODES:
        assert "folds back" in only_reason(face_planes(mesh), mode)


def test_faces_against_their_sphere_are_rejected() -> None:
    reversed_rows = -face_planes(SQUARE).local_spheres
    reason = only_reason(SphereMesh.from_local(SQUARE, reversed_rows))
    assert "clockwise" in reason


def dome() -> SphereMesh:
    """A square on the unit sphere, 64 degrees from its top."""
    turns = np.arange(4) * np.pi / 2
    points = np.stack([0.9 * np.cos(turns), 0.9 * np.sin(turns), np.full(4, np.sqrt(0.19))], 1)
    return on_sphere(Mesh(points, [[0, 1, 2, 3]]), 1.0)


def test_planes_that_miss_their_sphere_are_rejected() -> None:
    assert "do not meet on the sphere" in only_reason(dome(), joint_gap=2.5)


def test_thickness_that_leaves_no_inner_corner_is_rejected() -> None:
    """Cut 0.475 beside the centre the sphere of radius 1 has corners, that of 0.5 not."""
    assert not cut_panels(dome(), joint_gap=0.95)[1]
    reason = only_reason(dome(), thickness=0.5, joint_gap=0.95)
    assert "the thickness leaves no corner" in reason


@pytest.mark.parametrize("name", NETS)
@pytest.mark.parametrize("mode", MODES)
def test_no_panel_is_dropped_silently(
    optimum: dict[str, SphereMesh], name: str, mode: EdgeMode
) -> None:
    found = optimum[name]
    edge, count = mean_edge_length(found.mesh), found.mesh.n_faces
    for gap in (0.0, 0.3, 0.8):
        panels, rejected = cut_panels(found, mode, joint_gap=gap * edge)
        named = [r.element_id for r in rejected]
        assert sorted([*panels.face_ids.tolist(), *named]) == list(range(count))
        assert named == sorted(named)
        ids = part_ids("P", count)
        assert panels.ids == tuple(ids[i] for i in panels.face_ids)
        assert all(r.id == ids[r.element_id] and r.reason for r in rejected)
        assert (panel_areas(panels) > 0).all()


def test_what_is_kept_is_the_same_as_without_the_rejected(
    optimum: dict[str, SphereMesh],
) -> None:
    """Panels are selected with all their arrays."""
    found = optimum["roof"]
    rows = found.local_spheres.copy()
    rows[[3, 40]] *= -1
    whole, _ = cut_panels(found, thickness=0.1)
    labels = np.arange(found.mesh.n_faces)[::-1].copy()
    panels, rejected = cut_panels(
        SphereMesh.from_local(found.mesh, rows), thickness=0.1, labels=labels
    )
    gone = {r.element_id for r in rejected}
    assert {3, 40} <= gone
    np.testing.assert_array_equal(panels.labels, labels[panels.face_ids])
    near = {b for a in gone for b in np.unique(whole.neighbors[whole.corner_panels == a])}
    for i, face in enumerate(panels.face_ids):
        if face in near:
            continue
        a, b = panels.corner_panels == i, whole.corner_panels == face
        for field in fields(Panels):
            first, second = getattr(panels, field.name), getattr(whole, field.name)
            if not isinstance(first, np.ndarray) or field.name in ("offsets", "labels"):
                continue
            if len(first) == panels.n_panels:
                np.testing.assert_allclose(first[i], second[face], atol=1e-12)
            else:
                np.testing.assert_allclose(first[a], second[b], atol=1e-12)


def test_thickness_up_to_the_centre_is_rejected(octahedron: Mesh) -> None:
    for thickness in (0.9995, 1.0, 1.5, 1e9):
        assert "reaches the centre" in only_reason(
            on_sphere(octahedron, 1.0), thickness=thickness
        )
    rows = on_sphere(octahedron, 1.0).spheres.copy()
    rows[5] = [-0.6, 0, 0, 0, 1 / 2.4]
    panels, rejected = cut_panels(SphereMesh(octahedron, rows), thickness=0.9)
    assert [r.id for r in rejected] == ["P0005"]
    assert panels.n_panels == 7
    # Spheres that curve the other way may be as thick as one likes.
    bowl = Mesh(octahedron.vertices, [face[::-1] for face in octahedron.faces])
    inward = SphereMesh(bowl, np.tile([0.5, 0, 0, 0, -0.5], (8, 1)))
    panels, rejected = cut_panels(inward, thickness=3.0)
    assert not rejected
    np.testing.assert_allclose(panel_volumes(panels), np.pi / 6 * 63, rtol=1e-8)


def test_of_several_faults_the_cause_is_named() -> None:
    """A face that folds back has no corners and runs clockwise as well; the fold is why."""
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [0.3, 1, 0], [0.6, 1, 0]], [[0, 1, 2], [1, 0, 3]])
    rows = -face_planes(mesh).local_spheres
    found = SphereMesh.from_local(mesh, rows)
    assert "folds back" in only_reason(found, thickness=0.1, joint_gap=0.5)


@pytest.mark.parametrize("bad", [-1e-9, np.nan, np.inf])
def test_lengths_are_finite_and_not_negative(ball: Mesh, bad: float) -> None:
    with pytest.raises(InputError, match="thickness must be a length"):
        cut_panels(on_sphere(ball, 2.0), thickness=bad)
    with pytest.raises(InputError, match="joint gap must be a length"):
        cut_panels(on_sphere(ball, 2.0), joint_gap=bad)


def test_names_have_digits_enough() -> None:
    assert part_ids("P", 3) == ("P0000", "P0001", "P0002")
    assert part_ids("P", 10_000)[-1] == "P9999"
    names = part_ids("P", 10_001)
    assert (names[0], names[-1]) == ("P00000", "P10000")


def test_panels_without_moulds_have_no_label(ball: Mesh) -> None:
    panels, _ = cut_panels(on_sphere(ball, 2.0))
    assert (panels.labels == -1).all()


def test_gaps_are_those_of_panels_that_are_made() -> None:
    """Arcs that do not exist are NaN, and edges of rejected panels do not count."""
    found = minimize_angles(fit_spheres(enneper_net(25, 0.9)))[0]
    edge = mean_edge_length(found.mesh)
    panels, rejected = cut_panels(found, "intersection", 0.02 * edge, 0.01 * edge)
    assert rejected
    report = gap_report(found, "intersection", panels.face_ids)
    assert report["edges"] < len(found.mesh.topology.edge_corners)
    assert report["relative_to_edge"] < 0.01
