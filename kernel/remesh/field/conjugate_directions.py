"""Conjugate directions at the vertices of a triangulated sphere congruence."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import BoolArray, FloatArray, IntArray, dot, norm, unit
from ...meshes.mesh import Mesh
from ...meshes.vertex_fans import vertex_fans
from ...tolerances import UMBILIC
from .congruence_mesh import CongruenceMesh, congruence_mesh
from .conjugate_form import UndeterminedError, anisotropy, conjugate_field, form_roots
from .frames import comb_frames
from .jets import CongruenceJets, expected_node_axes, fit_jets
from .smoothing import orient_forms


@dataclass(frozen=True)
class ConjugateDirections:
    """The conjugate net of a congruence, to first order.

    Attributes
    ----------
    directions : (V, 2, 3) float array
        Unit tangents; the turn from the first to the second is counter-clockwise, seen from the
        normal, and less than π. Each is a line: its sign has no meaning.
    is_real : (V,) bool array
        False where the directions are complex: given are those of the nearest form whose two
        directions are real, which then coincide.
    complex_share : float
        Share of the area whose directions are complex.
    umbilic_share : float
        Share of the area on which all pairs of orthogonal directions are all but conjugate.
    singular : (s,) int array
        Vertices around which the directions turn.
    indices : (s,) int array
        How often, in half turns.
    axis_angles : (V,) float array
        Angle between the normal and the axis that a node would have there, in radians; NaN
        where the congruence fixes no axis, as planes.
    curvatures : (V,) float array
        Signed curvatures of the spheres, in inverse model units.
    degree : int
        Degree of the polynomials that were fitted to the spheres.
    """

    directions: FloatArray
    is_real: BoolArray
    complex_share: float
    umbilic_share: float
    singular: IntArray
    indices: IntArray
    axis_angles: FloatArray
    curvatures: FloatArray
    degree: int


def conjugate_directions(
    mesh: Mesh, spheres: ArrayLike, degree: int | None = None, rings: int = 4
) -> ConjugateDirections:
    """Directions in which neighbouring spheres of an SQ-mesh with support structure follow.

    Parameters
    ----------
    spheres : (V, 5) array_like of float
        A real sphere or plane for every vertex, in model coordinates.
    degree : int, optional
        Degree of the polynomials that are fitted to the spheres, from 2 to 7; by default the
        one with the least expected error.
    rings : int
        Rings of neighbours that they are fitted to.

    Returns
    -------
    ConjugateDirections
        Directions, where they are complex or singular, and what nodes to expect.

    Raises
    ------
    InputError
        If the mesh or the spheres cannot be used.

    References
    ----------
    Meshes with Spherical Faces, Sec. 6.4, eq. (12).
    """
    surface = congruence_mesh(mesh, spheres)
    jets, heights, fitted = fit_jets(surface, degree, rings)
    trace, deviator = orient_forms(surface, *conjugate_field(jets))
    first, second, is_real = form_roots(trace, deviator)
    angles = np.stack([first, second], 1)[..., None]
    frames = surface.vertex_frames
    tangents = frames[:, :2] + heights[:, 1:3, None] * frames[:, 2:]
    directions = unit(
        np.cos(angles) * tangents[:, None, 0] + np.sin(angles) * tangents[:, None, 1]
    )
    areas = surface.vertex_areas
    fans = vertex_fans(
        surface.topology, surface.triangles.ravel(), np.arange(len(surface.points))
    )
    indices = comb_frames(surface, fans, trace, deviator, 0.0).indices
    singular = np.flatnonzero(indices)
    return ConjugateDirections(
        directions, is_real, float(areas[~is_real].sum() / areas.sum()),
        umbilic_share(surface, jets), singular, indices[singular],
        expected_axis_angles(surface, jets), 2 * surface.rows[:, 0] / surface.size, fitted,
    )  # fmt: skip


def complex_share(mesh: Mesh, spheres: ArrayLike) -> float:
    """Share of the area on which a congruence has no real conjugate net.

    The spheres are real rows (V, 5), planes included, in model coordinates. The share is 1 if
    they determine no directions at all, as planes.

    Raises
    ------
    InputError
        If the mesh or the spheres cannot be used.
    """
    try:
        return conjugate_directions(mesh, spheres).complex_share
    except UndeterminedError:
        return 1.0


def umbilic_share(surface: CongruenceMesh, jets: CongruenceJets) -> float:
    """Share of the area on which a congruence does not tell its conjugate directions.

    It is 1 on a sphere with spheres of one radius; 0 on other surfaces, but for single points.
    """
    areas = surface.vertex_areas
    return float(areas[anisotropy(jets) < UMBILIC].sum() / areas.sum())


def expected_axis_angles(surface: CongruenceMesh, jets: CongruenceJets) -> FloatArray:
    """Angles between the normals of a surface and the node axes of a net on it.

    (V,) radians, at most π / 2; NaN where the congruence fixes no axis.
    """
    axes, normals = expected_node_axes(jets), surface.vertex_frames[:, 2]
    angles = np.arctan2(norm(np.cross(axes, normals)), np.abs(dot(axes, normals)))
    return np.where(norm(axes) > 0, angles, np.nan)
