"""Panels, and the files that fabricators open."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, NamedTuple

from ...fabrication import rhino, schedule, step
from ...fabrication.files import check_suffix, replacing
from ...kernel import cutting, panel_kinds
from ...kernel.arrays import IntArray
from ...kernel.errors import name_ids
from ...kernel.mesh import Mesh
from ...kernel.panels import Panels
from ...kernel.sphere_mesh import SphereMesh
from ...viewer.render import render_image
from ..node import node, running_graph, warn
from ..ports import Port, Units, WritePath

Length = Annotated[float, Port(min=0)]


class PanelSet(NamedTuple):
    """The panels that can be made, and what was found while cutting them."""

    panels: Panels
    report: Mapping[str, Any]


class PanelGroups(NamedTuple):
    """Panels grouped by shape."""

    kinds: IntArray
    report: Mapping[str, Any]


@node
def panels(
    sphere_mesh: SphereMesh,
    edges: Literal["bisector", "intersection"] = "bisector",
    thickness: Length = 0.0,
    joint_gap: Length = 0.0,
    labels: IntArray | None = None,
) -> PanelSet:
    """
    Cut a panel out of the sphere of every face.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.
    edges : {"bisector", "intersection"}
        Cut along each edge by the plane that bisects the two faces (walls stand upright, the
        two arcs of an edge differ by a small gap), or by the plane in which the two spheres
        meet (watertight, as tilted as the spheres left it).
    thickness : float
        Thickness to the inner side, in model units; 0 for surfaces.
    joint_gap : float
        Width of the joints, in model units.
    labels : (F,) int array, optional
        Mould of each face.

    Returns
    -------
    panels : Panels
        The panels that can be made.
    report : mapping
        ``edge_gap`` (max, mean, relative_to_edge, over so many edges) between the arcs of
        neighbouring panels, at the ends and in the middle, before the joint; ``written`` and
        ``rejected`` (id and reason of each panel that cannot be made).
    """
    made, rejected = cutting.cut_panels(sphere_mesh, edges, thickness, joint_gap, labels)
    if rejected:
        warn(
            f"{len(rejected)} panels cannot be made: faces "
            f"{name_ids([panel.face_id for panel in rejected])} ({rejected[0].reason})"
        )
    report = {
        "edge_gap": cutting.gap_report(sphere_mesh, edges, made.face_ids),
        "written": made.n_panels,
        "rejected": [{"id": panel.id, "reason": panel.reason} for panel in rejected],
    }
    return PanelSet(made, report)


@node
def write_step(
    panels: Panels,
    path: WritePath,
    units: Units = "m",
    step_units: Literal["mm", "m"] = "mm",
    schema: Literal["AP214IS", "AP242DIS"] = "AP214IS",
) -> str:
    """
    Write panels to a STEP file: exact solids, or faces where they have no thickness.

    Parameters
    ----------
    panels : Panels
        The panels.
    path : path
        Ends in .step or .stp.
    units : str
        Model units.
    step_units : {"mm", "m"}
        Units of the file.
    schema : {"AP214IS", "AP242DIS"}
        Application protocol.

    Returns
    -------
    str
        The path.
    """
    return str(step.write_step(panels, path, units, step_units, schema))


@node
def write_3dm(
    panels: Panels,
    path: WritePath,
    units: Units = "m",
    version: Annotated[int, Port(min=6, max=8)] = 8,
    reference: Mesh | SphereMesh | None = None,
    shape: Literal["panels", "blocks", "shell"] = "panels",
    layers: tuple[Literal["Edges", "Centres"], ...] = ("Edges",),
) -> str:
    """
    Write panels to a Rhino file: exact trimmed spheres, layers per mould, user text.

    Parameters
    ----------
    panels : Panels
        The panels.
    path : path
        Ends in .3dm.
    units : str
        Model units; those of the file.
    version : int
        Rhino version of the file.
    reference : Mesh or SphereMesh, optional
        The design mesh, for a layer of its own.
    shape : {"panels", "blocks", "shell"}
        A surface per panel; instances of a block wherever panels are identical; or all panels
        joined into one polysurface, which needs panels cut along intersections without joint.
    layers : tuple of {"Edges", "Centres"}
        Further layers: the edges of the panels, the centres of their spheres.

    Returns
    -------
    str
        The path. The document carries the graph that is running.
    """
    mesh = reference.mesh if isinstance(reference, SphereMesh) else reference
    contents = rhino.RhinoContents(shape, layers, mesh)
    file = rhino.write_3dm(panels, path, units, running_graph(), version, contents=contents)
    if file.rejected:
        shown = "; ".join(f"{panel.id}: {panel.reason}" for panel in file.rejected[:8])
        more = f"; {len(file.rejected) - 8} more" if len(file.rejected) > 8 else ""
        warn(f"{len(file.rejected)} panels are not in {file.path.name}: {shown}{more}")
    for note in file.notes:
        warn(f"{file.path.name}: {note}")
    return str(file.path)


@node
def identical_panels(panels: Panels) -> PanelGroups:
    """
    Group panels that are equal up to a motion: they can be made from one drawing.

    Parameters
    ----------
    panels : Panels
        The panels.

    Returns
    -------
    kinds : (P,) int array
        Kind of each panel, numbered by first appearance; mirror images are different kinds.
    report : mapping
        ``panels``, ``kinds``, ``repeated_kinds`` (of two panels or more), ``repeated_panels``
        (panels in these), ``largest_kind``, and ``deviation``: how far panels of a kind differ,
        in model units.
    """
    found = panel_kinds.identical_panels(panels)
    return PanelGroups(found.kinds, panel_kinds.panel_kinds_report(found))


@node
def write_schedule(panels: Panels, path: WritePath, units: Units = "m") -> str:
    """
    Write the list of panels with their moulds, sizes, edges and neighbours, in millimetres.

    Parameters
    ----------
    panels : Panels
        The panels.
    path : path
        Ends in .csv or .json.
    units : str
        Model units.

    Returns
    -------
    str
        The path.
    """
    return str(schedule.write_schedule(panels, path, units))


@node
def render(
    panels: Panels,
    path: WritePath,
    color_by: Literal["mould", "radius", "none"] = "mould",
    shading: Literal["studio", "zebra"] = "studio",
    width: Annotated[int, Port(min=16, max=8000)] = 1600,
    height: Annotated[int, Port(min=16, max=8000)] = 1000,
    *,
    legend: bool = False,
) -> str:
    """
    Draw panels into a PNG, from exact spheres and without a graphics card.

    Parameters
    ----------
    panels : Panels
        The panels.
    path : path
        Ends in .png.
    color_by : {"mould", "radius", "none"}
        What the colours mean.
    shading : {"studio", "zebra"}
        Daylight, or reflection lines that show how smooth the surface is.
    width, height : int
        Size in pixels.
    legend : bool
        Whether to list the moulds beside the picture.

    Returns
    -------
    str
        The path.
    """
    check_suffix(path, ".png")
    image = render_image(
        panels, color_by=color_by, shading=shading, width=width, height=height, legend=legend
    )
    with replacing(path) as temporary:
        image.save(temporary, format="PNG", optimize=True)
    return str(path)
