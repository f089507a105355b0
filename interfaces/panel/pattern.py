"""The pattern of the main job: from a design surface to the net that is panelled."""

from typing import Any, Final, NamedTuple

import click

from ...fabrication.mesh_files.surface_files import read_surface
from ...kernel.errors import InputError
from ...nodes.graphs.graph import Graph
from ...nodes.graphs.specification.wires import Step, Wire
from ...nodes.graphs.stores.entries import Store
from .options import PanelOptions

FINER: Final = 5.0
"""Edges of the mesh on a surface, as parts of those of the panels."""


_NODES: Final = {
    "quads": "quad_pattern", "hexagons": "hexagon_pattern", "triangles": "triangle_pattern",
}  # fmt: skip


class PatternSteps(NamedTuple):
    """What a pattern adds before the main job.

    Attributes
    ----------
    surface : Step or Wire
        The surface as a mesh, to show beside the result.
    net : Wire
        The net of spheres.
    mesh : Step
        The mesh under it.
    """

    surface: Step | Wire
    net: Wire
    mesh: Step


def has_surfaces(options: PanelOptions) -> bool:
    """Whether the file holds surfaces with an exact shape, and no mesh alone."""
    path = options.mesh
    if path is None or options.repair or path.suffix.lower() != ".3dm":
        return False
    try:
        read_surface(path.resolve(), options.layer, edge_length=options.edge_length)
    except InputError:  # a file of meshes, or one that read_mesh refuses with better words
        return False
    return True


def add_pattern(graph: Graph, options: PanelOptions) -> PatternSteps:
    """Add surface, expected gain, and net to a graph.

    Parameters
    ----------
    graph : Graph
        The main job, still empty.
    options : PanelOptions
        With a pattern and a length of edges.

    Returns
    -------
    PatternSteps
        What the rest of the job starts from.
    """
    length = graph.param("edge_length", options.edge_length, min=0)
    source, shown = _source(graph, options)
    graph.add("sphere_gain", "gain", mesh=source, edge_length=length)
    pattern = graph.add(
        _NODES[options.pattern], "pattern", mesh=source, edge_length=length, **_wishes(options)
    )
    mesh = graph.add("underlying_mesh", "net", sphere_mesh=pattern.sphere_mesh)
    return PatternSteps(shown, pattern.sphere_mesh, mesh)


def _wishes(options: PanelOptions) -> dict[str, Any]:
    """What the lines of quads follow; nothing for other patterns."""
    asked = {
        "direction": options.direction and list(options.direction),
        "density": options.density,
        "insist": options.insist,
    }
    return {name: value for name, value in asked.items() if value}


def _source(graph: Graph, options: PanelOptions) -> tuple[Step | Wire, Step | Wire]:
    """The surface as it is known best, and as a mesh."""
    if options.mesh is None:
        roof = graph.add("roof_mesh", "mesh")
        return roof, roof
    path = str(options.mesh.resolve())
    if has_surfaces(options) and options.edge_length is not None:
        fine = options.edge_length / FINER
        exact = graph.add(
            "read_surface", "mesh", path=path, layer=options.layer, edge_length=fine
        )
        return exact, graph.add("surface_fields", "fields", surface=exact).mesh
    if options.repair:
        mesh = graph.add("repair_mesh", "mesh", mesh=path, layer=options.layer).mesh
        return mesh, mesh
    read = graph.add("read_mesh", "mesh", path=path, layer=options.layer)
    return read, read


def say_gain(graph: Graph, store: Store) -> None:
    """Say on standard error what spheres will gain, before anything is made.

    Parameters
    ----------
    graph : Graph
        The main job with a pattern.
    store : Store
        Where the results stand that the job takes up again.
    """
    graph.cache = store
    found: dict[str, Any] = graph.run("gain.report")
    quads = found["quads"]
    click.echo(
        f"expected angle between neighbours: {quads['planes']:.2f} degrees with flat quads, "
        f"{quads['spheres']:.2f} with spheres, {quads['one_radius']:.2f} with one radius; "
        f"hexagons {found['hexagons']['spheres']:.2f}, triangles "
        f"{found['triangles']['spheres']:.2f}; {found['advice']}",
        err=True,
    )
