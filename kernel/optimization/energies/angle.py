"""E_angle: neighbouring spheres meet at the target angle."""

import numpy as np

from ...arrays import FloatArray
from ...solvers.blocks import Block
from ...spheres.minkowski import minkowski, minkowski_gradient
from ...spheres.rows import recenter
from .setting import Group, Setting, Unknowns


def blocks(setting: Setting) -> tuple[Block, ...]:
    """What each residual depends on: the two faces of an edge; a row per interior edge."""
    first, second = setting.edge_faces.T
    return Block(Group.SPHERE, first), Block(Group.SPHERE, second)


def residuals(setting: Setting, unknowns: Unknowns) -> FloatArray:
    """``√w (g |g| - cos² α)``, (E,), with ``g = <<S, S'>>`` the cosine of the angle.

    Where neighbours meet at less than 90 degrees they are the paper's ``g² - cos² α``, with
    edge weights w and target angle α; a spike, g = -1, counts 2 and not 0.

    References
    ----------
    Meshes with Spherical Faces, eq. (9), made to tell smooth contact from a spike.
    """
    g = minkowski(*_rows_at_middles(setting, unknowns))
    aim = np.cos(setting.target_angle) ** 2
    return np.sqrt(setting.edge_weights) * (g * np.abs(g) - aim)


def jacobian(setting: Setting, unknowns: Unknowns) -> tuple[FloatArray, ...]:
    """Derivatives by the rows of the two faces, (E, 5): ``2 √w |g|`` times the product's."""
    first, second = _rows_at_middles(setting, unknowns)
    slope = 2 * np.sqrt(setting.edge_weights) * np.abs(minkowski(first, second))
    return tuple(
        slope[:, None] * _product_gradient(other, middle)
        for other, middle in zip((second, first), setting.edge_middles, strict=True)
    )


def _product_gradient(other: FloatArray, middle: FloatArray) -> FloatArray:
    """Derivative (E, 5) of ``<<S, S'>>`` by S, with S' seen from the middle, local to S."""
    return minkowski_gradient(recenter(other, -middle))


def _rows_at_middles(setting: Setting, unknowns: Unknowns) -> tuple[FloatArray, FloatArray]:
    first, second = setting.edge_faces.T
    return (
        recenter(unknowns.spheres[first], setting.edge_middles[0]),
        recenter(unknowns.spheres[second], setting.edge_middles[1]),
    )
