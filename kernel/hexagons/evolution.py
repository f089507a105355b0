"""Tangent spheres that grow towards the curvature spheres of a surface.

The spheres touch a triangulation at its vertices; their centres ``v + λ n`` lie on one side.
Small spheres do not meet the surface, so neighbours cut convex faces out of them; large ones
approximate it better, up to the smallest curvature radius ρ on this side. Offsets λ grow to ρ
as far as the node axes, which are orthogonal to the triangles of the centres, stay within a
given angle of the surface normals, while flips of edges keep the faces convex.

The formulas are those of Section 7 of the paper "Meshes with Spherical Faces".
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from ..congruences.curvature_spheres import touching_spheres
from ..errors import InputError
from ..meshes.mesh import Mesh, mean_edge_length
from ..meshes.triangulation import check_triangles
from ..solvers.factorization import factorize_symmetric
from ..solvers.levenberg_marquardt import DampedStep, levenberg_marquardt
from ..tolerances import AXIS_SLACK, DUAL_EDGE
from .delaunay_flips import MAX_SWEEPS, dual_edge_lengths, flip_to_convex
from .ortho_energy import axis_deviations, ortho_residuals
from .tangent_offsets import (
    CLOSEST,
    CenterSide,
    TangentSurface,
    grow_offsets,
    least_offsets,
    mesh_edges,
    tangent_surface,
)

FAIRNESS = 1.0
FIRST_WEIGHT, LARGEST_WEIGHT = 100.0, 1e4
"""Weights of the bound on the axes: doubled until it holds."""
RETREAT = 0.9
"""Factor of the aim where faces are not convex and no flip helps."""
SHORTEST = 0.1
"""Shortest dual edges without flips, relative to the edges that they cross."""
TOO_FAR = 0.2
"""Axes that pass their bound by more (radians) do not come back by themselves."""
ROUNDS, RETREATS = 8, 20
NESTED_BOUNDS = (3.0, 5.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0)
"""Bounds that are tried, in degrees: those no looser than the one asked for."""
FINE_GRID = 8_000
"""Meshes with more vertices take every second bound."""
ITERATIONS = 40
LEAST_GAIN = 1e-3


@dataclass(frozen=True)
class Evolution:
    """Spheres that have grown, and how.

    Attributes
    ----------
    mesh : Mesh
        The triangulation, with flipped edges.
    spheres : (V, 5) float array
        Unit rows in model coordinates; N agrees with the normals of the mesh.
    offsets, radii : (V,) float array
        Distances of the centres from the vertices, and the curvature radii that they grew
        towards, in model units.
    axis_angles : (T,) float array
        Angle of each node axis with the surface normal, in radians, up to π.
    side : int
        1 if the centres lie to the side of the face normals, -1 if beyond.
    n_flips : int
        Edges flipped.
    converged : bool
        Whether the offsets came to rest, the axes keep their bound, and every edge of the dual
        mesh runs as it must on convex faces.
    is_outer : (V,) bool array
        Vertices where the surface bends away from the centres in all directions.
    """

    mesh: Mesh
    spheres: FloatArray
    offsets: FloatArray
    radii: FloatArray
    axis_angles: FloatArray
    side: int
    n_flips: int
    iterations: int
    converged: bool
    is_outer: BoolArray


def evolve_spheres(
    mesh: Mesh,
    max_axis_angle: float = np.pi / 12,
    side: CenterSide = "auto",
    *,
    flips: bool = True,
) -> Evolution:
    """Grow spheres that touch a triangulation towards its curvature spheres.

    Parameters
    ----------
    max_axis_angle : float
        Largest angle of a node axis with the surface normal, in radians, in (0, π/2).
    side : {"auto", "plus", "minus"}
        Centres to the side of the face normals, beyond, or where the surface bends to on
        average.
    flips : bool
        Whether edges may be flipped so that faces stay convex.

    Returns
    -------
    Evolution
        Triangulation, spheres and how it went.

    Raises
    ------
    InputError
        If faces are no triangles, an option is out of range, or a vertex has no normal.

    Notes
    -----
    Minimises ``E_cs + w E_ortho + E_fair``: ``E_cs = sum (λ / ρ - 0.95)²`` with
    ``ρ = 1 / max(k1, k2)`` for curvatures with respect to the normal towards the centres;
    ``E_ortho`` of `ortho_energy`, with a weight that is raised until the bound holds; and
    for fairness ``E_fair``, the squared differences of offsets along edges (a Laplacian of the
    centres would pull closed surfaces together). Between descents edges are flipped; where
    faces are not convex all the same, the aim is lowered: around small spheres they are.

    References
    ----------
    Meshes with Spherical Faces, Sec. 7.
    """
    check_triangles(mesh)
    _check_bound(max_axis_angle)
    surface, is_outer = tangent_surface(mesh, side)
    # Flips change dual edges at their shortest; without them none needs to be so short.
    rules = (MAX_SWEEPS, -DUAL_EDGE) if flips else (0, SHORTEST)
    surface, offsets, run = _evolve(surface, _Rules(max_axis_angle, *rules))
    size = mean_edge_length(mesh)
    angles = _axis_angles(surface, offsets)
    flipped = Mesh(mesh.vertices, surface.mesh.corners.reshape(-1, 3))
    upwards = surface.side * surface.normals
    spheres = touching_spheres(mesh.vertices, upwards, surface.side / (size * offsets))
    return Evolution(
        flipped,
        spheres,
        size * offsets,
        size * surface.radii,
        angles,
        surface.side,
        *run,
        is_outer=is_outer,
    )


def _check_bound(bound: float) -> None:
    if not 0 < bound < np.pi / 2:
        raise InputError(
            "the largest angle of an axis must lie between 0 and 90 degrees, not "
            f"{np.degrees(bound):g}"
        )


def evolve_best(
    mesh: Mesh,
    max_axis_angle: float = np.pi / 12,
    side: CenterSide = "auto",
    *,
    flips: bool = True,
) -> Evolution:
    """The largest spheres over a fixed grid of bounds: a looser bound never makes them smaller.

    Parameters and errors as for `evolve_spheres`; the bounds are those of `NESTED_BOUNDS` that
    are no looser, or the one given if it is tighter than all.

    Returns
    -------
    Evolution
        Of those that converged the one with the largest mean of ``λ / ρ``; else of all.

    Notes
    -----
    A descent ends in one of many local optima, since edges are flipped on the way, and one
    with a looser bound may be worse. What keeps a tighter bound keeps the looser one as well.
    """
    check_triangles(mesh)
    _check_bound(max_axis_angle)
    grid = NESTED_BOUNDS if mesh.n_vertices <= FINE_GRID else NESTED_BOUNDS[::2]
    bounds = [each for each in np.radians(grid) if each <= max_axis_angle + AXIS_SLACK]
    found = [evolve_spheres(mesh, bound, side, flips=flips) for bound in bounds]
    if not found:
        return evolve_spheres(mesh, max_axis_angle, side, flips=flips)
    return max(found, key=lambda each: (each.converged, (each.offsets / each.radii).mean()))


class _Rules(NamedTuple):
    """Largest tilt of the axes, rounds of flips, and the shortest dual edges put up with."""

    bound: float
    sweeps: int
    shortest: float


class _Run(NamedTuple):
    """Flips, linear systems solved, and whether all came to rest."""

    n_flips: int
    iterations: int
    converged: bool


def _evolve(surface: TangentSurface, rules: _Rules) -> tuple[TangentSurface, FloatArray, _Run]:
    bound = rules.bound
    aims = CLOSEST * surface.radii
    offsets = grow_offsets(surface, aims, bound)
    surface, n_flips = _flip(surface, offsets, rules.sweeps)
    iterations, weight = 0, FIRST_WEIGHT
    for _ in range(ROUNDS):
        offsets, steps, at_rest = descend(surface, offsets, aims, bound, weight)
        iterations += steps
        surface, count = _flip(surface, offsets, rules.sweeps)
        n_flips += count
        holds = float(_axis_angles(surface, offsets).max()) <= bound + AXIS_SLACK
        bad = _bad_vertices(surface, offsets, rules)
        can_retreat = bool((aims[bad] > least_offsets(surface.mesh)[bad]).any())
        if at_rest and holds and count == 0 and not can_retreat:
            lengths = dual_edge_lengths(surface.mesh, _rows(surface, offsets))
            is_convex = bool((lengths >= -DUAL_EDGE).all())
            return surface, offsets, _Run(n_flips, iterations, is_convex)
        if not holds:
            weight = min(2 * weight, LARGEST_WEIGHT)
        if can_retreat:
            surface, offsets, aims, count = _retreat(surface, offsets, aims, rules)
            n_flips += count
    return surface, offsets, _Run(n_flips, iterations, converged=False)


def _retreat(
    surface: TangentSurface, offsets: FloatArray, aims: FloatArray, rules: _Rules
) -> tuple[TangentSurface, FloatArray, FloatArray, int]:
    """Lower the aims where faces are not convex: around small enough spheres they are."""
    n_flips, least, aims = 0, least_offsets(surface.mesh), aims.copy()
    for _ in range(RETREATS):
        bad = _bad_vertices(surface, offsets, rules)
        bad = bad[aims[bad] > least[bad]]
        if len(bad) == 0:
            break
        aims[bad] = np.maximum(np.minimum(aims[bad], offsets[bad]) * RETREAT, least[bad])
        offsets = grow_offsets(surface, aims, rules.bound)
        surface, count = _flip(surface, offsets, rules.sweeps)
        n_flips += count
    return surface, offsets, aims, n_flips


def _rows(surface: TangentSurface, offsets: FloatArray) -> FloatArray:
    """Unit rows at the vertices, seen from them."""
    upwards = surface.side * surface.normals
    half = (surface.side / (2 * offsets))[:, None]
    return np.concatenate([half, upwards, np.zeros_like(half)], axis=1)


def _flip(
    surface: TangentSurface, offsets: FloatArray, sweeps: int
) -> tuple[TangentSurface, int]:
    result = flip_to_convex(surface.mesh, _rows(surface, offsets), sweeps)
    return replace(surface, mesh=result.mesh), result.n_flips


def _axis_angles(surface: TangentSurface, offsets: FloatArray) -> FloatArray:
    triangles = surface.mesh.corners.reshape(-1, 3)
    return axis_deviations(
        surface.mesh.vertices, surface.normals, _turned(triangles, surface.side), offsets
    )


def _turned(triangles: IntArray, side: int) -> IntArray:
    """Triangles counter-clockwise about the normals to the given side."""
    return triangles if side == 1 else triangles[:, ::-1]


def _bad_vertices(surface: TangentSurface, offsets: FloatArray, rules: _Rules) -> IntArray:
    """Vertices where smaller spheres help: dual edges run backwards, or axes tilt too far."""
    mesh = surface.mesh
    backwards = dual_edge_lengths(mesh, _rows(surface, offsets)) < rules.shortest
    is_bad = _axis_angles(surface, offsets) > rules.bound + TOO_FAR
    is_bad[mesh.topology.edge_faces[backwards]] = True
    return np.unique(mesh.corners.reshape(-1, 3)[is_bad])


def descend(
    surface: TangentSurface, offsets: FloatArray, aims: FloatArray, bound: float, weight: float
) -> tuple[FloatArray, int, bool]:
    """Minimise the energy of the offsets (V,) on a triangulation that stays as it is.

    From offsets towards aims (V,), with a weight on the bound: the angle allowed between axis
    and normal, in radians. Better offsets, the number of linear systems, and whether no step
    lowers the energy by more than a share of `LEAST_GAIN`.
    """
    from scipy.sparse import csr_array, diags_array

    points, normals, count = surface.mesh.vertices, surface.normals, len(offsets)
    triangles = _turned(surface.mesh.corners.reshape(-1, 3), surface.side)
    pull, least = 1 / surface.radii, least_offsets(surface.mesh)
    places = np.repeat(np.arange(len(triangles)), 3), triangles.ravel()
    starts, ends = mesh_edges(surface.mesh)
    fairness = FAIRNESS / float(surface.radii.mean())
    both = np.tile(np.arange(len(starts)), 2), np.concatenate([starts, ends])
    signs = np.repeat([fairness, -fairness], len(starts))
    smoothing: Any = csr_array((signs, both), (len(starts), count))
    constant: Any = (smoothing.T @ smoothing + diags_array(pull**2)).tocsc()

    def _energies(state: FloatArray) -> FloatArray:
        tilt, _ = ortho_residuals(points, normals, triangles, state, bound)
        parts = (pull * (state - aims), weight * tilt, smoothing @ state)
        return np.array([float(part @ part) for part in parts])

    def _linearize(state: FloatArray) -> Callable[[float], DampedStep]:
        tilt, slopes = ortho_residuals(points, normals, triangles, state, bound)
        tilting: Any = csr_array((weight * slopes.ravel(), places), (len(triangles), count))
        attraction, tilt, rough = pull * (state - aims), weight * tilt, smoothing @ state
        normal: Any = (constant + tilting.T @ tilting).tocsc()
        right = -(pull * attraction + tilting.T @ tilt + smoothing.T @ rough)

        def _step(damping: float) -> DampedStep:
            # Damping by the bound's own large diagonal would freeze moves along the bound.
            step = _solve(normal, damping * constant.diagonal(), right)
            parts = (attraction + pull * step, tilt + tilting @ step, rough + smoothing @ step)
            return DampedStep(step, sum(float(part @ part) for part in parts))

        return _step

    def _move(state: FloatArray, step: FloatArray) -> FloatArray:
        return np.clip(state + step, np.minimum(state, least), surface.radii)

    result = levenberg_marquardt(offsets, _energies, _linearize, _move, LEAST_GAIN, ITERATIONS)
    return result.state, result.iterations, result.status == "converged"


def _solve(matrix: object, damping: FloatArray, right: FloatArray) -> FloatArray:
    """Solve a sparse symmetric system whose diagonal is raised."""
    from scipy.sparse import diags_array

    raised: Any = diags_array(damping, format="csc")
    return factorize_symmetric(matrix + raised)(right)
