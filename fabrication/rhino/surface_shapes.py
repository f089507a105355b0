"""Reads the surfaces of a Rhino file as a mesh with their exact normals and curvatures."""

from collections import Counter
from dataclasses import dataclass

import numpy as np

from ...kernel.arrays import FloatArray, IntArray
from ...kernel.errors import InputError
from ...kernel.surfaces.face_meshes import mesh_polysurface
from ...kernel.surfaces.row_counts import GridSize
from ...kernel.surfaces.surface import Surface
from ...kernel.surfaces.vertex_shapes import (
    VertexShapes,
    join_shapes,
    merge_shapes,
    shapes_on_faces,
)
from ...kernel.tolerances import COINCIDENT
from ..polygons import Polygons, drop_repeats, join_polygons, mean_side, to_mesh, weld
from .brep_faces import read_polysurface
from .object_reader import RhinoObject, placed_objects
from .surface_reader import SURFACES, face_polygons, mesh_advice


@dataclass(frozen=True)
class SurfaceContent:
    """What was read from the surfaces of a file.

    Attributes
    ----------
    surface : Surface
        All surfaces in one.
    remarks : tuple of str
        Sentences for the user: what was left out and why.
    """

    surface: Surface
    remarks: tuple[str, ...] = ()


def read_surfaces_3dm(data: bytes, layer: str, size: GridSize) -> SurfaceContent:
    """The surfaces, polysurfaces and extrusions of a .3dm file.

    Parameters
    ----------
    data : bytes
        Content of the file.
    layer : str
        Full path of a layer: only what is on it and on its sublayers; empty for all.
    size : GridSize
        Numbers of rows, or the length of the edges.

    Returns
    -------
    SurfaceContent
        Meshed as `sample_object` does.

    Raises
    ------
    InputError
        If the file cannot be read, or no surface in it.
    """
    import rhino3dm

    rhino: RhinoObject = rhino3dm
    model = rhino.File3dm.FromByteArray(data)
    if model is None:
        raise InputError("Rhino cannot read the file: it is damaged or no .3dm; save it again")
    objects = placed_objects(model, layer)
    parts: list[_Part] = []
    remarks: list[str] = []
    for each in objects:
        kind = type(each.geometry).__name__
        if kind not in SURFACES:
            continue
        try:
            parts.append(_read_part(each.geometry, each.transform, size))
        except InputError as error:
            remarks.append(f"left out a {kind}: {error}")
    others = Counter(
        name for each in objects if (name := type(each.geometry).__name__) not in SURFACES
    )
    held = ", ".join(f"{count} {kind}" for kind, count in others.items())
    if not parts:
        raise InputError(
            "; ".join(remarks)
            or f"there are no surfaces, but {held or 'no objects'}; read a mesh with read_mesh"
        )
    if held:
        remarks.append(f"left out what is no surface: {held}; read meshes with read_mesh")
    return SurfaceContent(_join(parts), tuple(remarks))


@dataclass(frozen=True)
class _Part:
    """One object: its points and faces, and a shape for each of the ids."""

    polygons: Polygons
    ids: IntArray
    shapes: VertexShapes


def _read_part(geometry: RhinoObject, transform: FloatArray, size: GridSize) -> _Part:
    polysurface = read_polysurface(geometry, transform)
    with mesh_advice():
        mesh = mesh_polysurface(polysurface, size)
    faces = [face_polygons(face.faces) for face in mesh.faces]
    polygons = Polygons(
        mesh.points,
        np.concatenate([corners for corners, _ in faces]),
        np.concatenate([degrees for _, degrees in faces]),
    )
    ids = np.concatenate([face.vertices for face in mesh.faces])
    return _Part(polygons, ids, shapes_on_faces(polysurface, mesh))


def _join(parts: list[_Part]) -> Surface:
    starts = np.cumsum([0, *(len(part.polygons.vertices) for part in parts)])
    joined = join_polygons([part.polygons for part in parts])
    points, welded = weld(joined.vertices, COINCIDENT * mean_side(joined))
    ids = np.concatenate([part.ids + k for part, k in zip(parts, starts, strict=False)])
    shapes = merge_shapes(
        join_shapes([part.shapes for part in parts]), welded[ids], len(points)
    )
    faces = drop_repeats(Polygons(points, welded[joined.corners], joined.degrees))
    if not len(faces.degrees):
        raise InputError("so few rows of quads have no area: ask for more")
    is_used = np.zeros(len(points), bool)
    is_used[faces.corners] = True
    mesh = to_mesh(
        Polygons(points[is_used], (np.cumsum(is_used) - 1)[faces.corners], faces.degrees)
    )
    return Surface(
        mesh,
        shapes.normals[is_used],
        shapes.curvatures[is_used],
        shapes.directions[is_used],
        shapes.is_smooth[is_used],
    )
