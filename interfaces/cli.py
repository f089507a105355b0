"""The command line.

The docstrings of the commands are their help: click adds the options.

Exit codes: 0 done, 1 a library of the system is missing or a node is at fault, 2 usage, 3 bad
input, 4 not converged, 5 finished but a quality gate failed. An error is one line on standard
error.
"""

import json
import sys
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .cache_option import cache_options, chosen_store
from .console import GATE_FAILED, shown_progress, told_errors
from .option_values import plain_value, setting
from .panel_command import panel
from .serve_command import serve
from .studio_command import studio
from .sweep_command import sweep

if TYPE_CHECKING:
    from ..fabrication.output_folder import OutputFolder
    from ..nodes.graphs.graph import Graph
    from .panel.job import Progress


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="spheremesh")
def main() -> None:
    """Turn design surfaces into spherical panels that can be built."""


@main.command()
@click.argument("graph_file", metavar="GRAPH.json", type=click.Path(path_type=Path))
@click.option("--set", "settings", multiple=True, metavar="NAME=VALUE", help="Move a slider.")
@click.option("--target", "targets", multiple=True, metavar="STEP.PORT", help="What to run.")
@click.option(
    "-o", "--out", default=".", type=click.Path(path_type=Path), help="Folder for its files."
)
@click.option("--overwrite", is_flag=True, help="Replace files that spheremesh did not write.")
@click.option("--allow-outside", is_flag=True, help="Let steps write outside of the folder.")
@click.option("--strict", is_flag=True, help="Exit with 5 if the audit finds errors.")
@click.option("--json", "as_json", is_flag=True, help="Print the targets' values as JSON.")
@cache_options
def run(  # numpydoc ignore=PR01
    graph_file: Path, settings: tuple[str, ...], targets: tuple[str, ...], out: Path, *,
    overwrite: bool, allow_outside: bool, strict: bool, as_json: bool,
    **keeping: Any,  # noqa: ANN401
) -> None:  # fmt: skip
    """Run a graph: all of it, or what a target needs.

    Relative paths are read from the working directory and written to the output folder, and
    nothing is written elsewhere. The graph of a panel job writes its report and itself anew;
    other files are replaced only if spheremesh wrote them and nobody changed them since.
    """
    from ..fabrication.output_folder import output_folder
    from .panel import is_panel_job, run_job
    from .panel.output import has_errors, print_report

    with told_errors(), shown_progress() as progress:
        from ..nodes.graphs.graph import Graph

        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            graph = Graph.load(graph_file)
        for warning in caught:
            click.echo(f"warning: {warning.message}", err=True)
        graph.cache = chosen_store(**keeping)
        graph.set(**dict(setting(text) for text in settings))
        if targets or not is_panel_job(graph):
            with output_folder(
                out, inputs=(graph_file,), overwrite=overwrite, allow_outside=allow_outside
            ) as output:
                values = _run_targets(graph, targets, output, progress)
            _print_values(graph, values, as_json=as_json)
            return
        report, files = run_job(
            graph, out, progress, graph_file=graph_file, overwrite=overwrite,
            allow_outside=allow_outside,
        )  # fmt: skip
    print_report(report, out, files, as_json=as_json)
    if strict and has_errors(report):
        sys.exit(GATE_FAILED)


def _run_targets(
    graph: "Graph", targets: tuple[str, ...], out: "OutputFolder", progress: "Progress"
) -> dict[str, Any]:
    from .panel import said_to

    names = targets or tuple(step.name for step in graph.ends)
    results = graph.run(*names, on_step=progress, on_event=said_to(progress), write_to=out)
    return dict(zip(names, (results,) if len(names) == 1 else results, strict=True))


def _print_values(graph: "Graph", values: Mapping[str, Any], *, as_json: bool) -> None:
    for messages in graph.messages.values():
        for text in messages:
            click.echo(f"warning: {text}", err=True)
    plain = {name: plain_value(value) for name, value in values.items()}
    if as_json:
        click.echo(json.dumps(plain, indent=1, allow_nan=False))
        return
    for name, value in plain.items():
        click.echo(f"{name}: {value if isinstance(value, str) else json.dumps(value)}")


@main.command()
@click.argument("name", required=False)
def nodes(name: str | None) -> None:  # numpydoc ignore=PR01
    """List the nodes, or explain one."""
    with told_errors():
        from ..nodes.graphs.node import REGISTRY, find_node, load_library
        from .node_help import print_node

        if name is not None:
            print_node(find_node(name))
            return
        load_library()
        for category in sorted({node.category for node in REGISTRY.values()}):
            click.echo(click.style(category, bold=True))
            for node in REGISTRY.values():
                if node.category == category:
                    click.echo(f"  {node.name:22s}{node.summary}")


@main.command()
@click.argument("graph_file", metavar="GRAPH.json", type=click.Path(path_type=Path))
def graph(graph_file: Path) -> None:  # numpydoc ignore=PR01
    """Print a graph as a Mermaid flowchart."""
    with told_errors():
        from ..nodes.graphs.graph import Graph

        click.echo(Graph.load(graph_file).mermaid())


main.add_command(panel)
main.add_command(serve)
main.add_command(studio)
main.add_command(sweep)
