"""Faces as users give them, in compressed rows; what keeps them from being a mesh."""

from collections.abc import Iterable, Sequence
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray, IntArray
from ..errors import InputError, name_ids
from .defects import repeated_corner


def compress_faces(
    faces: IntArray | Iterable[Sequence[int] | IntArray],
) -> tuple[IntArray, IntArray]:
    """Faces in compressed rows; a plain (F, k) array is not split into rows.

    Parameters
    ----------
    faces : sequence of sequences of int, or (F, k) int array
        Vertex ids of each face.

    Returns
    -------
    corners : (H,) int array
        Vertex of each corner, face after face.
    offsets : (F + 1,) int array
        First corner of each face, and H.

    Raises
    ------
    InputError
        If an index is no whole number.
    """
    if isinstance(faces, np.ndarray) and faces.ndim == 2:
        table = cast("NDArray[Any]", faces)
        corners = _whole_numbers(table.ravel())
        degrees = np.full(len(table), len(corners) // max(len(table), 1), np.int64)
    else:
        rows = [np.asarray(face).ravel() for face in faces]
        corners = _whole_numbers(np.concatenate(rows) if rows else np.zeros(0))
        degrees = np.array([len(row) for row in rows], np.int64)
    return corners, np.concatenate([np.zeros(1, np.int64), np.cumsum(degrees)])


def _whole_numbers(indices: NDArray[Any]) -> IntArray:
    if indices.dtype.kind not in "iu":
        is_whole = np.isfinite(indices) & (indices == np.floor(indices))
        if not is_whole.all():
            raise InputError("faces must refer to vertices by whole numbers")
    return indices.astype(np.int64)


def check_faces(points: FloatArray, corners: IntArray, offsets: IntArray) -> None:
    """Refuse what can be no mesh, whatever its connectivity.

    Parameters
    ----------
    points : (V, 3) float array
        Vertices.
    corners, offsets : int arrays
        Of `compress_faces`.

    Raises
    ------
    InputError
        If there are no faces, a coordinate is not finite, an index out of range, or a face has
        too few corners or one twice; the message names the elements.
    """
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError(f"vertices must have shape (V, 3), not {points.shape}")
    if len(offsets) < 2:
        raise InputError("the mesh has no faces")
    bad_vertices = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad_vertices):
        raise InputError(
            f"vertices {name_ids(bad_vertices.tolist())} have coordinates that are not finite"
        )
    degrees = np.diff(offsets)
    corner_faces = np.repeat(np.arange(len(degrees)), degrees)
    if (degrees < 3).any():
        bad = name_ids(np.flatnonzero(degrees < 3).tolist())
        raise InputError(f"faces {bad} have fewer than 3 corners")
    outside = (corners < 0) | (corners >= len(points))
    if outside.any():
        bad = name_ids(np.unique(corner_faces[outside]).tolist())
        raise InputError(
            f"faces {bad} refer to vertices out of range: the mesh has {len(points)} vertices"
        )
    order = np.lexsort((corners, corner_faces))
    repeated = (np.diff(corners[order]) == 0) & (np.diff(corner_faces[order]) == 0)
    if repeated.any():
        faces = np.unique(corner_faces[order][1:][repeated])
        raise repeated_corner(corners, offsets, faces)


def padded_rows(flat: IntArray) -> list[IntArray]:
    """Faces of one array in which the number of corners stands before each, as VTK has it.

    Examples
    --------
    >>> [row.tolist() for row in padded_rows(np.array([3, 0, 1, 2, 4, 0, 2, 3, 4]))]
    [[0, 1, 2], [0, 2, 3, 4]]
    """
    rows: list[IntArray] = []
    begin = 0
    while begin < len(flat):
        end = begin + 1 + int(flat[begin])
        rows.append(flat[begin + 1 : end])
        begin = end
    return rows
