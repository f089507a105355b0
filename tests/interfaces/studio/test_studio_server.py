"""The studio's server: what it refuses, and what becomes of edits and runs."""

import http.client
import json
import time
from pathlib import Path
from typing import Any

import pytest

from spheremesh.nodes import Graph
from spheremesh.viewer.page.container import unpack_arrays

Studio = Any
Value = Any


BYTES = {"Content_Type": "application/octet-stream"}


@pytest.mark.parametrize(
    ("status", "method", "path", "body", "headers", "message"),
    [
        (401, "GET", "/studio/state", None, {"Authorization": ""}, "address"),
        (401, "POST", "/studio/run", {}, {"Authorization": "Bearer guessed"}, "address"),
        (401, "GET", "/studio/blob/0", None, {"Authorization": ""}, "address"),
        (421, "GET", "/studio", None, {"Host": "example.com"}, "no 'example.com' here"),
        (421, "GET", "/studio/state", None, {"Host": "127.0.0.1.example.com"}, "here"),
        (403, "POST", "/studio/edit", {}, {"Origin": "https://example.com"}, "other pages"),
        (403, "POST", "/studio/edit", {}, {"Origin": "null"}, "other pages"),
        (403, "POST", "/studio/edit", {}, {"Origin": "http://127.0.0.1:1"}, "other pages"),
        (403, "GET", "/studio/state", None, {"Sec_Fetch_Site": "cross-site"}, "other pages"),
        (413, "POST", "/studio/edit", b" " * 34_000_000, {}, "MB"),
        (415, "POST", "/studio/edit", b"{}", {"Content_Type": "text/plain"}, "json"),
        (400, "POST", "/studio/edit", b"{", {}, "no JSON"),
        (400, "POST", "/studio/edit", b"[" * 90_000, {}, "no JSON"),
        (400, "POST", "/studio/edit", {"ops": []}, {}, "rev"),
        (400, "POST", "/studio/run", {"targets": ["x"] * 99}, {}, "outputs"),
        (404, "GET", "/studio/blob/00", None, {}, "kept"),
        (404, "GET", "/studio/secret", None, {}, "here"),
        (405, "GET", "/studio/edit", None, {}, "POST"),
        (405, "POST", "/studio/state", {}, {}, "GET"),
        (405, "DELETE", "/studio", None, {}, "GET"),
        (403, "POST", "/studio/open", {"file": "../x.json"}, {}, "outside"),
        (403, "POST", "/studio/open", {"file": "/etc/passwd"}, {}, "outside"),
        (403, "POST", "/studio/save", {"file": "a/../../x"}, {}, "outside"),
        (403, "POST", "/studio/save", {"file": "x\0y"}, {}, "can be no path"),
        (403, "POST", "/studio/export", {"folder": "../out"}, {}, "outside"),
        (403, "POST", "/studio/export", {"folder": "."}, {}, "outside"),
        (403, "GET", "/studio/replaced?folder=..", None, {}, "outside"),
        (401, "POST", "/studio/receive?name=a.obj", b"", {"Authorization": ""}, "address"),
        (403, "POST", "/studio/receive?name=a.obj", b"", {"Origin": "null"}, "other pages"),
        (415, "POST", "/studio/receive?name=a.obj", b"", {}, "octet-stream"),
        (413, "POST", "/studio/receive?name=a.obj", b" " * 34_000_000, BYTES, "MB"),
        (422, "POST", "/studio/receive?name=a.json", b"{}", BYTES, "no mesh file"),
        (422, "POST", "/studio/receive?name=..", b"", BYTES, "no mesh file"),
        (403, "POST", "/studio/open", {"template": "beams", "mesh": "../x.obj"}, {}, "outside"),
        (422, "POST", "/studio/open", {"template": "beams", "mesh": "no.obj"}, {}, "no.obj"),
        (422, "POST", "/studio/open", {"file": "none.json"}, {}, "none.json"),
        (422, "POST", "/studio/open", {"template": "nothing"}, {}, "template"),
        (422, "POST", "/studio/revert", {"version": "../x"}, {}, "version"),
    ],
)  # fmt: skip
def test_attacks_and_mistakes_are_refused_with_their_codes(
    studio: Studio, status: int, method: str, path: str, body: Value,
    headers: dict[str, str], message: str,
) -> None:  # fmt: skip
    got, said = studio.ask(method, path, body, **headers)
    assert (got, message in said["error"]) == (status, True), said


def test_hops_is_served_beside_and_refuses_every_page(studio: Studio) -> None:
    status, said = studio.ask("GET", "/fit_spheres")
    assert (status, said["Name"]) == (200, "fit_spheres")
    own = f"http://127.0.0.1:{studio.port}"
    assert studio.ask("GET", "/fit_spheres", Origin=own)[0] == 403
    assert studio.ask("GET", "/studio/state", Origin=own)[0] == 200


def test_the_page_is_anybodys_and_may_ask_nobody_else(studio: Studio) -> None:
    for name in ("", "/studio.js", "/studio.css", "/viewer.js"):
        line = http.client.HTTPConnection("127.0.0.1", studio.port)
        line.request("GET", f"/studio{name}")
        answer = line.getresponse()
        assert answer.status == 200
        policy = answer.headers["Content-Security-Policy"]
        assert "default-src 'none'; script-src 'self'" in policy
        assert "frame-ancestors 'none'" in policy
        answer.read()
        line.close()


def test_a_link_out_of_the_folder_is_no_way_out(studio: Studio, tmp_path: Path) -> None:
    (tmp_path / "theirs.json").write_text("{}")
    link = studio.folder / "link.json"
    link.symlink_to(tmp_path / "theirs.json")
    assert studio.ask("POST", "/studio/open", {"file": "link.json"})[0] == 403
    link.unlink()


@pytest.mark.parametrize("path", ["../secret.obj", "/etc/passwd", "a/../../b.obj"])
def test_paths_of_steps_stay_in_the_folder(studio: Studio, vase: Graph, path: str) -> None:
    vase.add("read_mesh", "other", path="fine.obj")
    studio.open(vase)
    give = {"op": "give", "step": "other", "port": "path", "value": path}
    status, said = studio.edit(give)
    assert status == 422
    assert "--files" in said["error"]
    # A graph that somebody else has written is opened, and its step is not run.
    vase.rewire("other", path=path)
    studio.open(vase)
    studio.run("other.result")
    fault = studio.event(lambda e: e["type"] == "fault")
    assert (fault["step"], "--files" in fault["text"]) == ("other", True)


def test_a_mesh_that_is_dropped_stays_in_the_folder_and_replaces_nothing(
    studio: Studio,
) -> None:
    def drop(name: str, data: bytes) -> tuple[int, Value]:
        return studio.ask("POST", f"/studio/receive?name={name}", data, **BYTES)

    assert drop("../../up/mine.obj", b"v 0 0 0") == (200, {"file": "mine.obj"})
    assert drop("mine.obj", b"v 0 0 0") == (200, {"file": "mine.obj"})
    assert drop("c:%5Cmine.obj", b"v 1 0 0") == (200, {"file": "mine 2.obj"})
    assert (studio.folder / "mine.obj").read_bytes() == b"v 0 0 0"
    assert "mine 2.obj" in studio.ask("GET", "/studio/files?ending=mesh")[1]
    said = studio.ask("POST", "/studio/open", {"template": "moulds", "mesh": "mine.obj"})
    assert said[0] == 422
    assert "mine.obj" in said[1]["error"]


def test_a_template_is_no_file_until_it_is_changed(studio: Studio) -> None:
    _, said = studio.ask("POST", "/studio/open", {"template": "study"})
    assert said["is_new"]
    studio.edit({"op": "title", "text": "Mine"})
    studio.session.document.save()
    _, said = studio.ask("GET", "/studio/state")
    assert not said["is_new"]
    assert Path(said["place"], said["file"]).is_file()


def test_an_edit_of_an_old_revision_is_told_the_present_one(
    studio: Studio, vase: Graph
) -> None:
    studio.open(vase)
    rev = studio.session.document.rev
    assert studio.edit({"op": "set", "param": "moulds", "value": 4})[0] == 200
    body = {"rev": rev, "ops": [{"op": "set", "param": "moulds", "value": 9}]}
    status, said = studio.ask("POST", "/studio/edit", body)
    assert status == 409
    assert said["rev"] == rev + 1
    assert said["graph"]["params"]["moulds"]["value"] == 4


def test_only_what_depends_on_a_slider_runs_and_going_back_costs_nothing(
    studio: Studio, vase: Graph
) -> None:
    studio.open(vase)
    assert studio.run("panels.panels")["state"] == "done"
    first = studio.event(lambda e: e["type"] == "preview")["digest"]
    studio.heard.clear()
    studio.edit({"op": "set", "param": "moulds", "value": 5})
    studio.run("panels.panels")
    assert studio.made() == ["few", "panels"]
    studio.heard.clear()
    studio.edit({"op": "set", "param": "moulds", "value": 3})
    studio.run("panels.panels")
    assert studio.made() == []
    assert studio.event(lambda e: e["type"] == "preview")["digest"] == first
    status, data = studio.ask("GET", f"/studio/blob/{first}")
    assert status == 200
    head, arrays = unpack_arrays(data)
    assert (head["kind"], head["words"]) == ("model", "50 panels · 3 moulds")
    assert set(arrays["value_0"].tolist()) == {1, 2, 3}


def test_warnings_are_those_of_the_result_that_is_shown(studio: Studio, vase: Graph) -> None:
    """Made, kept or undone: a step says what its result was warned about, or nothing."""
    studio.open(vase)
    said: dict[int, list[str]] = {}
    for moulds in (3, 12, 3, 12):
        studio.edit({"op": "set", "param": "moulds", "value": moulds})
        studio.run("panels.panels")
        warned = studio.session.runs.state["steps"]["few"]["messages"]
        assert warned == said.setdefault(moulds, warned)
    assert said[3] == []
    assert "of 12" in said[12][0]
    studio.ask("POST", "/studio/undo", {})
    studio.run("panels.panels")
    assert studio.session.runs.state["steps"]["few"]["messages"] == []
    studio.ask("POST", "/studio/redo", {})
    studio.session.runs.forget()  # as after opening it again: only the picture is asked for
    studio.run("panels.panels")
    assert studio.session.runs.state["steps"]["few"]["messages"] == said[12]


def test_a_fault_of_one_target_is_none_of_the_others(studio: Studio, vase: Graph) -> None:
    vase.add("read_mesh", "other", path="no.obj")
    studio.open(vase)
    assert studio.run("other.result", "few.report")["state"] == "failed"
    fault = studio.event(lambda e: e["type"] == "fault")
    assert fault["step"] == "other"
    assert "no.obj" in fault["text"]
    assert studio.event(lambda e: e["type"] == "preview")["target"] == "few.report"
    assert studio.session.runs.state["steps"]["other"]["state"] == "failed"


def test_a_run_that_is_killed_in_mid_step_leaves_the_next_one_right(
    studio: Studio, vase: Graph
) -> None:
    slow = Graph("Slow")
    mesh = slow.add("roof_mesh", "mesh", n_span=120, n_length=300)
    fit = slow.add("fit_spheres", "fit", mesh=mesh)
    slow.add("optimize_spheres", "best", sphere_mesh=fit, tolerance=0.2)
    studio.open(slow)
    _, said = studio.ask("POST", "/studio/run", {"targets": ["best.sphere_mesh"]})
    studio.event(
        lambda e: e["type"] == "step" and e["state"] == "running" and e["step"] != "mesh"
    )
    assert studio.ask("POST", "/studio/cancel", {"run": said["run"] + 7})[1] == {
        "cancelled": False
    }
    began = time.monotonic()
    assert studio.ask("POST", "/studio/cancel", {"run": said["run"]})[1] == {"cancelled": True}
    assert studio.ended(said["run"])["state"] == "cancelled"
    assert time.monotonic() - began < 5
    studio.open(vase)
    assert studio.run("panels.panels")["state"] == "done"
    plain = vase.run("few.radii")
    studio.run("few.radii")
    found = studio.event(lambda e: e["type"] == "preview" and e["target"] == "few.radii")
    _, data = studio.ask("GET", f"/studio/blob/{found['digest']}")
    assert unpack_arrays(data)[0]["rows"] == plain.tolist()


def test_files_are_exported_and_nothing_of_the_users_is_replaced(
    studio: Studio, vase: Graph
) -> None:
    panels = vase.steps["panels"]
    vase.add("write_schedule", "table", panels=panels.panels, path="parts.csv")
    studio.open(vase)
    assert studio.ask("GET", "/studio/replaced?folder=out") == (200, [])
    _, said = studio.ask("POST", "/studio/export", {"folder": "out"})
    ended = studio.ended(said["run"])
    assert (ended["state"], ended["text"]) == ("done", "parts.csv")
    assert (studio.folder / "out" / "parts.csv").read_text().count("\n") == 51
    assert studio.ask("GET", "/studio/replaced?folder=out") == (200, ["parts.csv"])
    assert studio.ask("GET", "/studio/replaced?folder=other") == (200, [])
    (studio.folder / "out" / "parts.csv").write_text("mine")
    _, said = studio.ask("POST", "/studio/export", {"folder": "out"})
    ended = studio.ended(said["run"])
    assert ended["state"] == "failed"
    assert "changed" in ended["text"]
    assert (studio.folder / "out" / "parts.csv").read_text() == "mine"


def test_the_file_is_saved_as_it_is_edited_and_older_ones_are_kept(
    studio: Studio, vase: Graph
) -> None:
    studio.open(vase)
    document = studio.session.document
    first = document.path.read_text()
    studio.edit({"op": "set", "param": "moulds", "value": 7})
    document.save()
    assert json.loads(document.path.read_text())["params"]["moulds"]["value"] == 7
    document.path.write_text(first + "\n")  # by another program
    studio.edit({"op": "set", "param": "moulds", "value": 8})
    document.save()
    _, state = studio.ask("GET", "/studio/state")
    texts = {path.read_text() for path in document.versions()}
    assert {first, first + "\n"} & texts
    assert first + "\n" in texts
    version = next(p.stem for p in document.versions() if p.read_text() == first + "\n")
    assert version in state["versions"]
    assert studio.ask("POST", "/studio/revert", {"version": version})[0] == 200
    assert studio.session.document.content()["graph"]["params"]["moulds"]["value"] == 3


def test_events_reach_every_page_until_it_goes(studio: Studio, vase: Graph) -> None:
    studio.open(vase)
    lines = []
    for _ in range(2):
        line = http.client.HTTPConnection("127.0.0.1", studio.port, timeout=20)
        line.request(
            "GET", "/studio/events", headers={"Authorization": "Bearer a-token-of-the-tests"}
        )
        answer = line.getresponse()
        assert answer.headers["Content-Type"] == "text/event-stream"
        assert json.loads(_data(answer))["type"] == "hello"
        lines.append((line, answer))
    studio.edit({"op": "title", "text": "Another"})
    for _, answer in lines:
        told = json.loads(_data(answer))
        assert (told["type"], told["rev"]) == ("doc", studio.session.document.rev)
    for line, answer in lines:
        answer.close()
        line.close()


def _data(answer: http.client.HTTPResponse) -> bytes:
    while True:
        text = answer.fp.readline()
        if text.startswith(b"data: "):
            return text.removeprefix(b"data: ")
