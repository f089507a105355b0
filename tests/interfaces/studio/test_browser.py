"""The studio in a browser: the system's Chromium, drawing in software."""

import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from spheremesh.nodes import Graph, vase_mesh, write_mesh

SIZE = {"width": 1100, "height": 640}

Page = Any
Studio = Any
Browser = Any


@pytest.fixture(scope="module")
def shared(browser: Browser, studio: Studio) -> Iterator[Page]:
    """One page for all tests; whatever it says or asks for elsewhere is an error."""
    page = browser.new_page(viewport=SIZE)
    page.set_default_timeout(40_000)
    heard: list[str] = []
    page.on("console", lambda m: None if _is_usual(m.text) else heard.append(m.text))
    page.on("pageerror", lambda error: heard.append(str(error)))
    page.on("request", lambda r: None if _is_own(r.url, studio) else heard.append(r.url))
    yield page
    page.close()
    assert heard == []


def _is_usual(text: str) -> bool:
    """What Chromium says itself: of software drawing, and of edits that are refused."""
    return "GPU stall" in text or "the server responded with a status of 4" in text


def _is_own(url: str, studio: Studio) -> bool:
    return url.startswith((f"http://127.0.0.1:{studio.port}/", "data:", "blob:"))


@pytest.fixture
def page(shared: Page, studio: Studio, vase: Graph) -> Page:
    studio.open(vase)
    opened(shared, studio)
    return shared


def opened(page: Page, studio: Studio) -> None:
    page.goto("about:blank")
    page.goto(studio.address)
    page.wait_for_selector("html[data-ready]", state="attached", timeout=30_000)
    count = len(studio.session.document.specification.steps)
    until(page, f"document.querySelectorAll('.step').length === {count}")


def settled(page: Page) -> None:
    """The last result is shown, and nothing runs."""
    until(page, "Boolean(document.querySelector('.tile')?.dataset.digest)")
    until(page, "!window.studio.now().running")


def until(page: Page, expression: str) -> None:
    """Wait for something to be true on the page, whose policy forbids to do so there."""
    soon(lambda: page.evaluate(expression))


def graph(studio: Studio) -> dict[str, Any]:
    return studio.session.document.content()["graph"]


def port(page: Page, step: str, name: str) -> tuple[float, float]:
    box = page.locator(
        f'.react-flow__node[data-id="{step}"] [data-handleid="{name}"]'
    ).bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def drag(page: Page, start: tuple[float, float], end: tuple[float, float]) -> None:
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(start[0] + 8, start[1] + 3)
    page.mouse.move(*end, steps=4)


def soon(check: Any, seconds: float = 40.0) -> None:  # noqa: ANN401
    until = time.monotonic() + seconds
    while not check():
        assert time.monotonic() < until
        time.sleep(0.02)


def test_a_graph_opens_laid_out_with_its_last_result_beside(page: Page, studio: Studio) -> None:
    page.wait_for_selector(".tile[data-target='panels.panels'] .model canvas")
    until(page, "window.studioDrawn > 0")
    assert "50 panels" in page.inner_text(".words")
    assert page.locator(".react-flow__edge").count() == 5
    boxes = [each.bounding_box() for each in page.locator(".step").all()]
    assert len({(round(b["x"]), round(b["y"])) for b in boxes}) == 4
    assert "canvas" not in graph(studio)  # what was only looked at is not changed


def test_a_wire_is_drawn_and_a_wrong_one_refused_with_its_reason(
    page: Page, studio: Studio
) -> None:
    drag(page, port(page, "s:mesh", "result"), port(page, "s:panels", "labels"))
    page.wait_for_selector("#refusal")
    assert "mesh is Mesh; panels · labels takes labels of faces" in page.inner_text("#refusal")
    page.mouse.up()
    assert graph(studio)["steps"]["panels"]["inputs"]["labels"] == {"wire": "few.labels"}
    drag(page, port(page, "s:fit", "result"), port(page, "s:panels", "sphere_mesh"))
    page.mouse.up()
    soon(lambda: graph(studio)["steps"]["panels"]["inputs"]["sphere_mesh"] == {"wire": "fit"})
    drag(page, port(page, "s:few", "labels"), port(page, "s:fit", "mesh"))
    page.wait_for_selector("#refusal")
    assert "that would be a circle" in page.inner_text("#refusal")
    page.mouse.up()


def test_a_slider_runs_what_depends_on_it_and_undo_gives_the_same_bytes(
    page: Page, studio: Studio
) -> None:
    settled(page)
    path = studio.session.document.path
    before = path.read_bytes()
    drawn = page.get_attribute(".tile", "data-digest")
    studio.heard.clear()
    page.focus('[aria-label="moulds, slider"]')
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    soon(lambda: graph(studio)["params"]["moulds"]["value"] == 6)
    until(page, f"document.querySelector('.tile').dataset.digest !== '{drawn}'")
    settled(page)
    assert set(studio.made()) <= {"few", "panels"}
    assert "few" in studio.made()
    # Its five rings have five radii, however many moulds are asked for.
    until(page, "document.querySelector('.words').innerText.includes('5 moulds')")
    page.locator(".canvas").press("Escape")
    while studio.session.document.content()["undo"]:
        rev = studio.session.document.rev
        page.keyboard.press("Control+z")
        soon(lambda rev=rev: studio.session.document.rev > rev)
    studio.session.document.save()
    assert path.read_bytes() == before
    page.keyboard.press("Control+y")
    soon(lambda: graph(studio)["params"]["moulds"]["value"] > 3)


def test_steps_are_searched_by_name_and_by_what_fits_a_wire(page: Page, studio: Studio) -> None:
    page.locator(".react-flow__pane").dblclick(position={"x": 20, "y": 20})
    page.fill("[role=combobox]", "tilt")
    assert page.inner_text("[role=option] >> nth=0").startswith("beam tilt")
    page.keyboard.press("Enter")
    soon(lambda: "beam_tilt" in graph(studio)["steps"])
    page.wait_for_selector(".step[data-step=beam_tilt].unfinished")
    assert "needs its input" in page.inner_text(".step[data-step=beam_tilt] .fault")
    start = port(page, "s:fit", "result")
    box = page.locator(".react-flow__pane").bounding_box()
    drag(page, start, (box["x"] + 12, box["y"] + box["height"] - 12))
    page.mouse.up()
    page.wait_for_selector("[role=dialog]")
    shown = page.locator("[role=option] b").all_inner_texts()
    assert "vertex error" in shown
    assert "torus mesh" not in shown
    page.fill("[role=combobox]", "vertex error")
    page.keyboard.press("Enter")
    soon(lambda: "vertex_error" in graph(studio)["steps"])
    assert graph(studio)["steps"]["vertex_error"]["inputs"] == {"sphere_mesh": {"wire": "fit"}}


def test_steps_are_copied_grouped_and_said_something_of(page: Page, studio: Studio) -> None:
    page.click(".step[data-step=fit] header")
    page.click(".step[data-step=few] header", modifiers=["Shift"])
    until(page, "window.studio.now().selected.length === 2")
    page.keyboard.press("g")
    soon(lambda: graph(studio).get("groups") == {"Group 1": ["fit", "few"]})
    page.wait_for_selector(".grouptitle")
    page.keyboard.press("Control+c")
    page.keyboard.press("Control+v")
    soon(lambda: {"fit_2", "few_2"} <= set(graph(studio)["steps"]))
    steps = graph(studio)["steps"]
    assert steps["few_2"]["inputs"]["sphere_mesh"] == {"wire": "fit_2"}
    assert steps["fit_2"]["inputs"]["mesh"] == {"wire": "mesh"}
    page.click(".step[data-step=mesh] header")
    page.keyboard.press("m")
    page.fill("[role=dialog] textarea", "where it begins")
    page.keyboard.press("Control+Enter")
    soon(lambda: graph(studio).get("comments") == {"mesh": "where it begins"})
    page.wait_for_selector(".step[data-step=mesh] .comment")


def test_keys_do_all_that_the_mouse_does(page: Page, studio: Studio) -> None:
    """A step is added, wired, shown, pinned, moved, renamed and removed; no pointer moves."""
    page.evaluate("document.activeElement.blur()")
    page.keyboard.press("a")
    page.keyboard.type("planarity")
    page.keyboard.press("Enter")
    until(
        page,
        "document.activeElement?.closest('.react-flow__node')?.dataset.id === 's:planarity'",
    )
    page.keyboard.press("c")
    page.keyboard.type("sphere")
    page.keyboard.press("Enter")
    until(page, "document.querySelector('[role=dialog] h2').innerText.includes('from')")
    page.keyboard.type("few")
    page.keyboard.press("Enter")
    wired = {"sphere_mesh": {"wire": "few.sphere_mesh"}}
    soon(lambda: graph(studio)["steps"]["planarity"]["inputs"] == wired)
    page.focus('.react-flow__node[data-id="s:planarity"]')
    page.keyboard.press("Enter")
    page.wait_for_selector(".tile[data-target='planarity.result']")
    page.keyboard.press("p")
    soon(lambda: graph(studio)["canvas"].get("pins") == ["planarity.result"])
    place = graph(studio)["canvas"]["steps"]["planarity"]
    page.keyboard.press("ArrowRight")
    soon(lambda: graph(studio)["canvas"]["steps"]["planarity"] != place)
    page.keyboard.press("F2")
    page.keyboard.type("flatness")
    page.keyboard.press("Enter")
    soon(lambda: "flatness" in graph(studio)["steps"])
    assert graph(studio)["canvas"]["pins"] == ["flatness.result"]
    page.wait_for_selector('.react-flow__node[data-id="s:flatness"]')
    page.focus('.react-flow__node[data-id="s:flatness"]')
    page.keyboard.press("Enter")
    page.keyboard.press("Delete")
    soon(lambda: "flatness" not in graph(studio)["steps"])


def test_a_step_that_fails_says_so_and_an_unknown_node_is_kept(
    page: Page, studio: Studio, vase: Graph
) -> None:
    text = json.loads(vase.to_json())
    text["steps"]["odd"] = {
        "node": "gone_node",
        "version": "7",
        "inputs": {"x": 1.5},
        "note": 1,
    }
    text["steps"]["read"] = {"node": "read_mesh", "version": "1", "inputs": {"path": "no.obj"}}
    path = studio.folder / "odd.json"
    path.write_text(json.dumps(text))
    studio.ask("POST", "/studio/open", {"file": "odd.json"})
    opened(page, studio)
    assert "gone_node is not known here" in page.inner_text(".step[data-step=odd]")
    page.click(".step[data-step=read] header")
    page.wait_for_selector(".step[data-step=read].is-failed")
    assert "no.obj" in page.inner_text(".step[data-step=read] .fault")
    studio.edit({"op": "set", "param": "moulds", "value": 4})
    studio.session.document.save()
    saved = json.loads(path.read_text())["steps"]
    assert saved["odd"] == text["steps"]["odd"]


def test_two_pages_agree_and_a_reload_keeps_everything(
    page: Page, studio: Studio, browser: Browser
) -> None:
    other = browser.new_page(viewport={"width": 420, "height": 300})
    opened(other, studio)
    page.focus('[aria-label="moulds, slider"]')
    page.keyboard.press("ArrowRight")
    until(other, "window.studio.now().doc.graph.params.moulds.value === 4")
    settled(page)
    other.evaluate("document.activeElement.blur()")
    other.keyboard.press("Control+z")
    until(page, "window.studio.now().doc.graph.params.moulds.value === 3")
    other.close()
    page.click(".tile .pin")
    page.click(".step[data-step=fit] .eye")
    page.wait_for_selector(".tile[data-target='fit.result']")
    box = page.locator(".step[data-step=fit] strong").bounding_box()
    drag(page, (box["x"] + 4, box["y"] + 6), (box["x"] + 60, box["y"] + 90))
    page.mouse.up()
    soon(lambda: "fit" in graph(studio).get("canvas", {}).get("steps", {}))
    kept = graph(studio)
    settled(page)
    opened(page, studio)
    assert page.evaluate("window.studio.now().doc.graph") == kept
    page.wait_for_selector(".tile[data-target='panels.panels'] .pin[aria-pressed=true]")


def test_fingers_on_a_phone_wire_slide_and_add(
    browser: Browser, studio: Studio, vase: Graph
) -> None:
    studio.open(vase)
    phone = browser.new_context(
        viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True
    )
    page = phone.new_page()
    page.set_default_timeout(40_000)
    opened(page, studio)
    assert page.evaluate("document.documentElement.scrollWidth") == 390
    top, low = (page.locator(name).bounding_box() for name in (".preview", ".canvas"))
    assert top["y"] < low["y"]
    assert low["height"] > 250
    page.wait_for_selector(".model canvas")
    page.tap("[title^='add a step']")
    page.fill("[role=combobox]", "circularity")
    page.tap("[role=option] >> nth=0")
    soon(lambda: "circularity" in graph(studio)["steps"])
    page.wait_for_selector(".step[data-step=circularity]")
    page.tap(".step[data-step=circularity] .row.in .label")
    page.tap("[role=option] >> nth=0")
    soon(lambda: graph(studio)["steps"]["circularity"]["inputs"] != {})
    page.locator('[aria-label="moulds, slider"]').fill("5")
    soon(lambda: graph(studio)["params"]["moulds"]["value"] == 5)
    phone.close()


def test_a_newcomer_gets_from_a_mesh_to_files(
    page: Page, studio: Studio, tmp_path: Path
) -> None:
    """Nothing is open; a mesh is chosen, a template on it, what is written, and it is there."""
    studio.ask("POST", "/studio/open", {})
    write_mesh(vase_mesh(10, 5), tmp_path / "my vase.obj")
    opened(page, studio)
    page.set_input_files("input[type=file]", tmp_path / "my vase.obj")
    until(page, "document.querySelector('[aria-label^=mesh]').value === 'my vase.obj'")
    page.click(".card >> text=Roof with moulds")
    page.wait_for_selector(".tile[data-target='panels.panels'] .model canvas")
    settled(page)
    assert "50 panels" in page.inner_text(".words")
    assert "to be saved" in page.inner_text(".title small")
    page.click("text=Export >> nth=0")
    for file in ("panels.step", "model.3dm", "view.html"):
        page.click(f"[aria-label='do not write {file}']")
    page.click(".chips >> text=+ picture")
    page.wait_for_selector(".writers >> text=picture.png")
    folder = page.input_value("[aria-label=folder]")
    assert folder.endswith(" files")
    page.click("text=Write files")
    page.wait_for_selector(".outcome.is-done")
    assert page.locator(".outcome li").all_inner_texts() == ["picture.png", "schedule.csv"]
    assert (studio.folder / folder / "picture.png").read_bytes()[1:4] == b"PNG"
    page.keyboard.press("Escape")
    page.click(".step[data-step=picture] .eye")
    until(page, "document.querySelector('img.picture')?.naturalWidth === 1600")


def test_two_outputs_are_swiped_and_flat_panels_beside_spheres(
    page: Page, studio: Studio
) -> None:
    studio.edit({"op": "pin", "outputs": ["panels.panels", "few.sphere_mesh"]})
    page.wait_for_selector(".tile[data-target='few.sphere_mesh'] .model canvas")
    page.click(".tile[data-target='panels.panels'] >> text=Flat | spheres")
    line = page.get_by_role("slider", name="between flat and spheres")
    line.press("ArrowLeft")
    assert line.get_attribute("aria-valuenow") == "48"
    until(page, "window.studioViews.get('panels.panels').swipe === 0.48")
    page.click(".links >> text=Swipe")
    until(page, "Boolean(document.querySelector('.swiped')?.dataset.digest)")
    line = page.get_by_role("slider", name="between panels and few")
    box = page.locator(".swiped .body").bounding_box()
    drag(page, *_along(line.bounding_box(), box))
    page.mouse.up()
    assert line.get_attribute("aria-valuenow") == "25"
    # Both look from one place of the world.
    until(
        page,
        """(() => { const [a, b] = [...window.studioViews.values()].slice(-2).map((v) =>
          v.camera.position.toArray().map((x, k) => v.head.center[k] + v.head.size * x));
        return Math.hypot(...a.map((x, k) => x - b[k])) < 1e-6 * Math.hypot(...a); })()""",
    )
    page.click("text=Side by side")
    page.wait_for_selector(".tile[data-target='few.sphere_mesh']")


def _along(line: dict[str, float], body: dict[str, float]) -> Any:  # noqa: ANN401
    """From the middle of a line to a quarter of what it divides."""
    y = line["y"] + 60
    return (line["x"] + line["width"] / 2, y), (body["x"] + body["width"] / 4, y)


def test_a_graph_of_200_steps_moves_without_long_frames(page: Page, studio: Studio) -> None:
    """What a frame takes of the processor; how long others keep it busy is not ours."""
    big = Graph("Big")
    for chain in range(20):
        step = big.add("vase_mesh", f"mesh_{chain}", n_around=8, n_across=4)
        step = big.add("fit_spheres", f"fit_{chain}", mesh=step)
        for k in range(8):
            step = big.add(
                "cluster_radii", f"few_{chain}_{k}", sphere_mesh=step, k=3
            ).sphere_mesh
    studio.open(big)
    opened(page, studio)
    until(page, "document.querySelector('.canvas').dataset.nodes === '200'")
    settled(page)
    until(page, "window.studioDrawn > 0")
    client = page.context.new_cdp_session(page)
    client.send("Performance.enable", {"timeDomain": "threadTicks"})
    page.evaluate(
        "(() => { window.frames_ = 0; "
        "const next = () => { window.frames_++; requestAnimationFrame(next); }; next(); })()"
    )
    box = page.locator(".react-flow__pane").bounding_box()
    left, top = box["x"], box["y"]
    edge = left + box["width"] - 8, top + 90
    costs: dict[str, list[float]] = {}
    for where in ("far", "near"):
        cost = _costs(page, client, costs, where)
        page.mouse.move(left + 5, top + 5)
        if where == "near":
            page.mouse.wheel(0, -1500)
            until(page, "!document.querySelector('.canvas').classList.contains('far')")
        page.mouse.down()
        cost("scrolls", [(left + 5 + 9 * k, top + 5 + 4 * k) for k in range(8)])
        page.mouse.up()
        x, y = page.evaluate(
            """() => { const all = [...document.querySelectorAll('.step > header')];
            const at = all.map((e) => e.getBoundingClientRect()).map((r) => [r.x + 4, r.y + 4]);
            return at.sort((a, b) => Math.hypot(a[0] - 200, a[1] - 320)
              - Math.hypot(b[0] - 200, b[1] - 320))[0]; }"""
        )
        page.mouse.move(x, y)
        page.mouse.down()
        cost("drags", [(x + 5 * (k % 6), y + 3 * k) for k in range(1, 9)])
        # There the canvas moves as well, in every frame.
        before = page.get_attribute(".react-flow__viewport", "style")
        cost("drags at the edge", [(edge[0] + k % 3, edge[1]) for k in range(8)], many=True)
        assert page.get_attribute(".react-flow__viewport", "style") != before
        page.mouse.up()
    assert max(max(each) for each in costs.values()) < 100, costs


def _costs(page: Page, client: Any, costs: dict[str, list[float]], where: str) -> Any:  # noqa: ANN401
    """Notes milliseconds of the processor that a frame takes, for each move of the mouse."""

    def busy() -> tuple[float, int]:
        found = client.send("Performance.getMetrics")["metrics"]
        seconds = next(m["value"] for m in found if m["name"] == "TaskDuration")
        return 1000 * seconds, page.evaluate("window.frames_")

    def cost(what: str, places: list[tuple[float, float]], *, many: bool = False) -> None:
        for x, y in places:
            before, frames = busy()
            page.mouse.move(x, y)
            page.evaluate("new Promise(requestAnimationFrame)")
            after, drawn = busy()
            count = max(1, drawn - frames) if many else 1
            costs.setdefault(f"{what}, {where}", []).append(round((after - before) / count))

    return cost
