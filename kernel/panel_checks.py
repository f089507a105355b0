"""What keeps a panel from being made: crossing boundaries, lost corners, caps too deep."""

from dataclasses import dataclass

import numpy as np

from .arcs import Arcs, arc_points
from .arrays import BoolArray, FloatArray, dot, unit
from .crossings import crossing_boundaries
from .panels import Panels, inner_panel_arcs, panel_arcs, panel_areas, select_panels
from .spheres import normals
from .tolerances import CAP_ANGLE


@dataclass(frozen=True)
class RejectedPanel:
    """
    A panel that cannot be made.

    Attributes
    ----------
    id : str
        Name of the panel.
    face_id : int
        Its face.
    reason : str
        What is wrong, for a person.
    """

    id: str
    face_id: int
    reason: str


def rejection_reasons(
    panels: Panels, references: FloatArray, exists: BoolArray, inner_exists: BoolArray
) -> dict[int, str]:
    """
    Why panels cannot be made; of several reasons the first.

    Parameters
    ----------
    panels : Panels
        P panels with H corners, sound or not.
    references : (H, 3) float array
        Vertices of the mesh faces, local to the panels.
    exists, inner_exists : (H,) bool array
        Whether the corners of the outer and of the inner faces were found.

    Returns
    -------
    dict of int to str
        Reason by panel; panels that can be made do not occur.
    """
    owners = panels.corner_panels
    reasons: dict[int, str] = {}

    def _note(is_bad: BoolArray, reason: str) -> None:
        for panel in np.flatnonzero(is_bad):
            reasons.setdefault(int(panel), reason)

    def _any_corner(is_bad: BoolArray) -> BoolArray:
        return np.logical_or.reduceat(is_bad, panels.offsets[:-1])

    is_fold = (panels.plane_normals == 0).all(axis=1)
    _note(_any_corner(is_fold), "the face folds back onto a neighbour")
    _note(_any_corner(~exists), "two cutting planes do not meet on the sphere at a corner")
    _note(_any_corner(~inner_exists), "the thickness leaves no corner on the inner face")
    sides = references[panels.next_corners] - references
    arcs, inner_arcs = panel_arcs(panels), inner_panel_arcs(panels)
    layers = [(panels.spheres, arcs, "outer")]
    if panels.thickness > 0:
        layers.append((panels.inner_spheres, inner_arcs, "inner"))
    has_sides = panels.thickness > 0 or panels.joint_gap > 0
    for rows, layer, name in layers:
        backwards = dot(layer.ends - layer.starts, sides) <= 0
        _note(_any_corner(backwards), f"an edge of the {name} face vanishes or runs backwards")
        crosses = crossing_boundaries(
            rows, panels.offsets, panels.plane_normals, panels.plane_offsets, layer
        )
        _note(crosses, f"the boundary of the {name} face crosses itself")
        if has_sides:
            leans = _any_corner(_leaning(rows[owners], layer))
            _note(leans, f"a cutting plane leans over the {name} face: cut it by bisectors")
        steep = _any_corner(_steep(rows[owners], layer))
        _note(
            steep,
            f"the {name} face reaches more than 80 degrees from its middle: split it",
        )
    sound = ~np.isin(np.arange(panels.n_panels), list(reasons))
    # The others may reach where the area integral has no origin.
    areas = np.ones(panels.n_panels)
    areas[sound] = panel_areas(select_panels(panels, sound))
    _note(areas <= 0, "the boundary runs clockwise about the face normal")
    return reasons


def _leaning(rows: FloatArray, arcs: Arcs) -> BoolArray:
    """Whether panels begin on the wrong side of a plane, or arcs exceed a half circle."""
    middles = (arcs.starts + arcs.ends) / 2
    return dot(normals(rows, middles), arcs.rises) <= 0


def _steep(rows: FloatArray, arcs: Arcs) -> BoolArray:
    """Whether arcs reach beyond the largest cap about the local origin."""
    axis = unit(rows[:, 1:4])[:, None]
    points = arc_points(arcs, np.array([-1.0, 0.0]))
    return (dot(normals(rows[:, None], points), axis) < np.cos(CAP_ANGLE)).any(axis=1)
