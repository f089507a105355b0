"""Reads the surfaces of a Rhino file as a mesh with their exact normals and curvatures."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...kernel.arrays import IntArray
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
from .layers import RhinoObject
from .object_polygons import allow_object, file_units, open_model, placed_transform
from .object_reader import PlacedObject, find_objects, kind_name
from .surface_reader import SURFACES, face_polygons, mesh_advice


@dataclass(frozen=True)
class SurfaceContent:
    """What was read from the surfaces of a file.

    Attributes
    ----------
    surface : Surface
        All surfaces in one.
    units : str
        Model unit that the file names, one of `units.MILLIMETERS`; empty if it names none.
    remarks : tuple of str
        Sentences for the user: what was left out and why.
    """

    surface: Surface
    units: str = ""
    remarks: tuple[str, ...] = ()


def read_surfaces_3dm(data: bytes, layer: str, size: GridSize) -> SurfaceContent:
    """The surfaces, polysurfaces and extrusions of a .3dm file that are shown.

    rhino3dm may never come back from a damaged file: call this by `isolated`.

    Parameters
    ----------
    data : bytes
        Content of the file.
    layer : str
        Layers to read, see `choose_layers`; empty for all that are on.
    size : GridSize
        Numbers of rows, or the length of the edges.

    Returns
    -------
    SurfaceContent
        Meshed as `sample_object` does, in the unit that it names.

    Raises
    ------
    InputError
        If the file cannot be read, or no surface in it.
    """
    model = open_model(data)
    units, scale, remark = file_units(model)
    found = find_objects(model, layer)
    parts: list[_Part] = []
    failures: list[str] = []
    others: Counter[str] = Counter()
    for each in found.objects:
        if type(each.geometry).__name__ not in SURFACES:
            others[kind_name(each.geometry)] += 1
            continue
        try:
            parts.append(_read_part(each, size, scale))
        except InputError as error:
            failures.append(f"left out {each.label}: {error}")
    held = ", ".join(f"{count} {kind}" for kind, count in others.items())
    if not parts:
        raise InputError(
            "; ".join([*failures, *found.remarks])
            or f"there are no surfaces, but {held or 'no objects'}; read a mesh with read_mesh"
        )
    left_out = (f"left out what is no surface: {held}; read meshes with read_mesh",)
    remarks = (*remark, *found.remarks, *failures, *(left_out if held else ()))
    return SurfaceContent(_join(parts), units, remarks)


def surface_of_objects(objects: Sequence[RhinoObject], size: GridSize) -> Surface:
    """Surfaces, polysurfaces and extrusions as one surface, as `read_surfaces_3dm` reads them.

    rhino3dm may never come back from a damaged object: call this by `isolated`.

    Parameters
    ----------
    objects : sequence of rhino3dm.GeometryBase
        At least one.
    size : GridSize
        Numbers of rows, or the length of the edges.

    Raises
    ------
    InputError
        If one is no surface, or cannot be meshed; the message says why.
    """
    parts: list[_Part] = []
    for geometry in objects:
        if type(geometry).__name__ not in SURFACES:
            raise InputError(f"a {kind_name(geometry)} is no surface; give a mesh as a mesh")
        parts.append(_read_part(PlacedObject(geometry, np.eye(4), "surface"), size, 1.0))
    return _join(parts)


@dataclass(frozen=True)
class _Part:
    """One object: its points and faces, and a shape for each of the ids."""

    polygons: Polygons
    ids: IntArray
    shapes: VertexShapes


def _read_part(each: PlacedObject, size: GridSize, scale: float) -> _Part:
    allow_object(each.geometry, size)
    polysurface = read_polysurface(each.geometry, placed_transform(each, scale))
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
