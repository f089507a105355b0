"""What an exact support shall be like, as terms: each residual is 1 at what is tolerable.

Vertices stay near the surface and, less strictly, where they were; neighbours meet smoothly;
axes are upright; curvatures are nearly equal and near the one that suits the surface. Moves
that come near their bound meet a wall. Lengths are in mean edges, angles in radians.
"""

import numpy as np

from ..arrays import FloatArray, dot, norm
from ..solvers.blocks import Block
from ..spheres.incidence import normals
from .design_surface import across_rim, heights, slides
from .setting import SlideSetting, SlidState, Unknown
from .terms import SlideTerm, points_at, rows_at

HEIGHT, SLIDE = 1 / 3, 3 / 7
"""Tolerable shares of the bounds of a move: 0.02 and 0.3 edges for 0.06 and 0.7."""

RIM = 0.05
"""Tolerable move across the boundary."""

ANGLE = 0.10
"""Tolerable angle between neighbours at a vertex."""

TOLERABLE_LEAN = 0.15
"""Tolerable lean of an axis, as a tangent."""

LEAST_AXIS = 0.2
"""Poles shorter than this, in their unit, do not lean more for it."""

ALIKE_CURVATURE = 0.02
"""Tolerable difference of A between neighbours."""

HOLD = 0.2
"""Tolerable share by which curvatures leave the one that suits the surface."""

KEPT_LENGTH, EDGE_WIDTH = 0.6, 0.05
"""Share of its length that an edge keeps along itself, and within which a wall rises."""

WALL, WALL_WIDTH = 0.9, 0.05
"""Share of a bound at which its wall begins, and within which it rises by a unit."""


def _vertices(setting: SlideSetting) -> tuple[Block, ...]:
    return (Block(Unknown.SHIFT, np.arange(setting.mesh.n_vertices)),)


def _vertices_twice(setting: SlideSetting) -> tuple[Block, ...]:
    return (Block(Unknown.SHIFT, np.tile(np.arange(setting.mesh.n_vertices), 2)),)


def _height(setting: SlideSetting, state: SlidState) -> FloatArray:
    return heights(setting.surface, state.shifts)[0] / (HEIGHT * setting.bounds.height)


def _height_jacobian(setting: SlideSetting, state: SlidState) -> tuple[FloatArray, ...]:
    slopes = heights(setting.surface, state.shifts)[1]
    return (slopes / (HEIGHT * setting.bounds.height),)


def _height_wall(setting: SlideSetting, state: SlidState) -> FloatArray:
    share = heights(setting.surface, state.shifts)[0] / setting.bounds.height
    return np.copysign(np.maximum(np.abs(share) - WALL, 0) / WALL_WIDTH, share)


def _height_wall_jacobian(setting: SlideSetting, state: SlidState) -> tuple[FloatArray, ...]:
    lengths, slopes = heights(setting.surface, state.shifts)
    bound = setting.bounds.height
    is_beyond = np.abs(lengths) > WALL * bound
    return (slopes * (is_beyond / (WALL_WIDTH * bound))[:, None],)


def _slide_bounds(setting: SlideSetting) -> FloatArray:
    return setting.bounds.slide * setting.surface.reach


def _slide(setting: SlideSetting, state: SlidState) -> FloatArray:
    shares = slides(setting.surface, state.shifts) / _slide_bounds(setting)[:, None]
    return (shares / SLIDE).T.ravel()


def _slide_jacobian(setting: SlideSetting, _: SlidState) -> tuple[FloatArray, ...]:
    tangents = setting.surface.frames[:, :2] / _slide_bounds(setting)[:, None, None]
    return (np.concatenate([tangents[:, 0], tangents[:, 1]]) / SLIDE,)


def _slide_wall(setting: SlideSetting, state: SlidState) -> FloatArray:
    shares = norm(slides(setting.surface, state.shifts)) / _slide_bounds(setting)
    return np.maximum(shares - WALL, 0) / WALL_WIDTH


def _slide_wall_jacobian(setting: SlideSetting, state: SlidState) -> tuple[FloatArray, ...]:
    along, bounds = slides(setting.surface, state.shifts), _slide_bounds(setting)
    lengths = norm(along)
    is_beyond = lengths > WALL * bounds
    factors = np.divide(
        1.0, WALL_WIDTH * bounds * lengths, out=np.zeros_like(lengths), where=is_beyond
    )
    slopes = np.einsum("vi,vij->vj", along, setting.surface.frames[:, :2])
    return (factors[:, None] * slopes,)


def _edges(setting: SlideSetting) -> tuple[Block, ...]:
    return Block(Unknown.SHIFT, setting.edges[:, 0]), Block(Unknown.SHIFT, setting.edges[:, 1])


def _edge_wall(setting: SlideSetting, state: SlidState) -> FloatArray:
    return np.maximum(KEPT_LENGTH - _kept(setting, state), 0) / EDGE_WIDTH


def _kept(setting: SlideSetting, state: SlidState) -> FloatArray:
    """Share of its length that each edge has along its old direction."""
    tails, heads = setting.edges.T
    return 1 + dot(state.shifts[heads] - state.shifts[tails], setting.edge_slopes)


def _edge_wall_jacobian(setting: SlideSetting, state: SlidState) -> tuple[FloatArray, ...]:
    is_beyond = _kept(setting, state) < KEPT_LENGTH
    slopes = setting.edge_slopes * (is_beyond / EDGE_WIDTH)[:, None]
    return slopes, -slopes


def _rim_blocks(setting: SlideSetting) -> tuple[Block, ...]:
    return (Block(Unknown.SHIFT, np.repeat(setting.surface.rim, 3)),)


def _rim(setting: SlideSetting, state: SlidState) -> FloatArray:
    return across_rim(setting.surface, state.shifts)[0].ravel() / RIM


def _rim_jacobian(setting: SlideSetting, state: SlidState) -> tuple[FloatArray, ...]:
    return (across_rim(setting.surface, state.shifts)[1].reshape(-1, 3) / RIM,)


def _angle_blocks(setting: SlideSetting) -> tuple[Block, ...]:
    mesh, (first, second) = setting.mesh, np.repeat(setting.pairs, 3, axis=0).T
    faces = mesh.topology.corner_faces
    return (
        Block(Unknown.ROW, faces[first]),
        Block(Unknown.ROW, faces[second]),
        Block(Unknown.SHIFT, mesh.corners[first]),
    )


def _angle(setting: SlideSetting, state: SlidState) -> FloatArray:
    left, right = (
        normals(rows_at(setting, state, c), points_at(setting, state, c))
        for c in setting.pairs.T
    )
    # Both ends of an edge count: halves.
    return (left - right).ravel() / (ANGLE * np.sqrt(2))


def _angle_jacobian(setting: SlideSetting, state: SlidState) -> tuple[FloatArray, ...]:
    count, unit = len(setting.pairs), ANGLE * np.sqrt(2)
    by_rows: list[FloatArray] = []
    for corners, sign in zip(setting.pairs.T, (1, -1), strict=True):
        table = np.zeros((count, 3, 5))
        table[:, :, 0] = -2 * sign * points_at(setting, state, corners)
        table[:, :, 1:4] = sign * np.eye(3)
        by_rows.append(table.reshape(-1, 5) / unit)
    first, second = setting.pairs.T
    differ = rows_at(setting, state, first)[:, 0] - rows_at(setting, state, second)[:, 0]
    by_shift = (-2 * differ[:, None, None] * np.eye(3)).reshape(-1, 3) / unit
    return by_rows[0], by_rows[1], by_shift


def _lean_blocks(setting: SlideSetting) -> tuple[Block, ...]:
    return (Block(Unknown.POLE, np.tile(np.arange(len(setting.nodes)), 2)),)


def _axis_heights(setting: SlideSetting, state: SlidState) -> tuple[FloatArray, FloatArray]:
    """Heights (N,) of the poles, not less than the least, and their derivatives (N, 3)."""
    upward = setting.surface.frames[setting.nodes, 2]
    signed, least = dot(state.poles, upward), LEAST_AXIS * setting.node_scales
    is_high = np.abs(signed) > least
    slopes = np.where(is_high[:, None], np.sign(signed)[:, None] * upward, 0.0)
    return np.where(is_high, np.abs(signed), least), slopes


def _lean(setting: SlideSetting, state: SlidState) -> FloatArray:
    tangents = setting.surface.frames[setting.nodes, :2]
    rise, _ = _axis_heights(setting, state)
    return (np.einsum("nij,nj->in", tangents, state.poles) / (TOLERABLE_LEAN * rise)).ravel()


def _lean_jacobian(setting: SlideSetting, state: SlidState) -> tuple[FloatArray, ...]:
    tangents = setting.surface.frames[setting.nodes, :2]
    rise, slopes = _axis_heights(setting, state)
    along = np.einsum("nij,nj->in", tangents, state.poles)
    unit = TOLERABLE_LEAN * rise[:, None]
    tables = [
        tangents[:, i] / unit - (along[i] / (TOLERABLE_LEAN * rise**2))[:, None] * slopes
        for i in (0, 1)
    ]
    return (np.concatenate(tables),)


def _alike_blocks(setting: SlideSetting) -> tuple[Block, ...]:
    left, right = setting.mesh.topology.edge_faces.T
    return Block(Unknown.ROW, left), Block(Unknown.ROW, right)


def _alike(setting: SlideSetting, state: SlidState) -> FloatArray:
    left, right = setting.mesh.topology.edge_faces.T
    return (state.rows[left, 0] - state.rows[right, 0]) / ALIKE_CURVATURE


def _alike_jacobian(setting: SlideSetting, _: SlidState) -> tuple[FloatArray, ...]:
    table = np.zeros((len(setting.mesh.topology.edge_faces), 5))
    table[:, 0] = 1 / ALIKE_CURVATURE
    return table, -table


def _faces(setting: SlideSetting) -> tuple[Block, ...]:
    return (Block(Unknown.ROW, np.arange(setting.mesh.n_faces)),)


def _hold(setting: SlideSetting, state: SlidState) -> FloatArray:
    return (state.rows[:, 0] - setting.curvatures / 2) / (HOLD * setting.scales)


def _hold_jacobian(setting: SlideSetting, _: SlidState) -> tuple[FloatArray, ...]:
    table = np.zeros((setting.mesh.n_faces, 5))
    table[:, 0] = 1 / (HOLD * setting.scales)
    return (table,)


LEAN = SlideTerm("lean", _lean_blocks, _lean, _lean_jacobian)
"""Axes are upright."""

WISHES = (
    SlideTerm("height", _vertices, _height, _height_jacobian),
    SlideTerm("height_wall", _vertices, _height_wall, _height_wall_jacobian),
    SlideTerm("slide", _vertices_twice, _slide, _slide_jacobian),
    SlideTerm("slide_wall", _vertices, _slide_wall, _slide_wall_jacobian),
    SlideTerm("edge_wall", _edges, _edge_wall, _edge_wall_jacobian),
    SlideTerm("rim", _rim_blocks, _rim, _rim_jacobian),
    SlideTerm("angle", _angle_blocks, _angle, _angle_jacobian),
    LEAN,
    SlideTerm("alike", _alike_blocks, _alike, _alike_jacobian),
    SlideTerm("hold", _faces, _hold, _hold_jacobian),
)
"""Terms of the objective."""
