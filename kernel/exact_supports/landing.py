"""Landing: what the descent leaves of the conditions, met to rounding."""

from dataclasses import replace

import numpy as np

from ..arrays import unit
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..tolerances import NODE_EXACT
from .descent import meet_conditions, misses
from .setting import SlideSetting, SlidState, assembled, farthest

NEAR = 0.05
"""Mean edges by which landing may move a vertex."""


def land(setting: SlideSetting, state: SlidState) -> tuple[SphereMesh, bool]:
    """Meet all conditions to rounding; also whether that was near.

    If not, the sphere mesh is the one of the state.

    Notes
    -----
    Flat beams are a condition even where the descent did without: `planarize_near`, which does
    not ask for them, leaves neighbours that became one sphere with beams twisted by degrees.
    """
    landed = meet_conditions(setting, state)
    moved = farthest(landed.shifts - state.shifts)
    if moved <= NEAR and misses(setting, landed) <= NODE_EXACT:
        return assembled(setting, _unit(landed)), True
    return assembled(setting, state), False


def _unit(state: SlidState) -> SlidState:
    """The state with exactly unit rows: what is left to do goes to B, so that radii stay."""
    rows = state.rows.copy()
    lengths = np.sqrt(1 + 4 * rows[:, 0] * rows[:, 4])
    rows[:, 1:4] = unit(rows[:, 1:4]) * lengths[:, None]
    return replace(state, rows=rows)
