"""The page in a browser: the system's Chromium, drawing in software."""

import base64
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from spheremesh.fabrication.schedules.columns import beam_columns, panel_columns
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.parts.colors import mould_color
from spheremesh.kernel.parts.findings import Finding
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.fit import fit_spheres
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net, roof_net, vase_net
from spheremesh.nodes import beams as cut_beams
from spheremesh.nodes import bisector_support
from spheremesh.viewer.camera import SAMPLES, stand_at
from spheremesh.viewer.colors import panel_colors
from spheremesh.viewer.exposure import expose
from spheremesh.viewer.page.document import PageTexts, page_text
from spheremesh.viewer.page.faces import panel_faces
from spheremesh.viewer.page.grid import grid_about
from spheremesh.viewer.scene import gather
from spheremesh.viewer.shading import Shading
from spheremesh.viewer.shapes import panel_shape

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = [
    "--enable-unsafe-swiftshader",
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
]
SIZE = {"width": 780, "height": 300}
MISSING = 17
MISSING_BEAM = 10

Page = Any
Browser = Any


def write_page(folder: Path) -> Path:
    """A vase with beams, three moulds, a missing panel and findings, under a wicked title."""
    net = vase_net(12, 6, 1.0, 2.0, 0.3)
    spheres = fit_spheres(net)
    whole, _ = cut_panels(spheres, thickness=0.02, labels=np.arange(72) % 3, joint_gap=0.01)
    made = select_parts(whole, np.arange(72) != MISSING)
    carried = cut_beams(
        bisector_support(spheres, depth=0.1).annuli, thickness=0.02, node_radius=0.05
    ).beams
    carried = select_parts(carried, np.arange(carried.n_beams) != MISSING_BEAM)
    found = [
        Finding("P201", "P0000", "a step of 9 mm </script>"),
        Finding("P201", "P0002", "a step of 11 mm, more than 5: thinner", 11.0),
        Finding("P102", "P0001", "a corner of 12 degrees", severity="note"),
        Finding("B101", "B0010", "cannot be made: its ends cross"),
    ]
    columns = panel_columns(made, "m"), beam_columns(carried, made, "m")
    about = PageTexts('</script><b>"Dächer"', *columns, found)
    path = folder / "view.html"
    path.write_text(page_text(made, carried, about, net), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is missing")
    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    if program is None:
        pytest.skip("there is no Chromium: install the package chromium")
    with playwright.sync_playwright() as play:
        opened = play.chromium.launch(executable_path=program, args=FLAGS)
        yield opened
        opened.close()


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> str:
    return write_page(tmp_path_factory.mktemp("page")).as_uri()


@pytest.fixture(scope="module")
def shared(browser: Browser, address: str) -> Iterator[Page]:
    """One page for all tests; whatever it says or asks for is an error."""
    page = browser.new_page(viewport=SIZE)
    heard: list[str] = []
    # What software drawing remarks on its own speed is not said by the page.
    page.on("console", lambda m: None if "GPU stall" in m.text else heard.append(m.text))
    page.on("pageerror", lambda error: heard.append(str(error)))
    page.on("request", lambda request: heard.append(request.url))
    page.goto(address)
    page.wait_for_selector("html[data-ready]", state="attached", timeout=30_000)
    yield page
    page.close()
    assert heard == [address]


@pytest.fixture
def page(shared: Page) -> Page:
    shared.evaluate(
        """() => { const p = window.spheremesh;
        p.filter = null; p.select(-1); p.showTable(false);
        p.set({color: 'mould', shading: 0, flat: 'off', axis: '', depth: 0.5, explode: 0,
               hidden: new Set(['axes'])}); p.setMeasuring(false); p.view.fit(p.home); }"""
    )
    return shared


def picture(page: Page) -> np.ndarray:
    """Pixels of the canvas as it is drawn now, (height, width, 4)."""
    size = page.evaluate(
        """() => { const v = window.spheremesh.view, g = v.renderer.getContext();
        v.drawNow();
        const w = g.drawingBufferWidth, h = g.drawingBufferHeight;
        const a = new Uint8Array(4 * w * h);
        g.readPixels(0, 0, w, h, g.RGBA, g.UNSIGNED_BYTE, a);
        let s = ''; for (let i = 0; i < a.length; i += 8192)
          s += String.fromCharCode(...a.subarray(i, i + 8192));
        return [w, h, btoa(s)]; }"""
    )

    width, height, data = size
    return np.frombuffer(base64.b64decode(data), np.uint8).reshape(height, width, 4)[::-1]


def selected(page: Page) -> str:
    return page.inner_text("#card h2")


def test_title_and_summary_are_shown_as_text(page: Page) -> None:
    assert page.inner_text("h1") == '</script><b>"Dächer"'
    assert page.inner_text("#title p") == (
        "72 panels: 1 missing, 2 with errors; 156 beams: 1 missing; 3 moulds"
    )


def test_picking_finds_the_part_that_is_seen(page: Page) -> None:
    """Middles of panels, in front and seen at a slant, without the beams around them."""
    page.evaluate("window.spheremesh.set({hidden: new Set(['beams', 'nodes'])})")
    places = page.evaluate(
        """() => { const v = window.spheremesh.view; return v.shapes.centers.slice(0, 71).map(
        (c, i) => [i, v.project(c), v.camera.position.toArray().reduce((s, e, k) =>
          s + v.shapes.lifts[i][k] * (e - c[k]), 0)]); }"""
    )
    ids = page.evaluate("window.spheremesh.model.ids")
    facing = [(i, at) for i, at, side in places if side > 0.15]
    assert len(facing) > 15
    for part, (x, y) in facing[::3] + facing[-2:]:
        assert page.evaluate(f"window.spheremesh.view.pick({x}, {y})") == part
    under = "([x, y]) => document.elementFromPoint(x, y).id === 'canvas'"
    for part, (x, y) in [each for each in facing if page.evaluate(under, each[1])][:3]:
        page.mouse.click(x, y)
        assert selected(page) == ids[part]
    page.mouse.click(8, 150)
    assert not page.is_visible("#card")


def test_fifty_random_parts_are_picked_right(page: Page) -> None:
    """Against rays of ours: the nearest triangle of any part that a pixel's ray meets."""
    page.evaluate("window.spheremesh.view.fit([0.4, -1, 0.6])")
    rng = np.random.default_rng(7)
    places = rng.uniform((150, 60), (SIZE["width"] - 380, SIZE["height"] - 60), (400, 2))
    answers: list[tuple[int, int]] = page.evaluate(
        """(places) => { const v = window.spheremesh.view, cross = (a, b) => [
          a[1]*b[2]-a[2]*b[1], a[2]*b[0]-a[0]*b[2], a[0]*b[1]-a[1]*b[0]],
          dot = (a, b) => a[0]*b[0]+a[1]*b[1]+a[2]*b[2],
          sub = (a, b) => a.map((x, k) => x-b[k]);
        const rows = v.shapes.surfaces.rows, eye = v.camera.position.toArray(), found = [];
        const soups = [v.shapes.panels, v.shapes.walls, v.shapes.beams, v.shapes.nodes];
        const nearest = (ray) => { let best = Infinity, second = Infinity, part = -1;
          for (const soup of soups) for (let t = 0; t < soup.corners; t += 3) {
            const [a, b, c] = [0, 1, 2].map((k) => soup.point(soup.ids[t + k]));
            const e = sub(b, a), f = sub(c, a), p = cross(ray, f), d = dot(e, p);
            if (Math.abs(d) < 1e-14) continue;
            const s = sub(eye, a), u = dot(s, p) / d, q = cross(s, e), w = dot(ray, q) / d;
            const z = dot(f, q) / d;
            if (u < 0 || w < 0 || u + w > 1 || z <= 0) continue;
            const own = rows[12 * soup.owners[soup.ids[t]] + 7];
            if (z < best) { if (own !== part) second = best; best = z; part = own; }
            else if (own !== part) second = Math.min(second, z);
          } return [part, second - best]; };
        for (const [x, y] of places) {
          const ray = v.ray(Math.floor(x) + 0.5, Math.floor(y) + 0.5);
          const [part, apart] = nearest(ray);
          if (part < 0 || apart < 1e-4) continue;
          found.push([v.pick(x, y), part]);
          if (found.length === 50) break;
        } return found; }""",
        places.tolist(),
    )
    assert len(answers) == 50
    assert len({part for _, part in answers}) > 15
    assert [picked for picked, _ in answers] == [part for _, part in answers]


@pytest.mark.parametrize(("light", "shading"), [(0, "studio"), (1, "zebra")])
def test_shading_agrees_with_pictures(
    browser: Browser, tmp_path: Path, light: int, shading: Shading
) -> None:
    """100 random pixels of a dome, on which no shadow falls, by the same camera: 2 %."""
    spheres = fit_spheres(ellipsoid_net(24, 12, 2.0, 2.0, 0.9))
    made, _ = cut_panels(spheres)
    upper = select_parts(made, made.origins[:, 2] > 0.1)
    path = tmp_path / "view.html"
    about = PageTexts("dome", panel_columns(upper, "m"), beam_columns(None, None, "m"))
    path.write_text(page_text(upper, None, about), encoding="utf-8")
    page = browser.new_page(viewport={"width": 900, "height": 500})
    page.goto(path.as_uri())
    page.wait_for_selector("html[data-ready]", state="attached", timeout=30_000)
    page.wait_for_timeout(400)
    page.evaluate(f"window.spheremesh.set({{color: 'none', shading: {light}}})")
    page.evaluate("window.spheremesh.set({hidden: new Set(['edges'])})")
    page.evaluate("window.spheremesh.view.fit([0.2, -1, 0.22])")
    shown = picture(page)
    eye, target = np.array(
        page.evaluate(
            """(v => [v.camera.position.toArray(), v.controls.target.toArray()])
            (window.spheremesh.view)"""
        )
    )
    height, width, _ = shown.shape
    page.close()
    # The page has its own unit and an upright field of view; pictures one across.
    corners = panel_faces(upper)[0].points
    grid = grid_about(corners)
    camera = stand_at(eye * grid.size, target * grid.size, SAMPLES * width, SAMPLES * height)
    focal = SAMPLES * height / 2 / np.tan(np.radians(12.0))
    camera = replace(camera, focal=float(focal), eye=camera.eye + grid.center)
    colors, _ = panel_colors(upper, "none")
    scene = gather([panel_shape(upper, colors, edges=False)])
    own = replace(camera, eye=camera.eye - scene.origin)
    exact = np.asarray(expose(scene, own, shading, ground=False)).astype(float)
    inside = shown[..., 3] == 255
    # Away from outlines, where the page draws nothing behind.
    inside &= np.roll(inside, 2, 0) & np.roll(inside, -2, 0)
    inside &= np.roll(inside, 2, 1) & np.roll(inside, -2, 1)
    # Nor where two panels share a pixel: there the picture with edges has a line.
    edged = gather([panel_shape(upper, colors)])
    lines = np.asarray(expose(edged, own, shading, ground=False)).astype(float)
    inside &= (lines == exact).all(axis=2)
    # Nor near the outline, where stripes are finer than pixels.
    seen = np.flatnonzero(inside.any(axis=0))
    inside[:, : seen[0] + len(seen) // 8] = inside[:, seen[-1] - len(seen) // 8 :] = False
    rows, columns = np.nonzero(inside)
    chosen = np.random.default_rng(5).choice(len(rows), 100, replace=False)
    apart = np.abs(exact - shown[..., :3])[rows[chosen], columns[chosen]] / 255
    assert apart.max() < 0.02


def test_fingers_pick_and_turn(browser: Browser, address: str) -> None:
    context = browser.new_context(
        viewport={"width": 390, "height": 700}, has_touch=True, is_mobile=True
    )
    page = context.new_page()
    page.goto(address)
    page.wait_for_selector("html[data-ready]", state="attached", timeout=30_000)
    x, y = page.evaluate(
        """() => { const v = window.spheremesh.view, b = v.canvas.getBoundingClientRect();
        v.show(false); const w = b.width / 2;
        for (let y = 120; y < b.height - 100; y += 3) if (v.pick(w, y) >= 0)
          return [b.left + w, b.top + y + 4]; }"""
    )
    page.touchscreen.tap(x, y)
    assert page.is_visible("#card")
    eye = "window.spheremesh.view.camera.position.toArray()"
    before = page.evaluate(eye)
    session = context.new_cdp_session(page)
    for kind, shift in (("touchStart", 0), ("touchMove", 30), ("touchMove", 60)):
        points = [{"x": x + shift, "y": y}]
        session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    assert page.evaluate(eye) != before
    assert page.is_visible("#card")
    context.close()


def test_distances_are_those_of_corners_and_points(page: Page) -> None:
    page.evaluate("window.spheremesh.set({hidden: new Set(['beams', 'nodes', 'axes'])})")
    page.click("#measuring button")
    ends = page.evaluate(
        """() => { const p = window.spheremesh, v = p.view;
        const front = v.shapes.corners.map((c, i) => [i, v.project(v.shapes.centers[i])])
          .filter(([i, [x, y]]) => v.pick(x, y) === i)[3];
        const corners = v.shapes.corners[front[0]], [x, y] = front[1];
        const inwards = (c) => v.project(c).map((u, k) => u + 0.35 * ([x, y][k] - u));
        p.tap(...inwards(corners[0])); p.tap(...inwards(corners[1]));
        return [corners[0], corners[1], p.measure.distance]; }"""
    )
    length = page.evaluate("window.spheremesh.head.size_mm") * np.linalg.norm(
        np.subtract(ends[0], ends[1])
    )
    assert ends[2] == pytest.approx(length, rel=1e-6)
    assert "mm" in page.text_content("#measure text")
    assert page.inner_text("#hint").startswith("From corner ")
    far = page.evaluate(
        """() => { const p = window.spheremesh, v = p.view;
        const [i, [x, y]] = v.shapes.corners.map((c, i) => [i, v.project(v.shapes.centers[i])])
          .filter(([i, [x, y]]) => v.pick(x, y) === i)[3];
        const kept = v.shapes.corners[i]; v.shapes.corners[i] = [];
        p.tap(x, y); v.shapes.corners[i] = kept;
        const r = [...v.shapes.surfaces.rows], own = [];
        for (let s = 0; s < v.shapes.surfaces.length; s++) if (r[12 * s + 7] === i) own.push(s);
        const q = p.measure.points[0], k = 12 * own[0];
        const d = q.map((u, j) => u - r[k + 4 + j]);
        return r[k + 3] * (d[0]**2 + d[1]**2 + d[2]**2)
          - (r[k] * d[0] + r[k + 1] * d[1] + r[k + 2] * d[2]); }"""
    )
    # On the sphere of the panel, but for its triangles.
    assert abs(far) < 1e-3
    page.keyboard.press("Escape")
    assert page.evaluate("window.spheremesh.measure.points.length") == 0


def test_beams_and_nodes_are_picked_where_panels_are_hidden(page: Page) -> None:
    page.evaluate("window.spheremesh.set({hidden: new Set(['panels'])})")
    found = page.evaluate(
        """() => { const p = window.spheremesh, v = p.view, n = 71 + 155; let right = 0;
        for (let i = 71; i < n; i += 4) { const [x, y] = v.project(v.shapes.centers[i]);
          if (v.pick(x, y) === i) right++; } return right; }"""
    )
    assert found > 8
    page.evaluate("window.spheremesh.select(80)")
    assert page.inner_text("#card").count("Nodes")


def test_every_colour_says_something_else_of_the_panels(page: Page) -> None:
    """What is measured runs along the scale from its least to its largest value."""
    seen = {}
    for mode in page.evaluate("window.spheremesh.modes.map(m => m.key)"):
        page.select_option("#color", mode)
        colors = page.evaluate("[...window.spheremesh.view.colorData.slice(0, 4 * 71)]")
        seen[mode] = np.array(colors).reshape(71, 4)[:, :3]
        values = page.evaluate("window.spheremesh.mode.values ?? []")
        if len(set(values)) > 1:
            known = np.array(values, float)
            assert tuple(seen[mode][np.nanargmin(known)].tolist()) == mould_color(0, 2), mode
            assert tuple(seen[mode][np.nanargmax(known)].tolist()) == mould_color(1, 2), mode
    assert list(seen) == [
        "mould", "radius", "angle", "tilt", "area", "planarity", "finding", "none",
    ]  # fmt: skip
    assert len({colors.tobytes() for colors in seen.values()}) == len(seen)


def test_every_light_draws_another_picture(page: Page) -> None:
    seen = set()
    for light in range(3):
        page.evaluate(f"window.spheremesh.set({{color: 'none', shading: {light}}})")
        seen.add(picture(page).tobytes())
    assert len(seen) == 3


def test_what_is_wrong_stands_on_the_page(page: Page) -> None:
    """Which parts are bad, and why, by kind: the gravest first, then the most frequent."""
    rows = page.evaluate(
        "[...document.querySelectorAll('#faults li')].map("
        "line => line.innerText.replace(/\\s+/g, ' '))"
    )
    assert rows == [
        "cannot be made: 1 panel P0017 (P100)",
        "its ends cross: 1 beam B0010 (B101)",
        "a step </script>: 1 panel P0000: 9 mm (P201)",
        "a step: 1 panel P0002: 11 mm, more than 5. thinner (P201)",
        "a corner: 1 panel P0001: 12 degrees (P102)",
    ]
    page.click("#faults [data-part='1']")
    assert selected(page) == "P0001"
    assert "a corner of 12 degrees (P102)" in page.inner_text("#card .findings")
    page.click("#faults .row:has-text('a corner')")
    assert page.evaluate("window.spheremesh.left()") == [1]
    assert page.locator("#faults .names button").count() == 1
    page.click("#faults .row:has-text('a corner')")
    assert page.evaluate("window.spheremesh.filter") is None
    page.click("#title button[data-worst=error]")
    assert page.evaluate("window.spheremesh.state.color") == "finding"
    assert page.evaluate("window.spheremesh.left()") == [0, 2]


def test_missing_parts_are_shown_where_they_would_be(page: Page) -> None:
    """By a click on how many are missing, by search, and from the cards beside."""
    calm = picture(page)
    page.click("#title button[data-worst=rejected]")
    assert selected(page) == "P0017"
    assert "cannot be made" in page.inner_text("#card .findings")
    beside = page.inner_text("#card dl div").split()[1:]
    assert len(beside) == 3
    at = page.evaluate(
        "(({view: v, model: m}) => v.project(v.shapes.centers[m.made]))(window.spheremesh)"
    )
    assert abs(at[0] - calm.shape[1] / 2) < 40
    assert abs(at[1] - calm.shape[0] / 2) < 60
    page.evaluate("window.spheremesh.set({}, true)")
    ghost = picture(page)
    page.evaluate("window.spheremesh.view.ghosts.missing.material.visible = false")
    assert (ghost != picture(page)).any(axis=2).mean() > 0.02
    page.evaluate("window.spheremesh.view.ghosts.missing.material.visible = true")
    page.click(f"#card [data-part]:has-text('{beside[0]}')")
    assert selected(page) == beside[0]
    assert "P0017 (missing)" in page.inner_text("#card .edges")
    for name in ("b10", "P0017"):
        page.fill("#search input", name)
        page.press("#search input", "Enter")
        assert page.inner_text("#card .badge") == "missing"
        page.evaluate("window.spheremesh.view.drawNow()")
        assert page.evaluate("window.spheremesh.view.ghosts.missing.visible")
    page.fill("#search input", "B9999")
    page.press("#search input", "Enter")
    assert page.inner_text("#unknown") == "No part B9999"
    assert not page.is_visible("#card")
    page.evaluate("window.spheremesh.set({color: 'mould'})")
    page.evaluate("window.spheremesh.view.fit(window.spheremesh.home)")
    assert (picture(page) == calm).all()


def test_a_card_names_mould_and_neighbours_and_leads_there(page: Page) -> None:
    page.evaluate("window.spheremesh.select(30)")
    rows = dict(
        page.evaluate(
            "[...document.querySelectorAll('#card dl div')].map(d => [...d.children].map("
            "c => c.textContent))"
        )
    )
    mould, around = page.evaluate(
        "(({panels: p, ids}) => [p.mould[30], p.neighbors[30].map(j => ids[j])])"
        "(window.spheremesh.model)"
    )
    assert rows["Mould"] == str(mould)
    assert sorted(rows["Neighbours"].split()) == sorted(around)
    page.click(f"#card dl [data-part]:has-text('{around[0]}')")
    assert selected(page) == around[0]
    page.click("#card .mould")
    assert page.evaluate("window.spheremesh.left().length") == 24


def test_findings_are_red_and_amber(page: Page) -> None:
    page.select_option("#color", "finding")
    assert page.inner_text("#scale .kind[data-kind=error] em") == "2"
    assert page.inner_text("#scale .kind[data-kind=note] em") == "1"
    colors = page.evaluate("[...window.spheremesh.view.colorData.slice(0, 12)]")
    assert colors[:3] == [206, 58, 44]
    assert colors[4:7] == [232, 164, 38]
    page.evaluate("window.spheremesh.select(0)")
    assert "a step of 9 mm </script>" in page.inner_text("#card .findings")


def test_legend_filters_moulds_and_ranges(page: Page) -> None:
    page.click("#scale .kind[data-kind='2']")
    assert page.evaluate("window.spheremesh.left().length") == 24
    page.click("#all")
    assert page.evaluate("window.spheremesh.left().length") == 72 + 156 + 84
    page.select_option("#color", "area")
    box = page.locator("#scale svg").bounding_box()
    page.mouse.move(box["x"] + 5, box["y"] + 20)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 20)
    page.mouse.up()
    left = page.evaluate("window.spheremesh.left()")
    areas = np.array(page.evaluate("window.spheremesh.model.panels.area_m2"))
    assert 0 < len(left) < 71
    assert areas[left].max() <= areas[np.setdiff1d(np.arange(71), left)].min()


def test_search_takes_names_as_people_type_them(page: Page) -> None:
    for text, name in (("P0030", "P0030"), ("p30", "P0030"), ("30", "P0030"), ("b7", "B0007")):
        page.fill("#search input", text)
        page.press("#search input", "Enter")
        assert selected(page) == name
    page.fill("#search input", "P9999")
    page.press("#search input", "Enter")
    assert "unknown" in page.get_attribute("#search input", "class")


def test_what_is_found_is_turned_to_the_viewer(page: Page) -> None:
    """Also from within a saddle: in the middle, large, with nothing before it."""
    for part in (5, 29, 50, 70):
        page.evaluate(f"window.spheremesh.choose({part})")
        at = page.evaluate(
            f"window.spheremesh.view.project(window.spheremesh.view.shapes.centers[{part}])"
        )
        assert page.evaluate(f"window.spheremesh.view.pick({at[0]}, {at[1]})") == part
        width, height, reach = page.evaluate(
            f"""() => {{ const v = window.spheremesh.view, b = v.canvas.parentElement;
            const at = v.shapes.corners[{part}].map((c) => v.project(c)[1]);
            return [b.clientWidth, b.clientHeight, Math.max(...at) - Math.min(...at)]; }}"""
        )
        assert abs(at[0] - width / 2) < width / 10
        assert abs(at[1] - height / 2) < height / 5
        assert reach > height / 10


def test_keys_step_through_panels_and_turn_the_model(page: Page) -> None:
    page.focus("#canvas")
    page.keyboard.press("]")
    assert selected(page) == "P0000"
    page.keyboard.press("]")
    page.keyboard.press("]")
    page.keyboard.press("[")
    assert selected(page) == "P0001"
    assert "Mould 2" in page.inner_text("#spoken")
    eye = page.evaluate("window.spheremesh.view.camera.position.toArray()")
    page.keyboard.press("ArrowLeft")
    assert page.evaluate("window.spheremesh.view.camera.position.toArray()") != eye
    page.keyboard.press("Escape")
    assert not page.is_visible("#card")
    for key, there in (("t", "#table"), ("m", "[data-value=on][aria-pressed=true]")):
        assert not page.is_visible(there)
        page.keyboard.press(key)
        assert page.is_visible(there)
        page.keyboard.press(key)
    page.keyboard.press("f")
    assert page.evaluate("window.spheremesh.view.fitted") == page.evaluate(
        "window.spheremesh.home"
    )
    page.keyboard.press("/")
    assert page.evaluate("document.activeElement.type") == "search"


def test_sections_hide_what_is_beyond_them(page: Page) -> None:
    middle = "...window.spheremesh.view.project(window.spheremesh.view.shapes.centers[40])"
    page.evaluate("window.spheremesh.choose(40)")
    assert page.evaluate(f"window.spheremesh.view.pick({middle})") == 40
    # From the side of the viewer all is cut away.
    page.evaluate("window.spheremesh.set({axis: 'y', depth: 1})")
    assert page.evaluate(f"window.spheremesh.view.pick({middle})") == -1
    # But what is asked for by its name is shown.
    page.evaluate("window.spheremesh.set({hidden: new Set(['panels'])})")
    page.evaluate("window.spheremesh.choose(40)")
    assert page.evaluate(f"window.spheremesh.view.pick({middle})") == 40


def test_parts_drawn_apart_are_picked_where_they_are(page: Page) -> None:
    page.evaluate("window.spheremesh.set({explode: 0.8, hidden: new Set(['beams', 'nodes'])})")
    found = page.evaluate(
        """() => { const v = window.spheremesh.view; let right = 0, asked = 0;
        for (let i = 0; i < 71; i += 5) { const c = v.shapes.centers[i], n = v.shapes.lifts[i];
          const e = v.camera.position.toArray(), at = c.map((x, k) => 1.32 * x + 0.056 * n[k]);
          if (n.reduce((s, x, k) => s + x * (e[k] - at[k]), 0) < 0.5) continue;
          asked++; if (v.pick(...v.project(at)) === i) right++; } return [right, asked]; }"""
    )
    assert found[0] == found[1] > 2


def test_a_picture_is_saved(page: Page) -> None:
    with page.expect_download() as saved:
        page.click("#sharing [data-value=save]")
    assert saved.value.suggested_filename == "script-b-Dächer.png"
    assert saved.value.path().read_bytes()[:4] == b"\x89PNG"


@pytest.mark.long
def test_walls_of_many_panels_come_with_a_section(browser: Browser, tmp_path: Path) -> None:
    made, _ = cut_panels(fit_spheres(roof_net(40, 60, 60.0)), thickness=0.1)
    path = tmp_path / "view.html"
    about = PageTexts("roof", panel_columns(made, "m"), beam_columns(None, None, "m"))
    path.write_text(page_text(made, None, about), encoding="utf-8")
    page = browser.new_page(viewport=SIZE)
    page.goto(path.as_uri())
    page.wait_for_selector("html[data-ready]", state="attached", timeout=60_000)
    assert page.evaluate("window.spheremesh.shapes.walls.size") == 0
    page.evaluate("window.spheremesh.set({axis: 'y', depth: 0.5})")
    cut = picture(page)
    assert page.evaluate("window.spheremesh.shapes.walls.size") > 4 * 2000
    page.evaluate("window.spheremesh.view.meshes.walls.material.visible = false")
    assert (picture(page) != cut).any(axis=2).sum() > 20
    page.close()


def test_flat_panels_break_the_reflections_that_spheres_carry(page: Page) -> None:
    page.evaluate("window.spheremesh.set({shading: 1, color: 'none'})")
    spheres = picture(page)
    page.click("#flat [data-value=on]")
    flat = picture(page)
    page.click("#flat [data-value=swipe]")
    both = picture(page)
    middle = both.shape[1] // 2
    assert (spheres != flat).any(axis=2).mean() > 0.02
    np.testing.assert_array_equal(both[:, : middle - 2], flat[:, : middle - 2])
    np.testing.assert_array_equal(both[:, middle + 2 :], spheres[:, middle + 2 :])


def test_table_is_sorted_and_in_step_with_the_picture(page: Page) -> None:
    page.click("#listing")
    assert page.locator("#table tbody tr").count() == 200
    page.click("#table [data-sort='3']")
    areas = page.evaluate(
        "[...document.querySelectorAll('#table tbody tr')].map(r => Number(r.dataset.part))"
    )[:71]
    values = np.array(page.evaluate("window.spheremesh.model.panels.area_m2"))[areas]
    assert (np.diff(values) >= 0).all()
    page.click("#table tbody tr[data-part='30']")
    assert selected(page) == page.evaluate("window.spheremesh.model.ids[30]")
    assert page.get_attribute("#table tr[data-part='30']", "aria-selected") == "true"


def test_an_address_shows_what_its_sender_saw(browser: Browser, address: str) -> None:
    page = browser.new_page(viewport={"width": 390, "height": 700})
    page.goto(
        f"{address}#color=radius&light=zebra&panels=swipe&cut=z+0.25&part=P0030&hide=beams"
    )
    page.wait_for_selector("html[data-ready]", state="attached", timeout=30_000)
    state = page.evaluate("(s => ({...s, hidden: [...s.hidden]}))(window.spheremesh.state)")
    assert (state["color"], state["shading"], state["flat"]) == ("radius", 1, "swipe")
    assert (state["axis"], state["depth"], sorted(state["hidden"])) == (
        "z", 0.25, ["axes", "beams"],
    )  # fmt: skip
    assert selected(page) == "P0030"
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.close()


def test_without_webgl_there_is_a_picture_and_the_table(browser: Browser, address: str) -> None:
    page = browser.new_page(viewport=SIZE)
    page.add_init_script(
        """const get = HTMLCanvasElement.prototype.getContext;
        HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
          return kind.startsWith('webgl') ? null : get.call(this, kind, ...rest); };"""
    )
    page.goto(address)
    page.wait_for_selector("html[data-ready]", state="attached", timeout=30_000)
    assert "no WebGL" in page.inner_text("#message")
    assert page.locator("#table tbody tr").count() == 200
    painted = page.evaluate(
        """() => { const c = document.getElementById('canvas'), d = c.getContext('2d')
        .getImageData(0, 0, c.width, c.height).data; let n = 0;
        for (let i = 3; i < d.length; i += 4) n += d[i] > 0; return n / (d.length / 4); }"""
    )
    assert painted > 0.05
    page.close()
