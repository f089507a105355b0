"""Where the numbers of a Brep stand in its stream."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import BoolArray
from .stream_codes import Checksum
from .stream_reader import BufferPlace


class Curve(NamedTuple):
    """A curve: its class and the places of its domain, points and knots (of NURBS only).

    NURBS are rational, of so many dimensions and of an order one above their degree.
    """

    uuid: bytes
    domain: tuple[int, int]
    points: int
    n_points: int
    knots: int = 0
    n_knots: int = 0
    dimension: int = 3
    order: int = 3


class Surface(NamedTuple):
    """A surface: its class and the places of its two knot vectors and of its points."""

    uuid: bytes
    knots: tuple[int, int]
    points: int
    n_points: tuple[int, int]
    orders: tuple[int, int] = (3, 3)


class Side(NamedTuple):
    """One side of a loop: its trim, its edge, the places of its vertices and domains.

    The edge may run against the loop, in which the side goes from start to end.
    """

    trim: Curve
    edge: Curve
    start: int
    end: int
    trim_domain: int
    edge_domain: int
    is_reversed: bool = False


class FaceMesh(NamedTuple):
    """A render mesh: its triangles, the buffers of points and normals, and of exact points."""

    triangles: NDArray[np.unsignedinteger]
    floats: BufferPlace
    normals: BufferPlace
    points: BufferPlace | None


class Face(NamedTuple):
    """A face: its surface, the sides of its loops in their order, its render mesh.

    The first loop bounds it, others are holes; it `is_reversed` if it looks against the normal
    of its surface.
    """

    surface: Surface
    loops: tuple[tuple[Side, ...], ...]
    is_reversed: bool
    mesh: FaceMesh | None

    @property
    def sides(self) -> tuple[Side, ...]:
        """Sides of all loops."""
        return tuple(side for loop in self.loops for side in loop)


@dataclass(frozen=True)
class BrepLayout:
    """Where the numbers of a Brep stand.

    It `is_closed` if every edge has two sides, one each way; `numbers` are places and counts of
    all float64 numbers; `fixed` marks the bytes that are neither numbers nor checksums, nor say
    whether a trim runs along u or v.
    """

    faces: tuple[Face, ...]
    is_closed: bool
    checksums: tuple[Checksum, ...]
    numbers: tuple[tuple[int, int], ...]
    fixed: BoolArray
