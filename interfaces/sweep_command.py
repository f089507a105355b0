"""The command ``sweep``: a graph for many values of its sliders, a row for each."""

import json
import sys
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from .cache_option import cache_options, chosen_store
from .console import BAD_INPUT, GATE_FAILED, told_errors
from .option_values import settings

if TYPE_CHECKING:
    from ..nodes.graphs.sweeps.rows import Row, Sweep

    OnRow = Callable[[Row, int, int], None]

TABLE: Final = "sweep.csv"
RECORD: Final = "sweep.json"


@click.command()
@click.argument("graph_file", metavar="GRAPH.json", type=click.Path(path_type=Path))
@click.option(
    "--set",
    "values",
    multiple=True,
    required=True,
    metavar="NAME=A,B,C",
    help="Values of a slider, or START:STOP:COUNT; several sliders are combined.",
)
@click.option(
    "--target", "targets", multiple=True, metavar="STEP.PORT", help="What to run; else all."
)
@click.option(
    "-o",
    "--out",
    required=True,
    type=click.Path(path_type=Path),
    help="Folder for the table and a folder for each point.",
)
@click.option("--workers", type=click.IntRange(min=1), help="Number of processes to run in.")
@click.option("--dask", metavar="ADDRESS", help="Scheduler of a Dask cluster to run on.")
@click.option("--field", "fields", multiple=True, help="Of reports, for the table; else all.")
@click.option("--parquet", is_flag=True, help="Write the table as Parquet as well.")
@click.option("--import", "modules", multiple=True, metavar="MODULE", help="Of own nodes.")
@click.option("--overwrite", is_flag=True, help="Use a folder that holds other files.")
@click.option("--strict", is_flag=True, help="Exit with 5 if a point failed.")
@click.option("--json", "as_json", is_flag=True, help="Print the table as JSON.")
@cache_options
def sweep(  # numpydoc ignore=PR01
    graph_file: Path, values: tuple[str, ...], targets: tuple[str, ...], out: Path, *,
    strict: bool, as_json: bool, **options: Any,  # noqa: ANN401
) -> None:  # fmt: skip
    """Run a graph for all combinations of slider values.

    Writes a folder for each point with its files, and the table sweep.csv: sliders, results,
    warnings, seconds, and what failed. Run it again to go on where it ended: what is known
    is not computed twice.
    """
    with told_errors(), _shown_rows() as shown:
        found = _swept(graph_file, values, targets, out, options, shown)
    for row in found.failures:
        at = ", ".join(f"{name} = {value}" for name, value in row.point.items())
        click.echo(f"failed: {at}: {row.error}", err=True)
    if as_json:
        click.echo(json.dumps(found.table(options["fields"] or None), indent=1))
    else:
        click.echo(f"{len(found)} points, {len(found.failures)} failed; {out / TABLE}")
    if len(found.failures) == len(found):
        sys.exit(BAD_INPUT)
    if strict and found.failures:
        sys.exit(GATE_FAILED)


def _swept(
    graph_file: Path,
    values: tuple[str, ...],
    targets: tuple[str, ...],
    out: Path,
    options: dict[str, Any],
    shown: "OnRow",
) -> "Sweep":
    from importlib import import_module

    from ..kernel.errors import InputError
    from ..nodes.graphs.graph import Graph
    from ..nodes.graphs.sweeps.rows import Sweep
    from ..nodes.graphs.sweeps.sweep import run_sweep

    if options["workers"] and options["dask"]:
        raise click.UsageError("--workers and --dask exclude each other; drop one")
    for module in options["modules"]:
        try:
            import_module(module)
        except ImportError as error:
            raise InputError(f"--import {module}: {error}") from error
    store = chosen_store(options["cache"], no_cache=options["no_cache"])
    graph = Graph.load(graph_file, cache=store)
    axes = _axes(values)
    names = targets or tuple(step.name for step in graph.ends)
    _check_folder(out, overwrite=options["overwrite"])
    graph.check_params({name: several[0] for name, several in axes.items()})
    out.mkdir(parents=True, exist_ok=True)
    rows: list[Row] = []
    fields = options["fields"] or None
    _write_record(out, graph_file, names)

    def _on_row(row: "Row", done: int, total: int) -> None:
        rows.append(row)
        if done < total and done % max(1, total // 20) == 0:
            # Whoever ends the sweep now has what is done.
            Sweep(rows, names).save(out / TABLE)
        shown(row, done, total)

    with _executor(options["dask"]) as executor:
        found = run_sweep(
            graph, names, axes, executor=executor, workers=options["workers"], write_to=out,
            on_row=_on_row,
        )  # fmt: skip
    found.save(out / TABLE)
    if fields:
        found.save(out / TABLE, fields)
    if options["parquet"]:
        found.save((out / TABLE).with_suffix(".parquet"), fields)
    return found


def _axes(values: tuple[str, ...]) -> dict[str, list[Any]]:
    axes: dict[str, list[Any]] = {}
    for text in values:
        name, several = settings(text)
        axes[name] = axes.get(name, []) + several
    return axes


def _check_folder(out: Path, *, overwrite: bool) -> None:
    """Refuse a folder that holds what no sweep put there."""
    from ..kernel.errors import InputError

    if overwrite or not out.is_dir() or (out / RECORD).is_file() or not any(out.iterdir()):
        return
    raise InputError(
        f"cannot sweep into {out}: it holds other files; choose another folder, or --overwrite"
    )


def _write_record(out: Path, graph_file: Path, names: tuple[str, ...]) -> None:
    from ..fabrication.files import replacing

    content = {"graph": str(graph_file.absolute()), "targets": list(names)}
    with replacing(out / RECORD) as temporary:
        temporary.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


@contextmanager
def _executor(address: str | None) -> Generator[Any]:
    """A client of a Dask cluster, if there is an address."""
    if address is None:
        yield None
        return
    from importlib import import_module

    from ..kernel.errors import InputError, MissingLibraryError

    try:
        distributed = import_module("distributed")
    except ImportError as error:
        raise MissingLibraryError(
            "--dask needs Dask: pip install 'spheremesh[cluster]'"
        ) from error
    try:
        client = distributed.Client(address, timeout="10s")
    except (OSError, ValueError) as error:
        raise InputError(f"--dask {address}: no scheduler answers there: {error}") from error
    with client:
        yield client


@contextmanager
def _shown_rows() -> "Generator[OnRow]":
    """A bar on a terminal; silence elsewhere."""
    if not sys.stderr.isatty():
        yield lambda _row, _done, _total: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True)) as progress:
        task = progress.add_task("points")

        def _show(row: "Row", done: int, total: int) -> None:
            text = f"[red]failed[/]: {row.error[:60]}" if row.error else "points"
            progress.update(task, completed=done, total=total, description=text)

        yield _show
