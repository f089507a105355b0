"""Graphs to start from, small enough to be read at a glance."""

from collections.abc import Callable, Mapping
from typing import Final, NamedTuple

from ...nodes.graphs.graph import Graph
from ...nodes.graphs.specification.specification import Specification
from ...nodes.graphs.specification.wires import Param, Step, Wire, each


class Template(NamedTuple):
    """A graph to start from.

    Attributes
    ----------
    title, summary : str
    make : callable
        Gives the graph.
    pins : tuple of str
        Outputs that are shown at first.
    """

    title: str
    summary: str
    make: Callable[[], Graph]
    pins: tuple[str, ...]


def template_graph(name: str) -> Specification:
    """The graph of a template, with what it shows at first; KeyError if there is none."""
    from dataclasses import replace

    from ...nodes.graphs.specification.specification import frozen
    from .operations import CANVAS

    template = TEMPLATES[name]
    specification = template.make().specification
    return replace(specification, extra=frozen({CANVAS: {"pins": list(template.pins)}}))


def _optimum(graph: Graph, mesh: Step | Wire) -> Wire:
    start = graph.add("fit_spheres", "start", mesh=mesh)
    return graph.add("minimize_angles", "optimum", sphere_mesh=start).sphere_mesh


def _few(graph: Graph, spheres: Wire, moulds: int) -> Step:
    count = graph.param("moulds", moulds, min=1, max=40)
    return graph.add("cluster_radii", "moulds", sphere_mesh=spheres, k=count)


def _writers(graph: Graph, panels: Wire, **beams: Wire) -> None:
    graph.add("write_step", "step", panels=panels, path="panels.step", **beams)
    graph.add("write_3dm", "rhino", panels=panels, path="model.3dm", **beams)
    graph.add("write_view", "view", panels=panels, path="view.html", **beams)
    graph.add("write_schedule", "table", panels=panels, path="schedule.csv")


def _moulds() -> Graph:
    graph = Graph("Roof with moulds")
    thickness = graph.param("thickness", 0.02, min=0, max=0.2)
    mesh = graph.add("roof_mesh", "mesh")
    few = _few(graph, _optimum(graph, mesh), 6)
    made = graph.add(
        "panels", "panels", sphere_mesh=few.sphere_mesh, labels=few.labels, thickness=thickness
    )
    _writers(graph, made.panels)
    return graph


def _beams() -> Graph:
    graph = Graph("Roof with beams")
    thickness = graph.param("thickness", 0.02, min=0, max=0.2)
    depth = graph.param("depth", 0.25, min=0.05, max=1)
    mesh = graph.add("roof_mesh", "mesh", n_span=16, n_length=30)
    few = _few(graph, _optimum(graph, mesh), 6)
    held = graph.add("bisector_support", "annuli", sphere_mesh=few.sphere_mesh, depth=depth)
    made = graph.add(
        "panels", "panels", sphere_mesh=few.sphere_mesh, labels=few.labels,
        thickness=thickness, joint_gap=0.01, edges="axis", axes=held.axes,
    )  # fmt: skip
    beams = graph.add(
        "beams", "beams", annuli=held.annuli, panels=made.panels, thickness=0.04,
        node_radius=0.08,
    )  # fmt: skip
    _writers(graph, made.panels, beams=beams.beams)
    graph.add("write_dxf", "drawing", beams=beams.beams, path="beams.dxf")
    return graph


def _hexagons() -> Graph:
    graph = Graph("Hexagons")
    length = graph.param("edge_length", 0.35, min=0.15, max=1)
    surface = graph.add("triangulated_surface", "surface", shape="ellipsoid", edge_length=0.12)
    net = graph.add(
        "hexagon_pattern", "hexagons", mesh=surface.mesh, edge_length=length, boundary="drop"
    )
    made = graph.add("panels", "panels", sphere_mesh=net.sphere_mesh)
    graph.add("classify_hexagons", "shapes", sphere_mesh=net.sphere_mesh)
    graph.add("write_view", "view", panels=made.panels, path="view.html")
    return graph


def _quads() -> Graph:
    graph = Graph("Quads from a surface")
    length = graph.param("edge_length", 0.5, min=0.25, max=2)
    surface = graph.add("triangulated_surface", "surface", shape="bump", edge_length=0.15)
    graph.add("sphere_gain", "gain", mesh=surface.mesh, edge_length=length)
    net = graph.add("quad_pattern", "quads", mesh=surface.mesh, edge_length=length)
    made = graph.add("panels", "panels", sphere_mesh=net.sphere_mesh)
    graph.add("write_view", "view", panels=made.panels, path="view.html")
    return graph


def _cushions() -> Graph:
    graph = Graph("Target angle")
    angle = graph.param("angle", 12, min=0, max=40)
    mesh = graph.add("roof_mesh", "mesh", n_span=14, n_length=24)
    start = graph.add("fit_spheres", "start", mesh=mesh)
    optimum = graph.add(
        "minimize_angles", "optimum", sphere_mesh=start, target_angle=angle, sides="one"
    )
    graph.add("intersection_angles", "angles", sphere_mesh=optimum.sphere_mesh)
    made = graph.add("panels", "panels", sphere_mesh=optimum.sphere_mesh, edges="intersection")
    graph.add("write_view", "view", panels=made.panels, path="view.html")
    return graph


def _study() -> Graph:
    graph = Graph("Parameter study")
    counts: Param = graph.param("counts", [2, 4, 8, 16])
    mesh = graph.add("roof_mesh", "mesh")
    spheres = _optimum(graph, mesh)
    few = graph.add("cluster_radii", "moulds", sphere_mesh=spheres, k=each(counts))
    graph.add("angle_histogram", "angles", sphere_mesh=each(few.sphere_mesh))
    return graph


TEMPLATES: Final[Mapping[str, Template]] = {
    "moulds": Template(
        "Roof with moulds", "A station roof of 1,440 panels from six moulds.", _moulds,
        ("panels.panels",),
    ),
    "beams": Template(
        "Roof with beams", "Panels on upright beams with round nodes, ready for drawings.",
        _beams, ("beams.beams",),
    ),
    "hexagons": Template(
        "Hexagons", "A triangulated shell as convex hexagons on spheres.", _hexagons,
        ("panels.panels",),
    ),
    "quads": Template(
        "Quads from a surface", "Quads laid out along the curvature of a free surface.",
        _quads, ("panels.panels",),
    ),
    "angle": Template(
        "Target angle", "Cushions that meet at an angle of your choice.", _cushions,
        ("panels.panels",),
    ),
    "study": Template(
        "Parameter study", "One roof with 2, 4, 8 and 16 moulds side by side.", _study,
        ("moulds.sphere_mesh", "angles.result"),
    ),
}  # fmt: skip
