"""The conditions of an exact support, as terms: residuals and derivatives.

A sphere with row (A, B, C) passes through v if ``A |v|² - B·v + C = 0``. It passes
through ``v + p / |p|²`` as well if and only if ``A = p · N``, with its normal
``N = B - 2 A v`` at v: one linear form for Prop. 4.2 and 4.3, for planes as for spheres. Then
all spheres of the node meet in two points of the line along p, and beams in the planes of
their circles share it.

A beam between two nodes then is flat: its two axes lie in the plane of the circle. Neighbours
that become one sphere have no such plane, and the more alike they are the less they tell it:
their axes may be askew. Then flatness, ``det(p, p', e) = 0``, is a condition of its own. It
keeps neighbours from becoming one sphere at some cost in angles, so nets are first sought
without it.
"""

import numpy as np

from ..arrays import FloatArray, dot
from ..solvers.blocks import Block
from ..spheres.incidence import evaluate, normals
from ..spheres.minkowski import minkowski, minkowski_gradient
from .setting import SlideSetting, SlidState, Unknown
from .terms import SlideTerm, points_at, rows_at


def _incidence_blocks(setting: SlideSetting) -> tuple[Block, ...]:
    mesh = setting.mesh
    return (
        Block(Unknown.ROW, mesh.topology.corner_faces),
        Block(Unknown.SHIFT, mesh.corners),
    )


def _incidence(setting: SlideSetting, state: SlidState) -> FloatArray:
    corners = np.arange(len(setting.corners))
    return evaluate(rows_at(setting, state, corners), points_at(setting, state, corners))


def _incidence_jacobian(setting: SlideSetting, state: SlidState) -> tuple[FloatArray, ...]:
    corners = np.arange(len(setting.corners))
    rows, points = rows_at(setting, state, corners), points_at(setting, state, corners)
    ones = np.ones((len(points), 1))
    by_row = np.concatenate([dot(points, points)[:, None], -points, ones], axis=1)
    return by_row, -normals(rows, points)


def _axis_blocks(setting: SlideSetting) -> tuple[Block, ...]:
    mesh, spokes = setting.mesh, setting.spokes
    return (
        Block(Unknown.ROW, mesh.topology.corner_faces[spokes]),
        Block(Unknown.SHIFT, mesh.corners[spokes]),
        Block(Unknown.POLE, setting.spoke_nodes),
    )


def _axis(setting: SlideSetting, state: SlidState) -> FloatArray:
    rows, points = (
        rows_at(setting, state, setting.spokes),
        points_at(setting, state, setting.spokes),
    )
    poles = state.poles[setting.spoke_nodes]
    units = setting.node_scales[setting.spoke_nodes]
    return (rows[:, 0] - dot(poles, normals(rows, points))) / units


def _axis_jacobian(setting: SlideSetting, state: SlidState) -> tuple[FloatArray, ...]:
    rows, points = (
        rows_at(setting, state, setting.spokes),
        points_at(setting, state, setting.spokes),
    )
    poles = state.poles[setting.spoke_nodes]
    units = setting.node_scales[setting.spoke_nodes, None]
    by_a = 1 + 2 * dot(poles, points)[:, None]
    by_row = np.concatenate([by_a, -poles, np.zeros_like(by_a)], axis=1)
    by_shift = 2 * rows[:, :1] * poles
    return by_row / units, by_shift / units, -normals(rows, points) / units


def _unit_blocks(setting: SlideSetting) -> tuple[Block, ...]:
    return (Block(Unknown.ROW, np.arange(setting.mesh.n_faces)),)


def _unit(_: SlideSetting, state: SlidState) -> FloatArray:
    return minkowski(state.rows, state.rows) - 1


def _unit_jacobian(_: SlideSetting, state: SlidState) -> tuple[FloatArray, ...]:
    return (2 * minkowski_gradient(state.rows),)


def _flat_blocks(setting: SlideSetting) -> tuple[Block, ...]:
    (first, second), (tails, heads) = setting.beam_nodes.T, setting.nodes[setting.beam_nodes].T
    return (
        Block(Unknown.POLE, first),
        Block(Unknown.POLE, second),
        Block(Unknown.SHIFT, tails),
        Block(Unknown.SHIFT, heads),
    )


def _beam(setting: SlideSetting, state: SlidState) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Poles (n, 3) at both ends of the beams between nodes, in their units, and edges."""
    ends = setting.beam_nodes
    poles = state.poles[ends] / setting.node_scales[ends, None]
    tails, heads = setting.nodes[ends].T
    along = setting.beam_edges + state.shifts[heads] - state.shifts[tails]
    return poles[:, 0], poles[:, 1], along


def _flat(setting: SlideSetting, state: SlidState) -> FloatArray:
    first, second, along = _beam(setting, state)
    return dot(np.cross(first, second), along)


def _flat_jacobian(setting: SlideSetting, state: SlidState) -> tuple[FloatArray, ...]:
    first, second, along = _beam(setting, state)
    units = setting.node_scales[setting.beam_nodes].T[..., None]
    by_tail = -np.cross(first, second)
    return (
        np.cross(second, along) / units[0],
        np.cross(along, first) / units[1],
        by_tail,
        -by_tail,
    )


COMMON_AXES = SlideTerm("axis", _axis_blocks, _axis, _axis_jacobian)
"""All spheres of a node pass through a second point on its axis."""

CONDITIONS = (
    SlideTerm("incidence", _incidence_blocks, _incidence, _incidence_jacobian),
    COMMON_AXES,
    SlideTerm("unit", _unit_blocks, _unit, _unit_jacobian),
)
"""Spheres pass through their vertices, nodes have axes, rows are unit."""

FLATNESS = SlideTerm("flat", _flat_blocks, _flat, _flat_jacobian)
"""Beams are flat."""
