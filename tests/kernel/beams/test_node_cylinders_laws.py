"""Laws of node cylinders (E6): where they stand, and that beams end before them."""

from collections.abc import Callable

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, IntArray, dot, norm
from spheremesh.kernel.beams.beams import Beams, scale_beams
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.beams.node_cylinders import node_cylinders
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import torus_net, vase_net

TORUS = central_spheres(torus_net(9, 6, 3.0, 1.0))


def made(sphere_mesh: SphereMesh, radius: float = 0.1, gap: float = 0.02) -> Beams:
    """Beams of 0.2 edges depth and 0.05 edges thickness; radius and gap in edges as well."""
    size = mean_edge_length(sphere_mesh.mesh)
    annuli = annulus_support(sphere_mesh, depth=0.2 * size).annuli
    return cut_beams(annuli, 0.05 * size, gap * size, radius * size)[0]


def end_corners(beams: Beams) -> FloatArray:
    """Corners of all ends (2B, 6, 3), in model coordinates."""
    corners = beams.corners.reshape(beams.n_beams, 2, 6, 3)
    return (corners + beams.annuli.origins[:, None, None]).reshape(-1, 6, 3)


@pytest.mark.parametrize(
    "sphere_mesh",
    [TORUS, central_spheres(vase_net(9, 6, 1.0, 3.0, 0.3))],
    ids=["torus", "vase"],
)
def test_law_e6_beams_end_at_radius_and_gap_from_the_axis(sphere_mesh: SphereMesh) -> None:
    beams = made(sphere_mesh)
    found = node_cylinders(beams)
    mesh, size = sphere_mesh.mesh, mean_edge_length(sphere_mesh.mesh)
    assert found.vertices.tolist() == sorted(set(beams.annuli.edge_vertices.ravel().tolist()))
    assert found.ids == tuple(f"N{i:04d}" for i in found.vertices.tolist())
    assert found.radius == beams.node_radius == pytest.approx(0.1 * size)
    # The axis is that of the vertex.
    off = np.cross(mesh.vertices[found.vertices] - found.origins, found.directions)
    assert norm(off).max() < 1e-9 * size
    nodes = np.searchsorted(found.vertices, beams.annuli.edge_vertices.ravel())
    relative = end_corners(beams) - found.origins[nodes][:, None]
    across = (
        relative
        - dot(relative, found.directions[nodes][:, None])[..., None]
        * (found.directions[nodes][:, None])
    )
    normals = np.repeat(beams.annuli.frames[:, 2], 2, axis=0)[:, None]
    away = across - dot(across, normals)[..., None] * normals
    np.testing.assert_allclose(norm(away), 0.12 * size, rtol=1e-8)


def test_cylinders_are_as_high_as_their_beams() -> None:
    beams = made(TORUS)
    found = node_cylinders(beams)
    nodes = beams.annuli.edge_vertices.ravel()
    levels = dot(
        end_corners(beams) - found.origins[nodes][:, None], found.directions[nodes][:, None]
    )
    for node in range(found.n_nodes):
        here = levels[nodes == node]
        assert abs(here.min()) < 1e-12
        assert here.max() == pytest.approx(found.heights[node], rel=1e-12)
        assert found.heights[node] >= beams.annuli.depth * 0.9
        names = {name for name, ends in zip(
            beams.annuli.ids, beams.annuli.edge_vertices.tolist(), strict=True
        ) if node in ends}  # fmt: skip
        assert set(found.beam_ids[node]) == names
        assert len(found.beam_ids[node]) == len(names)


def test_only_nodes_with_beams_have_cylinders_and_only_with_a_radius() -> None:
    beams = made(TORUS)
    few = select_parts(beams, np.arange(beams.n_beams) < 3)
    found = node_cylinders(few)
    assert found.vertices.tolist() == sorted(set(few.annuli.edge_vertices.ravel().tolist()))
    assert node_cylinders(made(TORUS, radius=0.0)).n_nodes == 0
    none = node_cylinders(select_parts(beams, np.zeros(beams.n_beams, bool)))
    assert none.ids == none.beam_ids == ()


@pytest.mark.parametrize("exponent", [-3.0, 0.7, 3.0])
def test_law_e6_cylinders_do_not_depend_on_scale(exponent: float) -> None:
    scale = 10.0**exponent
    first, second = node_cylinders(made(TORUS)), node_cylinders(scale_beams(made(TORUS), scale))
    np.testing.assert_allclose(second.heights / scale, first.heights, rtol=1e-12)
    assert np.abs(second.origins / scale - first.origins).max() < 1e-12
    assert second.radius == pytest.approx(scale * first.radius)


def test_law_e6_cylinders_do_not_depend_on_place() -> None:
    shift = 1e6 * mean_edge_length(TORUS.mesh) * np.array([0.6, -0.7, 0.4])
    moved = Mesh(TORUS.mesh.vertices + shift, TORUS.mesh.faces)
    near, far = (
        node_cylinders(made(each))
        for each in (TORUS, SphereMesh.from_local(moved, TORUS.local_spheres))
    )
    # The vertices themselves are rounded to 1e-10 edges there.
    np.testing.assert_allclose(far.heights, near.heights, rtol=1e-8)
    assert np.abs(far.origins - shift - near.origins).max() < 1e-8
    assert np.abs(far.directions - near.directions).max() < 1e-8


def test_law_e6_cylinders_do_not_depend_on_numbering(
    renumber: Callable[[Mesh], tuple[Mesh, IntArray]],
) -> None:
    mesh, new = renumber(TORUS.mesh)
    rows = np.empty_like(TORUS.local_spheres)
    rows[new] = TORUS.local_spheres
    first = node_cylinders(made(TORUS))
    second = node_cylinders(made(SphereMesh.from_local(mesh, rows)))
    apart = norm(first.origins[:, None] - second.origins)
    partner = apart.argmin(axis=1)
    assert apart.min(axis=1).max() < 1e-11
    np.testing.assert_allclose(second.heights[partner], first.heights, rtol=1e-10)
