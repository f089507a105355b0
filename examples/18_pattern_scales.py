"""One pattern on three scales: without every second line, and split on its spheres."""

import warnings

import numpy as np
from PIL import Image

import spheremesh as sm
from spheremesh.nodes import coarsen_pattern, panels, quad_pattern, refine_pattern, render

WIDTH, HEIGHT, EDGE = 620, 400, 1.3

x, y = np.meshgrid(np.linspace(-8, 8, 49), np.linspace(-5.5, 5.5, 33), indexing="ij")
z = -0.035 * x**2 - 0.022 * y**2
ids = np.arange(x.size).reshape(x.shape)
faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
canopy = sm.Mesh(np.stack([x, y, z], -1).reshape(-1, 3), faces.reshape(-1, 4))

warnings.simplefilter("ignore")
net = quad_pattern(canopy, EDGE).sphere_mesh
made = {
    "coarser": coarsen_pattern(net),
    "pattern": (net, None),
    "finer": refine_pattern(net),
}
sheet = Image.new("RGB", (3 * WIDTH, HEIGHT))
for i, (name, (pattern, report)) in enumerate(made.items()):
    cut = panels(pattern, edges="bisector", thickness=0.04)
    said = f"{name:8s} {pattern.mesh.n_faces} panels, {len(cut.report['rejected'])} rejected"
    if report:
        angles = report["angles_deg"]
        said += f", {angles['planes']:.2f} degrees with planes"
        said += f", {angles['spheres']:.2f} with spheres"
    print(said)
    path = render(cut.panels, f"scale_{i}.png", color_by="none", width=WIDTH, height=HEIGHT)
    with Image.open(path) as picture:
        sheet.paste(picture.convert("RGB"), (i * WIDTH, 0))
sheet.save("pattern_scales.png")
