"""What hexagonal sphere meshes promise, in figures: shapes, axes, sizes, panels, time.

    python benchmarks/hexagons.py [MESH ...]

Triangle meshes given as files are evolved, made hexagonal, cut into panels and written.
"""

import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray
from spheremesh.nodes import (
    evolve_spheres,
    panels,
    read_mesh,
    sphere_congruence,
    tangent_sphere_shex,
    tangent_spheres,
    write_step,
)

Surface = Callable[[FloatArray, FloatArray], FloatArray]


def shifted_grid(surface: Surface, n: int, m: int, *, closed: bool, outside: bool) -> Mesh:
    """Triangles over [0, 1]², every second row shifted, from n x m vertices."""
    i, j = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    shifted = i + 0.5 * (j % 2)
    u, v = (shifted / n, j / m) if closed else (shifted / (n - 0.5), j / (m - 1))
    a, b = np.meshgrid(np.arange(n - (not closed)), np.arange(m - (not closed)), indexing="ij")
    p, q = a * m + b, (a + 1) % n * m + b
    r, s = (a + 1) % n * m + (b + 1) % m, a * m + (b + 1) % m
    even, odd = np.stack([p, q, s, q, r, s], -1), np.stack([p, q, r, p, r, s], -1)
    triangles = np.where((b % 2 == 0)[..., None], even, odd).reshape(-1, 3)
    return Mesh(surface(u.ravel(), v.ravel()), triangles if outside else triangles[:, ::-1])


def revolve(radius: FloatArray, turn: FloatArray, height: FloatArray) -> FloatArray:
    """Points at angles about the z axis."""
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), height], -1)


def catenoid(u: FloatArray, v: FloatArray) -> FloatArray:
    """Six tenths of a catenoid."""
    height = 1.2 * (2 * v - 1)
    return revolve(np.cosh(height), 1.2 * np.pi * u, height)


def ellipsoid(u: FloatArray, v: FloatArray) -> FloatArray:
    """Seven tenths of the belt of a spheroid."""
    height = 1.2 * (2 * v - 1)
    return revolve(np.sqrt(1 - (height / 1.6) ** 2), 1.4 * np.pi * u, height)


def torus(u: FloatArray, v: FloatArray) -> FloatArray:
    """A torus of radii 2 and 0.8."""
    tube = 2 * np.pi * v
    return revolve(2 + 0.8 * np.cos(tube), 2 * np.pi * u, 0.8 * np.sin(tube))


def shapes() -> None:
    """Constant offset against central spheres, on both signs of curvature."""
    for name, surface, outside in (
        ("catenoid", catenoid, True),
        ("ellipsoid", ellipsoid, False),
    ):
        mesh = shifted_grid(surface, 24, 17, closed=False, outside=outside)
        for kind, spheres in (
            ("offset 0.35", tangent_spheres(mesh, 0.35)),
            ("central", sphere_congruence(mesh)),
        ):
            found = tangent_sphere_shex(mesh, spheres).report
            print(
                f"{name:10s}{kind:12s}{found['faces']} faces: {found['convex']} convex, "
                f"{found['bow_tie']} bow-tie, {found['crossing']} crossing, "
                f"{found['imaginary']} imaginary; "
                f"off their spheres {found['vertex_error']['max']:.1e}"
            )


def tell(name: str, mesh: Mesh, side: str = "auto", *, flips: bool = True) -> None:
    """Evolve, make hexagons, and say how good they are and how long it took."""
    start, cpu = time.perf_counter(), time.process_time()
    grown = evolve_spheres(mesh, 15.0, side, flips=flips)
    made = tangent_sphere_shex(grown.mesh, grown.spheres)
    seconds, cpu = time.perf_counter() - start, time.process_time() - cpu
    report, found = grown.report, made.report
    inner = int((~grown.mesh.topology.is_boundary_vertex).sum())
    print(
        f"{name:20s}{mesh.n_vertices:6d} vertices: {found['convex']} of {inner} convex, "
        f"{len(report['bad_faces'])} listed as bad; "
        f"axes p95 {report['axis_angle_deg']['p95']:.2f} max "
        f"{report['axis_angle_deg']['max']:.2f}; "
        f"λ/ρ mean {report['lambda_over_rho']['mean']:.2f}; {report['flips']} flips, "
        f"valences {report['valences']}; {seconds:.1f} s ({cpu:.1f} s CPU)"
    )
    assert found["faces"] + len(found["left_out"]) == inner
    assert len(report["bad_faces"]) == inner - found["convex"]


def evolution() -> None:
    """Grids along and across the larger curvature, with and without flips, small and large."""
    doughnut = shifted_grid(torus, 36, 16, closed=True, outside=False)
    tell("torus", doughnut)
    tell("torus, no flips", doughnut, flips=False)
    saddle = shifted_grid(catenoid, 24, 17, closed=False, outside=True)
    tell("catenoid, good rows", saddle, "minus")
    tell("catenoid, adverse", saddle, "plus")
    tell("catenoid, no flips", saddle, "plus", flips=False)
    dome = shifted_grid(ellipsoid, 24, 17, closed=False, outside=False)
    tell("ellipsoid", dome)
    tell("torus", shifted_grid(torus, 200, 100, closed=True, outside=False))
    tell("catenoid", shifted_grid(catenoid, 200, 100, closed=False, outside=True))
    tell("ellipsoid", shifted_grid(ellipsoid, 200, 100, closed=False, outside=False))


def write_panels(path: Path) -> None:
    """Evolve a mesh, cut it in both ways and write it."""
    mesh = read_mesh(path)
    for side in ("plus", "minus"):
        tell(f"{path.stem}, {side}", mesh, side)
        grown = evolve_spheres(mesh, 15.0, side)
        made = tangent_sphere_shex(grown.mesh, grown.spheres)
        inner = int((~mesh.topology.is_boundary_vertex).sum())
        for edges in ("bisector", "intersection"):
            cut = panels(made.sphere_mesh, edges=edges, thickness=0.02)
            with tempfile.TemporaryDirectory() as folder:
                file = Path(write_step(cut.panels, Path(folder) / "panels.step"))
                size = file.stat().st_size
            listed = len(cut.report["rejected"]) + len(made.report["left_out"])
            print(
                f"  {edges:13s}{cut.report['written']} of {inner} written "
                f"({size / 1e6:.1f} MB), {listed} listed; largest gap "
                f"{cut.report['edge_gap']['relative_to_edge']:.1e} of an edge"
            )


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    shapes()
    evolution()
    for argument in sys.argv[1:]:
        write_panels(Path(argument))
