"""Render meshes of panels as openNURBS objects, for viewers that cannot mesh Breps.

They are written into the streams of Breps: the setters of rhino3dm crash it at exit. Layout of
`ON_Mesh` 3.8 (`opennurbs_mesh.cpp`): ii counts of vertices and faces, domains that are not set,
three empty boxes of floats, i -1, flags, faces of four indices each (a triangle repeats its
last), buffers of float32 vertices and normals, empty buffers, the tag of no texture mapping,
and a chunk with the vertices as float64, if that is needed.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, norm
from ...kernel.panels.panels import Panels
from ...kernel.panels.tessellation import tessellate
from ...kernel.tolerances import SINGLE_EPSILON, SINGLE_IS_ENOUGH
from .stream_codes import ANONYMOUS, MESH, MESH_VERSION
from .stream_writer import (
    Chunk,
    Piece,
    PlainBuffer,
    Slot,
    class_object,
    doubles,
    fill,
    ints,
)

_UNSET_DOMAINS = doubles(*[-1.23432101234321e308] * 8) + bytes(16)
MESH_TOLERANCE: Final = 0.004
"""Largest distance of a render mesh from its surface, relative to the radius of the piece."""

_EMPTY_BOXES = np.array([*[1, 1, 1, -1, -1, -1] * 2, 1, 1, -1, -1], "<f4").tobytes()
_IDENTITY = doubles(*np.eye(4).ravel().tolist())


@dataclass(frozen=True)
class RenderMeshes:
    """Triangles of panels, those of the same triangulation together.

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
    result = [b""] * len(meshes.kinds)
    for kind in range(len(meshes.triangles)):
        members = np.flatnonzero(meshes.kinds == kind)
        filled = fill(mesh_object(meshes, kind), mesh_numbers(meshes, members))
        for piece, stream in zip(members.tolist(), filled, strict=True):
            result[piece] = stream
    return result
