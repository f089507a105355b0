"""Pictures of panels, beams and other things without any graphics hardware.

Triangles only find the surface that is seen in a pixel; the ray of the pixel is then cut with
its sphere, so that normals, reflections and joints are exact and nothing is faceted.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import get_args

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from ..kernel.arrays import FloatArray, dot, norm
from ..kernel.beams.beams import Beams
from ..kernel.beams.node_cylinders import node_cylinders
from ..kernel.errors import InputError
from ..kernel.panels.panels import Panels
from ..kernel.parts.findings import Finding
from ..kernel.spheres.incidence import project
from .camera import SAMPLES, Camera, View, frame_scene, stand_at, view_direction
from .colors import ColorBy, panel_colors
from .exposure import expose
from .legend import draw_legend, legend_width
from .scene import gather
from .shading import Shading
from .shapes import INK, Shape, beam_shapes, node_shape, panel_shape

MAX_SIDE = 8000

OUTLINE_ERROR = 0.4
"""How far outlines of triangles may be off, in samples."""


def render_image(  # noqa: PLR0913 - a picture has an option per choice
    panels: Panels | None = None,
    *,
    beams: Beams | None = None,
    things: Sequence[Shape] = (),
    color_by: ColorBy = "mould",
    findings: Sequence[Finding] = (),
    shading: Shading = "studio",
    direction: View | None = None,
    eye: Sequence[float] | None = None,
    target: Sequence[float] | None = None,
    frame: FloatArray | None = None,
    width: int = 1600,
    height: int = 1000,
    legend: bool | None = None,
    edges: bool = True,
    ground: bool = True,
) -> Image.Image:
    """A picture of panels in daylight, RGB; the same for the same panels.

    With beams and their node cylinders, and with whatever else `viewer.shapes` makes to be
    drawn. Colours of panels are those of `viewer.colors`. The shading is ``studio``: matt, in
    the light of sky and sun; ``zebra``: reflected stripes, which break at every edge that is
    not smooth; ``lamps``: a few long lights in dark polish; or ``mirror``: surroundings.

    The direction, or the name of a view, points from the things to the viewer, and all is
    framed; by default from above, onto the long side. An eye stands where it is told, and looks
    at its target, by default the middle of the things. A frame is the points (n, 3) that the
    picture has to hold, in place of all. Sizes are in pixels. A legend says what
    the colours mean, by default where they mean something. Edges are lines along joints.

    Raises InputError if there is nothing to draw, or an option is unknown or out of range.
    """
    _check_options(color_by, shading, width, height)
    colors, words = (None, None) if panels is None else panel_colors(panels, color_by, findings)
    if legend and words is None:
        raise InputError(
            "there is nothing for a legend to say: colours mean something by mould where "
            "panels have moulds, by radius where they are curved, or by another measure"
        )
    shown = words if legend is None or legend else None
    strip = legend_width(shown, width, height) if shown else 0
    subject = _Subject(panels, beams, things)
    outline = subject.outline() if frame is None else frame
    camera = _camera(outline, direction, eye, target, (width, height, strip))
    scene = gather(_shapes(subject, colors, camera, edges=edges))
    image = expose(scene, _seen_from(scene.origin, camera), shading, ground=ground)
    if shown:
        draw_legend(image, shown)
    return image


def compare_image(
    left: Panels,
    right: Panels,
    *,
    captions: tuple[str, str] = ("", ""),
    shading: Shading = "zebra",
    direction: View | None = None,
    width: int = 1600,
    height: int = 600,
) -> Image.Image:
    """Two sets of panels of the same model side by side, seen by the same camera, RGB.

    Captions stand below them; the size is that of the whole picture, the rest as in
    `render_image`.
    """
    _check_options("none", shading, width, height)
    half = width // 2
    outline = np.concatenate([_Subject(panels).outline() for panels in (left, right)])
    camera = _camera(outline, direction, None, None, (half, height, 0))
    result = Image.new("RGB", (2 * half, height))
    draw, font = ImageDraw.Draw(result), ImageFont.load_default(max(11, height // 28))
    for place, (panels, caption) in enumerate(zip((left, right), captions, strict=True)):
        colors, _ = panel_colors(panels, "none")
        scene = gather(_shapes(_Subject(panels), colors, camera))
        image = expose(scene, _seen_from(scene.origin, camera), shading)
        result.paste(image, (place * half, 0))
        middle = (place * half + half // 2, height - height // 16)
        draw.text(middle, caption, fill=INK, font=font, anchor="mm")
    return result


def _check_options(color_by: str, shading: str, width: int, height: int) -> None:
    for name, value, known in (("color_by", color_by, ColorBy), ("shading", shading, Shading)):
        if value not in get_args(known):
            choices = ", ".join(repr(choice) for choice in get_args(known))
            raise InputError(f"{name} must be one of {choices}, not {value!r}")
    for name, value in (("width", width), ("height", height)):
        if not 16 <= value <= MAX_SIDE:
            raise InputError(f"the {name} must be 16 to {MAX_SIDE} pixels, not {value}")


@dataclass(frozen=True)
class _Subject:
    """What is to be drawn."""

    panels: Panels | None = None
    beams: Beams | None = None
    things: Sequence[Shape] = ()

    def outline(self) -> FloatArray:
        """Points (N, 3) in model coordinates that a picture has to hold."""
        points = [shape.points + shape.origin for shape in self.things]
        if self.panels is not None:
            points.append(_panel_outline(self.panels))
        if self.beams is not None and self.beams.n_beams:
            sections = self.beams.sections + self.beams.annuli.origins[:, None, None]
            points.append(sections.reshape(-1, 3))
        if not points:
            raise InputError("there is nothing to draw: give panels, beams or things")
        return np.concatenate(points)


def _panel_outline(panels: Panels) -> FloatArray:
    if panels.n_panels == 0:
        raise InputError("there are no panels to draw")
    owners, ends = panels.corner_panels, panels.corners[panels.next_corners]
    local = np.concatenate([panels.corners, panels.inner_corners, (panels.corners + ends) / 2])
    points = project(panels.spheres[np.tile(owners, 3)], local)
    # Inner corners stay where they are: their outer face is no place for them.
    count = len(owners)
    points[count : 2 * count] = panels.inner_corners
    middles = project(panels.spheres, np.zeros((panels.n_panels, 3)))
    return np.concatenate(
        [points + panels.origins[np.tile(owners, 3)], middles + panels.origins]
    )


def _camera(
    outline: FloatArray,
    direction: View | None,
    eye: Sequence[float] | None,
    target: Sequence[float] | None,
    size: tuple[int, int, int],
) -> Camera:
    """A camera whose eye is in model coordinates, with sizes in samples."""
    width, height, strip = (SAMPLES * side for side in size)
    low, high = outline.min(axis=0), outline.max(axis=0)
    middle = (low + high) / 2
    if eye is not None:
        if direction is not None:
            raise InputError("a view has a direction or an eye, not both")
        at = middle if target is None else np.asarray(target, float)
        return stand_at(np.asarray(eye, float), at, width, height)
    if target is not None:
        raise InputError("a target needs an eye that looks at it")
    local = outline - middle
    towards = view_direction("home" if direction is None else direction, local)
    camera = frame_scene(local, towards, width, height, strip)
    return replace(camera, eye=camera.eye + middle)


def _seen_from(origin: FloatArray, camera: Camera) -> Camera:
    """The same camera, its eye about another origin."""
    return replace(camera, eye=camera.eye - origin)


def _shapes(
    subject: _Subject, colors: FloatArray | None, camera: Camera, *, edges: bool = True
) -> list[Shape]:
    """Everything as triangles, as fine as the picture needs."""
    shapes: list[Shape] = []
    panels, beams = subject.panels, subject.beams
    if panels is not None and colors is not None:
        sizes = np.maximum.reduceat(norm(panels.corners), panels.offsets[:-1])
        scale = _samples_per_unit(camera, panels.origins)
        tolerance = np.clip(OUTLINE_ERROR / (scale * sizes), 1e-4, 0.3)
        # Panels of about one size are cut alike: that is quick.
        tolerance = 4 ** np.floor(np.log(tolerance) / np.log(4))
        is_seen = bool((panels.thickness * scale).max() > 2 * OUTLINE_ERROR)
        shapes.append(panel_shape(panels, colors, tolerance, solid=is_seen, edges=edges))
    if beams is not None and beams.n_beams:
        half = norm(beams.sections[:, 0] - beams.sections[:, 1]).max(axis=1) / 2
        scale = _samples_per_unit(camera, beams.annuli.origins)
        finest = float(np.clip(OUTLINE_ERROR / (scale * half).max(), 5e-4, 0.1))
        shapes += beam_shapes(beams, tolerance=finest)
        nodes = node_cylinders(beams)
        if nodes.n_nodes:
            shapes.append(node_shape(nodes))
    return [*shapes, *subject.things]


def _samples_per_unit(camera: Camera, points: FloatArray) -> FloatArray:
    """Samples of a picture that a model unit takes at points (n, 3), at most."""
    depth = dot(points - camera.eye, -camera.axes[2][None])
    return camera.focal / np.maximum(depth, 0.05 * float(np.abs(depth).max(initial=0)) or 1.0)
