"""
Möbius maps at work: on points, spheres, circles, arcs, meshes and sphere meshes.

Everything is mapped in closed form about its own place (`kernel.lorentz`); the matrix is never
multiplied onto geometry, which would lose digits with the fourth power of the distance. What
happens to orientation is said in `kernel.mobius`.
"""

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import BoolArray, FloatArray, dot, norm, sum_by, unit
from ..errors import InputError, name_ids
from ..meshes.mesh import (
    Mesh,
    face_centroids,
    face_normals,
    local_corners,
    mean_edge_length,
    reversed_corners,
)
from ..spheres.arcs import Arcs
from ..spheres.circles import Circles
from ..spheres.lorentz import (
    LocalMap,
    bend_vectors,
    offset_images,
    point_images,
    row_images,
    turn_vectors,
)
from ..spheres.mobius import read_transform
from ..spheres.rows import recenter
from ..tolerances import AT_INFINITY, EPSILON
from .sphere_mesh import SphereMesh


def map_spheres(rows: FloatArray, transform: ArrayLike) -> FloatArray:
    """
    Images of spheres, planes and points seen as rows.

    Parameters
    ----------
    rows : (..., 5) float array
        Rows of any scale, in model coordinates.
    transform : (5, 5) array_like of float
        The transform.

    Returns
    -------
    (..., 5) float array
        Rows of the same norm, oriented so that sides are kept; exactly A = 0 where a sphere
        passes, within rounding, through the point sent to infinity.

    Raises
    ------
    InputError
        If the transform is no Möbius map.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.1.
    """
    local = read_transform(transform)
    near = recenter(np.asarray(rows, float), local.origin)
    images = row_images(local, near, np.broadcast_to(local.origin, near[..., 1:4].shape))
    return recenter(images, -local.image)


def sent_to_infinity(points: FloatArray, transform: ArrayLike) -> BoolArray:
    """
    Which points have no image in space.

    Parameters
    ----------
    points : (..., 3) float array
        Points.
    transform : (5, 5) array_like of float
        The transform.

    Returns
    -------
    (...) bool array
        True for the centre of an inversion, up to rounding.

    Raises
    ------
    InputError
        If the transform is no Möbius map.
    """
    vectors, rounding = bend_vectors(read_transform(transform), np.asarray(points, float))
    return norm(vectors) <= rounding


def map_points(points: FloatArray, transform: ArrayLike) -> FloatArray:
    """
    Images of points.

    Parameters
    ----------
    points : (..., 3) float array
        Points.
    transform : (5, 5) array_like of float
        The transform.

    Returns
    -------
    (..., 3) float array
        Points.

    Raises
    ------
    InputError
        If a point is sent to infinity, which `sent_to_infinity` tells beforehand; the message
        names the rows. If the transform is no Möbius map.
    """
    points = np.asarray(points, float)
    local = read_transform(transform)
    vectors, rounding = bend_vectors(local, points)
    _refuse(norm(vectors) <= rounding, "points {} are sent to infinity; leave them out")
    return point_images(local, points)


def map_circles(circles: Circles, transform: ArrayLike) -> Circles:
    """
    Images of real circles.

    Parameters
    ----------
    circles : Circles
        Real circles, in model coordinates.
    transform : (5, 5) array_like of float
        The transform.

    Returns
    -------
    Circles
        Circles; going round about the normal stays going round about the normal.

    Raises
    ------
    InputError
        If a circle is imaginary, or its image a straight line; the message names them.

    Notes
    -----
    The curvature vector at a point of a curve, across its tangent, becomes
    ``rotation (κ + 2 g) / scale`` with g the bend there across the tangent.
    """
    local = read_transform(transform)
    centers, axes = np.asarray(circles.centers, float), circles.normals
    _refuse(~(circles.radii_squared > 0), "circles {} are imaginary or points")
    radii = np.sqrt(circles.radii_squared)[..., None]
    away, _ = bend_vectors(local, centers)
    flat = away - dot(away, axes)[..., None] * axes
    helper = np.eye(3)[np.argmin(np.abs(axes), axis=-1)]
    # Where the circle is farthest from the point sent to infinity.
    is_round = norm(flat) <= EPSILON * (1 + norm(away))
    outward = unit(np.where(is_round[..., None], np.cross(axes, helper), flat))
    bases = centers + radii * outward
    tangents = np.cross(axes, outward)
    vectors, _ = bend_vectors(local, bases)
    square = dot(vectors, vectors)[..., None]
    bends = local.strength * vectors / square
    bends = bends - dot(bends, tangents)[..., None] * tangents
    bent = 2 * bends - outward / radii
    size = 1 / radii[..., 0] + 2 * norm(bends)
    place = 1 + (norm(bases) + norm(local.origin)) * size
    is_line = norm(bent) <= 8 * EPSILON * size * place
    _refuse(is_line, "circles {} become straight lines; move the centre off them")
    curvature = turn_vectors(local, bases, bent) * square / local.scale
    tangents = turn_vectors(local, bases, tangents)
    length = dot(curvature, curvature)
    images = point_images(local, bases) + curvature / length[..., None]
    return Circles(images, np.cross(tangents, unit(curvature)), 1 / length)


def map_arcs(arcs: Arcs, transform: ArrayLike) -> Arcs:
    """
    Images of arcs, by their ends and their middle.

    Parameters
    ----------
    arcs : Arcs
        H arcs, in model coordinates.
    transform : (5, 5) array_like of float
        The transform.

    Returns
    -------
    Arcs
        Arcs from the images of the starts to those of the ends; `rises` points to the bulge.

    Raises
    ------
    InputError
        If an end is sent to infinity, or an image is more than a half circle (or passes
        through infinity), which no `Arcs` can hold; the message names them.
    """
    local = read_transform(transform)
    middles = (arcs.starts + arcs.ends) / 2 + arcs.sagittas[:, None] * arcs.rises
    for points in (arcs.starts, middles, arcs.ends):
        vectors, rounding = bend_vectors(local, points)
        _refuse(norm(vectors) <= rounding, "arcs {} pass through the point sent to infinity")
    first = offset_images(local, middles, arcs.starts - middles)
    last = offset_images(local, middles, arcs.ends - middles)
    # Start to middle to end turns by half of the sweep.
    turns = np.arctan2(norm(np.cross(-first, last)), dot(-first, last))
    _refuse(
        turns > np.pi / 2,
        "the images of arcs {} are more than half circles; move the centre away",
    )
    chords = last - first
    along = unit(chords)
    toward = -(first - dot(first, along)[:, None] * along)
    level = turn_vectors(local, middles, arcs.rises)
    level = unit(level - dot(level, along)[:, None] * along)
    is_straight = norm(toward) <= EPSILON * norm(chords)
    rises = np.where(is_straight[:, None], level, unit(toward))
    sagittas = np.tan(turns / 2) * norm(chords) / 2
    sagittas = np.where(is_straight, 0.0, sagittas)
    images = point_images(local, arcs.starts), point_images(local, arcs.ends)
    return Arcs(*images, rises, sagittas)


def map_mesh(mesh: Mesh, transform: ArrayLike) -> Mesh:
    """
    Image of a mesh: of its vertices, with straight sides between them.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    transform : (5, 5) array_like of float
        The transform.

    Returns
    -------
    Mesh
        Vertices and faces keep their ids. Where right and left change places each face starts
        at the same vertex and runs the other way, so its normal stays on the same side.

    Raises
    ------
    InputError
        If a vertex is sent to infinity, or so close to it (`AT_INFINITY`) that its image is of
        no use; the message names them. If the transform is no Möbius map.
    """
    return _image_mesh(mesh, read_transform(transform))


def map_sphere_mesh(sphere_mesh: SphereMesh, transform: ArrayLike) -> SphereMesh:
    """
    Image of a sphere mesh: spheres, vertices and the angles between the spheres.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.
    transform : (5, 5) array_like of float
        The transform.

    Returns
    -------
    SphereMesh
        Vertices and faces keep their ids, N agrees with the normal of the face as before, and
        neighbours meet at the same angles. Edges are numbered anew where faces run the other
        way.

    Raises
    ------
    InputError
        As `map_mesh`; and if the image of a face passes through infinity or is more than half
        a sphere, so that N would turn against the normal of the face. The message names them.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.
    """
    local, mesh = read_transform(transform), sphere_mesh.mesh
    image = _image_mesh(mesh, local)
    centroids, faces = face_centroids(mesh), mesh.topology.corner_faces
    too_near = "faces {} are too near the centre of the inversion; move it away"
    vectors, rounding = bend_vectors(local, centroids)
    _refuse(norm(vectors) <= rounding, too_near)
    steps = offset_images(local, centroids[faces], local_corners(mesh))
    shift = sum_by(faces, steps, mesh.n_faces) / mesh.degrees[:, None]
    rows = recenter(row_images(local, sphere_mesh.local_spheres, centroids), shift)
    before = dot(face_normals(mesh), sphere_mesh.local_spheres[:, 1:4])
    _refuse(before * dot(face_normals(image), rows[:, 1:4]) < 0, too_near)
    return SphereMesh.from_local(image, rows)


def _image_mesh(mesh: Mesh, local: LocalMap) -> Mesh:
    vectors, rounding = bend_vectors(local, mesh.vertices)
    reach = np.maximum(rounding, AT_INFINITY * local.strength * mean_edge_length(mesh))
    _refuse(norm(vectors) <= reach, "vertices {} are sent to infinity; move the centre away")
    corners = reversed_corners(mesh) if local.reverses else mesh.corners
    return Mesh(point_images(local, mesh.vertices), np.split(corners, mesh.offsets[1:-1]))


def _refuse(is_bad: BoolArray, message: str) -> None:
    if np.any(is_bad):
        raise InputError(message.format(name_ids(np.flatnonzero(is_bad).tolist())))
