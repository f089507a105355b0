"""Meshes with ngons, and grids on surfaces, in Rhino .3dm files."""

import base64
import struct
import zlib
from collections import Counter
from collections.abc import Iterator
from io import SEEK_CUR, BytesIO
from itertools import chain, islice
from pathlib import Path
from typing import Any, cast

import numpy as np

from ...kernel.arrays import FloatArray, IntArray
from ...kernel.errors import InputError
from ...kernel.meshes.mesh import Mesh
from ...kernel.tolerances import COINCIDENT
from ..polygons import (
    Polygons,
    drop_repeats,
    drop_unused,
    join_polygons,
    mean_side,
    transform_polygons,
    weld,
)
from ..triangles import fan_triangles
from .objects import RhinoObject, placed_objects
from .surfaces import SURFACES, GridSize, sample_object

_GRID = GridSize(24, 24)

_CHUNK = struct.Struct("<Iq")
_CLASS, _CLASS_DATA, _ANONYMOUS = 0x00027FFA, 0x0002FFFC, 0x40008000
_CLASS_DATA_START = 44
"""After the head of the class chunk (12 bytes) and the chunk of its id (12 + 16 + 4)."""


def read_3dm(data: bytes, layer: str = "", size: GridSize = _GRID) -> Polygons:
    """
    Polygons of all the meshes in a .3dm file, joined; without meshes, grids on its surfaces.

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
    Polygons
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
    rhino = _rhino3dm()
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
        return _weld(meshes)
    grids = [
        transform_polygons(grid, each.transform)
        for each in objects
        if type(each.geometry).__name__ in SURFACES
        for grid in sample_object(each.geometry, size)
    ]
    if grids:
        found = drop_repeats(_weld(grids))
        if not len(found.degrees):
            raise InputError(
                f"{size.n_u} by {size.n_v} quads on surfaces have no area: ask for more"
            )
        return found
    kinds = Counter(type(each.geometry).__name__ for each in objects)
    held = ", ".join(f"{count} {kind}" for kind, count in kinds.items()) or "no objects"
    where = f"layer {layer!r}" if layer else "the file"
    raise InputError(
        f"{where} holds no meshes and no surfaces, but {held}; mesh them in Rhino (Mesh, "
        "QuadRemesh or ExtractRenderMesh) and save"
    )


def _rhino3dm() -> RhinoObject:
    import rhino3dm

    return cast("RhinoObject", rhino3dm)


def _weld(parts: list[Polygons]) -> Polygons:
    joined = drop_unused(join_polygons(parts))
    if joined.corners.max() >= len(joined.vertices) or not np.isfinite(joined.vertices).all():
        return joined
    vertices, ids = weld(joined.vertices, COINCIDENT * mean_side(joined))
    return Polygons(vertices, ids[joined.corners], joined.degrees)


def _mesh_polygons(mesh: RhinoObject) -> Polygons:
    return _read_mesh(_class_data(base64.b64decode(mesh.Encode()["data"])))


def _class_data(encoded: bytes) -> bytes:
    """What ON_Mesh::Write wrote: rhino3dm gives no other access to ngons."""
    _, size = _CHUNK.unpack_from(encoded, _CLASS_DATA_START)
    start = _CLASS_DATA_START + _CHUNK.size
    return encoded[start : start + size - 4]


def _read_mesh(data: bytes) -> Polygons:
    """Follow ON_Mesh::Read (openNURBS, opennurbs_mesh.cpp)."""
    stream = BytesIO(data)
    vertices, faces = _read_to_ngons(stream)
    ngons = _read_ngons(stream) if stream.read(1) == b"\x01" else []
    if stream.read(1) == b"\x01":
        stream.seek(_CHUNK.size + 8 + 4, SEEK_CUR)
        vertices = np.frombuffer(_read_buffer(stream), "<f8").reshape(-1, 3)
    return _polygons(np.asarray(vertices, np.float64), faces, ngons)


def _read_to_ngons(stream: BytesIO) -> tuple[FloatArray, IntArray]:
    """Float32 vertices and quads (a triangle repeats its last corner); stop at the ngons."""
    stream.seek(1)
    n_faces: int = struct.unpack("<2i", stream.read(8))[1]
    # texture and surface domains, surface scale, three bounding boxes, whether it is closed
    stream.seek(64 + 16 + 64 + 4, SEEK_CUR)
    for _ in range(5):  # mesh parameters, four curvature statistics
        if stream.read(1) == b"\x01":
            _skip_chunk(stream)
    size = _read_int(stream)
    faces = np.frombuffer(stream.read(4 * size * n_faces), f"<u{size}").reshape(-1, 4)
    vertices = np.frombuffer(_read_buffer(stream), "<f4").reshape(-1, 3)
    for _ in range(4):  # normals, texture coordinates, curvatures, colours
        _read_buffer(stream)
    stream.seek(4 + 16, SEEK_CUR)  # texture rotation, mapping id
    _read_buffer(stream)  # surface parameters
    _skip_chunk(stream)  # mapping tag
    stream.seek(3, SEEK_CUR)  # whether it is manifold, oriented, solid
    return vertices.astype(np.float64), faces.astype(np.int64)


def _read_int(stream: BytesIO) -> int:
    return int.from_bytes(stream.read(4), "little", signed=True)


def _skip_chunk(stream: BytesIO) -> None:
    _, size = _CHUNK.unpack(stream.read(_CHUNK.size))
    stream.seek(size, SEEK_CUR)


def _read_buffer(stream: BytesIO) -> bytes:
    """A buffer that is deflated when that pays: size, CRC, method, bytes."""
    size = _read_int(stream)
    if size == 0:
        return b""
    stream.seek(4, SEEK_CUR)
    if stream.read(1) == b"\x00":
        return stream.read(size)
    _, chunk_size = _CHUNK.unpack(stream.read(_CHUNK.size))
    return zlib.decompress(stream.read(chunk_size)[:-4])


def _read_ngons(stream: BytesIO) -> list[tuple[IntArray, IntArray]]:
    """Boundary vertices and faces of each ngon."""
    _, size = _CHUNK.unpack(stream.read(_CHUNK.size))
    values = np.frombuffer(stream.read(size)[:-4], "<i4").astype(np.int64)
    at = 3  # after the version of the chunk and the count
    ngons: list[tuple[IntArray, IntArray]] = []
    for _ in range(int(values[2])):
        n_vertices = int(values[at])
        if n_vertices == 0:
            at += 1
            continue
        n_faces = int(values[at + 1])
        boundary, faces = at + 2, at + 2 + n_vertices
        at = faces + n_faces
        ngons.append((values[boundary:faces], values[faces:at]))
    return ngons


def _polygons(
    vertices: FloatArray, faces: IntArray, ngons: list[tuple[IntArray, IntArray]]
) -> Polygons:
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


def write_3dm(mesh: Mesh, path: Path) -> None:
    """
    Write a mesh into a .3dm file; faces with more than four corners become ngons.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    path : Path
        File to write; it has float64 vertices, one layer and no units.

    Raises
    ------
    InputError
        If Rhino calls the mesh invalid or cannot write the file.
    """
    rhino = _rhino3dm()
    ngon_mesh = to_rhino_mesh(mesh)
    model = rhino.File3dm()
    # A mesh has no units: Rhino must not scale it as if it were in millimetres.
    model.Settings.ModelUnitSystem = getattr(rhino.UnitSystem, "None")
    model.Layers.AddLayer("Mesh", (0, 0, 0, 255))
    model.Objects.AddMesh(ngon_mesh)
    if not model.Write(str(path), 8):
        raise InputError("rhino3dm cannot write the file; check the disk")


def to_rhino_mesh(mesh: Mesh) -> RhinoObject:
    """
    A mesh as an object of rhino3dm.

    Parameters
    ----------
    mesh : Mesh
        The mesh; faces with more than four corners become ngons.

    Returns
    -------
    rhino3dm.Mesh
        The object, with float64 vertices.

    Raises
    ------
    InputError
        If Rhino calls it invalid.
    """
    rhino = _rhino3dm()
    result = _with_faces(rhino, mesh)
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
    return _with_ngons(rhino, plain, ngons) if ngons else plain


def _with_ngons(rhino: RhinoObject, mesh: RhinoObject, ngons: list[list[int]]) -> RhinoObject:
    """Follow ON_Mesh::Write: a flag, and a chunk with version 1.0, the count and the ngons."""
    fields: dict[str, Any] = mesh.Encode()
    encoded = base64.b64decode(fields["data"])
    data = _class_data(encoded)
    before = BytesIO(data)
    _read_to_ngons(before)
    flag = before.tell()
    block = np.array([1, 0, len(ngons), *chain.from_iterable(ngons)], "<i4").tobytes()
    data = data[:flag] + b"\x01" + _chunk(_ANONYMOUS, block) + data[flag + 1 :]
    _, old_size = _CHUNK.unpack_from(encoded, _CLASS_DATA_START)
    end = _CLASS_DATA_START + _CHUNK.size + old_size
    body = encoded[_CHUNK.size : _CLASS_DATA_START] + _chunk(_CLASS_DATA, data) + encoded[end:]
    encoded = _CHUNK.pack(_CLASS, len(body)) + body
    return rhino.CommonObject.Decode({**fields, "data": base64.b64encode(encoded).decode()})


def _chunk(code: int, data: bytes) -> bytes:
    data += zlib.crc32(data).to_bytes(4, "little")
    return _CHUNK.pack(code, len(data)) + data
