"""Panels as shapes of OpenCASCADE: spheres, planes, circles and lines, all exact.

Vertices, edges and faces are built directly and shared, so nothing is intersected or sewn.
Every shape is built about the origin of its panel and placed by a translation, wherever the
model stands on the site. The translations are rounded to ten digits, short in the text of a
STEP file, and the remainders go into the shapes: no digit is lost.

The sphere of a face has its parameters turned so that the panel lies about u = π, v = 0, away
from the seam and the poles.

This module imports OCP, which takes more than a second: others import it inside functions.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from OCP.Geom import Geom_Line, Geom_Plane, Geom_SphericalSurface, Geom_Surface
from OCP.Geom2d import Geom2d_BSplineCurve
from OCP.gp import gp_Ax3, gp_Dir, gp_Pnt
from OCP.TopoDS import TopoDS_Edge, TopoDS_Face, TopoDS_Shape, TopoDS_Vertex

from ...kernel.arrays import FloatArray, IntArray, norm
from ...kernel.panels.panels import Panels, panel_arcs
from ...kernel.spheres.arcs import ArcCircles, Arcs, arc_circles, circle_axes
from ...kernel.spheres.rows import center_radius
from ..breps.panel_geometry import CONFUSION, panel_tolerances, panels_in_place, surface_frames
from . import opencascade_parts as occ


@dataclass(frozen=True)
class _Layer:
    """Outer or inner faces: vertices and edges (H), faces (P) oriented along N."""

    vertices: list[TopoDS_Vertex]
    edges: list[TopoDS_Edge]
    faces: list[TopoDS_Shape]


def panel_shapes(panels: Panels, scale: float = 1.0) -> list[TopoDS_Shape]:
    """A face per panel, or a closed solid where panels have a thickness.

    Each is placed by a translation to the origin of its panel; faces are oriented along N,
    solids outwards. The scale is units of the shapes per model unit; OpenCASCADE's tolerances
    suit millimetres. Raises InputError if a panel has numbers that are not finite, at which
    OpenCASCADE would crash.

    A solid has the outer face, the concentric inner face and a plane wall per edge. Edges carry
    curves in the parameters of spheres, which OpenCASCADE's algorithms need. The shape of a
    panel of n edges takes 0.1 n ms.
    """
    panels = panels_in_place(panels, scale)
    tolerances = panel_tolerances(panels)
    outer = _layer(panels, panels.spheres, panel_arcs(panels), tolerances)
    shapes: Iterable[TopoDS_Shape] = outer.faces
    if panels.thickness > 0:
        arcs = panel_arcs(panels, "inner")
        inner = _layer(panels, panels.inner_spheres, arcs, tolerances)
        walls = _walls(panels, outer, inner, tolerances)
        bounds = panels.offsets.tolist()
        shapes = [
            occ.make_solid([face, inner_face.Reversed(), *walls[first:last]])
            for face, inner_face, first, last in zip(
                outer.faces, inner.faces, bounds, bounds[1:], strict=False
            )
        ]
    places = panels.origins.tolist()
    return [shape.Located(occ.placement(x)) for shape, x in zip(shapes, places, strict=True)]


def _layer(panels: Panels, rows: FloatArray, arcs: Arcs, tolerances: FloatArray) -> _Layer:
    owners = panels.corner_panels
    corner_tolerances = tolerances[owners].tolist()
    frames = surface_frames(rows, arcs, panels.offsets)
    circles = arc_circles(arcs)
    vertices = [
        occ.make_vertex(point, tolerance)
        for point, tolerance in zip(arcs.starts.tolist(), corner_tolerances, strict=True)
    ]
    following: list[int] = panels.next_corners.tolist()
    ends = [vertices[corner] for corner in following]
    curves, lengths = occ.arc_curves(arcs, circles)
    edges = [
        occ.make_edge(*parts)
        for parts in zip(curves, vertices, ends, lengths, corner_tolerances, strict=True)
    ]
    surfaces = _surfaces(rows, frames)
    curves_2d = _parameter_curves(rows[owners], frames[owners], arcs, circles)
    bounds, is_inward = panels.offsets.tolist(), (rows[:, 0] > 0).tolist()
    faces: list[TopoDS_Shape] = []
    for panel, surface in enumerate(surfaces):
        ring = slice(bounds[panel], bounds[panel + 1])
        tolerance = corner_tolerances[bounds[panel]]
        faces.append(
            _patch(surface, edges[ring], curves_2d[ring], tolerance, is_inward=is_inward[panel])
        )
    return _Layer(vertices, edges, faces)


def _surfaces(rows: FloatArray, frames: FloatArray) -> list[Geom_Surface]:
    centers, squares = center_radius(rows)
    is_plane = rows[:, 0] == 0
    centers = np.where(is_plane[:, None], rows[:, 1:4] * rows[:, 4:], centers)
    surfaces: list[Geom_Surface] = []
    for center, radius, (x, _, z) in zip(
        centers.tolist(), np.sqrt(squares).tolist(), frames.tolist(), strict=True
    ):
        axes = gp_Ax3(gp_Pnt(*center), gp_Dir(*z), gp_Dir(*x))
        if radius == np.inf:
            surfaces.append(Geom_Plane(axes))
        else:
            surfaces.append(Geom_SphericalSurface(axes, radius))
    return surfaces


def _walls(
    panels: Panels, outer: _Layer, inner: _Layer, tolerances: FloatArray
) -> list[TopoDS_Face]:
    """Plane side walls, one per edge, with the normal out of the panel."""
    corner_tolerances = tolerances[panels.corner_panels].tolist()
    rises = panels.corners - panels.inner_corners
    posts = [
        occ.make_edge(Geom_Line(gp_Pnt(*foot), gp_Dir(*rise)), bottom, top, height, tolerance)
        for foot, rise, height, bottom, top, tolerance in zip(
            panels.inner_corners.tolist(), rises.tolist(), norm(rises).tolist(),
            inner.vertices, outer.vertices, corner_tolerances, strict=True,
        )
    ]  # fmt: skip
    following: list[int] = panels.next_corners.tolist()
    next_posts = [posts[corner] for corner in following]
    chords = panels.corners[panels.next_corners] - panels.corners
    walls: list[TopoDS_Face] = []
    for corner, normal, chord, low, right, high, left, tolerance in zip(
        panels.corners.tolist(), (-panels.plane_normals).tolist(), chords.tolist(),
        inner.edges, next_posts, outer.edges, posts, corner_tolerances, strict=True,
    ):  # fmt: skip
        plane = Geom_Plane(gp_Ax3(gp_Pnt(*corner), gp_Dir(*normal), gp_Dir(*chord)))
        walls.append(
            occ.make_face(plane, (low, right, high.Reversed(), left.Reversed()), tolerance)
        )
    return walls


def _patch(
    surface: Geom_Surface,
    edges: list[TopoDS_Edge],
    curves_2d: list[Geom2d_BSplineCurve | None],
    tolerance: float,
    *,
    is_inward: bool,
) -> TopoDS_Shape:
    """Face along N; is_inward: N points to the centre, unlike the surface's own normal."""
    ring = [edge.Reversed() for edge in reversed(edges)] if is_inward else edges
    face = occ.make_face(surface, ring, tolerance)
    for edge, curve in zip(edges, curves_2d, strict=True):
        if curve is not None:
            occ.BUILDER.UpdateEdge(edge, curve, face, tolerance)
    return face.Reversed() if is_inward else face


def _parameter_curves(
    rows: FloatArray, frames: FloatArray, arcs: Arcs, circles: ArcCircles
) -> list[Geom2d_BSplineCurve | None]:
    """Arcs in the parameters (u, v) of their spheres, by angle as the circles; None on planes.

    Quintic splines, twice differentiable, through nodes at equal angles where the value and
    two derivatives are those of the arc.
    """
    result: list[Geom2d_BSplineCurve | None] = [None] * len(rows)
    curved = np.flatnonzero(np.isfinite(circles.radii))
    x, y = (axes[curved] for axes in circle_axes(arcs, circles))
    frames, radii = frames[curved], circles.radii[curved]
    start = np.einsum("hij,hj->hi", frames, arcs.starts[curved])
    start[:, 0] -= norm(rows[curved, 1:4]) / (2 * np.abs(rows[curved, 0]))
    cosine = radii[:, None] * np.einsum("hij,hj->hi", frames, x)
    sine = radii[:, None] * np.einsum("hij,hj->hi", frames, y)
    motion = np.stack([start, cosine, sine], 1)
    sweeps = circles.sweeps[curved]
    spans = _span_counts(motion, sweeps)
    for count in np.unique(spans).tolist():
        ids = np.flatnonzero(spans == count)
        angles = sweeps[ids, None] * np.linspace(0, 1, count + 1)
        poles = occ.quintic_poles(_sphere_parameters(motion[ids], angles), sweeps[ids] / count)
        for i, knots, points in zip(
            curved[ids].tolist(), angles.tolist(), poles.tolist(), strict=True
        ):
            result[i] = occ.make_spline(knots, points)
    return result


def _span_counts(motion: FloatArray, sweeps: FloatArray) -> IntArray:
    """Spans after which the splines miss the arcs by much less than the tolerance."""
    points, _, _ = _moving_points(motion, sweeps[:, None] * np.linspace(0, 1, 7))
    cosine = np.hypot(points[..., 0], points[..., 1]) / norm(points)
    radii = norm(motion[:, 1])
    wanted = np.minimum(0.2 * CONFUSION, 1e-9 * radii * sweeps)
    step = 0.1 * (wanted / (1.2e-9 * radii)) ** (1 / 6) * cosine.min(axis=1)
    return np.maximum(1, np.ceil(sweeps / step)).astype(np.int64)


def _moving_points(
    motion: FloatArray, angles: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points (H, n, 3) of arcs about the centres of their spheres, and two derivatives."""
    start, x, y = (motion[:, i, None] for i in range(3))
    cosine, sine = np.cos(angles)[..., None], np.sin(angles)[..., None]
    fall = 2 * np.sin(angles / 2)[..., None] ** 2
    return start - fall * x + sine * y, cosine * y - sine * x, -cosine * x - sine * y


def _sphere_parameters(motion: FloatArray, angles: FloatArray) -> FloatArray:
    """Parameters (u, v) at the angles and two derivatives by the angle: (3, H, n, 2)."""
    points, speeds, pulls = _moving_points(motion, angles)
    px, py, pz = np.moveaxis(points, -1, 0)
    qx, qy, qz = np.moveaxis(speeds, -1, 0)
    rx, ry, rz = np.moveaxis(pulls, -1, 0)
    square = px**2 + py**2
    equator = np.sqrt(square)
    half_rate = px * qx + py * qy
    moment = px * qy - py * qx
    u = np.pi + np.arctan2(-py, -px)
    u1 = moment / square
    u2 = (px * ry - py * rx) / square - 2 * moment * half_rate / square**2
    v = np.arctan2(pz, equator)
    v1 = qz / equator
    v2 = rz / equator - qz * half_rate / (square * equator)
    return np.stack([np.stack([u, v], -1), np.stack([u1, v1], -1), np.stack([u2, v2], -1)])
