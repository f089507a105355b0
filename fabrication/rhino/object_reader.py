"""Reads the objects of a Rhino file where they stand, those inside blocks included."""

from collections import Counter
from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np

from ...kernel.arrays import FloatArray
from ...kernel.errors import InputError
from .layers import LayerChoice, RhinoObject, choose_layers, list_layers

_KINDS: Final = {
    "PointSet": "point cloud",
    "TextDot": "text dot",
    "ClipPlane": "clipping plane",
    "InstanceReference": "instance of a block that the file does not hold",
    "SubD": "SubD",
    "Brep": "polysurface",
}
"""What users call a kind of object, where that is not the name of its type in Rhino."""


class PlacedObject(NamedTuple):
    """Geometry of rhino3dm where it stands.

    Attributes
    ----------
    geometry : rhino3dm.GeometryBase
        The object as it is stored.
    transform : (4, 4) float array
        The affine map that takes it to its place.
    label : str
        What messages call it, such as ``mesh 'shell' on layer 'Roof::Glass'``.
    """

    geometry: RhinoObject
    transform: FloatArray
    label: str


class FoundObjects(NamedTuple):
    """Objects that are to be read, and sentences on what is not."""

    objects: list[PlacedObject]
    remarks: tuple[str, ...]


def placed_objects(model: RhinoObject, layer: str) -> list[PlacedObject]:
    """Visible objects on some layers, as `find_objects` finds them."""
    return find_objects(model, layer).objects


def find_objects(model: RhinoObject, layer: str) -> FoundObjects:
    """Visible objects on some layers, in the order of the file; blocks as what they show.

    What Rhino shows is found: objects that are hidden, on layers that are off, or on a layout
    are not; locked ones, and those of groups, are.

    Parameters
    ----------
    layer : str
        Layers by name, see `choose_layers`, with their sublayers; empty for all. Objects in a
        block count where they are themselves, and where the instance is.

    Returns
    -------
    FoundObjects
        The objects. An instance of an empty block stands for itself.

    Raises
    ------
    InputError
        If nothing is on the layers, or a block contains itself.
    """
    choice = choose_layers(model, layer)
    search = _Search(model, choice, Counter(), Counter())
    found: list[PlacedObject] = []
    for each in model.Objects:
        if not each.Attributes.IsInstanceDefinitionObject:
            found += _expand(search, each, _Place(np.eye(4), (), choice.chosen is None))
    if layer and not found and not search.hidden:
        held = list_layers(choice.paths, choice.hidden)
        raise InputError(f"nothing is on layer {layer!r}; the file has layers {held}")
    return FoundObjects(found, (*choice.remarks, *_remarks(search)))


def layer_phrase(paths: dict[int, str], index: int) -> str:
    """Where an object is, such as `` on layer 'Roof'``; empty for no layer."""
    return f" on layer {paths[index]!r}" if index in paths else ""


def kind_name(geometry: RhinoObject) -> str:
    """What users call this kind of object: ``mesh``, ``curve``, ``SubD``."""
    if geometry is None:
        return "unknown object"
    if type(geometry).__name__ == "Brep" and len(geometry.Faces) == 1:
        return "surface"
    kind = str(geometry.ObjectType.name)
    return _KINDS.get(kind, kind.lower())


class _Search(NamedTuple):
    """Where to look, and what was passed by: hidden objects by reason."""

    model: RhinoObject
    choice: LayerChoice
    hidden: Counter[str]
    linked: Counter[str]


class _Place(NamedTuple):
    """Where an object stands: the map, the blocks that it is in, and if that is asked for."""

    transform: FloatArray
    blocks: tuple[str, ...]
    is_chosen: bool


def _expand(search: _Search, item: RhinoObject, place: _Place) -> Iterator[PlacedObject]:
    """The object, or all that its block shows, as far as it is visible and asked for."""
    geometry, attributes = item.Geometry, item.Attributes
    paths, chosen = search.choice.paths, search.choice.chosen
    layer = attributes.LayerIndex
    is_chosen = place.is_chosen or (chosen is not None and layer in chosen)
    reason = _why_hidden(search.choice, attributes)
    definition = _definition(search.model, geometry)
    members = _members(search.model, definition)
    if reason:
        if is_chosen:
            search.hidden[reason] += 1
        return
    if not members:
        if is_chosen and definition is not None and definition.SourceArchive:
            search.linked[str(definition.Name)] += 1
        elif is_chosen:
            name = repr(attributes.Name) if attributes.Name else str(attributes.Id)
            label = f"{kind_name(geometry)} {name}{layer_phrase(paths, layer)}"
            yield PlacedObject(geometry, place.transform, label)
        return
    name = str(geometry.ParentIdefId)
    if name in place.blocks:
        raise InputError("a block of the file contains itself; explode it in Rhino and save")
    transform = place.transform @ _matrix(geometry.Xform)
    for member in members:
        yield from _expand(search, member, _Place(transform, (*place.blocks, name), is_chosen))


def _why_hidden(choice: LayerChoice, attributes: RhinoObject) -> str:
    """Why Rhino does not show an object in the model; empty if it does."""
    if attributes.ActiveSpace.name == "PageSpace":
        return "on layouts"
    if attributes.LayerIndex in choice.hidden:
        return f"on layer {choice.paths[attributes.LayerIndex]!r}, which is off"
    return "" if attributes.Visible else "hidden one by one"


def _remarks(search: _Search) -> Iterator[str]:
    if search.hidden:
        reasons = [f"{count} {reason}" for reason, count in search.hidden.most_common()]
        more = f" and on {len(reasons) - 10} more layers" if len(reasons) > 10 else ""
        total = search.hidden.total()
        yield (
            f"left out {total} hidden object{'s' * (total > 1)}: {', '.join(reasons[:10])}"
            f"{more}; to have them, show them in Rhino and save, or name their layer"
        )
    for name, count in search.linked.items():
        yield (
            f"left out {count} instance{'s' * (count > 1)} of block {name!r}, which is "
            "linked to a file of its own; embed it in Rhino (BlockManager) and save"
        )


def _definition(model: RhinoObject, geometry: RhinoObject) -> RhinoObject:
    """The block of an instance; None for other geometry, and if the file does not hold it."""
    if type(geometry).__name__ != "InstanceReference":
        return None
    return model.InstanceDefinitions.FindId(geometry.ParentIdefId)


def _members(model: RhinoObject, definition: RhinoObject) -> list[RhinoObject]:
    """Objects of a block; none for no block."""
    if definition is None:
        return []
    found = (model.Objects.FindId(str(each)) for each in definition.GetObjectIds())
    return [each for each in found if each is not None]


def _matrix(transform: RhinoObject) -> FloatArray:
    rows = [[getattr(transform, f"M{i}{j}") for j in range(4)] for i in range(4)]
    return np.array(rows, np.float64)
