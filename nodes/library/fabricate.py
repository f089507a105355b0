"""Panels, and the files that fabricators open."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal, NamedTuple

import numpy as np

from ...fabrication.model import Model, Written
from ...fabrication.rhino_models import writer as rhino
from ...fabrication.schedules import writer as schedule
from ...fabrication.step import writer as step
from ...kernel.beams.beams import Beams
from ...kernel.errors import name_ids
from ...kernel.meshes.mesh import Mesh
from ...kernel.panels import cutting
from ...kernel.panels.panels import Panels, mark_creases
from ...kernel.parts.findings import Finding, rejected_report
from ...kernel.reports import Report
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ..graphs.node import node, running_graph, warn
from ..graphs.ports import Length, Port, Units, WritePath
from .arrays import CreaseAngle, FaceLabels, VertexAxes


@dataclass(frozen=True, eq=False)
class CutReport(Report):
    """The panels that can be made, and the others.

    Attributes
    ----------
    edge_gap : dict
        Between the arcs of neighbouring panels, before the joint: ``max`` and ``mean`` in model
        units, ``relative_to_edge``, ``middle_p95`` and ``middle_max`` in the middle of edges,
        ``corner_p95`` and ``corner_max`` at their ends, over so many ``edges``.
    thickness : dict
        ``min``, ``mean`` and ``max``.
    written : int
    rejected : list of dict
        ``id``, ``code`` and ``reason`` of each panel that cannot be made.
    """

    edge_gap: dict[str, float]
    thickness: dict[str, float]
    written: int
    rejected: list[dict[str, str]]


class PanelSet(NamedTuple):
    """The panels that can be made, and what was found while cutting them."""

    panels: Panels
    report: CutReport


@node
def panels(  # noqa: PLR0913, PLR0917 - a node has an input per choice
    sphere_mesh: SphereMesh,
    edges: Literal["bisector", "intersection", "axis"] = "bisector",
    thickness: Length = 0.0,
    joint_gap: Length = 0.0,
    labels: FaceLabels | None = None,
    side: Literal["inward", "outward", "centred"] = "inward",
    layer: Literal["offset", "power"] = "offset",
    axes: VertexAxes | None = None,
    crease: CreaseAngle = 40.0,
) -> PanelSet:
    """Cut a panel out of the sphere of every face.

    Parameters
    ----------
    sphere_mesh : SphereMesh
    edges : {"bisector", "intersection", "axis"}
        Cut along each edge by the plane that bisects the two faces (walls stand upright, the
        two arcs of an edge differ by a small gap), by the plane in which the two spheres meet
        (watertight, as tilted as they left it), or by the plane of its beam, through its two
        vertices and node axes (these are needed then).
    thickness : float
        Thickness in model units; 0 for surfaces.
    joint_gap : float
        Width of the joints, in model units.
    labels : (F,) int array, optional
        Mould of each face.
    side : {"inward", "outward", "centred"}
        Where the thickness goes: against the face normals, along them, or half each way.
    layer : {"offset", "power"}
        The same thickness everywhere; or the same difference of squared radii, so that
        neighbours which bulge to one side meet in one plane on both of their faces: the
        thickness is then met on average, sharp panels are thicker and planes have none.
    axes : (V, 2, 3) float array, optional
        Two points of each node axis, as `axis_support` gives them: for edges cut by axes.
    crease : float
        Edges at which flat faces turn by more have their own layer and mark; 180 for none.

    Returns
    -------
    panels : Panels
        The panels that can be made.
    report : CutReport
        Gaps, thickness, and the panels that cannot be made.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, panels, vase_mesh
    >>> made = panels(fit_spheres(vase_mesh(12, 6)), thickness=0.02)
    >>> made.report["written"], made.report["rejected"]
    (72, [])
    """
    made, rejected = cutting.cut_panels(
        sphere_mesh, edges, thickness, joint_gap, labels, side, layer, axes
    )
    made = mark_creases(made, sphere_mesh.mesh, float(np.radians(crease)))
    if rejected:
        warn(
            f"{len(rejected)} panels cannot be made: faces "
            f"{name_ids([panel.element_id for panel in rejected])} "
            f"({rejected[0].id}: {rejected[0].reason})"
        )
    report = CutReport(
        edge_gap=cutting.gap_report(sphere_mesh, edges, made.face_ids, axes),
        thickness=cutting.thickness_report(made),
        written=made.n_panels,
        rejected=rejected_report(rejected),
    )
    return PanelSet(made, report)


@node(version="2")
def write_step(  # noqa: PLR0913, PLR0917 - a node has an input per choice
    panels: Panels | None = None,
    path: WritePath = "model.step",
    units: Units = "m",
    step_units: Literal["mm", "m"] = "mm",
    schema: Literal["AP214IS", "AP242DIS"] = "AP214IS",
    copies: Literal["shapes", "instances"] = "shapes",
    beams: Beams | None = None,
    parameter_curves: Literal["needed", "all", "none"] = "needed",
    engine: Literal["text", "cadquery"] = "text",
    validation: bool = False,  # noqa: FBT001, FBT002 - a toggle on the canvas
) -> str:
    """Write panels and beams to a STEP file: exact solids, or faces without thickness.

    Parameters
    ----------
    panels : Panels, optional
        The panels; these or beams are needed.
    path : path
        Ends in .step or .stp.
    units : str
    step_units : {"mm", "m"}
        Units of the file.
    schema : {"AP214IS", "AP242DIS"}
        Application protocol.
    copies : {"shapes", "instances"}
        A shape of its own for every panel, or one shape for identical panels: smaller files
        where panels repeat.
    beams : Beams, optional
        The beams, with their node cylinders if they have any, and the node axes.
    parameter_curves : {"needed", "all", "none"}
        Whether arcs have curves in the parameters of their spheres: where readers miss them
        without, so that Boolean operations work on sharply curved panels; everywhere; nowhere.
    engine : {"text", "cadquery"}
        Our own text, or OpenCASCADE by way of CadQuery: slower, and the same model.
    validation : bool
        Whether every solid states its volume, area and centre, so that readers can tell whether
        they read it right.

    Returns
    -------
    str
        The path.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from spheremesh.nodes import fit_spheres, panels, vase_mesh, write_step
    >>> made = panels(fit_spheres(vase_mesh(12, 6)), thickness=0.02)
    >>> with TemporaryDirectory() as folder:
    ...     write_step(made.panels, f"{folder}/vase.step").endswith("vase.step")
    True
    """
    options = step.StepOptions(
        step_units, schema, copies=copies, parameter_curves=parameter_curves, engine=engine,
        validation=validation,
    )  # fmt: skip
    return told_path(step.write_step(Model(panels, beams, units), path, options))


@node(version="2")
def write_3dm(  # noqa: PLR0913 - a node has an input per choice
    panels: Panels | None = None,
    path: WritePath = "model.3dm",
    units: Units = "m",
    version: Annotated[int, Port(min=6, max=8)] = 8,
    beams: Beams | None = None,
    reference: Mesh | SphereMesh | None = None,
    shape: Literal["panels", "blocks", "shell"] = "panels",
    layers: tuple[Literal["Edges", "Centres", "Moulds"], ...] = ("Edges",),
    *,
    findings: Sequence[Finding] = (),
    cut: CutReport | None = None,
) -> str:
    """Write panels and beams to a Rhino file: the solids of STEP files, layers, user text.

    Parameters
    ----------
    panels : Panels, optional
        The panels; these or beams are needed.
    path : path
        Ends in .3dm.
    units : str
        Model units; those of the file.
    version : int
        Rhino version of the file.
    beams : Beams, optional
        The beams, as solids, with their drilling marks, node cylinders and node axes.
    reference : Mesh or SphereMesh, optional
        The design mesh, for a layer of its own.
    shape : {"panels", "blocks", "shell"}
        A solid per panel, or a face without thickness; instances of a block wherever panels
        are identical; or all outer faces joined into one polysurface, which needs panels cut
        along intersections without joint.
    layers : tuple of {"Edges", "Centres", "Moulds"}
        Further layers: the edges of the panels, the centres of their spheres, and the blanks
        of the moulds as blocks under their panels.
    findings : sequence of Finding, optional
        What the node `audit` found: user text and a colour of the parts, named on the layer
        ``To check``.
    cut : CutReport, optional
        What `panels` reports: where panels are missing, the reference shows on ``Rejected``.

    Returns
    -------
    str
        The path. The document carries the graph that is running.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from spheremesh.nodes import fit_spheres, panels, vase_mesh, write_3dm
    >>> made = panels(fit_spheres(vase_mesh(12, 6)))
    >>> with TemporaryDirectory() as folder:
    ...     write_3dm(made.panels, f"{folder}/vase.3dm").endswith("vase.3dm")
    True
    """
    mesh = reference.mesh if isinstance(reference, SphereMesh) else reference
    graph = running_graph()
    rejected = () if cut is None else tuple(cut["rejected"])
    options = rhino.RhinoOptions(
        shape, layers, mesh, tuple(findings), rejected, version=version, graph_json=graph
    )
    return told_path(rhino.write_3dm(Model(panels, beams, units), path, options))


@node
def write_schedule(
    panels: Panels | None = None,
    path: WritePath = "schedule.csv",
    units: Units = "m",
    beams: Beams | None = None,
) -> str:
    """Write the list of panels or beams with sizes, edges and neighbours, in millimetres.

    Parameters
    ----------
    panels : Panels, optional
        The panels; these or beams are needed.
    path : path
        Ends in .csv (panels or beams), or in .json or .xlsx (both; .xlsx with the extra
        ``excel``).
    units : str
    beams : Beams, optional

    Returns
    -------
    str
        The path.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from spheremesh.nodes import fit_spheres, panels, vase_mesh, write_schedule
    >>> made = panels(fit_spheres(vase_mesh(12, 6)))
    >>> with TemporaryDirectory() as folder:
    ...     path = write_schedule(made.panels, f"{folder}/panels.csv")
    ...     len(Path(path).read_text("utf-8").splitlines())
    73
    """
    return told_path(schedule.write_schedule(Model(panels, beams, units), path))


def told_path(written: Written) -> str:
    """Warn of what differs from what was asked for.

    Parameters
    ----------
    written : Written
        What a writer says.

    Returns
    -------
    str
        The path.
    """
    name, rejected = written.path.name, written.rejected
    if rejected:
        shown = "; ".join(f"{part.id}: {part.reason}" for part in rejected[:8])
        more = f"; {len(rejected) - 8} more" if len(rejected) > 8 else ""
        warn(f"{len(rejected)} panels are not in {name}: {shown}{more}")
    for note in written.notes:
        warn(f"{name}: {note}")
    return str(written.path)
