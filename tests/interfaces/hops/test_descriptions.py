"""Descriptions: quick, without heavy libraries; the page, the client's file, the command."""

import ast
import html
import json
import re
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any, TypeAlias

import pytest
from click.testing import CliRunner

from spheremesh.fabrication.rhino_objects.meshes import mesh_fields
from spheremesh.interfaces.cli import main
from spheremesh.interfaces.hops import client
from spheremesh.nodes import fit_spheres, vase_mesh

pytestmark = pytest.mark.filterwarnings("ignore::spheremesh.nodes.NodeWarning")
Value: TypeAlias = Any


def test_a_component_is_described_within_20_milliseconds(served: Callable[..., Any]) -> None:
    _, one = served()
    one.gh.describe("panels")
    seconds = []
    for name in ("fit_spheres", "panels", "write_step", "show", "no_such") * 4:
        began = time.perf_counter()
        one.gh.send("GET", f"/{name}", None)
        seconds.append(time.perf_counter() - began)
    assert sorted(seconds)[len(seconds) // 2] < 0.02


def test_every_input_says_how_it_may_be_given(gh: Value) -> None:
    found = {each["Name"]: each for each in gh.describe("panels")["inputs"]}
    assert "'bisector' or 'intersection' or 'axis'" in found["edges"]["Description"]
    assert "handle" in found["sphere_mesh"]["Description"]
    assert "may be left out" in found["labels"]["Description"]
    assert (found["crease"]["Minimum"], found["crease"]["Maximum"]) == (0, 180)
    assert "in deg" in found["crease"]["Description"]
    path = gh.describe("write_step")["inputs"][1]
    assert "within the folder of the server" in path["Description"]


def test_the_page_lists_all_components_without_scripts(served: Callable[..., Any]) -> None:
    address, one = served()
    send = one.gh.send
    status, kind, body = send("GET", "/", None, Accept="text/html,*/*")
    assert (status, kind) == (200, "text/html; charset=utf-8")
    text = body.decode()
    for listed in one.service.catalogue.all():
        assert f'<a href="/{listed.component.name}">' in text
    assert "<script" not in text
    assert f"{address}/fit_spheres" in html.unescape(text)
    assert not re.search(r"(src|href)=\"(?!/|#)", text)
    status, _, body = send("HEAD", "/", None)
    assert (status, body) == (200, b"")


def test_the_client_is_of_python_3_9_and_the_standard_library(gh: Value) -> None:
    status, kind, body = gh.send("GET", "/client.py", None)
    assert (status, kind) == (200, "text/x-python; charset=utf-8")
    tree = ast.parse(body, feature_version=(3, 9))
    imported = {
        name
        for statement in ast.walk(tree)
        for name in (
            [alias.name for alias in statement.names]
            if isinstance(statement, ast.Import)
            else [statement.module]
            if isinstance(statement, ast.ImportFrom)
            else []
        )
    }
    tops = {str(name).partition(".")[0] for name in imported}
    assert tops <= sys.stdlib_module_names
    assert all(not isinstance(each, ast.Match) for each in ast.walk(tree))


def test_the_client_calls_components(served: Callable[..., Any]) -> None:
    address, one = served(patience=5)
    server = client.Server(address)
    assert "fit_spheres" in server.names()
    made = server.call("vase_mesh", n_around=8, n_across=4)
    assert made["mesh"] == mesh_fields(vase_mesh(8, 4))
    fitted = server.call("fit_spheres", mesh=made["mesh"])
    assert len(fitted["spheres"]) == 32
    assert one.service.solver.handles.take(fitted["sphere_mesh"], "here").mesh.n_faces == 32
    best = server.call("minimize_angles", sphere_mesh=fitted["sphere_mesh"], target_angle=None)
    assert json.loads(best["report"])["angles_deg"]["spherical"]["mean"] > 0
    assert isinstance(best.warnings, list)
    rows = server.call("sphere_rows", centers=[(0, 0, 0), (1, 0, 0)], radii=[1, 2.5])
    facts = server.call("sphere_facts", spheres=rows["spheres"])
    assert facts["centers"] == [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)]
    assert facts["radii_squared"] == pytest.approx([1.0, 6.25])
    assert server.call("inversion", center=(0, 0, 1))["transform"].startswith("[[")
    axes = server.call("node_axes", sphere_mesh=fitted["sphere_mesh"])
    assert len(axes["lines"]) == len(fit_spheres(vase_mesh(8, 4)).mesh.vertices)
    zero = {"radii_u": [0.0], "radii_v": [0.0]}
    flag = server.call(
        "smooth_envelope", centers=[(0, 0, 0)], radii=[1.0], centers_u=[(1, 0, 0)],
        centers_v=[(0, 1, 0)], **zero,
    )  # fmt: skip
    assert flag["is_real"] == [True]


def test_the_client_says_what_is_wrong(served: Callable[..., Any]) -> None:
    address, _ = served()
    server = client.Server(address)
    with pytest.raises(client.ServerError, match="did you mean 'fit_spheres'"):
        server.call("fit_sphere")
    with pytest.raises(client.ServerError, match="has no input 'msh'; there are mesh, ring"):
        server.call("fit_spheres", msh=1)
    with pytest.raises(client.ServerError, match="mesh is missing"):
        server.call("fit_spheres")
    with pytest.raises(client.ServerError, match="start spheremesh serve"):
        client.Server("http://127.0.0.1:9").names()


@pytest.mark.parametrize(
    ("options", "code", "text"),
    [
        (("--port", "70000"), 2, "70000"),
        (("--graphs", "nowhere"), 2, "nowhere"),
        (("--import", "nobody_has_this"), 3, "--import nobody_has_this"),
        (("--host", "256.0.0.1"), 3, "cannot listen at 256.0.0.1:5555"),
    ],
)
def test_what_the_command_refuses(options: tuple[str, ...], code: int, text: str) -> None:
    result = CliRunner().invoke(main, ["serve", "--no-cache", *options])
    assert result.exit_code == code
    assert text in result.stderr


def test_the_command_serves_until_it_is_ended_and_describes_without_heavy_libraries() -> None:
    code = (
        "import signal, sys\n"
        "from spheremesh.interfaces.cli import main\n"
        "heavy = ('OCP', 'cadquery', 'rhino3dm', 'ezdxf', 'igl', 'meshio', 'rich')\n"
        "def end(*_):\n"
        "    print([name for name in heavy if name in sys.modules], flush=True)\n"
        "    sys.exit()\n"
        "signal.signal(signal.SIGTERM, end)\n"
        "main(['serve', '--port', '0', '--no-cache'])"
    )
    command = [sys.executable, "-c", code]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            server = client.Server(process.stdout.readline().split()[0])
            assert len(server.names()) > 90
            assert server.describe("fit_spheres")["Inputs"]
        finally:
            process.terminate()
        assert process.stdout.read().strip() == "[]"
