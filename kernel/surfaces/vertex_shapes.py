"""The shape of surfaces at the vertices of a mesh on them, where faces meet as well."""

from typing import NamedTuple

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, unit
from ..tolerances import SMOOTH_JOINT
from .face_meshes import PolysurfaceMesh
from .poles import shape_at
from .trimmed_faces import Polysurface


class VertexShapes(NamedTuple):
    """Normals, curvatures and directions, a row for each point: see `surface.Surface`."""

    normals: FloatArray
    curvatures: FloatArray
    directions: FloatArray
    is_smooth: BoolArray


def shapes_on_faces(polysurface: Polysurface, mesh: PolysurfaceMesh) -> VertexShapes:
    """Shapes on the side where the faces look, a row for each point of each face.

    Parameters
    ----------
    mesh : PolysurfaceMesh
        Of this polysurface.

    Returns
    -------
    VertexShapes
        Rows for the points of the first face, then those of the second and so on: a vertex
        has one for each face that it is on.
    """
    rows: list[VertexShapes] = []
    for face, part in zip(polysurface.faces, mesh.faces, strict=True):
        found, is_smooth = shape_at(face.surface, part.uv)
        curvatures = np.stack([found.first, found.second], 1)
        if face.is_reversed:
            flipped = -found.normals, -curvatures[:, ::-1], found.directions[:, ::-1]
            rows.append(VertexShapes(*flipped, is_smooth))
        else:
            rows.append(VertexShapes(found.normals, curvatures, found.directions, is_smooth))
    return join_shapes(rows)


def join_shapes(parts: list[VertexShapes]) -> VertexShapes:
    """All rows, one part after the other.

    Parameters
    ----------
    parts : list of VertexShapes
        At least one.

    Returns
    -------
    VertexShapes
        As many rows as all parts have.
    """
    return VertexShapes(*map(np.concatenate, zip(*parts, strict=True)))


def merge_shapes(rows: VertexShapes, ids: IntArray, count: int) -> VertexShapes:
    """One shape for each vertex.

    Parameters
    ----------
    rows : VertexShapes
        Shapes of points.
    ids : (n,) int array
        The vertex of each row; every vertex has one.
    count : int
        Number of vertices.

    Returns
    -------
    VertexShapes
        The first row of each vertex; where the normals of its rows differ it is not smooth,
        and has their mean.
    """
    firsts = np.full(count, len(ids))
    np.minimum.at(firsts, ids, np.arange(len(ids)))
    found = VertexShapes(
        rows.normals[firsts], rows.curvatures[firsts], rows.directions[firsts],
        rows.is_smooth[firsts],
    )  # fmt: skip
    agrees = dot(found.normals[ids], rows.normals) > np.cos(SMOOTH_JOINT)
    np.logical_and.at(found.is_smooth, ids, rows.is_smooth & agrees)
    _use_mean_normals(found, rows, ids)
    return found


def _use_mean_normals(found: VertexShapes, rows: VertexShapes, ids: IntArray) -> None:
    """Mean normals at vertices that are not smooth; equal ones, as of a seam, count once."""
    rough = np.flatnonzero(~found.is_smooth[ids])
    sides = np.round(rows.normals[rough] / SMOOTH_JOINT)
    _, firsts = np.unique(np.c_[ids[rough], sides], axis=0, return_index=True)
    sums = np.zeros_like(found.normals)
    np.add.at(sums, ids[rough[firsts]], rows.normals[rough[firsts]])
    # Faces that turn back on one another have no mean: there the first normal stays.
    has_mean = np.abs(sums).max(1, initial=0) > SMOOTH_JOINT
    found.normals[has_mean] = unit(sums[has_mean])
