"""Torsion-free nodes: how planar, how exact, how far, how fast; relaxed congruences.

Spheres of radius 0.5 touch a torus, a ring of revolution, a hypar and a freeform bump at the
crossings of curvature lines, or of parameter lines, which are far from conjugate. Nodes start
at the means of the four points of contact.

    python benchmarks/planarization.py
"""

import time
from collections.abc import Callable

import numpy as np
from scipy.interpolate import CubicSpline

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, dot, norm, unit
from spheremesh.kernel.congruences.curvature_spheres import sphere_congruence, touching_spheres
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.remesh.field.relax import CongruenceQuality, relax_congruence
from spheremesh.kernel.remesh.planar.node_planarity import measure_nodes, node_axis_angles
from spheremesh.kernel.remesh.planar.planarize import planarize
from spheremesh.kernel.sphere_meshes.sphere_mesh import vertex_error

Surface = Callable[[FloatArray, FloatArray], FloatArray]

STEP = 1e-4
CURVATURE = 2.0


def torus(u: FloatArray, v: FloatArray) -> FloatArray:
    """Radii 2 and 0.7."""
    reach = 2 + 0.7 * np.cos(v)
    return np.stack([reach * np.cos(u), reach * np.sin(u), 0.7 * np.sin(v)], -1)


def ring(u: FloatArray, v: FloatArray) -> FloatArray:
    """Surface of revolution."""
    return np.stack([v * np.cos(u), v * np.sin(u), 0.4 * v**2 - 0.1 * v**3], -1)


def hypar(u: FloatArray, v: FloatArray) -> FloatArray:
    """Saddle."""
    return np.stack([u, v, 0.35 * u**2 - 0.25 * v**2 + 0.1 * u * v], -1)


def bump(u: FloatArray, v: FloatArray) -> FloatArray:
    """Freeform hill with a saddle beside it."""
    hill = 0.5 * np.cos(0.9 * u) * np.cos(0.7 * v + 0.2)
    return np.stack([u, v, hill + 0.1 * u * v + 0.08 * u**3], -1)


def frame(surface: Surface, uv: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Both tangents and the normal, by differences."""
    u, v, h = uv[..., 0], uv[..., 1], STEP
    along_u = (surface(u + h, v) - surface(u - h, v)) / (2 * h)
    along_v = (surface(u, v + h) - surface(u, v - h)) / (2 * h)
    return along_u, along_v, unit(np.cross(along_u, along_v))


def direction(surface: Surface, uv: FloatArray, which: int) -> FloatArray:
    """Curvature direction nearer to a parameter line, of unit length on the surface."""
    u, v, h = uv[..., 0], uv[..., 1], STEP
    a, b, n = frame(surface, uv)
    middle = surface(u, v)
    second = [
        surface(u + h, v) - 2 * middle + surface(u - h, v),
        (surface(u + h, v + h) - surface(u + h, v - h)) / 4
        - (surface(u - h, v + h) - surface(u - h, v - h)) / 4,
        surface(u, v + h) - 2 * middle + surface(u, v - h),
    ]
    first = np.stack([dot(a, a), dot(a, b), dot(b, b)], -1)
    shape = np.stack([dot(vector, n) for vector in second], -1) / h**2
    # first x shape: the form whose roots are the curvature directions.
    p, q, r = np.moveaxis(np.cross(first, shape), -1, 0)
    mean, size = (r + p) / 2, np.hypot((r - p) / 2, q / 2)
    middle_angle = np.arctan2(-q, r - p) / 2
    half = np.arccos(np.clip(-mean / size, -1, 1)) / 2
    angles = middle_angle[..., None] + np.stack([half, -half], -1)
    pairs = np.stack([np.cos(angles), np.sin(angles)], -1)
    chosen = np.abs(pairs[..., which]).argmax(-1)
    line = np.take_along_axis(pairs, chosen[..., None, None], -2)[..., 0, :]
    line = line * np.sign(line[..., which : which + 1])
    return line / norm(line[..., :1] * a + line[..., 1:] * b)[..., None]


def trace(surface: Surface, seeds: FloatArray, which: int, half: float) -> list[CubicSpline]:
    """Curvature lines through seeds, to both sides, by Runge-Kutta steps."""
    ends = np.linspace(0, half, 60)
    sides: list[FloatArray] = []
    for sign in (-1, 1):
        points, h = [seeds], sign * ends[1]
        for _ in ends[1:]:
            x = points[-1]
            k1 = direction(surface, x, which)
            k2 = direction(surface, x + h / 2 * k1, which)
            k3 = direction(surface, x + h / 2 * k2, which)
            k4 = direction(surface, x + h * k3, which)
            points.append(x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4))
        sides.append(np.stack(points, 1))
    lengths = np.concatenate([-ends[:0:-1], ends])
    lines = np.concatenate([sides[0][:, :0:-1], sides[1]], 1)
    return [CubicSpline(lengths, line) for line in lines]


def curvature_net(surface: Surface, center: tuple[float, float], n: int) -> FloatArray:
    """Parameters (n, n, 2) of the crossings of n curvature lines of each family."""
    half = 0.55
    steps = np.linspace(-half, half, n)
    seeds = [trace(surface, np.array([center]), k, half)[0](steps) for k in (0, 1)]
    rows = trace(surface, seeds[1], 0, 1.6 * half)
    columns = trace(surface, seeds[0], 1, 1.6 * half)
    result = np.zeros((n, n, 2))
    for i, column in enumerate(columns):
        for j, row in enumerate(rows):
            s = np.array([steps[i], steps[j]])
            for _ in range(8):
                slopes = np.stack([row(s[0], 1), -column(s[1], 1)], 1)
                s = s - np.linalg.solve(slopes, row(s[0]) - column(s[1]))
            result[i, j] = row(s[0])
    return result


def sphere_net(surface: Surface, uv: FloatArray, closed: tuple[bool, bool]) -> SphereMesh:
    """A face for every grid point, a node for every cell."""
    points = surface(uv[..., 0], uv[..., 1])
    rows = touching_spheres(points, frame(surface, uv)[2], CURVATURE)
    for axis in np.flatnonzero(closed).tolist():
        points = np.concatenate([points, points.take([0], axis)], axis)
    nodes = (points[1:, 1:] + points[:-1, 1:] + points[1:, :-1] + points[:-1, :-1]) / 4
    ids = np.arange(nodes[..., 0].size).reshape(nodes.shape[:2])
    for axis in (0, 1):
        if closed[axis]:
            ids = np.concatenate([ids.take([-1], axis), ids], axis)
        else:
            rows = np.delete(rows, [0, -1], axis)
    faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
    return SphereMesh(Mesh(nodes.reshape(-1, 3), faces.reshape(-1, 4)), rows.reshape(-1, 5))


def grid(u: FloatArray, v: FloatArray) -> FloatArray:
    """Parameters (n, m, 2) of all pairs."""
    return np.stack(np.meshgrid(u, v, indexing="ij"), -1)


def cases(n: int) -> dict[str, SphereMesh]:
    """Nets of about n² nodes."""
    turn, tube = 2 * np.pi * np.arange(2 * n) / (2 * n), 4 * np.pi * np.arange(n // 2) / n
    line = np.linspace(-1, 1, n + 1)
    return {
        "torus": sphere_net(torus, grid(turn, tube), (True, True)),
        "annulus": sphere_net(ring, grid(turn, np.linspace(0.8, 1.9, n // 2)), (True, False)),
        "hypar": sphere_net(hypar, curvature_net(hypar, (0.0, 0.0), n + 1), (False, False)),
        "bump": sphere_net(bump, curvature_net(bump, (-0.6, -0.2), n + 1), (False, False)),
        "bump, parameter lines": sphere_net(bump, grid(line, line), (False, False)),
    }


def planarization() -> None:
    """Every net before and after."""
    for n in (24, 48):
        for name, start in cases(n).items():
            clock = time.perf_counter()
            run = planarize(start)
            seconds = time.perf_counter() - clock
            before, after = measure_nodes(start), measure_nodes(run.sphere_mesh)
            gaps = [
                vertex_error(net).max() / mean_edge_length(net.mesh)
                for net in (start, run.sphere_mesh)
            ]
            angles = np.degrees(node_axis_angles(run.sphere_mesh, after)[after.is_inner])
            print(
                f"{name:22s}{start.mesh.n_vertices:5d} nodes  "
                f"planarity {before.planarity.max():.0e} -> {after.planarity.max():.0e}  "
                f"gap {gaps[0]:.2f} -> {gaps[1]:.0e}  real {after.is_real.sum()} of "
                f"{after.is_inner.sum()}  axes p95 {np.percentile(angles, 95):.2f} max "
                f"{angles.max():.2f} deg  moved {run.shifts.max():.3f} mean "
                f"{run.shifts.mean():.3f}  {run.iterations} steps, {seconds:.1f} s"
            )


def complex_share(spheres: FloatArray) -> float:
    """Share of the points of a square grid without real conjugate directions."""
    n = round(len(spheres) ** 0.5)
    rows = spheres.reshape(n, n, 5)
    along_u, along_v = np.gradient(rows, axis=(0, 1))
    uu, uv = np.gradient(along_u, axis=(0, 1))
    vv = np.gradient(along_v, axis=1)
    p, q, r = (
        np.linalg.det(np.stack([rows, along_u, along_v, *pair], -2))[2:-2, 2:-2]
        for pair in ((uu, uv), (uu, vv), (uv, vv))
    )
    return float((q * q <= 4 * p * r).mean())


def relaxation() -> None:
    """Central spheres, real alone and with upright axes."""
    n = 41
    ids = np.arange(n * n).reshape(n, n)
    a, b, c, d = (
        part.ravel() for part in (ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:])
    )
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    line = np.linspace(-1.2, 1.2, n)
    for name, surface in (("hypar", hypar), ("bump", bump)):
        u, v = np.meshgrid(line, line, indexing="ij")
        mesh = Mesh(surface(u, v).reshape(-1, 3), faces)
        spheres, _ = sphere_congruence(mesh, "central")
        for angle in (90, 20):
            target = CongruenceQuality(0.02, float(np.radians(angle)))
            run = relax_congruence(mesh, spheres, complex_share, target)
            print(
                f"{name:22s}central spheres, axes within {angle} deg: blend {run.blend:.2f} of "
                f"radius {run.radius:.2f}; complex {run.before.complex_share:.1%} -> "
                f"{run.after.complex_share:.1%}; axes p95 "
                f"{np.degrees(run.before.axis_angle):.0f} -> "
                f"{np.degrees(run.after.axis_angle):.0f} deg"
            )


if __name__ == "__main__":
    planarization()
    relaxation()
