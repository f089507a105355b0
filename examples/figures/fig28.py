"""Fig. 28: smallest angles, without and with arcs in bisecting planes; the mesh of centres."""

from collections.abc import Callable

import numpy as np
from figure import BLUE, INK, RED, Figure, View, cut, drawn_mesh, dual_mesh, run
from PIL import Image, ImageDraw, ImageFont

from spheremesh import SphereMesh
from spheremesh.nodes import (
    beam_tilt,
    ellipsoid_mesh,
    fit_spheres,
    intersection_angles,
    minimize_angles,
    optimize_spheres,
)


def draw(*, small: bool = False) -> Figure:
    """An ellipsoid: spheres, their centres, and histograms of angles."""
    net = ellipsoid_mesh(14, 7) if small else ellipsoid_mesh(24, 14)
    free = minimize_angles(fit_spheres(net)).sphere_mesh
    upright = optimize_spheres(free, regularity=3.5).sphere_mesh
    tilts = [float(np.nanquantile(beam_tilt(each), 0.95)) for each in (free, upright)]
    flat = float(intersection_angles(free, reference="planes").mean())
    angles = [float(intersection_angles(each).mean()) for each in (free, upright)]
    views: list[View] = []
    for caption, spheres in (("smallest angles", free), ("arcs in bisecting planes", upright)):
        views.append(View(caption, cut(spheres, edges="intersection")))
    for spheres in (free, upright):
        centers = dual_mesh(net, spheres.centers)
        views.append(View("the mesh of centres", things=drawn_mesh(centers)))
    views += [
        View("angles: spheres, and planes", picture=histogram(s)) for s in (free, upright)
    ]
    return Figure(
        "Fig. 28",
        f"spheres meet at {angles[0]:.2f}° on average with arcs that lean by {tilts[0]:.0f}°, "
        f"and at {angles[1]:.2f}° with arcs that lean by {tilts[1]:.1f}°; planes at "
        f"{flat:.2f}°.",
        max(angles) < flat and tilts[1] < tilts[0],
        views,
        columns=2,
        shape=0.62,
    )


def histogram(spheres: SphereMesh) -> Callable[[int, int], Image.Image]:
    """Counts of angles between spheres (blue) and between planes (red)."""

    def picture(width: int, height: int) -> Image.Image:
        image = Image.new("RGB", (width, height), (246, 246, 246))
        pen, font = ImageDraw.Draw(image), ImageFont.load_default(max(8, width // 36))
        both = [intersection_angles(spheres, reference=r) for r in ("spheres", "planes")]
        bins = np.linspace(0, 1.02 * max(each.max() for each in both), 31)
        counts = [np.histogram(each, bins)[0] for each in both]
        left, low, high = width // 10, int(0.85 * height), int(0.1 * height)
        step = 0.8 * width / 30
        for color, several, shift in ((RED, counts[1], 0.5), (BLUE, counts[0], 0.0)):
            for place, count in enumerate(several.tolist()):
                top = low - (low - high) * count / max(each.max() for each in counts)
                x = left + (place + shift) * step
                pen.rectangle([x, top, x + 0.46 * step, low], color)
        pen.line([(left, low), (left + 30 * step, low)], INK, 2)
        for value in (0, bins[-1] / 2, bins[-1]):
            x = left + 30 * step * value / bins[-1]
            pen.text((x, low + height // 40), f"{value:.1f}°", INK, font, anchor="mt")
        return image

    return picture


if __name__ == "__main__":
    run(draw)
