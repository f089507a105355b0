"""Graphs to start from, small enough to be read at a glance."""

from collections.abc import Callable, Mapping
from math import floor, log10
from typing import Final, NamedTuple

from ...nodes.graphs.graph import Graph
from ...nodes.graphs.specification.specification import Specification
from ...nodes.graphs.specification.wires import Param, Step, Wire, each


class Design(NamedTuple):
    """What a template begins with.

    Attributes
    ----------
    path : str
        A mesh file; empty for the mesh that the template has of its own.
    edge : float
        Mean edge of the mesh of that file: what lengths of the template are measured by.
    """

    path: str = ""
    edge: float = 1.0

    def length(self, own: float, share: float) -> float:
        """A length of the template: of its own mesh, or a share of an edge in round numbers."""
        if not self.path:
            return own
        length = share * self.edge
        return round(length, 1 - floor(log10(length)))


class Template(NamedTuple):
    """A graph to start from.

    Attributes
    ----------
    title, summary : str
    make : callable
        Gives the graph that begins with a design.
    pins : tuple of str
        Outputs that are shown at first.
    """

    title: str
    summary: str
    make: Callable[[Design], Graph]
    pins: tuple[str, ...]


_DEMO: Final = Design()


def template_graph(name: str, design: Design = _DEMO) -> Specification:
    """The graph of a template, with what it shows at first; KeyError if there is none."""
    from dataclasses import replace

    from ...nodes.graphs.specification.specification import frozen
    from .operations import CANVAS

    template = TEMPLATES[name]
    specification = template.make(design).specification
    return replace(specification, extra=frozen({CANVAS: {"pins": list(template.pins)}}))


def _mesh(graph: Graph, design: Design, **roof: int) -> Step:
    if design.path:
        return graph.add("read_mesh", "mesh", path=design.path)
    return graph.add("roof_mesh", "mesh", **roof)


def _surface(graph: Graph, design: Design, shape: str, edge_length: float) -> Step | Wire:
    if design.path:
        return graph.add("read_mesh", "mesh", path=design.path)
    made = graph.add("triangulated_surface", "surface", shape=shape, edge_length=edge_length)
    return made.mesh


def _slider(graph: Graph, name: str, value: float, low: float, high: float) -> Param:
    """A slider whose range, a multiple of its value, has round ends."""
    return graph.param(name, value, min=round(low * value, 9), max=round(high * value, 9))


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


def _moulds(design: Design) -> Graph:
    graph = Graph("Roof with moulds")
    thickness = _slider(graph, "thickness", design.length(0.02, 0.015), 0, 10)
    mesh = _mesh(graph, design)
    few = _few(graph, _optimum(graph, mesh), 6)
    made = graph.add(
        "panels", "panels", sphere_mesh=few.sphere_mesh, labels=few.labels, thickness=thickness
    )
    _writers(graph, made.panels)
    return graph


def _beams(design: Design) -> Graph:
    graph = Graph("Roof with beams")
    thickness = _slider(graph, "thickness", design.length(0.02, 0.008), 0, 10)
    depth = _slider(graph, "depth", design.length(0.25, 0.1), 0.2, 4)
    mesh = _mesh(graph, design, n_span=16, n_length=30)
    few = _few(graph, _optimum(graph, mesh), 6)
    held = graph.add("bisector_support", "annuli", sphere_mesh=few.sphere_mesh, depth=depth)
    made = graph.add(
        "panels", "panels", sphere_mesh=few.sphere_mesh, labels=few.labels,
        thickness=thickness, joint_gap=design.length(0.01, 0.004), edges="axis",
        axes=held.axes,
    )  # fmt: skip
    beams = graph.add(
        "beams", "beams", annuli=held.annuli, panels=made.panels,
        thickness=design.length(0.04, 0.016), node_radius=design.length(0.08, 0.032),
    )  # fmt: skip
    _writers(graph, made.panels, beams=beams.beams)
    graph.add("write_dxf", "drawing", beams=beams.beams, path="beams.dxf")
    return graph


def _hexagons(design: Design) -> Graph:
    graph = Graph("Hexagons")
    length = _slider(graph, "edge_length", design.length(0.35, 3), 0.5, 3)
    surface = _surface(graph, design, "ellipsoid", 0.12)
    net = graph.add(
        "hexagon_pattern", "hexagons", mesh=surface, edge_length=length, boundary="drop"
    )
    made = graph.add("panels", "panels", sphere_mesh=net.sphere_mesh)
    graph.add("classify_hexagons", "shapes", sphere_mesh=net.sphere_mesh)
    graph.add("write_view", "view", panels=made.panels, path="view.html")
    return graph


def _quads(design: Design) -> Graph:
    graph = Graph("Quads from a surface")
    length = _slider(graph, "edge_length", design.length(0.5, 3), 0.5, 4)
    surface = _surface(graph, design, "bump", 0.15)
    graph.add("sphere_gain", "gain", mesh=surface, edge_length=length)
    net = graph.add("quad_pattern", "quads", mesh=surface, edge_length=length)
    made = graph.add("panels", "panels", sphere_mesh=net.sphere_mesh)
    graph.add("write_view", "view", panels=made.panels, path="view.html")
    return graph


def _cushions(design: Design) -> Graph:
    graph = Graph("Target angle")
    angle = graph.param("angle", 12, min=0, max=40)
    mesh = _mesh(graph, design, n_span=14, n_length=24)
    start = graph.add("fit_spheres", "start", mesh=mesh)
    optimum = graph.add(
        "minimize_angles", "optimum", sphere_mesh=start, target_angle=angle, sides="one"
    )
    graph.add("intersection_angles", "angles", sphere_mesh=optimum.sphere_mesh)
    made = graph.add("panels", "panels", sphere_mesh=optimum.sphere_mesh, edges="intersection")
    graph.add("write_view", "view", panels=made.panels, path="view.html")
    return graph


def _study(design: Design) -> Graph:
    graph = Graph("Parameter study")
    counts: Param = graph.param("counts", [2, 4, 8, 16])
    mesh = _mesh(graph, design)
    spheres = _optimum(graph, mesh)
    few = graph.add("cluster_radii", "moulds", sphere_mesh=spheres, k=each(counts))
    graph.add("angle_histogram", "angles", sphere_mesh=each(few.sphere_mesh))
    return graph


TEMPLATES: Final[Mapping[str, Template]] = {
    "moulds": Template(
        "Roof with moulds", "Panels from six moulds, for a factory to press.", _moulds,
        ("panels.panels",),
    ),
    "beams": Template(
        "Roof with beams", "Panels from six moulds on upright beams with round nodes.",
        _beams, ("panels.panels", "beams.beams"),
    ),
    "hexagons": Template(
        "Hexagons", "A shell as convex hexagons on spheres.", _hexagons,
        ("panels.panels",),
    ),
    "quads": Template(
        "Quads from a surface", "Quads laid out along the curvature of a surface.",
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
