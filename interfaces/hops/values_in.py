"""Values that Grasshopper sends, as those of ports."""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, cast

import numpy as np

from ...fabrication.rhino_objects.curves import curves_of_fields
from ...fabrication.rhino_objects.meshes import mesh_of_fields
from ...fabrication.rhino_objects.surfaces import surface_of_fields
from ...kernel.errors import InputError
from ...kernel.spheres.rows import from_plane
from ...kernel.surfaces.row_counts import GridSize
from ...nodes.graphs.annotations import Member, Value, scalar_type
from .handles import Handles, is_handle
from .parameters import Carrier, ParamType
from .trees import Item

GRID: Final = GridSize(24, 24)
"""Rows of faces on a surface that comes from Grasshopper."""


def port_value(carrier: Carrier, items: Sequence[Item], where: str, handles: Handles) -> Value:
    """What a port is given for the items of a parameter.

    Parameters
    ----------
    carrier : Carrier
    items : sequence of dict
        One item, or those of a list.
    where : str
        How messages name the input.
    handles : Handles

    Returns
    -------
    object
        A number, text, array, list, or record of the kernel.

    Raises
    ------
    InputError
        If an item is not what the parameter carries; the message says which.
    """
    form = carrier.form
    try:
        if form.param_type == "Brep":
            return surface_of_fields([_object(item) for item in items], GRID)
        if form.param_type == "Curve":
            return curves_of_fields([_object(item) for item in items])
    except InputError as error:
        raise InputError(f"{where}: {error}") from error
    values: list[Value] = []
    for number, item in enumerate(items):
        at = where if len(items) == 1 else f"{where}, item {number}"
        if form.is_coded:
            values.append(_coded(_text(item), at, handles))
            continue
        try:
            values.append(_READERS[form.param_type](item))
        except InputError as error:
            raise InputError(f"{at}: {error}") from error
    return _joined(carrier, values)


def _joined(carrier: Carrier, values: list[Value]) -> Value:
    """One value of the items: a scalar if the port takes one, or else an array or a list."""
    if not carrier.form.is_list:
        return values[0]
    arrays = [member for member in carrier.members if member.kind is np.ndarray]
    has_one = len(values) == 1 and any(map(_is_single, carrier.members))
    if has_one:
        return np.asarray(values[0], float) if arrays and _is_row(values[0]) else values[0]
    if arrays and not carrier.form.is_coded:
        return np.array(values, scalar_type(arrays[0]))
    return values


def _is_single(member: Member) -> bool:
    """Whether an alternative is one item and not a list of them."""
    if member.kind is np.ndarray:
        facts = member.facts
        return facts is not None and len(facts.shape) == 1 and isinstance(facts.shape[0], int)
    return member.kind not in (list, tuple, Sequence)


def _is_row(value: Value) -> bool:
    return isinstance(value, list | tuple)


def item_data(item: Item) -> Value:
    """The data of an item, read as JSON where it is JSON.

    Raises
    ------
    InputError
        If a number in it is not finite.
    """
    data = item.get("data")
    if not isinstance(data, str):
        return data
    try:
        return json.loads(data, parse_constant=_no_constant)
    except (ValueError, RecursionError) as error:
        if isinstance(error, InputError):
            raise
        return data


def _no_constant(text: str) -> Value:
    raise InputError(f"{text} is no finite number")


def _text(item: Item) -> str:
    value = item.get("data")
    if not isinstance(value, str):
        return json.dumps(value)
    try:
        # A text of digits would be read as a number, and lose how it was written.
        found: Value = json.loads(value) if value.startswith('"') else value
    except (ValueError, RecursionError):
        return value
    return found if isinstance(found, str) else value


def _number(item: Item) -> float:
    value = item_data(item)
    if isinstance(value, str):
        try:
            value = float(value)
        except ValueError:
            raise InputError(f"{value[:40]!r} is no number") from None
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{str(value)[:40]} is no number")
    if isinstance(value, float) and not math.isfinite(value):
        raise InputError(f"{value} is no finite number")
    return value


def _integer(item: Item) -> int:
    value = _number(item)
    if value != int(value):
        raise InputError(f"{value} is no whole number")
    return int(value)


def _boolean(item: Item) -> bool:
    value = item_data(item)
    if isinstance(value, str) and value.lower() in ("true", "false"):
        return value.lower() == "true"
    if not isinstance(value, bool):
        raise InputError(f"{str(value)[:40]} is neither True nor False")
    return value


def _object(item: Item) -> dict[str, Any]:
    value = item_data(item)
    if not isinstance(value, dict):
        kind = str(item.get("type", "")).rpartition(".")[2] or "what was sent"
        raise InputError(f"{kind} is nothing that is taken here")
    return cast("dict[str, Any]", value)


def _triple(fields: Mapping[str, Any]) -> list[float]:
    try:
        numbers = [float(fields[axis]) for axis in ("X", "Y", "Z")]
    except (KeyError, TypeError, ValueError):
        raise InputError("it has no coordinates X, Y, Z") from None
    if not all(math.isfinite(x) and abs(x) < _UNSET for x in numbers):
        raise InputError("its coordinates are not finite")
    return numbers


_UNSET: Final = 1e300
"""Rhino has a number of this size for coordinates that are not set."""


def _point(item: Item) -> list[float]:
    fields = _object(item)
    return _triple(fields.get("Origin", fields))


def _plane(item: Item) -> list[float]:
    """A plane as a row of the sphere geometry."""
    fields = _object(item)
    try:
        origin = np.array(_triple(fields["Origin"]))
        normal = np.cross(_triple(fields["XAxis"]), _triple(fields["YAxis"]))
    except KeyError as error:
        raise InputError(f"it is no plane: {error} is missing") from None
    length = float(np.linalg.norm(normal))
    if not length:
        raise InputError("it is no plane: its axes are parallel")
    normal /= length
    return from_plane(normal, normal @ origin).tolist()


def _coded(text: str, where: str, handles: Handles) -> Value:
    """The value of a handle, or of JSON."""
    if is_handle(text):
        return handles.take(text, where)
    known = handles.recall(text)
    if known is not None:
        return known
    try:
        return json.loads(text, parse_constant=_no_constant)
    except (ValueError, RecursionError) as error:
        if isinstance(error, InputError):
            raise InputError(f"{where}: {error}") from error
        raise InputError(
            f"{where}: {text[:60]!r} is no handle; wire it to a spheremesh component, or give "
            "numbers as JSON, such as [1, 2, 3]"
        ) from error


_READERS: Final[dict[ParamType, Callable[[Item], Value]]] = {
    "Boolean": _boolean,
    "Integer": _integer,
    "Mesh": lambda item: mesh_of_fields(_object(item)),
    "Number": _number,
    "Plane": _plane,
    "Point": _point,
    "Text": _text,
    "Vector": _point,
}
