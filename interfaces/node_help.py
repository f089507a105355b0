"""The help of a node, for the command line and the reference."""

import inspect
import textwrap

import click

from ..kernel.reports import Report
from ..nodes.graphs.annotations import type_name
from ..nodes.graphs.node import Node
from ..nodes.graphs.ports import REQUIRED, Port


def print_node(node: Node) -> None:
    """Print what a node does, and its inputs and outputs.

    Parameters
    ----------
    node : Node
    """
    click.echo(f"{click.style(node.name, bold=True)} ({node.category})\n\n{node.summary}")
    for title, ports in (("Inputs", node.inputs), ("Outputs", node.outputs)):
        click.echo(f"\n{click.style(title, bold=True)}")
        for port in ports.values():
            click.echo(f"  {port.name} : {port_facts(port)}")
            if port.help:
                click.echo(textwrap.indent(textwrap.fill(port.help, 84), "      "))
            click.echo(textwrap.indent(report_fields(port), "        "), nl=False)


def port_facts(port: Port) -> str:
    """Type, unit, range, choices and default of a port, in one line.

    Parameters
    ----------
    port : Port

    Returns
    -------
    str
        The default is told where there is one.

    Examples
    --------
    >>> port_facts(Port(type=float, default=0.0, unit="deg", min=0, max=90))
    'float in deg, at least 0, at most 90, default 0.0'
    """
    facts = [f"{type_name(port.type)} in {port.unit}" if port.unit else type_name(port.type)]
    if port.choices:
        facts.append(f"one of {', '.join(map(repr, port.choices))}")
    if port.min is not None:
        facts.append(f"at least {port.min:g}")
    if port.max is not None:
        facts.append(f"at most {port.max:g}")
    if port.default is not REQUIRED:
        facts.append(f"default {port.default!r}")
    if port.graph_units:
        facts.append("in a graph its units")
    return ", ".join(facts)


def report_fields(port: Port) -> str:
    """What the fields of a report are, line by line as in the docstring of its class.

    Parameters
    ----------
    port : Port

    Returns
    -------
    str
        Ends with a line; empty if the port is no report.
    """
    if not (isinstance(port.type, type) and issubclass(port.type, Report)):
        return ""
    return (inspect.getdoc(port.type) or "").partition("-\n")[2] + "\n"
