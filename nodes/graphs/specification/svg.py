"""The picture of a graph, as SVG: sliders and steps in columns, each after those it needs."""

import html
from collections.abc import Iterator, Mapping
from typing import Final, NamedTuple

from ..annotations import Value
from .wires import Each, Param, Step, Wire

_LETTER, _HEIGHT, _GAP, _AISLE, _MARGIN = 7.0, 28, 12, 46, 12
"""Width of a letter, height of a box, and what is free between boxes, columns, and around."""

_RULES: Final = {
    "text": "font:12px sans-serif;fill:#34383e",
    "rect": "fill:#f4f4f1;stroke:#8a9099",
    "rect.slider": "fill:#dbe7f0", "path": "fill:none;stroke:#8a9099",
    "path.each": "stroke-width:3",
}  # fmt: skip
# Named, since the rules of a picture within a page hold for the whole page.
_STYLE: Final = "".join(f".graph-picture {what}{{{how}}}" for what, how in _RULES.items())


class _Box(NamedTuple):
    x: float
    y: float
    width: float
    text: str
    is_slider: bool


def svg_text(values: Mapping[str, Value], steps: Mapping[str, Step]) -> str:
    """A graph as an SVG picture.

    Parameters
    ----------
    values : mapping of str to object
        Of the sliders.
    steps : mapping of str to Step
        Each after those that it needs.

    Returns
    -------
    str
        One ``svg`` element; lists that are mapped over have thick wires.
    """
    boxes = _boxes(values, steps)
    width = max((box.x + box.width for box in boxes.values()), default=0) + _MARGIN
    height = max((box.y for box in boxes.values()), default=0) + _HEIGHT + _MARGIN
    parts = [*_wires(boxes, steps), *map(_drawn, boxes.values())]
    size = f'width="{width:g}" height="{height:g}" viewBox="0 0 {width:g} {height:g}"'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" class="graph-picture" {size}>'
        f"<style>{_STYLE}</style>{''.join(parts)}</svg>"
    )


def _boxes(values: Mapping[str, Value], steps: Mapping[str, Step]) -> dict[str, _Box]:
    """Boxes by name, sliders as ``param name``: rows follow those of what is needed."""
    needs: dict[str, list[str]] = {f"param {name}": [] for name in values}
    texts = {f"param {name}": f"{name} = {_short(value)}" for name, value in values.items()}
    for name, step in steps.items():
        needs[name] = [_source_name(source) for _, source in step.sources]
        same = step.node.name == name
        texts[name] = name if same else f"{name} ({step.node.name})"
    columns: dict[str, int] = {}
    for name, needed in needs.items():
        columns[name] = max((columns[each] + 1 for each in needed), default=0)
    for slider in [name for name in needs if name not in steps]:
        users = [columns[name] for name, needed in needs.items() if slider in needed]
        columns[slider] = min(users, default=1) - 1  # next to the first that it moves
    boxes: dict[str, _Box] = {}
    rows: dict[str, float] = {}
    x = float(_MARGIN)
    for column in range(max(columns.values(), default=-1) + 1):
        names = [name for name, place in columns.items() if place == column]
        wanted = {n: sum(rows[e] for e in needs[n]) / max(len(needs[n]), 1) for n in names}
        width = max(len(texts[name]) for name in names) * _LETTER + 20
        for row, name in enumerate(sorted(names, key=wanted.__getitem__)):
            rows[name] = row
            y = float(_MARGIN + row * (_HEIGHT + _GAP))
            boxes[name] = _Box(x, y, width, texts[name], name not in steps)
        x += width + _AISLE
    return boxes


def _source_name(source: Param | Wire) -> str:
    return f"param {source.name}" if isinstance(source, Param) else source.step.name


def _wires(boxes: Mapping[str, _Box], steps: Mapping[str, Step]) -> Iterator[str]:
    for name, step in steps.items():
        for port, source in step.sources:
            start, end = boxes[_source_name(source)], boxes[name]
            x, y = start.x + start.width, start.y + _HEIGHT / 2
            bend, to = (end.x - x) / 2, end.y + _HEIGHT / 2
            kind = ' class="each"' if isinstance(step.inputs[port], Each) else ""
            yield (
                f'<path{kind} d="M{x:g} {y:g}C{x + bend:g} {y:g} {end.x - bend:g} {to:g} '
                f'{end.x:g} {to:g}"><title>{html.escape(port)}</title></path>'
            )


def _drawn(box: _Box) -> str:
    kind, round_by = (' class="slider"', _HEIGHT / 2) if box.is_slider else ("", 4)
    return (
        f'<rect{kind} x="{box.x:g}" y="{box.y:g}" width="{box.width:g}" height="{_HEIGHT}" '
        f'rx="{round_by:g}"/><text x="{box.x + 10:g}" y="{box.y + 18:g}">'
        f"{html.escape(box.text)}</text>"
    )


def _short(value: Value) -> str:
    text = str(value)
    return text if len(text) <= 24 else f"{text[:21]}..."
