"""What an optimum came to, against flat panels; used by the nodes that optimise."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ....kernel.analysis import angle_summary
from ....kernel.arrays import BoolArray, FloatArray, norm
from ....kernel.meshes.mesh import Mesh, local_corners, mean_edge_length
from ....kernel.panels.cutting import cut_panels
from ....kernel.reports import Report
from ....kernel.sphere_meshes.fit import face_planes
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh, vertex_error
from ....kernel.tolerances import DEEP_CAP, FLATTENED, LITTLE_GAIN
from ...graphs.node import warn


@dataclass(frozen=True, eq=False)
class OptimumReport(Report):
    """How an optimum was reached: the kinds of report that `panel_report` starts from."""


def outcome_of(
    sphere_mesh: SphereMesh, design: Mesh, is_crease: BoolArray, crease: float
) -> dict[str, dict[str, Any]]:
    """What came out, against flat panels on the mesh as it was designed.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        What is built.
    design : Mesh
        The mesh as designed, with the same faces.
    is_crease : (E,) bool array
        Edges that are left sharp.
    crease : float
        The angle, in degrees, that makes them so.

    Returns
    -------
    dict
        Fields of `AnglesReport`: ``angles_deg``, ``vertex_error`` and ``creases``.
    """
    miss = float(vertex_error(sphere_mesh).max())
    sharp = angle_summary(sphere_mesh, is_crease)
    return {
        "angles_deg": {
            "planar": angle_summary(face_planes(design), ~is_crease),
            "spherical": angle_summary(sphere_mesh, ~is_crease),
        },
        "vertex_error": {
            "max": miss,
            "relative_to_edge": miss / mean_edge_length(sphere_mesh.mesh),
        },
        "creases": {
            "angle_deg": crease,
            "count": int(is_crease.sum()),
            "edges": np.flatnonzero(is_crease).tolist(),
            "mean_deg": sharp["mean"],
            "max_deg": sharp["max"],
        },
    }


def flatten_rejected(
    sphere_mesh: SphereMesh, is_crease: BoolArray
) -> tuple[SphereMesh, list[int]]:
    """Planes for the faces whose panels can be made flat, but not of their spheres.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        Spheres of smallest angles.
    is_crease : (E,) bool array
        Edges that are left sharp.

    Returns
    -------
    sphere_mesh : SphereMesh
        The same with planes there; planes everywhere if that is smoother in the mean.
    faces : list of int
        The faces that are flat now.
    """
    mesh = sphere_mesh.mesh
    reach = np.maximum.reduceat(norm(local_corners(mesh)), mesh.offsets[:-1])
    # Only deep caps are refused: most meshes have none, and cutting takes longer than all else.
    if (2 * reach * np.abs(sphere_mesh.local_spheres[:, 0])).max() < np.sin(DEEP_CAP):
        return sphere_mesh, []
    planes = face_planes(mesh)
    spoilt = {part.element_id for part in cut_panels(sphere_mesh)[1]}
    faces = sorted(spoilt - {part.element_id for part in cut_panels(planes)[1]})
    if not faces:
        return sphere_mesh, []
    rows = sphere_mesh.local_spheres.copy()
    rows[faces] = planes.local_spheres[faces]
    result = SphereMesh.from_local(mesh, rows)
    means = [angle_summary(each, ~is_crease)["mean"] for each in (result, planes)]
    if means[0] > means[1]:
        return planes, list(range(mesh.n_faces))
    return result, faces


def warn_of_losses(
    sphere_mesh: SphereMesh, design: Mesh, weights: FloatArray, is_crease: BoolArray
) -> None:
    """Say where spheres are hardly smoother than flat panels, or much sharper at some edge.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        What is built.
    design : Mesh
        The mesh as designed, with the same faces.
    weights : (E,) float array
        Weight of each interior edge; edges of weight 0 are meant to be sharp.
    is_crease : (E,) bool array
        Edges that are left sharp, whatever they weigh.
    """
    counts = (weights > 0) & ~is_crease
    if not counts.any():
        return
    planar = angle_summary(face_planes(design), counts)
    spherical = angle_summary(sphere_mesh, counts)
    along = "" if counts[~is_crease].all() else " along the weighted edges"
    if spherical["mean"] > (1 - LITTLE_GAIN) * planar["mean"]:
        warn(
            f"spheres gain little over planes here ({planar['mean']:.3g} to "
            f"{spherical['mean']:.3g} degrees{along}): the surface is nearly minimal or flat"
        )
    if spherical["max"] > (1 + LITTLE_GAIN) * planar["max"]:
        warn(
            f"the sharpest edge{along} rises from {planar['max']:.3g} to "
            f"{spherical['max']:.3g} degrees, while the mean goes from {planar['mean']:.3g} to "
            f"{spherical['mean']:.3g}"
        )


def warn_of_support(
    start: SphereMesh, result: SphereMesh, outcome: dict[str, dict[str, Any]],
    is_smooth: BoolArray,
) -> None:  # fmt: skip
    """Say where nodes without torsion cost what spheres are for.

    Parameters
    ----------
    start, result : SphereMesh
        Before and after.
    outcome : dict
        Of the result, from `outcome_of`.
    is_smooth : (E,) bool array
        Edges that are no crease.
    """
    planar, spherical = (
        outcome["angles_deg"][kind]["mean"] for kind in ("planar", "spherical")
    )
    bends = [
        float(np.median(np.abs(each.local_spheres[:, 0]))) * mean_edge_length(each.mesh)
        for each in (start, result)
    ]
    before = angle_summary(start, is_smooth)["mean"]
    found: list[str] = []
    if bends[1] < FLATTENED * bends[0] and spherical > (1 + LITTLE_GAIN) * before:
        share = 100 * bends[1] / bends[0]
        found.append(
            f"flatten to {share:.0f} % of their curvature ({before:.3g} to {spherical:.3g} "
            "degrees)"
        )
    if spherical > planar:
        found.append(f"are rougher than planes ({planar:.3g} to {spherical:.3g} degrees)")
    if found:
        warn(
            f"for nodes without torsion spheres {' and '.join(found)}: the net does not follow "
            "the lines of curvature; let its vertices slide (exact_support), or leave spheres "
            "as they are and take axis_support"
        )


def counted_weights(weights: FloatArray | None, is_crease: BoolArray) -> FloatArray:
    """Weight of each edge (E,), 0 on creases."""
    return np.where(is_crease, 0.0, 1.0 if weights is None else weights)
