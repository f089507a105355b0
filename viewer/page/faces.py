"""Faces of panels as a page draws them: points by row, triangles by pattern.

The triangles are those of `tessellate`. Panels of the same degree and fineness have the same
ones, so that a page is told each pattern once. Walls are left out: they hang between the rims,
which are the last points of each face, so many on each edge.
"""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import FloatArray, IntArray, unit
from ...kernel.panels.panels import Panels
from ...kernel.panels.tessellation import PanelTriangles, tessellate
from ...kernel.spheres.incidence import normals
from .grid import STEPS, Grid

FINE, COARSE = 0.002, 0.005
"""How far triangles may be off, relative to a panel: of a few panels, and of many."""

MANY: Final = 2000
"""Panels from which on each is small in the picture."""


@dataclass(frozen=True)
class Faces:
    """Outer or inner faces of P panels.

    Attributes
    ----------
    points : (N, 3) float array
        Points, in model coordinates, those of a panel together.
    normals : (N, 3) float array
        Exact unit normals there, outwards.
    starts : (P,) int array
        First point of each panel.
    kinds : (P,) int array
        Pattern of each panel.
    patterns : tuple of (T, 3) int array
        Triangles, counted from the first point of a panel.
    rims : tuple of tuple of int
        Points along each edge, of each pattern: the last ones.
    """

    points: FloatArray
    normals: FloatArray
    starts: IntArray
    kinds: IntArray
    patterns: tuple[IntArray, ...]
    rims: tuple[tuple[int, ...], ...]


def panel_faces(panels: Panels, tolerance: float | None = None) -> list[Faces]:
    """The outer faces of panels, and the inner ones if there is a thickness.

    The tolerance says how far triangles may be off, relative to a panel.
    """
    if tolerance is None:
        tolerance = FINE if panels.n_panels < MANY else COARSE
    skin = tessellate(panels, tolerance)
    sides = 1 if panels.thickness == 0 else 2
    return [_side(panels, skin, side) for side in range(sides)]


def _side(panels: Panels, skin: PanelTriangles, side: int) -> Faces:
    """Triangles of one side in the order of the panels."""
    count = panels.n_panels
    chosen = np.flatnonzero(
        (skin.surfaces >= side * count) & (skin.surfaces < (side + 1) * count)
    )
    owners = skin.panels[chosen]
    order = np.argsort(owners, kind="stable")
    triangles, owners = skin.triangles[chosen][order], owners[order]
    bounds = np.searchsorted(owners, np.arange(count + 1))
    first = np.minimum.reduceat(triangles.min(axis=1), bounds[:-1])
    last = np.maximum.reduceat(triangles.max(axis=1), bounds[:-1])
    known: dict[tuple[bytes, tuple[int, ...]], int] = {}
    kinds: list[int] = []
    for panel in range(count):
        own = triangles[bounds[panel] : bounds[panel + 1]] - first[panel]
        rim = tuple(skin.steps[panels.offsets[panel] : panels.offsets[panel + 1]].tolist())
        kinds.append(known.setdefault((own.tobytes(), rim), len(known)))
    sizes = last - first + 1
    starts: IntArray = np.concatenate([[0], np.cumsum(sizes)])
    ids = np.repeat(first - starts[:-1], sizes) + np.arange(int(starts[-1]))
    return Faces(
        skin.points[ids] + skin.origin,
        skin.normals[ids] * (1 - 2 * side),
        starts[:-1],
        np.array(kinds, np.int64),
        tuple(np.frombuffer(each, np.int64).reshape(-1, 3) for each, _ in known),
        tuple(rim for _, rim in known),
    )


def face_arrays(panels: Panels, faces: list[Faces], grid: Grid) -> dict[str, NDArray[Any]]:
    """Arrays of a page for panels, coordinates in steps of the grid.

    ``degrees`` (P,); ``normals`` (P, 3) and ``curvatures`` (P,) of the outer sphere at the
    first point of its face, in units of the grid's size: at another point p the normal is
    ``n - 2 A (p - p0)``, on the inner face as well. Of each side, ``outer`` and ``inner``, the
    ``points`` (N, 3), the ``kinds`` (P,), and of all patterns one after the other the
    ``triangles`` (T, 3), the points along each edge ``rims`` and the ``sizes`` (K, 2): points
    and triangles.
    """
    first = grid.center + grid.steps(faces[0].points)[faces[0].starts] * (grid.size / STEPS)
    local = first - panels.origins
    arrays: dict[str, NDArray[Any]] = {
        "degrees": panels.degrees,
        "normals": unit(normals(panels.spheres, local)),
        "curvatures": panels.spheres[:, 0] * grid.size,
    }
    for name, side in zip(("outer", "inner"), faces, strict=False):
        sizes = [(int(each.max()) + 1, len(each)) for each in side.patterns]
        arrays |= {
            f"{name}_points": grid.steps(side.points),
            f"{name}_kinds": side.kinds,
            f"{name}_sizes": np.array(sizes, np.int64),
            f"{name}_triangles": np.concatenate(side.patterns),
            f"{name}_rims": np.concatenate(side.rims),
        }
    return arrays


def cover(side: Faces) -> IntArray:
    """Triangles (T, 3) of all points of faces."""
    sizes = [len(pattern) for pattern in side.patterns]
    triangles = np.concatenate(side.patterns)
    first = np.cumsum([0, *sizes])[:-1]
    counts = np.array(sizes)[side.kinds]
    steps = np.arange(int(counts.sum())) - np.repeat(np.cumsum(counts) - counts, counts)
    chosen: IntArray = np.repeat(first[side.kinds], counts) + steps
    return triangles[chosen] + np.repeat(side.starts, counts)[:, None]
