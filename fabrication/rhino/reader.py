"""Reads Rhino .3dm files: meshes with ngons and grids on surfaces, joined."""

from functools import lru_cache

import numpy as np

from ...kernel.arrays import FloatArray
from ...kernel.errors import InputError
from ...kernel.tolerances import COINCIDENT, SAME_BOX
from ..polygons import (
    NO_SURFACES,
    FileContent,
    Polygons,
    drop_repeats,
    drop_unused,
    join_polygons,
    mean_side,
    weld,
)
from .isolation import isolated
from .object_polygons import FileObjects, ObjectPolygons, read_objects
from .surface_reader import GridSize

_GRID = GridSize(24, 24)


def read_3dm(data: bytes, layer: str = "", size: GridSize = _GRID) -> FileContent:
    """All that a .3dm file shows and can be panelled: its meshes, and grids on its surfaces.

    Parameters
    ----------
    data : bytes
        Content of the file.
    layer : str
        Layers by full path, such as ``Roof::Panels``, or by the end of it, several with
        commas; capitals do not matter. Only what is on them and on their sublayers is read, a
        layer that is off too if it is named. Empty reads all layers that are on.
    size : GridSize
        Quads along u and v of each face of surfaces and polysurfaces.

    Returns
    -------
    FileContent
        Faces in the order of the objects and, within a mesh, of the file; an ngon stands
        where the first of its triangles and quads stood. Hidden objects are left out, objects
        inside blocks read wherever an instance stands; remarks say what was left out. Vertices
        closer than COINCIDENT mean sides are one, as separate and unwelded meshes repeat the
        vertices of their seams; vertices inside ngons are dropped.

    Raises
    ------
    InputError
        If the file cannot be read or holds neither meshes nor surfaces there; the message says
        what it holds.
    """
    found = _read_isolated(data, layer, size)
    sources, polygons = _join(found.objects)
    if not len(polygons.degrees):
        if any(each.is_mesh for each in found.objects):
            raise InputError("its faces have no area; export the mesh again")
        raise InputError(
            f"{size.n_u} by {size.n_v} quads on surfaces have no area: ask for more"
        )
    remarks = [*found.remarks, *_narrowed(found.objects, sources), *_doubled(found.objects)]
    if size.edge_length is not None and all(each.is_mesh for each in found.objects):
        remarks.append(NO_SURFACES)
    return FileContent(polygons, found.units, tuple(remarks), sources)


@lru_cache(maxsize=1)
def _read_isolated(data: bytes, layer: str, size: GridSize) -> FileObjects:
    """The objects of a file, once for its units and again for its mesh."""
    return isolated(read_objects, data, layer, size)


def _join(objects: list[ObjectPolygons]) -> tuple[tuple[tuple[str, int], ...], Polygons]:
    """Numbers of faces by object, and all of them with common vertices."""
    joined = join_polygons([each.polygons for each in objects])
    used = drop_unused(joined)
    vertices, ids = weld(used.vertices, COINCIDENT * mean_side(used))
    ends = np.cumsum([len(each.polygons.corners) for each in objects])[:-1]
    parts = [
        drop_repeats(Polygons(vertices, corners, each.polygons.degrees))
        for each, corners in zip(objects, np.split(ids[used.corners], ends), strict=True)
    ]
    faces = Polygons(
        vertices,
        np.concatenate([part.corners for part in parts]),
        np.concatenate([part.degrees for part in parts]),
    )
    counts = [len(part.degrees) for part in parts]
    labels = [each.label for each in objects]
    sources = tuple(zip(labels, counts, strict=True))
    return sources, (drop_unused(faces) if sum(counts) else faces)


def _narrowed(objects: list[ObjectPolygons], sources: tuple[tuple[str, int], ...]) -> list[str]:
    """Meshes that lost faces of no area; grids do so at every pole."""
    return [
        f"left out {lost} faces of no area of {each.label}"
        for each, (_, count) in zip(objects, sources, strict=True)
        if each.is_mesh and (lost := len(each.polygons.degrees) - count)
    ]


def _doubled(objects: list[ObjectPolygons]) -> list[str]:
    """Meshes and surfaces that fill the same box: one was likely made from the other."""
    boxes = [_box(each.polygons) for each in objects]
    meshes = [i for i, each in enumerate(objects) if each.is_mesh]
    remarks: list[str] = []
    if not meshes:
        return remarks
    mesh_boxes = np.array([boxes[i] for i in meshes])
    for each, box in zip(objects, boxes, strict=True):
        misses = np.abs(mesh_boxes - box).max(axis=(1, 2))
        nearest = int(misses.argmin())
        if not each.is_mesh and misses[nearest] < SAME_BOX * np.ptp(box, axis=0).max():
            remarks.append(
                f"{each.label} fills the same box as {objects[meshes[nearest]].label}: if one "
                "was made from the other, hide one of them, or name a layer"
            )
    return remarks


def _box(polygons: Polygons) -> FloatArray:
    points = polygons.vertices[polygons.corners]
    return np.array([points.min(axis=0), points.max(axis=0)])
