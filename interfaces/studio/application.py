"""Requests of the page and their answers; whatever else comes is for Hops.

The page itself and its scripts are anybody's; all that knows the graph asks for the token,
which stands in the fragment of the address and so in no request and no log.
"""

import json
import secrets
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from http import HTTPStatus
from importlib import resources
from typing import Any, Final, cast
from urllib.parse import parse_qs

from ...kernel.errors import SpheremeshError
from ...nodes.graphs.errors import GraphError
from ..hops.application import Application, Environ, StartResponse
from ..hops.guard import Limits, RefusedError, host_name, too_large
from .document import StaleError
from .session import Session

ROOT: Final = "/studio"
MOST_BYTES: Final = 32 * 2**20
_POLICY: Final = (
    "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
    "connect-src 'self'; img-src 'self' data: blob:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'"
)
_ASSETS: Final = {
    "": ("interfaces.studio", "studio.html", "text/html; charset=utf-8"),
    "studio.js": ("interfaces.studio", "studio.js", "text/javascript; charset=utf-8"),
    "studio.css": ("interfaces.studio", "studio.css", "text/css; charset=utf-8"),
    "viewer.js": ("viewer.page", "viewer.js", "text/javascript; charset=utf-8"),
}
"""Files of the page by name: their package, their name in its bundle, and what they are."""

_PACKAGE: Final = __name__.partition(".interfaces.")[0]


@dataclass(frozen=True)
class Reply:
    """An answer.

    Attributes
    ----------
    status : int
    body : bytes or iterable of bytes
        The latter for lines that go on.
    content_type : str
    keeping : str
        What the browser may keep of it.
    """

    status: int
    body: bytes | Iterable[bytes]
    content_type: str = "application/json; charset=utf-8"
    keeping: str = "no-store"


def studio_application(
    session: Session, limits: Limits, token: str, hops: Application
) -> Application:
    """The application of a server: the studio below ``/studio``, Hops elsewhere.

    Parameters
    ----------
    session : Session
    limits : Limits
        Names of this machine; bodies are bounded by the smaller of two bounds.
    token : str
        What the page has to know.
    hops : Application
    """

    def _application(environ: Environ, start_response: StartResponse) -> Iterable[bytes]:
        path = str(environ.get("PATH_INFO", "/"))
        if path != ROOT and not path.startswith(f"{ROOT}/"):
            return hops(environ, start_response)
        reply = _reply(session, limits, token, environ)
        status = HTTPStatus(reply.status)
        headers = [
            ("Content-Type", reply.content_type),
            ("X-Content-Type-Options", "nosniff"),
            ("Referrer-Policy", "no-referrer"),
            ("Cache-Control", reply.keeping),
            ("Cross-Origin-Resource-Policy", "same-origin"),
            ("Cross-Origin-Opener-Policy", "same-origin"),
            ("Content-Security-Policy", _POLICY),
        ]
        if isinstance(reply.body, bytes):
            headers.append(("Content-Length", str(len(reply.body))))
        start_response(f"{status.value} {status.phrase}", headers)
        if isinstance(reply.body, bytes):
            return [b"" if environ.get("REQUEST_METHOD") == "HEAD" else reply.body]
        return reply.body

    return _application


def _reply(session: Session, limits: Limits, token: str, environ: Environ) -> Reply:
    try:
        return _answer(session, limits, token, environ)
    except RefusedError as error:
        return _json({"error": str(error)}, error.status)
    except StaleError:
        said = {"error": "the graph has been changed since", **session.present()}
        return _json(said, 409)
    except (GraphError, SpheremeshError, OSError) as error:
        return _json({"error": str(error)}, 422)
    except Exception as error:  # noqa: BLE001 - whatever it is, the page needs JSON
        text = f"{type(error).__name__}: {error}: a fault of spheremesh, report it"
        return _json({"error": text}, 500)


def _answer(session: Session, limits: Limits, token: str, environ: Environ) -> Reply:
    _check(environ, limits)
    method = str(environ.get("REQUEST_METHOD", "GET"))
    name = str(environ.get("PATH_INFO", "")).removeprefix(ROOT).strip("/")
    if name in _ASSETS:
        if method not in ("GET", "HEAD"):
            raise RefusedError(405, "the page is asked for with GET")
        return _asset(name)
    _check_token(environ, token)
    route = _ROUTES.get(name.partition("/")[0])
    if route is None:
        raise RefusedError(404, f"there is no {name[:80]!r} here")
    wanted, answer = route
    if method != wanted:
        raise RefusedError(405, f"{name[:80]} is asked for with {wanted}")
    return answer(session, environ)


def _check(environ: Environ, limits: Limits) -> None:
    """Refuse what does not come from a page of this very server, or a program of the user."""
    host = str(environ.get("HTTP_HOST", ""))
    if host_name(host) not in limits.hosts:
        raise RefusedError(421, f"there is no {host[:100]!r} here")
    origin = environ.get("HTTP_ORIGIN")
    if origin is not None and origin != f"http://{host}":
        raise RefusedError(403, "other pages of the web may not use the studio")
    if str(environ.get("HTTP_SEC_FETCH_SITE", "none")) not in ("none", "same-origin"):
        raise RefusedError(403, "other pages of the web may not use the studio")
    length = str(environ.get("CONTENT_LENGTH") or "0")
    if not length.isdecimal() or int(length) > MOST_BYTES:
        raise RefusedError(413, too_large(MOST_BYTES))


def _check_token(environ: Environ, token: str) -> None:
    given = str(environ.get("HTTP_AUTHORIZATION", "")).encode(errors="replace")
    if not secrets.compare_digest(given, f"Bearer {token}".encode()):
        raise RefusedError(401, "open the studio by the address that the command has printed")


def _asset(name: str) -> Reply:
    package, file, kind = _ASSETS[name]
    folder = resources.files(f"{_PACKAGE}.{package}") / "bundle"
    return Reply(200, (folder / file).read_bytes(), kind, "no-cache")


def _json(content: Any, status: int = 200) -> Reply:  # noqa: ANN401
    text = json.dumps(content, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return Reply(status, text.encode(errors="replace"))


def _body(environ: Environ) -> Mapping[str, Any]:
    kind = str(environ.get("CONTENT_TYPE", "")).partition(";")[0].strip().lower()
    if kind != "application/json":
        raise RefusedError(415, "the request needs the content type application/json")
    data = environ["wsgi.input"].read(MOST_BYTES + 1)
    if len(data) > MOST_BYTES:
        raise RefusedError(413, too_large(MOST_BYTES))
    try:
        content: object = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise RefusedError(400, f"the request is no JSON: {error}") from error
    if not isinstance(content, dict):
        raise RefusedError(400, "the request is no JSON object")
    return cast("dict[str, Any]", content)


def _word(environ: Environ, name: str) -> str:
    words = parse_qs(str(environ.get("QUERY_STRING", "")), max_num_fields=20)
    return words.get(name, [""])[0]


def _edit(session: Session, environ: Environ) -> Reply:
    body = _body(environ)
    operations = cast("object", body.get("ops"))
    if not isinstance(operations, list) or not isinstance(body.get("rev"), int):
        raise RefusedError(400, "an edit has a revision (rev) and a list of operations (ops)")
    several = cast("list[Any]", operations)
    return _json(session.edit(body["rev"], several, str(body.get("gesture", ""))))


def _events(session: Session, environ: Environ) -> Reply:
    if session.channels.is_full:
        raise RefusedError(503, "too many pages are open; close some")
    has_gone = environ.get("waitress.client_disconnected", lambda: False)
    first = {"type": "hello", "rev": session.document.rev}
    return Reply(200, session.channels.lines(first, has_gone), "text/event-stream")


def _blob(session: Session, environ: Environ) -> Reply:
    digest = str(environ.get("PATH_INFO", "")).rpartition("/")[2]
    data = session.runs.blob(digest)
    if data is None:
        raise RefusedError(404, "this picture is not kept any more; run again")
    keeping = "private, max-age=31536000, immutable"
    return Reply(200, data, "application/octet-stream", keeping)


def _receive(session: Session, environ: Environ) -> Reply:
    kind = str(environ.get("CONTENT_TYPE", "")).partition(";")[0].strip().lower()
    if kind != "application/octet-stream":
        raise RefusedError(415, "a file needs the content type application/octet-stream")
    data = environ["wsgi.input"].read(MOST_BYTES + 1)
    if len(data) > MOST_BYTES:
        raise RefusedError(413, too_large(MOST_BYTES))
    return _json(session.receive(_word(environ, "name"), data))


def _told(
    answer: Callable[[Session, Mapping[str, Any]], Any],
) -> Callable[[Session, Environ], Reply]:
    return lambda session, environ: _json(answer(session, _body(environ)))


_ROUTES: Final[dict[str, tuple[str, Callable[[Session, Environ], Reply]]]] = {
    "state": ("GET", lambda session, _: _json(session.state())),
    "nodes": ("GET", lambda session, _: _json(session.catalogue.content())),
    "events": ("GET", _events),
    "blob": ("GET", _blob),
    "files": ("GET", lambda s, environ: _json(s.files(_word(environ, "ending")))),
    "code": ("GET", lambda session, _: _json({"code": session.code()})),
    "edit": ("POST", _edit),
    "undo": ("POST", lambda session, _: _json(session.undo())),
    "redo": ("POST", lambda session, _: _json(session.redo())),
    "run": ("POST", _told(lambda s, body: s.run([str(x) for x in body.get("targets", [])]))),
    "cancel": ("POST", _told(lambda s, body: s.cancel(int(body.get("run", 0))))),
    "export": ("POST", _told(lambda s, body: s.export(str(body.get("folder", "")), body))),
    "replaced": ("GET", lambda s, environ: _json(s.replaced(_word(environ, "folder")))),
    "receive": ("POST", _receive),
    "open": ("POST", _told(lambda session, body: session.open(body))),
    "save": ("POST", _told(lambda s, body: s.save_as(str(body.get("file", ""))))),
    "revert": ("POST", _told(lambda s, body: s.revert(str(body.get("version", ""))))),
}
"""What is asked for below `ROOT`: how, and what answers."""
