"""Reads surfaces, polysurfaces and extrusions of a Rhino file as meshes that lie on them.

How a face is divided is told by `kernel.surfaces`: `face_plans` into grids, fans, discs or
triangles, `row_counts` how finely, so that faces meet along their common edges.
"""

from collections.abc import Generator
from contextlib import contextmanager
from typing import Final

import numpy as np

from ...kernel.arrays import FloatArray, IntArray
from ...kernel.errors import InputError
from ...kernel.surfaces.face_meshes import mesh_polysurface
from ...kernel.surfaces.row_counts import GridSize
from ..polygons import Polygons
from .brep_faces import read_polysurface
from .object_reader import RhinoObject

SURFACES: Final = ("Surface", "NurbsSurface", "PlaneSurface", "RevSurface", "Brep", "Extrusion")
"""Classes of rhino3dm that can be sampled."""


def sample_object(
    geometry: RhinoObject, size: GridSize, transform: FloatArray | None = None
) -> list[Polygons]:
    """Quads and triangles on a surface, polysurface or extrusion.

    Parameters
    ----------
    geometry : rhino3dm.GeometryBase
        An object of one of the classes `SURFACES`.
    transform : (4, 4) float array, optional
        Takes the object to its place, where the edge length holds.

    Returns
    -------
    list of Polygons
        One for each face, turning as the face does; on common edges their vertices are equal.

    Raises
    ------
    InputError
        If a face cannot be meshed; the message names it and says why.
    """
    polysurface = read_polysurface(geometry, np.eye(4) if transform is None else transform)
    with mesh_advice():
        mesh = mesh_polysurface(polysurface, size)
    found: list[Polygons] = []
    for face in mesh.faces:
        corners, degrees = face_polygons(face.faces)
        used, corners = np.unique(corners, return_inverse=True)
        found.append(Polygons(mesh.points[used], corners.ravel(), degrees))
    return found


@contextmanager
def mesh_advice() -> Generator[None]:
    """Say what to do where a polysurface cannot be meshed.

    Yields
    ------
    None
        With the error of the block, if any, completed.
    """
    try:
        yield
    except InputError as error:
        raise InputError(f"{error}; mesh it in Rhino (Mesh, QuadRemesh) and save") from error


def face_polygons(faces: IntArray) -> tuple[IntArray, IntArray]:
    """Corners and degrees of faces of one degree.

    Parameters
    ----------
    faces : (m, k) int array

    Returns
    -------
    corners : (m k,) int array
        Face after face.
    degrees : (m,) int array
        All k.
    """
    return faces.ravel(), np.full(len(faces), faces.shape[1])
