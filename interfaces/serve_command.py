"""The command ``serve``: nodes and graphs as components of Grasshopper."""

import os
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from .cache_option import cache_options, chosen_store
from .console import told_errors

if TYPE_CHECKING:
    from ..nodes.graphs.stores.entries import Store
    from .hops.application import Service

PORT: Final = 5555
ANYWHERE: Final = ("0.0.0.0", "::")  # noqa: S104 - compared, not bound to
"""Addresses that stand for all of this machine's."""
_FOLDER: Final = click.Path(path_type=Path, file_okay=False, exists=True)


@click.command()
@click.option(
    "--port", type=click.IntRange(0, 65535), default=PORT, show_default=True,
    help="0 for any that is free.",
)  # fmt: skip
@click.option(
    "--graphs", metavar="FOLDER", type=_FOLDER, help="Folder whose graph files are components."
)
@click.option(
    "--files", metavar="FOLDER", type=_FOLDER,
    help="Folder that nodes may read from and write to; without it there are none of these.",
)  # fmt: skip
@click.option(
    "--host", default="127.0.0.1", show_default=True,
    help="Address to listen at; others than this machine's own are open to the network.",
)  # fmt: skip
@click.option(
    "--allow-host", "allowed", multiple=True, metavar="NAME",
    help="Name by which other machines call this one.",
)  # fmt: skip
@click.option(
    "--max-mb", type=click.IntRange(min=1), default=64, show_default=True,
    help="Largest request, in megabytes.",
)  # fmt: skip
@click.option(
    "--patience", type=click.FloatRange(min=0, min_open=True), default=90.0, show_default=True,
    help="Seconds until a run is said to go on; less than Grasshopper waits (100).",
)  # fmt: skip
@click.option(
    "--import", "modules", multiple=True, metavar="MODULE", help="Of own nodes."
)  # fmt: skip
@cache_options
def serve(  # numpydoc ignore=PR01
    *,
    port: int,
    host: str,
    cache: Path | None,
    no_cache: bool,
    **options: Any,  # noqa: ANN401
) -> None:
    """Serve nodes and saved graphs to Grasshopper's Hops component.

    The page at its address lists the components. Only programs of this machine are answered
    unless --host says otherwise; nodes that read or write files are served with --files alone.
    """
    with told_errors():
        service = _service(host, chosen_store(cache, no_cache=no_cache), options)
        try:
            from .hops.server import make_server

            server = make_server(service, host, port)
        except OSError as error:
            from ..kernel.errors import InputError

            raise InputError(
                f"cannot listen at {host}:{port}: {error}; another server "
                "may be running, choose another --port"
            ) from error
    if host not in ("127.0.0.1", "localhost", "::1"):
        click.echo("warning: everybody in this network can use the server", err=True)
    click.echo(f"http://{_shown(host)}:{server.effective_port}  (Ctrl+C ends it)")
    sys.stdout.flush()
    try:
        _run(server)
    finally:
        service.jobs.close()
        server.close()
        if service.jobs.are_running:
            # Nobody waits for what runs; results and files are safe from sudden ends.
            os._exit(0)


def _run(server: Any) -> None:  # noqa: ANN401
    import warnings

    from ..nodes.graphs.node import NodeWarning

    # What nodes warn of is said on their components.
    warnings.simplefilter("ignore", NodeWarning)
    with suppress(KeyboardInterrupt):
        server.run()


def _shown(host: str) -> str:
    if host in ANYWHERE:
        return "localhost"
    return f"[{host}]" if ":" in host else host


def _service(host: str, store: "Store", options: dict[str, Any]) -> "Service":
    from importlib import import_module

    from ..kernel.errors import InputError
    from .hops.server import make_service

    for module in options["modules"]:
        try:
            import_module(module)
        except ImportError as error:
            raise InputError(f"--import {module}: {error}") from error
    hosts = options["allowed"] if host in ANYWHERE else (*options["allowed"], host)
    return make_service(
        store,
        graphs=options["graphs"],
        files=options["files"],
        hosts=hosts,
        most_bytes=options["max_mb"] * 2**20,
        patience=options["patience"],
    )
