"""Data trees of Grasshopper in JSON: branches by path, items with a type and a text."""

import re
from collections.abc import Mapping, Sequence
from typing import Any, Final, TypeAlias, cast

from ...kernel.errors import InputError

Path: TypeAlias = tuple[int, ...]
Item: TypeAlias = dict[str, Any]
"""``type``, a name of .NET, and ``data``, JSON or text."""
Tree: TypeAlias = dict[Path, list[Item]]
"""Branches in their order."""

MOST_BRANCHES: Final = 10_000
_PATH: Final = re.compile(r"\{?\s*\d{1,9}(\s*;\s*\d{1,9}){0,31}\s*\}?")


def read_trees(values: object) -> dict[str, Tree]:
    """The trees of a request by the name of their input.

    Parameters
    ----------
    values : list
        The entry ``values`` of the request.

    Returns
    -------
    dict of str to dict
        Branches without items are left out.

    Raises
    ------
    InputError
        If it is no list of trees; the message says where.
    """
    if not isinstance(values, list):
        raise InputError('the request needs a list "values"')
    found: dict[str, Tree] = {}
    none: Mapping[str, object] = {}
    for number, each in enumerate(cast("list[object]", values)):
        where = f"values[{number}]"
        tree = cast("Mapping[str, object]", each) if isinstance(each, Mapping) else none
        name, branches = tree.get("ParamName"), tree.get("InnerTree")
        if not isinstance(name, str) or not isinstance(branches, Mapping):
            raise InputError(f'{where}: needs a text "ParamName" and an object "InnerTree"')
        if name in found:
            raise InputError(f"{where}: {name!r} is given twice")
        found[name] = _read_tree(f"{where}.InnerTree", cast("Mapping[str, object]", branches))
    return found


def _read_tree(where: str, branches: Mapping[str, object]) -> Tree:
    if len(branches) > MOST_BRANCHES:
        raise InputError(f"{where}: more than {MOST_BRANCHES} branches")
    tree: Tree = {}
    for text, items in branches.items():
        if not isinstance(items, list):
            raise InputError(f"{where}: branch {text!r} is no list")
        several = cast("list[object]", items)
        if not all(isinstance(item, Mapping) for item in several):
            raise InputError(f"{where}: branch {text!r} holds what is no item")
        if several:
            tree[read_path(text, where)] = cast("list[Item]", several)
    return tree


def read_path(text: str, where: str) -> Path:
    """The numbers of a path.

    Raises
    ------
    InputError
        If it is none.

    Examples
    --------
    >>> read_path("{0;3}", "here")
    (0, 3)
    """
    if not _PATH.fullmatch(text.strip()):
        raise InputError(f"{where}: {text[:40]!r} is no path such as {{0;1}}")
    return tuple(int(part) for part in text.strip(" {}").split(";"))


def write_path(path: Path) -> str:
    """A path as Grasshopper writes it.

    Examples
    --------
    >>> write_path((0, 3))
    '{0;3}'
    """
    return f"{{{';'.join(map(str, path))}}}"


def write_tree(name: str, tree: Mapping[Path, Sequence[Item]]) -> dict[str, Any]:
    """A tree of an answer.

    Parameters
    ----------
    name : str
        Of the output.

    Returns
    -------
    dict
        For the entry ``values``.
    """
    branches = {write_path(path): list(items) for path, items in tree.items()}
    return {"ParamName": name, "InnerTree": branches}
