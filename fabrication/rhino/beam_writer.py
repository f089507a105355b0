"""Writes beams into a Rhino model: capped extrusions of their contours, drilling marks, nodes.

An extrusion is what a flat piece is before its ends are mitred: the contour in the middle of
the thickness, whose ends lie on the node axes. The mitres are in the STEP file. Nodes are lines
along their axes, and cylinders where beams end square before them.
"""

import base64

import numpy as np

from ...kernel.beams.beams import (
    Beams,
    DrillMarks,
    beam_lengths,
    node_axis_segments,
    section_arcs,
)
from ...kernel.beams.facts import beam_facts
from ...kernel.beams.node_cylinders import NodeCylinders, node_cylinders
from ...kernel.beams.triangles import beam_triangles, cylinder_triangles
from ...kernel.errors import InputError
from ...kernel.parts.colors import AXIS_COLOR, BEAM_COLOR, NODE_COLOR
from ...kernel.spheres.arcs import arc_circles
from ...kernel.support.node_axes import node_name
from ..opennurbs.render_meshes import (
    MESH_TOLERANCE,
    RenderMeshes,
    extrusions_with_meshes,
    gather_meshes,
)
from .curves import arc_curve
from .model import RhinoModel, Untyped, add_layer, object_attributes


def add_beams(model: RhinoModel, beams: Beams, units: str, *, render_meshes: bool) -> None:
    """Add beams and their nodes.

    Beams lie on the layer ``Beams``, the node axes on the layer ``Axes``; where there are any,
    node cylinders on the layer ``Nodes`` and drilling marks on the layer ``Drilling``.

    Parameters
    ----------
    units : str
        Model units.
    render_meshes : bool
        Whether the extrusions carry triangles for viewers that cannot mesh them.
    """
    place = add_layer(model, "Beams", BEAM_COLOR, has_material=True)
    solids, texts = beam_extrusions(model.library, beams), _beam_text(beams, units)
    if render_meshes and solids:
        error = MESH_TOLERANCE * float(beam_lengths(beams).min()) / 2
        groups = list(beam_triangles(beams, MESH_TOLERANCE))
        solids = with_meshes(model, solids, gather_meshes(groups, error))
    for name, solid, text in zip(beams.annuli.ids, solids, texts, strict=True):
        attributes = object_attributes(model, name, "beam", place)
        for key, value in text.items():
            attributes.SetUserString(key, value)
        model.file.Objects.AddExtrusion(solid, attributes)
    place = add_layer(model, "Axes", AXIS_COLOR)
    for name, line in _axis_lines(model.library, beams):
        model.file.Objects.AddCurve(line, object_attributes(model, name, "axis", place))
    cylinders = node_cylinders(beams)
    if cylinders.n_nodes:
        place = add_layer(model, "Nodes", NODE_COLOR, has_material=True)
        solids = cylinder_extrusions(model.library, cylinders)
        if render_meshes:
            error = MESH_TOLERANCE * cylinders.radius
            triangles = cylinder_triangles(
                cylinders.origins, cylinders.directions, cylinders.heights, cylinders.radius,
                MESH_TOLERANCE,
            )  # fmt: skip
            solids = with_meshes(model, solids, gather_meshes([triangles], error))
        for name, solid in zip(cylinders.ids, solids, strict=True):
            attributes = object_attributes(model, name, "node", place)
            model.file.Objects.AddExtrusion(solid, attributes)
    if beams.marks is not None:
        place = add_layer(model, "Drilling", AXIS_COLOR)
        for name, number, circle in _mark_circles(model.library, beams, beams.marks):
            attributes = object_attributes(model, name, f"mark {number}", place)
            model.file.Objects.AddCurve(circle, attributes)


def beam_extrusions(library: Untyped, beams: Beams) -> list[Untyped]:
    """A capped extrusion per beam in model coordinates, as thick as the beams.

    Parameters
    ----------
    library : module
        rhino3dm.

    Returns
    -------
    list of rhino3dm.Extrusion
        In their order.

    Raises
    ------
    InputError
        If openNURBS refuses one.
    """
    outer, inner = section_arcs(beams)
    circles = arc_circles(outer), arc_circles(inner)
    lifts = -beams.annuli.frames[:, 2] * beams.thickness / 2
    result: list[Untyped] = []
    refused: list[str] = []
    for i, name in enumerate(beams.annuli.ids):
        lift = lifts[i]
        sides = [
            arc_curve(library, arcs, found, i, lift)
            for arcs, found in zip((outer, inner), circles, strict=True)
        ]
        sides[0].Reverse()
        profile = library.PolyCurve()
        for first, second in (sides, sides[::-1]):
            profile.AppendSegment(first)
            profile.AppendSegment(library.LineCurve(first.PointAtEnd, second.PointAtStart))
        x, y, _ = beams.annuli.frames[i].tolist()
        plane = library.Plane(
            library.Point3d(*lift.tolist()), library.Vector3d(*x), library.Vector3d(*y)
        )
        solid = library.Extrusion.CreateWithPlane(profile, plane, beams.thickness, True)  # noqa: FBT003
        # Made where it stands, far from the origin, its contour would not close.
        if solid is not None:
            solid.Translate(library.Vector3d(*beams.annuli.origins[i].tolist()))
        if solid is None or not (solid.IsValid and solid.IsSolid):
            refused.append(name)
        result.append(solid)
    if refused:
        shown = ", ".join(refused[:8])
        raise InputError(
            f"openNURBS refuses {len(refused)} beams: {shown}; leave them out, or move the "
            "model nearer to the origin"
        )
    return result


def with_meshes(
    model: RhinoModel, solids: list[Untyped], meshes: RenderMeshes
) -> list[Untyped]:
    """Extrusions with render meshes, through their streams: the setter crashes at exit.

    Parameters
    ----------
    solids : list of rhino3dm.Extrusion
    meshes : RenderMeshes
        The triangles of each.

    Returns
    -------
    list of rhino3dm.Extrusion
        The same solids with their meshes.

    Raises
    ------
    InputError
        If openNURBS refuses one.
    """
    streams = [base64.b64decode(solid.Encode()["data"]) for solid in solids]
    found = [model.decode(stream) for stream in extrusions_with_meshes(streams, meshes)]
    if any(solid is None or not solid.IsValid for solid in found):
        raise InputError("openNURBS refuses the render meshes of beams: write them without")
    return found


def _beam_text(beams: Beams, units: str) -> list[dict[str, str]]:
    """User text of each beam; ``-`` is beyond the boundary, `tilt` in degrees."""
    annuli, facts = beams.annuli, beam_facts(beams)
    rows = zip(
        annuli.ids, annuli.edge_ids.tolist(), annuli.edge_vertices.tolist(),
        annuli.edge_faces.tolist(), facts.outer_radii.tolist(), facts.inner_radii.tolist(),
        facts.lengths.tolist(), np.degrees(facts.tilts).tolist(), strict=True,
    )  # fmt: skip
    return [
        {
            "id": name,
            "edge": str(edge),
            "nodes": " ".join(map(str, nodes)),
            "faces": " ".join("-" if face < 0 else str(face) for face in faces),
            "outer_radius": _radius(outer),
            "inner_radius": _radius(inner),
            "thickness": f"{beams.thickness:.12g}",
            "length": f"{length:.12g}",
            "tilt": f"{tilt:.6g}",
            "units": units,
        }
        for name, edge, nodes, faces, outer, inner, length, tilt in rows
    ]


def _radius(value: float) -> str:
    return f"{value:.12g}" if np.isfinite(value) else "straight"


def _axis_lines(library: Untyped, beams: Beams) -> list[tuple[str, Untyped]]:
    """Name and line of each node axis, between the outer and the inner corners of beams."""
    vertices, segments = node_axis_segments(beams)
    return [
        (node_name(vertex), library.LineCurve(library.Point3d(*a), library.Point3d(*b)))
        for vertex, (a, b) in zip(vertices, segments.tolist(), strict=True)
    ]


def cylinder_extrusions(library: Untyped, cylinders: NodeCylinders) -> list[Untyped]:
    """A capped extrusion per node cylinder, in model coordinates.

    Parameters
    ----------
    library : module
        rhino3dm.

    Returns
    -------
    list of rhino3dm.Extrusion
        In their order.

    Raises
    ------
    InputError
        If openNURBS refuses one.
    """
    solids: list[Untyped] = []
    for origin, direction, height in zip(
        cylinders.origins.tolist(), cylinders.directions.tolist(), cylinders.heights.tolist(),
        strict=True,
    ):  # fmt: skip
        circle = library.Circle(cylinders.radius)
        circle.Plane = library.Plane(library.Point3d(*origin), library.Vector3d(*direction))
        cylinder = library.Cylinder(circle, height)
        solids.append(library.Extrusion.CreateCylinderExtrusion(cylinder, True, True))  # noqa: FBT003
    refused = [
        name
        for name, solid in zip(cylinders.ids, solids, strict=True)
        if solid is None or not (solid.IsValid and solid.IsSolid)
    ]
    if refused:
        shown = ", ".join(refused[:8])
        raise InputError(f"openNURBS refuses {len(refused)} nodes: {shown}; use mitred beams")
    return solids


def _mark_circles(
    library: Untyped, beams: Beams, marks: DrillMarks
) -> list[tuple[str, int, Untyped]]:
    """Name of the beam, number of the hole, and circle on the side of the normal."""
    annuli = beams.annuli
    lifts = annuli.origins + annuli.frames[:, 2] * beams.thickness / 2
    centers = marks.holes + lifts[:, None]
    result: list[tuple[str, int, Untyped]] = []
    for i in np.flatnonzero(marks.fits).tolist():
        x, y, _ = (library.Vector3d(*axis) for axis in annuli.frames[i].tolist())
        for number, center in enumerate(centers[i].tolist()):
            circle = library.Circle(marks.diameter / 2)
            circle.Plane = library.Plane(library.Point3d(*center), x, y)
            curve = library.ArcCurve.CreateFromCircle(circle)
            result.append((annuli.ids[i], number, curve))
    return result
