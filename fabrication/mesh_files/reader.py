"""Reads mesh files: polygons in the order of the file; the suffix names the format.

The parsers of the usual formats are ours because a face is a panel and errors name lines:
trimesh cuts polygons into triangles; meshio 5.3.5 reads only triangles from OFF, mistakes
negative OBJ numbers, fails on ``vertex_index`` in PLY, and leaves the program when it cannot
read a file. Both serve for formats that few use.
"""

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from ...kernel.errors import InputError
from ...kernel.meshes.mesh import Mesh
from ..polygons import NO_SURFACES, FileContent, to_mesh
from ..rhino.reader import read_3dm
from ..rhino.surface_reader import GridSize
from .file_bytes import check_kind, read_bytes
from .obj import read_obj
from .off import read_off
from .other_formats import OTHER_SUFFIXES, read_other
from .ply import read_ply
from .stl import read_stl

_READERS: Final[dict[str, Callable[[bytes], FileContent]]] = {
    ".off": read_off,
    ".ply": read_ply,
    ".stl": read_stl,
}
SUFFIXES: Final = (".obj", *_READERS, ".3dm")
"""The formats of mesh files that are read and written, by suffix; capitals do."""


def read_mesh(
    path: str | os.PathLike[str],
    layer: str | Sequence[str] = "",
    n_u: int = 24,
    n_v: int = 24,
    edge_length: float | None = None,
) -> Mesh:
    """Read a mesh with faces of mixed degree: `read_content`, as a mesh.

    Surfaces of a .3dm are read as grids of quads whose vertices lie exactly on them.

    Parameters
    ----------
    path : path
        The file; its suffix names the format: OBJ, OFF, PLY, STL, Rhino .3dm, or one of
        `OTHER_SUFFIXES`.
    layer : str or sequence of str
        Read only a part of the file, several with commas. OBJ: the groups and objects of this
        name, or else whose name starts so. .3dm: the layer of this full path
        (``Roof::Panels``) with its sublayers. The other formats have no layers. Empty reads
        all.
    n_u, n_v : int
        Rows of quads along u and v of each face of surfaces and polysurfaces in a .3dm. Faces
        meet: where their numbers along a common edge differ, the larger holds.
    edge_length : float, optional
        Length of the edges there, instead of numbers of rows; in model units.

    Returns
    -------
    Mesh
        Faces in the order of the file. OBJ, OFF and PLY keep the vertex numbers of the file,
        unused vertices included, unless every face has vertices of its own; reading a layer
        keeps the vertices of its faces. STL and .3dm share coincident corners. Units are those
        of the file.

    Raises
    ------
    InputError
        If the file cannot be read or is no orientable manifold mesh; the message names the
        file, the line (of text files) or the faces, and what to do. Faces are never flipped.
    """
    return content_mesh(read_content(path, layer, n_u, n_v, edge_length), path)


def content_mesh(content: FileContent, path: str | os.PathLike[str]) -> Mesh:
    """What was read from a file, as a mesh.

    Parameters
    ----------
    path : path
        The file, for the message.

    Raises
    ------
    InputError
        If it is no orientable manifold mesh.
    """
    try:
        return to_mesh(content.polygons, content.sources)
    except InputError as error:
        raise InputError(f"cannot read {path}: {error}") from error


def read_content(
    path: str | os.PathLike[str],
    layer: str | Sequence[str] = "",
    n_u: int = 24,
    n_v: int = 24,
    edge_length: float | None = None,
) -> FileContent:
    """What a mesh file holds, whether or not it is a mesh; see `read_mesh`.

    Raises
    ------
    InputError
        If the file cannot be read; the message names the file, the line and what to do.
    MissingLibraryError
        If the format needs a library that is not installed.
    """
    source = Path(path)
    suffix = mesh_suffix(source, "read")
    if layer and suffix not in (".obj", ".3dm"):
        raise InputError(f"cannot read {source}: {suffix} files have no layers; drop {layer!r}")
    if min(n_u, n_v) < 1:
        raise InputError(f"a grid of {n_u} by {n_v} quads has no faces; ask for at least 1")
    if edge_length is not None and not 0 < edge_length < math.inf:
        raise InputError(f"the edge length must be positive, not {edge_length}")
    data = read_bytes(source)
    try:
        check_kind(data, suffix)
        if suffix == ".3dm":
            names = layer if isinstance(layer, str) else ",".join(layer)
            return read_3dm(data, names, GridSize(n_u, n_v, edge_length))
        if suffix == ".obj":
            content = read_obj(data, layer)
        elif suffix in _READERS:
            content = _READERS[suffix](data)
        else:
            content = read_other(source, suffix)
    except InputError as error:
        raise InputError(f"cannot read {source}: {error}") from error
    if edge_length is not None:
        content = replace(content, remarks=(*content.remarks, NO_SURFACES))
    return content


def mesh_suffix(path: Path, verb: str) -> str:
    """The format of a mesh file.

    Parameters
    ----------
    verb : str
        What is to be done with it, for the message.

    Returns
    -------
    str
        Its suffix, one of `SUFFIXES` or, to read, of `OTHER_SUFFIXES`.

    Raises
    ------
    InputError
        If it is a folder, no file can have that name, or the format is not known.
    """
    suffix = path.suffix.lower()
    known = (*SUFFIXES, *OTHER_SUFFIXES) if verb == "read" else SUFFIXES
    try:
        is_folder = path.is_dir()
    except (OSError, ValueError) as error:
        raise InputError(f"cannot {verb} {path}: {error}; check the path") from error
    if is_folder:
        raise InputError(f"cannot {verb} {path}: it is a folder; name a file in it")
    if suffix not in known:
        raise InputError(
            f"cannot {verb} {path}: {suffix or 'no suffix'} is not a mesh format; use one of "
            f"{', '.join(known)}"
        )
    return suffix
