"""Writes mesh files; the suffix names the format."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Final

from ...kernel.errors import InputError
from ...kernel.meshes.mesh import Mesh
from ..files import replacing
from ..rhino.mesh_writer import write_mesh_3dm
from .obj import format_obj
from .off import format_off
from .ply import format_ply
from .reader import mesh_suffix
from .stl import format_stl

_FORMATTERS: Final[dict[str, Callable[[Mesh], bytes]]] = {
    ".obj": format_obj,
    ".off": format_off,
    ".ply": format_ply,
    ".stl": format_stl,
}


def write_mesh(mesh: Mesh, path: str | os.PathLike[str]) -> Path:
    """Write a mesh to an OBJ, OFF, PLY, STL or Rhino .3dm file.

    Parameters
    ----------
    path : path
        The suffix names the format. An older file is replaced once the new one is complete.

    Raises
    ------
    InputError
        If the suffix is not known or the file cannot be written.

    Notes
    -----
    Vertices keep all digits of float64 and faces their order and corners, except in STL: it
    holds triangles with float32 corners, so other faces are cut into triangles.
    """
    target = Path(path)
    suffix = mesh_suffix(target, "write")
    with replacing(target) as temporary:
        try:
            if suffix == ".3dm":
                write_mesh_3dm(mesh, temporary)
            else:
                temporary.write_bytes(_FORMATTERS[suffix](mesh))
        except InputError as error:
            raise InputError(f"cannot write {target}: {error}") from error
    return target
