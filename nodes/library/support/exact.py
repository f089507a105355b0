"""Sphere meshes with exact supports: beams without torsion, panels without gaps."""

from dataclasses import dataclass
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np

from ....kernel.analysis import angle_summary
from ....kernel.arrays import FloatArray
from ....kernel.exact_supports import axes
from ....kernel.exact_supports.search import MAX_TILT, Attempt, find_exact_support
from ....kernel.exact_supports.setting import Bounds
from ....kernel.meshes.mesh import Mesh, mean_edge_length
from ....kernel.sphere_meshes.fit import face_planes
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ....kernel.support.beam_supports import axis_points
from ...graphs.node import node, warn
from ...graphs.ports import Port
from ..arrays import VertexAxes
from ..optimise.outcomes import OptimumReport

Verdict = Literal["feasible", "doubtful", "no"]


@dataclass(frozen=True, eq=False)
class ExactSupportReport(OptimumReport):
    """Whether an exact support was found, what it took, and what it gives.

    Attributes
    ----------
    verdict : {"feasible", "doubtful", "no"}
        ``doubtful``: exact, but beams tilt by more than 25 degrees; ``no``: the mesh is
        returned as it is, with flat panels.
    reason : str
        Why it is not feasible, and what else would do; empty if it is.
    landed, converged : bool
        Whether all conditions hold to rounding, the moves are as allowed, and neighbours meet
        no more sharply than flat panels: the two are the same.
    angles_deg : dict
        ``planar`` (flat panels on the design) and ``spherical``: ``mean`` and ``max``.
    torsion_deg : dict
        ``mean`` and ``max`` of the angles between node axes and beams, those of the boundary
        included.
    gap, vertex_error : dict
        ``max`` in model units and ``relative_to_edge``: between the arcs of an edge, and
        from a vertex to its spheres.
    height, slide, rim : dict
        ``p95`` and ``max`` of how far vertices moved off the design surface, within it, and
        across its boundary, in mean edges.
    design_move : dict
        ``max`` in model units, ``relative_to_edge``, and the largest ``height`` and ``slide``.
    beam_tilt_deg, axis_lean_deg : dict
        ``p95`` and ``max`` of beams from upright, and of node axes from the normals.
    curvature : dict
        ``common``: curvatures that the spheres were held near, per mean edge, one for each
        connected piece of the mesh; ``factor``: relative to the best for the surface.
    radii : dict
        ``min`` and ``max`` in model units; None for planes.
    attempts : list of dict
        ``factor``, ``landed`` and ``tilt_deg`` of each common curvature that was tried.
    """

    verdict: Verdict
    reason: str
    landed: bool
    converged: bool
    angles_deg: dict[str, dict[str, float]]
    torsion_deg: dict[str, float]
    gap: dict[str, float]
    vertex_error: dict[str, float]
    height: dict[str, float]
    slide: dict[str, float]
    rim: dict[str, float]
    design_move: dict[str, float]
    beam_tilt_deg: dict[str, float]
    axis_lean_deg: dict[str, float]
    curvature: dict[str, Any]
    radii: dict[str, float | None]
    attempts: list[dict[str, Any]]


class ExactSupport(NamedTuple):
    """A sphere mesh whose beams and panels meet exactly, and how it was found."""

    sphere_mesh: SphereMesh
    report: ExactSupportReport


@node
def exact_support(
    mesh: Mesh,
    max_height: Annotated[float, Port(min=0)] = 0.06,
    max_slide: Annotated[float, Port(min=0)] = 0.7,
    one_radius: bool = False,  # noqa: FBT001, FBT002 - a toggle on the canvas
) -> ExactSupport:
    """Let a mesh slide on its surface until beams have no torsion and panels leave no gap.

    Spheres of nearly one radius meet at upright planes where the mesh follows the lines of
    curvature. So its vertices slide into such a net, as little as that takes, and all
    conditions are met to rounding: every sphere passes through its vertices, and all spheres
    of a node through a second point on its axis.

    Parameters
    ----------
    mesh : Mesh
        Quadrilaterals or hexagons; some triangles do no harm.
    max_height : float
        How far vertices may leave the design surface, in mean edges.
    max_slide : float
        How far they may slide in it, in mean edges.
    one_radius : bool
        Whether all spheres shall have exactly one radius: one mould.

    Returns
    -------
    sphere_mesh : SphereMesh
        The net; where none was found, the mesh as it is with flat panels.
    report : ExactSupportReport
        The verdict, what moved, and torsion, gap, tilt and angles of what was found.

    Examples
    --------
    >>> from spheremesh.nodes import exact_support, roof_mesh
    >>> sphere_mesh, report = exact_support(roof_mesh(6, 8, 24.0))
    >>> report.verdict, report.torsion_deg["max"] < 1e-6, report.height["max"] < 0.06
    ('feasible', True, True)
    """
    bounds = Bounds(max_height, max_slide)
    found = find_exact_support(mesh, bounds, one_radius=one_radius)
    report = _report(mesh, found)
    if report.reason:
        warn(report.reason)
    return ExactSupport(found.sphere_mesh if found.is_exact else face_planes(mesh), report)


@node
def common_axes(sphere_mesh: SphereMesh) -> VertexAxes:
    """Find the node axes that the spheres of an exact support have in common.

    For `axis_support`, and for `panels` cut by ``edges="axis"``. Where neighbours are one
    sphere, the planes in which spheres meet do not tell the axes: then flat beams do.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh before moulds, as from `exact_support`.

    Returns
    -------
    (V, 2, 3) float array
        The vertex, and a point of the axis one mean edge inside.

    Examples
    --------
    >>> from spheremesh.nodes import axis_support, common_axes, exact_support, roof_mesh
    >>> found = exact_support(roof_mesh(6, 8, 24.0)).sphere_mesh
    >>> beams = axis_support(found, axes=common_axes(found))
    >>> round(beams.report.torsion_deg["max"], 6), round(beams.report.gap["max"], 9)
    (0.0, 0.0)
    """
    return axis_points(sphere_mesh.mesh, axes.common_axes(sphere_mesh))


def _report(mesh: Mesh, found: Attempt) -> ExactSupportReport:
    judged, edge = found.judgement, mean_edge_length(mesh)
    verdict, reason = _verdict(found)
    sizes = 2 * np.abs(found.sphere_mesh.local_spheres[:, 0])
    pieces = np.sort(np.unique(found.curvatures / found.factor))
    return ExactSupportReport(
        verdict=verdict,
        reason=reason,
        landed=found.is_exact,
        converged=found.is_exact,
        angles_deg={
            "planar": angle_summary(face_planes(mesh)),
            "spherical": angle_summary(found.sphere_mesh),
        },
        torsion_deg=_mean_max(np.degrees(judged.torsion)),
        gap=_length(judged.gaps.max(initial=0.0), edge),
        vertex_error=_length(judged.vertex_miss, edge),
        height=_p95_max(judged.heights),
        slide=_p95_max(judged.slides),
        rim=_p95_max(judged.across_rim),
        design_move={
            **_length(judged.moves.max(initial=0.0), edge),
            "height": float(judged.heights.max(initial=0.0)),
            "slide": float(judged.slides.max(initial=0.0)),
        },
        beam_tilt_deg=_p95_max(np.degrees(judged.tilt)),
        axis_lean_deg=_p95_max(np.degrees(judged.lean)),
        curvature={
            "common": (found.factor * pieces).tolist(),
            "factor": found.factor,
        },
        radii={
            "min": float(1 / sizes.max()) if sizes.max() > 0 else None,
            "max": float(1 / sizes.min()) if sizes.min() > 0 else None,
        },
        attempts=[
            {"factor": factor, "landed": landed, "tilt_deg": float(np.degrees(tilt))}
            for factor, landed, tilt in found.tried
        ],
    )


def _verdict(found: Attempt) -> tuple[Verdict, str]:
    """The verdict, and one sentence where it is not good."""
    judged, bounds = found.judgement, found.bounds
    tilt = np.degrees(judged.tilt.max(initial=0.0))
    instead = (
        "take beams on node axes, which move nothing (axis_support, panel --support axis), or "
        "a mesh along the lines of curvature"
    )
    if found.is_exact and found.is_upright:
        return "feasible", ""
    if found.is_exact:
        return "doubtful", (
            f"the support is exact, but beams tilt by up to {tilt:.0f} degrees, more than "
            f"{np.degrees(MAX_TILT):.0f}: look at them, or {instead}"
        )
    if not found.is_landed:
        why = "near this mesh there is none whose beams all share their axes"
    elif not judged.is_kept:
        why = "faces would turn over or edges shrink to less than half"
    elif not found.judgement.is_within(bounds):
        why = (
            f"vertices would have to leave the surface by {judged.heights.max():.2g} edges and "
            f"slide by {judged.slides.max():.2g}, where {bounds.height:g} and {bounds.slide:g} "
            "are allowed"
        )
    else:
        why = (
            f"neighbours would meet at {np.degrees(judged.angles.mean()):.2f} degrees on the "
            f"mean, flat panels at {np.degrees(judged.flat_angles.mean()):.2f}"
        )
    return "no", f"no exact support: {why}; {instead}"


def _mean_max(values: FloatArray) -> dict[str, float]:
    mean = float(values.mean()) if len(values) else 0.0
    return {"mean": mean, "max": float(values.max(initial=0.0))}


def _p95_max(values: FloatArray) -> dict[str, float]:
    p95 = float(np.percentile(values, 95)) if len(values) else 0.0
    return {"p95": p95, "max": float(values.max(initial=0.0))}


def _length(value: float, edge: float) -> dict[str, float]:
    return {"max": float(value) * edge, "relative_to_edge": float(value)}
