"""Exactly circular nets to start from: every face has a circumcircle.

Surfaces of revolution give nets of isosceles trapezoids, Möbius maps keep circles, and the
Christoffel dual of a net on the sphere with cross-ratio -1 is a discrete minimal surface. The
generators work at any resolution; normals point outwards (upwards for roofs).
"""

import numpy as np

from ..arrays import FloatArray, IntArray, dot, norm
from ..errors import InputError
from ..meshes.mesh import Mesh


def torus_net(n_around: int, n_across: int, major_radius: float, minor_radius: float) -> Mesh:
    """Closed net on a torus about the z axis.

    Parameters
    ----------
    n_around, n_across : int
        Faces along the large and along the small circles, at least 3.
    major_radius, minor_radius : float
        Radius of the core circle and of the tube.

    Returns
    -------
    Mesh
        ``n_around * n_across`` quadrilaterals.

    Raises
    ------
    InputError
        If the counts are too small or the tube does not fit.
    """
    _check_counts(around=(n_around, 3), across=(n_across, 3))
    if not 0 < minor_radius < major_radius < np.inf:
        raise InputError(
            "a torus needs 0 < minor radius < major radius, "
            f"not {minor_radius} and {major_radius}"
        )
    tube = 2 * np.pi * np.arange(n_across) / n_across
    radii = major_radius + minor_radius * np.cos(tube)
    points = _revolve(radii, minor_radius * np.sin(tube), _turns(n_around))
    return _grid_mesh(points, closed_around=True, closed_across=True)


def ellipsoid_net(
    n_around: int, n_across: int, radius: float, height: float, latitude: float
) -> Mesh:
    """Net on a spheroid about the z axis, without its two caps.

    Parameters
    ----------
    n_around, n_across : int
        Faces along the parallels (at least 3) and along the meridians.
    radius, height : float
        Half axes across and along z.
    latitude : float
        Reduced latitude at which the caps are cut off, in radians, below π/2.

    Returns
    -------
    Mesh
        ``n_around * n_across`` quadrilaterals.

    Raises
    ------
    InputError
        If a count or a half axis is too small, or the latitude out of range.
    """
    _check_counts(around=(n_around, 3), across=(n_across, 1))
    _check_positive(radius=radius, height=height, latitude=latitude)
    if latitude >= np.pi / 2:
        raise InputError("the latitude at which an ellipsoid is cut must be below 90 degrees")
    angles = np.linspace(-latitude, latitude, n_across + 1)
    points = _revolve(radius * np.cos(angles), height * np.sin(angles), _turns(n_around))
    return _grid_mesh(points, closed_around=True)


def catenoid_net(n_around: int, n_across: int, waist: float, height: float) -> Mesh:
    """Net on a catenoid about the z axis.

    Parameters
    ----------
    n_around, n_across : int
        Faces along the parallels (at least 3) and along the meridians.
    height : float
        Half of the height.

    Returns
    -------
    Mesh
        ``n_around * n_across`` quadrilaterals.

    Raises
    ------
    InputError
        If a count or a length is too small.
    """
    _check_counts(around=(n_around, 3), across=(n_across, 1))
    _check_positive(waist=waist, height=height)
    heights = np.linspace(-height, height, n_across + 1)
    points = _revolve(waist * np.cosh(heights / waist), heights, _turns(n_around))
    return _grid_mesh(points, closed_around=True)


def vase_net(
    n_around: int, n_across: int, radius: float, height: float, amplitude: float
) -> Mesh:
    """Net on a vase about the z axis: a cylinder whose radius swings by a sine.

    Parameters
    ----------
    n_around, n_across : int
        Faces along the parallels (at least 3) and along the meridians.
    radius, height : float
        Mean radius and height.
    amplitude : float
        Swing of the radius relative to the mean one, in (-1, 1).

    Returns
    -------
    Mesh
        ``n_around * n_across`` quadrilaterals, of both signs of Gaussian curvature.

    Raises
    ------
    InputError
        If a count or a length is too small, or the amplitude out of range.
    """
    _check_counts(around=(n_around, 3), across=(n_across, 1))
    _check_positive(radius=radius, height=height)
    if not -1 < amplitude < 1:
        raise InputError(f"the amplitude of a vase must lie between -1 and 1, not {amplitude}")
    share = np.linspace(0, 1, n_across + 1)
    radii = radius * (1 + amplitude * np.sin(2 * np.pi * share))
    return _grid_mesh(_revolve(radii, height * share, _turns(n_around)), closed_around=True)


def enneper_net(n: int, size: float) -> Mesh:
    """Discrete Enneper surface: a circular net that is exactly minimal.

    Parameters
    ----------
    n : int
        Faces along each side.
    size : float
        Half width of the parameter square; below 1 the surface does not meet itself.

    Returns
    -------
    Mesh
        ``n * n`` quadrilaterals.

    Raises
    ------
    InputError
        If the count or the size is too small.

    Notes
    -----
    The square grid has cross-ratio -1; lifted to the sphere (the Gauss image) it keeps it, and
    its Christoffel dual, with edges ``δN / |δN|²`` of alternating sign, is a discrete minimal
    surface (Bobenko and Pinkall, Discrete isothermic surfaces, 1996).
    """
    _check_counts(n=(n, 1))
    _check_positive(size=size)
    grid = np.linspace(-size, size, n + 1)
    u, v = np.meshgrid(grid, grid, indexing="ij")
    square = u**2 + v**2
    gauss = np.stack([2 * u, 2 * v, 1 - square], -1) / (square + 1)[..., None]
    first, second = np.diff(gauss, axis=0), np.diff(gauss, axis=1)
    first /= dot(first, first)[..., None]
    second /= dot(second, second)[..., None]
    points = np.zeros((n + 1, n + 1, 3))
    points[1:, 0] = np.cumsum(first[:, 0], axis=0)
    points[:, 1:] = points[:, :1] - np.cumsum(second, axis=1)
    step = 2 * size / n
    # Rows and columns swapped: the normal points up.
    return _grid_mesh(((points - points.mean((0, 1))) * step**2).transpose(1, 0, 2))


def roof_net(n_span: int, n_length: int, length: float) -> Mesh:
    """Freeform roof over a long hall: three domes in a row, bent in plan and of growing size.

    Parameters
    ----------
    n_span, n_length : int
        Faces across the hall and along it; 24 and 60 give nearly square ones.
    length : float
        Length of the hall, in model units.

    Returns
    -------
    Mesh
        ``n_span * n_length`` quadrilaterals with exact circumcircles, of both signs of
        Gaussian curvature, no two rows alike. The normals point up.

    Raises
    ------
    InputError
        If a count or the length is too small.

    Notes
    -----
    The upper part of a pipe whose radius swings: its circles and profiles form a circular net.
    Its domes are about as round along as across, where spheres fit best; the waists between
    them are narrower, and saddles. An inversion at a point far to the side keeps the circles,
    bends the axis and makes one end larger than the other.
    """
    _check_counts(span=(n_span, 1), length=(n_length, 1))
    _check_positive(length=length)
    share = _equal_steps(_swinging_pipe(np.linspace(0, 1, 4001)), n_length)
    radii, along = _swinging_pipe(share)
    # The inversion turns the pipe inside out: its angles run backwards to keep N outside.
    turns = np.pi * np.linspace(0.86, 0.14, n_span + 1)
    points = _revolve(radii, along, turns)[..., [2, 0, 1]]
    relative = points - np.array([3.5, -7.0, 2.0])
    points = _lay_flat(relative / dot(relative, relative)[..., None])
    return _grid_mesh(points * (length / np.ptp(points[..., 0])))


def _swinging_pipe(share: FloatArray) -> FloatArray:
    """Radius and height (2, n) of a profile with three swells, at shares of its length."""
    wave = np.sqrt(np.sin(np.pi * (2.4 * share - 0.6)) ** 2 + 0.25)
    return np.stack([0.4 + 0.7 * wave, 6 * (share - 0.5)])


def _equal_steps(profile: FloatArray, count: int) -> FloatArray:
    """Shares of the parameter that divide a sampled curve (2, n) in pieces of equal length."""
    lengths = np.concatenate([np.zeros(1), np.cumsum(norm(np.diff(profile).T))])
    shares = np.linspace(0, 1, len(lengths))
    targets = np.linspace(0, float(lengths[-1]), count + 1)
    return np.asarray(np.interp(targets, lengths, shares), np.float64)


def _lay_flat(points: FloatArray) -> FloatArray:
    """Longest direction along x, mean plane of the rim level, normals up, lowest point at 0."""
    rim = np.concatenate([points[0], points[-1], points[:, 0], points[:, -1]])
    center = rim.mean(0)
    axes = np.linalg.svd(rim - center, full_matrices=False)[2]
    diagonals = points[1:, 1:] - points[:-1, :-1], points[:-1, 1:] - points[1:, :-1]
    axes[2] *= np.copysign(1.0, np.cross(*diagonals).sum((0, 1)) @ axes[2])
    axes[1] = np.cross(axes[2], axes[0])
    result = (points - center) @ axes.T
    result[..., 2] -= result[..., 2].min()
    return result


def _turns(count: int) -> FloatArray:
    return 2 * np.pi * np.arange(count) / count


def _revolve(radii: FloatArray, heights: FloatArray, turns: FloatArray) -> FloatArray:
    """Points (turns, profile, 3) of a surface of revolution about z."""
    x, y = np.outer(np.cos(turns), radii), np.outer(np.sin(turns), radii)
    return np.stack([x, y, np.broadcast_to(heights, x.shape)], -1)


def _grid_mesh(
    points: FloatArray, *, closed_around: bool = False, closed_across: bool = False
) -> Mesh:
    rows, columns = len(points), len(points[0])
    ids: IntArray = np.arange(rows * columns).reshape((rows, columns))
    if closed_around:
        ids = np.concatenate([ids, ids[:1]], axis=0)
    if closed_across:
        ids = np.concatenate([ids, ids[:, :1]], axis=1)
    faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
    return Mesh(points.reshape(-1, 3), faces.reshape(-1, 4))


def _check_counts(**counts: tuple[int, int]) -> None:
    for name, (value, least) in counts.items():
        if value < least:
            raise InputError(
                f"the number of faces ({name}) must be at least {least}, not {value}"
            )


def _check_positive(**lengths: float) -> None:
    for name, value in lengths.items():
        if not (np.isfinite(value) and value > 0):
            raise InputError(f"{name} must be positive, not {value}")
