"""
What remeshing along conjugate directions reaches: directions, regular nets, singular ones, speed.

    python benchmarks/remeshing.py [directions | regular | singular | speed]
"""

import sys
import time
import warnings
from collections import Counter
from collections.abc import Callable

import numpy as np

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, norm, unit
from spheremesh.kernel.congruence import touching_spheres
from spheremesh.kernel.remesh.pipeline import Remeshing, remesh
from spheremesh.kernel.triangulated import triangulated_surface

Surface = tuple[Mesh, FloatArray]


def cube_sphere(n: int) -> tuple[FloatArray, FloatArray]:
    """Directions (V, 3) and triangles of a sphere made of six n by n grids."""
    angles = np.tan(np.linspace(-np.pi / 4, np.pi / 4, n + 1))
    u, v = np.meshgrid(angles, angles, indexing="ij")
    points, triangles = [], []
    for axis in range(3):
        for side in (1.0, -1.0):
            patch = np.stack([np.full_like(u, side), side * u, v], -1)
            ids = len(points) * (n + 1) ** 2 + np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
            a, b, c, d = ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]
            triangles += [np.stack([a, b, c], -1), np.stack([a, c, d], -1)]
            points.append(np.roll(patch, axis, axis=-1).reshape(-1, 3))
    stacked = unit(np.concatenate(points))
    _, first, ids = np.unique(
        np.rint(stacked * 1e6).astype(np.int64), axis=0, return_index=True, return_inverse=True
    )
    faces = ids.ravel()[np.concatenate([t.reshape(-1, 3) for t in triangles])]
    return stacked[first], faces


def star(n: int, radius: Callable[[FloatArray], tuple[FloatArray, FloatArray]]) -> Surface:
    """A closed surface seen as a radius over the sphere, with the gradient of the radius."""
    directions, triangles = cube_sphere(n)
    radii, gradients = radius(directions)
    tangential = gradients - (gradients * directions).sum(1, keepdims=True) * directions
    normals = unit(radii[:, None] * directions - tangential)
    return Mesh(radii[:, None] * directions, triangles), normals


def ellipsoid(d: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Triaxial."""
    axes = np.array([1.6, 1.2, 0.9])
    size = ((d / axes) ** 2).sum(1)
    return size**-0.5, -(size**-1.5)[:, None] * d / axes**2


def pebble(d: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A lopsided stone."""
    x, y, z = d.T
    radii = 1 + 0.18 * x * x - 0.2 * z * z + 0.12 * x * y + 0.1 * y * z * x + 0.08 * x
    gradients = [
        0.36 * x + 0.12 * y + 0.1 * y * z + 0.08,
        0.12 * x + 0.1 * z * x,
        -0.4 * z + 0.1 * y * x,
    ]
    return radii, np.stack(gradients, 1)


def peanut(d: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Waisted, with saddles."""
    x, y, z = d.T
    radii = 1 + 0.55 * x * x - 0.12 * z * z + 0.15 * x * z * y + 0.06 * y
    gradients = [1.1 * x + 0.15 * z * y, 0.15 * x * z + 0.06, -0.24 * z + 0.15 * x * y]
    return radii, np.stack(gradients, 1)


def graph(half: float, counts: int, height: Callable[..., FloatArray]) -> Surface:
    """A height over a square; derivatives by complex steps."""
    line = np.linspace(-half, half, counts + 1)
    u, v = (g.ravel() for g in np.meshgrid(line, line, indexing="ij"))
    ids = np.arange(len(u)).reshape(counts + 1, counts + 1)
    a, b, c, d = ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]
    triangles = np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
    slopes = [np.imag(height(u + 1e-30j, v)), np.imag(height(u, v + 1e-30j))]
    normals = unit(np.stack([-slopes[0] * 1e30, -slopes[1] * 1e30, np.ones(len(u))], 1))
    return Mesh(np.stack([u, v, height(u, v)], 1), triangles), normals


def monkey(u: FloatArray, v: FloatArray) -> FloatArray:
    """A saddle for two legs and a tail, on a slight dome."""
    return 0.2 * (u**3 - 3 * u * v * v) - 0.1 * (u * u + v * v)


def dome(u: FloatArray, v: FloatArray) -> FloatArray:
    """A freeform roof, flat at its rim."""
    return 0.9 * np.exp(-0.5 * u * u - 0.7 * v * v + 0.15 * u * v) + 0.08 * u


def two_hills(u: FloatArray, v: FloatArray) -> FloatArray:
    """Two domes of different height."""
    first = 0.6 * np.exp(-1.6 * (u - 0.7) ** 2 - 1.2 * (v - 0.2) ** 2)
    return first + 0.45 * np.exp(-1.1 * (u + 0.7) ** 2 - 1.7 * (v + 0.3) ** 2)


def singular_surfaces() -> dict[str, tuple[Surface, float, float]]:
    """Surfaces, signed offsets of the centres, and edge lengths."""
    return {
        "ellipsoid": (star(28, ellipsoid), -0.5, 0.2),
        "pebble": (star(28, pebble), -0.5, 0.17),
        "peanut": (star(32, peanut), -0.45, 0.2),
        "open ellipsoid": (triangulated_surface("ellipsoid", 0.07, 1), -0.5, 0.2),
        "monkey": (graph(1.0, 32, monkey), 1.0, 0.16),
        "dome": (graph(1.5, 44, dome), -0.8, 0.2),
        "two hills": (graph(1.6, 48, two_hills), 0.6, 0.2),
        "waves": (triangulated_surface("waves", 0.07, 1), 0.5, 0.2),
    }


def describe(name: str, done: Remeshing, seconds: float) -> None:
    """One line on a net."""
    mesh = done.sphere_mesh.mesh
    topology = mesh.topology
    sides = mesh.vertices[mesh.corners[topology.next_corners]] - mesh.vertices[mesh.corners]
    lengths = norm(sides)
    inner = ~topology.is_boundary_vertex
    valences = np.bincount(mesh.corners, minlength=mesh.n_vertices)[inner]
    sign = sorted(Counter(done.indices.tolist()).items())
    is_inside = inner[mesh.corners] | inner[mesh.corners[topology.next_corners]]
    print(
        f"{name:15s}F {mesh.n_faces:5d}  singular {dict(sign)}  irregular nodes "
        f"{int((valences != 4).sum())}  degrees {dict(sorted(Counter(mesh.degrees.tolist()).items()))}  "
        f"folds {done.n_folded} -> {done.n_flipped}  shortest/mean {lengths.min() / lengths.mean():.3f} "
        f"(inside {lengths[is_inside].min() / lengths.mean():.3f})  complex {100 * done.complex_share:.1f} % moved {100 * done.moved_share:.1f} %  "
        f"sides {done.n_aligned}  {seconds:.1f} s",
        flush=True,
    )


def singular() -> None:
    """Freeform congruences with singular directions: constant signed offsets of the centres."""
    for name, ((mesh, normals), offset, edge) in singular_surfaces().items():
        spheres = touching_spheres(mesh.vertices, normals, np.full(len(normals), 1 / offset))
        start = time.perf_counter()
        done = remesh(mesh, spheres, edge)
        describe(name, done, time.perf_counter() - start)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    chosen = sys.argv[1:] or ["singular"]
    for part in chosen:
        globals()[part]()
