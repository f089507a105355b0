"""What keeps a panel from being made: crossing boundaries, lost corners, caps too deep."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from ..arrays import BoolArray, FloatArray, dot, norm, unit
from ..parts.records import select_parts
from ..spheres.arc_crossings import crossing_boundaries
from ..spheres.arcs import Arcs, arc_points
from ..spheres.incidence import normals
from ..tolerances import CAP_ANGLE, THIN
from .panels import Panels, boundaries, panel_areas

NO_PANEL: Final = "P100"
"""Code of a panel that cannot be made."""


@dataclass(frozen=True)
class Found:
    """What cutting the panels found.

    Attributes
    ----------
    references : (H, 3) float array
        Vertices of the mesh faces, local to the panels.
    faces : (P,) bool array
        Whether both faces stay clear of the centre of their sphere.
    corners, outer_corners, inner_corners : (H,) bool array
        Whether the corners of the given spheres, and of the outer and inner faces, were found.
    """

    references: FloatArray
    faces: BoolArray
    corners: BoolArray
    outer_corners: BoolArray
    inner_corners: BoolArray


Fault = tuple[str, BoolArray]
"""A reason, and the panels (P,) that it holds for."""


def rejection_reasons(panels: Panels, found: Found) -> dict[int, str]:
    """Why panels cannot be made, by panel; those that can be made do not occur.

    Where one fault brings others with it, the reason is the cause: every fault is looked for in
    every panel, and they are ranked (`_faults`).
    """
    faults = _faults(panels, found)
    sound = ~np.any([bad for _, bad in faults], axis=0)
    # The area integral of an unsound panel may reach where it has no origin.
    areas = np.ones(panels.n_panels)
    areas[sound] = panel_areas(select_parts(panels, sound))
    faults.append(("the boundary runs clockwise about the face normal", areas <= 0))
    table = np.array([bad for _, bad in faults])
    causes = table.argmax(axis=0)
    return {int(panel): faults[causes[panel]][0] for panel in np.flatnonzero(table.any(axis=0))}


def _faults(panels: Panels, found: Found) -> list[Fault]:
    """Faults, each before those that it may cause."""

    def _any_corner(is_bad: BoolArray) -> BoolArray:
        return np.logical_or.reduceat(is_bad, panels.offsets[:-1])

    is_fold = (panels.plane_normals == 0).all(axis=1)
    sizes = 2 * np.maximum.reduceat(norm(found.references), panels.offsets[:-1])
    is_thin = (panels.thickness > 0) & (panels.thicknesses < THIN * sizes)
    faults: list[Fault] = [
        ("the face folds back onto a neighbour", _any_corner(is_fold)),
        (
            "two cutting planes do not meet on the sphere at a corner",
            _any_corner(~found.corners),
        ),
        (
            "the thickness reaches the centre of the sphere: make it thinner, or its mould "
            "larger",
            ~found.faces,
        ),
        (
            "thinner than a millionth of its size: with constant power planes have no "
            "thickness",
            is_thin,
        ),
        ("the thickness leaves no corner on the outer face", _any_corner(~found.outer_corners)),
        ("the thickness leaves no corner on the inner face", _any_corner(~found.inner_corners)),
    ]
    sides = found.references[panels.next_corners] - found.references
    has_sides = panels.thickness > 0 or panels.joint_gap > 0
    for name, (rows, arcs) in zip(("outer", "inner"), boundaries(panels), strict=False):
        corner_rows = rows[panels.corner_panels]
        backwards = _any_corner(dot(arcs.ends - arcs.starts, sides) <= 0)
        leaning = _any_corner(has_sides & _leaning(corner_rows, arcs))
        steep = _any_corner(_steep(corner_rows, arcs))
        faults += [
            (f"an edge of the {name} face vanishes or runs backwards", backwards),
            (
                f"the boundary of the {name} face crosses itself",
                crossing_boundaries(
                    rows, panels.offsets, panels.plane_normals, panels.plane_offsets, arcs
                ),
            ),
            (f"a cutting plane leans over the {name} face: cut it by bisectors", leaning),
            (f"the {name} face reaches more than 80 degrees from its middle: split it", steep),
        ]
    return faults


def _leaning(rows: FloatArray, arcs: Arcs) -> BoolArray:
    """Whether panels begin on the wrong side of a plane, or arcs exceed a half circle."""
    middles = (arcs.starts + arcs.ends) / 2
    return dot(normals(rows, middles), arcs.rises) <= 0


def _steep(rows: FloatArray, arcs: Arcs) -> BoolArray:
    """Whether arcs reach beyond the largest cap about the local origin."""
    axis = unit(rows[:, 1:4])[:, None]
    points = arc_points(arcs, np.array([-1.0, 0.0]))
    return (dot(normals(rows[:, None], points), axis) < np.cos(CAP_ANGLE)).any(axis=1)
