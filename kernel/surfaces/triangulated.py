"""Triangulated sample surfaces with exact normals, to remesh and to measure with.

A surface is a map of a rectangle of parameters with its two derivatives; opposite sides of the
rectangle may be glued.
"""

from collections.abc import Callable
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from ..arrays import FloatArray, IntArray, norm, unit
from ..errors import InputError
from ..meshes.isotropic_remeshing import MAX_TRIANGLES
from ..meshes.mesh import Mesh

SampleShape: TypeAlias = Literal["torus", "annulus", "hypar", "bump", "ellipsoid", "waves"]

IRREGULARITY = 0.2
"""How far the parameters of a vertex are moved at random, in grid steps."""


class Patch(NamedTuple):
    """Points of a parametric surface and their derivatives, (..., 3) each."""

    points: FloatArray
    along_u: FloatArray
    along_v: FloatArray


class ParametricShape(NamedTuple):
    """A map of the rectangle ``low <= (u, v) <= high``, and which directions are closed."""

    patch: Callable[[FloatArray, FloatArray], Patch]
    low: tuple[float, float]
    high: tuple[float, float]
    closed: tuple[bool, bool] = (False, False)


def triangulated_surface(
    shape: SampleShape, edge_length: float, seed: int | None = None
) -> tuple[Mesh, FloatArray]:
    """A triangulated sample surface of size about 2 with its exact normals.

    Parameters
    ----------
    shape : {"torus", "annulus", "hypar", "bump", "ellipsoid", "waves"}
        A torus of radii 2 and 0.7; a ring of revolution; a saddle; a freeform hill; a triaxial
        ellipsoid without its poles; a wavy sheet.
    edge_length : float
        Mean length of the edges along the parameter lines, in model units.
    seed : int, optional
        Moves the vertices along the surface at random; a regular grid without.

    Returns
    -------
    mesh : Mesh
        Triangles; the normals point up or outwards.
    normals : (V, 3) float array
        Unit normals of the smooth surface.

    Raises
    ------
    InputError
        If the shape is unknown, or the edge length not positive, too large for the shape or so
        small that there would be too many triangles.
    """
    if shape not in SHAPES:
        raise InputError(f"shape must be one of {', '.join(SHAPES)}, not {shape!r}")
    if not 0 < edge_length < np.inf:
        raise InputError(f"the edge length must be positive, not {edge_length}")
    chosen = SHAPES[shape]
    counts = grid_counts(chosen, edge_length)
    u, v, triangles = parameter_grid(chosen, counts, seed)
    patch = chosen.patch(u, v)
    normals = unit(np.cross(patch.along_u, patch.along_v))
    return Mesh(patch.points, triangles), normals


def grid_counts(shape: ParametricShape, edge_length: float) -> tuple[int, int]:
    """Numbers of grid steps along u and v.

    Parameters
    ----------
    edge_length : float
        Length of a step.

    Returns
    -------
    n_u, n_v : int
        At least 3.

    Raises
    ------
    InputError
        If the edge length is too large, or so small that there would be too many triangles.
    """
    axes = [np.linspace(low, high, 60) for low, high in zip(shape.low, shape.high, strict=True)]
    patch = shape.patch(*np.meshgrid(*axes, indexing="ij"))
    spans = np.subtract(shape.high, shape.low)
    lengths = norm(patch.along_u).mean() * spans[0], norm(patch.along_v).mean() * spans[1]
    if (
        2 * (float(lengths[0]) / edge_length) * (float(lengths[1]) / edge_length)
        > MAX_TRIANGLES
    ):
        raise InputError(
            f"edges of {edge_length:g} would make more than {MAX_TRIANGLES} triangles: choose "
            "longer ones"
        )
    counts = [round(float(length) / edge_length) for length in lengths]
    if min(counts) < 3:
        raise InputError(
            f"an edge length of {edge_length:g} is too large: the surface measures "
            f"{lengths[0]:.3g} by {lengths[1]:.3g}"
        )
    return counts[0], counts[1]


def parameter_grid(
    shape: ParametricShape, counts: tuple[int, int], seed: int | None
) -> tuple[FloatArray, FloatArray, IntArray]:
    """Parameters of the vertices and the triangles of a grid.

    Parameters
    ----------
    counts : (int, int)
        Steps along u and v.
    seed : int, optional
        Moves the vertices at random.

    Returns
    -------
    u, v : (V,) float array
        Parameters.
    triangles : (F, 3) int array
        Counter-clockwise in the parameters.
    """
    sizes = [n if closed else n + 1 for n, closed in zip(counts, shape.closed, strict=True)]
    places = np.stack(np.meshgrid(*map(np.arange, sizes), indexing="ij"), -1).astype(float)
    if seed is not None:
        moves = np.random.default_rng(seed).uniform(-IRREGULARITY, IRREGULARITY, places.shape)
        for axis in range(2):
            if not shape.closed[axis]:
                np.moveaxis(moves, axis, 0)[[0, -1], ..., axis] = 0
        places += moves
    ids = np.arange(sizes[0] * sizes[1]).reshape(sizes)
    for axis in range(2):
        if shape.closed[axis]:
            ids = np.concatenate([ids, ids.take([0], axis)], axis)
    a, b, c, d = ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]
    halves = np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)], 2)
    shares = places.reshape(-1, 2) / counts
    u, v = (np.array(shape.low) + shares * np.subtract(shape.high, shape.low)).T
    return u, v, halves.reshape(-1, 3)


def _graph(
    u: FloatArray, v: FloatArray, z: FloatArray, z_u: FloatArray, z_v: FloatArray
) -> Patch:
    one, zero = np.ones_like(u), np.zeros_like(u)
    stacked = [np.stack(parts, -1) for parts in ((u, v, z), (one, zero, z_u), (zero, one, z_v))]
    return Patch(*stacked)


def _torus(u: FloatArray, v: FloatArray) -> Patch:
    major, minor = 2.0, 0.7
    reach = major + minor * np.cos(v)
    return Patch(
        np.stack([reach * np.cos(u), reach * np.sin(u), minor * np.sin(v)], -1),
        np.stack([-reach * np.sin(u), reach * np.cos(u), 0 * u], -1),
        minor * np.stack([-np.sin(v) * np.cos(u), -np.sin(v) * np.sin(u), np.cos(v)], -1),
    )


def _annulus(u: FloatArray, v: FloatArray) -> Patch:
    """Ring of revolution about z with a cubic profile; v runs inwards, so that N is up."""
    height, slope = 0.4 * v**2 - 0.1 * v**3, 0.8 * v - 0.3 * v**2
    return Patch(
        np.stack([v * np.cos(u), -v * np.sin(u), height], -1),
        np.stack([-v * np.sin(u), -v * np.cos(u), 0 * u], -1),
        np.stack([np.cos(u), -np.sin(u), slope], -1),
    )


def _hypar(u: FloatArray, v: FloatArray) -> Patch:
    z = 0.35 * u**2 - 0.25 * v**2 + 0.1 * u * v
    return _graph(u, v, z, 0.7 * u + 0.1 * v, 0.1 * u - 0.5 * v)


def _bump(u: FloatArray, v: FloatArray) -> Patch:
    first, second = np.cos(0.9 * u), np.cos(0.7 * v + 0.2)
    z = 0.5 * first * second + 0.1 * u * v + 0.08 * u**3
    z_u = -0.45 * np.sin(0.9 * u) * second + 0.1 * v + 0.24 * u**2
    z_v = -0.35 * first * np.sin(0.7 * v + 0.2) + 0.1 * u
    return _graph(u, v, z, z_u, z_v)


def _waves(u: FloatArray, v: FloatArray) -> Patch:
    z = 0.25 * np.sin(1.9 * u + 0.4) * np.cos(1.6 * v) + 0.12 * u * u
    z_u = 0.475 * np.cos(1.9 * u + 0.4) * np.cos(1.6 * v) + 0.24 * u
    return _graph(u, v, z, z_u, -0.4 * np.sin(1.9 * u + 0.4) * np.sin(1.6 * v))


def _ellipsoid(u: FloatArray, v: FloatArray) -> Patch:
    a, b, c = 1.6, 1.2, 0.9
    return Patch(
        np.stack([a * np.cos(u) * np.cos(v), b * np.sin(u) * np.cos(v), c * np.sin(v)], -1),
        np.stack([-a * np.sin(u) * np.cos(v), b * np.cos(u) * np.cos(v), 0 * u], -1),
        np.stack([-a * np.cos(u) * np.sin(v), -b * np.sin(u) * np.sin(v), c * np.cos(v)], -1),
    )


_TURN = 2 * np.pi
SHAPES: dict[str, ParametricShape] = {
    "torus": ParametricShape(_torus, (0, 0), (_TURN, _TURN), (True, True)),
    "annulus": ParametricShape(_annulus, (0, 0.8), (_TURN, 1.9), (True, False)),
    "hypar": ParametricShape(_hypar, (-1, -1), (1, 1)),
    "bump": ParametricShape(_bump, (-1.2, -1.2), (1.2, 1.2)),
    "ellipsoid": ParametricShape(_ellipsoid, (0, -1.2), (_TURN, 1.2), (True, False)),
    "waves": ParametricShape(_waves, (-1.5, -1.5), (1.5, 1.5)),
}
