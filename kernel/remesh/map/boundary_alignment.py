"""Sides of the boundary that run along a direction of the field become lines of the map."""

from dataclasses import dataclass

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray, dot, norm
from ...meshes.vertex_fans import VertexFans
from ..field.congruence_mesh import CongruenceMesh
from ..field.frames import CombedFrames
from .seams import Seams

CORNER = np.radians(40)
"""A boundary that turns by more has a corner."""

ALIGNED = np.radians(20)
"""A side that leaves a direction nowhere by more runs along it."""

LEAST_SIDE = 1.5
"""Shorter sides, in steps of the map, are left as they are."""


@dataclass(frozen=True)
class Alignment:
    """Boundary vertices at which a coordinate is a whole number and a half.

    Attributes
    ----------
    vertices : (k,) int array
        The vertices.
    expressions : (k, m + n) float array
        Their coordinates by the integers of the seams and one more for each side.
    constants : (k,) float array
        What is added, a half up to signs.
    relations : (r, m + n) float array
        Combinations of the integers that are given: along closed sides a coordinate returns.
    relation_constants : (r,) float array
        The values given.
    n_sides : int
        Number n of aligned sides.
    """

    vertices: IntArray
    expressions: FloatArray
    constants: FloatArray
    relations: FloatArray
    relation_constants: FloatArray
    n_sides: int


def next_on_boundary(surface: CongruenceMesh, fans: VertexFans) -> IntArray:
    """The following half-edge along the boundary, (H,); -1 for those not on it."""
    topology = surface.topology
    heads = surface.triangles.ravel()[topology.next_corners]
    return np.where(topology.twins < 0, fans.corners[fans.offsets[heads]], -1)


def boundary_corners(surface: CongruenceMesh, following: IntArray) -> BoolArray:
    """Vertices (V,) where two boundary edges meet at more than 40 degrees."""
    tails, heads = surface.triangles.ravel(), np.roll(surface.triangles, -1, axis=1).ravel()
    sides = surface.points[heads] - surface.points[tails]
    rim = np.flatnonzero(following >= 0)
    ahead = sides[following[rim]]
    turns = np.arctan2(norm(np.cross(sides[rim], ahead)), dot(sides[rim], ahead))
    result = np.zeros(len(surface.points), bool)
    result[heads[rim[turns > CORNER]]] = True
    return result


def align_boundary(
    surface: CongruenceMesh,
    fans: VertexFans,
    frames: CombedFrames,
    seams: Seams,
    edge_length: float,
) -> tuple[Alignment, Alignment]:
    """Find the sides that run along a direction, and what that says about the coordinates.

    Two alignments, along the second and the first direction: where u and where v is constant.
    The length of a unit step is in mean edges.
    """
    following = next_on_boundary(surface, fans)
    sides = _sides(surface, following)
    tails, heads = surface.triangles.ravel(), np.roll(surface.triangles, -1, axis=1).ravel()
    vectors = surface.points[heads] - surface.points[tails]
    long = [side for side in sides if norm(vectors[side]).sum() > LEAST_SIDE * edge_length]
    frame = surface.face_frames[surface.topology.corner_faces]
    angles = np.arctan2(dot(vectors, frame[:, 1]), dot(vectors, frame[:, 0]))
    result: list[Alignment] = []
    for directions in (frames.second, frames.first):
        misses = np.abs(np.sin(angles - directions[surface.topology.corner_faces]))
        chosen = [side for side in long if misses[side].max() < np.sin(ALIGNED)]
        result.append(_express(surface, seams, chosen, following))
    return result[0], result[1]


def no_alignment(n_integers: int) -> Alignment:
    """No side is aligned, with m integers of the seams."""
    rows, empty = np.zeros((0, n_integers)), np.zeros(0)
    return Alignment(np.zeros(0, np.int64), rows, empty, rows, empty, 0)


def _sides(surface: CongruenceMesh, following: IntArray) -> list[IntArray]:
    """Half-edges of each stretch of the boundary from corner to corner, or of a whole loop."""
    is_corner = boundary_corners(surface, following)[surface.triangles.ravel()]
    rim = np.flatnonzero(following >= 0)
    is_left = following >= 0
    sides: list[IntArray] = []
    # Stretches that begin at corners come first; what is left are loops without corners.
    for start in np.concatenate([rim[is_corner[rim]], rim[~is_corner[rim]]]).tolist():
        side: list[int] = []
        current = start
        while is_left[current] and not (side and is_corner[current]):
            side.append(current)
            is_left[current] = False
            current = int(following[current])
        if side:
            sides.append(np.array(side))
    return sides


def _express(
    surface: CongruenceMesh, seams: Seams, sides: list[IntArray], following: IntArray
) -> Alignment:
    """Carry the coordinate of each side along it, from the chart of one face to the next."""
    n_integers = seams.shifts.shape[1]
    width = n_integers + len(sides) + 1
    tails = surface.triangles.ravel()
    known: dict[int, FloatArray] = {}
    relations: list[FloatArray] = []

    def _assign(vertex: int, row: FloatArray) -> None:
        if vertex in known:
            relations.append(row - known[vertex])
        else:
            known[vertex] = row

    for index, side in enumerate(sides):
        row = np.zeros(width)
        row[n_integers + index], row[-1] = 1.0, 0.5
        _assign(int(tails[side[0]]), row)
        for half_edge in side.tolist():
            corner = int(surface.topology.next_corners[half_edge])
            row = row.copy()
            row[:n_integers] -= seams.shifts[[corner]].toarray()[0]
            row = row * seams.signs[corner]
            _assign(int(tails[following[half_edge]]), row)
    rows = np.array(list(known.values())).reshape(-1, width)
    ties = np.array(relations).reshape(-1, width)
    ties = ties[(ties != 0).any(axis=1)]
    vertices = np.array(list(known), np.int64)
    return Alignment(
        vertices, rows[:, :-1], rows[:, -1], ties[:, :-1], -ties[:, -1], len(sides)
    )
