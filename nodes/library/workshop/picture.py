"""Pictures of panels, beams and other things."""

from collections.abc import Sequence
from typing import Annotated, Literal

import numpy as np

from ....fabrication.files import check_suffix, replacing
from ....kernel.arrays import FloatArray
from ....kernel.beams.beams import Beams
from ....kernel.errors import InputError
from ....kernel.meshes.mesh import Mesh
from ....kernel.panels.panels import Panels
from ....kernel.parts.findings import Finding
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ....viewer.render import render_image
from ....viewer.shapes import Shape, axis_shape, edge_shape, mesh_shape, sphere_shape
from ...graphs.node import node
from ...graphs.ports import Port, WritePath
from ..arrays import VertexAxes, VertexSpheres

PICTURE_PIXELS = Annotated[int, Port(min=16, max=8000)]

SPHERE, MESH = (146, 178, 206), (214, 210, 198)
"""Colours of whole spheres and of meshes."""

LINE = 0.0016
"""Radius of lines, in sizes of the things."""


@node(version="2")
def render(  # noqa: PLR0913 - a node has an input per choice
    panels: Panels | None = None,
    path: WritePath = "picture.png",
    color_by: Literal[
        "mould", "radius", "angle", "area", "planarity", "tilt", "convexity", "finding", "none"
    ] = "mould",
    shading: Literal["studio", "zebra", "lamps", "mirror"] = "studio",
    width: PICTURE_PIXELS = 1600,
    height: PICTURE_PIXELS = 1000,
    *,
    legend: bool | None = None,
    beams: Beams | None = None,
    findings: Sequence[Finding] = (),
    mesh: Mesh | None = None,
    spheres: SphereMesh | VertexSpheres | None = None,
    axes: VertexAxes | None = None,
    view: Literal["home", "front", "back", "left", "right", "top", "below"] = "home",
    eye: tuple[float, float, float] | None = None,
    target: tuple[float, float, float] | None = None,
    edges: bool = True,
    ground: bool = True,
) -> str:
    """Draw panels, beams and other things into a PNG, exact and without a graphics card.

    Parameters
    ----------
    panels : Panels, optional
        The panels; these or anything else to draw are needed.
    path : path
        Ends in .png.
    color_by : str
        What the colours of panels mean: their mould, radius (red outwards, blue inwards),
        largest angle at their edges, area, how far corners are off a plane, tilt of their
        walls, whether all corners are convex, what an audit found; or nothing.
    shading : {"studio", "zebra", "lamps", "mirror"}
        Daylight; or what polished panels mirror, which shows how smooth the surface is:
        stripes, a few long lamps, or a sky over houses.
    width, height : int
        Size in pixels.
    legend : bool, optional
        Whether to say beside the picture what the colours mean; by default where they mean
        something.
    beams : Beams, optional
        Drawn with their node cylinders if they have any.
    findings : sequence of Finding, optional
        What the node `audit` found, for colours: errors red, notes amber.
    mesh : Mesh, optional
        Drawn with flat faces and its edges: a design, an envelope, a mesh of centres.
    spheres : SphereMesh or (V, 5) float array, optional
        Drawn whole, as spheres that one sees through.
    axes : (V, 2, 3) float array, optional
        Node axes, drawn as lines.
    view : str
        From where: ``home`` is from above, onto the long side.
    eye, target : (float, float, float), optional
        Where the viewer stands, in place of a view, and what is looked at; by default the
        middle.
    edges : bool
        Whether edges of panels and of the mesh are drawn as lines.
    ground : bool
        Whether there is a ground with shadows below.

    Returns
    -------
    str
        The path.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from spheremesh.nodes import fit_spheres, panels, render, vase_mesh
    >>> made = panels(fit_spheres(vase_mesh(12, 6)))
    >>> with TemporaryDirectory() as folder:
    ...     render(made.panels, f"{folder}/vase.png", width=64, height=40).endswith("vase.png")
    True
    """
    check_suffix(path, ".png")
    if eye is not None and view != "home":
        raise InputError("a picture has a view or an eye, not both: leave one out")
    image = render_image(
        panels,
        beams=beams,
        things=_things(mesh, spheres, axes, panels, edges=edges),
        color_by=color_by,
        findings=findings,
        shading=shading,
        direction=None if eye is not None else view,
        eye=eye,
        target=target,
        width=width,
        height=height,
        legend=legend,
        edges=edges,
        ground=ground,
    )
    with replacing(path) as temporary:
        # More would save a tenth of the size for twice the time.
        image.save(temporary, format="PNG", compress_level=3)
    return str(path)


def _things(
    mesh: Mesh | None,
    spheres: SphereMesh | FloatArray | None,
    axes: FloatArray | None,
    panels: Panels | None,
    *,
    edges: bool,
) -> list[Shape]:
    found: list[Shape] = []
    if mesh is not None:
        found.append(mesh_shape(mesh, MESH))
    if spheres is not None:
        rows = spheres.spheres if isinstance(spheres, SphereMesh) else spheres
        found.append(sphere_shape(rows, SPHERE, is_veil=True))
    points = [shape.points + shape.origin for shape in found]
    if panels is not None:
        points.append(panels.origins)
    if axes is not None:
        points.append(axes.reshape(-1, 3))
    radius = LINE * float(np.ptp(np.concatenate(points), axis=0).max()) if points else 0.0
    if mesh is not None and edges:
        found.append(edge_shape(mesh, radius))
    if axes is not None:
        found.append(axis_shape(axes, radius))
    return found
