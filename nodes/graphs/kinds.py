"""Kinds of annotations: which values an input takes, and which wires."""

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields, is_dataclass
from numbers import Complex, Integral, Number, Real
from pathlib import Path
from typing import Any, Literal, cast, get_args, get_type_hints

import numpy as np

from .annotations import (
    Hint,
    Member,
    Value,
    element_type,
    is_subclass,
    members,
    scalar_type,
)
from .arrays import as_array, is_other_array, takes_array


def accepts(hint: Hint, value: Value) -> bool:
    """Whether a value may go into an input of a type.

    Returns
    -------
    bool
        True also where the annotation cannot be decided at run time.

    Examples
    --------
    >>> accepts(float, 1), accepts(int, 1.5), accepts(int | None, None)
    (True, False, True)
    """
    return any(_row(member).takes(member, value) for member in members(hint))


def fits(source: Hint, target: Hint) -> bool:
    """Whether an output of one type may be wired into an input of another.

    Parameters
    ----------
    source, target : type
        Annotations of the output and the input.

    Returns
    -------
    bool
        False only if no value of the source could be accepted.

    Examples
    --------
    >>> fits(int, float), fits(float, int), fits(str, float | None)
    (True, False, False)
    """
    return any(_fits(a, b) for a in members(source) for b in members(target))


def _fits(source: Member, target: Member) -> bool:
    if source.kind is Literal:
        return any(_row(target).takes(target, option) for option in get_args(source.hint))
    return source.kind is Any or source == target or _row(target).wires(target, source)


def convert(hint: Hint, value: Value) -> Value:
    """The value in the form that a function expects: lists become arrays, texts paths.

    Parameters
    ----------
    value : object
        A value that it accepts.

    Returns
    -------
    object
        The value itself if it is of the annotated type.
    """
    options = members(hint)
    is_of_type = any(isinstance(m.kind, type) and _is_instance(m, value) for m in options)
    if is_of_type and not is_other_array(hint, value):
        return value
    for member in options:
        row = _row(member)
        if isinstance(value, row.convertible) and row.takes(member, value):
            return row.convert(member, value)
    return value


@dataclass(frozen=True)
class _Row:
    """What an input of one kind takes: values, and wires by their source; and what it converts.

    All rules are given the alternative of the input first.
    """

    takes: Callable[[Member, Value], bool]
    wires: Callable[[Member, Member], bool]
    convertible: tuple[type, ...] = ()
    convert: Callable[[Member, Value], Value] = lambda _, value: value


def _row(target: Member) -> _Row:
    return _RECORD if _is_record(target.kind) else _ROWS.get(target.kind, _OTHERS)


def _is_record(kind: Hint) -> bool:
    """Whether it is a report: a dataclass that is a mapping of its fields."""
    return is_dataclass(kind) and _is_class(kind, Mapping)


def record_fault(hint: Hint, value: Value) -> str:
    """What keeps a mapping from being the report that an input takes.

    Parameters
    ----------
    hint : type
        Of the input.
    value : object
        What it was given.

    Returns
    -------
    str
        The end of a message; empty if no report is asked for or no mapping given.
    """
    kinds = [member.kind for member in members(hint) if _is_record(member.kind)]
    if not kinds or not isinstance(value, dict) or accepts(hint, value):
        return ""
    given = cast("dict[str, Value]", value)
    hints, needed = _record_fields(kinds[0])
    faults = [f"misses {name!r}" for name in needed if name not in given]
    faults += [f"has no entry {str(name)[:40]!r}" for name in given if name not in hints]
    if not faults:
        faults = [f"{n!r} is none" for n, item in given.items() if not accepts(hints[n], item)]
    rest = f", ... {len(faults) - 8} more" if len(faults) > 8 else ""
    return f": {kinds[0].__name__} {', '.join(faults[:8])}{rest}"


def _record_fields(kind: type[Any]) -> tuple[dict[str, Hint], list[str]]:
    """Types of the fields of a record, and the names of those without a default."""
    needed = [f.name for f in fields(kind) if f.default is f.default_factory is MISSING]
    return get_type_hints(kind), needed


def _is_record_of(target: Member, value: Value) -> bool:
    if not isinstance(value, dict):
        return _is_instance(target, value)
    given = cast("dict[str, Value]", value)
    hints, needed = _record_fields(target.kind)
    return set(needed) <= given.keys() <= hints.keys() and all(
        accepts(hints[name], item) for name, item in given.items()
    )


def _number_row(kind: type) -> _Row:
    """Numbers, those of NumPy included; bool is none."""
    return _Row(
        lambda _, value: isinstance(value, kind) and not is_bool(value),
        lambda _, source: source.kind is not bool and _is_class(source.kind, kind),
    )


_BOOLS = (bool, np.bool_)


def is_bool(value: Value) -> bool:
    """Whether a value is True or False, of Python or of NumPy: False for 0 and 1."""
    return isinstance(value, _BOOLS)


def _is_choice(target: Member, value: Value) -> bool:
    options = get_args(target.hint)
    # an array compares entry by entry
    return not isinstance(value, np.ndarray) and any(
        value == x and is_bool(value) == is_bool(x) for x in options
    )


def _may_be_choice(target: Member, source: Member) -> bool:
    return any(_fits(source, Member(type(x), type(x))) for x in get_args(target.hint))


def _may_be_array(target: Member, source: Member) -> bool:
    if source.kind is not np.ndarray:
        return _is_list_of_numbers(source)
    a, b = source.facts, target.facts
    if a is None or b is None:
        scalars = scalar_type(source), scalar_type(target)
        return None in scalars or (scalars[0] is np.str_) == (scalars[1] is np.str_)
    is_same_kind = scalar_type(source) is scalar_type(target)
    return (
        is_same_kind and len(a.shape) == len(b.shape) and all(map(_is_same, a.shape, b.shape))
    )


def _is_same(a: str | int, b: str | int) -> bool:
    return a == b or ("N" in (a, b) and isinstance(a, str) and isinstance(b, str))


def _is_list_of_numbers(source: Member) -> bool:
    if source.kind in (str, bytes) or not _is_class(source.kind, Sequence):
        return False
    return any(
        item.kind in (Any, np.ndarray)
        or _is_class(item.kind, (Number, np.bool_))
        or _is_list_of_numbers(item)
        for item in members(element_type(source.hint))
    )


def _is_tuple(target: Member, value: Value) -> bool:
    """Lists will do: JSON knows nothing else."""
    if not isinstance(value, list | tuple):
        return False
    items, elements = cast("Sequence[Value]", value), get_args(target.hint)
    if not elements or elements[-1] is ...:
        return _are_elements(target, items)
    return len(items) == len(elements) and all(map(accepts, elements, items))


def _may_be_tuple(target: Member, source: Member) -> bool:
    return source.kind is not str and _may_be_member(Member(target.hint, Sequence), source)


def _is_list(target: Member, value: Value) -> bool:
    return isinstance(value, np.ndarray) or (
        not isinstance(value, str) and _is_member(target, value)
    )


def _may_be_list(target: Member, source: Member) -> bool:
    return source.kind is np.ndarray or (
        source.kind is not str and _may_be_member(target, source)
    )


def _is_member(target: Member, value: Value) -> bool:
    if not _is_instance(target, value):
        return False
    is_list = isinstance(value, list | tuple)
    return not is_list or _are_elements(target, cast("Sequence[Value]", value))


def _may_be_member(target: Member, source: Member) -> bool:
    if not is_subclass(source.kind, target.kind):
        return False
    is_list = is_subclass(target.kind, Sequence)
    return not is_list or fits(element_type(source.hint), element_type(target.hint))


def _is_path(_: Member, value: Value) -> bool:
    return isinstance(value, str | os.PathLike)


def _may_be_path(_: Member, source: Member) -> bool:
    return source.kind is str or is_subclass(source.kind, os.PathLike)


def _are_elements(target: Member, items: Sequence[Value]) -> bool:
    element = element_type(target.hint)
    return all(accepts(element, item) for item in items)


def _is_instance(target: Member, value: Value) -> bool:
    try:
        return isinstance(value, target.kind)
    except TypeError:  # a protocol that is not checkable, a callable's signature
        return True


def _is_class(kind: Hint, base: Hint) -> bool:
    return is_subclass(kind, base, undecided=False)


_ANYTHING = _Row(lambda _, __: True, lambda _, __: True)
_RECORD = _Row(
    _is_record_of, _may_be_member, (dict,), lambda target, value: target.kind(**value)
)
_LIST = _Row(_is_list, _may_be_list)
_ROWS: dict[Hint, _Row] = {
    Any: _ANYTHING,
    object: _ANYTHING,
    Literal: _Row(_is_choice, _may_be_choice),
    bool: _Row(lambda _, value: is_bool(value), lambda _, source: source.kind in _BOOLS),
    int: _number_row(Integral),
    float: _number_row(Real),
    complex: _number_row(Complex),
    Sequence: _LIST,
    Iterable: _LIST,
    tuple: _Row(_is_tuple, _may_be_tuple, (list,), lambda _, value: tuple(value)),
    np.ndarray: _Row(takes_array, _may_be_array, (list, tuple, np.ndarray), as_array),
    Path: _Row(_is_path, _may_be_path, (str,), lambda _, value: Path(value)),
    str: _Row(_is_path, _may_be_path, (os.PathLike,), lambda _, value: str(value)),
}
_OTHERS = _Row(_is_member, _may_be_member)
