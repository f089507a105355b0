"""Figures of the page in the system's Chromium, drawing in software.

python benchmarks/page.py          sizes, seconds until it answers, requests; to 20,000 panels
python benchmarks/page.py light    stripes on one sphere against their closed form, zoomed
"""

import base64
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.fit import fit_spheres
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net
from spheremesh.nodes import write_view
from spheremesh.viewer.page.faces import panel_faces
from spheremesh.viewer.page.grid import grid_about
from viewer import model, timed

FLAGS = [
    "--enable-unsafe-swiftshader",
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
]
SIZE = {"width": 1280, "height": 800}
ROUNDS = 3
MODELS = ((50, 100, True), (50, 100, False), (100, 200, False), (100, 200, True))
"""Rows and columns of roofs, and whether they are solids with beams and node cylinders."""

ZOOMS = (1, 10, 100)
Page = Any

PICTURE = """() => { const v = window.spheremesh.view, g = v.renderer.getContext(); v.drawNow();
  const w = g.drawingBufferWidth, h = g.drawingBufferHeight, a = new Uint8Array(4 * w * h);
  g.readPixels(0, 0, w, h, g.RGBA, g.UNSIGNED_BYTE, a);
  let s = ''; for (let i = 0; i < a.length; i += 8192)
    s += String.fromCharCode(...a.subarray(i, i + 8192));
  return [w, h, btoa(s)]; }"""

ANSWER = """() => { const v = window.spheremesh.view, began = performance.now();
  const [x, y] = v.project(v.shapes.centers[Math.floor(v.shapes.parts / 2)]);
  return [v.pick(x, y), Math.floor(v.shapes.parts / 2), began, performance.now()]; }"""

FROM_ABOVE = """() => { const p = window.spheremesh;
  p.set({hidden: new Set(['beams', 'nodes', 'axes'])}); p.view.fit([0, -0.01, 1]); }"""

OPEN_SKY = """() => { const p = window.spheremesh;
  p.set({shading: 1, color: 'none', hidden: new Set(['edges'])});
  const light = p.view.meshes.panels.geometry.attributes.light;
  light.array.fill(255); light.needsUpdate = true; p.view.fit([0.2, -1, 0.4]); }"""

TURN = """() => { const v = window.spheremesh.view, g = v.renderer.getContext();
  const a = new Uint8Array(4), began = performance.now(); v.orbit(0.4, 0.1); v.drawNow();
  g.readPixels(0, 0, 1, 1, g.RGBA, g.UNSIGNED_BYTE, a); return performance.now() - began; }"""


def opened(chromium: Any, path: Path, asked: list[str]) -> Page:  # noqa: ANN401
    """A page when it says that it is ready; what it asks for is noted."""
    page = chromium.new_page(viewport=SIZE)
    page.on("request", lambda request: asked.append(request.url))
    page.on("console", lambda m: None if "GPU stall" in m.text else asked.append(m.text))
    page.on("pageerror", lambda error: asked.append(str(error)))
    page.goto(path.as_uri())
    page.wait_for_selector("html[data-ready]", state="attached", timeout=120_000)
    return page


def sizes(launch: Any, folder: Path) -> None:  # noqa: ANN401
    """Bytes of pages, and when they are drawn and pick the right part, by their own clock."""
    for rows, columns, carried in MODELS:
        made, beams = model(rows, columns, carried=carried)
        path = folder / "view.html"
        _, seconds = timed(lambda: write_view(made, str(path), beams=beams))  # noqa: B023
        words = f"{made.n_panels} {'solids with beams' if carried else 'surfaces'}"
        print(f"{words}: {path.stat().st_size / 1e6:.2f} MB, written in {seconds:.2f} s CPU")
        for _ in range(ROUNDS if rows * columns <= 5000 else 1):
            chromium, asked = launch(), []
            page = opened(chromium, path, asked)
            ready = page.evaluate("performance.getEntriesByName('ready')[0].startTime")
            page.evaluate(
                "window.spheremesh.set({hidden: new Set(['beams', 'nodes', 'axes'])})"
            )
            page.evaluate("window.spheremesh.view.fit([0, -0.01, 1])")
            found, part, began, ended = page.evaluate(ANSWER)
            turned = page.evaluate(TURN)
            chromium.close()
            print(
                f"  ready after {ready / 1000:.2f} s; a click took {ended - began:.0f} ms "
                f"({'right' if found == part else 'WRONG'}), turned in {turned:.0f} ms; "
                f"{len(asked) - 1} requests and messages"
            )


def highlights(launch: Any, folder: Path) -> None:  # noqa: ANN401
    """Zebra stripes on panels of one sphere under an open sky, drawn and as they are."""
    made, _ = cut_panels(fit_spheres(ellipsoid_net(24, 16, 1.0, 1.0, 1.0)))
    upper = select_parts(made, made.origins[:, 2] > 0.0)
    grid = grid_about(panel_faces(upper)[0].points)
    path = folder / "sphere.html"
    write_view(upper, str(path))
    chromium = launch()
    page = opened(chromium, path, [])
    page.wait_for_timeout(400)
    page.evaluate(OPEN_SKY)
    print(f"{upper.n_panels} panels of one sphere:")
    for zoom in ZOOMS:
        apart = page_against_sphere(page, zoom, -grid.center / grid.size, 1 / grid.size)
        print(
            f"  zoom {zoom}: {len(apart)} pixels, off by {apart.mean():.2%} in the mean, "
            f"{np.quantile(apart, 0.999):.2%} for all but one in a thousand, {apart.max():.2%}"
        )
    chromium.close()


def page_against_sphere(page: Page, zoom: int, center: np.ndarray, radius: float) -> np.ndarray:
    """How far green is off the closed form, in pixels whose stripes are wider than they."""
    sun, low, high = page.evaluate(
        """(zoom) => { const { view: v, head } = window.spheremesh; v.camera.zoom = zoom;
        v.camera.updateProjectionMatrix(); v.drawNow();
        return [v.uniforms.sun.value.toArray(), head.low[2], head.high[2]]; }""",
        zoom,
    )
    width, height, data = page.evaluate(PICTURE)
    shown = np.frombuffer(base64.b64decode(data), np.uint8).reshape(height, width, 4)[::-1]
    pose = np.array(page.evaluate("window.spheremesh.view.camera.matrixWorld.elements"))
    right, up, back, eye = pose.reshape(4, 4)[:, :3]
    focal = zoom * height / 2 / np.tan(np.radians(12.0))
    x, y = np.meshgrid(np.arange(width) + 0.5 - width / 2, height / 2 - np.arange(height) - 0.5)
    rays = x[..., None] * right + y[..., None] * up - focal * back
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    away = eye - center
    half = rays @ away
    square = half**2 - (away @ away - radius**2)
    along = -half - np.sqrt(np.maximum(square, 0))
    normals = (away + along[..., None] * rays) / radius
    mirrored = rays - 2 * (rays * normals).sum(-1, keepdims=True) * normals
    turn = 14.0 * np.arcsin(np.clip(mirrored @ right, -0.9999, 0.9999))
    spread = np.abs(np.gradient(turn)).sum(axis=0)
    stripe = 0.5 + 0.5 * np.tanh(np.minimum(6.0, 1.2 / np.maximum(spread, 1e-4)) * np.cos(turn))
    # The green of daylight on white, as in shaders.js.
    n = normals[..., 2]
    light = 0.55 * (0.5 + 0.5 * n) + 0.25 * (0.5 - 0.5 * n)
    light += 0.45 * np.maximum(normals @ sun, 0) / sun[2]
    paint = 0.88 * 0.99 + 0.12 * 1.25 * (226 / 255) ** 2.2
    tone = (0.06 + 0.84 * stripe) * (0.55 + 0.45 * light) * paint
    exact = np.clip(tone, 0, 1) ** (1 / 2.2)
    whole = shown[..., 3] == 255
    level = eye[2] + along * rays[..., 2]
    inside = (
        whole & (square > 0) & (spread < 0.3) & (level > low + 0.02) & (level < high - 0.02)
    )
    for axis in (0, 1):
        inside &= np.roll(whole, 2, axis) & np.roll(whole, -2, axis)
    return np.abs(shown[..., 1] / 255 - exact)[inside]


def main() -> None:
    """What is asked for on the command line."""
    from playwright.sync_api import sync_playwright

    program = shutil.which("chromium") or shutil.which("chromium-browser")
    work = highlights if "light" in sys.argv[1:] else sizes
    with sync_playwright() as play, tempfile.TemporaryDirectory() as name:
        work(lambda: play.chromium.launch(executable_path=program, args=FLAGS), Path(name))


if __name__ == "__main__":
    main()
