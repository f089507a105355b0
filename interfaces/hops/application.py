"""Requests and answers: the routes, and every error as JSON."""

import json
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from http import HTTPStatus
from pathlib import Path
from typing import Any, Final, TypeAlias, cast

from ...kernel.errors import SpheremeshError
from ...nodes.graphs.errors import GraphError, nearest
from ...nodes.graphs.running.events import RunCancelledError
from ...nodes.graphs.running.keys import key_of
from .catalogue import Catalogue, Listed
from .description import describe_error, to_json
from .guard import Limits, RefusedError, check_request, too_large
from .jobs import Answer, BusyError, Jobs, StillRunningError, Watcher
from .page import POLICY, components_page
from .solving import ChangedError, Solver, solve
from .trees import read_trees

StartResponse: TypeAlias = Callable[[str, list[tuple[str, str]]], object]
Environ: TypeAlias = Mapping[str, Any]
Application: TypeAlias = Callable[[Environ, StartResponse], Iterable[bytes]]

_ADDRESS: Final = re.compile(r"[A-Za-z0-9.:\[\]-]{1,200}")
_NOT_KEPT: Final = 203
"""Grasshopper keeps every 200 for the whole session; this one it takes and does not keep."""


@dataclass(frozen=True)
class Service:
    """What a server has to answer with."""

    catalogue: Catalogue
    solver: Solver
    jobs: Jobs
    limits: Limits


def application(service: Service) -> Application:
    """The application of a server, for any server of WSGI.

    Parameters
    ----------
    service : Service

    Returns
    -------
    callable
        Raises nothing: all that goes wrong is an answer.
    """

    def _application(environ: Environ, start_response: StartResponse) -> Iterable[bytes]:
        answer = _answer(service, environ)
        status = HTTPStatus(answer.status)
        is_page = answer.content_type.startswith("text/html")
        headers = [
            ("Content-Type", answer.content_type),
            ("Content-Length", str(len(answer.body))),
            ("X-Content-Type-Options", "nosniff"),
            ("Cache-Control", "no-store"),
            ("Cross-Origin-Resource-Policy", "same-origin"),
            ("Content-Security-Policy", POLICY if is_page else "default-src 'none'"),
        ]
        start_response(f"{status.value} {status.phrase}", headers)
        return [b"" if environ.get("REQUEST_METHOD") == "HEAD" else answer.body]

    return _application


def _answer(service: Service, environ: Environ) -> Answer:
    method = str(environ.get("REQUEST_METHOD", "GET"))
    try:
        check_request(environ, service.limits)
        return _METHODS.get(method, _no_method)(service, environ)
    except RefusedError as error:
        return error_answer(error.status, str(error), is_solve=method == "POST")
    except Exception as error:  # noqa: BLE001 - whatever it is, Grasshopper needs JSON
        text = f"{type(error).__name__}: {error}: a fault of spheremesh, report it"
        return error_answer(500, text, is_solve=method == "POST")


def error_answer(
    status: int,
    message: str,
    *,
    is_solve: bool,
    running: bool = False,
    is_changed: bool = False,
) -> Answer:
    """An error as JSON of the form that is asked for.

    Parameters
    ----------
    status : int
        Of HTTP; never 200.
    message : str
    is_solve : bool
        Whether it is the answer of a run.
    running : bool
        Whether who asks again joins the run.
    is_changed : bool
        Whether the component is not what the client took it for: two words make it look again.
    """
    errors = ["Bad inputs", message] if is_changed else [message]
    content: dict[str, Any] = {"values": [], "warnings": [], "errors": errors}
    if not is_solve:
        content = describe_error(message)
    marks = {"running": True} if running else {}
    return Answer(status, to_json({**content, "message": message, **marks}))


def _get(service: Service, environ: Environ) -> Answer:
    name = str(environ.get("PATH_INFO", "/")).strip("/")
    catalogue = service.catalogue
    if not name:
        if "text/html" in str(environ.get("HTTP_ACCEPT", "")):
            return _page(catalogue, environ)
        bodies = [listed.body for listed in catalogue.all() if not listed.component.fault]
        return Answer(200, b"[" + b",".join(bodies) + b"]")
    if name == "client.py":
        return Answer(200, _client(), "text/x-python; charset=utf-8")
    listed = catalogue.find(name)
    if listed is None:
        return error_answer(404, _no_component(catalogue, name), is_solve=False)
    if listed.component.fault:
        return error_answer(500, listed.component.fault, is_solve=False)
    return Answer(200, listed.body)


def _no_component(catalogue: Catalogue, name: str) -> str:
    return f"no component {name[:80]!r}; {nearest(name[:80], catalogue.names())}"


def _page(catalogue: Catalogue, environ: Environ) -> Answer:
    host = str(environ.get("HTTP_HOST", ""))
    address = f"http://{host}" if _ADDRESS.fullmatch(host) else ""
    text = components_page((listed.description for listed in catalogue.all()), address)
    return Answer(200, text.encode(), "text/html; charset=utf-8")


@cache
def _client() -> bytes:
    return Path(__file__).with_name("client.py").read_bytes()


def _post(service: Service, environ: Environ) -> Answer:
    if str(environ.get("PATH_INFO", "")).strip("/") != "solve":
        raise RefusedError(404, "components are solved at /solve")
    kind = str(environ.get("CONTENT_TYPE", "")).partition(";")[0].strip().lower()
    if kind != "application/json":
        raise RefusedError(415, "the request needs the content type application/json")
    limit = service.limits.most_bytes
    body = environ["wsgi.input"].read(limit + 1)
    if len(body) > limit:
        raise RefusedError(413, too_large(limit))
    request = _request(body)
    pointer = str(request.get("pointer") or "").strip("/").rpartition("/")[2]
    listed = service.catalogue.find(pointer)
    if listed is None:
        raise RefusedError(404, _no_component(service.catalogue, pointer))
    units = str(request.get("modelunits") or "")
    key = key_of([listed.body, units.encode(errors="replace"), to_json(request.get("values"))])
    try:
        return service.jobs.answer(
            key, lambda watcher: _solved(service, listed, request, watcher)
        )
    except ChangedError as error:
        return error_answer(500, str(error), is_solve=True, is_changed=True)
    except (SpheremeshError, GraphError, OSError) as error:
        # There are no options here.
        text = str(error).replace("another folder, or --overwrite", "another name")
        raise RefusedError(500, text) from error
    except StillRunningError as error:
        return error_answer(500, f"{pointer}: {error}", is_solve=True, running=True)
    except (BusyError, RunCancelledError) as error:
        raise RefusedError(500, f"{pointer}: {error}") from error


def _no_method(_: Service, environ: Environ) -> Answer:
    method = str(environ.get("REQUEST_METHOD", ""))[:20]
    return error_answer(405, f"there is no {method} here, only GET and POST", is_solve=False)


_METHODS: Final = {"GET": _get, "HEAD": _get, "POST": _post}


def _request(body: bytes) -> Mapping[str, Any]:
    try:
        # NaN is no JSON.
        request: object = json.loads(body, parse_constant=_no_constant)
    except (ValueError, RecursionError) as error:
        raise RefusedError(400, f"the request is no JSON: {error}") from error
    if not isinstance(request, dict):
        raise RefusedError(400, "the request is no JSON object")
    found = cast("dict[str, Any]", request)
    return {str(name).lower(): item for name, item in found.items()}


def _no_constant(text: str) -> None:
    raise ValueError(f"{text} is no number of JSON")


def _solved(
    service: Service, listed: Listed, request: Mapping[str, Any], watcher: Watcher
) -> Answer:
    trees = read_trees(request.get("values"))
    units = str(request.get("modelunits") or "")
    found = solve(service.solver, listed.component, trees, units, watcher)
    content = {"values": found.values, "warnings": found.warnings, "errors": list[str]()}
    return Answer(200 if found.is_lasting else _NOT_KEPT, to_json(content))
