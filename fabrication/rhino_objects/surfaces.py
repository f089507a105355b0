"""Reads surfaces and polysurfaces of Rhino in JSON with their normals and curvatures."""

from ...kernel.surfaces.row_counts import GridSize
from ...kernel.surfaces.surface import Surface
from ..rhino.isolation import isolated
from ..rhino.surface_shapes import surface_of_objects
from .fields import Fields, decoded_objects


def surface_of_fields(several: list[Fields], size: GridSize) -> Surface:
    """Surfaces, polysurfaces and extrusions in JSON as one surface.

    Parameters
    ----------
    several : list of dict
        At least one.
    size : GridSize
        Rows of faces on each, or the length of their edges.

    Returns
    -------
    Surface
        A mesh whose vertices lie on them, with exact normals and curvatures.

    Raises
    ------
    InputError
        If one is no surface, is damaged, or cannot be meshed; the message says why.
    """
    return isolated(_surface, several, size)


def _surface(several: list[Fields], size: GridSize) -> Surface:
    return surface_of_objects(decoded_objects(several), size)
