"""Pictures of panels on their beams: from below, where beams are seen, or near a node."""

from collections.abc import Sequence

import numpy as np
from PIL import Image

from ..kernel.arrays import FloatArray, norm
from ..kernel.beams.beams import Beams
from ..kernel.errors import InputError
from ..kernel.panels.panels import Panels
from .render import render_image

REACH = 0.3
"""Share of the longest beam of a node that is seen around it."""


def assembly_image(
    panels: Panels,
    beams: Beams,
    direction: Sequence[float] = (0.6, -0.8, -0.7),
    near: int | None = None,
    width: int = 1600,
    height: int = 1000,
) -> Image.Image:
    """A picture of panels and beams together.

    Parameters
    ----------
    panels : Panels
        The panels, with or without thickness.
    beams : Beams
        The beams, and their node cylinders if they have any.
    direction : sequence of float
        Towards the viewer; below the model by default.
    near : int, optional
        Vertex of the mesh whose node is to fill the picture; by default all is seen.
    width, height : int
        Size in pixels.

    Returns
    -------
    Image
        The picture.

    Raises
    ------
    InputError
        If the direction is no direction, or no beam ends at the vertex.
    """
    return render_image(
        panels,
        beams=beams,
        color_by="none",
        direction=direction,
        frame=None if near is None else _around(beams, near),
        width=width,
        height=height,
        ground=near is None,
    )


def _around(beams: Beams, vertex: int) -> FloatArray:
    """Corners of a box, in model coordinates, that a picture of a node has to hold."""
    annuli = beams.annuli
    rows, ends = np.nonzero(annuli.edge_vertices == vertex)
    if len(rows) == 0:
        raise InputError(f"no beam ends at vertex {vertex}: name a vertex that carries beams")
    tops = annuli.corners[rows, ends] + annuli.origins[rows][:, None]
    lengths = norm(annuli.corners[rows, 1 - ends] - annuli.corners[rows, ends])
    box = np.stack(np.meshgrid(*[[-1.0, 1.0]] * 3), -1).reshape(-1, 3)
    reach: FloatArray = tops.mean(axis=(0, 1)) + REACH * float(lengths.max()) * box
    return reach
