"""A graph as a picture for paper: steps in rows, each below those that it needs.

`Graph.svg` lies, for screens that scroll; a page of paper has room downwards.
"""

from collections.abc import Mapping
from html import escape
from typing import Any, cast

BOX = (116, 32)
COLUMN, ROW = 128, 62


def graph_picture(graph: Mapping[str, Any]) -> str:
    """SVG of a graph, given as its file has it; empty without steps."""
    steps: Mapping[str, Mapping[str, Any]] = graph.get("steps", {})
    if not steps:
        return ""
    sources = {name: _sources(step.get("inputs", {}), steps) for name, step in steps.items()}
    places = _places(sources)
    wires = "".join(
        _wire(places[source], places[name])
        for name, found in sources.items()
        for source in sorted(found)
    )
    boxes = "".join(_box(name, str(step["node"]), places[name]) for name, step in steps.items())
    width = COLUMN * (1 + max(column for column, _ in places.values()))
    height = ROW * max(row for _, row in places.values()) + BOX[1] + 8
    return (
        f'<svg class="graph" viewBox="0 0 {width} {height}" role="img" '
        f'aria-label="The graph of steps">{wires}{boxes}</svg>'
    )


def _sources(inputs: object, steps: Mapping[str, Any]) -> set[str]:
    """Steps whose outputs stand anywhere among the inputs of one."""
    if isinstance(inputs, Mapping):
        found: set[str] = set()
        values = cast("Mapping[str, object]", inputs)
        wire = values.get("wire")
        if isinstance(wire, str) and wire.split(".")[0] in steps:
            found.add(wire.split(".")[0])
        for value in values.values():
            found |= _sources(value, steps)
        return found
    if isinstance(inputs, list):
        entries = cast("list[object]", inputs)
        return {name for value in entries for name in _sources(value, steps)}
    return set()


def _places(sources: Mapping[str, set[str]]) -> dict[str, tuple[int, int]]:
    """Column and row of each step: columns as near to those of its sources as may be."""
    rows: dict[str, int] = {}
    for name, found in sources.items():
        # Steps of a file stand behind those that they need.
        rows[name] = 1 + max((rows.get(source, 0) for source in found), default=-1)
    taken: set[tuple[int, int]] = set()
    places: dict[str, tuple[int, int]] = {}
    for name in sorted(sources, key=lambda name: rows[name]):
        above = [places[source][0] for source in sources[name] if source in places]
        wanted = round(sum(above) / len(above)) if above else 0
        free = next(
            wanted + way * step
            for step in range(len(sources) + wanted + 1)
            for way in (1, -1)
            if wanted + way * step >= 0 and (wanted + way * step, rows[name]) not in taken
        )
        places[name] = free, rows[name]
        taken.add(places[name])
    return places


def _wire(start: tuple[int, int], end: tuple[int, int]) -> str:
    x, y = start[0] * COLUMN + BOX[0] / 2 + 4, start[1] * ROW + BOX[1] + 4
    u, v = end[0] * COLUMN + BOX[0] / 2 + 4, end[1] * ROW + 4
    bend = max(16.0, (v - y) / 2)
    path = f"M{x:.0f},{y} C{x:.0f},{y + bend:.0f} {u:.0f},{v - bend:.0f} {u:.0f},{v}"
    return f'<path d="{path}"/>'


def _box(name: str, node: str, place: tuple[int, int]) -> str:
    x, y = place[0] * COLUMN + 4, place[1] * ROW + 4
    left, words = x + 7, escape(node)
    note = "" if node == name else f'<tspan x="{left}" dy="12" class="fine">{words}</tspan>'
    return (
        f'<rect x="{x}" y="{y}" width="{BOX[0]}" height="{BOX[1]}" rx="5"/>'
        f'<text x="{left}" y="{y + (14 if note else 20)}">{escape(name)}{note}</text>'
    )
