"""What the tests of fabrication share: spheres on given faces, and panels in few moulds."""

import os
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.optimization.radius_clustering import cluster_radii
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.panels import Panels
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres


@pytest.fixture(scope="session")
def curved() -> Callable[[Mesh, FloatArray | list[float] | float], SphereMesh]:
    """Spheres through the circles of the faces; angle 0 is the plane, ±π/2 half a sphere."""

    def through_circles(mesh: Mesh, angles: FloatArray | list[float] | float) -> SphereMesh:
        planes, great_spheres = circle_pencils(face_circles(mesh)[0])
        each = np.broadcast_to(np.asarray(angles, float), mesh.n_faces)
        return SphereMesh.from_local(mesh, pencil_spheres(planes, great_spheres, each))

    return through_circles


@pytest.fixture(scope="session")
def squares(curved: Callable[..., SphereMesh]) -> Callable[..., SphereMesh]:
    """Unit squares in a row under spheres of the given half openings."""

    def in_a_row(*angles: float) -> SphereMesh:
        points = [[x, y, 0.0] for x in range(len(angles) + 1) for y in (0, 1)]
        faces = [[2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1] for i in range(len(angles))]
        return curved(Mesh(points, faces), list(angles))

    return in_a_row


@pytest.fixture(scope="session")
def moulded() -> Callable[..., Panels]:
    """Panels cut of the smoothest spheres in three moulds."""

    def cut(sphere_mesh: SphereMesh, *lengths: float, **options: str) -> Panels:
        found, clusters = cluster_radii(minimize_angles(sphere_mesh)[0], 3)
        panels, rejected = cut_panels(found, "bisector", *lengths, clusters.labels, **options)
        assert not rejected
        return panels

    return cut


def left(path: Path, age: float) -> Path:
    """Something of an age, as a killed process left it; a folder if it has no suffix."""
    if path.suffix:
        path.write_text("half")
    else:
        path.mkdir()
        (path / "model.3dm").write_text("half")
    then = time.time() - age
    os.utime(path, (then, then))
    return path


@pytest.fixture
def leave() -> Callable[[Path, float], Path]:
    """Something of an age in seconds, as a killed process left it."""
    return left
