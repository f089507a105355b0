"""Reads the surfaces of a file, with their exact normals and curvatures."""

import math
import os
from pathlib import Path

from ...kernel.errors import InputError
from ...kernel.surfaces.row_counts import GridSize
from ..rhino.isolation import isolated
from ..rhino.surface_shapes import SurfaceContent, read_surfaces_3dm
from .file_bytes import check_kind, read_bytes
from .reader import mesh_suffix


def read_surface(
    path: str | os.PathLike[str],
    layer: str = "",
    n_u: int = 24,
    n_v: int = 24,
    edge_length: float | None = None,
) -> SurfaceContent:
    """The surfaces, polysurfaces and extrusions of a .3dm file, as a mesh with its shape.

    Parameters
    ----------
    path : path
        The file.
    layer : str
        Full path of a layer: only what is on it and on its sublayers; empty for all.
    n_u, n_v : int
        Rows of quads along u and v of each face.
    edge_length : float, optional
        Length of the edges, instead of numbers of rows; in model units.

    Returns
    -------
    SurfaceContent
        The surface, and what was left out.

    Raises
    ------
    InputError
        If it is no .3dm, cannot be read or holds no surface that can be meshed.
    """
    source = Path(path)
    if mesh_suffix(source, "read") != ".3dm":
        raise InputError(
            f"cannot read {source}: only a .3dm holds surfaces; read a mesh with read_mesh"
        )
    if min(n_u, n_v) < 1 or (edge_length is not None and not 0 < edge_length < math.inf):
        raise InputError("a surface needs at least one row of quads, and edges of some length")
    data = read_bytes(source)
    try:
        check_kind(data, ".3dm")
        return isolated(read_surfaces_3dm, data, layer, GridSize(n_u, n_v, edge_length))
    except InputError as error:
        raise InputError(f"cannot read {source}: {error}") from error
