"""The points of a sweep, and the names of their folders."""

import re
from collections.abc import Iterable, Mapping, Sequence
from itertools import product
from typing import Any, Final

from ..graph import Graph
from ..specification.wires import Param
from ..stores.digests import digest

Point = dict[str, Any]

_LONGEST: Final = 80
_UNSAFE: Final = re.compile(r"[^A-Za-z0-9_.+-]")
"""What file systems or shells read as something else."""


def combined(graph: Graph, params: Mapping[str, Iterable[Any]]) -> list[Point]:
    """All combinations of values, the last slider fastest; checked before anything is run.

    Raises
    ------
    GraphError
        If a slider is unknown or a value not allowed.
    """
    axes = [list(values) for values in params.values()]
    return [
        graph.check_params(dict(zip(params, values, strict=True))) for values in product(*axes)
    ]


def in_order(graph: Graph, points: Sequence[Point]) -> list[int]:
    """Numbers of the points, such that those with most steps in common are neighbours.

    Sliders that feed early steps change last.
    """
    reach = {name: _reach(graph, name) for name in (points[0] if points else ())}
    sliders = sorted(reach, key=lambda name: -reach[name])
    places = {
        name: {digest(point[name]): place for place, point in reversed(list(enumerate(points)))}
        for name in sliders
    }
    return sorted(
        range(len(points)),
        key=lambda i: [places[name][digest(points[i][name])] for name in sliders],
    )


def _reach(graph: Graph, slider: str) -> int:
    """How many steps a slider changes."""
    reached: set[str] = set()
    for name, step in graph.steps.items():
        is_fed = any(isinstance(w, Param) and w.name == slider for _, w in step.sources)
        if is_fed or not reached.isdisjoint(step.parents):
            reached.add(name)
    return len(reached)


def folder_names(points: Sequence[Point]) -> list[str]:
    """A name for the folder of each point, from its values: the same in another sweep.

    Examples
    --------
    >>> folder_names([{"k": 3, "t": 0.5}, {"k": 3, "t": 1.0}])
    ['k=3_t=0.5', 'k=3_t=1.0']
    """
    names = [_name(point) for point in points]
    seen: dict[str, int] = {}
    for i, name in enumerate(names):
        # Systems that do not tell capitals apart would give two points one folder.
        seen[name.lower()] = count = seen.get(name.lower(), 0) + 1
        if count > 1:
            names[i] = f"{name}_{count}"
    return names


def _name(point: Point) -> str:
    texts = [f"{name}={_UNSAFE.sub('-', str(value))}" for name, value in point.items()]
    name = "_".join(texts)
    is_plain = all(
        isinstance(value, bool | int | float | str) and not _UNSAFE.search(str(value))
        for value in point.values()
    )
    if is_plain and len(name) <= _LONGEST:
        return name or "point"
    return f"{name[:_LONGEST]}_{digest(point).hex()[:8]}"
