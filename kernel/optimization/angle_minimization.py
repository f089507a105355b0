"""Angle minimisation in the pencils of the faces' circles.

Every sphere through the circle of a face is ``S(t) = cos t P + sin t Q``: one unknown per face,
and the conditions of lying on the vertices and of being a unit row hold exactly. Creases weigh
nothing: across them a surface is not meant to be smooth.

For smooth contact, stage 1 minimises the signed energy ``sum (1 - g)`` with ``g = <<S, S'>>``,
stage 2 the paper's ``sum (g² - 1)²`` from there. Another target angle has many optima: of those
found from starts of structure, the lowest is taken. It mostly curves to both sides in turn, and
the planes of its arcs then lean over the faces: panels cut there ask for spheres of one side.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import BoolArray, FloatArray, IntArray, norm, sum_by
from ..errors import InputError
from ..meshes.creases import crease_edges, joined_parts
from ..meshes.mesh import Mesh, face_centroids, mean_edge_length
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..spheres.circles import Circles, circle_pencils, face_circles, pencil_spheres
from ..spheres.minkowski import minkowski
from ..tolerances import LEAST_ENERGY, SAME_BULGE, SAME_ENERGY, SAME_TURN
from .pencil_energy import (
    PRODUCT_ROUNDING,
    EdgeEnergy,
    PencilCoupling,
    angle_density,
    angle_energy,
    couple_pencils,
    edge_products,
    signed_density,
)
from .pencil_newton import PencilDescent, PencilProblem, minimize_in_pencils
from .target_starts import one_sided_descents, target_descents

BulgeSides = Literal["both", "one"]


@dataclass(frozen=True)
class AngleReport:
    """How a minimisation of angles went.

    Attributes
    ----------
    converged : bool
        Whether both stages came to rest at optima of second order: the lowest eigenvalue of the
        second derivatives is nowhere negative.
    iterations : tuple of int
        Newton steps of the smooth stages, signed and the paper's; with a target angle of
        the smooth stages and of the descent taken.
    energies : tuple of float
        The paper's energy (9) at the start, after stage 1, and after each accepted step of
        stage 2; one more where spheres were taken back. With a target angle at the start, at
        smooth contact and at the end.
    step : float
        Largest change of an unknown in the last step, in radians.
    circle_miss : float
        Largest distance of a vertex from the best-fit circle of a face, in mean edges; zero
        (up to rounding) for circular faces.
    is_crease : (E,) bool array
        Edges that were left sharp.
    is_taken_back : (F,) bool array
        Faces whose mean angle would have been larger than that of flat panels: those of
        stage 1 there if they are smoother, else flat.
    """

    converged: bool
    iterations: tuple[int, int]
    energies: tuple[float, ...]
    step: float
    circle_miss: float
    is_crease: BoolArray
    is_taken_back: BoolArray


def minimize_angles(
    sphere_mesh: SphereMesh,
    target_angle: float = 0.0,
    edge_weights: ArrayLike | None = None,
    crease: float = np.pi,
    max_opening: float = np.pi,
    sides: BulgeSides = "both",
) -> tuple[SphereMesh, AngleReport]:
    """Spheres through the faces' circles that meet their neighbours most smoothly.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        Mesh and spheres to start from. The smoother of these, put into the pencils, and the
        face planes is the start; the result does not depend on it.
    target_angle : float
        Angle at which neighbours shall meet, in radians from 0 to π/2.
    edge_weights : (E,) array_like of float, optional
        Weight of each interior edge, at least 0; 1 by default. Faces without a weighted edge
        get their planes.
    crease : float
        Edges at which the planes of the faces turn by more, in radians, stay sharp: their
        weight is 0. At π there are none.
    max_opening : float
        Largest half opening of the caps, in radians; π for no bound.
    sides : {"both", "one"}
        Whether the spheres of a part that meet at a target angle may curve to both sides.

    Returns
    -------
    sphere_mesh : SphereMesh
        The optimum; faces whose vertices lie on no circle keep their best-fit circle. No part
        that hangs together by weighted edges is rougher in the mean than its planes.
    report : AngleReport
        Convergence and miss.

    Raises
    ------
    InputError
        If a face has no area, or a weight, the target or another angle is out of range.

    Notes
    -----
    The result does not depend on the numbering, place, size or position of the mesh. Where two
    optima are equally low, the one that bulges more is taken.

    References
    ----------
    Meshes with Spherical Faces, Sec. 4.2, eq. (9).
    """
    mesh = sphere_mesh.mesh
    weights = check_angle_options(mesh, target_angle, edge_weights)
    bound = _bound(max_opening)
    is_crease = crease_edges(mesh, crease)
    weights = np.where(is_crease, 0.0, weights)
    circles, miss = face_circles(mesh)
    coupling = couple_pencils(mesh, circles, weights)
    parts = joined_parts(mesh, weights > 0)
    curvatures = mean_edge_length(mesh) / np.sqrt(circles.radii_squared)

    def _problem(density: EdgeEnergy) -> PencilProblem:
        return PencilProblem(coupling, density, (-bound, bound), curvatures)

    given = np.clip(pencil_angles(sphere_mesh, circles), -bound, bound)
    planes = np.zeros_like(given)
    start = _lower(coupling, parts, given, planes)
    first = minimize_in_pencils(_problem(signed_density), start)
    second = _second_stage(_problem(angle_density(0.0)), first)
    iterations = (len(first.energies) - 1, len(second.energies) - 1)
    density = angle_density(target_angle)
    energies = [angle_energy(coupling, density, start)]
    if target_angle == 0:
        angles, taken_back = _never_rougher(coupling, parts, (second, first))
        last, converged = second, first.converged and second.converged
        energies += second.energies
    else:
        angles, descents = _lowest_of_parts(
            _problem(density),
            parts,
            second.angles,
            None if sides == "one" else given,
            target_angle,
            face_centroids(mesh),
        )
        converged = all(descent.converged for descent in descents)
        last = max(descents, key=lambda each: len(each.energies), default=second)
        iterations = (sum(iterations), len(last.energies) - 1)
        taken_back = np.zeros(mesh.n_faces, bool)
        energies.append(angle_energy(coupling, density, second.angles))
    is_alone = np.bincount(coupling.faces[weights > 0].ravel(), minlength=mesh.n_faces) == 0
    angles = np.where(is_alone, 0.0, angles)
    if taken_back.any() or target_angle > 0:
        energies.append(angle_energy(coupling, density, angles))
    report = AngleReport(
        converged, iterations, tuple(energies), last.step,
        float(miss.max()) / mean_edge_length(mesh), is_crease, taken_back,
    )  # fmt: skip
    spheres = pencil_spheres(*circle_pencils(circles), angles)
    return SphereMesh.from_local(mesh, spheres), report


def _second_stage(problem: PencilProblem, first: PencilDescent) -> PencilDescent:
    """Descent of the paper's energy from the end of stage 1.

    Where that is smooth up to rounding, the second derivatives of the paper's energy are
    nothing but rounding, and stage 1 has the last word.
    """
    rounding = PRODUCT_ROUNDING * float(problem.coupling.weights.sum())
    if first.energies[-1] > rounding:
        return minimize_in_pencils(problem, first.angles)
    energy = angle_energy(problem.coupling, problem.density, first.angles)
    return PencilDescent(first.angles, (energy,), first.step, first.converged)


def _bound(max_opening: float) -> float:
    """Largest unknown, in radians: infinite from 180 degrees on."""
    if not 0 <= max_opening <= np.pi:
        raise InputError(
            "the half opening of caps lies between 0 and 180 degrees, not "
            f"{np.degrees(max_opening):g}"
        )
    return np.inf if max_opening >= np.pi - SAME_TURN else max_opening


def _lower(
    coupling: PencilCoupling, parts: IntArray, one: FloatArray, other: FloatArray
) -> FloatArray:
    """Of each part the unknowns of lower signed energy; the others if they are equal."""
    energies = [
        _part_sums(coupling, parts, signed_density(edge_products(coupling, angles).value)[0])
        for angles in (one, other)
    ]
    return np.where((energies[0] < energies[1])[parts], one, other)


def _part_sums(coupling: PencilCoupling, parts: IntArray, values: FloatArray) -> FloatArray:
    """Weighted sums over the edges (E,) of each part."""
    count = int(parts.max()) + 1
    return sum_by(parts[coupling.faces[:, 0]], coupling.weights * values, count)


def _never_rougher(
    coupling: PencilCoupling, parts: IntArray, descents: Sequence[PencilDescent]
) -> tuple[FloatArray, BoolArray]:
    """Of each part the first descent that is no rougher than its planes, else the planes.

    Unknowns (F,), and whether they are not those of the first descent.
    """

    def _roughness(angles: FloatArray) -> FloatArray:
        cosines = np.clip(edge_products(coupling, angles).value, -1, 1)
        return _part_sums(coupling, parts, np.arccos(cosines))

    result = np.zeros_like(descents[0].angles)
    flat = _roughness(result)
    is_open, first = np.ones(len(flat), bool), descents[0].angles
    for descent in descents:
        is_good = is_open & (_roughness(descent.angles) <= flat * (1 + SAME_ENERGY))
        result = np.where(is_good[parts], descent.angles, result)
        is_open &= ~is_good
    return result, np.abs(result - first) > SAME_TURN


def _lowest_of_parts(
    problem: PencilProblem, parts: IntArray, smooth: FloatArray, given: FloatArray | None,
    target: float, places: FloatArray,
) -> tuple[FloatArray, tuple[PencilDescent, ...]]:  # fmt: skip
    """Lowest optimum of each part by itself: unknowns (F,), and the descents of the parts."""
    coupling = problem.coupling
    used = coupling.weights > 0
    part_of_edge = np.where(used, parts[coupling.faces[:, 0]], -1)
    angles, descents = np.zeros_like(smooth), list[PencilDescent]()
    index = np.empty(len(parts), np.int64)
    for part in np.unique(part_of_edge[used]).tolist():
        faces, edges = np.flatnonzero(parts == part), np.flatnonzero(part_of_edge == part)
        index[faces] = np.arange(len(faces))
        own = PencilProblem(
            PencilCoupling(
                index[coupling.faces[edges]],
                coupling.products[:, edges],
                coupling.weights[edges],
            ),
            problem.density,
            problem.bounds,
            problem.curvatures[faces],
        )
        own_given = None if given is None else given[faces]
        found = _lowest(own, smooth[faces], own_given, target, places[faces])
        angles[faces] = found.angles
        descents.append(found)
    return angles, tuple(descents)


def _lowest(
    problem: PencilProblem, smooth: FloatArray, given: FloatArray | None, target: float,
    places: FloatArray,
) -> PencilDescent:  # fmt: skip
    """The lowest of several descents; of equal ones that which bulges more.

    Without given spheres those that curve to one side.
    """
    find = one_sided_descents if given is None else target_descents
    descents = find(problem, smooth, target)
    lowest = min(descent.energies[-1] for descent in descents)
    zero = LEAST_ENERGY * float(problem.coupling.weights.sum())
    if given is not None:
        start = angle_energy(problem.coupling, problem.density, given)
        if start < lowest * (1 - SAME_ENERGY) - zero:
            descents.append(minimize_in_pencils(problem, given))
            lowest = min(lowest, descents[-1].energies[-1])
    equal = [
        each for each in descents if each.energies[-1] <= lowest * (1 + SAME_ENERGY) + zero
    ]
    best = equal[0]
    for other in equal[1:]:
        if _bulges_more(problem.curvatures, other.angles, best.angles, places):
            best = other
    return best


def _bulges_more(
    curvatures: FloatArray, one: FloatArray, other: FloatArray, places: FloatArray
) -> bool:
    """Whether spheres bulge more at some unknowns (F,) than at others.

    By the sum of their curvatures, of the cubes of these, and last by where they bulge.
    """
    first, second = curvatures * np.sin(one), curvatures * np.sin(other)
    size = float((np.abs(first) + np.abs(second)).sum())
    centered = places - places[0]
    centered -= centered.mean(axis=0)
    reach = float(norm(centered).max()) or 1.0
    along = centered @ np.array([1.0, 0.7, 0.4]) / reach
    for measure in (first - second, first**3 - second**3, along * (first - second)):
        total = float(measure.sum())
        if abs(total) > SAME_BULGE * size:
            return total > 0
    return False


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
