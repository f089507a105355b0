"""Relaxation of sphere congruences: towards real conjugate nets with upright node axes.

Where spheres touch a surface with curvature κ, neighbours differ along a principal direction by
``κ - k`` for every unit of length, k the principal curvature, and the node axis is tilted
towards it by the derivative of κ over ``κ (κ - k)``. Nets turn complex and axes lie down where
κ varies much, vanishes, or lies between the principal curvatures, as that of central spheres
does everywhere. Touching spheres of constant radius have the curvature lines for conjugate
net and the normals for axes. Those sharper than the surface, as in Sec. 7 of the paper, are
far from all three troubles: the family between a given congruence and them is real from
somewhere on.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import FloatArray, dot, norm
from ...errors import ConvergenceError, InputError, name_ids
from ...meshes.curvature import principal_curvatures
from ...meshes.mesh import Mesh, face_centroids, face_vector_areas, mean_edge_length
from ...meshes.triangulation import check_triangles
from ...spheres.minkowski import minkowski
from ...spheres.rows import recenter, rescale
from ...tolerances import BLEND_STEP, FLATTEST
from .congruence_mesh import CongruenceMesh, congruence_mesh

SHARPER = 2.0
"""Curvature of the spheres of constant radius, relative to the sharpest of the surface."""

SHARPEST = 95
"""Percentile of the curvatures of the surface that counts as the sharpest."""


class CongruenceQuality(NamedTuple):
    """Whether a congruence can be remeshed.

    Attributes
    ----------
    complex_share : float
        Share of the area without a real conjugate net.
    axis_angle : float
        95th percentile, by area, of the angles between node axes and normals, in radians.
    """

    complex_share: float
    axis_angle: float


@dataclass(frozen=True)
class Relaxation:
    """A relaxed congruence.

    Attributes
    ----------
    spheres : (V, 5) float array
        Unit rows in model coordinates.
    blend : float
        Share τ of the spheres of constant radius in them.
    radius : float
        Signed radius of those: the distance of their centres along the normals.
    before, after : CongruenceQuality
        Of the given and of the relaxed congruence.
    """

    spheres: FloatArray
    blend: float
    radius: float
    before: CongruenceQuality
    after: CongruenceQuality


def relax_congruence(
    mesh: Mesh,
    spheres: ArrayLike,
    complex_share: Callable[[FloatArray], float],
    target: CongruenceQuality,
    radius: float | None = None,
) -> Relaxation:
    """Blend a congruence with spheres of constant radius as little as makes it fit to remesh.

    Parameters
    ----------
    spheres : (V, 5) array_like of float
        Real rows of the spheres at the vertices, planes included, near the surface there.
    complex_share : callable
        From rows (V, 5) to the share of the area without a real conjugate net.
    target : CongruenceQuality
        Largest share and angle allowed.
    radius : float, optional
        Signed distance, along the vertex normals, of the centres of the spheres of constant
        radius; half of the smallest radius of curvature of the surface by default, on the side
        where most of the given spheres have their centre.

    Returns
    -------
    Relaxation
        The given spheres if they are fit.

    Raises
    ------
    InputError
        If the mesh is not made of triangles or in pieces, a sphere is not real or not near its
        vertex, the radius is zero or not finite, or the surface is flat and has no radius.
    ConvergenceError
        If not even the spheres of constant radius meet the target.

    Notes
    -----
    The blend is of unit rows: for touching spheres of curvatures, which keeps them touching.
    One blend for all vertices, found by bisection. A blend that varies, largest where the net
    is complex, makes the radii vary more: on freeform surfaces it had to change the curvatures
    by half more and left the axes in the surface.

    References
    ----------
    Meshes with Spherical Faces, Sec. 6.4 and 7.
    """
    surface = congruence_mesh(mesh, spheres)
    normals, rows = surface.vertex_frames[:, 2], _checked_rows(surface)
    distance = _default_radius(mesh, rows) if radius is None else radius
    if not (np.isfinite(distance) and distance != 0):
        raise InputError(f"the radius must be finite and not zero, not {radius}")
    constant = np.concatenate(
        [np.full((len(rows), 1), 0.5 / distance), normals, np.zeros((len(rows), 1))], axis=1
    )

    def _blended(share: float) -> FloatArray:
        mixed = (1 - share) * rows + share * constant
        return recenter(mixed / np.sqrt(minkowski(mixed, mixed))[:, None], -mesh.vertices)

    def _measured(share: float) -> CongruenceQuality:
        candidate = _blended(share)
        return CongruenceQuality(complex_share(candidate), axis_angle(mesh, candidate))

    before, last = _measured(0.0), _measured(1.0)
    if _is_fit(before, target):
        return Relaxation(_blended(0.0), 0.0, distance, before, before)
    if not _is_fit(last, target):
        raise ConvergenceError(
            f"spheres of constant radius {abs(distance):.4g} leave {last.complex_share:.1%} "
            f"of the area complex and axes at {np.degrees(last.axis_angle):.3g} degrees: "
            "refine the mesh, or give another radius"
        )
    blend = _least_blend(lambda share: _is_fit(_measured(share), target))
    return Relaxation(_blended(blend), blend, distance, before, _measured(blend))


def _least_blend(is_fit: Callable[[float], bool]) -> float:
    """Bisection: fit at the share returned, not fit a little below."""
    low, high = 0.0, 1.0
    while high - low > BLEND_STEP:
        middle = (low + high) / 2
        low, high = (low, middle) if is_fit(middle) else (middle, high)
    return high


def _is_fit(quality: CongruenceQuality, target: CongruenceQuality) -> bool:
    return all(found <= allowed for found, allowed in zip(quality, target, strict=True))


def axis_angle(mesh: Mesh, spheres: FloatArray) -> float:
    """Angle that the node axes of a congruence make with the normals of its surface.

    95th percentile by area, in radians from 0 to π/2, of spheres (V, 5) at the vertices. Faces
    of three planes count as π/2.

    Notes
    -----
    The axis of three spheres, the line of their two common points, is normal to the plane of
    their centres: ``A B' x B'' + A' B'' x B + A'' B x B'``. Whatever conjugate net a congruence
    has, its axes are those.
    """
    check_triangles(mesh)
    corners = mesh.corners.reshape(-1, 3)
    rows = recenter(spheres[corners], face_centroids(mesh)[:, None])
    a, b = rows[..., :1], rows[..., 1:4]
    crosses = np.cross(np.roll(b, -1, axis=1), np.roll(b, -2, axis=1))
    axes: FloatArray = (a * crosses).sum(axis=1)
    areas = face_vector_areas(mesh)
    angles = np.arctan2(norm(np.cross(axes, areas)), np.abs(dot(axes, areas)))
    angles[norm(axes) == 0] = np.pi / 2
    order = np.argsort(angles, kind="stable")
    passed = np.cumsum(norm(areas)[order])
    return float(angles[order][np.searchsorted(passed, 0.95 * passed[-1])])


def _checked_rows(surface: CongruenceMesh) -> FloatArray:
    """Unit rows seen from their vertex, in model units."""
    far = np.flatnonzero(np.abs(surface.rows[:, 4]) > 1)
    if len(far):
        raise InputError(
            f"the spheres of vertices {name_ids(far.tolist())} pass their vertices by more "
            "than a mean edge: give spheres that touch the surface"
        )
    return rescale(surface.rows, surface.size)


def _default_radius(mesh: Mesh, rows: FloatArray) -> float:
    first, second, _ = principal_curvatures(mesh)
    sharpest = float(np.percentile(np.maximum(np.abs(first), np.abs(second)), SHARPEST))
    if sharpest * mean_edge_length(mesh) <= FLATTEST:
        raise InputError("the surface is flat: give the radius of the spheres to relax to")
    return float(np.copysign(1 / (SHARPER * sharpest), rows[:, 0].sum()))
