"""Pieces of a mesh that share no vertex do not change each other."""

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, IntArray
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.optimization.pieces import join_pieces, mesh_pieces
from spheremesh.kernel.optimization.radius_clustering import (
    RadiusClusters,
    cluster_radii,
    relax_moulds,
)
from spheremesh.kernel.sphere_meshes.fit import fit_spheres
from spheremesh.nodes import ellipsoid_mesh, roof_mesh, vase_mesh

TOLERANCE = 0.05


def joined(*meshes: Mesh) -> Mesh:
    """Meshes far from each other as one."""
    points, faces, first = [], [], 0
    for number, mesh in enumerate(meshes):
        points.append(mesh.vertices + np.array([50.0 * number, 0, 0]))
        faces += [face + first for face in mesh.faces]
        first += mesh.n_vertices
    return Mesh(np.concatenate(points), faces)


def on_moulds(mesh: Mesh, k: int) -> tuple[SphereMesh, RadiusClusters]:
    return cluster_radii(minimize_angles(fit_spheres(mesh))[0], k)


def part(clusters: RadiusClusters, faces: IntArray) -> RadiusClusters:
    """The same moulds for some of the faces."""
    return RadiusClusters(
        clusters.labels[faces], clusters.radii, clusters.counts, clusters.reassigned[faces]
    )


def larger(mesh: Mesh, factor: float) -> Mesh:
    return Mesh(factor * mesh.vertices, mesh.faces)


@pytest.mark.parametrize("factor", [1.0, 7.0])
def test_law_d13_relaxed_pieces_do_not_know_of_each_other(factor: float) -> None:
    """However large the other is; each is measured in its own mean edges."""
    one, other = vase_mesh(8, 5), larger(vase_mesh(10, 6), factor)
    whole = joined(one, other)
    spheres, clusters = on_moulds(whole, 4)
    relaxed, report = relax_moulds(spheres, clusters, TOLERANCE)
    moves = []
    for piece in mesh_pieces(whole):
        own = part(clusters, piece.faces)
        alone, run = relax_moulds(piece.spheres(spheres), own, TOLERANCE)
        edge = mean_edge_length(piece.mesh)
        points = relaxed.mesh.vertices[piece.vertices]
        np.testing.assert_allclose(points, alone.mesh.vertices, atol=1e-9 * edge)
        assert run.vertex_move <= TOLERANCE
        moves.append(run.vertex_move * edge)
    assert report.converged
    assert report.vertex_move == pytest.approx(max(moves) / mean_edge_length(whole))


def test_a_piece_that_finds_no_spheres_stays() -> None:
    """Quadrilaterals that lie on no circles, beside a vase that becomes smoother."""
    vase, net = vase_mesh(8, 5), vase_mesh(6, 4)
    noise = np.random.default_rng(0).normal(size=net.vertices.shape)
    bumpy = Mesh(net.vertices + 0.03 * mean_edge_length(net) * noise, net.faces)
    whole = joined(bumpy, vase)
    spheres, clusters = on_moulds(whole, 3)
    pieces = mesh_pieces(whole)
    runs = [
        relax_moulds(piece.spheres(spheres), part(clusters, piece.faces), 1e-3)[1]
        for piece in pieces
    ]
    assert [run.vertex_miss < 1e-6 for run in runs] == [False, True]
    relaxed, report = relax_moulds(spheres, clusters, 1e-3)
    stays, moves = (relaxed.mesh.vertices[piece.vertices] for piece in pieces)
    np.testing.assert_array_equal(stays, pieces[0].mesh.vertices)
    assert np.abs(moves - pieces[1].mesh.vertices).max() > 0
    assert report.vertex_miss < 1e-6


def test_pieces_are_put_together_again() -> None:
    """Faces and vertices in any order, pieces of other degrees among each other."""
    mesh = joined(ellipsoid_mesh(6, 4), vase_mesh(5, 3), roof_mesh(2, 3))
    rng = np.random.default_rng(0)
    new = rng.permutation(mesh.n_vertices)
    points = np.empty_like(mesh.vertices)
    points[new] = mesh.vertices
    whole = Mesh(points, [new[mesh.faces[i]] for i in rng.permutation(mesh.n_faces)])
    pieces = mesh_pieces(whole)
    assert sorted(piece.mesh.n_faces for piece in pieces) == sorted(
        each.n_faces for each in (ellipsoid_mesh(6, 4), vase_mesh(5, 3), roof_mesh(2, 3))
    )
    spheres = fit_spheres(whole)
    same = join_pieces(spheres, pieces, [piece.spheres(spheres) for piece in pieces])
    np.testing.assert_array_equal(same.mesh.vertices, whole.vertices)
    np.testing.assert_allclose(same.local_spheres, spheres.local_spheres, atol=1e-15)
    values = rng.normal(size=len(whole.topology.edge_corners))
    of_pieces = [piece.edge_values(whole, values) for piece in pieces]
    np.testing.assert_array_equal(np.sort(np.concatenate(of_pieces)), np.sort(values))
    lengths = edge_lengths(whole)
    for piece in pieces:
        expected = edge_lengths(piece.mesh)
        np.testing.assert_allclose(piece.edge_values(whole, lengths), expected, rtol=1e-12)


def edge_lengths(mesh: Mesh) -> FloatArray:
    ends = mesh.vertices[mesh.topology.edge_vertices]
    return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
