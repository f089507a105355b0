"""The search for an exact support: a few common curvatures, the best net that they lead to."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, sum_by
from ..errors import InputError
from ..meshes.mesh import Mesh, with_vertices
from ..remesh.planar.conditions import must_be_planar
from ..sphere_meshes.fit import face_planes
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..support.feasibility import judge_support
from .curvatures import common_curvatures, one_curvature
from .descent import slide_to_support
from .design_surface import design_surface
from .judgement import Judgement, judge
from .landing import land
from .setting import Bounds, first_state, make_setting

SEARCHES = ((1.0, False), (1.0, True), (1.3, True), (0.7, True))
"""Common curvatures that are tried, relative to the best, and whether flatness is a condition:
the next where none is found or beams tilt."""

LEAST_MIXED = 0.5
"""Share of the nodes that need a face of more than three corners."""

MAX_TILT = np.radians(25.0)
"""Beams that tilt more are worth another try."""

LEAST_BOUND = 1e-4
"""Bounds of moves count at least this much while searching, in mean edges."""

SHARE = 0.98
"""Share of the bounds that the descent may use: landing moves by a hair."""


class Trial(NamedTuple):
    """What came of one common curvature: its factor, whether it is exact, the largest tilt."""

    factor: float
    is_exact: bool
    tilt: float


@dataclass(frozen=True)
class Attempt:
    """A net found from one common curvature.

    Attributes
    ----------
    sphere_mesh : SphereMesh
        The net, landed or not.
    factor : float
        Its common curvatures relative to the best.
    curvatures : (F,) float array
        The common curvatures, per mean edge; one for each connected piece.
    is_landed : bool
        Whether all conditions hold to rounding.
    tried : tuple of Trial
        This and the other attempts, in their order.
    """

    sphere_mesh: SphereMesh
    factor: float
    curvatures: FloatArray
    is_landed: bool
    judgement: Judgement
    bounds: Bounds
    tried: tuple[Trial, ...] = ()

    @property
    def is_exact(self) -> bool:
        """Whether it is a net to build: landed, within the bounds, still a net, no rougher."""
        found = self.judgement
        return (
            self.is_landed
            and found.is_kept
            and found.is_smoother
            and found.is_within(self.bounds)
        )

    @property
    def is_upright(self) -> bool:
        """Whether no beam tilts much."""
        return bool(self.judgement.tilt.max(initial=0.0) <= MAX_TILT)


def find_exact_support(mesh: Mesh, bounds: Bounds, *, one_radius: bool = False) -> Attempt:
    """The sphere mesh near a mesh whose beams have no torsion and whose panels leave no gap.

    Parameters
    ----------
    mesh : Mesh
        Of quadrilaterals, hexagons, or both; some triangles do no harm.
    bounds : Bounds
        How far vertices may move.
    one_radius : bool
        Whether all spheres shall have the same radius.

    Returns
    -------
    Attempt
        Of all attempts the best; see its `is_exact`.

    Raises
    ------
    InputError
        If most nodes have triangles alone around them, or a bound is not a length.

    Notes
    -----
    Where the best common curvature leads to beams that tilt, or to no net, larger and smaller
    ones are tried: near a curvature of the surface the net is badly determined. Meshes
    whose beams could not stand on node axes anyway (`judge_support`) get one trial.
    """
    _check_bounds(bounds)
    _refuse_triangles(mesh)
    # Far from the origin coordinates have fewer digits than the conditions need.
    center = mesh.vertices.mean(axis=0)
    design = with_vertices(mesh, mesh.vertices - center)
    surface = design_surface(design)
    curvatures = (one_curvature if one_radius else common_curvatures)(design)
    attempts: list[Attempt] = []
    # Where even with fixed vertices no axes please the beams, sliding hardly ever helps.
    is_hopeless = judge_support(face_planes(design)).verdict == "no"
    for factor, is_flat in SEARCHES[:1] if is_hopeless else SEARCHES:
        setting = make_setting(
            design, surface, _searched(bounds), factor * curvatures,
            has_one_radius=one_radius, is_flat=is_flat,
        )  # fmt: skip
        found, is_landed = land(setting, slide_to_support(setting, first_state(setting)))
        judgement = judge(design, surface, found)
        attempts.append(
            Attempt(found, factor, setting.curvatures, is_landed, judgement, bounds)
        )
        if attempts[-1].is_exact and attempts[-1].is_upright:
            break
    best = min(attempts, key=_rank)
    moved = with_vertices(mesh, best.sphere_mesh.mesh.vertices + center)
    placed = SphereMesh.from_local(moved, best.sphere_mesh.local_spheres)
    tried = tuple(
        Trial(a.factor, a.is_exact, float(a.judgement.tilt.max(initial=0.0))) for a in attempts
    )
    return replace(best, sphere_mesh=placed, tried=tried)


def _rank(attempt: Attempt) -> tuple[bool, bool, float]:
    """Of two attempts the better one has the lower rank."""
    tilt = float(attempt.judgement.tilt.max(initial=0.0))
    return not attempt.is_exact, not attempt.is_landed, tilt


def _searched(bounds: Bounds) -> Bounds:
    """The bounds that the descent is given."""
    return Bounds(
        max(SHARE * bounds.height, LEAST_BOUND), max(SHARE * bounds.slide, LEAST_BOUND)
    )


def _check_bounds(bounds: Bounds) -> None:
    for name, value in (("height", bounds.height), ("slide", bounds.slide)):
        if not (np.isfinite(value) and value >= 0):
            raise InputError(f"the largest {name} must be a number from 0 on, not {value}")


def _refuse_triangles(mesh: Mesh) -> None:
    nodes = must_be_planar(mesh)
    is_larger = (mesh.degrees > 3)[mesh.topology.corner_faces].astype(np.float64)
    has_larger = sum_by(mesh.corners, is_larger, mesh.n_vertices) > 0
    if nodes.any() and has_larger[nodes].mean() < LEAST_MIXED:
        raise InputError(
            "a mesh of triangles has no exact support: with an axis at every node all spheres "
            "are orthogonal to one sphere and cannot follow the surface (Lemma 5.1); use "
            "bisector_support (panel --support bisector), or make a mesh of quadrilaterals"
        )
