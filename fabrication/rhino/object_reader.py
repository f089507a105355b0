"""Reads the objects of a Rhino file where they stand, those inside blocks included."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from ...kernel.arrays import FloatArray
from ...kernel.errors import InputError

RhinoObject = Any
"""An object of rhino3dm, whose stubs lack iteration and half of the methods."""


class PlacedObject(NamedTuple):
    """Geometry of rhino3dm, and the affine map (4, 4) that takes it to its place."""

    geometry: RhinoObject
    transform: FloatArray


def placed_objects(model: RhinoObject, layer: str) -> list[PlacedObject]:
    """Objects on a layer, in the order of the file; instances of blocks as what they show.

    Parameters
    ----------
    layer : str
        Full path of a layer: only what is on it and on its sublayers; empty for all. Objects
        in a block count where they are themselves, and where the instance is.

    Returns
    -------
    list of PlacedObject
        The objects. An instance of an empty block stands for itself.

    Raises
    ------
    InputError
        If nothing is on the layer, or a block contains itself.
    """
    paths: dict[int, str] = {each.Index: each.FullPath for each in model.Layers}
    named = [path for path in paths.values() if _is_below(path, layer)]
    chosen = {index for index, path in paths.items() if path in named}
    found: list[PlacedObject] = []
    for each in model.Objects:
        if not each.Attributes.IsInstanceDefinitionObject:
            found += _expand(model, each, chosen if layer else None, np.eye(4), ())
    if layer and not found:
        raise InputError(
            f"nothing is on layer {layer!r}; the file has layers "
            + (", ".join(map(repr, paths.values())) or "none")
        )
    return found


def _is_below(path: str, layer: str) -> bool:
    return not layer or path == layer or path.startswith(f"{layer}::")


def _expand(
    model: RhinoObject,
    item: RhinoObject,
    layers: set[int] | None,
    transform: FloatArray,
    blocks: tuple[str, ...],
) -> Iterator[PlacedObject]:
    """The object, or all that its block shows; `blocks` are those that it stands in."""
    geometry = item.Geometry
    is_chosen = layers is None or item.Attributes.LayerIndex in layers
    members = _members(model, geometry)
    if not members:
        if is_chosen:
            yield PlacedObject(geometry, transform)
        return
    name = str(geometry.ParentIdefId)
    if name in blocks:
        raise InputError("a block of the file contains itself; explode it in Rhino and save")
    placed = transform @ _matrix(geometry.Xform)
    for member in members:
        inner = None if is_chosen else layers
        yield from _expand(model, member, inner, placed, (*blocks, name))


def _members(model: RhinoObject, geometry: RhinoObject) -> list[RhinoObject]:
    """Objects of the block that an instance shows; none for other geometry."""
    if type(geometry).__name__ != "InstanceReference":
        return []
    definition = model.InstanceDefinitions.FindId(geometry.ParentIdefId)
    if definition is None:
        return []
    found = (model.Objects.FindId(str(each)) for each in definition.GetObjectIds())
    return [each for each in found if each is not None]


def _matrix(transform: RhinoObject) -> FloatArray:
    rows = [[getattr(transform, f"M{i}{j}") for j in range(4)] for i in range(4)]
    return np.array(rows, np.float64)
