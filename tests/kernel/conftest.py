"""What the kernel's tests share: one helper per idea, and a few nets to run them on."""

import os
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import settings
from scipy.spatial.transform import Rotation

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, IntArray
from spheremesh.kernel.surfaces.circular_nets import (
    catenoid_net,
    ellipsoid_net,
    enneper_net,
    roof_net,
    torus_net,
    vase_net,
)

settings.register_profile("kernel", deadline=None, derandomize=True, max_examples=30)
settings.register_profile("nightly", deadline=None, max_examples=300, print_blob=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "kernel"))


@pytest.fixture(scope="session")
def assert_spheres_close() -> Callable[..., None]:
    """Compare unit rows up to sign (or oriented), in units of a size."""

    def check(
        actual: FloatArray,
        expected: FloatArray,
        tolerance: float = 1e-12,
        size: float = 1.0,
        *,
        oriented: bool = False,
    ) -> None:
        units = np.array([size, 1.0, 1.0, 1.0, 1 / size])
        a, b = np.broadcast_arrays(actual * units, expected * units)
        sign = 1.0
        if not oriented:
            sign = np.where((a * b).sum(-1, keepdims=True) < 0, -1.0, 1.0)
        magnitude = np.maximum(np.abs(b).max(-1, keepdims=True), 1.0)
        worst = np.abs((a - sign * b) / magnitude).max()
        assert worst <= tolerance, f"spheres differ by {worst:.3g} of their size"

    return check


@pytest.fixture(scope="session")
def rotation() -> FloatArray:
    """A rotation without symmetry."""
    return Rotation.from_rotvec([0.3, -1.1, 0.7]).as_matrix()


@pytest.fixture(scope="session")
def renumber() -> Callable[[Mesh], tuple[Mesh, IntArray]]:
    """Shuffle vertices and faces and turn the faces; face i becomes face `new[i]`."""

    def apply(mesh: Mesh) -> tuple[Mesh, IntArray]:
        rng = np.random.default_rng(5)
        vertices, new = rng.permutation(mesh.n_vertices), rng.permutation(mesh.n_faces)
        points = np.empty_like(mesh.vertices)
        points[vertices] = mesh.vertices
        faces: list[IntArray] = [np.zeros(0, np.int64)] * mesh.n_faces
        for i, face in enumerate(mesh.faces):
            faces[new[i]] = np.roll(vertices[face], rng.integers(len(face)))
        return Mesh(points, faces), new

    return apply


@pytest.fixture(scope="session")
def nets() -> dict[str, Mesh]:
    """Small circular nets of every kind of curvature."""
    return {
        "torus": torus_net(24, 12, 3.0, 1.0),
        "ellipsoid": ellipsoid_net(20, 9, 2.0, 3.0, 1.2),
        "egg": ellipsoid_net(20, 12, 1.0, 1.4, 1.3),
        "catenoid": catenoid_net(16, 8, 1.0, 1.0),
        "vase": vase_net(20, 12, 1.0, 3.0, 0.3),
        "enneper": enneper_net(10, 0.8),
        "roof": roof_net(12, 10, 40.0),
    }


@pytest.fixture(scope="session")
def ball() -> Mesh:
    """A net inscribed in the sphere of radius 2 about the origin, seen from outside."""
    return ellipsoid_net(16, 8, 2.0, 2.0, 1.2)


@pytest.fixture(scope="session")
def octahedron() -> Mesh:
    """Eight triangles inscribed in the unit sphere, seen from outside."""
    vertices = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
    upper = [[i, (i + 1) % 4, 4] for i in range(4)]
    lower = [[(i + 1) % 4, i, 5] for i in range(4)]
    return Mesh(vertices, upper + lower)


class CurvedGrid(NamedTuple):
    """A triangulation with shifted rows, its exact normals and curvatures along two ways."""

    mesh: Mesh
    normals: FloatArray
    around: FloatArray
    across: FloatArray


def shifted_triangles(n: int, m: int, *, closed: bool) -> IntArray:
    """Triangles (T, 3) of n columns and m rows, every second row shifted to the right."""
    i, j = np.meshgrid(np.arange(n - (not closed)), np.arange(m - (not closed)), indexing="ij")
    a, b = i * m + j, (i + 1) % n * m + j
    c, d = (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m
    even = np.stack([a, b, d, b, c, d], -1)
    odd = np.stack([a, b, c, a, c, d], -1)
    return np.where((j % 2 == 0)[..., None], even, odd).reshape(-1, 3)


@pytest.fixture(scope="session")
def curved_grids() -> dict[str, CurvedGrid]:
    """Torus and ellipsoid with normals inwards, catenoid with normals outwards."""
    i, j = np.meshgrid(np.arange(24), np.arange(17), indexing="ij")
    turn, height = ((i + 0.5 * (j % 2)) / 23.5).ravel(), 1.2 * (j.ravel() / 8 - 1)
    shape = shifted_triangles(24, 17, closed=False)

    def _revolve(radius: FloatArray, turns: FloatArray, z: FloatArray) -> FloatArray:
        return np.stack([radius * np.cos(turns), radius * np.sin(turns), z], -1)

    cosh, u = np.cosh(height), 1.2 * np.pi * turn
    catenoid = CurvedGrid(
        Mesh(_revolve(cosh, u, height), shape),
        _revolve(1 / cosh, u, -np.tanh(height)),
        -1 / cosh**2,
        1 / cosh**2,
    )
    u, radius = 1.4 * np.pi * turn, np.sqrt(1 - (height / 1.6) ** 2)
    gradient = _revolve(radius, u, height / 1.6**2)
    size = np.sqrt((gradient**2).sum(1))
    ellipsoid = CurvedGrid(
        Mesh(_revolve(radius, u, height), shape[:, ::-1]),
        -gradient / size[:, None],
        1 / size,
        1 / (1.6**2 * size**3),
    )
    i, j = np.meshgrid(np.arange(36), np.arange(16), indexing="ij")
    u, v = 2 * np.pi * ((i + 0.5 * (j % 2)) / 36).ravel(), 2 * np.pi * j.ravel() / 16
    radius = 2 + 0.8 * np.cos(v)
    torus = CurvedGrid(
        Mesh(
            _revolve(radius, u, 0.8 * np.sin(v)),
            shifted_triangles(36, 16, closed=True)[:, ::-1],
        ),
        -_revolve(np.cos(v), u, np.sin(v)),
        np.cos(v) / radius,
        np.full(len(v), 1 / 0.8),
    )
    return {"catenoid": catenoid, "ellipsoid": ellipsoid, "torus": torus}
