"""Fig. 31: the spheres that touch a saddle: which of them cut it, and which do not."""

import numpy as np
from figure import BLUE, GREEN, RED, SAND, Figure, View, grid_mesh, run

from spheremesh.nodes import sphere_rows
from spheremesh.viewer.shapes import Shape, mesh_shape, sphere_shape

FIRST, SECOND = 2.4, -0.8
"""Principal curvatures."""


def draw(*, small: bool = False) -> Figure:
    """Curvature spheres red, central sphere green, spheres that do not cut the surface blue."""
    n = 25 if small else 81
    u, v = np.meshgrid(*[np.linspace(-0.8, 0.8, n)] * 2, indexing="ij")
    saddle = grid_mesh(np.stack([u, v, (FIRST * u**2 + SECOND * v**2) / 2], -1))
    colors = {FIRST: RED, SECOND: RED, (FIRST + SECOND) / 2: GREEN, 3.6: BLUE, -1.6: BLUE}
    cuts = {curvature: cuts_surface(curvature) for curvature in colors}
    blue = [cuts[k] for k, color in colors.items() if color == BLUE]
    between = np.linspace(SECOND, FIRST, 9)[1:-1]

    def shapes(*kinds: tuple[int, int, int]) -> list[Shape]:
        return [
            sphere_shape(
                sphere_rows([[0, 0, 1 / k]], [1 / abs(k)]), color, is_veil=color != BLUE
            )
            for k, color in colors.items()
            if color in kinds
        ]

    surface = mesh_shape(saddle, SAND, smooth=True)
    view = {"direction": (0.7, -1.0, 0.35)}
    return Figure(
        "Fig. 31",
        f"of spheres with curvatures between {SECOND} and {FIRST} all "
        f"{sum(map(cuts_surface, between))} tried cut the surface, of the others "
        f"{sum(blue)} of {len(blue)}.",
        all(map(cuts_surface, between)) and not any(blue),
        [
            View("curvature spheres", things=[surface, *shapes(RED)], options=view),
            View("the central sphere", things=[surface, *shapes(GREEN)], options=view),
            View("spheres that do not cut", things=[surface, *shapes(BLUE)], options=view),
        ],
    )


def cuts_surface(curvature: float) -> bool:
    """Whether a touching sphere has points of the surface on both sides, near the contact."""
    turns = np.linspace(0, 2 * np.pi, 721)
    u, v = 1e-3 * np.cos(turns), 1e-3 * np.sin(turns)
    height = (FIRST * u**2 + SECOND * v**2) / 2 - curvature * 1e-6 / 2
    return bool(height.min() < 0 < height.max())


if __name__ == "__main__":
    run(draw)
