"""Pictures of panels on their beams."""

from typing import Annotated

from ....fabrication.files import check_suffix, replacing
from ....kernel.beams.beams import Beams
from ....kernel.panels.panels import Panels
from ....viewer.assembly import assembly_image
from ...graphs.node import node
from ...graphs.ports import Port, WritePath


@node
def render_assembly(
    panels: Panels,
    beams: Beams,
    path: WritePath,
    direction: tuple[float, float, float] = (0.6, -0.8, -0.7),
    near: int | None = None,
    width: Annotated[int, Port(min=16, max=8000)] = 1600,
    height: Annotated[int, Port(min=16, max=8000)] = 1000,
) -> str:
    """Draw panels and beams together into a PNG, from below or near a node.

    Parameters
    ----------
    panels : Panels
    beams : Beams
        Their node cylinders are drawn with them.
    path : path
        Ends in .png.
    direction : (float, float, float)
        Towards the viewer; below the model by default.
    near : int, optional
        Vertex of the mesh whose node is to fill the picture; by default all is seen.
    width, height : int
        Size in pixels.

    Returns
    -------
    str
        The path.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from spheremesh.nodes import axis_support, beams, fit_spheres, panels, render_assembly
    >>> from spheremesh.nodes import vase_mesh
    >>> spheres = fit_spheres(vase_mesh(12, 6))
    >>> annuli, axes, _ = axis_support(spheres)
    >>> cut, made = panels(spheres, edges="axis", axes=axes), beams(annuli)
    >>> with TemporaryDirectory() as folder:
    ...     path = render_assembly(cut.panels, made.beams, f"{folder}/vase.png", width=64)
    ...     path.endswith("vase.png")
    True
    """
    check_suffix(path, ".png")
    image = assembly_image(panels, beams, direction, near, width, height)
    with replacing(path) as temporary:
        image.save(temporary, format="PNG", optimize=True)
    return str(path)
