"""Finding the annuli of a sphere mesh: planes, circles, ends, and what cannot be made.

The outer arc of an annulus is the circle in which the spheres of its two faces meet. The inner
one is either concentric with constant power ``R² - r² = κ``, so that all annuli of a node meet
in the same two points (Lemma 4.4), or lies at a constant depth, measured on the node axes.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..arrays import BoolArray, FloatArray, dot
from ..errors import InputError
from ..meshes.mesh import mean_edge_length
from ..panels.cutting import flatten_nearly_plane
from ..panels.edge_axes import EdgeMode
from ..parts.findings import rejected_report
from ..parts.records import RejectedPart, reject_parts
from ..reports import Report
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..spheres.incidence import evaluate, meet_lines, normals
from ..spheres.minkowski import minkowski
from ..tolerances import BEAM_TILT
from .annuli import Annuli, corner_mismatch, end_depths, twist_angles
from .annulus_checks import NO_ANNULUS, inner_reasons, standing_reasons
from .node_axes import support_structure
from .outer_annuli import annuli_on_arcs, annuli_on_walls


@dataclass(frozen=True)
class AnnulusSupport:
    """The annuli of a sphere mesh, and what cannot be made of it.

    Attributes
    ----------
    annuli : Annuli
        Those that can be made.
    rejected : tuple of RejectedPart
        The others, each with its reason.
    kappa_max : float
        Largest admissible power of the annuli that stand, in squared model units; infinite
        where all arcs are straight.
    """

    annuli: Annuli
    rejected: tuple[RejectedPart, ...]
    kappa_max: float


def annulus_support(
    sphere_mesh: SphereMesh,
    depth: float | None = None,
    kappa: float | None = None,
    max_tilt: float = BEAM_TILT,
) -> AnnulusSupport:
    """Annuli under all edges, of constant depth or of constant power.

    Parameters
    ----------
    depth : float, optional
        Length of the ends, along the node axes to the inner side, in model units.
    kappa : float, optional
        Power ``R² - r²``, in squared model units. The ends reach from a vertex towards its
        mirror point, to the outer side if that lies there; away from it if negative.
    max_tilt : float
        Planes that tilt more from the bisecting plane are rejected, in radians.

    Returns
    -------
    AnnulusSupport
        Annuli, rejected ones, and the range of κ.

    Raises
    ------
    InputError
        If not exactly one of depth and kappa is given, or it is out of range.

    Notes
    -----
    The ends of an annulus lie on the node axes, projected to its plane. At nodes free of
    torsion the planes contain the axis, and all annuli of a node share their end there. An
    outer corner is where that line meets the circle.

    Constant power: both circles are concentric and the concentric spheres ``r² - κ`` meet in
    the inner ones. Constant depth: the inner corners lie at that depth on the end lines, and
    the inner arc is the one through both whose centre is nearest to that of the outer arc: the
    concentric one wherever the two ends are alike.

    On the boundary, and between faces on the same sphere, there is no circle of intersection:
    there the plane contains the edge and the mean of the two node axes.

    References
    ----------
    Meshes with Spherical Faces, Sec. 4.1, Lemma 4.4, Fig. 7 to 9.
    """
    _check_options(depth, kappa, max_tilt)
    sphere_mesh = flatten_nearly_plane(sphere_mesh)
    annuli, is_real = annuli_on_arcs(sphere_mesh, support_structure(sphere_mesh))
    return _completed(
        annuli, is_real, mean_edge_length(sphere_mesh.mesh), depth, kappa, max_tilt
    )


def _completed(
    annuli: Annuli,
    is_real: BoolArray,
    size: float,
    depth: float | None,
    kappa: float | None,
    max_tilt: float,
) -> AnnulusSupport:
    """Annuli with inner arcs, of a depth or a power; those that cannot stand apart."""
    reasons = standing_reasons(annuli, is_real, max_tilt)
    stands = np.ones(annuli.n_annuli, bool)
    stands[list(reasons)] = False
    kappa_max = _largest_kappa(annuli, stands)
    if depth is not None:
        annuli = _with_depth(annuli, float(depth))
    else:
        _check_kappa(float(kappa or 0), kappa_max)
        annuli = _with_power(annuli, float(kappa or 0), stands)
    reasons = inner_reasons(annuli, size) | reasons
    return AnnulusSupport(*reject_parts(annuli, reasons, NO_ANNULUS), kappa_max)


def _check_options(depth: float | None, kappa: float | None, max_tilt: float) -> None:
    if (depth is None) == (kappa is None):
        raise InputError("give either a depth or a power kappa, and not both")
    if depth is not None and not (np.isfinite(depth) and depth > 0):
        raise InputError(f"depth must be a length above 0, not {depth}")
    if kappa is not None and not (np.isfinite(kappa) and kappa != 0):
        raise InputError(f"kappa must be a number other than 0, not {kappa}")
    if not 0 < max_tilt <= np.pi / 2:
        raise InputError(f"max_tilt must be above 0 and at most 90 degrees, not {max_tilt} rad")


def _check_kappa(kappa: float, kappa_max: float) -> None:
    if kappa > kappa_max:
        raise InputError(
            f"kappa {kappa:g} is outside the admissible range: at most {kappa_max:.6g}, the "
            "least square of half the distance from a vertex to its mirror point; use a "
            "smaller kappa or give a depth"
        )


def annuli_in_planes(
    sphere_mesh: SphereMesh,
    edges: EdgeMode,
    axes: FloatArray,
    depth: float | None,
    kappa: float | None,
    max_tilt: float,
) -> AnnulusSupport:
    """Annuli in the planes in which panels are cut: on node axes, or upright.

    Parameters
    ----------
    edges : {"bisector", "axis"}
        Planes of the annuli, which are the walls of the panels, see `cutting_planes`.
    axes : (V, 2, 3) float array
        Two points of each node axis, in any order.
    depth, kappa : float or None
        As in `annulus_support`.
    max_tilt : float
        As in `annulus_support`.
    """
    _check_options(depth, kappa, max_tilt)
    sphere_mesh = flatten_nearly_plane(sphere_mesh)
    annuli, is_real = annuli_on_walls(sphere_mesh, edges, axes)
    size = mean_edge_length(sphere_mesh.mesh)
    return _completed(annuli, is_real, size, depth, kappa, max_tilt)


def _largest_kappa(annuli: Annuli, stands: BoolArray) -> float:
    """Least square of half the chords on the node axes, and least squared radius."""
    rows = annuli.outer[stands]
    slopes = dot(
        normals(rows[:, None], annuli.corners[stands][:, :, 0]), annuli.end_directions[stands]
    )
    curvature = 4 * rows[:, :1] ** 2
    # A slope is a cosine, so half a chord is never longer than the radius.
    squares = np.divide(
        slopes**2, curvature, out=np.full(slopes.shape, np.inf), where=curvature > 0
    )
    return float(squares.min(initial=np.inf))


def _with_power(annuli: Annuli, kappa: float, stands: BoolArray) -> Annuli:
    curvature = annuli.outer[:, 0]
    inner = annuli.outer.copy()
    inner[:, 4] += curvature * kappa
    square = 1 - 4 * curvature**2 * kappa
    inner /= np.sqrt(np.where(stands & (square > 0), square, 1.0))[:, None]
    steps, _ = meet_lines(
        np.repeat(inner, 2, axis=0),
        annuli.corners[:, :, 0].reshape(-1, 3),
        annuli.end_directions.reshape(-1, 3),
    )
    corners = annuli.corners.copy()
    corners[:, :, 1] += steps.reshape(-1, 2)[..., None] * annuli.end_directions
    return replace(annuli, inner=inner, corners=corners, kappa=kappa)


def _with_depth(annuli: Annuli, depth: float) -> Annuli:
    corners = annuli.corners.copy()
    corners[:, :, 1] += depth * annuli.end_directions
    bottoms = corners[:, :, 1]
    middles, chords = bottoms.mean(axis=1), bottoms[:, 1] - bottoms[:, 0]
    levels = evaluate(annuli.outer[:, None], bottoms)
    # The circle minus a linear function that vanishes it at both corners and changes along
    # their chord only: the centre moves along the chord, and a line stays a line.
    square = dot(chords, chords)
    change = np.divide(
        levels[:, 1] - levels[:, 0], square, out=np.zeros_like(square), where=square > 0
    )
    slopes = change[:, None] * chords
    inner = annuli.outer.copy()
    inner[:, 1:4] += slopes
    inner[:, 4] += dot(slopes, middles) - levels.mean(axis=1)
    norms = minkowski(inner, inner)
    # Where no circle is left (the depth is beyond the centre) the row keeps its scale.
    inner /= np.sqrt(np.where(norms > 0, norms, 1.0))[:, None]
    return replace(annuli, inner=inner, corners=corners, depth=depth)


@dataclass(frozen=True, eq=False)
class AnnuliReport(Report):
    """What a user must know about annuli.

    Attributes
    ----------
    kappa_max : float or None
        Largest admissible power; None where all arcs are straight.
    tilt_deg : dict
        ``p95`` and ``max`` of the annuli made.
    corner_mismatch : dict
        Between the ends at a node: ``max`` in model units and ``relative_to_edge``.
    axis_angle_deg : float
        Largest angle between a node axis and a plane.
    end_depth : dict
        ``min`` and ``max`` length of the ends.
    outward : int
        Ends that reach to the outer side.
    rejected : list of dict
        ``id``, ``code`` and ``reason`` of each annulus that cannot be made.
    """

    kappa_max: float | None
    tilt_deg: dict[str, float]
    corner_mismatch: dict[str, float]
    axis_angle_deg: float
    end_depth: dict[str, float]
    outward: int
    made: int
    rejected: list[dict[str, str]]


def annulus_report(support: AnnulusSupport, size: float) -> AnnuliReport:
    """The report of annuli."""
    annuli = support.annuli
    tilt = np.degrees(annuli.tilt)
    steps = annuli.corners[:, :, 1] - annuli.corners[:, :, 0]
    lengths = end_depths(annuli)
    mismatch = float(corner_mismatch(annuli).max(initial=0.0)) if annuli.n_annuli else 0.0
    return AnnuliReport(
        kappa_max=support.kappa_max if np.isfinite(support.kappa_max) else None,
        tilt_deg={
            "p95": float(np.percentile(tilt, 95)) if len(tilt) else 0.0,
            "max": float(tilt.max(initial=0.0)),
        },
        corner_mismatch={"max": mismatch, "relative_to_edge": mismatch / size},
        axis_angle_deg=float(np.degrees(twist_angles(annuli).max(initial=0.0))),
        end_depth={
            "min": float(lengths.min()) if lengths.size else 0.0,
            "max": float(lengths.max(initial=0.0)),
        },
        outward=int((dot(steps, annuli.end_directions) < 0).sum()),
        made=annuli.n_annuli,
        rejected=rejected_report(support.rejected),
    )
