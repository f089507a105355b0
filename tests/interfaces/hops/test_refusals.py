"""What is refused, over the network: always in JSON, and never kept by the client."""

import http.client
import json
import socket
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spheremesh.fabrication.rhino_objects.meshes import mesh_fields
from spheremesh.nodes import vase_mesh

Value: TypeAlias = Any
JSON = {"Content-Type": "application/json"}
SOLVE = json.dumps({"pointer": "vase_mesh", "values": []}).encode()


def asked(
    address: str, method: str, path: str, body: bytes | None = None, **headers: str
) -> tuple[int, dict[str, Value]]:
    host = address.removeprefix("http://")
    line = http.client.HTTPConnection(host, timeout=30)
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    line.request(method, path, body, {**JSON, **named})
    answer = line.getresponse()
    assert answer.headers["Content-Type"] == "application/json; charset=utf-8"
    content = json.loads(answer.read())
    line.close()
    return answer.status, content


@pytest.mark.parametrize(
    ("status", "method", "path", "body", "headers", "message"),
    [
        (403, "POST", "/solve", SOLVE, {"Origin": "https://example.com"}, "pages of the web"),
        (403, "POST", "/solve", SOLVE, {"Origin": "null"}, "pages of the web"),
        (
            403,
            "GET",
            "/fit_spheres",
            None,
            {"Origin": "https://example.com"},
            "pages of the web",
        ),
        (421, "POST", "/solve", SOLVE, {"Host": "example.com"}, "no 'example.com' here"),
        (421, "GET", "/", None, {"Host": "127.0.0.1.example.com:80"}, "--allow-host"),
        (415, "POST", "/solve", SOLVE, {"Content_Type": "text/plain"}, "application/json"),
        (400, "POST", "/solve", b"{", {}, "no JSON"),
        (400, "POST", "/solve", b"\xff", {}, "no JSON"),
        (400, "POST", "/solve", b"[" * 100_000, {}, "no JSON"),
        (400, "POST", "/solve", b"[1]", {}, "no JSON object"),
        (400, "POST", "/solve", b'{"pointer": "vase_mesh", "values": NaN}', {}, "NaN"),
        (500, "POST", "/solve", b'{"pointer": "vase_mesh"}', {}, "values"),
        (404, "POST", "/solve", b'{"pointer": "vas_mesh", "values": []}', {}, "vase_mesh"),
        (404, "POST", "/vase_mesh", SOLVE, {}, "/solve"),
        (404, "GET", "/../../etc/passwd", None, {}, "no component"),
        (404, "GET", "/" + "x" * 5000, None, {}, "no component"),
        (405, "DELETE", "/vase_mesh", None, {}, "only GET and POST"),
        (405, "OPTIONS", "/solve", None, {}, "only GET and POST"),
        (431, "GET", "/", None, {"X": "x" * 40_000}, "max_header"),
    ],
)
def test_a_request_is_refused_in_json(
    shared_address: str, status: int, method: str, path: str, body: bytes | None,
    headers: dict[str, str], message: str,
) -> None:  # fmt: skip
    got, content = asked(shared_address, method, path, body, **headers)
    assert got == status
    assert message in content["message"]
    errors = content.get("errors") or content["Errors"]
    assert errors == [content["message"]]
    lists = ("values", "warnings") if "values" in content else ("Inputs", "Outputs", "Warnings")
    assert all(content[name] == [] for name in lists)


@pytest.mark.parametrize("is_chunked", [False, True])
def test_a_body_of_200_megabytes_is_refused_in_json(
    shared_address: str, *, is_chunked: bool
) -> None:
    host, _, port = shared_address.removeprefix("http://").partition(":")
    block = b" " * 2**20
    with socket.create_connection((host, int(port)), timeout=60) as line:
        length = (
            "Transfer-Encoding: chunked" if is_chunked else f"Content-Length: {200 * 2**20}"
        )
        line.sendall(
            f"POST /solve HTTP/1.1\r\nHost: {host}\r\nContent-Type: application/json\r\n"
            f"{length}\r\n\r\n".encode()
        )
        sent = b"100000\r\n" + block + b"\r\n" if is_chunked else block
        for _ in range(65 if is_chunked else 200):
            line.sendall(sent)
        answer = line.recv(2**16)
        while b"\r\n\r\n" not in answer or not answer.endswith(b"}"):
            answer += line.recv(2**16)
    head, _, body = answer.partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 413 ")
    assert b"application/json" in head
    assert json.loads(body)["errors"] == [
        "the request is larger than 64 MB; send less, or start the server with --max-mb"
    ]
    status, _ = asked(shared_address, "GET", "/vase_mesh")
    assert status == 200


@pytest.mark.parametrize(
    "path",
    ["../out.obj", "/etc/out.obj", "a/../../out.obj", "link/out.obj", "out\0.obj", "x" * 5000],
)
def test_a_path_outside_of_the_folder_is_refused(
    opened: Callable[..., Any], tmp_path: Path, path: str
) -> None:
    one = opened()
    (one.files / "link").symlink_to(tmp_path)
    mesh = mesh_fields(vase_mesh(6, 3))
    with pytest.raises(
        Exception, match=r"write_mesh.path = .*(outside of|can be no path)|cannot"
    ):
        one.gh.solve("write_mesh", mesh=mesh, path=path)
    with pytest.raises(
        Exception, match=r"read_mesh.path = .*(outside of|can be no path)|cannot"
    ):
        one.gh.solve("read_mesh", path=path)
    assert not list(tmp_path.glob("*.obj"))


def test_files_of_the_user_are_not_replaced(opened: Callable[..., Any]) -> None:
    one = opened()
    (one.files / "mine.obj").write_text("mine")
    with pytest.raises(Exception, match="did not write; choose another name"):
        one.gh.solve("write_mesh", mesh=mesh_fields(vase_mesh(6, 3)), path="mine.obj")
    assert (one.files / "mine.obj").read_text() == "mine"


def test_without_a_folder_there_are_no_files(opened: Callable[..., Any]) -> None:
    one = opened(files=None)
    names = {each["Name"] for each in one.gh.get("/")[1]}
    assert {"repair_mesh", "fit_spheres", "show"} <= names
    assert not {name for name in names if name.startswith(("write_", "read_", "render"))}
    inputs = [each["Name"] for each in one.gh.describe("repair_mesh")["inputs"]]
    assert "mesh_path" not in inputs
    with pytest.raises(Exception, match="no component 'write_mesh'"):
        one.gh.ask("write_mesh", [], [])


def test_a_path_is_no_way_around_a_handle(opened: Callable[..., Any]) -> None:
    one = opened(files=None)
    item = {"type": "System.String", "data": json.dumps("/etc/passwd")}
    values = [{"ParamName": "mesh", "InnerTree": {"{0}": [item]}}]
    with pytest.raises(Exception, match=r"repair_mesh.mesh: String is nothing"):
        one.gh.ask("repair_mesh", values, [])


def test_names_of_this_machine_may_be_added(served: Callable[..., Any]) -> None:
    address, _ = served(hosts=["studio.local"])
    assert asked(address, "GET", "/vase_mesh", Host="STUDIO.local:5555")[0] == 200
    assert asked(address, "GET", "/vase_mesh", Host="[::1]:5555")[0] == 200
    assert asked(address, "GET", "/vase_mesh", Host="other.local")[0] == 421


def test_a_fault_of_ours_is_json_too(
    opened: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    one = opened()

    def fail(_: str) -> None:
        raise ZeroDivisionError("by nothing")

    monkeypatch.setattr(one.service.catalogue, "find", fail)
    with pytest.raises(Exception, match="ZeroDivisionError: by nothing: a fault of spheremesh"):
        one.gh.describe("fit_spheres")


KINDS = st.sampled_from(["System.Double", "System.String", "Rhino.Geometry.Mesh", "", None])
DATA = st.one_of(
    st.text(max_size=8),
    st.sampled_from(["NaN", "null", "{}", "[]", "1e999", "spheremesh:a:b", '"', "true", "-0"]),
    st.integers(-5, 40),
    st.none(),
)
ITEMS = st.lists(st.fixed_dictionaries({}, optional={"type": KINDS, "data": DATA}), max_size=2)
PATHS = st.sampled_from(["{0}", "{0;1}", "{9}", "0", "", "{x}"])
BRANCHES = st.dictionaries(PATHS, ITEMS, max_size=2)


@pytest.mark.usefixtures("in_this_process")
@settings(max_examples=100, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.data())
def test_whatever_is_asked_the_answer_is_json(shared: Value, data: st.DataObject) -> None:
    listed = data.draw(st.sampled_from(shared.service.catalogue.all()))
    pointer, inputs = listed.component.name, [each.name for each in listed.component.inputs]
    names = data.draw(st.lists(st.sampled_from([*inputs, "x"]), max_size=3))
    values = [{"ParamName": name, "InnerTree": data.draw(BRANCHES)} for name in names]
    body = json.dumps({"pointer": pointer, "values": values}).encode()
    status, kind, content = shared.gh.send("POST", "/solve", body)
    assert kind == "application/json; charset=utf-8"
    answer = json.loads(content, parse_constant=pytest.fail)
    assert (status in {200, 203}) == (answer["errors"] == [])
    assert "a fault of" not in "".join(answer["errors"])
