"""A pattern with four times the faces, or a quarter."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ....kernel.meshes.mesh import mean_edge_length
from ....kernel.patterns import scales
from ....kernel.patterns.deviations import deviations
from ....kernel.reports import Report
from ....kernel.sphere_meshes.fit import face_planes
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh, intersection_angles
from ...graphs.node import node, warn


@dataclass(frozen=True, eq=False)
class ScaleReport(Report):
    """A pattern before and after its scale changed.

    Attributes
    ----------
    faces, edge : dict
        Number of faces, and mean edge in model units: ``before`` and ``after``.
    angles_deg : dict
        Mean angle between neighbours: ``before`` with the given spheres, ``planes`` and
        ``spheres`` after.
    deviation : float
        Largest distance of new nodes inside from the faces before, in mean edges after.
    single : int
        Faces that could not be merged with others.
    """

    faces: dict[str, int]
    edge: dict[str, float]
    angles_deg: dict[str, float]
    deviation: float
    single: int


class ScaledPattern(NamedTuple):
    """A finer or coarser pattern, and how it compares."""

    sphere_mesh: SphereMesh
    report: ScaleReport


@node
def refine_pattern(sphere_mesh: SphereMesh) -> ScaledPattern:
    """Split the faces of a pattern, on their spheres: about four times as many.

    Nodes stay where they are. New ones have torsion: beams stand upright (`bisector_support`),
    or nodes are made exact once more (`exact_support`).

    Parameters
    ----------
    sphere_mesh : SphereMesh
        A pattern, as from `quad_pattern` or `triangle_pattern`.

    Returns
    -------
    sphere_mesh : SphereMesh
        Triangles from triangles, else a quadrilateral at each corner; spheres of smallest
        angles.
    report : ScaleReport
        Faces, edges and angles before and after.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, refine_pattern, vase_mesh
    >>> fine, report = refine_pattern(fit_spheres(vase_mesh(8, 4)))
    >>> report["faces"], report["angles_deg"]["spheres"] < report["angles_deg"]["before"]
    ({'before': 32, 'after': 128}, True)
    """
    return _told(sphere_mesh, scales.refine_pattern(sphere_mesh), 0)


@node
def coarsen_pattern(sphere_mesh: SphereMesh) -> ScaledPattern:
    """Merge the faces of a pattern four by four: every second line goes.

    Nodes that are left stay where they are. Around singular points lines do not alternate: a
    few faces stay as they are, which is told. Triangles become even ones of twice the edge.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        A pattern, as from `quad_pattern` or `triangle_pattern`.

    Returns
    -------
    sphere_mesh : SphereMesh
        About a quarter of the faces, with spheres of smallest angles.
    report : ScaleReport
        Faces, edges and angles before and after.

    Examples
    --------
    >>> from spheremesh.nodes import coarsen_pattern, fit_spheres, roof_mesh
    >>> coarse, report = coarsen_pattern(fit_spheres(roof_mesh(12, 18)))
    >>> report["faces"], report["single"]
    ({'before': 216, 'after': 54}, 0)
    """
    found = scales.coarsen_pattern(sphere_mesh)
    if found.n_single:
        warn(
            f"{found.n_single} faces are as small as before: around singular points lines do "
            "not alternate; make the pattern anew with twice the edge length for even faces"
        )
    return _told(sphere_mesh, found.net, found.n_single)


def _told(before: SphereMesh, after: SphereMesh, n_single: int) -> ScaledPattern:
    """The new pattern with its report."""
    report = ScaleReport(
        faces={"before": before.mesh.n_faces, "after": after.mesh.n_faces},
        edge={"before": mean_edge_length(before.mesh), "after": mean_edge_length(after.mesh)},
        angles_deg={
            "before": _mean_degrees(before),
            "planes": _mean_degrees(face_planes(after.mesh)),
            "spheres": _mean_degrees(after),
        },
        deviation=deviations(after, before.mesh).nodes,
        single=n_single,
    )
    return ScaledPattern(after, report)


def _mean_degrees(sphere_mesh: SphereMesh) -> float:
    angles = intersection_angles(sphere_mesh)
    return float(np.degrees(angles.mean())) if len(angles) else 0.0
