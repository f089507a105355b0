"""
The Möbius group: similarities, inversions, their products, and what they do to everything.

A transform is a (5, 5) Lorentz matrix on pentaspherical coordinates: ``Mᵀ J M = J`` with
``J = diag(1, 1, 1, 1, -1)``. M and -M are the same map.

Orientation: a map takes sides along. The side of a sphere to which N points goes to the side to
which N points of the image, so that outside stays outside (the image of it, even where the
centre of an inversion lies inside). An inversion turns right into left: faces keep their ids,
but the order of their vertices is reversed, so that N agrees with the normal of the face again.
Edges are therefore numbered anew.

The formulas are those of Section 2 of the paper "Meshes with Spherical Faces".
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from .arcs import Arcs
from .arrays import BoolArray, FloatArray, dot, norm, sum_by, unit
from .circles import Circles, PencilKind, pencil_kind
from .errors import InputError, name_ids
from .lorentz import (
    SIGNATURE,
    LocalMap,
    after,
    bend_vectors,
    make_local,
    offset_images,
    point_images,
    read_matrix,
    row_images,
    to_matrix,
    turn_vectors,
)
from .mesh import Mesh, face_centroids, face_normals, local_corners, mean_edge_length
from .sphere_mesh import SphereMesh
from .spheres import Kind, kind, minkowski, normalize, pentaspherical, recenter
from .tolerances import AT_INFINITY, EPSILON, LORENTZ


def check_transform(transform: ArrayLike) -> FloatArray:
    """
    Refuse a matrix that is no Möbius map.

    Parameters
    ----------
    transform : (5, 5) array_like of float
        The matrix, on pentaspherical coordinates.

    Returns
    -------
    (5, 5) float array
        The matrix.

    Raises
    ------
    InputError
        If the shape is wrong, an entry is not finite, or ``Mᵀ J M`` is not J; the message
        states by how much.
    """
    matrix = np.asarray(transform, float)
    if matrix.shape != (5, 5):
        raise InputError(f"a transform must have shape (5, 5), not {matrix.shape}")
    if not np.isfinite(matrix).all():
        raise InputError("the transform has entries that are not finite")
    defect = float(np.abs(matrix.T @ SIGNATURE @ matrix - SIGNATURE).max())
    size = float(max(1.0, np.abs(matrix).max() ** 2))
    if not defect <= LORENTZ * size:
        raise InputError(
            f"the transform is no Möbius map: MᵀJM differs from J by {defect:.3g}; build it "
            "with inversion, similarity and compose"
        )
    return matrix


def similarity(
    scale: float = 1.0, rotation: ArrayLike | None = None, translation: ArrayLike | None = None
) -> FloatArray:
    """
    The map ``x -> scale rotation x + translation``.

    Parameters
    ----------
    scale : float
        Positive factor.
    rotation : (3, 3) array_like of float, optional
        Orthogonal matrix; of determinant -1 it also reflects. None by default.
    translation : (3,) array_like of float, optional
        Shift, in model units. None by default.

    Returns
    -------
    (5, 5) float array
        The transform.

    Raises
    ------
    InputError
        If the scale is not positive, or the matrix is not orthogonal.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.1, the Möbius group as Lorentz matrices.

    Examples
    --------
    >>> lift = similarity(translation=[0, 0, 1])
    >>> map_points(np.zeros((1, 3)), lift).tolist()
    [[0.0, 0.0, 1.0]]
    """
    turn = np.asarray(np.eye(3) if rotation is None else rotation, float)
    shift = _vector(np.zeros(3) if translation is None else translation, "translation")
    _check_positive("scale", scale)
    if turn.shape != (3, 3):
        raise InputError(f"a rotation must have shape (3, 3), not {turn.shape}")
    defect = float(np.abs(turn.T @ turn - np.eye(3)).max())
    if not defect <= LORENTZ:
        raise InputError(f"the rotation is not orthogonal (RᵀR differs from 1 by {defect:.3g})")
    return to_matrix(make_local(np.zeros(3), shift, scale, turn, np.zeros(3)))


def inversion(center: ArrayLike, radius: float) -> FloatArray:
    """
    Inversion in a sphere: ``x -> c + r² (x - c) / |x - c|²``.

    Parameters
    ----------
    center : (3,) array_like of float
        Centre c, which is sent to infinity.
    radius : float
        Radius r of the sphere that stays in place.

    Returns
    -------
    (5, 5) float array
        The transform, its own inverse.

    Raises
    ------
    InputError
        If the centre is no point or the radius is not positive.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.1, Möbius transformations.

    Examples
    --------
    >>> map_points(np.array([[0.5, 0, 0]]), inversion([0, 0, 0], 1)).tolist()
    [[2.0, 0.0, 0.0]]
    """
    point = _vector(center, "centre")
    _check_positive("radius", radius)
    constant = (point @ point - radius**2) / (2 * radius)
    return _reflect_in(np.concatenate([[0.5 / radius], point / radius, [constant]]))


def reflection(row: ArrayLike) -> FloatArray:
    """
    Reflection ``s -> s - 2 <<s, w>> w`` in a sphere (an inversion) or plane.

    Parameters
    ----------
    row : (5,) array_like of float
        Real row w of any scale.

    Returns
    -------
    (5, 5) float array
        The transform, its own inverse.

    Raises
    ------
    InputError
        If the row is a point or an imaginary sphere.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.1, reflection in a hyperplane.
    """
    mirror = np.asarray(row, float)
    if mirror.shape != (5,) or not np.isfinite(mirror).all():
        raise InputError("a mirror must be one row of 5 finite numbers")
    if int(kind(mirror)) not in {int(Kind.SPHERE), int(Kind.PLANE)}:
        raise InputError(
            "only real spheres and planes are mirrors, not points or imaginary ones"
        )
    return _reflect_in(normalize(mirror))


def _reflect_in(unit_row: FloatArray) -> FloatArray:
    mirror = pentaspherical(unit_row)
    return np.eye(5) - 2 * (mirror[:, None] * mirror) * np.diag(SIGNATURE)


def rotation_about(vector: ArrayLike) -> FloatArray:
    """
    Rotation about an axis through the origin.

    Parameters
    ----------
    vector : (3,) array_like of float
        Axis times angle, in radians, counter-clockwise seen against the axis.

    Returns
    -------
    (3, 3) float array
        Orthogonal matrix of determinant 1.

    Raises
    ------
    InputError
        If it is no vector of finite numbers.
    """
    turn = _vector(vector, "rotation")
    angle = float(norm(turn))
    x, y, z = unit(turn)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + 2 * np.sin(angle / 2) ** 2 * cross @ cross


def compose(transforms: Sequence[ArrayLike]) -> FloatArray:
    """
    Maps one after another.

    Parameters
    ----------
    transforms : sequence of (5, 5) array_like of float
        Transforms, applied first to last; none of them give the identity.

    Returns
    -------
    (5, 5) float array
        The transform.

    Raises
    ------
    InputError
        If one is no Möbius map; the message names it.

    Notes
    -----
    Similarities and reflections far from the origin come out without loss. The matrix of any
    other map, of stretch 1 at distance r from the point sent to infinity and both at distance
    D from the origin, is rounded by about ``ε D⁴ / r²`` (in model units): there, apply one
    transform after another.
    """
    local = _read(np.eye(5))
    for place, transform in enumerate(transforms):
        try:
            local = after(_read(transform), local)
        except InputError as error:
            raise InputError(f"transform {place}: {error}") from None
    return to_matrix(local)


def inverse(transform: ArrayLike) -> FloatArray:
    """
    The map that undoes another.

    Parameters
    ----------
    transform : (5, 5) array_like of float
        The transform.

    Returns
    -------
    (5, 5) float array
        ``J Mᵀ J``, exactly.

    Raises
    ------
    InputError
        If it is no Möbius map.
    """
    return SIGNATURE @ check_transform(transform).T @ SIGNATURE


def is_orthogonal(s: FloatArray, t: FloatArray) -> BoolArray:
    """
    Whether spheres meet at a right angle: ``<<s, t>> = 0`` up to rounding.

    Parameters
    ----------
    s, t : (..., 5) float array
        Real rows of any scale.

    Returns
    -------
    (...) bool array
        True where they do.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.1.
    """
    terms = norm(s[..., 1:4]) * norm(t[..., 1:4])
    terms = terms + 2 * np.abs(s[..., 0] * t[..., 4]) + 2 * np.abs(s[..., 4] * t[..., 0])
    return np.abs(minkowski(s, t)) <= 64 * EPSILON * terms


def is_tangent(s: FloatArray, t: FloatArray) -> BoolArray:
    """
    Whether spheres touch: ``<<s, t>>² = <<s, s>> <<t, t>>`` up to rounding.

    Parameters
    ----------
    s, t : (..., 5) float array
        Real rows of any scale.

    Returns
    -------
    (...) bool array
        True where they touch, in either orientation, or are the same.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.1.
    """
    return pencil_kind(s, t) == PencilKind.PARABOLIC


def polar_hyperplane(omega: FloatArray) -> FloatArray:
    """
    Covector of the rows orthogonal to a row: s with ``<<s, ω>> = covector · s = 0``.

    Parameters
    ----------
    omega : (..., 5) float array
        Rows: spheres (real or imaginary), planes or points.

    Returns
    -------
    (..., 5) float array
        ``(-2 C, B, -2 A)``; for a point the spheres through it.

    References
    ----------
    Meshes with Spherical Faces, Sec. 2.1, polarity.
    """
    return omega[..., ::-1][..., [0, 3, 2, 1, 4]] * np.array([-2.0, 1, 1, 1, -2.0])


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
    local = _read(transform)
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
    vectors, rounding = bend_vectors(_read(transform), np.asarray(points, float))
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
    local = _read(transform)
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
    local = _read(transform)
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
    local = _read(transform)
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
    return _image_mesh(mesh, _read(transform))


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
    local, mesh = _read(transform), sphere_mesh.mesh
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
    corners = mesh.corners
    if local.reverses:
        faces = mesh.topology.corner_faces
        firsts = mesh.offsets[:-1][faces]
        place = (firsts - np.arange(len(corners))) % mesh.degrees[faces]
        corners = corners[firsts + place]
    return Mesh(point_images(local, mesh.vertices), np.split(corners, mesh.offsets[1:-1]))


def _read(transform: ArrayLike) -> LocalMap:
    return read_matrix(check_transform(transform))


def _vector(value: ArrayLike, name: str) -> FloatArray:
    vector = np.asarray(value, float)
    if vector.shape != (3,) or not np.isfinite(vector).all():
        raise InputError(f"the {name} must be 3 finite numbers")
    return vector


def _check_positive(name: str, value: float) -> None:
    if not (np.isfinite(value) and value > 0):
        raise InputError(f"the {name} must be positive and finite, not {value}")


def _refuse(is_bad: BoolArray, message: str) -> None:
    if np.any(is_bad):
        raise InputError(message.format(name_ids(np.flatnonzero(is_bad).tolist())))
