"""Steps in an order in which each stands after those that it needs."""

from collections.abc import Mapping, Set
from graphlib import CycleError, TopologicalSorter
from typing import cast

from ..errors import GraphError


def ordered(needed: Mapping[str, Set[str]]) -> list[str]:
    """The names in their order, changed only where one stands before what it needs.

    Parameters
    ----------
    needed : mapping of str to set of str
        For each name those that it needs, all of them names too.

    Raises
    ------
    GraphError
        If they form a cycle, which the message shows.
    """
    try:
        TopologicalSorter(needed).prepare()
    except CycleError as error:
        cycle = " -> ".join(reversed(cast("list[str]", error.args[1])))
        raise GraphError(f"the steps form a cycle: {cycle}") from error
    position = {name: i for i, name in enumerate(needed)}
    found: dict[str, None] = {}
    for first in needed:
        pending = [first]
        while pending:
            name = pending[-1]
            missing = needed[name] - found.keys() if name not in found else ()
            if missing:
                pending.extend(sorted(missing, key=position.__getitem__, reverse=True))
            else:
                found.setdefault(pending.pop())
    return list(found)
