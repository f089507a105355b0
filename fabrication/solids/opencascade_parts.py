"""Parts of OpenCASCADE shapes: vertices, edges, faces and solids, built directly and shared.

This module imports OCP, which takes more than a second: others import it inside functions.
"""

from collections.abc import Iterable

import numpy as np
from OCP.BRep import BRep_Builder
from OCP.Geom import Geom_Circle, Geom_Curve, Geom_Line, Geom_Surface
from OCP.Geom2d import Geom2d_BSplineCurve
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt, gp_Pnt2d, gp_Trsf, gp_Vec
from OCP.TColgp import TColgp_Array1OfPnt2d
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal
from OCP.TopAbs import TopAbs_Orientation
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import (
    TopoDS_Edge,
    TopoDS_Face,
    TopoDS_Shape,
    TopoDS_Shell,
    TopoDS_Solid,
    TopoDS_Vertex,
    TopoDS_Wire,
)

from ...kernel.arrays import FloatArray, norm
from ...kernel.spheres.arcs import ArcCircles, Arcs, circle_axes

BUILDER = BRep_Builder()
"""Builder of all shapes; it has no state."""


def placement(origin: list[float]) -> TopLoc_Location:
    """The translation of the origin of a shape to a point, for `TopoDS_Shape.Located`."""
    translation = gp_Trsf()
    translation.SetTranslation(gp_Vec(*origin))
    return TopLoc_Location(translation)


def make_vertex(point: list[float], tolerance: float) -> TopoDS_Vertex:
    """A vertex, to be shared by the edges that meet there."""
    vertex = TopoDS_Vertex()
    BUILDER.MakeVertex(vertex, gp_Pnt(*point), tolerance)
    return vertex


def make_edge(
    curve: Geom_Curve,
    start: TopoDS_Vertex,
    end: TopoDS_Vertex,
    length: float,
    tolerance: float,
    first: float = 0.0,
) -> TopoDS_Edge:
    """An edge between two vertices, to be shared by the faces on its sides.

    Its parameters run from `first` over the length.
    """
    edge = TopoDS_Edge()
    BUILDER.MakeEdge(edge, curve, tolerance)
    BUILDER.Add(edge, start.Oriented(TopAbs_Orientation.TopAbs_FORWARD))
    BUILDER.Add(edge, end.Oriented(TopAbs_Orientation.TopAbs_REVERSED))
    BUILDER.Range(edge, first, first + length)
    return edge


def make_face(
    surface: Geom_Surface, ring: Iterable[TopoDS_Shape], tolerance: float
) -> TopoDS_Face:
    """Face to the left of a closed ring of oriented edges, with the normal of the surface."""
    wire = TopoDS_Wire()
    BUILDER.MakeWire(wire)
    for edge in ring:
        BUILDER.Add(wire, edge)
    wire.Closed(theIsClosed=True)
    face = TopoDS_Face()
    BUILDER.MakeFace(face, surface, tolerance)
    BUILDER.Add(face, wire)
    return face


def make_solid(faces: Iterable[TopoDS_Shape]) -> TopoDS_Solid:
    """Solid in a closed shell of faces that share their edges, normals outwards."""
    shell = TopoDS_Shell()
    BUILDER.MakeShell(shell)
    for face in faces:
        BUILDER.Add(shell, face)
    shell.Closed(theIsClosed=True)
    solid = TopoDS_Solid()
    BUILDER.MakeSolid(solid)
    BUILDER.Add(solid, shell)
    return solid


def arc_curves(arcs: Arcs, circles: ArcCircles) -> tuple[list[Geom_Curve], list[float]]:
    """Curves from parameter 0 at the starts of arcs, and the parameters of their ends.

    H circles, or lines where arcs are straight; H angles, or lengths.
    """
    starts, chords = arcs.starts, arcs.ends - arcs.starts
    x_axes, _ = circle_axes(arcs, circles)
    curves: list[Geom_Curve] = []
    for start, chord, center, axis, x, radius in zip(
        starts.tolist(), chords.tolist(), circles.centers.tolist(), circles.axes.tolist(),
        x_axes.tolist(), circles.radii.tolist(), strict=True,
    ):  # fmt: skip
        if radius == np.inf:
            curves.append(Geom_Line(gp_Pnt(*start), gp_Dir(*chord)))
        else:
            axes = gp_Ax2(gp_Pnt(*center), gp_Dir(*axis), gp_Dir(*x))
            curves.append(Geom_Circle(axes, radius))
    lengths = np.where(np.isinf(circles.radii), norm(chords), circles.sweeps)
    return curves, lengths.tolist()


def quintic_poles(nodes: FloatArray, steps: FloatArray) -> FloatArray:
    """Poles (H, 3n + 3, 2) of quintic splines with triple inner knots, for `make_spline`.

    They pass through nodes (3, H, n + 1, 2), values and first two derivatives; the steps (H,)
    are the distances of the knots. With the Bézier points b₃, b₄ before an inner node and b₂
    after it, the three poles of its knot are b₃, 2 b₄ - b₃, b₂. The first and last three poles
    are Bézier points.
    """
    value, rate, bend = nodes
    rate = rate * steps[:, None, None]
    bend = bend * steps[:, None, None] ** 2
    before = value - 0.4 * rate + 0.05 * bend
    after = value + 0.4 * rate + 0.05 * bend
    middle = 2 * (value - 0.2 * rate) - before
    ring = np.stack([before, middle, after], 2)
    ring[:, 0] = np.stack([value, value + 0.2 * rate, after], 2)[:, 0]
    ring[:, -1] = np.stack([before, value - 0.2 * rate, value], 2)[:, -1]
    return ring.reshape(len(steps), -1, 2)


def make_spline(
    knots: list[float], poles: list[list[float]], degree: int = 5
) -> Geom2d_BSplineCurve:
    """A spline in the parameters of a surface: for degree 5, n + 1 knots and 3n + 3 poles."""
    points = TColgp_Array1OfPnt2d(1, len(poles))
    for i, pole in enumerate(poles, 1):
        points.SetValue(i, gp_Pnt2d(*pole))
    values = TColStd_Array1OfReal(1, len(knots))
    multiplicities = TColStd_Array1OfInteger(1, len(knots))
    for i, knot in enumerate(knots, 1):
        values.SetValue(i, knot)
        multiplicities.SetValue(i, 3)
    multiplicities.SetValue(1, degree + 1)
    multiplicities.SetValue(len(knots), degree + 1)
    return Geom2d_BSplineCurve(points, values, multiplicities, degree)
