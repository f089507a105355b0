"""Lists as values: what steps mapped over lists give, put in another form."""

from collections.abc import Sequence
from typing import Annotated, Any, cast

from ..graphs.node import node
from ..graphs.ports import Port


@node
def flatten(
    values: Sequence[Any], levels: Annotated[int | None, Port(min=0)] = None
) -> list[Any]:
    """One list of the items of nested lists.

    Parameters
    ----------
    values : list
        Lists within lists, as steps give that are mapped over several axes.
    levels : int, optional
        How many levels to take away; by default all of them.

    Returns
    -------
    list
        The items in their order. Arrays and tuples are items.

    Examples
    --------
    >>> from spheremesh.nodes import flatten
    >>> flatten([[1, 2], [3, [4]]]), flatten([[1, 2], [3, [4]]], levels=1)
    ([1, 2, 3, 4], [1, 2, 3, [4]])
    """
    if levels == 0:
        return list(values)
    items: list[Any] = []
    for value in values:
        if isinstance(value, list):
            below = None if levels is None else levels - 1
            items += flatten(cast("list[Any]", value), below)
        else:
            items.append(value)
    return items
