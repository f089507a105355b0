"""Reads Rhino .3dm files: meshes with ngons, or grids on surfaces."""

import base64
from collections import Counter

import numpy as np

from ...kernel.arrays import IntArray
from ...kernel.errors import InputError
from ...kernel.tolerances import COINCIDENT
from ..opennurbs.mesh_ngons import read_mesh_object
from ..polygons import (
    FileContent,
    Polygons,
    drop_repeats,
    drop_unused,
    join_polygons,
    mean_side,
    transform_polygons,
    weld,
)
from .object_reader import RhinoObject, placed_objects
from .surface_reader import SURFACES, GridSize, sample_object

_GRID = GridSize(24, 24)


def read_3dm(data: bytes, layer: str = "", size: GridSize = _GRID) -> FileContent:
    """All the meshes in a .3dm file, joined; without meshes, grids on its surfaces.

    Parameters
    ----------
    data : bytes
        Content of the file.
    layer : str
        Full path of a layer, such as ``Roof::Panels``: read only what is on it and on its
        sublayers; empty reads all. Objects inside blocks are read wherever an instance
        stands, see `placed_objects`.
    size : GridSize
        Quads along u and v of each face of surfaces and polysurfaces.

    Returns
    -------
    FileContent
        Faces in the order of the objects and, within a mesh, of the file; an ngon stands
        where the first of its triangles and quads stood. Vertices closer than COINCIDENT
        mean sides are one, as separate and unwelded meshes repeat the vertices of their
        seams; vertices inside ngons are dropped.

    Raises
    ------
    InputError
        If the file cannot be read or holds neither meshes nor surfaces there; the message says
        what it holds.
    """
    import rhino3dm

    rhino: RhinoObject = rhino3dm
    model = rhino.File3dm.FromByteArray(data)
    if model is None:
        raise InputError("Rhino cannot read the file: it is damaged or no .3dm; save it again")
    objects = placed_objects(model, layer)
    meshes = [
        transform_polygons(_mesh_polygons(each.geometry), each.transform)
        for each in objects
        if isinstance(each.geometry, rhino.Mesh) and each.geometry.Faces.Count
    ]
    if meshes:
        return FileContent(_weld(meshes))
    grids = [
        grid
        for each in objects
        if type(each.geometry).__name__ in SURFACES
        for grid in sample_object(each.geometry, size, each.transform)
    ]
    if grids:
        found = drop_repeats(_weld(grids))
        if not len(found.degrees):
            raise InputError(
                f"{size.n_u} by {size.n_v} quads on surfaces have no area: ask for more"
            )
        return FileContent(found)
    kinds = Counter(type(each.geometry).__name__ for each in objects)
    held = ", ".join(f"{count} {kind}" for kind, count in kinds.items()) or "no objects"
    where = f"layer {layer!r}" if layer else "the file"
    raise InputError(
        f"{where} holds no meshes and no surfaces, but {held}; mesh them in Rhino (Mesh, "
        "QuadRemesh or ExtractRenderMesh) and save"
    )


def _weld(parts: list[Polygons]) -> Polygons:
    joined = drop_unused(join_polygons(parts))
    if joined.corners.max() >= len(joined.vertices) or not np.isfinite(joined.vertices).all():
        return joined
    vertices, ids = weld(joined.vertices, COINCIDENT * mean_side(joined))
    return Polygons(vertices, ids[joined.corners], joined.degrees)


def _mesh_polygons(mesh: RhinoObject) -> Polygons:
    vertices, faces, ngons = read_mesh_object(base64.b64decode(mesh.Encode()["data"]))
    degrees = np.where(faces[:, 2] == faces[:, 3], 3, 4)
    is_free = np.ones(len(faces), bool)
    boundaries: dict[int, IntArray] = {}
    for boundary, members in ngons:
        is_free[members] = False
        boundaries[int(members.min())] = boundary
    kept = [
        faces[i, : degrees[i]] if is_free[i] else boundaries[i]
        for i in sorted([*np.flatnonzero(is_free).tolist(), *boundaries])
    ]
    return Polygons(
        vertices, np.concatenate(kept), np.array([len(face) for face in kept], np.int64)
    )
