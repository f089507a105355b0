"""Render meshes of panels and beams as openNURBS objects, for viewers that cannot mesh solids.

They are written into the streams of Breps and extrusions: the setters of rhino3dm crash it at
exit. Layout of `ON_Mesh` 3.8 (`opennurbs_mesh.cpp`): ii counts of vertices and faces, domains
that are not set, three empty boxes of floats, i -1, flags, faces of four indices each (a
triangle repeats its last), buffers of float32 vertices and normals, empty buffers, the tag of
no texture mapping, and a chunk with the vertices as float64, if that is needed.

An extrusion keeps meshes in a chunk of version 1.0 (`ON_MeshCache`): for each a byte 1 and a
chunk of version 1.0 with an id that says what it is for and the mesh; in the end a byte 0.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, norm
from ...kernel.beams.triangles import BeamTriangles
from ...kernel.panels.panels import Panels
from ...kernel.panels.tessellation import tessellate
from ...kernel.tolerances import SINGLE_EPSILON, SINGLE_IS_ENOUGH
from .stream_codes import ANONYMOUS, CHUNK_HEADER, MESH, MESH_VERSION
from .stream_writer import (
    Chunk,
    Piece,
    PlainBuffer,
    Slot,
    class_object,
    doubles,
    encode,
    fill,
    ints,
)

_UNSET_DOMAINS = doubles(*[-1.23432101234321e308] * 8) + bytes(16)
MESH_TOLERANCE: Final = 0.004
"""Largest distance of a render mesh from its surface, relative to the radius of the piece."""

_RENDER_MESH: Final = bytes.fromhex("a9bae3f5a2a7fd49b8a166eb274a5f91")
_AROUND_CACHE: Final = (0, 44, 56)
"""Where the chunks around the meshes of an extrusion begin: class, its data, extrusion."""

_EMPTY_BOXES = np.array([*[1, 1, 1, -1, -1, -1] * 2, 1, 1, -1, -1], "<f4").tobytes()
_IDENTITY = doubles(*np.eye(4).ravel().tolist())


@dataclass(frozen=True)
class RenderMeshes:
    """Triangles of panels or beams, those of the same triangulation together.

    Vertices are written as float64 too where the model lies so far from the origin that float32
    would show.
    """

    kinds: IntArray  # (P,) triangulation of each piece
    triangles: tuple[IntArray, ...]  # (T, 3) each, counter-clockwise about the normals
    starts: IntArray  # (P,) first vertex of each piece; its triangulation tells how many
    points: FloatArray  # (N, 3) vertices on the surfaces, in model coordinates
    normals: FloatArray  # (N, 3) exact unit normals there
    has_doubles: bool


def panel_meshes(panels: Panels, tolerance: float) -> RenderMeshes:
    """Triangulate the outer faces of panels, a mesh each.

    The tolerance is the largest distance of a triangle from its sphere, relative to the radius
    of the panel.
    """
    pieces = tessellate(panels, tolerance, solid=False)
    order = np.argsort(pieces.panels, kind="stable")
    triangles = pieces.triangles[order]
    bounds = np.searchsorted(pieces.panels[order], np.arange(panels.n_panels + 1)).tolist()
    known: dict[bytes, int] = {}
    kinds: list[int] = []
    starts: list[int] = []
    for first, last in pairwise(bounds):
        own = triangles[first:last]
        starts.append(int(own.min()))
        kinds.append(known.setdefault((own - starts[-1]).tobytes(), len(known)))
    shapes = tuple(np.frombuffer(each, np.int64).reshape(-1, 3) for each in known)
    points = pieces.points + pieces.origin
    sizes = np.maximum.reduceat(norm(panels.corners), panels.offsets[:-1])
    has_doubles = _needs_doubles(points, tolerance * float(sizes.min(initial=np.inf)))
    ids, firsts = np.array(kinds, np.int64), np.array(starts, np.int64)
    return RenderMeshes(ids, shapes, firsts, points, pieces.normals, has_doubles)


def gather_meshes(groups: Sequence[BeamTriangles], error: float) -> RenderMeshes:
    """Triangulated beams or cylinders as render meshes, every piece once.

    The error is the distance of the triangles of the smallest piece from its surface, in model
    units.
    """
    n_pieces = sum(len(group.beams) for group in groups)
    kinds, starts = np.zeros((2, n_pieces), np.int64)
    n_points = 0
    for kind, group in enumerate(groups):
        n_beams, count = group.points.shape[:2]
        kinds[group.beams] = kind
        starts[group.beams] = n_points + count * np.arange(n_beams)
        n_points += n_beams * count
    points = np.concatenate([group.points.reshape(-1, 3) for group in groups])
    normals = np.concatenate([group.normals.reshape(-1, 3) for group in groups])
    triangles = tuple(group.triangles for group in groups)
    has_doubles = _needs_doubles(points, error)
    return RenderMeshes(kinds, triangles, starts, points, normals, has_doubles)


def _needs_doubles(points: FloatArray, error: float) -> bool:
    """Whether rounding points to float32 adds much to what triangles miss."""
    rounding = SINGLE_EPSILON * float(np.abs(points).max(initial=0.0))
    return rounding > SINGLE_IS_ENOUGH * error


def mesh_numbers(meshes: RenderMeshes, members: IntArray) -> dict[str, FloatArray]:
    """Points and normals (n, 1, V, 3) of pieces of one triangulation, for `mesh_object`."""
    count = _n_points(meshes.triangles[int(meshes.kinds[members[0]])])
    ids = meshes.starts[members][:, None, None] + np.arange(count)
    return {"points": meshes.points[ids], "normals": meshes.normals[ids]}


def mesh_object(meshes: RenderMeshes, kind: int) -> Chunk:
    """An `ON_Mesh` of a triangulation, with slots ``points`` and ``normals`` to be filled."""
    triangles = meshes.triangles[kind]
    count = _n_points(triangles)
    size = 1 if count < 1 << 8 else 2 if count < 1 << 16 else 4
    faces = triangles[:, [0, 1, 2, 2]].astype(f"<u{size}").tobytes()
    floats = (PlainBuffer(Slot(name, 0, 3 * count, "<f4")) for name in ("points", "normals"))
    doubles_too: tuple[Piece, ...] = (b"\0",)
    if meshes.has_doubles:
        precise = (ints(1, 0, count), PlainBuffer(Slot("points", 0, 3 * count)))
        doubles_too = (b"\1", Chunk(ANONYMOUS, precise))
    return class_object(
        MESH, MESH_VERSION, ints(count, len(triangles)), _UNSET_DOMAINS, _EMPTY_BOXES, ints(-1),
        bytes(5), ints(size), faces, *floats,
        ints(0, 0, 0) + bytes(4 + 16) + ints(0),  # no textures, curvatures, colours, parameters
        Chunk(ANONYMOUS, (ints(1, 1) + bytes(16 + 4) + _IDENTITY + ints(0),)),
        bytes(3) + b"\0",  # manifold, oriented, solid: not known; no ngons
        *doubles_too, _UNSET_DOMAINS[:48],
    )  # fmt: skip


def _n_points(triangles: IntArray) -> int:
    return int(triangles.max()) + 1


def mesh_streams(meshes: RenderMeshes) -> list[bytes]:
    """Each mesh as the stream of an `ON_Mesh`, in model coordinates."""
    return _filled(meshes, lambda mesh: mesh)


def _filled(meshes: RenderMeshes, wrap: Callable[[Chunk], Chunk]) -> list[bytes]:
    result = [b""] * len(meshes.kinds)
    for kind in range(len(meshes.triangles)):
        members = np.flatnonzero(meshes.kinds == kind)
        filled = fill(wrap(mesh_object(meshes, kind)), mesh_numbers(meshes, members))
        for piece, stream in zip(members, filled, strict=True):
            result[piece] = stream
    return result


def extrusions_with_meshes(extrusions: Sequence[bytes], meshes: RenderMeshes) -> list[bytes]:
    """Put render meshes into `ON_Extrusion` that openNURBS encoded without meshes."""
    caches = _filled(meshes, _cache)
    empty = encode(_cache())
    result: list[bytes] = []
    for stream, cache in zip(extrusions, caches, strict=True):
        data = bytearray(stream)
        # Checksums leave out inner chunks: the lengths around the cache are all that changes.
        for start in _AROUND_CACHE:
            typecode, length = CHUNK_HEADER.unpack_from(data, start)
            CHUNK_HEADER.pack_into(data, start, typecode, length + len(cache) - len(empty))
        place = data.rindex(empty)
        data[place : place + len(empty)] = cache
        result.append(bytes(data))
    return result


def _cache(*meshes: Chunk) -> Chunk:
    pieces: list[Piece] = [ints(1, 0)]
    for mesh in meshes:
        pieces += [b"\1", Chunk(ANONYMOUS, (ints(1, 0) + _RENDER_MESH, mesh))]
    return Chunk(ANONYMOUS, (*pieces, b"\0"))
