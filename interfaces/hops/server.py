"""The server around the application: waitress, with errors as JSON.

What waitress refuses by itself it would say as text, which Grasshopper takes for a definition
of its own; and it would close the line while the client still sends, who then never reads why.
"""

import socket
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Final

from waitress.channel import HTTPChannel
from waitress.parser import HTTPRequestParser
from waitress.server import create_server
from waitress.task import ErrorTask
from waitress.utilities import RequestEntityTooLarge

from ...nodes.graphs.stores.entries import Store
from .application import Application, Service, application, error_answer
from .catalogue import Catalogue
from .guard import LOOPBACK, MOST_BYTES, Limits, host_name, too_large
from .handles import Handles
from .jobs import MOST_WAITING, PATIENCE, Jobs
from .solving import Solver

THREADS: Final = MOST_WAITING + 8
"""Of requests: however many wait for runs, components are described."""
_MOST_DROPPED: Final = 2**30
"""Bytes of a body that are passed over before the line is closed."""


class _Parser(HTTPRequestParser):
    """Passes over a body that is too large, and keeps nothing of it."""

    left = 0

    def received(self, data: bytes) -> int:
        """Take what came; how much of it was used."""
        if self.left:
            used = min(len(data), self.left)
            self.left -= used
            self.completed = not self.left
            return used
        used: int = super().received(data)
        if self.completed and isinstance(self.error, RequestEntityTooLarge):
            self.left = 0 if self.chunked else min(self.content_length, _MOST_DROPPED)
            self.completed = not self.left
        return used


class _ErrorTask(ErrorTask):
    """Says in JSON what waitress refuses."""

    def execute(self) -> None:
        """Write the answer."""
        request, channel, headers = _untyped(self.request, self.channel, self.response_headers)
        error = request.error
        message = str(error.body)
        if isinstance(error, RequestEntityTooLarge):
            message = too_large(channel.server.adj.max_request_body_size)
        is_solve = getattr(request, "command", "") == "POST"
        answer = error_answer(error.code, message, is_solve=is_solve)
        self.status = f"{error.code} {error.reason}"
        headers.append(("Content-Type", answer.content_type))
        self.set_close_on_finish()
        self.content_length = len(answer.body)
        self.write(answer.body)


def _untyped(*several: Any) -> tuple[Any, ...]:  # noqa: ANN401
    """The stubs of waitress have other names for what tasks hold."""
    return several


class _Channel(HTTPChannel):
    parser_class = _Parser
    error_task_class = _ErrorTask


def make_service(
    store: Store,
    *,
    graphs: Path | None = None,
    files: Path | None = None,
    hosts: Iterable[str] = (),
    most_bytes: int = MOST_BYTES,
    patience: float = PATIENCE,
) -> Service:
    """What a server answers with.

    Parameters
    ----------
    store : Store
        Of results and handles.
    graphs : Path, optional
        Folder whose graph files are components.
    files : Path, optional
        Folder that nodes may read from and write to.
    hosts : iterable of str
        Names of this machine besides its own for itself.
    most_bytes : int
        Of a request.
    patience : float
        Seconds until a run is said to go on.

    Returns
    -------
    Service
        The library of nodes is imported, so that components are described at once.
    """
    names = frozenset(map(host_name, hosts)) | LOOPBACK
    return Service(
        Catalogue(graphs, files),
        Solver(Handles(store), files),
        Jobs(patience=patience),
        Limits(names, most_bytes),
    )


def make_server(
    service: Service, host: str, port: int, answers: Application | None = None
) -> Any:  # noqa: ANN401
    """A server that listens already; ``run`` answers until ``close``.

    Parameters
    ----------
    service : Service
    host : str
        Name or number of the network card.
    port : int
        0 for any that is free.
    answers : Application, optional
        What answers; by default the components of the service alone.

    Returns
    -------
    waitress.server.BaseWSGIServer
        ``effective_port`` is the port.
    """
    # A name can stand for several addresses; a server listens at the first.
    address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][4][0]
    server: Any = create_server(
        answers or application(service),
        host=str(address),
        port=port,
        threads=THREADS,
        ident="spheremesh",
        max_request_body_size=service.limits.most_bytes,
        max_request_header_size=2**15,
        connection_limit=1000,
        clear_untrusted_proxy_headers=True,
    )
    server.channel_class = _Channel
    return server
