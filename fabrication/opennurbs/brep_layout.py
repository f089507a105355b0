"""Where the numbers of a one-faced Brep stand in its stream."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import BoolArray
from .stream_codes import Checksum
from .stream_reader import BufferPlace


class Curve(NamedTuple):
    """A curve: its class and the places of its domain, points and knots (of NURBS only)."""

    uuid: bytes
    domain: tuple[int, int]
    points: int
    n_points: int
    knots: int = 0
    n_knots: int = 0


class Surface(NamedTuple):
    """A surface: its class and the places of its two knot vectors and of its points."""

    uuid: bytes
    knots: tuple[int, int]
    points: int
    n_points: tuple[int, int]


class Side(NamedTuple):
    """One side of the loop: its trim, its edge, the places of its vertices and domains."""

    trim: Curve
    edge: Curve
    start: int
    end: int
    trim_domain: int
    edge_domain: int


class FaceMesh(NamedTuple):
    """A render mesh: its triangles, the buffers of points and normals, and of exact points."""

    triangles: NDArray[np.unsignedinteger]
    floats: BufferPlace
    normals: BufferPlace
    points: BufferPlace | None


@dataclass(frozen=True)
class BrepLayout:
    """Where the numbers of a Brep stand.

    The sides are in the order of the loop; a face `is_reversed` if it looks against the normal
    of its surface; `numbers` are places and counts of all float64 numbers; `fixed` marks the
    bytes that are neither numbers nor checksums.
    """

    surface: Surface
    sides: tuple[Side, ...]
    is_reversed: bool
    mesh: FaceMesh | None
    checksums: tuple[Checksum, ...]
    numbers: tuple[tuple[int, int], ...]
    fixed: BoolArray
