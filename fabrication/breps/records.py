"""Boundary representations: corners, edges, faces and loops, told apart from any file format.

Parts of the same topology differ in their numbers alone. A batch says the topology once, and
gives the numbers of its curves and surfaces as arrays, a row per part. All geometry is
elementary: lines, circles and ellipses on planes, spheres and cylinders.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Literal, TypeAlias

import numpy as np

from ...kernel.arrays import FloatArray, IntArray
from ...kernel.spheres.arcs import ArcCircles, Arcs, circle_axes

EdgeKind: TypeAlias = Literal["LINE", "CIRCLE", "ELLIPSE"]
FaceKind: TypeAlias = Literal["PLANE", "SPHERICAL_SURFACE", "CYLINDRICAL_SURFACE"]

Ring: TypeAlias = tuple[tuple[int, bool], ...]
"""Edges of a closed chain, each with whether it is run from its start to its end."""


@dataclass(frozen=True)
class EdgeBatch:
    """The same edge of m parts.

    Circles and ellipses run counter-clockwise about their axes; an edge that ends in the corner
    where it starts is the whole circle. The numbers (m, n) are the unit direction of a line,
    which leaves its start; or centre, unit axis, unit vector to parameter 0, and one or two
    radii, the larger first.
    """

    start: int
    end: int
    kind: EdgeKind
    numbers: FloatArray


@dataclass(frozen=True)
class FaceBatch:
    """The same face of m parts.

    Normals of surfaces point away from centres and axes. The numbers (m, n) are the unit normal
    and x axis of a plane, which passes through the corner; or origin, unit z and x axes, and
    the radius. The ring runs counter-clockwise about the normal of the face, out of a solid,
    which `is_along` that of the surface or against it; rings about holes run clockwise. A
    closed cylinder has a seam: its ring runs along one edge both ways.
    """

    kind: FaceKind
    numbers: FloatArray
    ring: Ring
    is_along: bool = True
    corner: int = 0
    holes: tuple[Ring, ...] = ()


@dataclass(frozen=True)
class BrepBatch:
    """Parts of one topology, m of them, about their own origins: solids, or open faces.

    Rows (m,) say which of all parts they are; corners are (m, n, 3). Numbers are finite.
    """

    rows: IntArray
    corners: FloatArray
    edges: tuple[EdgeBatch, ...] = field(repr=False)
    faces: tuple[FaceBatch, ...] = field(repr=False)
    is_solid: bool = True


def brep_batch(
    rows: IntArray,
    corners: Iterable[FloatArray],
    edges: Iterable[EdgeBatch],
    faces: Iterable[FaceBatch],
    *,
    is_solid: bool = True,
) -> BrepBatch:
    """Parts of one topology with corners (m, 3) each; solids if the faces are closed."""
    points = np.stack(list(corners), axis=1)
    return BrepBatch(rows, points, tuple(edges), tuple(faces), is_solid)


def select_rows(batch: BrepBatch, chosen: IntArray) -> BrepBatch:
    """Some parts of a batch, by their places in it."""
    edges, faces = (
        tuple(replace(each, numbers=each.numbers[chosen]) for each in members)
        for members in (batch.edges, batch.faces)
    )
    return replace(
        batch, rows=batch.rows[chosen], corners=batch.corners[chosen], edges=edges, faces=faces
    )


def batches_by_kind(
    kinds: FloatArray, make: Callable[[IntArray], BrepBatch]
) -> list[BrepBatch]:
    """Parts of several topologies: those with equal rows of kinds have one.

    `make` makes the batch of some rows, all of one topology.
    """
    if not len(kinds):
        return []
    _, groups = np.unique(kinds, axis=0, return_inverse=True)
    order = np.argsort(groups.ravel(), kind="stable")
    bounds = np.flatnonzero(np.diff(groups.ravel()[order])) + 1
    return [make(rows) for rows in np.split(order, bounds)]


def circle_numbers(arcs: Arcs, circles: ArcCircles) -> FloatArray:
    """What tells the circles of arcs in an `EdgeBatch`: (n, 10), parameter 0 at the start."""
    x, _ = circle_axes(arcs, circles)
    return np.column_stack([circles.centers, circles.axes, x, circles.radii])
