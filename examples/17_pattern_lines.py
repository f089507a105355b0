"""Where the lines of quads run: along curvature, a direction, a curve, or the boundary."""

import warnings

import numpy as np
from PIL import Image

import spheremesh as sm
from spheremesh.nodes import panels, quad_pattern, render

WIDTH, HEIGHT, EDGE = 620, 400, 1.15


def height(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """A vault with a soft crest across, where it bends most."""
    return -0.05 * y**2 - 0.45 * np.sqrt(2 + (x - 1.5) ** 2)


u, v = np.meshgrid(np.linspace(-6, 6, 61), np.linspace(-4, 4, 41), indexing="ij")
x, y = u + 0.2 * v, v
ids = np.arange(x.size).reshape(x.shape)
faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
vault = sm.Mesh(np.stack([x, y, height(x, y)], -1).reshape(-1, 3), faces.reshape(-1, 4))

t = np.linspace(-6, 6, 40)
wave = 1.4 * np.sin(t / 2.2)
curve = np.stack([t, wave, height(t, wave)], 1)
segments = np.stack([curve[:-1], curve[1:]], 1)

warnings.simplefilter("ignore")
made = {
    "lines of curvature": quad_pattern(vault, EDGE),
    "boundary left alone": quad_pattern(vault, EDGE, boundary="free"),
    "boundary followed": quad_pattern(vault, EDGE, boundary="follow"),
    "a direction": quad_pattern(vault, EDGE, direction=np.array([1.0, 0.6, 0])),
    "a curve": quad_pattern(vault, EDGE, guides=segments),
    "density": quad_pattern(vault, EDGE, density=1.0),
}
sheet = Image.new("RGB", (3 * WIDTH, 2 * HEIGHT))
for i, (name, (net, report)) in enumerate(made.items()):
    edges = "intersection" if report["status"] == "usable" else "bisector"
    cut, angles = panels(net, edges=edges, thickness=0.03), report["angles_deg"]
    print(
        f"{name:20s} {report['status']}: {report['faces']['count']} panels, "
        f"{len(cut.report['rejected'])} rejected, {angles['planes']:.2f} degrees with planes, "
        f"{angles['spheres']:.2f} with spheres, {angles['expected']:.2f} expected"
    )
    path = render(
        cut.panels, f"lines_{i}.png", color_by="none", width=WIDTH, height=HEIGHT, view="top"
    )
    with Image.open(path) as picture:
        sheet.paste(picture.convert("RGB"), (i % 3 * WIDTH, i // 3 * HEIGHT))
sheet.save("pattern_lines.png")
