"""Beams as solids of OpenCASCADE: planes, cylinders, lines, circles and ellipses, all exact.

A beam has two plane sides, an outer and an inner face - cylinders, or planes where the arcs
are straight - and one or two plane faces at each end. A plane cuts a cylinder in an ellipse, or
in lines if it is parallel to the axis. As for panels, vertices and edges are shared and nothing
is intersected or sewn; every solid is built about its own origin and placed by a translation.

The parameters of a cylinder are turned so that the beam lies about u = π, away from the seam.

This module imports OCP, which takes more than a second: others import it inside functions.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from OCP.Geom import Geom_Curve, Geom_CylindricalSurface, Geom_Ellipse, Geom_Line, Geom_Plane
from OCP.Geom2d import Geom2d_Curve, Geom2d_Line
from OCP.gp import gp_Ax2, gp_Ax3, gp_Dir, gp_Dir2d, gp_Elips, gp_Pnt, gp_Pnt2d
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape, TopoDS_Vertex

from ...kernel.arrays import FloatArray, dot, norm
from ...kernel.beams.beams import Beams, scale_beams
from ...kernel.beams.end_edges import EndEdges
from ...kernel.spheres.arcs import circle_axes
from ..breps.beam_geometry import LEVELS, BeamGeometry, beam_geometry
from . import opencascade_parts as occ

_SPAN = 0.05
"""Longest span, in radians, of a spline for an ellipse in the parameters of a cylinder."""

_Upright: TypeAlias = tuple[int, int, tuple[int, int]]
"""End, outer (0) or inner (1) face, and levels of an edge across the thickness."""


@dataclass(frozen=True)
class _Sides:
    """Arcs of one level: curves, their lengths and parameters (B, 2) on the cylinders."""

    curves: list[list[Geom_Curve]]
    lengths: list[list[float]]
    starts: FloatArray
    turns: FloatArray


@dataclass(frozen=True)
class _Solids:
    """What the solids of a batch of beams are made of, about their rounded origins."""

    numbers: BeamGeometry
    sides: dict[int, _Sides]
    parameters: dict[tuple[int, int], tuple[FloatArray, FloatArray]]
    tolerances: list[float]


@dataclass(frozen=True)
class _Block:
    """Vertices and edges of one beam by end, face and level; the levels of its two ends."""

    vertices: dict[tuple[int, int, int], TopoDS_Vertex]
    arcs: dict[tuple[int, int], TopoDS_Edge]
    lines: dict[tuple[int, int], TopoDS_Edge]
    uprights: dict[_Upright, TopoDS_Edge]
    steps: tuple[list[tuple[int, int]], list[tuple[int, int]]]


def beam_shapes(beams: Beams, scale: float = 1.0) -> list[TopoDS_Shape]:
    """A closed solid per beam, placed by a translation to the origin of its beam.

    The scale is units of the shapes per model unit; OpenCASCADE's tolerances suit millimetres.
    Edges carry curves in the parameters of cylinders, which OpenCASCADE's algorithms need.
    Raises InputError if a beam has numbers that are not finite, at which OpenCASCADE would
    crash.
    """
    if beams.n_beams == 0:
        return []
    solids = _solids(beam_geometry(scale_beams(beams, scale)))
    shapes: list[TopoDS_Shape] = []
    for beam, place in enumerate(solids.numbers.places.tolist()):
        block = _block(solids, beam)
        faces = _plane_faces(solids, beam, block)
        faces += [_long_face(solids, beam, block, k) for k in (0, 1)]
        shapes.append(occ.make_solid(faces).Located(occ.placement(place)))
    return shapes


def _solids(numbers: BeamGeometry) -> _Solids:
    with np.errstate(invalid="ignore"):
        parameters = {
            levels: _cut_parameters(
                numbers.cuts[levels], numbers.centers, numbers.radii, numbers.frames
            )
            for levels in LEVELS
        }
    sides = {level: _sides(numbers, level) for level in (0, 2)}
    return _Solids(numbers, sides, parameters, numbers.tolerances.tolist())


def _sides(numbers: BeamGeometry, level: int) -> _Sides:
    curves: list[list[Geom_Curve]] = []
    lengths: list[list[float]] = []
    starts: list[FloatArray] = []
    turns: list[FloatArray] = []
    for k, (arcs, circles) in enumerate(
        zip(numbers.arcs[level], numbers.circles[level], strict=True)
    ):
        found, spans = occ.arc_curves(arcs, circles)
        curves.append(found)
        lengths.append(spans)
        x, _ = circle_axes(arcs, circles)
        frames = numbers.frames[:, k]
        starts.append(np.pi + np.arctan2(-dot(x, frames[:, 1]), -dot(x, frames[:, 0])))
        turns.append(np.copysign(1.0, dot(circles.axes, frames[:, 2])))
    return _Sides(curves, lengths, np.stack(starts, 1), np.stack(turns, 1))


def _cut_parameters(
    cuts: EndEdges, centers: FloatArray, radii: FloatArray, frames: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Knots (B, 2, 2, n + 1) and poles of the ellipses in the parameters of the cylinders."""
    lengths = np.where(cuts.is_line, 0.0, cuts.lengths)
    count = max(1, int(np.ceil(np.nan_to_num(lengths).max(initial=0.0) / _SPAN)))
    angles = cuts.firsts[..., None] + lengths[..., None] * np.linspace(0, 1, count + 1)
    turn = frames[:, None]
    radius = np.broadcast_to(radii[:, None], cuts.radii.shape)
    middle, major, minor = (
        np.einsum("bekij,bekj->beki", np.broadcast_to(turn, (*vectors.shape, 3)), vectors)
        for vectors in (
            cuts.centers - centers[:, None],
            cuts.radii[..., None] * cuts.majors,
            radius[..., None] * np.cross(cuts.normals, cuts.majors),
        )
    )
    cosine, sine = np.cos(angles)[..., None], np.sin(angles)[..., None]
    major, minor = major[..., None, :], minor[..., None, :]
    point = middle[..., None, :] + cosine * major + sine * minor
    speed, pull = cosine * minor - sine * major, -cosine * major - sine * minor
    square = radius[..., None] ** 2
    u = np.pi + np.arctan2(-point[..., 1], -point[..., 0])
    u1 = (point[..., 0] * speed[..., 1] - point[..., 1] * speed[..., 0]) / square
    u2 = (point[..., 0] * pull[..., 1] - point[..., 1] * pull[..., 0]) / square
    nodes = np.stack(
        [
            np.stack([u, point[..., 2]], -1),
            np.stack([u1, speed[..., 2]], -1),
            np.stack([u2, pull[..., 2]], -1),
        ]
    )
    flat = nodes.reshape(3, -1, count + 1, 2)
    poles = occ.quintic_poles(flat, lengths.reshape(-1) / count)
    return angles, poles.reshape(*lengths.shape, -1, 2)


def _block(solids: _Solids, beam: int) -> _Block:
    tolerance = solids.tolerances[beam]
    flat: list[bool] = solids.numbers.beams.is_flat[beam].tolist()
    steps = tuple([(0, 2)] if is_flat else [(0, 1), (1, 2)] for is_flat in flat)
    points = solids.numbers.corners[beam].tolist()
    levels = [sorted({level for step in ends for level in step}) for ends in steps]
    vertices = {
        (end, k, level): occ.make_vertex(points[end][k][level], tolerance)
        for end in (0, 1)
        for k in (0, 1)
        for level in levels[end]
    }
    arcs = {
        (k, level): occ.make_edge(
            solids.sides[level].curves[k][beam], vertices[0, k, level], vertices[1, k, level],
            solids.sides[level].lengths[k][beam], tolerance,
        )
        for k in (0, 1)
        for level in (0, 2)
    }  # fmt: skip
    lines = {
        (end, level): _line(
            (points[end][0][level], points[end][1][level]),
            (vertices[end, 0, level], vertices[end, 1, level]), tolerance,
        )
        for end in (0, 1)
        for level in levels[end]
    }  # fmt: skip
    uprights = {
        (end, k, step): _upright(solids, beam, (end, k, step), vertices)
        for end in (0, 1)
        for k in (0, 1)
        for step in steps[end]
    }
    return _Block(vertices, arcs, lines, uprights, (steps[0], steps[1]))


def _line(
    points: tuple[list[float], list[float]],
    ends: tuple[TopoDS_Vertex, TopoDS_Vertex],
    tolerance: float,
) -> TopoDS_Edge:
    change = [b - a for a, b in zip(*points, strict=True)]
    curve = Geom_Line(gp_Pnt(*points[0]), gp_Dir(*change))
    return occ.make_edge(curve, *ends, math.hypot(*change), tolerance)


def _upright(
    solids: _Solids,
    beam: int,
    place: _Upright,
    vertices: dict[tuple[int, int, int], TopoDS_Vertex],
) -> TopoDS_Edge:
    end, k, (low, high) = place
    cuts, tolerance = solids.numbers.cuts[low, high], solids.tolerances[beam]
    ends = vertices[end, k, low], vertices[end, k, high]
    spot = beam, end, k
    if cuts.is_line[spot]:
        points = solids.numbers.corners[beam, end, k].tolist()
        return _line((points[low], points[high]), ends, tolerance)
    axes = gp_Ax2(
        gp_Pnt(*cuts.centers[spot].tolist()),
        gp_Dir(*cuts.normals[spot].tolist()),
        gp_Dir(*cuts.majors[spot].tolist()),
    )
    radius = float(solids.numbers.radii[beam, k])
    curve = Geom_Ellipse(gp_Elips(axes, max(float(cuts.radii[spot]), radius), radius))
    length, first = float(cuts.lengths[spot]), float(cuts.firsts[spot])
    return occ.make_edge(curve, *ends, length, tolerance, first)


def _plane_faces(solids: _Solids, beam: int, block: _Block) -> list[TopoDS_Shape]:
    """Sides and ends; edges run along the beam, from outer to inner, and upwards."""
    arcs, lines, uprights = block.arcs, block.lines, block.uprights
    x, _, z = solids.numbers.beams.annuli.frames[beam]
    corners, tolerance = solids.numbers.corners[beam], solids.tolerances[beam]
    rings: list[tuple[FloatArray, FloatArray, FloatArray, list[TopoDS_Shape]]] = []
    for level, normal in ((0, -z), (2, z)):
        ring = [
            arcs[1, level], lines[1, level].Reversed(), arcs[0, level].Reversed(),
            lines[0, level],
        ]  # fmt: skip
        rings.append((corners[0, 0, level], normal, x, ring if level else _backwards(ring)))
    for end in (0, 1):
        down = solids.numbers.beams.annuli.end_directions[beam, end]
        for low, high in block.steps[end]:
            rise = corners[end, 0, high] - corners[end, 0, low]
            normal = np.cross(rise, down)
            ring = [
                uprights[end, 0, (low, high)], lines[end, high],
                uprights[end, 1, (low, high)].Reversed(), lines[end, low].Reversed(),
            ]  # fmt: skip
            outward = normal if end else -normal
            rings.append(
                (corners[end, 0, low], outward, down, ring if end else _backwards(ring))
            )
    return [
        occ.make_face(_plane(point, normal, along), ring, tolerance)
        for point, normal, along, ring in rings
    ]


def _plane(point: FloatArray, normal: FloatArray, along: FloatArray) -> Geom_Plane:
    axes = gp_Ax3(gp_Pnt(*point.tolist()), gp_Dir(*normal.tolist()), gp_Dir(*along.tolist()))
    return Geom_Plane(axes)


def _backwards(ring: list[TopoDS_Shape]) -> list[TopoDS_Shape]:
    return [edge.Reversed() for edge in reversed(ring)]


def _long_face(solids: _Solids, beam: int, block: _Block, k: int) -> TopoDS_Shape:
    """Outer (0) or inner (1) face, with the normal out of the beam."""
    tolerance, curvature = solids.tolerances[beam], 1 / float(solids.numbers.radii[beam, k])
    up = [block.uprights[0, k, step] for step in block.steps[0]]
    down = [block.uprights[1, k, step].Reversed() for step in reversed(block.steps[1])]
    outwards = [*up, block.arcs[k, 2], *down, block.arcs[k, 0].Reversed()]
    x, _, z = solids.numbers.frames[beam, k].tolist()
    if curvature == 0:
        normal = -np.array(x) if k == 0 else np.array(x)
        point = solids.numbers.corners[beam, 0, k, 0]
        surface = _plane(point, normal, np.array(z))
        return occ.make_face(surface, outwards if k == 0 else _backwards(outwards), tolerance)
    axes = gp_Ax3(gp_Pnt(*solids.numbers.centers[beam, k].tolist()), gp_Dir(*z), gp_Dir(*x))
    surface = Geom_CylindricalSurface(axes, 1 / curvature)
    is_dome = bool(solids.numbers.is_dome[beam, k])
    ring = outwards if is_dome else _backwards(outwards)
    face = occ.make_face(surface, ring, tolerance)
    for edge, curve in _parameter_curves(solids, beam, block, k):
        occ.BUILDER.UpdateEdge(edge, curve, face, tolerance)
    return face if is_dome == (k == 0) else face.Reversed()


def _parameter_curves(
    solids: _Solids, beam: int, block: _Block, k: int
) -> Iterator[tuple[TopoDS_Edge, Geom2d_Curve]]:
    """Edges of a cylinder and their curves in its parameters."""
    heights = solids.numbers.beams.levels[beam]
    for level, sides in solids.sides.items():
        start, turn = float(sides.starts[beam, k]), float(sides.turns[beam, k])
        height = float(heights[0, level])
        yield (block.arcs[k, level], Geom2d_Line(gp_Pnt2d(start, height), gp_Dir2d(turn, 0.0)))
    for end in (0, 1):
        for step in block.steps[end]:
            edge = block.uprights[end, k, step]
            knots, poles = (values[beam, end, k] for values in solids.parameters[step])
            if not solids.numbers.cuts[step].is_line[beam, end, k]:
                yield edge, occ.make_spline(knots.tolist(), poles.tolist())
                continue
            relative = (
                solids.numbers.corners[beam, end, k, list(step)]
                - solids.numbers.centers[beam, k]
            )
            x, y, z = solids.numbers.frames[beam, k] @ relative.T
            points = np.stack([np.pi + np.arctan2(-y, -x), z], 1)
            length = float(norm(relative[1] - relative[0]))
            yield edge, occ.make_spline([0.0, length], points.tolist(), 1)
