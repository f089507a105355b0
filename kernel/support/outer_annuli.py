"""Planes and outer circles of annuli, before their inner side is found."""

from typing import NamedTuple

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm, unit
from ..meshes.mesh import Mesh, face_centroids, face_normals, local_corners
from ..panels.cutting import cutting_planes
from ..panels.edge_axes import EdgeMode, outward_axes
from ..parts.records import part_ids
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..spheres.incidence import meet_lines
from ..spheres.minkowski import minkowski
from ..spheres.rows import recenter
from ..tolerances import DEGENERATE
from .annuli import Annuli
from .beam_axes import beam_edges
from .node_axes import SupportStructure, arc_planes


def annuli_on_arcs(
    sphere_mesh: SphereMesh, structure: SupportStructure
) -> tuple[Annuli, BoolArray]:
    """Annuli where spheres meet, with outer circles and end lines; where circles are real."""
    sides = _edge_sides(sphere_mesh)
    axes = structure.directions[sides.vertices]
    planes = unit(np.cross(sides.chords, sides.upright))
    shifts = np.zeros(len(planes))
    free = np.cross(axes.sum(axis=1), sides.chords)
    circles = arc_planes(sphere_mesh)
    planes = np.where(norm(free)[:, None] > 0, unit(free), planes)
    use = np.flatnonzero(sides.is_interior)[circles.exists]
    planes[use] = circles.normals[circles.exists]
    shifts[use] = circles.offsets[circles.exists]
    planes, shifts = _facing_right(sides, planes, shifts)
    feet = shifts[:, None] * planes
    left, right = recenter(sides.left, feet), recenter(sides.right, feet)
    # Of the two spheres, that which stands more upright on the plane tells the circle better.
    slopes = [np.abs(dot(rows[:, 1:4], planes)) for rows in (left, right)]
    outer, is_real = _great_spheres(
        np.where((slopes[1] < slopes[0])[:, None], right, left), planes
    )
    return _annuli_on(sides, planes, feet, outer, axes, is_real)


def annuli_on_walls(
    sphere_mesh: SphereMesh, edges: EdgeMode, axes: FloatArray
) -> tuple[Annuli, BoolArray]:
    """Annuli in the planes in which panels are cut; where circles are real.

    Edges are "bisector" or "axis" as in `cutting_planes`, the axes (V, 2, 3) two points of each
    node axis, in any order.

    Notes
    -----
    The two panels of an edge meet its plane in two circles, which differ by the gap. The outer
    circle is their mean: that of the pencil whose curvature is the mean of theirs. Each panel
    is half of the gap off.
    """
    sides = _edge_sides(sphere_mesh)
    normals, offsets = cutting_planes(sphere_mesh, edges, axes)
    planes = normals[sides.first]
    middles = _chord_middles(sphere_mesh.mesh)[sides.first]
    planes, shifts = _facing_right(sides, planes, offsets[sides.first] - dot(planes, middles))
    feet = shifts[:, None] * planes
    left, is_left = _great_spheres(recenter(sides.left, feet), planes)
    right, is_right = _great_spheres(recenter(sides.right, feet), planes)
    mean = left + right
    square = minkowski(mean, mean)
    is_real = is_left & is_right & (square > DEGENERATE) & planes.any(axis=1)
    outer = mean / np.sqrt(np.where(is_real, square, 1.0))[:, None]
    directions = -outward_axes(sphere_mesh.mesh, axes)[sides.vertices]
    return _annuli_on(sides, planes, feet, outer, directions, is_real)


class _EdgeSides(NamedTuple):
    """All edges, the boundary included, seen from the middles of their chords.

    Attributes
    ----------
    first : (B,) int array
        First half-edges.
    is_interior : (B,) bool array
        Whether there is a face on the right.
    vertices, faces : (B, 2) int array
        Ends; faces left and right, -1 beyond the boundary.
    panel_ids : tuple
        Names of the panels of these faces.
    chords : (B, 3) float array
        From end to end.
    left, right : (B, 5) float array
        Spheres beside the edges; beyond the boundary that on the left again.
    upright : (B, 3) float array
        Sum of the two sphere normals.
    across : (B, 3) float array
        A direction that the bisecting plane contains.
    middles : (B, 3) float array
        Middles of the chords, in model coordinates.
    """

    first: IntArray
    is_interior: BoolArray
    vertices: IntArray
    faces: IntArray
    panel_ids: tuple[tuple[str | None, str | None], ...]
    chords: FloatArray
    left: FloatArray
    right: FloatArray
    upright: FloatArray
    across: FloatArray
    middles: FloatArray


def _edge_sides(sphere_mesh: SphereMesh) -> _EdgeSides:
    mesh, topology = sphere_mesh.mesh, sphere_mesh.mesh.topology
    twins = topology.twins
    first = np.flatnonzero((twins > np.arange(len(twins))) | (twins < 0))
    twins = twins[first]
    is_interior = twins >= 0
    starts = local_corners(mesh)
    middles = _chord_middles(mesh)
    faces = np.stack([topology.corner_faces[first], topology.corner_faces[twins]], 1)
    left = recenter(sphere_mesh.local_spheres[faces[:, 0]], middles[first])
    right = recenter(sphere_mesh.local_spheres[faces[:, 1]], middles[twins])
    right[~is_interior] = left[~is_interior]
    across = face_normals(mesh)[faces[:, 0]] + face_normals(mesh)[faces[:, 1]]
    edge_faces = np.where(is_interior[:, None], faces, faces * [1, 0] - [0, 1])
    return _EdgeSides(
        first, is_interior, beam_edges(mesh), edge_faces,
        _panel_ids_beside(edge_faces, mesh.n_faces),
        (starts[topology.next_corners] - starts)[first], left, right,
        left[:, 1:4] + right[:, 1:4], np.where(is_interior[:, None], across, left[:, 1:4]),
        face_centroids(mesh)[faces[:, 0]] + middles[first],
    )  # fmt: skip


def _chord_middles(mesh: Mesh) -> FloatArray:
    starts = local_corners(mesh)
    return (starts + starts[mesh.topology.next_corners]) / 2


def _facing_right(
    sides: _EdgeSides, planes: FloatArray, shifts: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Planes whose normals point to the faces on the right."""
    x = sides.chords - dot(sides.chords, planes)[:, None] * planes
    turn = np.where(dot(np.cross(planes, x), sides.upright) < 0, -1.0, 1.0)
    return planes * turn[:, None], shifts * turn


def _annuli_on(
    sides: _EdgeSides,
    planes: FloatArray,
    feet: FloatArray,
    outer: FloatArray,
    axes: FloatArray,
    is_real: BoolArray,
) -> tuple[Annuli, BoolArray]:
    """Annuli without inner arcs, from planes through `feet` and circles seen from there."""
    x = unit(sides.chords - dot(sides.chords, planes)[:, None] * planes)
    directions = unit(axes - dot(axes, planes[:, None])[..., None] * planes[:, None])
    ends = np.stack([-sides.chords / 2, sides.chords / 2], 1)
    ends = ends - dot(ends, planes[:, None])[..., None] * planes[:, None]
    steps, meets = meet_lines(
        np.repeat(outer, 2, axis=0), ends.reshape(-1, 3), directions.reshape(-1, 3)
    )
    tops = ends + steps.reshape(-1, 2)[..., None] * directions
    count = len(planes)
    annuli = Annuli(
        part_ids("B", count), np.arange(count), sides.vertices, sides.faces, sides.panel_ids,
        sides.middles + feet, np.stack([x, np.cross(planes, x), planes], 1), outer, outer,
        np.stack([tops, tops], 2), directions, axes,
        _angle_of_planes(planes, np.cross(sides.chords, sides.across)), 0.0, 0.0,
    )  # fmt: skip
    return annuli, is_real & meets.reshape(-1, 2).all(axis=1)


def _panel_ids_beside(
    edge_faces: IntArray, n_faces: int
) -> tuple[tuple[str | None, str | None], ...]:
    """Names of the panels beside edges."""
    names = (*part_ids("P", n_faces), None)  # -1, beyond the boundary, is the last
    sides: list[list[int]] = edge_faces.tolist()
    return tuple((names[left], names[right]) for left, right in sides)


def _great_spheres(rows: FloatArray, plane_normals: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Unit rows orthogonal to planes through the origin, through the circles of rows there."""
    great = rows.copy()
    great[:, 1:4] -= dot(rows[:, 1:4], plane_normals)[:, None] * plane_normals
    square = minkowski(great, great)
    is_real = square > DEGENERATE
    return great / np.sqrt(np.where(is_real, square, 1.0))[:, None], is_real


def _angle_of_planes(first: FloatArray, second: FloatArray) -> FloatArray:
    a, b = unit(first), unit(second)
    angles = 2 * np.arctan2(norm(a - b), norm(a + b))
    return np.minimum(angles, np.pi - angles)
