"""Whether a mesh can have beams on node axes, found before anything is optimised."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from ..arrays import FloatArray, dot, norm, unit
from ..meshes.mesh import Mesh, face_centroids, face_normals, mean_edge_length
from ..reports import Report
from ..sphere_meshes.sphere_mesh import SphereMesh, vertex_error
from ..tolerances import CREASE
from .beam_axes import LOOSE_LEAN_WEIGHT, beam_axes, beam_edges
from .beam_supports import (
    axis_points,
    exact_directions,
    inner_tilt,
    is_mostly_triangles,
    node_torsion,
    wall_planes,
)

FEASIBLE_TILT: Final = 0.2617993877991494
"""Beams of a feasible support mostly tilt by less (15 degrees)."""

DOUBTFUL_TILT: Final = 0.4886921905584123
"""Beams that mostly tilt by less (28 degrees) may do; above, panels lean over their beams."""

WIDE_MISS: Final = 0.05
"""Vertices farther from their spheres, in mean edges, leave steps that no joint takes up."""

NEARLY_MINIMAL: Final = 0.15
"""Curvatures across edges whose sum is less than this share of their sizes cancel."""


@dataclass(frozen=True, eq=False)
class FeasibilityReport(Report):
    """Whether beams on node axes can stand.

    Attributes
    ----------
    verdict : {"feasible", "doubtful", "no"}
        By the tilt of most beams: up to 15 degrees, up to 28, above.
    tilt_deg_p95, tilt_deg_max : float
        Angles between the planes of inner beams and those that bisect the faces.
    torsion_deg_max : float
        Largest angle between an axis and the plane of one of its beams.
    vertex_miss : float
        Farthest vertex from one of its spheres, in mean edges.
    creases : int
        Edges across which faces meet at more than 40 degrees.
    triangles : float
        Share of the faces.
    reason : str
        What decided, and what else is to be known, in plain sentences.
    """

    verdict: str
    tilt_deg_p95: float
    tilt_deg_max: float
    torsion_deg_max: float
    vertex_miss: float
    creases: int
    triangles: float
    reason: str


def judge_support(sphere_mesh: SphereMesh) -> FeasibilityReport:
    """Whether a sphere mesh can have beams on node axes.

    Notes
    -----
    The axis problem with a small price on leaning: where no axes please the edges it answers
    with axes that lean, and beams tilt. The bounds were set on twenty meshes.
    """
    mesh = sphere_mesh.mesh
    directions = exact_directions(sphere_mesh)
    if directions is None:
        directions = beam_axes(mesh, LOOSE_LEAN_WEIGHT)
    axes = axis_points(mesh, directions)
    planes = wall_planes(sphere_mesh, "axis", axes)
    tilt = inner_tilt(sphere_mesh, planes)
    torsion = node_torsion(beam_edges(mesh), planes, directions)
    p95 = float(np.percentile(tilt, 95)) if len(tilt) else 0.0
    miss = float(vertex_error(sphere_mesh).max()) / mean_edge_length(mesh)
    creases = int((_dihedral_angles(mesh) > CREASE).sum())
    verdict = _verdict(p95)
    sentences = [_tilt_sentence(p95), *_remarks(mesh, miss, creases)]
    return FeasibilityReport(
        verdict=verdict,
        tilt_deg_p95=float(np.degrees(p95)),
        tilt_deg_max=float(np.degrees(tilt.max(initial=0.0))),
        torsion_deg_max=float(np.degrees(torsion.max(initial=0.0))),
        vertex_miss=miss,
        creases=creases,
        triangles=float((mesh.degrees == 3).mean()),
        reason="; ".join(sentences),
    )


def _verdict(p95: float) -> str:
    if p95 <= FEASIBLE_TILT:
        return "feasible"
    return "doubtful" if p95 <= DOUBTFUL_TILT else "no"


def _tilt_sentence(p95: float) -> str:
    return (
        f"beams on node axes tilt by up to {np.degrees(p95):.1f} degrees (95 % of them; "
        f"{np.degrees(FEASIBLE_TILT):.0f} is good, {np.degrees(DOUBTFUL_TILT):.0f} the limit)"
    )


def _remarks(mesh: Mesh, miss: float, creases: int) -> list[str]:
    """What else may spoil a support."""
    found: list[str] = []
    if miss > WIDE_MISS:
        found.append(
            f"vertices miss their spheres by up to {100 * miss:.0f} % of an edge, so "
            "neighbours step at corners"
        )
    if is_mostly_triangles(mesh):
        found.append(
            "spheres on triangles have no common node axes, unless all are orthogonal to one "
            "sphere (Lemma 5.1)"
        )
    if creases:
        edges = "1 edge is a crease" if creases == 1 else f"{creases} edges are creases"
        found.append(f"{edges} of more than 40 degrees, where axes have to lean")
    if _cancelled_share(mesh) < NEARLY_MINIMAL:
        found.append("the surface is nearly minimal: spheres are hardly smoother than planes")
    return found


def _dihedral_angles(mesh: Mesh) -> FloatArray:
    normals = face_normals(mesh)
    left, right = mesh.topology.edge_faces.T
    return 2 * np.arctan2(
        norm(normals[left] - normals[right]), norm(normals[left] + normals[right])
    )


def _cancelled_share(mesh: Mesh) -> float:
    """Sum of the curvatures across edges over the sum of their sizes; 1 for a plane mesh."""
    normals, centers = face_normals(mesh), face_centroids(mesh)
    left, right = mesh.topology.edge_faces.T
    across = centers[right] - centers[left]
    bends = dot(normals[right] - normals[left], unit(across))
    total = float(np.abs(bends).sum())
    return abs(float(bends.sum())) / total if total > 0 else 1.0
