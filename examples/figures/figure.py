"""What the figures share: one size, one light, a caption below each view, and how they are run.

``python examples/figures/fig12.py`` writes ``fig12.png`` and prints the number that it proves;
``--small`` draws a smaller model.
"""

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.beams.beams import Beams
from spheremesh.kernel.meshes.vertex_fans import vertex_fans
from spheremesh.kernel.panels.panels import Panels
from spheremesh.nodes import panels
from spheremesh.viewer.render import render_image
from spheremesh.viewer.shapes import Shape, edge_shape, mesh_shape

WIDTH, CAPTION = 1200, 40
"""Width of a figure, and height of the line below each view, in pixels."""

SHAPES = {1: 0.6, 2: 0.8}
"""Height of a view over its width, by the number of columns."""

INK, PAPER = (52, 56, 62), (238, 238, 236)
BLUE, RED, GREEN, SAND, GREY = (
    (132, 166, 198), (206, 108, 84), (122, 176, 132), (216, 206, 184), (222, 222, 218),
)  # fmt: skip
"""Colours of spheres; of curvature spheres; of centres; of surfaces; of what is only there."""


@dataclass(frozen=True)
class View:
    """A view of a figure: panels, beams, other things, and options of `render_image`.

    Or a picture that is drawn otherwise, of a width and a height.
    """

    caption: str
    panels: Panels | None = None
    things: Sequence[Shape] = ()
    beams: Beams | None = None
    picture: Callable[[int, int], Image.Image] | None = None
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Figure:
    """A figure of the paper, what it says, with its number, and whether that holds."""

    name: str
    says: str
    holds: bool
    views: Sequence[View]
    columns: int = 0
    shape: float = 0.0
    """Height of a view over its width; 0 for what suits most."""


def paint(figure: Figure, width: int = WIDTH) -> Image.Image:
    """All views of a figure in rows, captions below."""
    columns = figure.columns or len(figure.views)
    across = width // columns
    high = int(across * (figure.shape or SHAPES.get(columns, 1.0)))
    caption = CAPTION * width // WIDTH
    rows = -(-len(figure.views) // columns)
    sheet = Image.new("RGB", (columns * across, rows * (high + caption)), PAPER)
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(max(8, 17 * width // WIDTH))
    for place, view in enumerate(figure.views):
        left, top = place % columns * across, place // columns * (high + caption)
        picture = view.picture(across, high) if view.picture else _rendered(view, across, high)
        sheet.paste(picture, (left, top))
        middle = (left + across // 2, top + high + caption // 2)
        pen.text(middle, view.caption, INK, font, anchor="mm")
    return sheet


def _rendered(view: View, width: int, height: int) -> Image.Image:
    options = {"color_by": "none", "legend": False, "ground": False, **view.options}
    return render_image(
        view.panels, beams=view.beams, things=view.things, width=width, height=height, **options
    )


def run(draw: Callable[..., Figure]) -> None:
    """What a script does: print what its figure says, and write the picture."""
    parser = argparse.ArgumentParser(description=sys.modules["__main__"].__doc__)
    parser.add_argument("--small", action="store_true", help="a smaller model")
    parser.add_argument("-o", "--folder", type=Path, default=Path(), help="of the picture")
    options = parser.parse_args()
    figure = draw(small=options.small)
    print(f"{figure.name}: {figure.says}")
    path = options.folder / f"{Path(sys.argv[0]).stem}.png"
    paint(figure).quantize(192).save(path, optimize=True)
    print(path)
    sys.exit(not figure.holds)


def cut(sphere_mesh: SphereMesh, **options: Any) -> Panels:  # noqa: ANN401, those of the node
    """The panels of a sphere mesh."""
    return panels(sphere_mesh, **options).panels


def grid_mesh(points: np.ndarray, *, around: bool = False) -> Mesh:
    """Quads of a grid of points (n, m, 3), closed in the first direction or not."""
    n, m = points.shape[:2]
    ids = np.arange(n * m).reshape(n, m)
    rows = np.vstack([ids, ids[:1]]) if around else ids
    faces = np.stack([rows[:-1, :-1], rows[1:, :-1], rows[1:, 1:], rows[:-1, 1:]], axis=-1)
    return Mesh(points.reshape(-1, 3), faces.reshape(-1, 4))


def dual_mesh(mesh: Mesh, points: np.ndarray) -> Mesh:
    """The mesh with a vertex for each face (F, 3) and a face for each inner vertex."""
    topology = mesh.topology
    fans = vertex_fans(topology, mesh.corners, np.unique(mesh.corners))
    rings = np.split(topology.corner_faces[fans.corners], fans.offsets[1:-1])
    chosen = [r for r, closed in zip(rings, fans.is_closed, strict=True) if closed]
    used, corners = np.unique(np.concatenate(chosen), return_inverse=True)
    ends = np.cumsum([len(ring) for ring in chosen])[:-1]
    return Mesh(points[used], np.split(corners, ends))


def drawn_mesh(
    mesh: Mesh,
    color: Sequence[float] = GREEN,
    edge: float = 0.02,
    **options: Any,  # noqa: ANN401
) -> list[Shape]:
    """A mesh with flat faces and its edges, which are so thick in mean edges."""
    ends = mesh.vertices[mesh.corners[mesh.topology.next_corners]]
    length = float(np.linalg.norm(ends - mesh.vertices[mesh.corners], axis=1).mean())
    return [mesh_shape(mesh, color, **options), edge_shape(mesh, edge * length)]
