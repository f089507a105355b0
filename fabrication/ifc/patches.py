"""Pieces of spheres as spline surfaces: rational ones, exact, or polynomials.

IfcOpenShell, and what is built on it, has no spherical surfaces (0.9: it crashes), takes the
far side of a surface of revolution for the near one, and drops the weights of rational patches:
of sharply curved panels a twentieth of the volume. Polynomials it reads as they are; their
degree is such that they keep to their sphere within `_MISS` of the size of the panel, a
nanometre for one of a metre.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import comb, factorial
from typing import Final, Literal

import numpy as np

from ...kernel.arrays import FloatArray

PatchKind = Literal["polynomial", "rational"]

_MISS: Final = 1e-9
"""How far polynomials may be from their sphere, relative to the angle that they open."""

_HIGHEST: Final = 24
"""Degree that readers take."""

_WIDER: Final = 1.5
"""How far a rational patch reaches beyond the farthest corner of its face."""

_WIDEST: Final = 0.6
"""Rational patches that reach farther, as tangents of half angles, have four spans."""

_MARGIN, _NEAR_POLE = 1.25, 1.5
"""How far a polynomial reaches beyond the farthest corner, and not farther in radians."""


@dataclass(frozen=True)
class Patch:
    """Kind of a patch, and how fine it is: degree of polynomials, spans of rational patches."""

    kind: PatchKind
    fineness: int

    @property
    def degree(self) -> int:
        """Along both parameters."""
        return self.fineness if self.kind == "polynomial" else 2

    @property
    def n_spans(self) -> int:
        """Bézier spans along both."""
        return 1 if self.kind == "polynomial" else self.fineness


def patch_for(kind: PatchKind, half: float) -> Patch:
    """The coarsest patch for faces whose corners are so far, in radians, from their middle."""
    if kind == "rational":
        return Patch(kind, 1 if _WIDER * np.tan(half / 2) < _WIDEST else 2)
    reach = _reach(half)
    for degree in range(3, _HIGHEST):
        # The error of interpolating a sine or cosine at Chebyshev's points.
        if reach ** (degree + 1) <= _MISS * 2 * half * 2**degree * factorial(degree + 1):
            return Patch(kind, degree)
    return Patch(kind, _HIGHEST)


def patch_lines(patch: Patch, number: str, first: int) -> list[str]:
    """Poles numbered from the first on, and the surface with a number of its own."""
    degree, n_spans = patch.degree, patch.n_spans
    side = degree * n_spans + 1
    poles = [f"#{first + i}=IFCCARTESIANPOINT((%s,%s,%s));\n" for i in range(side**2)]
    rows = [",".join(f"#{first + side * i + j}" for j in range(side)) for i in range(side)]
    ends = f"{degree + 1}"
    counts = f"({','.join([ends, *[f'{degree}'] * (n_spans - 1), ends])})"
    knots = ",".join(["%s"] * (n_spans + 1))
    is_rational = patch.kind == "rational"
    name = "IFCRATIONALBSPLINESURFACEWITHKNOTS" if is_rational else "IFCBSPLINESURFACEWITHKNOTS"
    weights = "),(".join(",".join(["%s"] * side) for _ in range(side))
    surface = (
        f"#{number}={name}({degree},{degree},(({'),('.join(rows)})),"
        f".UNSPECIFIED.,.F.,.F.,.F.,{counts},{counts},({knots}),({knots}),.UNSPECIFIED."
        f"{f',(({weights}))' if is_rational else ''});\n"
    )
    return [*poles, surface]


def patch_numbers(
    patch: Patch, half: float, center: FloatArray, axes: FloatArray, radius: float
) -> FloatArray:
    """Poles, knots and weights; axes point across the patch, along it, and to its middle."""
    make = _polynomial if patch.kind == "polynomial" else _rational
    local, knots, weights = make(patch, half)
    poles = center + radius * (local @ axes)
    return np.concatenate([poles.ravel(), knots, knots, weights.ravel()])


def _reach(half: float) -> float:
    return max(min(_MARGIN * half, _NEAR_POLE), 1.01 * half)


def _polynomial(patch: Patch, half: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """By longitude and latitude: products of sines and cosines of each."""
    reach = _reach(half)
    nodes, to_poles = _chebyshev(patch.degree)
    sines, cosines = to_poles @ np.sin(reach * nodes), to_poles @ np.cos(reach * nodes)
    local = np.stack(
        [
            np.outer(sines, cosines),
            np.broadcast_to(sines, (len(sines), len(sines))),
            np.outer(cosines, cosines),
        ],
        axis=-1,
    )
    return local, np.array([-reach, reach]), np.zeros(0)


@lru_cache
def _chebyshev(degree: int) -> tuple[FloatArray, FloatArray]:
    """Nodes from -1 to 1, and the matrix from values there to Bézier points."""
    nodes = np.cos(np.pi * (2 * np.arange(degree + 1) + 1) / (2 * degree + 2))
    share = (nodes[:, None] + 1) / 2
    i = np.arange(degree + 1)
    binomials = np.array([float(comb(degree, each)) for each in i])
    basis = binomials * share**i * (1 - share) ** (degree - i)
    return nodes, np.linalg.inv(basis).astype(np.float64)


def _rational(patch: Patch, half: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """By stereographic projection from the far side of the sphere."""
    reach = _WIDER * float(np.tan(half / 2))
    # Poles of the square and of the parameter itself, span by span.
    squares, values = {
        1: (np.array([1.0, -1.0, 1.0]), np.array([-1.0, 0.0, 1.0])),
        2: (np.array([1.0, 0.0, 0.0, 0.0, 1.0]), np.array([-1.0, -0.5, 0.0, 0.5, 1.0])),
    }[patch.n_spans]
    squares, values = squares * reach**2, values * reach
    p, q = np.meshgrid(values, values, indexing="ij")
    rises = squares[:, None] + squares
    weights = 1 + rises
    local = np.stack([2 * p, 2 * q, 1 - rises], axis=-1) / weights[..., None]
    return local, np.linspace(-reach, reach, patch.n_spans + 1), weights
