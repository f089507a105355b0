"""Reads all that can be panelled from a Rhino file, object by object, and says what cannot."""

import base64
from collections import Counter
from typing import Final, NamedTuple

import numpy as np

from ...kernel.arrays import FloatArray, IntArray
from ...kernel.errors import InputError
from ..opennurbs.mesh_ngons import MeshContent, read_mesh_object
from ..polygons import Polygons, join_polygons, transform_polygons
from .isolation import QUIET_SECONDS, allow_seconds
from .layers import RhinoObject
from .object_reader import PlacedObject, find_objects, kind_name
from .surface_reader import SURFACES, GridSize, sample_object

_MOST_NAMED: Final = 5
"""Objects that one sentence names one by one."""

_UNITS: Final[dict[str, tuple[str, float]]] = {
    "Millimeters": ("mm", 1),
    "Centimeters": ("cm", 1),
    "Meters": ("m", 1),
    "Inches": ("in", 1),
    "Feet": ("ft", 1),
    "Angstroms": ("mm", 1e-7),
    "Nanometers": ("mm", 1e-6),
    "Microns": ("mm", 1e-3),
    "Decimeters": ("m", 0.1),
    "Dekameters": ("m", 10),
    "Hectometers": ("m", 100),
    "Kilometers": ("m", 1000),
    "NauticalMiles": ("m", 1852),
    "Microinches": ("in", 1e-6),
    "Mils": ("in", 1e-3),
    "PrinterPoints": ("in", 1 / 72),
    "PrinterPicas": ("in", 1 / 6),
    "Yards": ("ft", 3),
    "Miles": ("ft", 5280),
}
"""Units of Rhino as the unit that the library knows, and how many of these they are."""


class ObjectPolygons(NamedTuple):
    """Polygons of one object of a file, in the units that were read.

    Attributes
    ----------
    label : str
        What messages call it.
    is_mesh : bool
        Whether it is a mesh of the file, or was made on a surface.
    polygons : Polygons
        Its faces.
    """

    label: str
    is_mesh: bool
    polygons: Polygons


class FileObjects(NamedTuple):
    """What `read_objects` finds: objects with faces, the unit of the file, and remarks."""

    objects: list[ObjectPolygons]
    units: str
    remarks: tuple[str, ...]


def read_objects(data: bytes, layer: str, size: GridSize) -> FileObjects:
    """Meshes of a .3dm file, and grids on its surfaces.

    rhino3dm may never come back from a damaged file: call this by `isolated`.

    Parameters
    ----------
    data : bytes
        Content of the file.
    layer : str
        Layers to read, see `choose_layers`; empty for all that are on.

    Returns
    -------
    FileObjects
        Objects in the order of the file.

    Raises
    ------
    InputError
        If the file cannot be read, or nothing in it can be panelled.
    """
    model = open_model(data)
    units, scale, remark = file_units(model)
    found = find_objects(model, layer)
    objects: list[ObjectPolygons] = []
    failures: list[str] = []
    others: Counter[str] = Counter()
    unread: list[str] = []
    for each in found.objects:
        if kind_name(each.geometry) == "SubD":
            unread.append(each.label)
        elif not _has_faces(each.geometry):
            is_mesh = type(each.geometry).__name__ == "Mesh"
            others["mesh without faces" if is_mesh else kind_name(each.geometry)] += 1
        else:
            try:
                objects.append(_read_object(each, size, scale))
            except InputError as error:
                failures.append(f"{each.label}: {error}")
    remarks = [*remark, *found.remarks, *_left_out(failures, unread, others)]
    if not objects:
        where = f"layer {layer!r}" if layer else "the file"
        held = ", ".join(_counted(others)) or "no objects"
        if failures and not unread:
            raise InputError("; ".join(failures[:_MOST_NAMED]))
        raise InputError(
            f"{where} holds no meshes and no surfaces that are shown, but {held}; "
            + ("; ".join(remarks[:-1] if others else remarks) or _CURE)
        )
    return FileObjects(objects, units, tuple(remarks))


_CURE = "mesh them in Rhino (Mesh, QuadRemesh or ExtractRenderMesh) and save"


def open_model(data: bytes) -> RhinoObject:
    """The model of a .3dm file.

    Raises
    ------
    InputError
        If rhino3dm does not read it.
    """
    import rhino3dm

    rhino: RhinoObject = rhino3dm
    model = rhino.File3dm.FromByteArray(data)
    if model is None:
        raise InputError("Rhino cannot read the file: it is damaged or no .3dm; save it again")
    return model


def file_units(model: RhinoObject) -> tuple[str, float, tuple[str, ...]]:
    """The unit of a file.

    Returns
    -------
    units : str
        One of `units.MILLIMETERS`; empty if the file has none that is known.
    scale : float
        How many of these the unit of the file is.
    remarks : tuple of str
        What to say of other units.

    Raises
    ------
    InputError
        If nobody builds in such units.
    """
    name: str = model.Settings.ModelUnitSystem.name
    if name in ("None", "Unset"):
        return "", 1.0, ()
    if name == "CustomUnits":
        remark = "the file has custom units, whose size is not read; units are taken as given"
        return "", 1.0, (remark,)
    if name not in _UNITS:
        raise InputError(
            f"the file is drawn in {name}; choose mm, cm, m, in or ft in Rhino (Units) and save"
        )
    units, scale = _UNITS[name]
    if scale == 1:
        return units, 1.0, ()
    return units, scale, (f"the file is drawn in {name.lower()}; it is read in {units}",)


def _has_faces(geometry: RhinoObject) -> bool:
    kind = type(geometry).__name__
    return kind in SURFACES or (kind == "Mesh" and geometry.Faces.Count > 0)


def placed_transform(each: PlacedObject, scale: float) -> FloatArray:
    """The affine map (4, 4) of an object to its place in another unit, `scale` to a unit.

    Raises
    ------
    InputError
        If it is not finite.
    """
    transform: FloatArray = np.diag([scale, scale, scale, 1.0]) @ each.transform
    if not np.isfinite(transform).all():
        raise InputError("its block is placed at coordinates that are not finite; delete it")
    return transform


def allow_object(geometry: RhinoObject, size: GridSize) -> None:
    """Allow the time that meshing a surface or polysurface takes (`allow_seconds`)."""
    faces = len(geometry.Faces) if hasattr(geometry, "Faces") else 1
    allow_seconds(QUIET_SECONDS + faces * (1 + size.n_u * size.n_v // 2000))


def _read_object(each: PlacedObject, size: GridSize, scale: float) -> ObjectPolygons:
    transform = placed_transform(each, scale)
    is_mesh = type(each.geometry).__name__ == "Mesh"
    if is_mesh:
        allow_seconds()
        moved = transform_polygons(_mesh_polygons(each.geometry), transform)
    else:
        allow_object(each.geometry, size)
        moved = join_polygons(sample_object(each.geometry, size, transform))
    return ObjectPolygons(each.label, is_mesh, moved)


def _mesh_polygons(mesh: RhinoObject) -> Polygons:
    return content_polygons(read_mesh_object(base64.b64decode(mesh.Encode()["data"])))


def content_polygons(content: MeshContent) -> Polygons:
    """The faces of a mesh of Rhino: an ngon stands where the first of its parts stood.

    Raises
    ------
    InputError
        If faces refer to vertices that it does not have, or coordinates are not finite.
    """
    vertices, faces, ngons = content
    degrees = np.where(faces[:, 2] == faces[:, 3], 3, 4)
    is_free = np.ones(len(faces), bool)
    boundaries: dict[int, IntArray] = {}
    for boundary, members in ngons:
        is_free[members] = False
        boundaries[int(members.min())] = boundary
    kept = [
        faces[i, : degrees[i]] if is_free[i] else boundaries[i]
        for i in sorted([*np.flatnonzero(is_free).tolist(), *boundaries])
    ]
    corners = np.concatenate(kept)
    if corners.min() < 0 or corners.max() >= len(vertices):
        raise InputError("faces refer to vertices that it does not have; export it again")
    if not np.isfinite(vertices).all():
        raise InputError("its coordinates are not finite; delete it or export it again")
    return Polygons(vertices, corners, np.array([len(face) for face in kept], np.int64))


def _left_out(failures: list[str], unread: list[str], others: Counter[str]) -> list[str]:
    """Sentences on objects that are shown and cannot be panelled; those of no faces last."""
    remarks = [f"left out {failure}" for failure in failures[:_MOST_NAMED]]
    if len(failures) > _MOST_NAMED:
        remarks.append(f"left out {len(failures) - _MOST_NAMED} more objects for such reasons")
    if unread:
        more = f" and {len(unread) - _MOST_NAMED} more" if len(unread) > _MOST_NAMED else ""
        remarks.append(
            f"left out {', '.join(unread[:_MOST_NAMED])}{more}: SubDs are not read; turn them "
            "into surfaces (ToNURBS) or meshes (Mesh, QuadRemesh) in Rhino and save"
        )
    if others:
        remarks.append(f"left out what has no faces: {', '.join(_counted(others))}")
    return remarks


def _counted(kinds: Counter[str]) -> list[str]:
    return [f"{count} {_plural(kind) if count > 1 else kind}" for kind, count in kinds.items()]


def _plural(kind: str) -> str:
    noun, *rest = kind.split(maxsplit=1) if kind.startswith(("mesh ", "instance ")) else [kind]
    ending = "es" if noun.endswith(("sh", "ch")) else "s"
    return " ".join([f"{noun}{ending}", *rest])
