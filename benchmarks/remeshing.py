"""What remeshing along conjugate directions reaches.

python benchmarks/remeshing.py [directions | noise | regular | singular | speed | complex]
"""

import itertools
import sys
import time
import warnings
from collections import Counter
from collections.abc import Callable

import numpy as np
from scipy.spatial import KDTree

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, IntArray, norm, unit
from spheremesh.kernel.congruences.curvature_spheres import touching_spheres
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.tessellation import tessellate
from spheremesh.kernel.remesh.field.conjugate_directions import conjugate_directions
from spheremesh.kernel.remesh.field.conjugate_form import form_roots, split_form
from spheremesh.kernel.remesh.pipeline import Remeshing, remesh
from spheremesh.kernel.remesh.planar.node_planarity import measure_nodes, node_axis_angles
from spheremesh.kernel.remesh.planar.planarize import planarize_held
from spheremesh.kernel.sphere_meshes.sphere_mesh import vertex_error
from spheremesh.kernel.surfaces.triangulated import (
    SHAPES,
    SampleShape,
    grid_counts,
    parameter_grid,
    triangulated_surface,
)
from spheremesh.nodes import p4_remesh, sphere_congruence

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
        "double torus": (double_torus(30), -0.3, 0.1),
        "double torus in": (double_torus(30), 0.25, 0.15),
    }


def double_torus(n: int) -> Surface:
    """A smooth surface of genus two: a level set, with its triangles made even."""
    import igl

    def _level(p: FloatArray) -> tuple[FloatArray, FloatArray]:
        x, y, z = p.T
        q = x * x * (1 - x * x) - y * y
        value = q * q + 0.5 * z * z - 0.025 * (1 + 0.6 * (x * x + y * y))
        slopes = [2 * q * (2 * x - 4 * x**3) - 0.03 * x, -4 * q * y - 0.03 * y, z]
        return value, np.stack(slopes, 1)

    sizes = (1.35, 0.8, 0.5)
    axes = [
        np.linspace(-s, s, round(c * n)) for s, c in zip(sizes, (2, 1.25, 0.8), strict=True)
    ]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), -1).transpose(2, 1, 0, 3).reshape(-1, 3)
    grid = np.ascontiguousarray(grid)
    counts = [len(axis) for axis in axes]
    points, faces = igl.marching_cubes(_level(grid)[0], grid, *counts, 0.0)[:2]
    near = igl.adjacency_matrix(faces.astype(np.int64)).astype(float)
    valences = np.asarray(near.sum(1)).reshape(-1, 1)
    for _ in range(60):
        normals = unit(_level(points)[1])
        step = near @ points / valences - points
        points = points + 0.5 * (step - (step * normals).sum(1, keepdims=True) * normals)
        for _ in range(3):
            value, slope = _level(points)
            points = points - (value / (slope**2).sum(1))[:, None] * slope
    normals = unit(_level(points)[1])
    sides = points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]]
    if (np.cross(*sides) * normals[faces[:, 0]]).sum() < 0:
        faces = faces[:, ::-1]
    return Mesh(points, faces.astype(np.int64)), normals


def net_figures(done: Remeshing) -> str:
    """Faces, irregular places and edges of a net."""
    mesh = done.sphere_mesh.mesh
    mean = mean_edge_length(mesh)
    degrees = dict(sorted(Counter(mesh.degrees.tolist()).items()))
    singular = dict(sorted(Counter(done.indices.tolist()).items()))
    return (
        f"faces {degrees}  singular {singular}  irregular nodes {done.n_irregular}  "
        f"folds {done.n_folded} -> {done.n_flipped}  sides {done.n_aligned}  "
        f"shortest/mean edge {done.shortest_edge / mean:.2f}"
    )


def timed(surface: Surface, offset: float, edge: float) -> tuple[Remeshing, float]:
    """Remesh the tangent spheres of a constant signed offset, and the seconds it takes."""
    mesh, normals = surface
    spheres = touching_spheres(mesh.vertices, normals, np.full(len(normals), 1 / offset))
    start = time.perf_counter()
    done = remesh(mesh, spheres, edge)
    return done, time.perf_counter() - start


def principal_frames(shape: SampleShape, edge: float) -> tuple[FloatArray, FloatArray]:
    """Curvature lines (V, 2, 3) and mean curvatures of a sample, by complex steps."""
    chosen, step = SHAPES[shape], 1e-30
    u, v, _ = parameter_grid(chosen, grid_counts(chosen, edge), 1)
    patch = chosen.patch(u, v)
    area = np.cross(patch.along_u, patch.along_v)
    length = norm(area)[:, None]
    ahead = chosen.patch(u + step * 1j, v), chosen.patch(u, v + step * 1j)
    along = ahead[0].along_u, ahead[0].along_v, ahead[1].along_v
    bend = [(np.imag(part) / step * area / length).sum(1) for part in along]
    e, f, g = (
        (a * b).sum(1)
        for a, b in (
            (patch.along_u, patch.along_u), (patch.along_u, patch.along_v),
            (patch.along_v, patch.along_v),
        )
    )  # fmt: skip
    form = [e * bend[1] - f * bend[0], e * bend[2] - g * bend[0], f * bend[2] - g * bend[1]]
    roots = form_roots(*split_form(np.stack(form, 1)))[:2]
    angles = np.stack(roots, 1)[..., None]
    lines = np.cos(angles) * patch.along_u[:, None] + np.sin(angles) * patch.along_v[:, None]
    mean = (e * bend[2] - 2 * f * bend[1] + g * bend[0]) / (2 * (e * g - f * f))
    return unit(lines), mean


DIRECTIONS: tuple[tuple[SampleShape, str], ...] = (
    ("torus", "constant"), ("hypar", "constant"), ("bump", "constant"),
    ("annulus", "constant"), ("ellipsoid", "constant"), ("hypar", "plane"),
    ("bump", "plane"), ("annulus", "plane"), ("torus", "central"), ("annulus", "central"),
    ("ellipsoid", "central"),
)  # fmt: skip


def directions(noises: tuple[float, ...] = (0.0,)) -> None:
    """Angles between computed directions and curvature lines, on meshes with edges of 0.1."""
    for (shape, kind), noise in itertools.product(DIRECTIONS, noises):
        mesh, normals = triangulated_surface(shape, 0.1, seed=1)
        lines, mean = principal_frames(shape, 0.1)
        curvatures = {
            "constant": np.full(len(normals), 2.0),
            "plane": -(1 + normals[:, 2]) / (mesh.vertices[:, 2] + 3),
            "central": mean,
        }[kind]
        moves = noise * np.random.default_rng(3).normal(size=(2, *normals.shape))
        points = mesh.vertices + mean_edge_length(mesh) * moves[0]
        spheres = touching_spheres(points, unit(normals + moves[1]), curvatures)
        moved = Mesh(points, mesh.corners.reshape(-1, 3))
        found = conjugate_directions(moved, spheres)
        sines = [
            norm(np.cross(found.directions, order)).max(1) for order in (lines, lines[:, ::-1])
        ]
        errors = np.degrees(np.arcsin(np.minimum(np.minimum(*sines), 1)))
        inner = ~mesh.topology.is_boundary_vertex
        axes = np.degrees(found.axis_angles)
        print(
            f"{shape:10s}{kind:9s} noise {noise:<7g}degree {found.degree}  error median "
            f"{np.median(errors[inner]):.4f}  p95 {np.quantile(errors[inner], 0.95):.3f}  with "
            f"boundary p95 {np.quantile(errors, 0.95):.3f} degrees  "
            f"complex {100 * found.complex_share:.2f} %  "
            f"node axes p95 {np.nanquantile(axes, 0.95):.1f} degrees"
        )


def noise() -> None:
    """The same with noise of points (in mean edges) and normals (in radians)."""
    directions((1e-5, 1e-4, 1e-3))


REGULAR: tuple[tuple[SampleShape, float, float], ...] = (
    ("annulus", 0.5, 0.12), ("annulus", 1.5, 0.08), ("hypar", 0.5, 0.12), ("hypar", 0.5, 0.06),
    ("bump", 0.5, 0.12), ("bump", 1.0, 0.08), ("bump", 1.0, 0.06), ("torus", -0.5, 0.2),
    ("torus", -1.1, 0.15), ("torus", -0.5, 0.07),
)  # fmt: skip
"""Shapes, signed radii of the spheres and edge lengths."""


def regular() -> None:
    """Nets of constant radius on simple surfaces: regular, planar, on the surface."""
    for shape, offset, edge in REGULAR:
        done, _ = timed(triangulated_surface(shape, 0.05, seed=1), offset, edge)
        run, is_held = planarize_held(done.sphere_mesh, done.surface)
        net, nodes = run.sphere_mesh, measure_nodes(run.sphere_mesh)
        mean = mean_edge_length(net.mesh)
        angles = np.degrees(node_axis_angles(net, nodes)[nodes.is_inner])
        away = norm(net.mesh.vertices - feet(shape, net.mesh.vertices)) / mean
        print(f"{shape:10s}radius {offset}  {net_figures(done)}")
        print(
            f"    planarity {nodes.planarity.max():.0e}  corner gap "
            f"{vertex_error(net).max() / mean:.0e}  real nodes "
            f"{100 * nodes.is_real[nodes.is_inner].mean():.0f} %  axes p95 "
            f"{np.percentile(angles, 95):.2f} deg  nodes to surface "
            f"{away[nodes.is_inner].max():.0e} edge  {run.iterations} steps  held {is_held}"
        )
        print(f"    {distances(shape, net)}", flush=True)


def feet(shape: SampleShape, points: FloatArray) -> FloatArray:
    """Nearest points of the smooth surface, by Gauss-Newton steps of the parameters."""
    chosen = SHAPES[shape]
    u, v, _ = parameter_grid(chosen, grid_counts(chosen, 0.05), None)
    near = KDTree(chosen.patch(u, v).points).query(points)[1]
    u, v = u[near], v[near]
    for _ in range(8):
        patch = chosen.patch(u, v)
        tangents = np.stack([patch.along_u, patch.along_v], 1)
        slopes = tangents @ (points - patch.points)[..., None]
        step = np.linalg.solve(tangents @ tangents.transpose(0, 2, 1), slopes)[..., 0]
        u, v = u + step[:, 0], v + step[:, 1]
        if not chosen.closed[0]:
            u = np.clip(u, chosen.low[0], chosen.high[0])
        if not chosen.closed[1]:
            v = np.clip(v, chosen.low[1], chosen.high[1])
    return chosen.patch(u, v).points


def triangulate(mesh: Mesh) -> Mesh:
    """Fans of triangles, vertices as they are."""
    fans = [[f[0], f[k], f[k + 1]] for f in mesh.faces for k in range(1, len(f) - 1)]
    return Mesh(mesh.vertices, fans)


def distances(shape: SampleShape, net: SphereMesh) -> str:
    """Largest distances, both ways, between the surface and the flat and spherical faces."""
    import igl

    fine, mean = triangulated_surface(shape, 0.02)[0].vertices, mean_edge_length(net.mesh)

    def _both(points: FloatArray, triangles: IntArray) -> str:
        corners = points[triangles]
        inside = np.concatenate([corners.mean(1), (corners[:, 0] + corners[:, 2]) / 2])
        there = norm(inside - feet(shape, inside)).max()
        back = np.sqrt(igl.point_mesh_squared_distance(fine, points, triangles)[0].max())
        return f"to surface {100 * there / mean:.2f} %, back {100 * back / mean:.2f} %"

    flat = triangulate(net.mesh)
    panels, rejected = cut_panels(net, "intersection")
    curved = tessellate(panels, 1e-3)
    return (
        f"flat faces {_both(flat.vertices, flat.corners.reshape(-1, 3))}; spherical faces "
        f"{_both(curved.points + curved.origin, curved.triangles)}, {len(rejected)} rejected"
    )


def singular() -> None:
    """Freeform congruences with singular directions: constant signed offsets of the centres."""
    for name, (surface, offset, edge) in singular_surfaces().items():
        done, seconds = timed(surface, offset, edge)
        print(f"{name:15s}{net_figures(done)}  {seconds:.1f} s", flush=True)


def speed() -> None:
    """From 20,000 triangles and spheres to the net."""
    cases = {
        "torus": (triangulated_surface("torus", 0.0745, 1), -0.5, 0.2),
        "pebble": (star(41, pebble), -0.5, 0.17),
        "two hills": (graph(1.6, 100, two_hills), 0.6, 0.2),
        "waves": (triangulated_surface("waves", 0.031, 1), 0.5, 0.2),
    }
    for name, (surface, offset, edge) in cases.items():
        before = time.process_time()
        done, seconds = timed(surface, offset, edge)
        used = time.process_time() - before
        print(
            f"{name:10s}{surface[0].n_faces} triangles to {done.sphere_mesh.mesh.n_faces} "
            f"faces: {seconds:.1f} s, {used:.1f} s of processor time"
        )


def complex_directions() -> None:
    """Central spheres have complex directions on much of a freeform surface: it is said."""
    mesh, _ = triangulated_surface("bump", 0.08, 1)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        report = p4_remesh(mesh, sphere_congruence(mesh, "central"), 0.2).report
    print(f"complex share {report['complex_share']:.3f}, warnings:")
    print("\n".join(f"  {entry.message}" for entry in caught))


PARTS: dict[str, Callable[[], None]] = {
    "directions": directions, "noise": noise, "regular": regular, "singular": singular,
    "speed": speed, "complex": complex_directions,
}  # fmt: skip

if __name__ == "__main__":
    for part in sys.argv[1:] or PARTS:
        print(f"-- {part}")
        PARTS[part]()
