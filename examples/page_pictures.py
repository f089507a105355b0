"""The pictures of page, report and studio in the docs: in Chromium, drawn in software.

python examples/page_pictures.py docs/images
"""

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from PIL import Image

from spheremesh.nodes import (
    cluster_radii,
    fit_spheres,
    minimize_angles,
    panel_report,
    panels,
    roof_mesh,
    write_report,
    write_view,
)

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
FLAGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
]
STATES = {
    "page": "{color: 'mould', shading: 0, flat: 'off'}",
    "page-swipe": "{color: 'none', shading: 1, flat: 'swipe'}",
}
"""What the page shows in each picture."""

TEMPLATES = {"studio": "Roof with moulds", "studio-beams": "Roof with beams"}
"""What the studio begins with in each picture."""

PATIENCE = 120_000
"""Milliseconds to wait for a page."""

Chromium = Any


def pages(chromium: Chromium, folder: Path, place: Path) -> None:
    """The roof on its page, and the report of it."""
    smooth = minimize_angles(fit_spheres(roof_mesh()))
    moulds = cluster_radii(smooth.sphere_mesh, 8)
    made = panels(moulds.sphere_mesh, labels=moulds.labels, thickness=0.05)
    page = chromium.new_page(viewport={"width": 1180, "height": 720})
    path = write_view(made.panels, str(place / "view.html"), title="Roof")
    page.goto(Path(path).as_uri())
    page.wait_for_selector("html[data-ready]", state="attached", timeout=PATIENCE)
    for name, state in STATES.items():
        page.evaluate(f"window.spheremesh.set({state})")
        page.wait_for_timeout(4000)
        _take(page, folder / f"{name}.png")
    report = panel_report(moulds.sphere_mesh, smooth.report, made.report, moulds.report)
    path = write_report(
        report, made.panels, moulds.sphere_mesh, str(place / "report.html"), "Roof"
    )
    page = chromium.new_page(viewport={"width": 900, "height": 980})
    page.goto(Path(path).as_uri())
    _take(page, folder / "report.png")


def studios(chromium: Chromium, folder: Path, place: Path) -> None:
    """Templates in the studio, with what they make."""
    for name, template in TEMPLATES.items():
        with _studio(place) as address:
            page = chromium.new_page(viewport={"width": 1440, "height": 860})
            page.goto(address)
            page.wait_for_selector("html[data-ready]", state="attached", timeout=PATIENCE)
            page.click(f".card:has-text('{template}')", timeout=PATIENCE)
            page.wait_for_selector(".tile canvas", timeout=PATIENCE)
            page.wait_for_timeout(12_000)
            _take(page, folder / f"{name}.png")


@contextmanager
def _studio(place: Path) -> Iterator[str]:
    """The address of a studio that runs as long as it is needed."""
    command = [sys.executable, "-m", "spheremesh", "studio", "--no-browser", "--port", "0"]
    with subprocess.Popen(command, cwd=place, stdout=subprocess.PIPE, text=True) as studio:  # noqa: S603
        try:
            yield (studio.stdout.readline() if studio.stdout else "").split()[0]
        finally:
            studio.terminate()


def _take(page: Any, path: Path) -> None:  # noqa: ANN401
    page.screenshot(path=path)
    with Image.open(path) as image:
        image.convert("RGB").save(path, optimize=True)
    print(path)


def main(folder: Path) -> None:
    """Open all, and take their pictures; without Chromium, say so."""
    from playwright.sync_api import sync_playwright

    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    if program is None:
        print("the pictures of pages stay as they are: there is no Chromium")
        return
    with tempfile.TemporaryDirectory() as place, sync_playwright() as play:
        chromium = play.chromium.launch(executable_path=program, args=FLAGS)
        pages(chromium, folder, Path(place))
        studios(chromium, folder, Path(place))
        chromium.close()


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "docs/images"))
