"""Second derivatives of a term: what its residuals add to the Hessian of the energy."""

from collections.abc import Mapping
from typing import TypeAlias

from ...arrays import FloatArray

SecondDerivatives: TypeAlias = Mapping[tuple[int, int], FloatArray]
"""Tables (m, width, width) by pairs ``i <= j`` of a term's blocks: row by row the multiplier
times the derivative of the residual by the elements of both blocks. Pairs without are left out.
"""
