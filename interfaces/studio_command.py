"""The command ``studio``: a graph on a canvas in the browser."""

import os
import secrets
import sys
import threading
import webbrowser
from pathlib import Path
from typing import Any, Final

import click

from .cache_option import cache_options, chosen_store
from .console import told_errors

PORT: Final = 5556
_FOLDER: Final = click.Path(path_type=Path, file_okay=False, exists=True)


@click.command()
@click.argument(
    "graph_file", metavar="[GRAPH.json]", required=False, type=click.Path(path_type=Path)
)
@click.option(
    "--port", type=click.IntRange(0, 65535), default=PORT, show_default=True,
    help="0 for any that is free; so it is too where this one is taken.",
)  # fmt: skip
@click.option(
    "--files", metavar="FOLDER", type=_FOLDER,
    help="Folder that nodes may read from and write to, and where graphs are kept; by default "
    "the working directory, or that of the graph.",
)  # fmt: skip
@click.option("--no-browser", is_flag=True, help="Print the address and open no browser.")
@click.option(
    "--import", "modules", multiple=True, metavar="MODULE", help="Of own nodes."
)  # fmt: skip
@cache_options
def studio(  # numpydoc ignore=PR01
    graph_file: Path | None,
    *,
    port: int,
    files: Path | None,
    no_browser: bool,
    modules: tuple[str, ...],
    cache: Path | None,
    no_cache: bool,
) -> None:
    """Edit a graph on a canvas, with what it makes beside it.

    Opens a page in the browser: steps with sliders on the left, the roof on the right. Only
    programs of this machine are answered, and only pages that know the address printed here.
    The graph is saved as it is edited; a file that does not exist yet is made with the first
    edit. The same address serves all nodes to Grasshopper's Hops.
    """
    with told_errors():
        server, session, address = _opened(graph_file, port, files, modules, cache, no_cache)
    click.echo(f"{address}  (Ctrl+C ends it)")
    sys.stdout.flush()
    if not no_browser:
        threading.Timer(0.3, webbrowser.open, [address]).start()
    try:
        server.run()
    except KeyboardInterrupt:
        pass
    finally:
        session.close()
        server.close()
        # Lines to pages that are open wait for events, and nobody waits for them.
        os._exit(0)


def _opened(
    graph_file: Path | None, port: int, files: Path | None, modules: tuple[str, ...],
    cache: Path | None, no_cache: bool,  # noqa: FBT001
) -> tuple[Any, Any, str]:  # fmt: skip
    from importlib import import_module

    from ..kernel.errors import InputError
    from ..nodes.graphs.stores.disk import DiskStore
    from .hops.server import make_service
    from .studio.application import ROOT, studio_application
    from .studio.session import Session
    from .studio.worker import Place

    for module in modules:
        try:
            import_module(module)
        except ImportError as error:
            raise InputError(f"--import {module}: {error}") from error
    path, folder = _places(graph_file, files)
    store = chosen_store(cache, no_cache=no_cache)
    kept = str(store.folder) if isinstance(store, DiskStore) else ""
    service = make_service(store, files=files)
    token = secrets.token_urlsafe(24)
    session = Session(Place(kept, str(folder), modules), path)
    from .hops.application import application

    answers = studio_application(session, service.limits, token, application(service))
    server = _listening(service, port, answers)
    return server, session, f"http://127.0.0.1:{server.effective_port}{ROOT}#{token}"


def _places(graph_file: Path | None, files: Path | None) -> tuple[Path | None, Path]:
    """The graph file and the folder around it."""
    from ..kernel.errors import InputError

    path = None if graph_file is None else graph_file.resolve()
    if files is not None:
        folder = files.resolve()
    else:
        folder = Path.cwd().resolve()
        if path is not None and not path.is_relative_to(folder):
            folder = path.parent
    if path is not None and not path.is_relative_to(folder):
        raise InputError(f"{graph_file} is outside of {files}: name a graph in that folder")
    if path is not None and not path.parent.is_dir():
        raise InputError(f"{graph_file}: there is no folder {path.parent}; make it first")
    return path, folder


def _listening(service: Any, port: int, answers: Any) -> Any:  # noqa: ANN401
    from ..kernel.errors import InputError
    from .hops.server import make_server

    try:
        return make_server(service, "127.0.0.1", port, answers)
    except OSError as error:
        if port != PORT:
            raise InputError(
                f"cannot listen at 127.0.0.1:{port}: {error}; another server may be running, "
                "choose another --port"
            ) from error
        return make_server(service, "127.0.0.1", 0, answers)
