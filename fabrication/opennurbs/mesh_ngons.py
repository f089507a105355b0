"""Meshes with ngons in the stream of `ON_Mesh`: rhino3dm gives no other access to ngons.

Follows `ON_Mesh::Read` and `ON_Mesh::Write` (`opennurbs_mesh.cpp`).
"""

import struct
import zlib
from collections.abc import Sequence
from io import SEEK_CUR, BytesIO
from itertools import chain
from typing import NamedTuple

import numpy as np

from ...kernel.arrays import FloatArray, IntArray
from .stream_codes import ANONYMOUS, CHUNK_HEADER, CLASS, CLASS_DATA

_CLASS_DATA_START = 44
"""After the head of the class chunk (12 bytes) and the chunk of its id (12 + 16 + 4)."""


class MeshContent(NamedTuple):
    """What a mesh of openNURBS holds.

    Vertices (V, 3), as exact as they are there; faces (F, 4), in which a triangle repeats its
    last corner; of each ngon the vertices around it, and its faces.
    """

    vertices: FloatArray
    faces: IntArray
    ngons: list[tuple[IntArray, IntArray]]


def read_mesh_object(encoded: bytes) -> MeshContent:
    """Vertices, faces and ngons of an `ON_Mesh`, as openNURBS encodes it."""
    stream = BytesIO(_class_data(encoded))
    vertices, faces = _read_to_ngons(stream)
    ngons = _read_ngons(stream) if stream.read(1) == b"\x01" else []
    if stream.read(1) == b"\x01":
        stream.seek(CHUNK_HEADER.size + 8 + 4, SEEK_CUR)
        vertices = np.frombuffer(_read_buffer(stream), "<f8").reshape(-1, 3)
    return MeshContent(np.asarray(vertices, np.float64), faces, ngons)


def insert_ngons(encoded: bytes, ngons: Sequence[Sequence[int]]) -> bytes:
    """Give a mesh ngons: a chunk of version 1.0 with their count and the ngons.

    The `ON_Mesh` has none yet; an ngon is the number of its corners and of its faces, its
    corners, its faces.
    """
    data = _class_data(encoded)
    before = BytesIO(data)
    _read_to_ngons(before)
    flag = before.tell()
    block = np.array([1, 0, len(ngons), *chain.from_iterable(ngons)], "<i4").tobytes()
    data = data[:flag] + b"\x01" + _chunk(ANONYMOUS, block) + data[flag + 1 :]
    _, old_size = CHUNK_HEADER.unpack_from(encoded, _CLASS_DATA_START)
    end = _CLASS_DATA_START + CHUNK_HEADER.size + old_size
    head = encoded[CHUNK_HEADER.size : _CLASS_DATA_START]
    body = head + _chunk(CLASS_DATA, data) + encoded[end:]
    return CHUNK_HEADER.pack(CLASS, len(body)) + body


def _class_data(encoded: bytes) -> bytes:
    """What ON_Mesh::Write wrote."""
    _, size = CHUNK_HEADER.unpack_from(encoded, _CLASS_DATA_START)
    start = _CLASS_DATA_START + CHUNK_HEADER.size
    return encoded[start : start + size - 4]


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
    _, size = CHUNK_HEADER.unpack(stream.read(CHUNK_HEADER.size))
    stream.seek(size, SEEK_CUR)


def _read_buffer(stream: BytesIO) -> bytes:
    """A buffer that is deflated when that pays: size, CRC, method, bytes."""
    size = _read_int(stream)
    if size == 0:
        return b""
    stream.seek(4, SEEK_CUR)
    if stream.read(1) == b"\x00":
        return stream.read(size)
    _, chunk_size = CHUNK_HEADER.unpack(stream.read(CHUNK_HEADER.size))
    return zlib.decompress(stream.read(chunk_size)[:-4])


def _read_ngons(stream: BytesIO) -> list[tuple[IntArray, IntArray]]:
    """Boundary vertices and faces of each ngon."""
    _, size = CHUNK_HEADER.unpack(stream.read(CHUNK_HEADER.size))
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


def _chunk(code: int, data: bytes) -> bytes:
    data += zlib.crc32(data).to_bytes(4, "little")
    return CHUNK_HEADER.pack(code, len(data)) + data
