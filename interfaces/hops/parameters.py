"""Which parameters of Grasshopper carry the values of a port."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Integral, Real
from types import NoneType
from typing import Any, Final, Literal, TypeAlias, get_args

import numpy as np

from ...kernel.meshes.mesh import Mesh
from ...kernel.spheres.arcs import Arcs
from ...kernel.spheres.circles import Circles
from ...kernel.surfaces.surface import Surface
from ...nodes.graphs.annotations import Hint, Member, is_subclass, members, scalar_type
from ...nodes.graphs.ports import Port

ParamType: TypeAlias = Literal[
    "Boolean", "Brep", "Curve", "Integer", "Line", "Mesh", "Number", "Plane", "Point", "Text",
    "Vector",
]  # fmt: skip
"""Parameters, by the names that Grasshopper has for them."""

_VECTORS: Final = ("vector", "vectors", "normals", "directions")
"""What arrays of three numbers hold that are no points."""


@dataclass(frozen=True)
class Form:
    """How a parameter carries a value.

    Attributes
    ----------
    param_type : str
    is_list : bool
        Whether the value is a list of items of the parameter.
    is_coded : bool
        Whether a text stands for the value, as a handle or as JSON.
    """

    param_type: ParamType
    is_list: bool = False
    is_coded: bool = False


CODED: Final = Form("Text", is_coded=True)


@dataclass(frozen=True)
class Carrier:
    """A parameter that carries values of a port.

    Attributes
    ----------
    form : Form
    members : tuple of Member
        The alternatives of the type of the port that it carries.
    """

    form: Form
    members: tuple[Member, ...]


def carriers(port: Port) -> tuple[Carrier, ...]:
    """The parameters that carry values of an input.

    Parameters
    ----------
    port : Port

    Returns
    -------
    tuple of Carrier
        In the order of the alternatives of its type: an input that takes a mesh or a sphere
        mesh has two.
    """
    found: dict[ParamType, list[tuple[Form, Member]]] = {}
    for member in members(port.type):
        # A text is a path where files are read, so nothing else may come as one.
        if is_file(port) and not _may_be_path(member) and member.kind is not Mesh:
            continue
        for form in forms_of(member):
            found.setdefault(form.param_type, []).append((form, member))
    return tuple(
        Carrier(
            Form(
                param_type,
                any(form.is_list for form, _ in several),
                any(form.is_coded for form, _ in several),
            ),
            tuple(member for _, member in several),
        )
        for param_type, several in found.items()
    )


def is_file(port: Port) -> bool:
    """Whether an input takes paths of files."""
    return port.reads or port.writes


def is_path(port: Port, form: Form) -> bool:
    """Whether a parameter carries paths of files."""
    return is_file(port) and form.param_type == "Text"


def _may_be_path(member: Member) -> bool:
    return is_subclass(member.kind, (str, os.PathLike), undecided=False)


def forms_of(member: Member) -> tuple[Form, ...]:
    """How values of one alternative are carried; the first is the usual one.

    Returns
    -------
    tuple of Form
        Empty for None.
    """
    kind = member.kind
    if kind is NoneType:
        return ()
    if kind is Literal:
        return (_of_class(type(get_args(member.hint)[0])),)
    if kind is np.ndarray:
        return _of_array(member)
    if kind in _SHAPES:
        return _SHAPES[kind]
    if kind is not str and is_subclass(kind, Sequence, undecided=False):
        return (_of_elements(member.hint),)
    return (_of_class(kind),)


_SHAPES: Final[dict[Any, tuple[Form, ...]]] = {
    Mesh: (Form("Mesh"),),
    Surface: (CODED, Form("Brep", is_list=True)),
    Arcs: (CODED, Form("Curve", is_list=True)),
    Circles: (CODED, Form("Curve", is_list=True)),
}


def _of_class(kind: Hint) -> Form:
    by_class: tuple[tuple[Hint, ParamType], ...] = (
        (bool, "Boolean"),
        (Integral, "Integer"),
        (Real, "Number"),
        ((str, os.PathLike), "Text"),
    )
    for base, param_type in by_class:
        if is_subclass(kind, base, undecided=False):
            return Form(param_type)
    return CODED


def _of_elements(hint: Hint) -> Form:
    """Of a list or tuple: that of its elements, if one parameter carries them one by one."""
    elements = [option for each in get_args(hint)[:1] for option in members(each)]
    forms = {form for option in elements for form in forms_of(option)}
    if len(forms) == 1 and not (form := forms.pop()).is_list:
        return Form(form.param_type, is_list=True, is_coded=form.is_coded)
    return Form("Text", is_list=True, is_coded=True)


def _of_array(member: Member) -> tuple[Form, ...]:
    facts = member.facts
    if facts is None:
        return (CODED,)
    shape, holds = facts.shape, facts.holds.replace(",", " ").split()[0]
    first, last = shape[0], shape[-1]
    if len(shape) == 1 and isinstance(first, str):
        kind = scalar_type(member)
        form = Form("Text") if kind is np.str_ else _of_class(_PYTHON.get(kind, float))
        return (Form(form.param_type, is_list=True),)
    if last == 3 and len(shape) <= 2:
        is_vector = holds in _VECTORS or isinstance(first, int)
        return (Form("Vector" if is_vector else "Point", is_list=len(shape) == 2),)
    plane = _PLANES.get((holds, first)) if last == 5 and len(shape) <= 2 else None
    return (CODED,) if plane is None else (CODED, plane)


_PLANES: Final[dict[tuple[str, str | int], Form]] = {
    ("sphere", 5): Form("Plane"),
    ("spheres", "N"): Form("Plane", is_list=True),
}
"""Arrays of spheres that may come as planes: by what they hold, and how many there are."""
_PYTHON: Final[dict[Hint, type]] = {np.bool_: bool, np.int64: int, np.float64: float}
