"""Model change, support types, subdivision and remeshing in figures.

    python benchmarks/models.py [MESH ...]

With mesh files it remeshes those as well.
"""

import sys
import time
import warnings
from collections import Counter

import igl
import numpy as np

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import dot, norm, unit
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.isotropic_remeshing import even_share
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.sphere_meshes.mobius import map_sphere_mesh
from spheremesh.kernel.sphere_meshes.model_change import (
    SIGNS,
    Branch,
    Geometry,
    change_model,
    model_points,
    model_spheres,
    sphere_bundle,
)
from spheremesh.kernel.sphere_meshes.sphere_mesh import vertex_error
from spheremesh.kernel.sphere_meshes.support_type import support_type
from spheremesh.kernel.spheres.incidence import evaluate
from spheremesh.kernel.spheres.minkowski import minkowski
from spheremesh.kernel.spheres.mobius_group import (
    compose,
    inversion,
    rotation_about,
    similarity,
)
from spheremesh.kernel.spheres.mobius_images import map_spheres
from spheremesh.kernel.spheres.rows import recenter
from spheremesh.nodes import (
    enneper_mesh,
    fit_spheres,
    intersection_angles,
    minimize_angles,
    read_mesh,
    remesh_triangles,
    roof_mesh,
    torus_mesh,
    triangulate,
    vase_mesh,
)

CENTER = np.array([0.3, -0.2, 0.4])
GEOMETRIES: tuple[Geometry, ...] = ("hyperbolic", "elliptic")
BRANCHES: tuple[Branch, ...] = ("inner", "outer")


def model_change() -> None:
    """E7: products of the branches, and images of planes, on 10,000 points."""
    rng = np.random.default_rng(0)
    points = unit(rng.normal(size=(10000, 3))) * rng.uniform(0, 1, (10000, 1)) ** 3
    normals = unit(rng.normal(size=points.shape))
    for geometry in GEOMETRIES:
        images = {b: model_points(points, geometry, 1.0, b) for b in BRANCHES}
        products = np.abs(dot(images["inner"], images["outer"]) - SIGNS[geometry]).max()
        rows = model_spheres(normals, dot(normals, points), geometry, 1.0)
        miss = max(
            (np.abs(evaluate(rows, image)) / (1 + dot(image, image))).max()
            for image in images.values()
        )
        print(f"E7 {geometry}: product misses by {products:.1e}, planes by {miss:.1e}")


def supported() -> dict[str, SphereMesh]:
    """Triangles of a torus through every map."""
    net = triangulate(torus_mesh(24, 12, 2.0, 0.8))
    shapes = {
        f"{geometry} {branch}": change_model(
            net, geometry, {"hyperbolic": 3.6, "elliptic": 2.5}[geometry], CENTER, branch
        )
        for geometry in GEOMETRIES
        for branch in BRANCHES
    }
    return {**shapes, "bundle": sphere_bundle(net, CENTER + np.array([0, 0, 2]), 2.0)}


def support_types() -> None:
    """E8: types and ω after 200 random Möbius maps, and with noise."""
    rng = np.random.default_rng(1)
    for name, shape in supported().items():
        omega = support_type(shape).omega
        kinds: dict[float, Counter[str]] = {noise: Counter() for noise in (0, 1e-9, 1e-6, 1e-5)}
        worst = refused = 0.0
        for _ in range(200):
            place = unit(rng.normal(size=3)) * rng.uniform(4, 7)
            turn = similarity(
                rng.uniform(0.1, 10), rotation_about(rng.normal(size=3)), 5 * rng.normal(size=3)
            )
            transform = compose([inversion(place, rng.uniform(2, 3)), turn])
            try:
                image = map_sphere_mesh(shape, transform)
            except InputError:
                refused += 1
                continue
            found, expected = support_type(image), map_spheres(omega, transform)
            expected /= np.sqrt(abs(minkowski(expected, expected))) if name != "bundle" else 1
            expected *= 1 / expected[0] if name == "bundle" else np.sign(expected[0])
            worst = max(worst, float(norm(found.omega - expected) / norm(expected)))
            extent = float(norm(image.mesh.vertices.std(axis=0)))
            size = np.array([1 / extent, 1, 1, 1, extent])
            for noise, count in kinds.items():
                rows = image.local_spheres
                rows = rows + noise * size * rng.normal(size=rows.shape)
                count[support_type(SphereMesh.from_local(image.mesh, rows)).kind] += 1
        print(f"E8 {name}: ω to {worst:.1e} ({refused:.0f} maps refused: through a face)")
        for noise, count in kinds.items():
            print(f"   noise {noise:g}: {dict(count)}")


def bundles() -> None:
    """E9: distance of the common point from all spheres."""
    for net in (torus_mesh(), vase_mesh(), roof_mesh(length=6.0)):
        center = np.array([0.3, 0.1, 4.0])
        image = sphere_bundle(triangulate(net), center, 1.5)
        miss = np.abs(evaluate(recenter(image.spheres, center), np.zeros(3))).max()
        error = vertex_error(image).max()
        print(f"E9: {net.n_faces} quads, spheres miss the point by {miss:.1e}, {error:.1e}")


def triangle_pencils() -> None:
    """E10: mean angles of triangles, planar and optimal."""
    nets = {"torus": torus_mesh(), "vase": vase_mesh(), "roof": roof_mesh()}
    for name, net in nets.items():
        triangles = triangulate(net)
        start = time.perf_counter()
        best = minimize_angles(fit_spheres(triangles))
        seconds = time.perf_counter() - start
        means = [intersection_angles(best.sphere_mesh, r).mean() for r in ("planes", "spheres")]
        steps = best.report["iterations"]
        print(f"E10 {name}: {means[0]:.2f} -> {means[1]:.2f} degrees, {steps}, {seconds:.2f} s")


def remeshing(meshes: dict[str, Mesh]) -> None:
    """Evenness, angles and distances of remeshed surfaces."""
    for name, mesh in meshes.items():
        surface = triangulate(mesh)
        for factor in (0.5, 1.0, 2.0):
            length = factor * mean_edge_length(mesh)
            start = time.perf_counter()
            result = remesh_triangles(mesh, length)
            seconds = time.perf_counter() - start
            corners = result.vertices[result.corners].reshape(-1, 3, 3)
            sides = unit(np.roll(corners, -1, axis=1) - corners)
            angles = np.degrees(np.arccos(-dot(sides, np.roll(sides, 1, axis=1))))
            there, back = (
                np.sqrt(igl.point_mesh_squared_distance(a, b, c.reshape(-1, 3))[0]).max()
                for a, b, c in (
                    (result.vertices, surface.vertices, surface.corners),
                    (surface.vertices, result.vertices, result.corners),
                )
            )
            print(
                f"{name} x {factor:g}: {mesh.n_faces} -> {result.n_faces}, "
                f"even {100 * even_share(result, length):.2f} %, "
                f"least angle {angles.min():.0f} (1 % below {np.percentile(angles, 1):.0f}), "
                f"off by {there / length:.1e} and {back / length:.3f} edges, {seconds:.1f} s"
            )


def main() -> None:
    """Print every figure."""
    warnings.simplefilter("ignore")
    model_change()
    support_types()
    bundles()
    triangle_pencils()
    meshes = {"torus": torus_mesh(), "roof": roof_mesh(), "enneper": enneper_mesh()}
    remeshing({**meshes, **{path: read_mesh(path) for path in sys.argv[1:]}})


if __name__ == "__main__":
    main()
