"""Terms of the search: what they are made of, and the values at corners that they need."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray
from ..solvers.blocks import Block
from .setting import SlideSetting, SlidState


@dataclass(frozen=True)
class SlideTerm:
    """One term: residuals (m,) that shall be 0, each in units of what is tolerable.

    Attributes
    ----------
    blocks : callable
        Setting to what each residual depends on.
    residuals : callable
        SlideSetting and state to (m,) residuals.
    jacobian : callable
        SlideSetting and state to one (m, width) table of derivatives per block.
    """

    name: str
    blocks: Callable[[SlideSetting], tuple[Block, ...]]
    residuals: Callable[[SlideSetting, SlidState], FloatArray]
    jacobian: Callable[[SlideSetting, SlidState], tuple[FloatArray, ...]]


def rows_at(setting: SlideSetting, state: SlidState, corners: IntArray) -> FloatArray:
    """Rows (m, 5) of the faces of corners."""
    return state.rows[setting.mesh.topology.corner_faces[corners]]


def points_at(setting: SlideSetting, state: SlidState, corners: IntArray) -> FloatArray:
    """Points (m, 3) of corners, local to their face."""
    return setting.corners[corners] + state.shifts[setting.mesh.corners[corners]]


def stacked(tables: list[FloatArray]) -> FloatArray:
    """Tables (m, k), one per coordinate, as one table in the order of coordinates."""
    return np.concatenate(tables, axis=0)
