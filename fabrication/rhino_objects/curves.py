"""Arcs, lines and circles as curves of Rhino in JSON, written and read."""

from typing import Any, Final, NamedTuple

import numpy as np

from ...kernel.arrays import FloatArray, dot, norm, unit
from ...kernel.errors import InputError
from ...kernel.spheres.arcs import Arcs
from ...kernel.spheres.circles import Circles
from ...kernel.tolerances import CURVE_SHAPE
from ..breps.nodes import perpendiculars
from ..opennurbs.brep_writer import arc_streams, circle_streams
from ..rhino.isolation import isolated
from .fields import Fields, decoded_objects, object_fields

_ADVICE: Final = "use arcs and lines, or whole circles"


def arc_fields(arcs: Arcs) -> list[Fields]:
    """Arcs as curves in JSON; straight ones are lines.

    Parameters
    ----------
    arcs : Arcs

    Returns
    -------
    list of dict
        A curve for each, in their order.
    """
    return [object_fields(stream) for stream in arc_streams(arcs)]


def circle_fields(circles: Circles) -> list[Fields]:
    """Circles as curves in JSON; imaginary ones, and points, are left out.

    Parameters
    ----------
    circles : Circles

    Returns
    -------
    list of dict
        A closed curve for each real circle.
    """
    centers, normals = circles.centers.reshape(-1, 3), circles.normals.reshape(-1, 3)
    squares = np.ravel(circles.radii_squared)
    is_real = (squares > 0) & np.isfinite(np.column_stack([centers, normals, squares])).all(1)
    axes = unit(normals[is_real])
    streams = circle_streams(
        centers[is_real], perpendiculars(axes), axes, np.sqrt(squares[is_real])
    )
    return [object_fields(stream) for stream in streams]


def curves_of_fields(several: list[Fields]) -> Arcs | Circles:
    """Curves of Rhino in JSON as arcs, or as circles.

    Parameters
    ----------
    several : list of dict
        Arcs of at most a half circle and lines, of whatever class the curves are, or whole
        circles.

    Returns
    -------
    Arcs or Circles
        In the order of the curves.

    Raises
    ------
    InputError
        If a curve is neither, or some are circles and some are not.
    """
    pieces = isolated(_pieces, several)
    is_circle = np.array([piece.is_circle for piece in pieces])
    if is_circle.any() and not is_circle.all():
        raise InputError(f"some curves are circles and some are not; {_ADVICE}")
    points = np.array([piece.points for piece in pieces]).reshape(-1, 3, 3)
    if is_circle.any():
        return Circles(points[:, 0], points[:, 1], points[:, 2, 0] ** 2)
    return _arcs(points)


class _Piece(NamedTuple):
    """A circle by centre, normal and radius; an arc or line by start, middle and end."""

    is_circle: bool
    points: list[list[float]]


def _pieces(several: list[Fields]) -> list[_Piece]:
    found: list[_Piece] = []
    for number, curve in enumerate(decoded_objects(several)):
        if not hasattr(curve, "PointAtStart"):
            raise InputError(f"item {number} is no curve; {_ADVICE}")
        found.append(_piece(curve, number))
    return found


def _piece(curve: Any, number: int) -> _Piece:  # noqa: ANN401
    """A curve, seen from its start and in its own size: Rhino's tolerances are lengths."""
    start, end = _point(curve.PointAtStart), _point(curve.PointAtEnd)
    low, high = _corners(curve.GetBoundingBox())
    size = float(np.linalg.norm(high - low))
    if not 0 < size < np.inf:
        raise InputError(f"curve {number} has no length; {_ADVICE}")
    local = _moved(curve, start, size)
    if local.IsLinear(CURVE_SHAPE):
        return _Piece(
            is_circle=False, points=[start, ((np.array(start) + end) / 2).tolist(), end]
        )
    if local.IsClosed and local.IsCircle(CURVE_SHAPE):
        circle = local.TryGetCircle(CURVE_SHAPE)
        plane, radius = circle.Plane, size * float(circle.Radius)
        center = (np.array(start) + size * np.array(_point(plane.Origin))).tolist()
        return _Piece(is_circle=True, points=[center, _point(plane.ZAxis), [radius] * 3])
    if local.IsClosed or not local.IsArc(CURVE_SHAPE):
        raise InputError(f"curve {number} is neither an arc nor straight; {_ADVICE}")
    # The middle by length: parameters of NURBS curves run unevenly.
    arc = local.TryGetArc(CURVE_SHAPE)
    half_way = _point(arc.PointAt((arc.AngleDomain.T0 + arc.AngleDomain.T1) / 2))
    middle = (np.array(start) + size * np.array(half_way)).tolist()
    return _Piece(is_circle=False, points=[start, middle, end])


def _moved(curve: Any, start: list[float], size: float) -> Any:  # noqa: ANN401
    import rhino3dm

    library: Any = rhino3dm
    local = curve.Duplicate()
    local.Translate(library.Vector3d(*(-x for x in start)))
    local.Scale(1 / size)
    return local


def _corners(box: Any) -> tuple[FloatArray, FloatArray]:  # noqa: ANN401
    return np.array(_point(box.Min)), np.array(_point(box.Max))


def _point(point: Any) -> list[float]:  # noqa: ANN401
    return [point.X, point.Y, point.Z]


def _arcs(points: FloatArray) -> Arcs:
    starts, middles, ends = points.transpose(1, 0, 2)
    chords = ends - starts
    rises = middles - (starts + ends) / 2
    sagittas = norm(rises)
    if (2 * sagittas > norm(chords) * (1 + CURVE_SHAPE)).any():
        raise InputError("an arc is longer than a half circle; split it")
    across = _across(chords)
    is_bent = sagittas > CURVE_SHAPE * norm(chords)
    return Arcs(
        starts,
        ends,
        np.where(is_bent[:, None], unit(np.where(is_bent[:, None], rises, across)), across),
        np.where(is_bent, sagittas, 0.0),
    )


def _across(chords: FloatArray) -> FloatArray:
    """Unit vectors across chords."""
    directions = unit(chords)
    axis = np.eye(3)[np.abs(directions).argmin(axis=1)]
    return unit(axis - dot(axis, directions)[:, None] * directions)
