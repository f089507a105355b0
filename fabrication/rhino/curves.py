"""Arcs, lines and circles as curves of rhino3dm."""

import numpy as np

from ...kernel.arrays import FloatArray
from ...kernel.spheres.arcs import ArcCircles, Arcs
from .model import Untyped


def arc_curve(
    library: Untyped, arcs: Arcs, circles: ArcCircles, i: int, lift: FloatArray
) -> Untyped:
    """Arc or line i, by its circle: three points would lose the radius of a flat arc.

    Parameters
    ----------
    library : module
        rhino3dm.
    circles : ArcCircles
        Of the arcs.
    i : int
    lift : (3,) float array
        By which the curve is moved.

    Returns
    -------
    rhino3dm.ArcCurve or LineCurve
        From start to end.
    """
    start, end = arcs.starts[i] + lift, arcs.ends[i] + lift
    radius = float(circles.radii[i])
    if radius == np.inf:
        return library.LineCurve(
            library.Point3d(*start.tolist()), library.Point3d(*end.tolist())
        )
    center = circles.centers[i] + lift
    x = arcs.starts[i] - circles.centers[i]
    y = np.cross(circles.axes[i], x)
    circle = library.Circle(radius)
    circle.Plane = library.Plane(
        library.Point3d(*center.tolist()), library.Vector3d(*x.tolist()),
        library.Vector3d(*y.tolist()),
    )  # fmt: skip
    return library.ArcCurve.CreateFromArc(library.Arc(circle, float(circles.sweeps[i])))


def circle_curve(
    library: Untyped, center: FloatArray, normal: FloatArray, radius: float
) -> Untyped:
    """A circle as a closed curve.

    Parameters
    ----------
    library : module
        rhino3dm.
    center, normal : (3,) float array
    radius : float

    Returns
    -------
    rhino3dm.ArcCurve
        Closed.
    """
    circle = library.Circle(radius)
    circle.Plane = library.Plane(
        library.Point3d(*center.tolist()), library.Vector3d(*normal.tolist())
    )
    return library.ArcCurve.CreateFromCircle(circle)
