"""Fig. 5: an elliptic pencil, all spheres through a circle; and the law of cosines."""

import numpy as np
from figure import BLUE, INK, RED, Figure, View, cut, run

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.nodes import sphere_pairs, sphere_rows
from spheremesh.viewer.shapes import circle_shape, line_shape, sphere_shape


def draw(*, small: bool = False) -> Figure:
    """Halves of the spheres of a pencil; two spheres of another."""
    count, turns = (5 if small else 9), np.linspace(0, np.pi, 49)
    half = np.stack([np.cos(turns), np.sin(turns), np.zeros(49)], axis=1)
    mesh = Mesh(np.tile(half, (count, 1)), np.arange(49 * count).reshape(count, 49))
    rows = pencil_spheres(*circle_pencils(face_circles(mesh)[0]), np.linspace(-1.2, 1.2, count))
    pencil = cut(SphereMesh.from_local(mesh, rows), labels=np.arange(count))

    centers, radii = np.array([[-0.7, 0, 0], [0.75, 0, 0]]), np.array([1.1, 0.9])
    pair = sphere_rows(centers, radii)
    angle = np.radians(sphere_pairs(pair[:1], pair[1:]).angles[0])
    square = float(((centers[1] - centers[0]) ** 2).sum())
    miss = abs(square - (radii**2).sum() + 2 * radii.prod() * np.cos(angle))
    foot = centers[0, 0] + (square + radii[0] ** 2 - radii[1] ** 2) / (2 * np.sqrt(square))
    size = np.sqrt(radii[0] ** 2 - (foot - centers[0, 0]) ** 2)
    point = np.array([foot, 0.0, size])
    things = [
        sphere_shape(pair, np.array([BLUE, RED]), is_veil=True),
        circle_shape([[foot, 0, 0]], [[1, 0, 0]], [size], 0.02),
        line_shape([*centers, centers[0]], [point, point, centers[1]], 0.012, INK),
    ]
    return Figure(
        "Fig. 5",
        f"two spheres meet at {np.degrees(angle):.2f}°, and the law of cosines "
        f"|c - c'|² = r² + r'² - 2 r r' cos φ holds to {miss:.0e}.",
        bool(miss < 1e-14),
        [
            View(
                "spheres through a circle",
                pencil,
                options={"color_by": "mould", "direction": (0.25, -1.0, 0.3)},
            ),
            View(
                "the angle of two spheres",
                things=things,
                options={"direction": (0.1, -1.0, 0.2)},
            ),
        ],
    )


if __name__ == "__main__":
    run(draw)
