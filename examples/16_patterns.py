"""One canopy in all patterns, side by side: quads, hexagons, triangles, semi-regular ones."""

import warnings

import numpy as np
from PIL import Image

import spheremesh as sm
from spheremesh.nodes import (
    hexagon_pattern,
    panels,
    quad_pattern,
    render,
    semiregular_pattern,
    sphere_gain,
    triangle_pattern,
)

WIDTH, HEIGHT = 620, 400

x, y = np.meshgrid(np.linspace(-8, 8, 49), np.linspace(-5.5, 5.5, 33), indexing="ij")
z = -0.035 * x**2 - 0.022 * y**2
ids = np.arange(x.size).reshape(x.shape)
faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
canopy = sm.Mesh(np.stack([x, y, z], -1).reshape(-1, 3), faces.reshape(-1, 4))
print(sphere_gain(canopy, 1.5).report["advice"])

warnings.simplefilter("ignore")
made = {
    "quads": (quad_pattern(canopy, 1.5), "intersection"),
    "hexagons": (hexagon_pattern(canopy, 0.9, max_axis_angle=9), "intersection"),
    "triangles": (triangle_pattern(canopy, 2.0), "bisector"),
    "3.6.3.6": (semiregular_pattern(canopy, 1.3), "bisector"),
    "3.4.6.4": (semiregular_pattern(canopy, 1.1, "3.4.6.4"), "bisector"),
    "4.8.8": (semiregular_pattern(canopy, 0.9, "4.8.8"), "bisector"),
}
sheet = Image.new("RGB", (3 * WIDTH, 2 * HEIGHT))
for i, (name, (pattern, edges)) in enumerate(made.items()):
    report, cut = pattern.report, panels(pattern.sphere_mesh, edges=edges, thickness=0.04)
    angles = report["angles_deg"]
    print(
        f"{name:10s} {report['status']}: {report['faces']['count']} panels, "
        f"{len(cut.report['rejected'])} rejected, {angles['planes']:.2f} degrees with planes, "
        f"{angles['spheres']:.2f} with spheres, {angles['expected']:.2f} expected"
    )
    path = render(cut.panels, f"pattern_{i}.png", color_by="none", width=WIDTH, height=HEIGHT)
    with Image.open(path) as picture:
        sheet.paste(picture.convert("RGB"), (i % 3 * WIDTH, i // 3 * HEIGHT))
sheet.save("patterns.png")
