"""Values of ports, as Grasshopper takes them.

Numbers go as a whole number and a power of ten, ``25E-2``: Grasshopper reads them by the rules
of the user's language, in some of which a point parts thousands. NaN has no place in JSON; it
goes as the number that Rhino has for what is not set, infinity as the largest there is, and a
warning counts them.
"""

import json
import math
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from typing import Any, Final, Literal, TypeAlias, cast

import numpy as np

from ...fabrication.rhino_objects.curves import arc_fields, circle_fields
from ...fabrication.rhino_objects.meshes import mesh_fields
from ...fabrication.rhino_objects.solids import axis_lines, beam_solids, panel_breps
from ...kernel.arrays import BoolArray
from ...kernel.beams.beams import Beams
from ...kernel.errors import InputError, SpheremeshError
from ...kernel.meshes.mesh import Mesh
from ...kernel.panels.panels import Panels
from ...kernel.reports import Report
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...kernel.spheres.arcs import Arcs
from ...kernel.spheres.circles import Circles
from ...nodes.graphs.annotations import Value
from .handles import Handles
from .parameters import Form, ParamType
from .trees import Item, Tree

UNSET: Final = -1.23432101234321e308
"""What Rhino has for a number that is not set."""
MOST_SHOWN: Final = 3000
"""Panels or beams that a component shows unasked; the component ``show`` gives more."""
_LARGEST: Final = float(np.finfo(float).max)
_MOST_INT32: Final = 2**31

PanelsOf: TypeAlias = Callable[[SphereMesh], Panels]


@dataclass
class Exchange:
    """One answer while it is made.

    Attributes
    ----------
    handles : Handles
    panels_of : callable
        Cuts the panels of a sphere mesh, to show them.
    most_shown : int
    warnings : list of str
    is_lasting : bool
        Whether the answer is good as long as Grasshopper is open: handles may not be.
    """

    handles: Handles
    panels_of: PanelsOf
    most_shown: int = MOST_SHOWN
    warnings: list[str] = field(default_factory=list[str])
    is_lasting: bool = True

    def warn(self, text: str) -> None:
        """Say something on the component, once."""
        if text not in self.warnings:
            self.warnings.append(text)


Encode: TypeAlias = Callable[[Value, "Exchange", str], list[Item]]
"""Items of a value; the text is how messages name the output."""


def output_tree(
    value: Value, nesting: int, encode: Callable[[Value], list[Item]], *, is_list: bool
) -> Tree:
    """The branches of a value, and of lists of values.

    Parameters
    ----------
    nesting : int
        How deeply values stand in lists.
    encode : callable
        Gives the items of one.
    is_list : bool
        Whether one value has a branch of its own.

    Returns
    -------
    dict of tuple to list of dict
        By the end of the path.
    """
    if nesting == 0:
        return {(): encode(value)}
    if nesting == 1 and not is_list:
        return {(): [item for each in value for item in encode(each)]}
    tree: Tree = {}
    for index, each in enumerate(value):
        inner = output_tree(each, nesting - 1, encode, is_list=is_list)
        tree.update({(index, *path): items for path, items in inner.items()})
    return tree


def text_items(texts: Iterable[str]) -> list[Item]:
    """Texts as items: what old and new clients read alike.

    Old ones take away quotes and leave the rest, but read JSON objects with their escapes; new
    ones read JSON, and else the text as it is.
    """
    return [{"type": "System.String", "data": _text_data(text)} for text in texts]


_PLAIN: Final = re.compile(r'[^"\\\x00-\x1f]*')


def _text_data(text: str) -> str:
    text = text.encode(errors="replace").decode()
    is_json = text.lstrip().startswith("{")
    return json.dumps(text, ensure_ascii=False) if is_json or _PLAIN.fullmatch(text) else text


def number_text(number: float) -> str:
    """A number without a decimal point.

    Examples
    --------
    >>> number_text(0.25), number_text(-3.0), number_text(1e300)
    ('25E-2', '-3', '1E300')
    """
    sign, digits, exponent = Decimal(repr(float(number))).normalize().as_tuple()
    text = "".join(map(str, digits))
    power = int(exponent)
    if power >= 0 and len(text) + power <= 15:
        text, power = text + "0" * power, 0
    return f"{'-' * sign}{text}" + (f"E{power}" if power else "")


def _finite(numbers: Iterable[float], exchange: Exchange, where: str) -> list[float]:
    found = list(numbers)
    missing = [i for i, x in enumerate(found) if not math.isfinite(x)]
    for i in missing:
        found[i] = UNSET if math.isnan(found[i]) else math.copysign(_LARGEST, found[i])
    if missing:
        exchange.warn(
            f"{where}: {len(missing)} of {len(found)} numbers are not defined or not finite; "
            "Rhino's number for what is not set, or the largest there is, stands for them"
        )
    return found


def _numbers(value: Value, exchange: Exchange, where: str) -> list[Item]:
    numbers = _finite(_floats(value), exchange, where)
    return [{"type": "System.Double", "data": number_text(x)} for x in numbers]


def _floats(value: Value) -> list[float]:
    return np.ravel(np.asarray(value, float)).tolist()


def _integers(value: Value, exchange: Exchange, where: str) -> list[Item]:
    whole: list[int] = np.ravel(np.asarray(value)).tolist()
    if any(not -_MOST_INT32 <= number < _MOST_INT32 for number in whole):
        return _numbers(value, exchange, where)
    return [{"type": "System.Int32", "data": str(int(number))} for number in whole]


def _booleans(value: Value, _: Exchange, __: str) -> list[Item]:
    marks: list[bool] = np.ravel(np.asarray(value, bool)).tolist()
    return [{"type": "System.Boolean", "data": "true" if mark else "false"} for mark in marks]


def _triples(kind: Literal["Point3d", "Vector3d"]) -> Encode:
    def _encode(value: Value, exchange: Exchange, where: str) -> list[Item]:
        rows = np.asarray(value, float).reshape(-1, 3)
        is_whole: BoolArray = np.logical_and.reduce(np.isfinite(rows), axis=1)
        if not is_whole.all():
            exchange.warn(
                f"{where}: {int((~is_whole).sum())} of {len(rows)} are not defined; they are "
                "given as points that are not set"
            )
        rows = np.where(is_whole[:, None], rows, UNSET)
        return [
            _json_item(f"Rhino.Geometry.{kind}", dict(zip("XYZ", row, strict=True)))
            for row in rows.tolist()
        ]

    return _encode


def _json_item(kind: str, data: Mapping[str, Any]) -> Item:
    return {"type": kind, "data": json.dumps(data, allow_nan=False)}


def _texts(value: Value, _: Exchange, __: str) -> list[Item]:
    if isinstance(value, str | bytes) or not hasattr(value, "__iter__"):
        return text_items([str(value)])
    return text_items(map(str, value))


def _mesh(value: Value, _: Exchange, __: str) -> list[Item]:
    return [_json_item("Rhino.Geometry.Mesh", mesh_fields(value))]


def _coded(value: Value, exchange: Exchange, where: str) -> list[Item]:
    """Reports and small arrays as JSON, all else as handles."""
    if value is None or isinstance(value, bool | int | float | str):
        return text_items([value if isinstance(value, str) else json.dumps(plain(value))])
    if isinstance(value, Report):
        text = json.dumps(plain(value), ensure_ascii=False, allow_nan=False)
        exchange.handles.remember(text, value)
        return text_items([text])
    is_small = isinstance(value, np.ndarray) and cast("Any", value).size <= _SMALL
    if is_small and np.isfinite(cast("Any", value)).all():
        return text_items([json.dumps(value.tolist())])
    handle = exchange.handles.give(kind_name(value, where), value)
    exchange.is_lasting = exchange.is_lasting and exchange.handles.lasts(handle)
    return text_items([handle])


_SMALL: Final = 25
"""Numbers of an array that is given as they are: a transform has 25."""


def kind_name(value: Value, where: str = "") -> str:
    """What a value is, in words with underscores: ``sphere_mesh``.

    Parameters
    ----------
    where : str
        The output that gives it, for arrays.
    """
    is_named = hasattr(value, "_fields")
    if not is_named and isinstance(value, np.ndarray | list | tuple):
        return re.sub(r"[^a-z0-9_]", "_", where.rpartition(".")[2].lower()) or "list"
    name = str(getattr(value, "__class__", object).__name__)
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower().strip("_")


def plain(value: Value) -> Value:
    """A value as JSON has it; numbers that are not finite are None."""
    if isinstance(value, Mapping):
        items = cast("Mapping[Any, Any]", value)
        return {str(name): plain(item) for name, item in items.items()}
    if names := _field_names(value):
        return {name: plain(getattr(value, name)) for name in names}
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [plain(item) for item in cast("list[Any]", value)]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, bool | int | str) else str(value)


def _records(value: Value, exchange: Exchange, where: str) -> list[Item]:
    """Items of a list one by one: small records as JSON, others as handles."""
    items: list[Item] = []
    for each in value:
        if _is_small_record(each):
            items += text_items([json.dumps(plain(each), ensure_ascii=False, allow_nan=False)])
        else:
            items += _coded(each, exchange, where)
    return items


def _is_small_record(value: Value) -> bool:
    """Whether all that a record holds is numbers, texts and lists of them."""
    held = [getattr(value, name) for name in _field_names(value)]
    is_deep = any(isinstance(each, np.ndarray) or _field_names(each) for each in held)
    return bool(held) and not is_deep and not isinstance(value, Report)


def _field_names(value: Value) -> list[str]:
    """The fields of a record; none for all else."""
    return [] if isinstance(value, type) else list(getattr(value, "__dataclass_fields__", ()))


def _sphere_breps(value: Value, exchange: Exchange, where: str) -> list[Item]:
    if _is_too_many(value.mesh.n_faces, "panels", exchange, where):
        return []
    return _panel_breps(exchange.panels_of(value), exchange, where)


def _panel_breps(value: Value, exchange: Exchange, where: str) -> list[Item]:
    if _is_too_many(value.n_panels, "panels", exchange, where):
        return []
    breps, rejected = panel_breps(value)
    if rejected:
        exchange.warn(f"{where}: {len(rejected)} panels are not shown: {rejected[0].reason}")
    return [_json_item("Rhino.Geometry.Brep", brep) for brep in breps]


def _beam_breps(value: Value, exchange: Exchange, where: str) -> list[Item]:
    if _is_too_many(len(value.annuli.ids), "beams", exchange, where):
        return []
    return [_json_item("Rhino.Geometry.Extrusion", solid) for solid in beam_solids(value)]


def _is_too_many(count: int, what: str, exchange: Exchange, where: str) -> bool:
    if count <= exchange.most_shown:
        return False
    exchange.warn(
        f"{where}: {count} {what} are not shown unasked ({exchange.most_shown} at most); wire "
        "the handle to the component show"
    )
    return True


def _lines(value: Value, _: Exchange, __: str) -> list[Item]:
    if value.shape[1:] != (2, 3):
        return []
    return [_json_item("Rhino.Geometry.Line", line) for line in axis_lines(value)]


def _curves(value: Value, _: Exchange, __: str) -> list[Item]:
    fields = arc_fields(value) if isinstance(value, Arcs) else circle_fields(value)
    return [_json_item("Rhino.Geometry.Curve", curve) for curve in fields]


_ENCODERS: Final[dict[ParamType, Encode]] = {
    "Boolean": _booleans,
    "Integer": _integers,
    "Mesh": _mesh,
    "Number": _numbers,
    "Point": _triples("Point3d"),
    "Text": _texts,
    "Vector": _triples("Vector3d"),
}


def encoder(form: Form) -> Encode:
    """How values of a form are written.

    Returns
    -------
    callable
        Given a value, the exchange, and how messages name the output.
    """
    if form.is_coded:
        return _records if form.is_list else _coded
    return _ENCODERS[form.param_type]


@dataclass(frozen=True)
class Shape:
    """What is shown of values of a class besides their handles.

    Attributes
    ----------
    name : str
        Of the output.
    param_type : str
    encode : callable
    """

    name: str
    param_type: ParamType
    encode: Encode


def _safe(encode: Encode) -> Encode:
    """What cannot be shown is said, and spoils nothing: the handle is good."""

    def _encode(value: Value, exchange: Exchange, where: str) -> list[Item]:
        try:
            return encode(value, exchange, where)
        except (SpheremeshError, InputError) as error:
            exchange.warn(f"{where}: cannot be shown: {error}")
            return []

    return _encode


_CURVES: Final = Shape("curves", "Curve", _safe(_curves))
SHAPES: Final[dict[type, Shape]] = {
    SphereMesh: Shape("spheres", "Brep", _safe(_sphere_breps)),
    Panels: Shape("breps", "Brep", _safe(_panel_breps)),
    Beams: Shape("breps", "Brep", _safe(_beam_breps)),
    Arcs: _CURVES,
    Circles: _CURVES,
    Mesh: Shape("mesh", "Mesh", _safe(_mesh)),
}

AXES: Final = Shape("lines", "Line", _lines)
"""Node axes: two points of each."""


def _points(value: Value, exchange: Exchange, where: str) -> list[Item]:
    is_points = value.ndim == 2 and value.shape[1] == 3
    return _ENCODERS["Point"](value, exchange, where) if is_points else []


POINTS: Final = Shape("points", "Point", _points)
