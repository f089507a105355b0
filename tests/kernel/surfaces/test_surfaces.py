"""Circular nets: exactly circular at every size, outward, of the counts asked for."""

from collections.abc import Callable

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, dot, norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import (
    face_centroids,
    face_normals,
    face_vector_areas,
    mean_edge_length,
)
from spheremesh.kernel.spheres.circles import face_circles
from spheremesh.kernel.surfaces.circular_nets import (
    catenoid_net,
    ellipsoid_net,
    enneper_net,
    roof_net,
    torus_net,
    vase_net,
)
from spheremesh.kernel.surfaces.triangulated import triangulated_surface

CASES: list[tuple[Callable[..., Mesh], tuple[float, ...], int]] = [
    (torus_net, (3, 3, 3.0, 1.0), 9),
    (torus_net, (24, 12, 3.0, 2.9), 288),
    (torus_net, (60, 5, 1e4, 1.0), 300),
    (ellipsoid_net, (3, 1, 1.0, 1.0, 0.5), 3),
    (ellipsoid_net, (20, 9, 2.0, 3.0, 1.5), 180),
    (ellipsoid_net, (12, 6, 1e-3, 4e-3, 1.2), 72),
    (catenoid_net, (3, 1, 1.0, 0.5), 3),
    (catenoid_net, (24, 10, 1.0, 2.5), 240),
    (catenoid_net, (16, 8, 250.0, 100.0), 128),
    (vase_net, (3, 1, 1.0, 1.0, 0.0), 3),
    (vase_net, (20, 16, 1.0, 3.0, 0.9), 320),
    (vase_net, (20, 16, 1.0, 3.0, -0.5), 320),
    (enneper_net, (1, 0.5), 1),
    (enneper_net, (7, 0.8), 49),
    (enneper_net, (20, 1.5), 400),
    (roof_net, (1, 1, 1.0), 1),
    (roof_net, (12, 10, 40.0), 120),
    (roof_net, (33, 47, 1e3), 1551),
]
NAMES = [f"{make.__name__}-{count}" for make, _, count in CASES]


def grid(mesh: Mesh, columns: int) -> FloatArray:
    return mesh.vertices.reshape(-1, columns, 3)


@pytest.mark.parametrize(("make", "sizes", "count"), CASES, ids=NAMES)
def test_law_nets_are_exactly_circular(
    make: Callable[..., Mesh], sizes: tuple[float, ...], count: int
) -> None:
    mesh = make(*sizes)
    assert mesh.n_faces == count
    assert (mesh.degrees == 4).all()
    circles, miss = face_circles(mesh)
    assert miss.max() < 1e-12 * np.abs(mesh.vertices).max()
    radii = np.sqrt(circles.radii_squared)
    assert (radii > 0).all()
    assert norm(face_vector_areas(mesh)).min() > 0
    assert mesh.n_vertices == len(np.unique(mesh.corners))


@pytest.mark.parametrize(
    "mesh",
    [
        ellipsoid_net(16, 7, 2.0, 3.0, 1.3),
        vase_net(16, 9, 1.0, 3.0, 0.3),
        catenoid_net(16, 7, 1, 1),
    ],
    ids=["ellipsoid", "vase", "catenoid"],
)
def test_normals_of_surfaces_of_revolution_point_away_from_the_axis(mesh: Mesh) -> None:
    away = face_centroids(mesh) * [1, 1, 0]
    assert (dot(face_normals(mesh), away) > 0).all()


def test_normals_of_the_torus_point_away_from_its_core() -> None:
    mesh = torus_net(24, 12, 3.0, 1.0)
    centroids = face_centroids(mesh)
    flat = centroids * [1, 1, 0]
    core = 3 * flat / norm(flat)[:, None]
    assert (dot(face_normals(mesh), centroids - core) > 0).all()
    # Signed volume: positive for outward normals, near 2 π² R r².
    volume = dot(face_vector_areas(mesh), centroids).sum() / 3
    assert volume == pytest.approx(6 * np.pi**2, rel=0.1)


@pytest.mark.parametrize(
    "mesh", [roof_net(12, 10, 40.0), enneper_net(10, 0.5)], ids=["roof", "enneper"]
)
def test_normals_of_roofs_point_up(mesh: Mesh) -> None:
    assert face_vector_areas(mesh).sum(0)[2] > 0
    assert (face_normals(mesh)[:, 2] > 0).mean() > 0.9


def test_vertices_lie_on_their_surfaces() -> None:
    x, y, z = torus_net(9, 7, 3.0, 1.0).vertices.T
    np.testing.assert_allclose((np.hypot(x, y) - 3) ** 2 + z**2, 1, atol=1e-13)
    x, y, z = ellipsoid_net(9, 7, 2.0, 3.0, 1.2).vertices.T
    np.testing.assert_allclose((x**2 + y**2) / 4 + z**2 / 9, 1, atol=1e-13)
    assert np.abs(z).max() == pytest.approx(3 * np.sin(1.2))
    x, y, z = catenoid_net(9, 6, 0.5, 0.8).vertices.T
    np.testing.assert_allclose(np.hypot(x, y), 0.5 * np.cosh(z / 0.5), rtol=1e-13)
    assert (z.min(), z.max()) == (-0.8, 0.8)
    x, y, z = vase_net(9, 6, 1.0, 3.0, 0.3).vertices.T
    np.testing.assert_allclose(np.hypot(x, y), 1 + 0.3 * np.sin(2 * np.pi * z / 3), rtol=1e-13)
    assert (z.min(), z.max()) == (0, 3)


def test_boundaries() -> None:
    assert (torus_net(5, 4, 2.0, 1.0).topology.twins >= 0).all()
    for mesh, rim in (
        (ellipsoid_net(9, 4, 1.0, 1.0, 1.0), 18),
        (catenoid_net(9, 4, 1.0, 1.0), 18),
        (vase_net(9, 4, 1.0, 1.0, 0.1), 18),
        (enneper_net(5, 0.5), 20),
        (roof_net(6, 4, 10.0), 20),
    ):
        assert (mesh.topology.twins < 0).sum() == rim


@pytest.mark.parametrize("n", [3, 8, 15])
def test_law_enneper_net_is_minimal(n: int) -> None:
    """Christoffel dual of its Gauss image: edges parallel, lengths inverse, signs alternating.

    Then offsets along the Gauss image change areas only to second order: mean curvature zero.
    """
    size = 0.8
    parameters = np.linspace(-size, size, n + 1)
    u, v = np.meshgrid(parameters, parameters, indexing="ij")
    square = u**2 + v**2
    gauss = np.stack([2 * u, 2 * v, 1 - square], -1) / (square + 1)[..., None]
    mesh = enneper_net(n, size)
    points = grid(mesh, n + 1).transpose(1, 0, 2)
    step = (2 * size / n) ** 2
    for axis, sign in ((0, 1.0), (1, -1.0)):
        image = np.diff(gauss, axis=axis)
        expected = sign * step * image / dot(image, image)[..., None]
        np.testing.assert_allclose(np.diff(points, axis=axis), expected, atol=1e-13)
    # Mixed area of each face with its Gauss image: the discrete mean curvature times the area.
    f, g = points, gauss
    d1, d2 = f[1:, 1:] - f[:-1, :-1], f[:-1, 1:] - f[1:, :-1]
    e1, e2 = g[1:, 1:] - g[:-1, :-1], g[:-1, 1:] - g[1:, :-1]
    mixed = np.cross(d1, e2) + np.cross(e1, d2)
    scale = norm(np.cross(d1, d2)).max()
    assert np.abs(mixed).max() < 1e-12 * max(scale, 1)


def test_enneper_converges_to_the_smooth_surface() -> None:
    size = 0.7
    errors = []
    for n in (8, 16):
        parameters = np.linspace(-size, size, n + 1)
        u, v = np.meshgrid(parameters, parameters, indexing="ij")
        smooth = (
            np.stack([u + u * v**2 - u**3 / 3, -v - u**2 * v + v**3 / 3, v**2 - u**2], -1) / 2
        )
        points = grid(enneper_net(n, size), n + 1).transpose(1, 0, 2)
        errors.append(np.abs(points - smooth + smooth.mean((0, 1))).max())
    assert errors[0] < 0.02
    assert errors[1] < errors[0] / 3


def test_the_roof_is_a_roof() -> None:
    mesh = roof_net(16, 20, 60.0)
    x, y, z = mesh.vertices.T
    assert np.ptp(x) == pytest.approx(60.0)
    assert np.ptp(x) > np.ptp(y) > np.ptp(z) > 3
    assert z.min() == 0
    edges = face_circles(mesh)[0].radii_squared
    assert len(np.unique(np.round(edges / edges.max(), 9))) == mesh.n_faces
    double = roof_net(16, 20, 120.0)
    np.testing.assert_allclose(double.vertices, 2 * mesh.vertices, rtol=1e-12)
    assert mean_edge_length(double) == pytest.approx(2 * mean_edge_length(mesh))


@pytest.mark.parametrize(
    ("make", "sizes", "message"),
    [
        (torus_net, (2, 5, 3.0, 1.0), r"\(around\) must be at least 3, not 2"),
        (torus_net, (5, 2, 3.0, 1.0), r"\(across\) must be at least 3, not 2"),
        (torus_net, (5, 5, 1.0, 1.0), "minor radius < major radius"),
        (torus_net, (5, 5, 3.0, 0.0), "0 < minor radius"),
        (torus_net, (5, 5, 3.0, np.nan), "0 < minor radius"),
        (torus_net, (5, 5, np.inf, 1.0), "major radius"),
        (ellipsoid_net, (2, 5, 1.0, 1.0, 1.0), r"\(around\)"),
        (ellipsoid_net, (5, 0, 1.0, 1.0, 1.0), r"\(across\) must be at least 1, not 0"),
        (ellipsoid_net, (5, 5, 0.0, 1.0, 1.0), "radius must be positive"),
        (ellipsoid_net, (5, 5, 1.0, -1.0, 1.0), "height must be positive"),
        (ellipsoid_net, (5, 5, 1.0, np.nan, 1.0), "height must be positive"),
        (ellipsoid_net, (5, 5, 1.0, 1.0, np.pi / 2), "below 90 degrees"),
        (ellipsoid_net, (5, 5, 1.0, 1.0, 0.0), "latitude must be positive"),
        (catenoid_net, (2, 5, 1.0, 1.0), r"\(around\)"),
        (catenoid_net, (5, 5, 0.0, 1.0), "waist must be positive"),
        (catenoid_net, (5, 5, 1.0, np.inf), "height must be positive"),
        (vase_net, (5, 0, 1.0, 1.0, 0.1), r"\(across\)"),
        (vase_net, (5, 5, -1.0, 1.0, 0.1), "radius must be positive"),
        (vase_net, (5, 5, 1.0, 1.0, 1.0), "between -1 and 1"),
        (vase_net, (5, 5, 1.0, 1.0, np.nan), "between -1 and 1"),
        (enneper_net, (0, 1.0), r"\(n\) must be at least 1"),
        (enneper_net, (5, 0.0), "size must be positive"),
        (roof_net, (0, 5, 1.0), r"\(span\) must be at least 1, not 0"),
        (roof_net, (5, 0, 1.0), r"\(length\) must be at least 1, not 0"),
        (roof_net, (5, 5, 0.0), "length must be positive"),
        (roof_net, (5, 5, np.inf), "length must be positive"),
    ],
)
def test_unusable_sizes_are_refused(
    make: Callable[..., Mesh], sizes: tuple[float, ...], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        make(*sizes)


@pytest.mark.parametrize("edge_length", [1e-4, 1e-308])
def test_a_sample_surface_of_too_many_triangles_is_refused(edge_length: float) -> None:
    with pytest.raises(InputError, match="more than 2000000 triangles"):
        triangulated_surface("bump", edge_length)


def test_a_sample_surface_of_boundless_edges_is_refused() -> None:
    with pytest.raises(InputError, match="too large"):
        triangulated_surface("bump", 1e308)
