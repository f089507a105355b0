"""The table of terms of energy (6).

A new term is one module with `blocks`, `residuals`, `jacobian` and `second_derivatives`, one
row in `TERMS`, and one weight in `EnergyWeights`.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np

from ...arrays import FloatArray
from ...errors import InputError
from ...solvers.blocks import Block
from . import angle, closeness, dual_norm, fairness, regularity, sphericity, support, unit_norm
from .second_derivatives import SecondDerivatives
from .setting import Setting, Unknowns


@dataclass(frozen=True)
class EnergyWeights:
    """Weights λ of energy (6); a term counts λ² times. Lengths are in mean edges.

    Attributes
    ----------
    sphericity, unit_norm, angle, regularity, support, dual_norm : float
        The paper's weights; its defaults are 1, 10, 0.1, 3.5, 1 and 10.
    fairness : float
        Weight of the umbrella vectors of moving vertices.
    closeness : float
        Weight of the displacements of moving vertices.

    Raises
    ------
    InputError
        If a weight is negative or not finite.

    References
    ----------
    Meshes with Spherical Faces, eq. (6), Table 1.
    """

    sphericity: float = 1.0
    unit_norm: float = 10.0
    angle: float = 0.1
    regularity: float = 0.0
    support: float = 0.0
    dual_norm: float = 10.0
    fairness: float = 0.0
    closeness: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not (np.isfinite(value) and value >= 0):
                raise InputError(
                    f"the weight {field.name} must be finite and at least 0, not {value}"
                )


@dataclass(frozen=True)
class Term:
    """One term of the energy: a sum of squares of residuals.

    Attributes
    ----------
    name : str
        Name of the term and of its weight.
    blocks : callable
        Setting to what each residual depends on.
    residuals : callable
        Setting and unknowns to (m,) residuals.
    jacobian : callable
        Setting and unknowns to one (m, width) table of derivatives per block.
    second_derivatives : callable
        Setting, unknowns and (m,) multipliers to second derivatives by pairs of blocks.
    is_gauge : bool
        Whether the term holds a scale that moves keep exactly: it is zero always.
    """

    name: str
    blocks: Callable[[Setting], tuple[Block, ...]]
    residuals: Callable[[Setting, Unknowns], FloatArray]
    jacobian: Callable[[Setting, Unknowns], tuple[FloatArray, ...]]
    second_derivatives: Callable[[Setting, Unknowns, FloatArray], SecondDerivatives]
    is_gauge: bool


TERMS = tuple(
    Term(
        module.__name__.rpartition(".")[2], module.blocks, module.residuals, module.jacobian,
        module.second_derivatives, is_gauge=module in (unit_norm, dual_norm),
    )
    for module in (
        sphericity, unit_norm, angle, regularity, support, dual_norm, fairness, closeness,
    )
)  # fmt: skip
