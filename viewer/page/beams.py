"""Beams and node cylinders as a page draws them: corners, rises and axes."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import FloatArray, dot, unit
from ...kernel.beams.beams import Beams, section_arcs
from ...kernel.beams.node_cylinders import NodeCylinders
from .grid import Grid


def beam_points(beams: Beams) -> FloatArray:
    """Corners (8 B, 3) of the sections of beams, in model coordinates."""
    points: FloatArray = beams.sections + beams.annuli.origins[:, None, None]
    half = beams.annuli.frames[:, 2] * beams.thickness / 2
    both = np.stack([points - half[:, None, None], points + half[:, None, None]])
    return both.reshape(-1, 3)


def beam_arrays(beams: Beams, grid: Grid) -> dict[str, NDArray[Any]]:
    """Arrays of a page for B beams, coordinates in steps of the grid, lengths in its size.

    ``beam_corners`` (B, 12): at both ends the outer and the inner corner of the section in the
    middle of the thickness; ``beam_planes`` (B, 3), the normals of its plane; ``beam_rises``
    (B, 2), the sagittas of the outer and the inner arc along plane normal × chord.
    """
    rises: list[FloatArray] = []
    planes = beams.annuli.frames[:, 2]
    for arcs in section_arcs(beams):
        across = np.cross(planes, unit(arcs.ends - arcs.starts))
        rises.append(arcs.sagittas * dot(across, arcs.rises))
    corners = grid.steps(beams.sections + beams.annuli.origins[:, None, None])
    return {
        "beam_corners": corners.reshape(beams.n_beams, 12),
        "beam_planes": planes,
        "beam_rises": np.stack(rises, 1) / grid.size,
    }


def node_arrays(nodes: NodeCylinders, grid: Grid) -> dict[str, NDArray[Any]]:
    """Arrays of a page for N node cylinders: first discs, axes and heights."""
    return {
        "node_origins": grid.steps(nodes.origins),
        "node_axes": nodes.directions,
        "node_heights": nodes.heights / grid.size,
    }
