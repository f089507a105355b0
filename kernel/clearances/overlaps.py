"""How deep bodies overlap, and how far apart they are."""

from collections.abc import Callable

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm
from .bodies import HALF_ARC, Bodies, common_frame, face_slopes, face_values, select_bodies
from .interior_point import minimize_within

_BATCH = 1 << 13
"""As many pairs at once as stay in the processor's cache."""

_DEPTH_ROUNDS = 14
_DISTANCE_ROUNDS = 32
_STARTS = 4
_ROUNDING = 1e-9


def overlap_depths(first: Bodies, second: Bodies) -> FloatArray:
    """Widths (n,) of what pairs of bodies have in common, negative where they are apart.

    Twice the largest distance that a point can have from all faces of both, seen from inside:
    the diameter of the largest ball in both. It is zero where bodies touch, and where they are
    apart no larger than their distance, with the sign changed.
    """
    return _in_batches(_depths, first, second)


def separated_by_planes(
    first: Bodies, second: Bodies, rows: IntArray, others: IntArray, least: float
) -> BoolArray:
    """Which pairs (n,) planes keep apart.

    Two planes that look away from each other, as the wall between two panels and the mitre of
    two beams; or a plane of one that all of the other lies behind. What both bodies can have in
    common is then no wider than `least`; pairs of which planes tell nothing are not marked.
    """
    result = np.zeros(len(rows), bool)
    for begin in range(0, len(rows), _BATCH):
        part = slice(begin, begin + _BATCH)
        one, two = select_bodies(first, rows[part]), select_bodies(second, others[part])
        shift = one.origins - two.origins
        (normals, levels), (far_normals, far_levels) = _planes(one), _planes(two)
        far_levels = far_levels - np.einsum("nmi,ni->nm", far_normals, shift)
        # Where two functions are at least zero, so is their sum, which varies by little.
        cosine = np.einsum("nai,nbi->nab", normals, far_normals)
        slope = np.sqrt(np.maximum(2 + 2 * cosine, 0.0))
        reach = norm(one.points).max(axis=1)[:, None, None] * 2
        excess = slope * reach - levels[:, :, None] - far_levels[:, None]
        found = (excess <= least).any(axis=(1, 2))
        moved = two.points - shift[:, None]
        found |= (_reach(normals, moved, two.edges) - levels <= least).any(axis=1)
        found |= (_reach(far_normals, one.points, one.edges) - far_levels <= least).any(axis=1)
        result[part] = found
    return result


def _reach(normals: FloatArray, points: FloatArray, edges: IntArray) -> FloatArray:
    """How far bodies reach along normals (n, m, 3): no less than they do.

    The points of the bodies, and their edges: a half of an arc lies over its chord by no more
    than `HALF_ARC` of what the whole does, most in its middle and none at its ends.
    """
    values = np.einsum("nmi,nki->nmk", normals, points)
    result = values.max(axis=2)
    if edges.shape[1] == 0:
        return result
    row = np.arange(len(points))[:, None]
    starts, middles, ends = (points[row, edges[..., k]] for k in range(3))
    along = norm(ends - starts)[:, None]
    rises = middles - (starts + ends) / 2
    columns = np.arange(int(normals.shape[1]), dtype=np.int64)
    before, middle, after = (
        values[row[..., None], columns[None, :, None], edges[:, None, :, k]] for k in range(3)
    )
    lean = np.divide(after - before, along**2, out=np.zeros_like(before), where=along > 0)
    bulge = HALF_ARC * (
        np.abs(middle - (before + after) / 2) + 2 * dot(rises, rises)[:, None] * np.abs(lean)
    )
    for end in (before, after):
        over = np.where(np.abs(end - middle) < 4 * bulge, bulge, 0.0)
        result = np.maximum(result, (np.maximum(end, middle) + over).max(axis=2))
    return result


def _planes(bodies: Bodies) -> tuple[FloatArray, FloatArray]:
    """Normals and levels of plane faces; of all others a level at which nothing is told."""
    rows = bodies.rows
    is_plane = (rows[..., 0] == 0) & rows[..., 1:4].any(axis=-1)
    levels = np.where(is_plane, rows[..., 4], -np.inf)
    return np.where(is_plane[..., None], rows[..., 1:4], 0.0), levels


def nearest_points(first: Bodies, second: Bodies) -> FloatArray:
    """Nearest points (n, 2, 3) of pairs of bodies, in model coordinates.

    Where bodies touch or overlap, both are one point, up to rounding.
    """
    return _in_batches(_nearest, first, second)


def body_distances(first: Bodies, second: Bodies) -> FloatArray:
    """Distances (n,) of pairs of bodies; 0 where they touch or overlap."""
    points = nearest_points(first, second)
    return norm(points[:, 0] - points[:, 1])


def _in_batches(
    measure: Callable[[Bodies, Bodies], FloatArray], first: Bodies, second: Bodies
) -> FloatArray:
    parts: list[FloatArray] = []
    for begin in range(0, max(first.n_bodies, 1), _BATCH):
        rows = np.arange(begin, min(begin + _BATCH, first.n_bodies))
        parts.append(measure(select_bodies(first, rows), select_bodies(second, rows)))
    return np.concatenate(parts)


def _scaled(
    first: Bodies, second: Bodies
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Faces and points of pairs in sizes of the smaller body, and the sizes."""
    rows, axes, points, others = common_frame(first, second)
    sizes = np.minimum(*(np.ptp(part, axis=1).max(axis=1) for part in (points, others)))
    units = np.ones((len(sizes), 1, 5))
    units[:, 0, 0], units[:, 0, 4] = sizes, 1 / sizes
    return (
        rows * units,
        axes,
        points / sizes[:, None, None],
        others / sizes[:, None, None],
        sizes,
    )


def _depths(first: Bodies, second: Bodies) -> FloatArray:
    rows, axes, points, others, sizes = _scaled(first, second)
    middle = _nearest_starts(points, others, 1)[0].mean(axis=1)
    least = face_values(rows, axes, middle).min(axis=1)
    start = np.column_stack([middle, least - 0.1])

    def _functions(unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        values = face_values(rows, axes, unknowns[:, :3]) - unknowns[:, 3:]
        slopes = face_slopes(rows, axes, unknowns[:, :3])
        return values, np.concatenate([slopes, np.full((*values.shape, 1), -1.0)], 2)

    def _curvature(forces: FloatArray) -> tuple[FloatArray, FloatArray]:
        whole, positive = np.zeros((2, len(forces), 4, 4))
        whole[:, :3, :3], positive[:, :3, :3] = _bending(rows, axes, forces)
        return whole, positive

    found = minimize_within(
        start, np.zeros((4, 4)), np.array([0.0, 0.0, 0.0, -1.0]), _functions, _curvature,
        _DEPTH_ROUNDS,
    )  # fmt: skip
    # What the last point really has, whatever the method reached.
    values = face_values(rows, axes, found[:, :3])
    slopes = norm(face_slopes(rows, axes, found[:, :3]))
    return 2 * (2 * values / (1 + np.where(slopes > 0, slopes, 1.0))).min(axis=1) * sizes


def _bending(
    rows: FloatArray, axes: FloatArray, forces: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Curvature (n, 3, 3) of faces, and of those that bend towards their bodies."""
    result: list[FloatArray] = []
    for curvature in (rows[..., 0], np.maximum(rows[..., 0], 0.0)):
        weights = 2 * curvature * forces
        along = np.einsum("nm,nmi,nmj->nij", weights, axes, axes, optimize=True)
        result.append(weights.sum(axis=1)[:, None, None] * np.eye(3) - along)
    return result[0], result[1]


def _nearest_starts(points: FloatArray, others: FloatArray, count: int) -> list[FloatArray]:
    """Pairs (n, 2, 3) of points of both bodies: the nearest ones, far from each other."""
    apart = norm(points[:, :, None] - others[:, None])
    flat = apart.reshape(len(points), apart.shape[1] * apart.shape[2])
    row = np.arange(len(points))
    result: list[FloatArray] = []
    for _ in range(count):
        best = flat.argmin(axis=1)
        i, j = np.divmod(best, apart.shape[2])
        pair = np.stack([points[row, i], others[row, j]], 1)
        result.append(pair)
        near = norm(points - pair[:, :1]) < 0.3
        flat = np.where(np.repeat(near, apart.shape[2], axis=1), np.inf, flat)
    return result


def _nearest(first: Bodies, second: Bodies) -> FloatArray:
    rows, axes, points, others, sizes = _scaled(first, second)
    split = first.rows.shape[1]

    def _functions(unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        values: list[FloatArray] = []
        slopes: list[FloatArray] = []
        for k, faces in enumerate((slice(None, split), slice(split, None))):
            part = unknowns[:, 3 * k : 3 * k + 3]
            values.append(face_values(rows[:, faces], axes[:, faces], part))
            own = face_slopes(rows[:, faces], axes[:, faces], part)
            slopes.append(np.concatenate([own, 0 * own][:: 1 - 2 * k], 2))
        return np.concatenate(values, 1), np.concatenate(slopes, 1)

    def _curvature(forces: FloatArray) -> tuple[FloatArray, FloatArray]:
        whole, positive = np.zeros((2, len(forces), 6, 6))
        for faces, place in ((slice(None, split), slice(3)), (slice(split, None), slice(3, 6))):
            bend = _bending(rows[:, faces], axes[:, faces], forces[:, faces])
            whole[:, place, place], positive[:, place, place] = bend
        return whole, positive

    eye = np.eye(3)
    quadratic = np.block([[eye, -eye], [-eye, eye]])
    best, result = np.full(len(sizes), np.inf), np.zeros((len(sizes), 2, 3))
    for pair in _nearest_starts(points, others, _STARTS):
        found = minimize_within(
            pair.reshape(-1, 6), quadratic, np.zeros(6), _functions, _curvature,
            _DISTANCE_ROUNDS,
        )  # fmt: skip
        is_inside = _functions(found)[0].min(axis=1) > -_ROUNDING
        apart = norm(found[:, :3] - found[:, 3:])
        is_better = is_inside & (apart < best)
        best = np.where(is_better, apart, best)
        result[is_better] = found[is_better].reshape(-1, 2, 3)
    return result * sizes[:, None, None] + first.origins[:, None]


def part_pairs(
    values: FloatArray, first: IntArray, second: IntArray
) -> tuple[IntArray, IntArray, FloatArray]:
    """Largest value of each pair of parts, of those of their bodies."""
    order = np.lexsort((-values, second, first))
    keys = np.stack([first[order], second[order]], 1)
    is_first = np.ones(len(keys), bool)
    is_first[1:] = (np.diff(keys, axis=0) != 0).any(axis=1)
    chosen = order[is_first]
    return first[chosen], second[chosen], values[chosen]
