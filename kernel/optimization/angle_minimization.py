"""Angle minimisation in the pencils of the faces' circles.

Every sphere through the circle of a face is ``S(t) = cos t P + sin t Q``: one unknown per face,
and the conditions of lying on the vertices and of being a unit row hold exactly. Across an
edge only the four products of P, Q with P', Q' occur, so an iteration costs a few operations
per edge and an F×F system with one entry per edge.

Stage 1 minimises the signed energy ``sum (1 - g)`` with ``g = <<S, S'>>``, which tells smooth
contact from a spike; stage 2 minimises the paper's ``sum (g² - cos² α)²`` from there, with
``g |g|`` for ``g²``, so that 120 degrees are no more taken for 60.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import FloatArray, IntArray, dot, sum_by
from ..errors import InputError
from ..meshes.mesh import Mesh, face_centroids, mean_edge_length
from ..solvers.symmetric import solve_symmetric, symmetric_pattern
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..spheres.circles import Circles, circle_pencils, face_circles, pencil_spheres
from ..spheres.minkowski import minkowski
from ..tolerances import ANGLE_STEP, DAMPING, ENERGY_ROUNDING

MAX_NEWTON_STEPS = 1000


@dataclass(frozen=True)
class AngleReport:
    """How a minimisation of angles went.

    Attributes
    ----------
    converged : bool
        Whether both stages came to rest.
    iterations : tuple of int
        Newton steps of the signed stage and of the paper's stage.
    energies : tuple of float
        The paper's energy (9) at the start, after stage 1, and after each accepted step of
        stage 2.
    step : float
        Largest change of an unknown in the last step, in radians.
    circle_miss : float
        Largest distance of a vertex from the best-fit circle of a face, in mean edges; zero
        (up to rounding) for circular faces.
    """

    converged: bool
    iterations: tuple[int, int]
    energies: tuple[float, ...]
    step: float
    circle_miss: float


@dataclass(frozen=True)
class PencilCoupling:
    """Products of the pencil rows of the two faces of each edge.

    Attributes
    ----------
    faces : (E, 2) int array
        Faces of each edge.
    products : (4, E) float array
        ``<<P,P'>>, <<P,Q'>>, <<Q,P'>>, <<Q,Q'>>``.
    weights : (E,) float array
        Weight of each edge.
    """

    faces: IntArray
    products: FloatArray
    weights: FloatArray


@dataclass(frozen=True)
class EdgeProducts:
    """The product ``g = <<S, S'>>`` of each edge and its derivatives.

    Attributes
    ----------
    value, by_first, by_second, mixed : (E,) float array
        g, its derivatives by the unknowns of the two faces, and the mixed one. The second
        derivative by either unknown alone is -g.
    """

    value: FloatArray
    by_first: FloatArray
    by_second: FloatArray
    mixed: FloatArray


def couple_pencils(mesh: Mesh, circles: Circles, weights: FloatArray) -> PencilCoupling:
    """Products of neighbouring pencils, from differences of centres only.

    The circles are in the coordinates local to their faces; (E,) weights. Independent of scale
    and of where the model sits.
    """
    faces = mesh.topology.edge_faces
    a, b = faces.T
    centroids = face_centroids(mesh)
    across = centroids[b] - centroids[a] + circles.centers[b] - circles.centers[a]
    radii = np.sqrt(circles.radii_squared)
    n, m = circles.normals[a], circles.normals[b]
    products = np.stack(
        [
            dot(n, m),
            dot(n, across) / radii[b],
            -dot(m, across) / radii[a],
            (radii[a] ** 2 + radii[b] ** 2 - dot(across, across)) / (2 * radii[a] * radii[b]),
        ]
    )
    return PencilCoupling(faces, products, weights)


def edge_products(coupling: PencilCoupling, angles: FloatArray) -> EdgeProducts:
    """Products ``<<S, S'>>`` at given unknowns t, (F,)."""
    pp, pq, qp, qq = coupling.products
    cosine, sine = np.cos(angles), np.sin(angles)
    ca, cb = cosine[coupling.faces].T
    sa, sb = sine[coupling.faces].T
    p, q = pp * cb + pq * sb, qp * cb + qq * sb
    p_turned, q_turned = pq * cb - pp * sb, qq * cb - qp * sb
    return EdgeProducts(
        ca * p + sa * q, ca * q - sa * p, ca * p_turned + sa * q_turned,
        ca * q_turned - sa * p_turned,
    )  # fmt: skip


EdgeEnergy = Callable[[FloatArray], tuple[FloatArray, FloatArray, FloatArray]]
"""Energy density of an edge as a function of g, with its first and second derivative."""


def signed_density(products: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Density ``1 - g`` of stage 1, with first and second derivative by g, each (E,)."""
    return 1 - products, np.full_like(products, -1.0), np.zeros_like(products)


def angle_density(target: float) -> EdgeEnergy:
    """Density ``(g |g| - cos² α)²`` of stage 2: the paper's, told from a spike by its sign.

    Takes (E,) values of g; returns density, first and second derivative by g. The target α is
    in radians.

    References
    ----------
    Meshes with Spherical Faces, eq. (9).
    """
    aim = np.cos(target) ** 2

    def _density(products: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        size, side = np.abs(products), np.sign(products)
        excess = products * size - aim
        return excess**2, 4 * size * excess, 4 * side * excess + 8 * products**2

    return _density


def minimize_angles(
    sphere_mesh: SphereMesh, target_angle: float = 0.0, edge_weights: ArrayLike | None = None
) -> tuple[SphereMesh, AngleReport]:
    """Spheres through the faces' circles that meet their neighbours most smoothly.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        Mesh and spheres to start from. The smoother of these, put into the pencils, and the
        face planes is the start; the result does not depend on it, but for faces without
        a weighted edge, which keep it.
    target_angle : float
        Angle at which neighbours shall meet, in radians from 0 to π/2.
    edge_weights : (E,) array_like of float, optional
        Weight of each interior edge, at least 0; 1 by default.

    Returns
    -------
    sphere_mesh : SphereMesh
        The optimum; faces whose vertices lie on no circle keep their best-fit circle.
    report : AngleReport
        Convergence and miss.

    Raises
    ------
    InputError
        If a face has no area, or a weight or the target is out of range.

    References
    ----------
    Meshes with Spherical Faces, Sec. 4.2, eq. (9).
    """
    mesh = sphere_mesh.mesh
    weights = check_angle_options(mesh, target_angle, edge_weights)
    circles, miss = face_circles(mesh)
    planes, great_spheres = circle_pencils(circles)
    coupling = couple_pencils(mesh, circles, weights)
    density = angle_density(target_angle)

    start = pencil_angles(sphere_mesh, circles)
    if _energy(coupling, signed_density, start) > _energy(
        coupling, signed_density, np.zeros_like(start)
    ):
        start = np.zeros_like(start)
    first = _minimize(coupling, signed_density, start)
    # At smooth contact the energy of another target is stationary: leave it by bulging
    # every panel by half the angle.
    second = _minimize(coupling, density, first.angles - target_angle / 2)
    report = AngleReport(
        first.converged and second.converged,
        (first.iterations, second.iterations),
        (_energy(coupling, density, start), *second.energies),
        second.step,
        float(miss.max()) / mean_edge_length(mesh),
    )
    result = SphereMesh.from_local(mesh, pencil_spheres(planes, great_spheres, second.angles))
    return result, report


def pencil_angles(sphere_mesh: SphereMesh, circles: Circles) -> FloatArray:
    """Unknowns t, (F,), of the members of the circle pencils nearest to given spheres.

    Angles ``atan2(<<S,Q>>, <<S,P>>)``, the circles local to their faces: exact where the sphere
    contains the circle.
    """
    planes, great_spheres = circle_pencils(circles)
    rows = sphere_mesh.local_spheres
    return np.arctan2(minkowski(rows, great_spheres), minkowski(rows, planes))


def check_angle_options(
    mesh: Mesh, target: float, edge_weights: ArrayLike | None
) -> FloatArray:
    """Weight of each interior edge, (E,): 1 by default. The target angle is in radians.

    Raises
    ------
    InputError
        If the target lies outside [0, π/2], or a weight is negative or not finite.
    """
    if not 0 <= target <= np.pi / 2:
        raise InputError(
            f"the target angle must lie between 0 and 90 degrees, not {np.degrees(target):g}"
        )
    count = len(mesh.topology.edge_corners)
    if edge_weights is None:
        return np.ones(count)
    weights = np.array(edge_weights, np.float64)
    if weights.shape != (count,):
        raise InputError(f"edge weights must have shape ({count},), not {weights.shape}")
    if not (np.isfinite(weights) & (weights >= 0)).all():
        raise InputError("edge weights must be finite and at least 0")
    return weights


def _energy(coupling: PencilCoupling, density: EdgeEnergy, angles: FloatArray) -> float:
    value = edge_products(coupling, angles).value
    return float(coupling.weights @ density(value)[0])


@dataclass(frozen=True)
class _Descent:
    angles: FloatArray
    energies: tuple[float, ...]
    step: float
    iterations: int
    converged: bool


def _minimize(coupling: PencilCoupling, density: EdgeEnergy, start: FloatArray) -> _Descent:
    """Damped Newton steps, each solved by conjugate gradients; only descents are accepted."""
    pattern = symmetric_pattern(coupling.faces, len(start))
    energies = [_energy(coupling, density, start)]
    angles, damping, largest, converged = start, DAMPING, np.inf, False
    while not converged and len(energies) <= MAX_NEWTON_STEPS and damping < 1 / DAMPING:
        gradient, diagonal, mixed = _derivatives(coupling, density, angles)
        accepted = False
        while not accepted and damping < 1 / DAMPING:
            step = solve_symmetric(pattern, diagonal + damping, mixed, -gradient)
            largest = float(np.abs(step).max(initial=0.0))
            converged = largest <= ANGLE_STEP
            energy = _energy(coupling, density, angles + step)
            accepted = converged or energy <= energies[-1] * (1 + ENERGY_ROUNDING)
            if accepted:
                angles = angles + step
                energies.append(energy)
            damping = max(damping / 16, DAMPING) if accepted else damping * 16
    return _Descent(angles, tuple(energies), largest, len(energies) - 1, converged)


def _derivatives(
    coupling: PencilCoupling, density: EdgeEnergy, angles: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Gradient (F,), diagonal (F,) and edge entries (E,) of the Hessian of the energy."""
    g = edge_products(coupling, angles)
    a, b = coupling.faces.T
    _, slope, bend = density(g.value)
    slope, bend = coupling.weights * slope, coupling.weights * bend
    count = len(angles)
    gradient = sum_by(a, slope * g.by_first, count) + sum_by(b, slope * g.by_second, count)
    diagonal = sum_by(a, bend * g.by_first**2 - slope * g.value, count) + sum_by(
        b, bend * g.by_second**2 - slope * g.value, count
    )
    return gradient, diagonal, bend * g.by_first * g.by_second + slope * g.mixed
