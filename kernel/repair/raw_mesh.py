"""Vertices and faces that are not yet known to be a mesh, and where they come from."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import BoolArray, FloatArray, IntArray
from ..errors import InputError
from ..meshes.faces import compress_faces
from ..meshes.mesh import Mesh


@dataclass(frozen=True)
class RawMesh:
    """Faces of any kind on points; every step of a repair makes a new one.

    Attributes
    ----------
    vertices : (V, 3) float array
        Points; steps append to them and leave the rest as it is.
    corners : (H,) int array
        Vertex of each corner, face after face.
    offsets : (F + 1,) int array
        First corner of each face, and H.
    face_ids : (F,) int array
        Number of each face in the input.
    corner_ids : (H,) int array
        Vertex of each corner in the input.
    """

    vertices: FloatArray
    corners: IntArray
    offsets: IntArray
    face_ids: IntArray
    corner_ids: IntArray

    @property
    def n_faces(self) -> int:
        """Number of faces."""
        return len(self.offsets) - 1

    @property
    def degrees(self) -> IntArray:
        """Number of corners of each face."""
        return np.diff(self.offsets)

    @property
    def corner_faces(self) -> IntArray:
        """Face of each corner."""
        return np.repeat(np.arange(self.n_faces), self.degrees)

    @property
    def next_corners(self) -> IntArray:
        """The corner after each corner around its face."""
        result = np.arange(1, len(self.corners) + 1)
        is_face = self.degrees > 0
        result[self.offsets[1:][is_face] - 1] = self.offsets[:-1][is_face]
        return result


def raw_from_rows(vertices: ArrayLike, corners: IntArray, offsets: IntArray) -> RawMesh:
    """Faces in compressed rows, as they are given.

    Raises
    ------
    InputError
        If the vertices are no rows of three numbers.
    """
    try:
        points = np.array(vertices, np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"vertices must be rows of three numbers: {error}") from error
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError(f"vertices must have shape (V, 3), not {points.shape}")
    return RawMesh(points, corners, offsets, np.arange(len(offsets) - 1), corners)


def raw_from_faces(
    vertices: ArrayLike, faces: IntArray | Iterable[Sequence[int] | IntArray]
) -> RawMesh:
    """Faces as lists of vertices, as they are given.

    Raises
    ------
    InputError
        If the vertices are no rows of three numbers, or an index is no whole number.
    """
    return raw_from_rows(vertices, *compress_faces(faces))


def raw_from_mesh(mesh: Mesh) -> RawMesh:
    """The faces of a mesh."""
    return raw_from_rows(mesh.vertices, mesh.corners, mesh.offsets)


def keep_corners(raw: RawMesh, is_kept: BoolArray) -> RawMesh:
    """The same faces with some of their corners."""
    counts = np.concatenate([np.zeros(1, np.int64), np.cumsum(is_kept)])
    return replace(
        raw,
        corners=raw.corners[is_kept],
        corner_ids=raw.corner_ids[is_kept],
        offsets=counts[raw.offsets],
    )


def keep_faces(raw: RawMesh, is_kept: BoolArray) -> RawMesh:
    """Some of the faces."""
    chosen = is_kept[raw.corner_faces]
    offsets = np.concatenate([np.zeros(1, np.int64), np.cumsum(raw.degrees[is_kept])])
    return replace(
        raw,
        corners=raw.corners[chosen],
        corner_ids=raw.corner_ids[chosen],
        offsets=offsets,
        face_ids=raw.face_ids[is_kept],
    )
