"""E_angle: neighbouring spheres meet at the target angle."""

import numpy as np

from ...arrays import FloatArray, dot, gather
from ...solvers.blocks import Block
from ...spheres.minkowski import minkowski, minkowski_gradient
from ...spheres.rows import recenter
from .second_derivatives import SecondDerivatives
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


def second_derivatives(
    setting: Setting, unknowns: Unknowns, multipliers: FloatArray
) -> SecondDerivatives:
    """Second derivatives of the residuals, each times its multiplier, by pairs of blocks.

    ``2 √w (|g| ∂²g + sign(g) ∂g ∂gᵀ)``; only the mixed derivative of g is not zero.
    """
    first, second = _rows_at_middles(setting, unknowns)
    g = minkowski(first, second)
    by_first, by_second = (
        _product_gradient(other, middle)
        for other, middle in zip((second, first), setting.edge_middles, strict=True)
    )
    scale = 2 * np.sqrt(setting.edge_weights) * multipliers
    bent = scale * np.sign(g)
    mixed = _product_form(setting) * (scale * np.abs(g))[:, None, None]
    return {
        (0, 0): _outer(by_first, by_first * bent[:, None]),
        (0, 1): mixed + _outer(by_first, by_second * bent[:, None]),
        (1, 1): _outer(by_second, by_second * bent[:, None]),
    }


def _product_form(setting: Setting) -> FloatArray:
    """Matrices K (E, 5, 5) with ``<<S, S'>> = Sᵀ K S'``, each row local to its face."""
    shift = setting.edge_middles[1] - setting.edge_middles[0]
    form = np.zeros((len(shift), 5, 5))
    form[:, 0, 0] = -2 * dot(shift, shift)
    form[:, 0, 1:4] = 2 * shift
    form[:, 1:4, 0] = -2 * shift
    form[:, [1, 2, 3], [1, 2, 3]] = 1
    form[:, [0, 4], [4, 0]] = -2
    return form


def _outer(a: FloatArray, b: FloatArray) -> FloatArray:
    return a[:, :, None] * b[:, None, :]


def _product_gradient(other: FloatArray, middle: FloatArray) -> FloatArray:
    """Derivative (E, 5) of ``<<S, S'>>`` by S, with S' seen from the middle, local to S."""
    return minkowski_gradient(recenter(other, -middle))


def _rows_at_middles(setting: Setting, unknowns: Unknowns) -> tuple[FloatArray, FloatArray]:
    first, second = setting.edge_faces.T
    return (
        recenter(gather(unknowns.spheres, first), setting.edge_middles[0]),
        recenter(gather(unknowns.spheres, second), setting.edge_middles[1]),
    )
