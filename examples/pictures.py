"""
The pictures of the README: a roof on eight moulds, and the reflections that prove it smooth.

    python examples/pictures.py docs/images
"""

import sys
from pathlib import Path

from PIL import Image

from spheremesh.nodes import (
    cluster_radii,
    face_planes,
    fit_spheres,
    minimize_angles,
    panels,
    roof_mesh,
)
from spheremesh.viewer.render import compare_image, render_image


def roof() -> Image.Image:
    """The roof of 1440 spherical panels, made on eight moulds."""
    smooth = minimize_angles(fit_spheres(roof_mesh()))
    clusters = cluster_radii(smooth.sphere_mesh, 8)
    made = panels(clusters.sphere_mesh, labels=clusters.labels)
    return render_image(made.panels, direction=(0.5, -0.85, 0.5), height=800, legend=True)


def roof_zebra() -> Image.Image:
    """Reflected stripes on plane panels, and on spherical ones with the same corners."""
    planes = face_planes(roof_mesh())
    smooth = minimize_angles(planes)
    angles = smooth.report["angles_deg"]
    return compare_image(
        panels(planes).panels,
        panels(smooth.sphere_mesh).panels,
        captions=(
            f"plane panels: {angles['planar']['mean']:.1f}° between neighbours, on average",
            f"spherical panels: {angles['spherical']['mean']:.1f}°, on the same mesh",
        ),
        direction=(0.72, -0.7, 0.55),
        height=560,
    )


def main(folder: Path) -> None:
    """Draw and write both pictures."""
    for name, draw in (("roof", roof), ("roof-zebra", roof_zebra)):
        path = folder / f"{name}.png"
        draw().save(path, optimize=True)
        print(f"{path}: {path.stat().st_size // 1000} kB")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "docs/images"))
