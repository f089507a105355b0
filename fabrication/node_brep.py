"""
Node cylinders and node axes as shapes of OpenCASCADE.

Shapes are built about origins of their own and placed by a translation, as beams are.

This module imports OCP, which takes more than a second: others import it inside functions.
"""

from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.TopoDS import TopoDS_Compound, TopoDS_Shape

from ..kernel.arrays import FloatArray
from ..kernel.node_cylinders import NodeCylinders
from .brep_parts import BUILDER, placement, rounded_origins


def cylinder_shapes(cylinders: NodeCylinders, scale: float = 1.0) -> list[TopoDS_Shape]:
    """
    A closed solid per node cylinder.

    Parameters
    ----------
    cylinders : NodeCylinders
        N cylinders.
    scale : float
        Units of the shapes per model unit.

    Returns
    -------
    list of TopoDS_Shape
        N solids, each placed by a translation.
    """
    origins = cylinders.origins * scale
    places = rounded_origins(origins)
    radius = cylinders.radius * scale
    shapes: list[TopoDS_Shape] = []
    for place, base, direction, height in zip(
        places.tolist(), (origins - places).tolist(), cylinders.directions.tolist(),
        (cylinders.heights * scale).tolist(), strict=True,
    ):  # fmt: skip
        axes = gp_Ax2(gp_Pnt(*base), gp_Dir(*direction))
        solid = BRepPrimAPI_MakeCylinder(axes, radius, height).Shape()
        shapes.append(solid.Located(placement(place)))
    return shapes


def axis_shape(segments: FloatArray, scale: float = 1.0) -> TopoDS_Shape:
    """
    The node axes as one compound of straight edges.

    Parameters
    ----------
    segments : (N, 2, 3) float array
        Ends of the axes, in model coordinates; at least one.
    scale : float
        Units of the shape per model unit.

    Returns
    -------
    TopoDS_Shape
        The compound, placed by a translation.
    """
    place = rounded_origins(segments[:1, 0] * scale)
    compound = TopoDS_Compound()
    BUILDER.MakeCompound(compound)
    for start, end in (segments * scale - place).tolist():
        BUILDER.Add(compound, BRepBuilderAPI_MakeEdge(gp_Pnt(*start), gp_Pnt(*end)).Edge())
    return compound.Located(placement(place[0].tolist()))
