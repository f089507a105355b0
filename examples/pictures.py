"""
The pictures of the README: a roof on eight moulds, and the reflections that prove it smooth.

    python examples/pictures.py docs/images
"""

import sys
from pathlib import Path

import numpy as np
from PIL import Image

from spheremesh.kernel.clustering import cluster_radii
from spheremesh.kernel.cutting import cut_panels
from spheremesh.kernel.fit import face_planes, fit_spheres
from spheremesh.kernel.pencil import minimize_angles
from spheremesh.kernel.sphere_mesh import intersection_angles
from spheremesh.kernel.surfaces import roof_net
from spheremesh.viewer.render import compare_image, render_image


def roof() -> Image.Image:
    """A roof of 1440 spherical panels, made on eight moulds."""
    smooth, _ = minimize_angles(fit_spheres(roof_net(24, 60, 80.0)))
    clustered, moulds = cluster_radii(smooth, 8)
    panels, _ = cut_panels(clustered, labels=moulds.labels)
    return render_image(panels, direction=(0.5, -0.85, 0.5), height=800, legend=True)


def roof_zebra() -> Image.Image:
    """Reflected stripes on plane panels, and on spherical ones with the same corners."""
    mesh = roof_net(24, 60, 80.0)
    plane = face_planes(mesh)
    smooth, _ = minimize_angles(plane)
    before, after = (
        np.degrees(intersection_angles(spheres).mean()) for spheres in (plane, smooth)
    )
    captions = (
        f"plane panels: {before:.1f}° between neighbours",
        f"spherical panels: {after:.1f}°",
    )
    left, right = cut_panels(plane)[0], cut_panels(smooth)[0]
    direction = (0.72, -0.7, 0.55)
    return compare_image(left, right, captions=captions, direction=direction, height=560)


def main(folder: Path) -> None:
    """Draw and write both pictures."""
    for name, draw in (("roof", roof), ("roof-zebra", roof_zebra)):
        path = folder / f"{name}.png"
        draw().save(path, optimize=True)
        print(f"{path}: {path.stat().st_size // 1000} kB")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "docs/images"))
