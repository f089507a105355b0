"""Meshes with ngons in the stream of `ON_Mesh`: rhino3dm gives no other access to ngons.

Follows `ON_Mesh::Read` and `ON_Mesh::Write` (`opennurbs_mesh.cpp`).
"""

import zlib
from collections.abc import Sequence
from itertools import chain
from typing import NamedTuple

import numpy as np

from ...kernel.arrays import FloatArray, IntArray
from .stream_codes import ANONYMOUS, CHUNK_HEADER, CLASS, CLASS_DATA
from .stream_reader import StreamReader, UnreadableError, buffer_content

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
    reader = StreamReader(_class_data(encoded))
    vertices, faces = _read_to_ngons(reader)
    ngons = _read_ngons(reader) if reader.data[reader.take(1)] == 1 else []
    if reader.data[reader.take(1)] == 1:
        with reader.chunk(ANONYMOUS):
            reader.ints(3)
            vertices = np.frombuffer(_content(reader), "<f8").reshape(-1, 3)
    return MeshContent(np.asarray(vertices, np.float64), faces, ngons)


def insert_ngons(encoded: bytes, ngons: Sequence[Sequence[int]]) -> bytes:
    """Give a mesh ngons: a chunk of version 1.0 with their count and the ngons.

    The `ON_Mesh` has none yet; an ngon is the number of its corners and of its faces, its
    corners, its faces.
    """
    data = _class_data(encoded)
    before = StreamReader(data)
    _read_to_ngons(before)
    flag = before.position
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


def _read_to_ngons(reader: StreamReader) -> tuple[FloatArray, IntArray]:
    """Float32 vertices and quads (a triangle repeats its last corner); stop at the ngons."""
    reader.take(1)
    _, n_faces = reader.ints(2)
    # texture and surface domains, surface scale, three bounding boxes, whether it is closed
    reader.take(64 + 16 + 64 + 4)
    for _ in range(5):  # mesh parameters, four curvature statistics
        if reader.data[reader.take(1)] == 1:
            reader.skip_chunk()
    (size,) = reader.ints(1)
    if size not in (1, 2, 4):
        raise UnreadableError(f"vertex ids of {size} bytes")
    place = reader.take(4 * size * n_faces)
    faces = np.frombuffer(reader.data, f"<u{size}", 4 * n_faces, place).reshape(-1, 4)
    vertices = np.frombuffer(_content(reader), "<f4").reshape(-1, 3)
    for _ in range(4):  # normals, texture coordinates, curvatures, colours
        reader.buffer()
    reader.take(4 + 16)  # texture rotation, mapping id
    reader.buffer()  # surface parameters
    reader.skip_chunk()  # mapping tag
    reader.take(3)  # whether it is manifold, oriented, solid
    return vertices.astype(np.float64), faces.astype(np.int64)


def _content(reader: StreamReader) -> bytes:
    return buffer_content(reader.data, reader.buffer())


def _read_ngons(reader: StreamReader) -> list[tuple[IntArray, IntArray]]:
    """Boundary vertices and faces of each ngon."""
    ngons: list[tuple[IntArray, IntArray]] = []
    with reader.chunk(ANONYMOUS):
        _, _, count = reader.ints(3)
        for _ in range(count):
            (n_vertices,) = reader.ints(1)
            if n_vertices:
                (n_faces,) = reader.ints(1)
                parts = reader.ints(n_vertices), reader.ints(n_faces)
                ngons.append((np.array(parts[0], np.int64), np.array(parts[1], np.int64)))
    return ngons


def _chunk(code: int, data: bytes) -> bytes:
    data += zlib.crc32(data).to_bytes(4, "little")
    return CHUNK_HEADER.pack(code, len(data)) + data
