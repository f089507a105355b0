"""
The command line.

The docstrings of the commands are their help: click adds the options.

Exit codes: 0 done, 1 a library of the system is missing, 2 usage, 3 bad input, 4 not converged,
5 finished but a quality gate failed. An error is one line on standard error.
"""

import json
import sys
import textwrap
import warnings
from collections.abc import Generator
from contextlib import chdir, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

if TYPE_CHECKING:
    from ..nodes.node import Node
    from ..nodes.ports import Port
    from .panel import Progress

MISSING_LIBRARY: Final = 1
BAD_INPUT: Final = 3
NOT_CONVERGED: Final = 4
GATE_FAILED: Final = 5

UNITS: Final = ("mm", "cm", "m", "in", "ft")


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="spheremesh")
def main() -> None:
    """Turn design surfaces into spherical panels that can be built."""


@main.command()
@click.argument("mesh", required=False, type=click.Path(path_type=Path))
@click.option("-o", "--out", required=True, type=click.Path(path_type=Path), help="Folder.")
@click.option("--moulds", type=int, help="Number of mould radii; by default one per panel.")
@click.option("--thickness", type=float, default=0.0, help="Thickness, in model units.")
@click.option("--joint-gap", type=float, default=0.0, help="Joint width, in model units.")
@click.option("--units", type=click.Choice(UNITS), default="m", help="Model units.")
@click.option("--layer", default="", help="Only this layer (.3dm) or group (OBJ).")
@click.option(
    "--edges",
    type=click.Choice(["bisector", "intersection"]),
    default="bisector",
    help="Cut panels by planes that bisect the faces, or where the spheres meet.",
)
@click.option("--strict", is_flag=True, help="Exit with 5 if a panel is rejected.")
@click.option("--json", "as_json", is_flag=True, help="Print the report alone.")
def panel(  # numpydoc ignore=PR01
    out: Path,
    *,
    strict: bool,
    as_json: bool,
    **options: Any,  # noqa: ANN401
) -> None:
    """
    Panel a MESH with spheres and write CAD files, schedule and report.

    Reads OBJ, OFF, PLY, STL and .3dm. Without MESH, a demonstration roof is panelled.
    """
    from .panel import PanelOptions, run_panel

    with _errors(), _progress() as progress:
        report = run_panel(PanelOptions(**options), out, progress)
    if as_json:
        click.echo(json.dumps(report, indent=1))
    else:
        _print_summary(report, out)
    if strict and report["panels"]["rejected"]:
        sys.exit(GATE_FAILED)


@main.command()
@click.argument("graph_file", metavar="GRAPH.json", type=click.Path(path_type=Path))
@click.option("--set", "settings", multiple=True, metavar="NAME=VALUE", help="Move a slider.")
@click.option("--target", "targets", multiple=True, metavar="STEP.PORT", help="What to run.")
@click.option(
    "-o", "--out", default=".", type=click.Path(path_type=Path), help="Folder for its files."
)
@click.option("--json", "as_json", is_flag=True, help="Print the targets' values as JSON.")
def run(  # numpydoc ignore=PR01
    graph_file: Path, settings: tuple[str, ...], targets: tuple[str, ...], out: Path, *,
    as_json: bool,
) -> None:  # fmt: skip
    """
    Run a graph: all of it, or what a target needs.

    Relative paths are read from the working directory and written to the output folder.
    """
    with _errors(), _progress() as progress:
        from ..fabrication.files import replacing_all
        from ..nodes.graph import Graph

        graph = Graph.load(graph_file)
        graph.set(**dict(_setting(text) for text in settings))
        names = targets or tuple(step.name for step in graph.ends)
        here = Path.cwd()
        with replacing_all(out) as staging, chdir(staging):
            results = graph.run(*names, on_step=progress, read_from=here)
        values = (results,) if len(names) == 1 else results
    for name, value in zip(names, values, strict=True):
        if not as_json:
            click.echo(f"{name}: {_text(value)}")
    if as_json:
        content = {name: _plain(value) for name, value in zip(names, values, strict=True)}
        click.echo(json.dumps(content, indent=1))


@main.command()
@click.argument("name", required=False)
def nodes(name: str | None) -> None:  # numpydoc ignore=PR01
    """List the nodes, or explain one."""
    with _errors():
        from ..nodes.node import REGISTRY, find_node, load_library

        if name is not None:
            _print_node(find_node(name))
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
    with _errors():
        from ..nodes.graph import Graph

        click.echo(Graph.load(graph_file).mermaid())


@contextmanager
def _errors() -> Generator[None]:
    """Turn the library's errors into one line and an exit code."""
    from ..kernel.errors import ConvergenceError, MissingLibraryError, SpheremeshError
    from ..nodes.errors import GraphError, NodeError

    try:
        # Warnings of nodes are part of the report; they are printed with it.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except (SpheremeshError, GraphError, NodeError, OSError) as error:
        cause = error.cause if isinstance(error, NodeError) else error
        # An OSError is the disk's or the system's: full, too many files, a broken pipe.
        if not isinstance(cause, SpheremeshError | GraphError | OSError):
            raise
        message = " ".join(str(cause).split())
        click.echo(f"spheremesh: {message}", err=True)
        if isinstance(cause, MissingLibraryError):
            sys.exit(MISSING_LIBRARY)
        sys.exit(NOT_CONVERGED if isinstance(cause, ConvergenceError) else BAD_INPUT)


@contextmanager
def _progress() -> "Generator[Progress]":
    """Show the running step on a terminal; stay silent elsewhere."""
    if not sys.stderr.isatty():
        yield lambda _step, _state: None
        return
    from rich.console import Console

    console = Console(stderr=True)
    with console.status("reading") as status:

        def _show(step: str, state: str) -> None:
            if state == "running":
                status.update(step)
            else:
                console.print(f"{step}: {state}", style="dim")

        yield _show


def _setting(text: str) -> tuple[str, Any]:
    name, equals, value = text.partition("=")
    if not equals:
        raise click.UsageError(f"--set takes NAME=VALUE, not {text!r}")
    try:
        return name, json.loads(value)
    except json.JSONDecodeError:
        return name, value


def _print_summary(report: dict[str, Any], out: Path) -> None:
    angles, panels, moulds = report["angles_deg"], report["panels"], report["moulds"]
    for text in report["warnings"]:
        click.echo(f"warning: {text}", err=True)
    for rejected in panels["rejected"]:
        click.echo(f"rejected: {rejected['id']}: {rejected['reason']}", err=True)
    for path in sorted(out.iterdir()):
        click.echo(f"  {path}")
    count = moulds["count"] or panels["written"]
    click.echo(
        f"angle between neighbours {angles['planar']['mean']:.2f} degrees with planes, "
        f"{angles['spherical']['mean']:.2f} with spheres"
    )
    click.echo(f"moulds {count}")
    click.echo(f"panels {panels['written']} written, {len(panels['rejected'])} rejected")


def _print_node(node: "Node") -> None:
    click.echo(f"{click.style(node.name, bold=True)} ({node.category})\n\n{node.summary}")
    for title, ports in (("Inputs", node.inputs), ("Outputs", node.outputs)):
        click.echo(f"\n{click.style(title, bold=True)}")
        for port in ports.values():
            click.echo(f"  {port.name} : {_port_facts(port)}")
            click.echo(textwrap.indent(textwrap.fill(port.help, 84), "      "))


def _port_facts(port: "Port") -> str:
    """Type, unit, range and default of a port, in one line."""
    from ..nodes.ports import REQUIRED, type_name

    facts = [f"{type_name(port.type)} in {port.unit}" if port.unit else type_name(port.type)]
    if port.min is not None:
        facts.append(f"at least {port.min:g}")
    if port.max is not None:
        facts.append(f"at most {port.max:g}")
    if port.default is not REQUIRED:
        facts.append(f"default {port.default!r}")
    return ", ".join(facts)


def _plain(value: Any) -> Any:  # noqa: ANN401
    """A JSON value of a result; what has no JSON form is described."""
    if hasattr(value, "_asdict"):
        return {name: _plain(item) for name, item in value._asdict().items()}
    if hasattr(value, "tolist"):
        return value.tolist()
    try:
        json.dumps(value)
    except TypeError:
        return type(value).__name__
    return value


def _text(value: Any) -> str:  # noqa: ANN401
    plain = _plain(value)
    return plain if isinstance(plain, str) else json.dumps(plain)
