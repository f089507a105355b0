"""The pictures of docs/viewer.md: the page of the roof in Chromium, drawn in software.

python examples/page_pictures.py docs/images
"""

import shutil
import sys
import tempfile
from pathlib import Path

from PIL import Image

from spheremesh.nodes import (
    cluster_radii,
    fit_spheres,
    minimize_angles,
    panels,
    roof_mesh,
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


def main(folder: Path) -> None:
    """Write the page, open it, and take its pictures; without Chromium, say so."""
    from playwright.sync_api import sync_playwright

    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    if program is None:
        print("the pictures of the page stay as they are: there is no Chromium")
        return
    smooth = minimize_angles(fit_spheres(roof_mesh())).sphere_mesh
    moulds = cluster_radii(smooth, 8)
    made = panels(moulds.sphere_mesh, labels=moulds.labels, thickness=0.05)
    with tempfile.TemporaryDirectory() as place, sync_playwright() as play:
        page = play.chromium.launch(executable_path=program, args=FLAGS).new_page(
            viewport={"width": 1180, "height": 720}
        )
        page.goto(Path(write_view(made.panels, f"{place}/view.html", title="Roof")).as_uri())
        page.wait_for_selector("html[data-ready]", state="attached", timeout=120_000)
        for name, state in STATES.items():
            page.evaluate(f"window.spheremesh.set({state})")
            page.wait_for_timeout(4000)
            path = folder / f"{name}.png"
            page.screenshot(path=path)
            with Image.open(path) as image:
                image.convert("RGB").quantize(128).save(path, optimize=True)
            print(path)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "docs/images"))
