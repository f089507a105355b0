"""A component in JSON, as Grasshopper asks for it.

New clients need ``InputNames`` and ``OutputNames`` and fail without a word where they are
missing; of an error they show ``message``, old ones ``Errors``.
"""

import json
from typing import Any

from ...nodes.graphs.annotations import type_name
from .components import Component, Input, Output
from .parameters import is_path


def describe(component: Component) -> dict[str, Any]:
    """What Grasshopper makes a component of.

    Parameters
    ----------
    component : Component

    Returns
    -------
    dict
        JSON.
    """
    name = component.name
    return {
        "Uri": f"/{name}",
        "Name": name,
        "Nickname": name,
        "Description": component.node.summary,
        "Category": "spheremesh",
        "Subcategory": component.category.replace("_", " ").capitalize(),
        "InputNames": [each.name for each in component.inputs],
        "OutputNames": [each.name for each in component.outputs],
        "Inputs": [_input(each) for each in component.inputs],
        "Outputs": [_output(each) for each in component.outputs],
        "Warnings": [],
        "Errors": [component.fault] if component.fault else [],
    }


def describe_error(message: str) -> dict[str, Any]:
    """What Grasshopper shows instead of a component.

    Parameters
    ----------
    message : str

    Returns
    -------
    dict
        JSON: empty lists, without which old clients fail.
    """
    return {
        "Description": "", "InputNames": [], "OutputNames": [], "Inputs": [], "Outputs": [],
        "Warnings": [], "Errors": [message], "message": message,
    }  # fmt: skip


def to_json(content: Any) -> bytes:  # noqa: ANN401
    """JSON without NaN, in UTF-8."""
    return json.dumps(content, ensure_ascii=False, allow_nan=False).encode(errors="replace")


def _input(each: Input) -> dict[str, Any]:
    port, form = each.port, each.carrier.form
    facts: dict[str, Any] = {
        "Name": each.name,
        "Nickname": each.name,
        "Description": describe_input(each),
        "ParamType": form.param_type,
        "AtLeast": each.at_least,
        "AtMost": each.at_most,
    }
    if each.default is not None:
        facts["Default"] = each.default
    if form.param_type in ("Number", "Integer"):
        limits = {"Minimum": port.min, "Maximum": port.max}
        facts.update({name: limit for name, limit in limits.items() if limit is not None})
    return facts


def describe_input(each: Input) -> str:
    """What an input is, in a sentence: its help, unit, choices, and how it may be given."""
    port, form = each.port, each.carrier.form
    facts = [port.help.rstrip(".") or type_name(port.type)]
    if port.unit:
        facts.append(f"in {port.unit}")
    if is_path(port, form):
        facts.append("a path within the folder of the server")
    elif form.is_coded:
        facts.append("a handle from a spheremesh component, or numbers as JSON")
    elif form.param_type == "Text" and (choices := _choices(each)):
        facts.append(choices)
    elif form.param_type in ("Plane", "Curve", "Brep") or each.name != port.name:
        facts.append(f"as {form.param_type.lower()}{'s' if form.is_list else ''}")
    if port.graph_units:
        facts.append("the units of the Rhino document by default")
    elif each.at_least == 0:
        facts.append("may be left out")
    return "; ".join(facts)


def _choices(each: Input) -> str:
    text = type_name(each.port.type)
    if each.port.choices:
        return "one of " + ", ".join(map(repr, each.port.choices))
    return text if "'" in text else ""


def _output(each: Output) -> dict[str, Any]:
    text = each.port.help.rstrip(".")
    if each.kinds:
        text = f"shown: {text}" if text else "shown"
    elif each.param_type == "Text" and not text:
        text = type_name(each.port.type)
    return {
        "Name": each.name,
        "Nickname": each.name,
        "Description": text,
        "ParamType": each.param_type,
        # Grasshopper passes it over; our own client knows by it what a single item is.
        "Access": "list" if each.is_list or each.nesting else "item",
    }
