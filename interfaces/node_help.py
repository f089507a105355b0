"""The help of a node on the command line."""

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
            click.echo(f"  {port.name} : {_port_facts(port)}")
            if port.help:
                click.echo(textwrap.indent(textwrap.fill(port.help, 84), "      "))
            if isinstance(port.type, type) and issubclass(port.type, Report):
                fields = (inspect.getdoc(port.type) or "").partition("-\n")[2]
                click.echo(textwrap.indent(fields, "        "))


def _port_facts(port: Port) -> str:
    """Type, unit, range and default of a port, in one line."""
    facts = [f"{type_name(port.type)} in {port.unit}" if port.unit else type_name(port.type)]
    if port.min is not None:
        facts.append(f"at least {port.min:g}")
    if port.max is not None:
        facts.append(f"at most {port.max:g}")
    if port.default is not REQUIRED:
        facts.append(f"default {port.default!r}")
    return ", ".join(facts)
