"""Vertices of their own for faces that meet without sharing an edge, or too many at one."""

from dataclasses import replace

import numpy as np

from ..arrays import BoolArray, IntArray
from ..meshes.orientation import faces_to_flip
from ..solvers.weighted_graphs import piece_labels
from .raw_mesh import RawMesh
from .sides import find_sides, paired_sides


def separate_and_unify(raw: RawMesh) -> tuple[RawMesh, BoolArray]:
    """Make an orientable manifold with boundary.

    Parameters
    ----------
    raw : RawMesh
        Faces without repeated corners, none of which repeats another.

    Returns
    -------
    raw : RawMesh
        The faces in the same order, some turned over; vertices around which they make several
        fans, or at an edge with more than two faces, are repeated at the end of the vertices.
    is_flipped : (F,) bool array
        Faces that were turned over: of every piece the fewer.
    """
    sides = find_sides(raw)
    pairs = paired_sides(raw, sides)
    owners, heads = raw.corner_faces, raw.next_corners
    is_aligned = raw.corners[pairs[:, 0]] == raw.corners[pairs[:, 1]]
    is_flipped, is_met = faces_to_flip(raw.n_faces, owners[pairs], is_aligned)
    pairs, is_aligned = pairs[is_met], is_aligned[is_met]
    separated = _separated(raw, pairs, is_aligned)
    for _ in range(raw.n_faces):
        loose = _crowding_sides(separated, pairs)
        if not len(loose):
            break
        # A slit whose ends are both shared: its loose bank gets ends of its own.
        ends = np.concatenate([loose, heads[loose]])
        is_cut = np.isin(
            owners * len(separated.vertices) + separated.corners,
            owners[ends] * len(separated.vertices) + separated.corners[ends],
        )
        touched = is_cut[pairs] | is_cut[heads[pairs]]
        kept = ~touched.any(axis=1)
        pairs, is_aligned = pairs[kept], is_aligned[kept]
        separated = _separated(raw, pairs, is_aligned)
    return _in_order(_turned_over(separated, is_flipped), len(raw.vertices)), is_flipped


def _separated(raw: RawMesh, pairs: IntArray, is_aligned: BoolArray) -> RawMesh:
    """The faces with one vertex for each fan of corners that pairs of sides hold together."""
    heads = raw.next_corners
    left, right = pairs.T
    far = np.where(is_aligned, right, heads[right])
    near = np.where(is_aligned, heads[right], right)
    rows, columns = np.concatenate([left, heads[left]]), np.concatenate([far, near])
    labels = piece_labels(rows, columns, len(raw.corners))
    _, firsts, fans = np.unique(labels, return_index=True, return_inverse=True)
    owners = raw.corners[firsts]
    # The fan of the first corner keeps the vertex, the others follow in the order of corners.
    order = np.lexsort((firsts, owners))
    is_first = np.ones(len(order), bool)
    is_first[1:] = np.diff(owners[order]) != 0
    extra = np.sort(firsts[order[~is_first]])
    numbers = owners.copy()
    rank = len(raw.vertices) + np.searchsorted(extra, firsts)
    is_extra = np.zeros(len(firsts), bool)
    is_extra[order[~is_first]] = True
    numbers[is_extra] = rank[is_extra]
    return replace(
        raw,
        vertices=np.concatenate([raw.vertices, raw.vertices[raw.corners[extra]]]),
        corners=numbers[fans.reshape(-1)],
    )


def _crowding_sides(raw: RawMesh, pairs: IntArray) -> IntArray:
    """Sides on edges where another pair meets, or where two meet that are no pair."""
    sides = find_sides(raw)
    partners = np.arange(len(raw.corners))
    partners[pairs[:, 0]], partners[pairs[:, 1]] = pairs[:, 1], pairs[:, 0]
    # Of each edge the first pair stays, or the first side if none is a pair.
    group = np.minimum(partners, np.arange(len(partners)))
    rank = np.where(partners == np.arange(len(partners)), len(partners), 0) + group
    least = np.full(len(sides.counts), 2 * len(partners))
    np.minimum.at(least, sides.edges, rank)
    return np.flatnonzero(rank > least[sides.edges])


def _turned_over(raw: RawMesh, is_flipped: BoolArray) -> RawMesh:
    """The faces with some of them run the other way round, each from the same first corner."""
    faces = raw.corner_faces
    firsts, steps = raw.offsets[:-1][faces], np.arange(len(faces))
    backwards = firsts + (firsts - steps) % raw.degrees[faces]
    order = np.where(is_flipped[faces], backwards, steps)
    return replace(raw, corners=raw.corners[order], corner_ids=raw.corner_ids[order])


def _in_order(raw: RawMesh, first: int) -> RawMesh:
    """The same with the vertices from a number on in the order of the corners."""
    added, places = np.unique(raw.corners, return_index=True)
    is_added = added >= first
    old = added[is_added][np.argsort(places[is_added])]
    new = np.arange(len(raw.vertices))
    new[old] = first + np.arange(len(old))
    vertices = np.concatenate([raw.vertices[:first], raw.vertices[old]])
    return replace(raw, vertices=vertices, corners=new[raw.corners])
