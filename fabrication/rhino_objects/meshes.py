"""Meshes of Rhino in JSON: faces with more than four corners are ngons."""

import struct
import zlib
from typing import Any

from ...kernel.errors import InputError
from ...kernel.meshes.mesh import Mesh
from ...kernel.tolerances import COINCIDENT
from ..opennurbs import stream_codes as codes
from ..opennurbs.mesh_ngons import read_mesh_object
from ..opennurbs.stream_reader import UnreadableError
from ..polygons import Polygons, drop_repeats, drop_unused, mean_side, to_mesh, weld
from ..rhino.mesh_writer import to_rhino_mesh
from ..rhino.object_polygons import content_polygons
from .fields import Fields, class_id, object_stream


def mesh_of_fields(fields: object) -> Mesh:
    """The mesh of an object in JSON.

    Parameters
    ----------
    fields : mapping
        A mesh of Rhino.

    Returns
    -------
    Mesh
        The same vertices and faces in their order, an ngon where the first of its parts stood;
        vertices that coincide, as in unwelded meshes, are one.

    Raises
    ------
    InputError
        If it is no mesh, is damaged, or no orientable manifold; the message says which faces.
    """
    stream = object_stream(fields)
    if class_id(stream) != codes.MESH:
        raise InputError("it is no mesh; let Grasshopper make one of it (Mesh Brep)")
    try:
        content = read_mesh_object(stream)
    except (UnreadableError, ValueError, IndexError, struct.error, zlib.error) as error:
        raise InputError(f"the mesh is damaged: {error}") from error
    if not len(content.faces):
        raise InputError("the mesh has no faces")
    return to_mesh(_welded(content_polygons(content)))


def _welded(polygons: Polygons) -> Polygons:
    used = drop_unused(polygons)
    vertices, ids = weld(used.vertices, COINCIDENT * mean_side(used))
    return drop_unused(drop_repeats(Polygons(vertices, ids[used.corners], used.degrees)))


def mesh_fields(mesh: Mesh) -> Fields:
    """A mesh as an object in JSON.

    Parameters
    ----------
    mesh : Mesh

    Returns
    -------
    dict
        With float64 vertices, and ngons for faces with more than four corners.

    Raises
    ------
    InputError
        If Rhino calls it invalid.
    """
    encoded: Any = to_rhino_mesh(mesh).Encode()
    return dict(encoded)
