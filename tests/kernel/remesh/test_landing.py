"""Neighbours on all but one sphere are turned apart; all else stays."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, dot, norm, unit
from spheremesh.kernel.meshes.mesh import local_corners
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.remesh.planar.landing import turn_apart
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.sphere_mesh import intersection_angles
from spheremesh.kernel.spheres.incidence import evaluate
from spheremesh.kernel.spheres.minkowski import minkowski
from spheremesh.kernel.spheres.rows import recenter, rescale
from spheremesh.kernel.support.node_axes import arc_planes
from spheremesh.kernel.surfaces.circular_nets import roof_net
from spheremesh.kernel.tolerances import ALIKE_NEIGHBORS


@pytest.fixture(scope="module")
def roof() -> SphereMesh:
    return minimize_angles(central_spheres(roof_net(8, 10, 12.0)))[0]


def inner_edge(sphere_mesh: SphereMesh) -> int:
    """An edge in the middle."""
    topology = sphere_mesh.mesh.topology
    ends = sphere_mesh.mesh.vertices[topology.edge_vertices].mean(axis=1)
    return int(norm(ends - ends.mean(axis=0)).argmin())


def alike(sphere_mesh: SphereMesh, edge: int, apart: float) -> SphereMesh:
    """The two spheres of an edge drawn together until they meet at an angle."""
    mesh, topology = sphere_mesh.mesh, sphere_mesh.mesh.topology
    first, second = sides(mesh, edge)
    rows, middles = sphere_mesh.local_spheres.copy(), edge_middles(mesh)
    faces = topology.corner_faces[[first, second]]
    left, right = recenter(rows[faces], middles[[first, second]])
    differ = right - left
    differ *= apart / np.linalg.norm(differ[1:4])
    for face, corner, sign in zip(faces, (first, second), (-1, 1), strict=True):
        rows[face] = recenter((left + right + sign * differ) / 2, -middles[corner])
    return SphereMesh.from_local(mesh, rows / np.sqrt(minkowski(rows, rows))[:, None])


def sides(mesh: Mesh, edge: int) -> tuple[int, int]:
    first = int(mesh.topology.edge_corners[edge])
    return first, int(mesh.topology.twins[first])


def edge_middles(mesh: Mesh) -> FloatArray:
    """Middles of all half-edges, local to their face."""
    starts = local_corners(mesh)
    return (starts + starts[mesh.topology.next_corners]) / 2


def edge_normal(sphere_mesh: SphereMesh, edge: int) -> FloatArray:
    """Normal part of the first row, seen from the middle of an edge."""
    mesh = sphere_mesh.mesh
    first, _ = sides(mesh, edge)
    row = sphere_mesh.local_spheres[mesh.topology.corner_faces[first]]
    return recenter(row, edge_middles(mesh)[first])[1:4]


def heights_at_ends(sphere_mesh: SphereMesh, edge: int) -> FloatArray:
    mesh = sphere_mesh.mesh
    corners = [[h, mesh.topology.next_corners[h]] for h in sides(mesh, edge)]
    rows = sphere_mesh.local_spheres[mesh.topology.corner_faces[corners]]
    return evaluate(rows, local_corners(mesh)[corners])


@pytest.mark.parametrize("apart", [0.0, 1e-12, 1e-8, 1e-5])
def test_they_meet_in_the_plane_of_their_axes(roof: SphereMesh, apart: float) -> None:
    edge = inner_edge(roof)
    start = alike(roof, edge, apart)
    turned = turn_apart(start)
    # A plane that leans turns the spheres the less.
    leaning = dot(arc_planes(turned).normals[edge], edge_normal(start, edge))
    angle = float(intersection_angles(turned)[edge])
    assert abs(angle - ALIKE_NEIGHBORS * np.sqrt(1 - leaning**2)) <= apart + 1e-8
    np.testing.assert_allclose(
        heights_at_ends(turned, edge), heights_at_ends(start, edge), atol=1e-12
    )
    mesh = roof.mesh
    faces = mesh.topology.edge_faces[edge]
    others = np.setdiff1d(np.arange(mesh.n_faces), faces)
    np.testing.assert_allclose(
        turned.local_spheres[others], start.local_spheres[others], rtol=1e-12, atol=1e-15
    )
    if apart <= 1e-8:
        planes = arc_planes(turned)
        axes = [node_axis(turned, vertex, edge) for vertex in mesh.topology.edge_vertices[edge]]
        axes[1] *= np.sign(dot(axes[0], axes[1]))
        assert abs(float(dot(planes.normals[edge], axes[0] + axes[1]))) < 1e-3
        ends = mesh.vertices[mesh.topology.edge_vertices[edge]]
        assert abs(float(dot(planes.normals[edge], unit(ends[1] - ends[0])))) < 1e-9


def node_axis(sphere_mesh: SphereMesh, vertex: int, but: int) -> FloatArray:
    """The line nearest to the planes of the other beams at a node."""
    ends = sphere_mesh.mesh.topology.edge_vertices
    chosen = (ends == vertex).any(axis=1)
    chosen[but] = False
    return np.linalg.svd(arc_planes(sphere_mesh).normals[chosen])[2][2]


def test_without_such_neighbors_nothing_changes(roof: SphereMesh) -> None:
    assert turn_apart(roof) is roof


def test_within_one_sphere_no_axis_is_known_and_nothing_changes() -> None:
    mesh = roof_net(5, 6, 8.0)
    rows = np.tile([0.05, 0.0, 0.0, 1.0, 0.0], (mesh.n_faces, 1))
    ball = SphereMesh(mesh, rows)
    np.testing.assert_allclose(turn_apart(ball).local_spheres, ball.local_spheres, rtol=1e-12)


@given(st.floats(-4, 4))
def test_nothing_depends_on_the_scale(roof: SphereMesh, exponent: float) -> None:
    start = alike(roof, inner_edge(roof), 1e-9)
    factor = 10**exponent
    mesh = Mesh(start.mesh.vertices * factor, [list(face) for face in start.mesh.faces])
    large = SphereMesh.from_local(mesh, rescale(start.local_spheres, factor))
    back = rescale(turn_apart(large).local_spheres, 1 / factor)
    np.testing.assert_allclose(back, turn_apart(start).local_spheres, rtol=1e-7, atol=1e-11)
