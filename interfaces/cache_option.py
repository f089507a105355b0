"""Where commands keep results between runs: options that several of them have."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from ..nodes.graphs.stores.entries import Store

_Command = TypeVar("_Command", bound=Callable[..., Any])


def cache_options(command: _Command) -> _Command:
    """Add ``--cache FOLDER`` and ``--no-cache`` to a command.

    Parameters
    ----------
    command : callable
        With the parameters ``cache`` and ``no_cache``.

    Returns
    -------
    callable
        The command.
    """
    folder = click.option(
        "--cache",
        metavar="FOLDER",
        type=click.Path(path_type=Path, file_okay=False),
        help="Where results are kept for the next run; several may share it. By default the "
        "user's cache folder, or SPHEREMESH_CACHE.",
    )
    without = click.option("--no-cache", is_flag=True, help="Keep nothing for the next run.")
    return folder(without(command))


def chosen_store(cache: Path | None, *, no_cache: bool) -> "Store":
    """The store that a user asked for.

    Parameters
    ----------
    cache : Path or None
        What was given for ``--cache``.
    no_cache : bool
        Whether nothing is to be kept; so it is too where ``SPHEREMESH_CACHE`` is ``off``, or
        the user's cache folder cannot be used.

    Returns
    -------
    Store
        On disk, or in memory.

    Raises
    ------
    GraphError
        If the folder asked for cannot be used.
    """
    from ..nodes.graphs.errors import GraphError
    from ..nodes.graphs.stores.disk import DiskStore, user_cache_folder
    from ..nodes.graphs.stores.memory import MemoryStore

    if cache is not None and no_cache:
        raise click.UsageError("--cache and --no-cache exclude each other; drop one")
    if cache is not None:
        return DiskStore(cache)
    if no_cache or os.environ.get("SPHEREMESH_CACHE") == "off":
        return MemoryStore()
    try:
        return DiskStore(user_cache_folder())
    except GraphError:
        return MemoryStore()
