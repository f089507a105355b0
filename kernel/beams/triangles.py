"""Triangles of beams and cylinders for viewers: exact points and normals, flat between."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray, norm, unit
from ..panels.tessellation import MAX_STEPS
from ..spheres.arcs import Arcs, arc_points
from ..spheres.incidence import normals
from .beams import Beams, section_arcs


@dataclass(frozen=True)
class BeamTriangles:
    """Triangulated beams (or cylinders) that are cut into the same number of steps, n of them.

    Attributes
    ----------
    beams : (n,) int array
        Which of the beams.
    points : (n, V, 3) float array
        Points, in model coordinates.
    normals : (n, V, 3) float array
        Unit normals there, pointing out of the beam.
    triangles : (T, 3) int array
        Points of each triangle of one beam, counter-clockwise about the normals.
    """

    beams: IntArray
    points: FloatArray
    normals: FloatArray
    triangles: IntArray


def beam_triangles(beams: Beams, tolerance: float) -> Iterator[BeamTriangles]:
    """Triangulate beams as they are before their ends are mitred.

    Parameters
    ----------
    beams : Beams
        B beams: their sections in the middle of the thickness, as thick as the beams.
    tolerance : float
        Largest distance of the chords from the arcs, relative to half the length of a beam;
        reached by at most `MAX_STEPS` steps.

    Yields
    ------
    BeamTriangles
        Every beam once.
    """
    arcs = section_arcs(beams)
    sagittas = np.max([np.abs(each.sagittas) for each in arcs], axis=0, initial=0.0)
    halves = np.max([norm(each.ends - each.starts) for each in arcs], axis=0, initial=0.0) / 2
    needed = np.ceil(np.sqrt(sagittas / (tolerance * halves)))
    steps = np.clip(needed, 1, MAX_STEPS).astype(np.int64)
    for count in np.unique(steps).tolist():
        members = np.flatnonzero(steps == count)
        yield _triangulate(beams, arcs, members, count)


def _triangulate(
    beams: Beams, arcs: tuple[Arcs, Arcs], members: IntArray, steps: int
) -> BeamTriangles:
    """Strips: upper and lower side, outer and inner face, first and second end."""
    annuli = beams.annuli
    across = annuli.frames[members, None, 2]
    outer, inner = (_points(each, members, steps) for each in arcs)
    outwards = normals(annuli.outer[members][:, None], outer)
    inwards = -normals(annuli.inner[members][:, None], inner)
    half = across * beams.thickness / 2
    beyond: FloatArray = np.cross(outer[:, [0, -1]] - inner[:, [0, -1]], across)
    first, second = np.split(unit(beyond), 2, axis=1)
    before, after = (np.stack([outer[:, end], inner[:, end]], 1) for end in (0, -1))
    strips = [
        (inner + half, outer + half, across),
        (outer - half, inner - half, -across),
        (outer + half, outer - half, outwards),
        (inner - half, inner + half, inwards),
        (before - half, before + half, -first),
        (after + half, after - half, second),
    ]
    points = np.concatenate([np.concatenate(strip[:2], 1) for strip in strips], 1)
    vectors = [
        np.concatenate([np.broadcast_to(normal, low.shape)] * 2, 1) for low, _, normal in strips
    ]
    counts = [low.shape[1] for low, _, _ in strips]
    starts = 2 * np.cumsum([0, *counts])
    triangles = [
        start + _strip(count) for start, count in zip(starts.tolist(), counts, strict=False)
    ]
    return BeamTriangles(
        members,
        points + annuli.origins[members][:, None],
        np.concatenate(vectors, 1),
        np.concatenate(triangles),
    )


def _points(arcs: Arcs, members: IntArray, steps: int) -> FloatArray:
    chosen = Arcs(*(values[members] for values in vars(arcs).values()))
    return arc_points(chosen, np.linspace(-1, 1, steps + 1))


def _strip(count: int) -> IntArray:
    """Triangles between a lower and an upper row of points, seen from outside."""
    low: IntArray = np.arange(count - 1)
    high = low + count
    lower = np.stack([low, low + 1, high + 1], 1)
    return np.concatenate([lower, np.stack([low, high + 1, high], 1)])


def cylinder_triangles(
    origins: FloatArray,
    directions: FloatArray,
    heights: FloatArray,
    radius: float,
    tolerance: float,
) -> BeamTriangles:
    """Triangulate upright cylinders with both ends.

    Parameters
    ----------
    origins : (n, 3) float array
        Centres of their lower ends, in model coordinates.
    directions : (n, 3) float array
        Unit vectors along their axes, from the lower to the upper end.
    heights : (n,) float array
        Their heights.
    tolerance : float
        Largest distance of the chords from the circles, relative to the radius.

    Returns
    -------
    BeamTriangles
        All cylinders, each of as many sides as the tolerance needs.
    """
    n_sides = int(np.ceil(np.pi / np.arccos(1 - min(tolerance, 0.5))))
    angles: FloatArray = 2 * np.pi * np.arange(n_sides) / n_sides
    # Any direction across the axis will do: the most distant coordinate axis gives one.
    other = np.eye(3)[np.argmin(np.abs(directions), axis=1)]
    x = unit(np.cross(other, directions))[:, None]
    y = np.cross(directions[:, None], x)
    around = np.cos(angles)[:, None] * x + np.sin(angles)[:, None] * y
    rise = (heights[:, None] * directions)[:, None]
    lower = origins[:, None] + radius * around
    upper = lower + rise
    up = np.broadcast_to(directions[:, None], around.shape)
    ids: IntArray = np.arange(n_sides)
    after = np.roll(ids, -1)
    fan = np.stack([0 * ids[1:-1], ids[1:-1], ids[2:]], 1)
    triangles = [
        np.stack([ids, after, after + n_sides], 1),
        np.stack([ids, after + n_sides, ids + n_sides], 1),
        2 * n_sides + fan[:, ::-1],
        3 * n_sides + fan,
    ]
    return BeamTriangles(
        np.arange(len(origins)),
        np.concatenate([lower, upper, lower, upper], 1),
        np.concatenate([around, around, -up, up], 1),
        np.concatenate(triangles),
    )
