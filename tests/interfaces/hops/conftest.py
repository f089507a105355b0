"""A double of Grasshopper's Hops client, and servers for it to ask.

Its rules are those of the client's source: of version 0.16 and of the one that reads texts as
JSON and needs the names of inputs. What both would read differently is an error here.
"""

import io
import json
import re
import threading
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import pytest

from spheremesh.fabrication.rhino import isolation
from spheremesh.interfaces.hops.application import Service, application
from spheremesh.interfaces.hops.server import make_server, make_service
from spheremesh.nodes import MemoryStore

Value: TypeAlias = Any
Send = Callable[..., tuple[int, str, bytes]]
PARAMETERS = {
    "Boolean", "Brep", "Curve", "Integer", "Line", "Mesh", "Number", "Plane", "Point", "Text",
    "Vector",
}  # fmt: skip
OBJECTS = {"Brep", "Curve", "Extrusion", "Mesh"}
COORDINATES = {"Point3d": "XYZ", "Vector3d": "XYZ", "Line": ("From", "To")}


class HopsCrash(Exception):  # noqa: N818 - what the client would do
    """The client would fail without a word."""


class Rebuilt(Exception):  # noqa: N818 - what the client does
    """The component is described and made anew."""


class HopsError(Exception):
    """What stands on the component in red."""


@dataclass
class Grasshopper:
    """The client: components that it knows, and the answers that it keeps."""

    send: Send
    kept: dict[str, Any] = field(default_factory=dict)
    status: int = 0
    warnings: list[str] = field(default_factory=list)

    def get(self, path: str, **headers: str) -> Value:
        """Status and JSON of an address."""
        status, kind, body = self.send("GET", path, None, **headers)
        if "json" not in kind:
            raise HopsCrash("taken for a definition: sent to Rhino.Compute")
        return status, read_json(body)

    def describe(self, name: str) -> dict[str, Any]:
        """What a component is made of."""
        status, found = self.get(f"/{name}")
        found = {key.lower(): value for key, value in found.items()}
        for key in ("inputs", "outputs", "inputnames", "outputnames", "errors", "warnings"):
            if not isinstance(found.get(key), list):
                raise HopsCrash(f"NullReferenceException: {key}")
        if status != 200 or found["errors"]:
            assert status != 200, "an error is kept for the session"
            assert found["message"] == found["errors"][0]
            raise HopsError(found["message"])
        for port in (*found["inputs"], *found["outputs"]):
            assert port["ParamType"] in PARAMETERS, port
        names = [[port["Name"] for port in found[side]] for side in ("inputs", "outputs")]
        assert names == [found["inputnames"], found["outputnames"]]
        assert all(len(set(several)) == len(several) for several in names)
        return found

    def solve(self, name: str, /, document: str = "Meters", **trees: Value) -> dict[str, Any]:
        """Values by output: a list for one branch, else lists by path."""
        found = self.describe(name)
        values = [
            {"ParamName": port["Name"], "InnerTree": self.tree(port, trees)}
            for port in found["inputs"]
        ]
        assert not trees, f"{name} has no inputs {list(trees)}"
        return self.ask(name, values, found["outputnames"], document)

    def tree(self, port: dict[str, Any], trees: dict[str, Any]) -> dict[str, Any]:
        """The data of an input, taken out of those given."""
        name, is_item = port["Name"], port["AtLeast"] == port["AtMost"] == 1
        if name not in trees:
            if is_item and "Default" in port:
                return {"{0}": [item(port["ParamType"], port["Default"])]}
            assert port["AtLeast"] == 0, f"{name}: the client collects no data"
            return {}
        given = trees.pop(name)
        is_tree = isinstance(given, dict) and all(path.startswith("{") for path in given)
        branches = given if is_tree else {"{0}": given}
        items = {
            path: [item(port["ParamType"], x) for x in (b if isinstance(b, list) else [b])]
            for path, b in branches.items()
        }
        for each in (x for several in items.values() for x in several):
            if "Minimum" in port:
                assert json.loads(each["data"]) >= port["Minimum"]
            if "Maximum" in port:
                assert json.loads(each["data"]) <= port["Maximum"]
        return items

    def ask(
        self, pointer: str, values: Value, outputs: list[str], units: str = "Meters"
    ) -> dict[str, Any]:
        """The answer to a request, converted."""
        request = json.dumps({
            "absolutetolerance": 0.001, "angletolerance": 1.0, "modelunits": units,
            "dataversion": 7, "algo": None, "pointer": pointer, "cachesolve": True,
            "values": values, "warnings": [], "errors": [],
        })  # fmt: skip
        answer = self.kept.get(request)
        if answer is None:
            self.status, kind, body = self.send("POST", "/solve", request.encode())
            assert "json" in kind
            answer = read_json(body)
        for key in ("values", "errors", "warnings"):
            if not isinstance(answer.get(key), list):
                raise HopsCrash(f"NullReferenceException: {key}")
        self.warnings = answer["warnings"]
        if answer["errors"]:
            assert self.status not in (200, 203, 401, 408), "kept, or replaced by another text"
            if answer["errors"][0].lower() == "bad inputs":
                raise Rebuilt(answer["message"])
            raise HopsError(answer["errors"][0])
        assert [tree["ParamName"] for tree in answer["values"]] == outputs, "made anew"
        if self.status == 200:
            self.kept[request] = answer
        found: dict[str, Any] = {}
        for tree in answer["values"]:
            branches = {
                path: [value_of(x) for x in items] for path, items in tree["InnerTree"].items()
            }
            assert all(re.fullmatch(r"\{\d+(;\d+)*\}", path) for path in branches)
            one = next(iter(branches.values())) if len(branches) == 1 else branches
            found[tree["ParamName"]] = one
        return found


def read_json(body: bytes) -> Value:
    def refuse(text: str) -> None:
        raise HopsCrash(f"{text} is no JSON")

    return json.loads(body, parse_constant=refuse)


def item(kind: str, value: Value) -> dict[str, str]:
    """A value as Rhino's own classes are written by Json.NET."""
    if isinstance(value, dict) and "type" in value:
        return value
    if kind in ("Mesh", "Brep", "Curve"):
        return {"type": f"Rhino.Geometry.{kind}", "data": json.dumps(value)}
    if kind in ("Point", "Vector"):
        axes = dict(zip("XYZ", map(float, value), strict=True))
        name = "Point3d" if kind == "Point" else "Vector3d"
        return {"type": f"Rhino.Geometry.{name}", "data": json.dumps(axes)}
    if kind == "Plane":
        return {"type": "Rhino.Geometry.Plane", "data": json.dumps(value)}
    kinds = {"Boolean": "Boolean", "Integer": "Int32", "Number": "Double", "Text": "String"}
    if kind == "Number" and isinstance(value, int) and not isinstance(value, bool):
        kinds["Number"] = "Int32"  # a slider of whole numbers
    return {"type": f"System.{kinds[kind]}", "data": json.dumps(value, ensure_ascii=False)}


def value_of(given: dict[str, str]) -> Value:
    kind, data = given["type"], given["data"]
    if kind == "System.String":
        old, new = old_text(data), new_text(data)
        assert old == new, f"clients read {data!r} as {old!r} and as {new!r}"
        return new
    data = data.strip('"')
    if kind == "System.Double":
        german = float(data.replace(".", "").replace(",", "."))
        assert float(data) == german, f"{data} is {german} in German"
        assert np.isfinite(german)
        return german
    if kind == "System.Int32":
        assert -(2**31) <= int(data) < 2**31
        return int(data)
    if kind == "System.Boolean":
        return {"true": True, "false": False}[data.lower()]
    name = kind.removeprefix("Rhino.Geometry.")
    found = read_json(data.encode())
    if name in COORDINATES:
        assert set(found) == set(COORDINATES[name])
        return found
    if name in OBJECTS:
        assert {"version", "archive3dm", "opennurbs", "data"} <= set(found)
        return found
    raise HopsCrash(f"unable to convert resthopper data {kind}")


def old_text(data: str) -> str:
    text = data.strip('"')
    if text.strip().startswith("{") and "\\" in text:
        text = re.sub(r"\\(.)", lambda m: {"n": "\n", "t": "\t"}.get(m[1], m[1]), text)
    return text


def new_text(data: str) -> str:
    try:
        found = json.loads(data)
    except ValueError:
        return old_text(data)
    assert isinstance(found, str), f"{data} is read as a number"
    return found


@pytest.fixture
def error_of() -> type[Exception]:
    return HopsError


def in_process(service: Service) -> Send:
    app = application(service)

    def send(
        method: str, path: str, body: bytes | None, **headers: str
    ) -> tuple[int, str, bytes]:
        environ = {
            "REQUEST_METHOD": method, "PATH_INFO": path, "HTTP_HOST": "localhost:5555",
            "CONTENT_TYPE": "application/json; charset=utf-8",
            "CONTENT_LENGTH": str(len(body or b"")), "wsgi.input": io.BytesIO(body or b""),
            **headers,
        }  # fmt: skip
        said: list[Any] = []
        content = b"".join(app(environ, lambda status, heads: said.extend((status, heads))))
        return int(said[0].split()[0]), dict(said[1])["Content-Type"], content

    return send


@dataclass
class Opened:
    """A service, and a client of it."""

    service: Service
    gh: Grasshopper
    files: Path
    graphs: Path


@contextmanager
def opener(folder: Path) -> Iterator[Callable[..., Opened]]:
    """Make services and clients that ask them without a network."""
    services: list[Service] = []
    for name in ("files", "graphs"):
        (folder / name).mkdir(exist_ok=True)

    def make(store: Value = None, **options: Value) -> Opened:
        options = {"files": folder / "files", "graphs": folder / "graphs", **options}
        service = make_service(MemoryStore() if store is None else store, **options)
        services.append(service)
        client = Grasshopper(in_process(service))
        return Opened(service, client, options["files"], folder / "graphs")

    yield make
    for service in services:
        service.jobs.close()


@pytest.fixture
def opened(tmp_path: Path) -> Iterator[Callable[..., Opened]]:
    with opener(tmp_path) as make:
        yield make


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Opened]:
    """One service for all tests of a module that leave it as it is."""
    with opener(tmp_path_factory.mktemp("shared")) as make:
        yield make()


@pytest.fixture
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """What Rhino's library reads is read here: starting processes is tested elsewhere."""
    monkeypatch.setattr(isolation, "_can_start", lambda: False)


@pytest.fixture
def gh(shared: Opened) -> Grasshopper:
    return Grasshopper(shared.gh.send)


@contextmanager
def network(found: Opened) -> Iterator[tuple[str, Opened]]:
    """A server: its address, and what is behind."""
    server = make_server(found.service, "127.0.0.1", 0)

    def run() -> None:
        with suppress(OSError):  # closed from outside
            server.run()

    threading.Thread(target=run, daemon=True).start()
    address = f"http://127.0.0.1:{server.effective_port}"
    yield address, replace(found, gh=Grasshopper(over_network(address)))
    server.close()


@pytest.fixture
def served(opened: Callable[..., Opened]) -> Iterator[Callable[..., tuple[str, Opened]]]:
    with ExitStack() as stack:
        yield lambda **options: stack.enter_context(network(opened(**options)))


@pytest.fixture(scope="module")
def shared_address(shared: Opened) -> Iterator[str]:
    with network(shared) as (address, _):
        yield address


def over_network(address: str) -> Send:
    def send(
        method: str, path: str, body: bytes | None, **headers: str
    ) -> tuple[int, str, bytes]:
        request = urllib.request.Request(  # noqa: S310
            address + path, body, {"Content-Type": "application/json", **headers}, method=method
        )
        try:
            with urllib.request.urlopen(request, timeout=60) as answer:  # noqa: S310
                return answer.status, answer.headers["Content-Type"], answer.read()
        except urllib.error.HTTPError as error:
            with error:
                return error.code, error.headers["Content-Type"], error.read()

    return send
