"""Does another program see what was written? three.js reads .3dm files in headless Chromium.

    npm install --prefix FOLDER three@VERSION rhino3dm@VERSION   (as in package.json)
    python benchmarks/three_dm_viewer/run.py FOLDER [PICTURES]

FOLDER holds node_modules. Served on localhost; the page counts objects by kind, posts them with
all messages of the console, and draws a picture. The files: a roof in five moulds with every
layer, a torus of blocks, and a torus of panels on beams.
"""

import base64
import json
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import warnings
from collections import Counter
from dataclasses import replace
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import numpy as np

from spheremesh import nodes
from spheremesh.fabrication.model import Model, Written
from spheremesh.fabrication.rhino_models.writer import RhinoOptions, write_3dm
from spheremesh.kernel.meshes.mesh import Mesh
from spheremesh.kernel.parts.records import select_parts

HERE = Path(__file__).parent
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
KINDS = {"ArcCurve": "Curve", "LineCurve": "Curve"}
PATIENCE = 120


def write_model(mesh: Mesh, path: Path, options: RhinoOptions, moulds: int) -> Written:
    """A mesh as panels in a Rhino file."""
    optimum = nodes.minimize_angles(nodes.fit_spheres(mesh))
    clusters = nodes.cluster_radii(optimum.sphere_mesh, k=moulds)
    made = nodes.panels(clusters.sphere_mesh, joint_gap=0.02, labels=clusters.labels)
    return write_3dm(Model(made.panels), path, replace(options, graph_json='{"steps": {}}'))


def write_beams(mesh: Mesh, path: Path, options: RhinoOptions, moulds: int) -> Written:
    """Every other panel of a mesh, so that the beams below are seen."""
    spheres = nodes.central_spheres(mesh)
    labels = nodes.cluster_radii(spheres, k=moulds).labels
    made = nodes.panels(spheres, edges="intersection", joint_gap=0.02, labels=labels).panels
    shown = select_parts(made, np.arange(made.n_panels) % 2 == 0)
    beams = nodes.beams(nodes.annulus_support(spheres).annuli).beams
    return write_3dm(Model(shown, beams), path, replace(options, graph_json="{}"))


class Handler(SimpleHTTPRequestHandler):
    """Serves a folder, and keeps what the page posts."""

    results: list[dict[str, Any]] = []  # noqa: RUF012

    def do_POST(self) -> None:
        """Keep what the page found."""
        size = int(self.headers["Content-Length"])
        self.results.append(json.loads(self.rfile.read(size)))
        self.send_response(204)
        self.end_headers()

    def log_message(self, *_: object) -> None:
        """Be quiet."""


def look(folder: Path) -> dict[str, Any]:
    """What the page found in model.3dm."""
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        sys.exit("needs Chromium: apt-get install chromium")
    Handler.results.clear()
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Handler, directory=str(folder)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with (
        tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile,
        (folder / "browser.log").open("w") as log,
    ):
        command = [
            browser, "--headless=new", "--no-sandbox", "--disable-gpu-sandbox",
            "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run",
            "--enable-logging=stderr", f"--user-data-dir={profile}",
            f"http://127.0.0.1:{server.server_port}/index.html",
        ]  # fmt: skip
        process = subprocess.Popen(command, stdout=log, stderr=log)
        try:
            end = time.monotonic() + PATIENCE
            while not Handler.results and time.monotonic() < end:
                time.sleep(0.2)
        finally:
            process.terminate()
            process.wait(30)
            server.shutdown()
    text = (folder / "browser.log").read_text(errors="replace")
    if not Handler.results:
        sys.exit(f"no answer from the page in {PATIENCE} s; the browser said:\n{text[-2000:]}")
    result = Handler.results[0]
    result["console"] = [line for line in text.splitlines() if "CONSOLE" in line]
    return result


def judge(name: str, written: dict[str, int], found: dict[str, Any], picture: Path) -> bool:
    """Compare what was written with what was found."""
    if "failure" in found:
        print(f"{name}: {found['failure']}")
        return False
    expected: Counter[str] = Counter()
    for kind, count in written.items():
        expected[KINDS.get(kind, kind)] += count
    print(f"{name}: written {dict(expected)}")
    print(f"  found {found['objects']}, {found['triangles']:.0f} triangles")
    print(f"  read in {found['seconds']:.1f} s")
    print(f"  layers {found['layers']}")
    print(f"  views {found['names']}, strings {found['strings']}")
    complaints = [*found["messages"], *map(str, found["warnings"]), *found["console"]]
    print(f"  messages {complaints}")
    picture.write_bytes(base64.b64decode(found["picture"].split(",")[1]))
    print(f"  picture {picture}")
    return found["objects"] == dict(expected) and not complaints


def main() -> None:
    """Write, look, judge."""
    warnings.simplefilter("ignore")
    modules = Path(sys.argv[1]).resolve() / "node_modules"
    pictures = Path(sys.argv[2] if len(sys.argv) > 2 else tempfile.mkdtemp())
    roof, torus = nodes.roof_mesh(24, 40), nodes.torus_mesh(24, 16)
    layers = ("Edges", "Centres", "Moulds")
    models = {
        "roof": (write_model, roof, RhinoOptions(layers=layers, reference=roof), 5),
        "torus of blocks": (write_model, torus, RhinoOptions("blocks", ()), 3),
        "torus on beams": (write_beams, torus, RhinoOptions(), 4),
    }
    is_good = True
    for name, (write, mesh, contents, moulds) in models.items():
        with tempfile.TemporaryDirectory() as folder:
            place = Path(folder)
            shutil.copy(HERE / "index.html", place)
            (place / "node_modules").symlink_to(modules)
            written = dict(write(mesh, place / "model.3dm", contents, moulds).counts)
            n_instances = written.pop("InstanceReference", 0)
            if n_instances:
                # three.js sets the member of a block in place of every instance.
                n_blocks = len({*_block_names(place / "model.3dm")})
                written["Brep"] += n_instances - n_blocks
            found = look(place)
            picture = pictures / f"{name.replace(' ', '_')}.png"
            is_good &= judge(name, written, found, picture)
    print("all objects found, no messages" if is_good else "NOT as written")
    sys.exit(not is_good)


def _block_names(path: Path) -> list[str]:
    import rhino3dm

    model: Any = rhino3dm.File3dm.Read(str(path))
    return [block.Name for block in model.InstanceDefinitions]


if __name__ == "__main__":
    main()
