"""A Rhino model under construction: layers, materials, groups, views, and ids."""

import base64
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple, TypeAlias
from uuid import NAMESPACE_URL, UUID, uuid5

import numpy as np

from ...kernel.arrays import FloatArray
from ...kernel.parts.colors import Color
from ..units import millimeters_per
from .archive import FileObject, ObjectAttributes

# What comes from rhino3dm is not typed: its stub lacks setters, indices and overloads.
Untyped: TypeAlias = Any

_UNIT_SYSTEMS = {
    "mm": "Millimeters", "cm": "Centimeters", "m": "Meters", "in": "Inches", "ft": "Feet",
}  # fmt: skip
_TOLERANCE = 0.01
"""Model tolerance in millimetres."""

_ANGLE_TOLERANCE = 0.1
"""Model tolerance of angles in degrees."""

_NAMESPACE = uuid5(NAMESPACE_URL, "urn:spheremesh:3dm")
_LENS = 50.0
"""Focal length of the perspective view in millimetres; Rhino's own."""

_HALF_ANGLE = float(np.arctan(12 / _LENS))
"""Half the smaller angle of view of that lens, on film of 36 by 24 mm."""


@dataclass(frozen=True)
class RhinoModel:
    """The library rhino3dm, a model under construction, and the objects that it is to hold."""

    library: Untyped
    file: Untyped
    objects: list[FileObject] = field(default_factory=list[FileObject])

    def add(self, kind: str, stream: bytes, attributes: ObjectAttributes) -> None:
        """Add an object by its kind, as openNURBS calls it, and its stream."""
        self.objects.append(FileObject(kind, stream, attributes))

    def add_geometry(self, geometry: Untyped, attributes: ObjectAttributes) -> None:
        """Add an object that rhino3dm made."""
        self.add(type(geometry).__name__, geometry_stream(geometry), attributes)


class ModelLayer(NamedTuple):
    """Indices of a layer and of the material of its objects, if they have one."""

    layer: int
    material: int | None = None


def model_tolerance(units: str) -> float:
    """Absolute tolerance of the models written.

    Parameters
    ----------
    units : str
        Model units.

    Returns
    -------
    float
        A hundredth of a millimetre, in model units.
    """
    return _TOLERANCE / millimeters_per(units)


def new_model(units: str) -> RhinoModel:
    """An empty model.

    Parameters
    ----------
    units : str
        Model units.

    Returns
    -------
    RhinoModel
        With units and tolerances.
    """
    tolerance = model_tolerance(units)
    import rhino3dm

    library: Untyped = rhino3dm
    file = library.File3dm()
    file.ApplicationName = "spheremesh"
    settings = file.Settings
    settings.ModelUnitSystem = getattr(library.UnitSystem, _UNIT_SYSTEMS[units])
    settings.ModelAbsoluteTolerance = tolerance
    settings.ModelAngleToleranceDegrees = _ANGLE_TOLERANCE
    return RhinoModel(library, file)


def geometry_stream(geometry: Untyped) -> bytes:
    """The stream of an object that rhino3dm made."""
    return base64.b64decode(geometry.Encode()["data"])


def encode_model(model: RhinoModel, version: int) -> bytes:
    """The model as a file.

    Parameters
    ----------
    version : int
        Of Rhino.

    Returns
    -------
    bytes
        Content of the file without its objects; empty if rhino3dm cannot encode it.
    """
    options = model.library.File3dmWriteOptions()
    options.Version = version
    # File3dm.Write would store the path of the temporary file in the model.
    return base64.b64decode(model.file.Encode(options) or "")


def object_id(name: str, role: str) -> UUID:
    """An id that is the same in every run.

    Parameters
    ----------
    name : str
        Panel, layer or material.

    Returns
    -------
    UUID
        Of name and role alone.
    """
    return uuid5(_NAMESPACE, f"{name}/{role}")


def add_layer(
    model: RhinoModel,
    name: str,
    color: Color,
    parent: ModelLayer | None = None,
    *,
    has_material: bool = False,
    visible: bool = True,
) -> ModelLayer:
    """Add a layer.

    Parameters
    ----------
    parent : ModelLayer, optional
        The layer that it lies under.
    has_material : bool
        Whether there is a material of its colour, for surfaces.
    visible : bool
        Whether it is switched on.

    Returns
    -------
    ModelLayer
        Where objects go.
    """
    file = model.file
    layer = model.library.Layer()
    layer.Id = object_id(name, "layer")
    layer.Name = name
    layer.Color = (*color, 255)
    layer.Visible = visible
    if parent:
        layer.ParentLayerId = file.Layers[parent.layer].Id
    place = ModelLayer(file.Layers.Add(layer))
    if not has_material:
        return place
    material = model.library.Material()
    material.Id = object_id(name, "material")
    material.Name = name
    material.DiffuseColor = (*color, 255)
    index: int = file.Materials.Add(material)
    file.Layers[place.layer].RenderMaterialIndex = index
    return place._replace(material=index)


def add_group(model: RhinoModel, name: str) -> int:
    """Add a group."""
    group = model.library.Group()
    group.Name = name
    group.Id = object_id(name, "group")
    model.file.Groups.Add(group)
    return len(model.file.Groups) - 1


def object_attributes(
    name: str, role: str, place: ModelLayer, text: Mapping[str, str] | None = None
) -> ObjectAttributes:
    """Attributes with a stable id: the colour of the layer, and its material if it has one.

    Parameters
    ----------
    name : str
        Name of the object, such as the id of its panel.
    role : str
        What the object is; tells apart those of one name.
    place : ModelLayer
        Where it goes.
    text : mapping of str to str, optional
        User text.

    Returns
    -------
    ObjectAttributes
        Those that go with its geometry.
    """
    # Many viewers know materials of objects only, and show other surfaces in white.
    return ObjectAttributes(
        object_id(name, role), name, place.layer, place.material, text=text or {}
    )


def add_views(model: RhinoModel, points: FloatArray) -> None:
    """Add the named views Top and Perspective, which show all points.

    Parameters
    ----------
    points : (n, 3) float array
        At least one point, in model coordinates.
    """
    low, high = points.min(0), points.max(0)
    center, radius = (low + high) / 2, float(np.linalg.norm(high - low)) / 2
    perspective = model.library.ViewInfo()
    perspective.Name = "Perspective"
    distance = radius / np.sin(_HALF_ANGLE)
    perspective.Viewport.ChangeToPerspectiveProjection(distance, True, _LENS)  # noqa: FBT003
    _aim(model, perspective.Viewport, center, np.array([1.0, -1.0, 0.8]), distance)
    half, near = float(np.tan(_HALF_ANGLE)), distance - radius
    frame = (1.5 * half * near, half * near)
    _frame(perspective.Viewport, frame, near, distance + radius)
    top = model.library.ViewInfo()
    top.Name = "Top"
    top.Viewport.ChangeToParallelProjection(True)  # noqa: FBT003
    _aim(model, top.Viewport, center, np.array([0.0, 0.0, 1.0]), 2 * radius)
    _frame(top.Viewport, (1.5 * radius, radius), radius, 3 * radius)
    for view in (top, perspective):
        model.file.NamedViews.Add(view)


def _aim(
    model: RhinoModel,
    viewport: Untyped,
    target: FloatArray,
    backwards: FloatArray,
    distance: float,
) -> None:
    backwards = backwards / np.linalg.norm(backwards)
    upwards = np.array([0.0, 0.0, 1.0]) if backwards[2] < 1 else np.array([0.0, 1.0, 0.0])
    right = np.cross(upwards, backwards)
    upwards = np.cross(backwards, right / np.linalg.norm(right))
    point, vector = model.library.Point3d, model.library.Vector3d
    viewport.SetCameraLocation(point(*(target + distance * backwards).tolist()))
    viewport.SetCameraDirection(vector(*(-distance * backwards).tolist()))
    viewport.SetCameraUp(vector(*upwards.tolist()))
    viewport.TargetPoint = point(*target.tolist())


def _frame(viewport: Untyped, half: tuple[float, float], near: float, far: float) -> None:
    viewport.SetScreenPort((0, 0, 1500, 1000))
    viewport.SetFrustum(-half[0], half[0], -half[1], half[1], near, far)
