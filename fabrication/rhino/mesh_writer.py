"""Writes meshes as objects of Rhino: faces with more than four corners are ngons."""

import base64
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any, cast

import numpy as np

from ...kernel.errors import InputError
from ...kernel.meshes.mesh import Mesh
from ..opennurbs.mesh_ngons import insert_ngons
from ..triangles import fan_triangles
from .object_reader import RhinoObject


def write_mesh_3dm(mesh: Mesh, path: Path) -> None:
    """Write a mesh into a .3dm file; faces with more than four corners become ngons.

    Parameters
    ----------
    path : Path
        It has float64 vertices, one layer and no units.

    Raises
    ------
    InputError
        If Rhino calls the mesh invalid or cannot write the file.
    """
    import rhino3dm

    rhino: RhinoObject = rhino3dm
    ngon_mesh = to_rhino_mesh(mesh)
    model = rhino.File3dm()
    # A mesh has no units: Rhino must not scale it as if it were in millimetres.
    model.Settings.ModelUnitSystem = getattr(rhino.UnitSystem, "None")
    model.Layers.AddLayer("Mesh", (0, 0, 0, 255))
    model.Objects.AddMesh(ngon_mesh)
    if not model.Write(str(path), 8):
        raise InputError("rhino3dm cannot write the file; check the disk")


def to_rhino_mesh(mesh: Mesh) -> RhinoObject:
    """A mesh as an object of rhino3dm.

    Parameters
    ----------
    mesh : Mesh
        Faces with more than four corners become ngons.

    Returns
    -------
    rhino3dm.Mesh
        With float64 vertices.

    Raises
    ------
    InputError
        If Rhino calls it invalid.
    """
    import rhino3dm

    result = _with_faces(cast("RhinoObject", rhino3dm), mesh)
    is_valid, reason = result.IsValidWithLog
    if not is_valid:
        raise InputError(
            f"Rhino calls the mesh invalid ({' '.join(reason.split())}); write .obj"
        )
    return result


def _with_faces(rhino: RhinoObject, mesh: Mesh) -> RhinoObject:
    plain = rhino.Mesh()
    add_vertex, add_face = plain.Vertices.AddPoint3d, plain.Faces.AddFace
    for x, y, z in mesh.vertices.tolist():
        add_vertex(x, y, z)
    triangles, owners = fan_triangles(mesh)
    fans: Iterator[list[int]] = iter(triangles[mesh.degrees[owners] > 4].tolist())
    ngons: list[list[int]] = []
    n_parts = 0
    for face in np.split(mesh.corners, mesh.offsets[1:-1]):
        corners: list[int] = face.tolist()
        parts = [corners] if len(corners) <= 4 else list(islice(fans, len(corners) - 2))
        for part in parts:
            add_face(*part)
        if len(corners) > 4:
            members = range(n_parts, n_parts + len(parts))
            ngons.append([len(corners), len(parts), *corners, *members])
        n_parts += len(parts)
    if not ngons:
        return plain
    fields: dict[str, Any] = plain.Encode()
    stream = insert_ngons(base64.b64decode(fields["data"]), ngons)
    return rhino.CommonObject.Decode({**fields, "data": base64.b64encode(stream).decode()})
