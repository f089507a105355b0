"""The picture of a graph, as text."""

from collections.abc import Mapping

from ..annotations import Value
from .wires import Each, Param, Step


def mermaid_text(values: Mapping[str, Value], steps: Mapping[str, Step]) -> str:
    """A graph as a Mermaid flowchart.

    Parameters
    ----------
    values : mapping of str to object
    steps : mapping of str to Step

    Returns
    -------
    str
        Text that Markdown viewers draw; lists that are mapped over have thick arrows.
    """
    # prefixed: a step called "end" would end the chart
    lines = ["flowchart LR"]
    lines += [f'  param_{name}(["{name} = {_brief(v)}"])' for name, v in values.items()]
    lines += [f'  step_{name}["{_label(step)}"]' for name, step in steps.items()]
    for name, step in steps.items():
        for port, source in step.sources:
            arrow = "==>" if isinstance(step.inputs[port], Each) else "-->"
            if isinstance(source, Param):
                lines.append(f"  param_{source.name} {arrow}|{port}| step_{name}")
                continue
            many = len(source.step.wires) > 1 and source.port.name != port
            text = f"{source.port.name} to {port}" if many else port
            lines.append(f"  step_{source.step.name} {arrow}|{text}| step_{name}")
    return "\n".join(lines) + "\n"


def _label(step: Step) -> str:
    node = step.node.name
    return step.name if step.name == node else f"{step.name} ({node})"


def _brief(value: Value) -> str:
    text = str(value)
    return (text if len(text) <= 40 else f"{text[:37]}...").replace('"', "#quot;")
