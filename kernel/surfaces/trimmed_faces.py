"""Faces of polysurfaces: pieces of NURBS surfaces between trims, joined along edges."""

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np

from ..arrays import FloatArray
from .nurbs import NurbsSurface

ShareCurve: TypeAlias = Callable[[FloatArray], FloatArray]
"""Points (n, 2) or (n, 3) of a curve at shares (n,) of its parameters, from 0 to 1."""


class Trim(NamedTuple):
    """A piece of the boundary of a face.

    Attributes
    ----------
    edge : int
        The edge on which it lies; -1 at a pole.
    is_reversed : bool
        Whether it runs against its edge.
    ends : (int, int)
        Vertices where it begins and ends.
    curve : ShareCurve
        Its points in (u, v), (n, 2).
    """

    edge: int
    is_reversed: bool
    ends: tuple[int, int]
    curve: ShareCurve


class TrimmedFace(NamedTuple):
    """A piece of a surface.

    Attributes
    ----------
    surface : NurbsSurface
    loops : list of list of Trim
        Closed boundaries: the outer one, counter-clockwise in (u, v), then the holes.
    is_reversed : bool
        Whether the face looks against the normal ``x_u × x_v`` of its surface.
    """

    surface: NurbsSurface
    loops: list[list[Trim]]
    is_reversed: bool


class Polysurface(NamedTuple):
    """Faces with common edges, which are curves in space."""

    faces: list[TrimmedFace]
    edges: list[ShareCurve]


def transformed_surface(surface: NurbsSurface, transform: FloatArray) -> NurbsSurface:
    """The image of a surface under an affine map, which is exact.

    Parameters
    ----------
    transform : (4, 4) float array
        The map, for columns of homogeneous coordinates.

    Returns
    -------
    NurbsSurface
        With the same knots.
    """
    if np.array_equal(transform, np.eye(4)):
        return surface
    return NurbsSurface(surface.knots_u, surface.knots_v, surface.points @ transform.T)


def turned_left(face: TrimmedFace) -> TrimmedFace:
    """The face with its outer loop first and counter-clockwise.

    Returns
    -------
    TrimmedFace
        The outer loop is the one with the largest area in (u, v).
    """
    areas = [_loop_area(loop) for loop in face.loops]
    order = sorted(range(len(areas)), key=lambda i: -abs(areas[i]))
    loops = [face.loops[i] for i in order]
    if areas[order[0]] < 0:
        loops = [[_backwards(trim) for trim in reversed(loop)] for loop in loops]
    return face._replace(loops=loops)


def _loop_area(loop: list[Trim]) -> float:
    share = np.linspace(0, 1, 17)
    x, y = np.concatenate([trim.curve(share) for trim in loop]).T
    x, y = x - x[0], y - y[0]
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def _backwards(trim: Trim) -> Trim:
    def _curve(share: FloatArray) -> FloatArray:
        return trim.curve(1 - share)

    return Trim(trim.edge, not trim.is_reversed, (trim.ends[1], trim.ends[0]), _curve)
