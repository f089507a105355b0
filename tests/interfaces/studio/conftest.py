"""A studio that is open: its session, its server, and who asks it."""

import http.client
import json
import shutil
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from spheremesh.interfaces.hops.application import application
from spheremesh.interfaces.hops.server import make_server, make_service
from spheremesh.interfaces.studio.application import studio_application
from spheremesh.interfaces.studio.session import Session
from spheremesh.interfaces.studio.worker import Place
from spheremesh.nodes import Graph, MemoryStore

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = [
    "--enable-unsafe-swiftshader",
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
]
TOKEN = "a-token-of-the-tests"  # noqa: S105

Value = Any
Browser = Any


@dataclass
class Studio:
    """A session with its server, and what it tells."""

    session: Session
    port: int
    folder: Path
    heard: list[dict[str, Value]] = field(default_factory=list)

    @property
    def address(self) -> str:
        """Of the page, with its token."""
        return f"http://127.0.0.1:{self.port}/studio#{TOKEN}"

    def ask(
        self, method: str, path: str, body: Value = None, **headers: str
    ) -> tuple[int, Value]:
        """Status and content of an answer."""
        line = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        sent = {"Authorization": f"Bearer {TOKEN}", "Content-Type": "application/json"}
        sent |= {name.replace("_", "-"): text for name, text in headers.items()}
        data = body if isinstance(body, bytes | None) else json.dumps(body).encode()
        line.request(method, path, data, {k: x for k, x in sent.items() if x})
        answer = line.getresponse()
        content = answer.read()
        line.close()
        is_json = "json" in (answer.headers["Content-Type"] or "")
        return answer.status, json.loads(content) if is_json else content

    def edit(self, *operations: Value, gesture: str = "") -> tuple[int, Value]:
        """Change the present graph."""
        rev = self.session.document.rev
        body = {"rev": rev, "ops": operations, "gesture": gesture}
        return self.ask("POST", "/studio/edit", body)

    def open(self, graph: Graph) -> None:
        """Begin with a graph, as if it had been opened from its file."""
        path = self.folder / "graph.json"
        graph.save(path)
        status, said = self.ask("POST", "/studio/open", {"file": "graph.json"})
        assert status == 200, said
        self.heard.clear()

    def run(self, *targets: str) -> dict[str, Value]:
        """Run and wait; the event that ends it."""
        status, said = self.ask("POST", "/studio/run", {"targets": targets})
        assert status == 200, said
        return self.ended(said["run"])

    def ended(self, run: int, seconds: float = 60.0) -> dict[str, Value]:
        """The event that ends a run."""
        return self.event(
            lambda e: e["type"] == "run" and e["run"] == run and e["state"] != "running",
            seconds,
        )

    def event(self, is_meant: Value, seconds: float = 60.0) -> dict[str, Value]:
        """The first event that is meant, once it has come."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            found = next(filter(is_meant, list(self.heard)), None)
            if found is not None:
                return found
            time.sleep(0.01)
        raise AssertionError(f"not heard; {self.heard[-5:]}")

    def made(self) -> list[str]:
        """The steps that were made since the events were last forgotten."""
        return [e["step"] for e in self.heard if e["type"] == "step" and e["state"] == "done"]


@pytest.fixture(scope="module")
def studio(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Studio]:
    folder = tmp_path_factory.mktemp("studio")
    cache = tmp_path_factory.mktemp("cache")
    session = Session(Place(str(cache), str(folder)))
    service = make_service(MemoryStore())
    answers = studio_application(session, service.limits, TOKEN, application(service))
    server = make_server(service, "127.0.0.1", 0, answers)

    def run() -> None:
        with suppress(OSError):  # closed from outside
            server.run()

    threading.Thread(target=run, daemon=True).start()
    found = Studio(session, server.effective_port, folder)
    tell = session.channels.tell

    def told(event: dict[str, Value]) -> None:
        found.heard.append(event)
        tell(event)

    session.channels.tell = told
    session.runs._tell = told
    yield found
    session.close()
    time.sleep(0.1)  # what was being sent is
    server.close()


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is missing")
    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    if program is None:
        pytest.skip("there is no Chromium: install the package chromium")
    with playwright.sync_playwright() as play:
        opened = play.chromium.launch(executable_path=program, args=FLAGS)
        yield opened
        opened.close()


@pytest.fixture
def vase() -> Graph:
    """A vase in a few moulds: quickly made and quickly drawn."""
    graph = Graph("Vase")
    moulds = graph.param("moulds", 3, min=1, max=12)
    mesh = graph.add("vase_mesh", "mesh", n_around=10, n_across=5)
    fit = graph.add("fit_spheres", "fit", mesh=mesh)
    few = graph.add("cluster_radii", "few", sphere_mesh=fit, k=moulds)
    given = {"sphere_mesh": few.sphere_mesh, "labels": few.labels}
    graph.add("panels", "panels", thickness=0.02, **given)
    return graph
