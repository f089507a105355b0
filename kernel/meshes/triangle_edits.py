"""Splits, collapses and flips of the edges of a triangle mesh, many at a time.

Every function takes triangles in units in which edges shall have length 1 and returns edited
ones. Edits that could disturb each other are not made in the same batch, so that a batch is a
few operations on arrays. None of them changes the topology, and none crosses a line: the
boundary, or a crease. Vertices on a line stay on its curve, and however the choices fall, a
line that was no farther than `STRAY` from its edges is so afterwards.
"""

from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm, unit
from ..tolerances import SAME_LENGTH
from .triangle_edges import (
    SLIVER,
    Edges,
    Triangles,
    edge_lengths,
    exceeds,
    find_edges,
    pair_keys,
    thickness,
    triangle_normals,
)

TOO_LONG, TOO_SHORT = 4 / 3, 4 / 5
STRAY = 0.1
Number = TypeVar("Number", np.int64, np.float64)
LEAST_COSINE = 0.5
SLIVER_GAIN = 1000
INDEPENDENT_ROUNDS = 8
SCATTER, SCATTER_RANGE = 2654435761, 2**32


def split_long_edges(triangles: Triangles) -> Triangles:
    """Split edges of more than 4/3, and those on a line that leave it, until none are left.

    Returns
    -------
    Triangles
        Triangles of the same shape; vertices added on a line lie in the middle of its curve.
    """
    while True:
        edges = find_edges(triangles)
        is_long = exceeds(edge_lengths(triangles, edges), TOO_LONG)
        is_long[edges.line_edges[strays(triangles)]] = True
        if not is_long.any():
            return triangles
        halved = is_long[edges.line_edges]
        arcs = triangles.arcs.mean(axis=1)[halved]
        middles = triangles.vertices[edges.ends].mean(axis=1)
        middles[edges.line_edges[halved]] = triangles.curves.at(arcs)
        middles = middles[is_long]
        ids = np.full(len(is_long), -1, np.int64)
        ids[is_long] = len(triangles.vertices) + np.arange(len(middles))
        vertices = np.concatenate([triangles.vertices, middles])
        fixed = np.concatenate([triangles.is_fixed, np.zeros(len(middles), bool)])
        faces = _split_faces(vertices, triangles.faces, ids[edges.corner_edges])
        triangles = replace(
            triangles,
            vertices=vertices,
            faces=faces,
            is_fixed=fixed,
            lines=_halved(triangles.lines, ids[edges.line_edges[halved]], halved),
            arcs=_halved(triangles.arcs, arcs, halved),
        )


def _halved(
    pairs: NDArray[Number], middles: NDArray[Number], chosen: BoolArray
) -> NDArray[Number]:
    """Pairs (n, 2), the chosen ones cut in two at their middles."""
    first, second = pairs[chosen].T
    halves = np.stack([first, middles], 1), np.stack([middles, second], 1)
    return np.concatenate([pairs[~chosen], *halves])


def strays(triangles: Triangles) -> BoolArray:
    """Edges on lines that their curve leaves by more than `STRAY`.

    Returns
    -------
    (n,) bool array
        For each edge of `lines`.
    """
    chords = triangles.vertices[triangles.lines]
    return ~exceeds(STRAY, triangles.curves.deviations(chords, triangles.arcs))


def _split_faces(vertices: FloatArray, faces: IntArray, middles: IntArray) -> IntArray:
    """Triangles cut at the vertices (T, 3) in the middle of their sides; -1 for none."""
    is_cut = middles >= 0
    count = is_cut.sum(axis=1)
    # Turned so that cut sides come first.
    first: IntArray = np.argmax(is_cut, axis=1)
    uncut: IntArray = np.argmin(is_cut, axis=1)
    order: IntArray = (np.where(count == 2, uncut + 1, first)[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(faces, order, axis=1).T
    m, n, p = np.take_along_axis(middles, order, axis=1).T
    one, two, three = (count == k for k in (1, 2, 3))
    diagonals = norm(vertices[a] - vertices[n]), norm(vertices[m] - vertices[c])
    from_a = two & ~exceeds(*diagonals)
    from_m = two & ~from_a
    pieces = [
        (count == 0, (a, b, c)),
        (one, (a, m, c)), (one, (m, b, c)),
        (two, (m, b, n)),
        (from_a, (a, m, n)), (from_a, (a, n, c)),
        (from_m, (a, m, c)), (from_m, (m, n, c)),
        (three, (a, m, p)), (three, (m, b, n)), (three, (p, n, c)), (three, (m, n, p)),
    ]  # fmt: skip
    return np.concatenate([np.stack(corners, 1)[chosen] for chosen, corners in pieces])


def collapse_short_edges(triangles: Triangles, max_batches: int = 12) -> Triangles:
    """Merge the ends of edges of less than 4/5 where nothing grows beyond 4/3, folds or strays.

    Parameters
    ----------
    max_batches : int
        Most batches to make.

    Returns
    -------
    Triangles
        Triangles of the same topology.
    """
    refused = np.zeros(0, np.int64)
    for _ in range(max_batches):
        edges = find_edges(triangles)
        lengths = edge_lengths(triangles, edges)
        candidates = np.flatnonzero(exceeds(TOO_SHORT, lengths) & ~np.isin(edges.keys, refused))
        candidates = candidates[_may_merge(triangles, edges, candidates)]
        chosen = candidates[_independent(edges, candidates, lengths[candidates], reach=2)]
        if not len(chosen):
            break
        ends, arcs = edges.ends[chosen], _merged_arcs(triangles, edges, chosen)
        places = _merged_places(triangles, edges, chosen, arcs)
        is_good = _keeps_shape(triangles, ends, places)
        is_good &= _keeps_lines(_merge(triangles, ends, places, arcs), ends)
        refused = np.concatenate([refused, edges.keys[chosen[~is_good]]])
        triangles = _merge(triangles, ends[is_good], places[is_good], arcs[is_good])
    return triangles


def _may_merge(triangles: Triangles, edges: Edges, chosen: IntArray) -> BoolArray:
    """Edges whose ends may become one without a change of the topology."""
    a, b = edges.ends[chosen].T
    on_line = edges.is_line_vertex
    joins_lines = on_line[a] & on_line[b] & ~edges.is_line[chosen]
    # The other two sides of a triangle become one edge.
    halves = edges.halves[chosen]
    sides = [edges.corner_edges[halves // 3, (halves + turn) % 3] for turn in (1, 2)]
    joins_lines |= ((halves >= 0) & edges.is_line[sides[0]] & edges.is_line[sides[1]]).any(1)
    both_fixed = triangles.is_fixed[a] & triangles.is_fixed[b]
    from scipy.sparse import csr_array

    count = len(triangles.vertices)
    pairs = np.concatenate([edges.ends, edges.ends[:, ::-1]]).T
    ones = np.ones(len(pairs[0]), np.int64)
    adjacency: Any = csr_array((ones, (pairs[0], pairs[1])), shape=(count, count))
    common: Any = adjacency[a] * adjacency[b]
    shared = np.asarray(common.sum(axis=1)).ravel()
    # A vertex opposite the edge loses a neighbour.
    corners = np.roll(triangles.faces, 1, axis=1).ravel()
    opposite = np.where(halves >= 0, corners[halves], corners[halves[:, :1]])
    valence = np.bincount(edges.ends.ravel(), minlength=count)
    is_thin = valence[opposite] <= np.where(edges.is_rim_vertex[opposite], 2, 3)
    fits = shared == np.where(edges.is_rim[chosen], 1, 2)
    return fits & ~joins_lines & ~both_fixed & ~is_thin.any(axis=1)


def _merged_arcs(triangles: Triangles, edges: Edges, chosen: IntArray) -> FloatArray:
    """Where on its curve an edge of a line becomes a vertex; nan for other edges."""
    arcs = np.full(len(edges.keys), np.nan)
    is_fixed = triangles.is_fixed[triangles.lines]
    weights = np.where(is_fixed.any(axis=1, keepdims=True), is_fixed, 0.5)
    arcs[edges.line_edges] = dot(weights, triangles.arcs)
    return arcs[chosen]


def _merged_places(
    triangles: Triangles, edges: Edges, chosen: IntArray, arcs: FloatArray
) -> FloatArray:
    """Where the two ends of edges meet: at the one that must not move, or half way."""
    a, b = edges.ends[chosen].T
    rank = edges.is_line_vertex.astype(np.int64) + 2 * triangles.is_fixed
    share = np.select([rank[a] > rank[b], rank[a] < rank[b]], [0.0, 1.0], 0.5)[:, None]
    first, second = triangles.vertices[a], triangles.vertices[b]
    places = first + share * (second - first)
    slides = edges.is_line[chosen] & (rank[a] == rank[b])
    places[slides] = triangles.curves.at(arcs[slides])
    return places


def _keeps_shape(triangles: Triangles, ends: IntArray, places: FloatArray) -> BoolArray:
    """Merges (n,) that neither fold a triangle nor make a side too long."""
    owner = np.full(len(triangles.vertices), -1, np.int64)
    owner[ends] = np.arange(len(ends))[:, None]
    # The merges are independent: no triangle belongs to two of them.
    owners = owner[triangles.faces]
    is_moved = owners >= 0
    changed = is_moved.sum(axis=1) == 1
    merges = owners[changed].max(axis=1)
    corners = triangles.vertices[triangles.faces[changed]]
    before = unit(triangle_normals(corners))
    thickness_before = thickness(corners)
    moved = np.where(is_moved[changed][..., None], places[merges][:, None], corners)
    after = unit(triangle_normals(moved))
    sides = norm(np.roll(moved, -1, axis=1) - moved)
    sides_before = norm(np.roll(corners, -1, axis=1) - corners)
    grown = exceeds(sides, TOO_LONG) & exceeds(sides, sides_before)
    is_thin = exceeds(np.minimum(thickness_before, SLIVER), thickness(moved))
    # The normal of a sliver turns easily.
    least = np.where(thickness_before < SLIVER, 0.0, LEAST_COSINE)
    folds = dot(before, after) <= least
    good = np.ones(len(ends), bool)
    good[merges[grown.any(axis=1) | folds | is_thin]] = False
    return good


def _keeps_lines(merged: Triangles, ends: IntArray) -> BoolArray:
    """Merges (n,) after which no line strays; `merged` is what all of them lead to."""
    is_bad = np.zeros(len(merged.vertices), bool)
    # The merges are independent: no edge belongs to two of them.
    is_bad[merged.lines[strays(merged)]] = True
    return ~is_bad[ends[:, 0]]


def _merge(
    triangles: Triangles, ends: IntArray, places: FloatArray, arcs: FloatArray
) -> Triangles:
    vertices, fixed = triangles.vertices.copy(), triangles.is_fixed.copy()
    target = np.arange(len(vertices))
    target[ends[:, 1]] = ends[:, 0]
    vertices[ends[:, 0]] = places
    fixed[ends[:, 0]] |= fixed[ends[:, 1]]
    faces = target[triangles.faces]
    is_kept = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    places_on_line = np.full(len(vertices), np.nan)
    places_on_line[ends] = np.where(triangles.is_fixed[ends], np.nan, arcs[:, None])
    moved = places_on_line[triangles.lines]
    line_arcs = np.where(np.isnan(moved), triangles.arcs, moved)
    lines = target[triangles.lines]
    stays = lines[:, 0] != lines[:, 1]
    return replace(
        triangles,
        vertices=vertices,
        faces=faces[is_kept],
        is_fixed=fixed,
        lines=lines[stays],
        arcs=line_arcs[stays],
    )


def flip_edges(triangles: Triangles, max_batches: int = 12) -> Triangles:
    """Flip edges to widen slivers, and to bring valences to 6, on the boundary to 4.

    Parameters
    ----------
    max_batches : int
        Most batches to make.

    Returns
    -------
    Triangles
        Triangles on the same vertices.
    """
    for _ in range(max_batches):
        edges = find_edges(triangles)
        corners = np.roll(triangles.faces, 1, axis=1).ravel()
        inner = np.flatnonzero(~edges.is_line)
        quads = np.concatenate([edges.ends[inner], corners[edges.halves[inner]]], 1)
        gains = _flip_gains(triangles, edges, quads)
        wanted = np.flatnonzero(gains > 0)
        wanted = wanted[_may_flip(triangles, edges, quads[wanted])]
        ranks = _ranks(-gains[wanted])
        least = np.full(len(triangles.vertices), len(ranks), np.int64)
        np.minimum.at(least, quads[wanted], ranks[:, None])
        chosen = wanted[(least[quads[wanted]] == ranks[:, None]).all(axis=1)]
        if not len(chosen):
            break
        faces = triangles.faces.copy()
        first, second = (edges.halves[inner[chosen]] // 3).T
        a, b, c, d = quads[chosen].T
        faces[first] = np.stack([a, d, c], 1)
        faces[second] = np.stack([d, b, c], 1)
        triangles = replace(triangles, faces=faces)
    return triangles


BEFORE_FLIP, AFTER_FLIP = ([0, 1, 2], [1, 0, 3]), ([0, 3, 2], [3, 1, 2])


def _flip_gains(triangles: Triangles, edges: Edges, quads: IntArray) -> IntArray:
    """What turning the diagonal a, b of quads (n, 4) to c, d does for the valences; slivers."""
    optimum = np.where(edges.is_rim_vertex, 4, 6)
    excess = np.bincount(edges.ends.ravel(), minlength=len(optimum)) - optimum
    a, b, c, d = excess[quads].T
    # Change of the sum of squares: a and b lose a neighbour, c and d gain one.
    gains = 2 * (a + b - c - d) - 4
    points = triangles.vertices[quads]
    least = np.minimum(*(thickness(points[:, corners]) for corners in BEFORE_FLIP))
    return np.where(least < SLIVER, SLIVER_GAIN, gains)


def _may_flip(triangles: Triangles, edges: Edges, quads: IntArray) -> BoolArray:
    """Quads a, b, c, d whose diagonal may go from a, b to c, d: new, no fold, no sliver."""
    points = triangles.vertices[quads]
    first, second = (triangle_normals(points[:, corners]) for corners in BEFORE_FLIP)
    before = unit(first + second)
    least = np.minimum(*(thickness(points[:, corners]) for corners in BEFORE_FLIP))
    new_keys = pair_keys(quads[:, 2:], len(triangles.vertices))
    is_good = ~np.isin(new_keys, edges.keys)
    for corners in AFTER_FLIP:
        is_good &= exceeds(thickness(points[:, corners]), np.minimum(least, SLIVER))
        after = unit(triangle_normals(points[:, corners]))
        is_good &= dot(before, after) > LEAST_COSINE
    return is_good


def _independent(edges: Edges, chosen: IntArray, values: FloatArray, reach: int) -> BoolArray:
    """Edges, least values first, of which no two have ends at most `reach` edges apart."""
    # What is equal but for rounding comes in scattered order: in that of the indices, each edge
    # of a grid would wait for the one before.
    scattered = np.arange(len(chosen)) * SCATTER % SCATTER_RANGE
    ranks = np.empty(len(chosen), np.int64)
    ranks[np.lexsort((scattered, np.round(values / SAME_LENGTH)))] = np.arange(len(chosen))
    ends, is_open, result = edges.ends[chosen], np.ones(len(chosen), bool), ranks < 0
    for _ in range(INDEPENDENT_ROUNDS):
        least = np.full(len(edges.is_rim_vertex), len(chosen), np.int64)
        np.minimum.at(least, ends[is_open], ranks[is_open, None])
        first = is_open & (_spread(edges, least, reach)[ends] == ranks[:, None]).all(axis=1)
        if not first.any():
            break
        result |= first
        distance = np.ones(len(least), np.int64)
        distance[ends[first]] = 0
        is_open &= (_spread(edges, distance, reach)[ends] > 0).all(axis=1)
    return result


def _spread(edges: Edges, least: IntArray, reach: int) -> IntArray:
    """Least of the values (V,) up to so many edges away."""
    for _ in range(reach):
        spread = least.copy()
        np.minimum.at(spread, edges.ends[:, 0], least[edges.ends[:, 1]])
        np.minimum.at(spread, edges.ends[:, 1], least[edges.ends[:, 0]])
        least = spread
    return least


def _ranks(values: FloatArray | IntArray) -> IntArray:
    """Place of each value in rising order."""
    result = np.empty(len(values), np.int64)
    result[np.argsort(values, kind="stable")] = np.arange(len(values))
    return result
