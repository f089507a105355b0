"""Laws of triangulations in rows: six neighbours, third-order points, the same surface."""

from collections.abc import Callable

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, IntArray, dot, norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.mesh import face_normals, face_vector_areas, reversed_corners
from spheremesh.kernel.shifted_rows import Rows, shifted_rows
from spheremesh.kernel.subdivision import subdivide_catmull_clark
from spheremesh.kernel.surfaces import ellipsoid_net, enneper_net, torus_net

ROWS: list[Rows] = ["sharper", "flatter"]


def counts(mesh: Mesh) -> tuple[int, int]:
    """Euler characteristic, and number of boundary edges."""
    rim = int((mesh.topology.twins < 0).sum())
    used = len(np.unique(mesh.corners))
    return used - len(mesh.topology.edge_corners) - rim + mesh.n_faces, rim


@pytest.mark.parametrize("rows", ROWS)
@pytest.mark.parametrize("name", ["torus", "ellipsoid", "enneper", "roof", "vase"])
def test_law_every_inner_vertex_has_six_neighbors(
    name: str, rows: Rows, nets: dict[str, Mesh]
) -> None:
    mesh = nets[name]
    result = shifted_rows(mesh, rows)
    inner = ~result.topology.is_boundary_vertex
    assert (np.bincount(result.corners)[inner] == 6).all()
    assert counts(result)[0] == counts(mesh)[0]
    areas = [norm(face_vector_areas(m)).sum() for m in (result, mesh)]
    np.testing.assert_allclose(*areas, rtol=0.03)
    # Each triangle looks the way of the nearest face.
    middles = result.vertices[result.corners].reshape(-1, 3, 3).mean(1)
    centers = np.array([mesh.vertices[face].mean(0) for face in mesh.faces])
    nearest = norm(middles[:, None] - centers).argmin(axis=1)
    assert (dot(face_normals(result), face_normals(mesh)[nearest]) > 0.5).all()


def test_law_rows_follow_the_sharper_or_the_flatter_curvature() -> None:
    # On a slender torus the tube circles bend more; they are the rows that stay whole.
    mesh = torus_net(24, 12, 3.0, 1.0)
    for rows, shifted in (("sharper", 12 * 12), ("flatter", 6 * 24)):
        result = shifted_rows(mesh, rows)  # type: ignore[arg-type]
        gaps = norm(result.vertices[:, None] - mesh.vertices).min(axis=1)
        assert (gaps > 1e-6).sum() == shifted
        fresh = result.vertices[gaps > 1e-6]
        side = norm(fresh[:, :2]) - 3
        tube, turn = np.arctan2(fresh[:, 2], side), np.arctan2(fresh[:, 1], fresh[:, 0])
        across = (tube * 6 / np.pi) if rows == "sharper" else (turn * 12 / np.pi)
        np.testing.assert_allclose(across % 1, 0.5, atol=1e-9)


def test_law_new_vertices_are_close_to_the_surface() -> None:
    for closed in (True, False):
        errors = []
        for n in (12, 24, 48):
            if closed:
                mesh = shifted_rows(torus_net(2 * n, n, 3.0, 1.0))
                side = norm(mesh.vertices[:, :2]) - 3
                error = np.abs(np.hypot(side, mesh.vertices[:, 2]) - 1).max()
            else:
                mesh = shifted_rows(ellipsoid_net(4 * n, n, 2.0, 2.0, 1.2), "flatter")
                error = np.abs(norm(mesh.vertices) - 2).max()
            errors.append(error)
        # Fourth order, at the ends of rows third.
        order = 14 if closed else 7
        assert errors[0] > order * errors[1] > order**2 * errors[2] > 0


def test_law_flat_grids_become_regular() -> None:
    x, y = np.meshgrid(np.arange(7.0), np.arange(5.0), indexing="ij")
    ids = np.arange(35).reshape(7, 5)
    faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1).reshape(
        -1, 4
    )
    mesh = Mesh(np.stack([x, y, 0 * x], -1).reshape(-1, 3), faces)
    result = shifted_rows(mesh)
    areas = face_vector_areas(result)[:, 2]
    np.testing.assert_allclose(areas.sum(), 24, rtol=1e-14)
    assert set(np.round(areas, 12)) == {0.25, 0.5}
    # Outer rows stay: their number is odd both ways.
    assert counts(result) == (1, counts(mesh)[1])


@pytest.mark.parametrize("name", ["enneper", "roof"])
def test_law_does_not_depend_on_numbering_units_and_place(
    name: str,
    nets: dict[str, Mesh],
    rotation: FloatArray,
    renumber: Callable[[Mesh], tuple[Mesh, IntArray]],
) -> None:
    # An odd number of rows both ways, so that no choice is left.
    mesh = {"enneper": enneper_net(10, 0.8), "roof": nets["roof"]}[name]
    rows: Rows = "flatter"

    def described(shape: Mesh) -> FloatArray:
        faces = shape.vertices[shape.corners].reshape(-1, 3, 3)
        table = np.concatenate([faces.mean(1), face_vector_areas(shape)], 1)
        return table[np.lexsort(np.round(table, 5).T)]

    if name == "enneper":
        # Both families bend alike: stretch the surface so that one bends more.
        mesh = Mesh(mesh.vertices * [1.0, 1.5, 1.0], mesh.faces)
    expected = described(shifted_rows(mesh, rows))
    shuffled = described(shifted_rows(renumber(mesh)[0], rows))
    np.testing.assert_allclose(shuffled, expected, atol=1e-9)
    for scale, shift in ((1e3, 0.0), (1e-3, 0.0), (1.0, 1e6)):
        moved = Mesh(scale * (mesh.vertices @ rotation.T + shift), mesh.faces)
        result = shifted_rows(moved, rows)
        back = Mesh((result.vertices / scale - shift) @ rotation, result.faces)
        np.testing.assert_allclose(described(back), expected, atol=1e-7)


def test_law_turned_nets_give_turned_triangles(nets: dict[str, Mesh]) -> None:
    mesh = nets["roof"]
    turned = Mesh(mesh.vertices, reversed_corners(mesh).reshape(-1, 4))
    areas = [face_vector_areas(shifted_rows(m)).sum(0) for m in (mesh, turned)]
    np.testing.assert_allclose(areas[0], -areas[1], atol=1e-9)


def test_bad_input_is_named(octahedron: Mesh, nets: dict[str, Mesh]) -> None:
    with pytest.raises(InputError, match=r"faces \[0, 1, .*\] are no quadrilaterals"):
        shifted_rows(octahedron)
    with pytest.raises(InputError, match=r"faces \[0, 1, .*\] belong to a net in which rows"):
        shifted_rows(subdivide_catmull_clark(octahedron))
    with pytest.raises(InputError, match=r"faces \[0, .*\] lie in an odd number of rows"):
        shifted_rows(torus_net(9, 12, 3.0, 1.0))
    shifted_rows(torus_net(9, 12, 3.0, 1.0), "flatter")
    with pytest.raises(InputError, match="rows must be sharper or flatter"):
        shifted_rows(nets["torus"], "longer")  # type: ignore[arg-type]
    lonely = Mesh(np.vstack([nets["torus"].vertices, [[9, 9, 9]]]), nets["torus"].faces)
    assert shifted_rows(lonely).n_vertices == shifted_rows(nets["torus"]).n_vertices
