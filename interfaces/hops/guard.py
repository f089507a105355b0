"""Who may ask, and which files may be named.

A page of the web that a user looks at can send requests to their own machine. Browsers say
where such requests come from (Origin), and a name that leads here by trickery stands in Host.
"""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from ...kernel.errors import InputError
from ...nodes.graphs.annotations import Hint, Value, element_type, is_subclass, members
from ...nodes.graphs.running.files import is_written, paths_of
from ...nodes.graphs.specification.specification import Specification
from ...nodes.graphs.specification.subgraphs import Inner
from ...nodes.graphs.specification.wires import Each, Wire, sources

LOOPBACK: Final = frozenset({"localhost", "127.0.0.1", "::1"})
MOST_BYTES: Final = 64 * 2**20


class RefusedError(Exception):
    """A request that is not answered.

    Parameters
    ----------
    status : int
        Of HTTP.
    message : str
    """

    def __init__(self, status: int, message: str) -> None:
        super().__init__(message)
        self.status = status


@dataclass(frozen=True)
class Limits:
    """What is let in.

    Attributes
    ----------
    hosts : frozenset of str
        Names of this machine that requests may be sent to.
    most_bytes : int
        Of a request.
    """

    hosts: frozenset[str] = LOOPBACK
    most_bytes: int = MOST_BYTES


def check_request(environ: Mapping[str, Any], limits: Limits) -> None:
    """Refuse what does not come from a program of the user.

    Parameters
    ----------
    environ : mapping
        Of WSGI.
    limits : Limits

    Raises
    ------
    RefusedError
        With the status 421 for another name of the machine, 403 for a page of the web, 413
        for a body that is too large.
    """
    host = str(environ.get("HTTP_HOST", ""))
    if host_name(host) not in limits.hosts:
        raise RefusedError(
            421,
            f"there is no {host[:100]!r} here; start the server with --allow-host to add it",
        )
    if "HTTP_ORIGIN" in environ:
        raise RefusedError(403, "pages of the web may not use this server")
    length = str(environ.get("CONTENT_LENGTH") or "0")
    if not length.isdecimal() or int(length) > limits.most_bytes:
        raise RefusedError(413, too_large(limits.most_bytes))


def too_large(most_bytes: int) -> str:
    """What is said of a request with too many bytes."""
    return (
        f"the request is larger than {most_bytes / 2**20:g} MB; send less, or start the server "
        "with --max-mb"
    )


def host_name(host: str) -> str:
    """A name without its port, in small letters.

    Examples
    --------
    >>> host_name("LocalHost:5555"), host_name("[::1]:5555")
    ('localhost', '::1')
    """
    text = host.strip().lower()
    if text.count(":") > 1 and not text.startswith("["):
        return text  # a number of version 6 as it is
    if text.startswith("["):
        return text[1:].partition("]")[0]
    return text.partition(":")[0]


def check_paths(value: Value, folder: Path, where: str) -> None:
    """Refuse paths that lead out of a folder.

    Parameters
    ----------
    value : object
        A path or a list of paths; what else it may be is no file.
    folder : Path
    where : str
        How messages name the input.

    Raises
    ------
    InputError
        If a path leads elsewhere, by links as well.
    """
    root = folder.resolve()
    for path in paths_of(value):
        try:
            target = (root / path).resolve()
        except (OSError, ValueError, RuntimeError) as error:
            raise InputError(f"{where} = {path[:80]!r}: can be no path") from error
        if not target.is_relative_to(root):
            raise InputError(
                f"{where} = {path[:80]!r}: outside of the folder that is served (--files); "
                "name a file in it"
            )


def check_graph_files(graph: Specification, folder: Path | None) -> None:
    """Refuse a graph whose own paths lead out of a folder.

    Parameters
    ----------
    graph : Specification
    folder : Path, optional
        None if no files are served.

    Raises
    ------
    InputError
        The message names the step.
    """
    for step in graph.steps.values():
        if isinstance(step.node.inner, Inner):
            check_graph_files(step.node.inner.specification, folder)
        for port in step.node.file_inputs:
            where = f"step {step.name!r}: {port.name}"
            given = step.inputs.get(port.name, port.default)
            if folder is None:
                if port.writes or paths_of(_literal(given, graph)) or _is_path_by_wire(given):
                    raise InputError(f"{where}: files are not served; start with --files")
                continue
            if port.reads and _is_path_by_wire(given) and not is_written(given):
                raise InputError(f"{where}: a path that is computed is not read by a server")
            check_paths(_literal(given, graph), folder, where)


def _is_path_by_wire(given: Value) -> bool:
    """Whether a path may come from another step; what comes may also be a mesh."""
    return any(_may_be_path(each.type) for each in sources(given) if isinstance(each, Wire))


def _may_be_path(hint: Hint) -> bool:
    for member in members(hint):
        is_text = is_subclass(member.kind, (str, os.PathLike), undecided=False)
        if is_text or member.kind in (Any, object):
            return True
        if member.kind in (list, tuple) and _may_be_path(element_type(member.hint)):
            return True
    return False


def _literal(given: Value, graph: Specification) -> Value:
    """What is known of a value before the graph is run."""
    if isinstance(given, Each):
        return _literal(given.items, graph)
    wired = list(sources(given))
    if not wired:
        return given
    names = [getattr(each, "name", "") for each in wired]
    return [graph.values[name] for name in names if name in graph.values]
