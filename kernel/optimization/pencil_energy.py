"""Energies of the angles between neighbours, as functions of one unknown per face.

Every sphere through the circle of a face is ``S(t) = cos t P + sin t Q``. Across an edge only
the four products of P, Q with P', Q' occur. All spheres through the two ends of an edge make a
Euclidean space of three dimensions, so the product ``g = <<S, S'>>`` is the cosine of the angle
between two unit vectors, each on a great circle of its own.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, sum_by
from ..meshes.mesh import Mesh, face_centroids
from ..spheres.circles import Circles
from ..tolerances import EPSILON

PRODUCT_ROUNDING = 16 * EPSILON
"""Rounding of a product of unit rows."""


@dataclass(frozen=True)
class PencilCoupling:
    """Products of the pencil rows of the two faces of each edge.

    Attributes
    ----------
    faces : (E, 2) int array
        Faces of each edge.
    products : (4, E) float array
        ``<<P,P'>>, <<P,Q'>>, <<Q,P'>>, <<Q,Q'>>``.
    weights : (E,) float array
        Weight of each edge.
    """

    faces: IntArray
    products: FloatArray
    weights: FloatArray


@dataclass(frozen=True)
class EdgeProducts:
    """The product ``g = <<S, S'>>`` of each edge and its derivatives.

    Attributes
    ----------
    value, by_first, by_second, mixed : (E,) float array
        g, its derivatives by the unknowns of the two faces, and the mixed one. The second
        derivative by either unknown alone is -g.
    """

    value: FloatArray
    by_first: FloatArray
    by_second: FloatArray
    mixed: FloatArray


class PencilDerivatives(NamedTuple):
    """Derivatives of an energy by the unknowns.

    Attributes
    ----------
    gradient : (F,) float array
        First derivatives.
    first, second, mixed : (E,) float array
        Second derivatives of the share of each edge: by the unknown of its first face, of its
        second, and of both. The Hessian is the sum of these blocks.
    noise : float
        How much of the energy may be rounding.
    """

    gradient: FloatArray
    first: FloatArray
    second: FloatArray
    mixed: FloatArray
    noise: float


def couple_pencils(mesh: Mesh, circles: Circles, weights: FloatArray) -> PencilCoupling:
    """Products of neighbouring pencils, from differences of centres only.

    The circles are in the coordinates local to their faces; (E,) weights. Independent of scale
    and of where the model sits.
    """
    faces = mesh.topology.edge_faces
    a, b = faces.T
    centroids = face_centroids(mesh)
    across = centroids[b] - centroids[a] + circles.centers[b] - circles.centers[a]
    radii = np.sqrt(circles.radii_squared)
    n, m = circles.normals[a], circles.normals[b]
    products = np.stack(
        [
            dot(n, m),
            dot(n, across) / radii[b],
            -dot(m, across) / radii[a],
            (radii[a] ** 2 + radii[b] ** 2 - dot(across, across)) / (2 * radii[a] * radii[b]),
        ]
    )
    return PencilCoupling(faces, products, weights)


def edge_products(coupling: PencilCoupling, angles: FloatArray) -> EdgeProducts:
    """Products ``<<S, S'>>`` at given unknowns t, (F,)."""
    pp, pq, qp, qq = coupling.products
    cosine, sine = np.cos(angles), np.sin(angles)
    ca, cb = cosine[coupling.faces].T
    sa, sb = sine[coupling.faces].T
    p, q = pp * cb + pq * sb, qp * cb + qq * sb
    p_turned, q_turned = pq * cb - pp * sb, qq * cb - qp * sb
    return EdgeProducts(
        ca * p + sa * q, ca * q - sa * p, ca * p_turned + sa * q_turned,
        ca * q_turned - sa * p_turned,
    )  # fmt: skip


EdgeEnergy = Callable[[FloatArray], tuple[FloatArray, FloatArray, FloatArray]]
"""Energy density of an edge as a function of g, with its first and second derivative."""


def signed_density(products: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Density ``1 - g``, with first and second derivative by g, each (E,).

    It tells smooth contact from a spike.
    """
    return 1 - products, np.full_like(products, -1.0), np.zeros_like(products)


def angle_density(target: float) -> EdgeEnergy:
    """Density ``(g |g| - cos² α)²``: the paper's, told from a spike by its sign.

    Takes (E,) values of g; returns density, first and second derivative by g. The target α is
    in radians. With ``g |g|`` for ``g²``, 120 degrees are not taken for 60.

    References
    ----------
    Meshes with Spherical Faces, eq. (9).
    """
    aim = np.cos(target) ** 2

    def _density(products: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        size, side = np.abs(products), np.sign(products)
        excess = products * size - aim
        return excess**2, 4 * size * excess, 4 * side * excess + 8 * products**2

    return _density


def angle_energy(coupling: PencilCoupling, density: EdgeEnergy, angles: FloatArray) -> float:
    """Weighted sum of the density over the edges, at unknowns (F,)."""
    pp, pq, qp, qq = coupling.products
    a, b = coupling.faces.T
    cosine, sine = np.cos(angles), np.sin(angles)
    near, far = cosine[b], sine[b]
    value = cosine[a] * (pp * near + pq * far) + sine[a] * (qp * near + qq * far)
    return float(coupling.weights @ density(value)[0])


def energy_derivatives(
    coupling: PencilCoupling, density: EdgeEnergy, angles: FloatArray
) -> PencilDerivatives:
    """First and second derivatives of `angle_energy` by the unknowns (F,)."""
    g = edge_products(coupling, angles)
    a, b = coupling.faces.T
    _, slope, bend = density(g.value)
    slope, bend = coupling.weights * slope, coupling.weights * bend
    count = len(angles)
    gradient = sum_by(a, slope * g.by_first, count) + sum_by(b, slope * g.by_second, count)
    turn = slope * g.value
    # Each g is rounded at the size of the four terms that it is summed of.
    rounded = np.abs(slope).sum() + PRODUCT_ROUNDING * np.abs(bend).sum()
    return PencilDerivatives(
        gradient,
        bend * g.by_first**2 - turn,
        bend * g.by_second**2 - turn,
        bend * g.by_first * g.by_second + slope * g.mixed,
        PRODUCT_ROUNDING * float(rounded),
    )


def convex_part(found: PencilDerivatives) -> PencilDerivatives:
    """The same with the block of each edge replaced by its part without negative curvature.

    The sum of these blocks has none either: a step by it always goes down.
    """
    middle, half = (found.first + found.second) / 2, (found.first - found.second) / 2
    reach = np.hypot(half, found.mixed)
    high, low = np.maximum(middle + reach, 0), np.maximum(middle - reach, 0)
    # The two eigenvectors lie at ± a turn whose double has cosine half / reach.
    share = np.divide(high - low, 2 * reach, out=np.zeros_like(reach), where=reach > 0)
    mean = (high + low) / 2
    return PencilDerivatives(
        found.gradient,
        mean + share * half,
        mean - share * half,
        share * found.mixed,
        found.noise,
    )


def has_convex_blocks(found: PencilDerivatives) -> BoolArray:
    """Whether the block of each edge (E,) has no negative curvature."""
    return (found.first + found.second >= 0) & (found.first * found.second >= found.mixed**2)
