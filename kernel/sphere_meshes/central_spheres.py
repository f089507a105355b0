"""Central and principal spheres of circular meshes.

Two neighbouring circular faces share two vertices, so both of their circles lie on one sphere:
the sphere of their edge. It belongs to the pencil of either circle and estimates the curvature
across the edge. Bisecting the spheres of two opposite edges gives the principal sphere of a
quad in that direction, bisecting its two principal spheres the central sphere. All of this is
made of circles and angles: it commutes with Möbius maps.
"""

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, sum_by, unit
from ..errors import InputError, name_ids
from ..meshes.mesh import Mesh, face_centroids, local_corners, mean_edge_length
from ..solvers.weighted_graphs import piece_labels, weighted_graph
from ..spheres.circles import Circles, circle_pencils, face_circles, pencil_spheres
from ..spheres.minkowski import minkowski
from ..spheres.rows import recenter
from ..tolerances import CIRCULAR
from .sphere_mesh import SphereMesh

NAMED_FACES = 4


def edge_spheres(mesh: Mesh) -> FloatArray:
    """Sphere of each interior edge of a circular mesh, through the circles of its two faces.

    Unit rows (E, 5), planes included, in the coordinates local to the edge: seen from the
    middle of its two vertices, with the axes of the model. N agrees with the normal of the
    first face. Where both faces have the same circle, its plane.

    Raises
    ------
    InputError
        If a face has no area or no circumcircle; the message names the worst faces, their
        miss and the tolerance.

    References
    ----------
    Meshes with Spherical Faces, Sec. 6.1, Fig. 22 (left).
    """
    topology = mesh.topology
    circles = _circumcircles(mesh)
    angles, is_known = _edge_angles(mesh, circles)
    half_edges = topology.edge_corners
    faces = topology.edge_faces[:, 0]
    planes, great_spheres = circle_pencils(circles)
    used = np.where(is_known, angles, 0.0)[half_edges]
    rows = pencil_spheres(planes[faces], great_spheres[faces], used)
    corners = local_corners(mesh)
    middles = (corners + corners[topology.next_corners]) / 2
    return recenter(rows, middles[half_edges])


def bisectors(s: FloatArray, t: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Both spheres that bisect the angles of two spheres.

    Of unit rows (..., 5) that meet, seen from near their circle: ``ε s + t`` for the smaller
    angle, with ε the sign of ``<<s, t>>``, orthogonal rows counting as ε = +1, since then both
    angles are the smaller one; and ``ε s - t`` for the larger angle, orthogonal to the first.
    NaN where the spheres are the same or do not meet: then nothing is bisected.

    Notes
    -----
    Unit rows carry the weights ``1 / r`` of the printed lemma, and planes do not need radii.

    References
    ----------
    Meshes with Spherical Faces, Lemma 6.1, with sign(0) = +1.
    """
    acute = _acute_bisector(s, t)
    sign = np.where(minkowski(s, t) < 0, -1.0, 1.0)
    difference = sign[..., None] * s - t
    square = minkowski(difference, difference)
    with np.errstate(divide="ignore", invalid="ignore"):
        obtuse = difference / np.sqrt(np.where(square > 0, square, np.nan))[..., None]
    return acute, obtuse


def _acute_bisector(s: FloatArray, t: FloatArray) -> FloatArray:
    product = minkowski(s, t)
    total = np.where(product < 0, -1.0, 1.0)[..., None] * s + t
    return total / np.sqrt(2 + 2 * np.abs(product))[..., None]


def principal_spheres(mesh: Mesh) -> tuple[SphereMesh, SphereMesh]:
    """Discrete principal spheres: one per quad and direction.

    Parameters
    ----------
    mesh : Mesh
        A circular mesh of quads.

    Returns
    -------
    first, second : SphereMesh
        The sphere that bisects the smaller angle of the spheres of two opposite edges, through
        the circle of the face. On the boundary the sphere of the one edge there is; in a
        direction without neighbours that of the other direction; for a lone face its plane.
        In the first face of each connected piece `first` goes across the sides that leave
        corners 0 and 2, `second` across the other two; the neighbours follow along the strips
        of quads. Around vertices of odd valence no such choice is continuous.

    Raises
    ------
    InputError
        If a face is no quad, has no area or no circumcircle; the message names the faces.

    References
    ----------
    Meshes with Spherical Faces, Sec. 6.1, Fig. 22 (left).
    """
    others = np.flatnonzero(mesh.degrees != 4)
    if len(others):
        raise InputError(
            f"faces {name_ids(others.tolist())} are no quads: principal spheres need two pairs "
            "of opposite edges; use central spheres, which any face has"
        )
    circles = _circumcircles(mesh)
    pairs = _principal_rows(mesh, circles, np.arange(mesh.n_faces))
    turned = _direction_labels(mesh)
    rows = np.arange(mesh.n_faces)
    return (
        SphereMesh.from_local(mesh, pairs[rows, turned]),
        SphereMesh.from_local(mesh, pairs[rows, 1 - turned]),
    )


def central_spheres(mesh: Mesh) -> SphereMesh:
    """Discrete central spheres: the Möbius-invariant mean of the curvatures at each face.

    On quads of a circular mesh the sphere that bisects the smaller angle of the two principal
    spheres (see `principal_spheres`, also for the boundary). On other faces the sphere S
    through the circle with the largest sum of ``<<S, s>>²`` over the spheres s of the edges.
    Exact on meshes inscribed in a sphere; commutes with Möbius maps. Only a face without a
    neighbour on another circle gets its plane, which does not.

    Raises
    ------
    InputError
        If a face has no area or no circumcircle; the message names the worst faces, their
        miss and the tolerance.

    Notes
    -----
    On a net of curvature lines of size h the error of the curvature is of order h² inside and
    of order h on the boundary, where one edge stands for two.

    References
    ----------
    Meshes with Spherical Faces, Sec. 6.1, Fig. 22. The rule for other faces is not in the
    paper.
    """
    circles = _circumcircles(mesh)
    planes, _ = circle_pencils(circles)
    is_quad = mesh.degrees == 4
    rows = _mean_rows(mesh, circles)
    pairs = _principal_rows(mesh, circles, np.flatnonzero(is_quad))
    rows[is_quad] = _acute_bisector(pairs[:, 0], pairs[:, 1])
    return SphereMesh.from_local(mesh, _oriented(rows, planes))


def _circumcircles(mesh: Mesh) -> Circles:
    """Circles of the faces, all of which must have one."""
    circles, miss = face_circles(mesh)
    relative = miss / mean_edge_length(mesh)
    bad = np.flatnonzero(relative > CIRCULAR)
    if len(bad):
        worst = bad[np.argsort(-relative[bad], kind="stable")[:NAMED_FACES]]
        names = ", ".join(f"{face} ({relative[face]:.2g})" for face in worst)
        raise InputError(
            f"{len(bad)} of {mesh.n_faces} faces have no circumcircle; the worst are faces "
            f"{names}: their vertices miss the best circle by that many mean edges, and "
            f"{CIRCULAR:g} is the tolerance. Make the mesh circular, or start from fit_spheres"
        )
    return circles


def _edge_angles(mesh: Mesh, circles: Circles) -> tuple[FloatArray, BoolArray]:
    """Unknown t of the edge sphere in the pencil of the face of each half-edge.

    Both axes lie in the plane that bisects the edge: where they meet is the centre of the
    sphere. Unknown on the boundary, and where both faces have the same circle.
    """
    topology = mesh.topology
    faces, twins = topology.corner_faces, topology.twins
    others = faces[twins]
    corners = local_corners(mesh)
    along = unit(corners[topology.next_corners] - corners)
    centroids = face_centroids(mesh)
    across = centroids[others] - centroids[faces]
    across = across + circles.centers[others] - circles.centers[faces]
    n, m = circles.normals[faces], circles.normals[others]
    turn = np.sqrt(circles.radii_squared)[faces] * dot(along, np.cross(n, m))
    reach = dot(along, np.cross(across, m))
    is_known = (twins >= 0) & (np.hypot(turn, reach) > CIRCULAR * mean_edge_length(mesh))
    # An angle and its opposite are one sphere: N shall agree with the face.
    side = np.where(reach < 0, -1.0, 1.0)
    return np.arctan2(side * turn, side * reach), is_known


def _principal_rows(mesh: Mesh, circles: Circles, quads: IntArray) -> FloatArray:
    """Principal spheres (n, 2, 5) of quads, across sides 0 and 2, and across 1 and 3."""
    angles, is_known = _edge_angles(mesh, circles)
    planes, great_spheres = (row[quads] for row in circle_pencils(circles))
    sides = mesh.offsets[quads][:, None] + np.arange(4)
    rows = pencil_spheres(planes[:, None], great_spheres[:, None], angles[sides])
    known = is_known[sides]
    first, second = rows[:, :2], rows[:, 2:]
    pairs = _acute_bisector(
        np.where(known[:, :2, None], first, second), np.where(known[:, 2:, None], second, first)
    )
    has_direction = (known[:, :2] | known[:, 2:])[..., None]
    pairs = np.where(has_direction, pairs, pairs[:, ::-1])
    pairs = np.where(has_direction.any(axis=1, keepdims=True), pairs, planes[:, None])
    return _oriented(pairs, planes[:, None])


def _mean_rows(mesh: Mesh, circles: Circles) -> FloatArray:
    """Member of each face's pencil with the largest sum of squared products with its edges.

    That sum is constant plus half of ``cos 2t sum(cos 2t') + sin 2t sum(sin 2t')``.
    """
    angles, is_known = _edge_angles(mesh, circles)
    faces = mesh.topology.corner_faces
    doubled = np.stack([np.cos(2 * angles), np.sin(2 * angles)], 1) * is_known[:, None]
    cosine, sine = sum_by(faces, doubled, mesh.n_faces).T
    return pencil_spheres(*circle_pencils(circles), np.arctan2(sine, cosine) / 2)


def _oriented(rows: FloatArray, planes: FloatArray) -> FloatArray:
    """The same spheres, N on the side of the face normal."""
    return np.where(minkowski(rows, planes) < 0, -1.0, 1.0)[..., None] * rows


def _direction_labels(mesh: Mesh) -> IntArray:
    """Direction (0 or 1) of each quad that continues direction 0 of its piece's first quad.

    Each quad has two nodes, one per direction; along a spanning tree of the quads they fall
    apart into two sets per piece.
    """
    from scipy.sparse.csgraph import minimum_spanning_tree

    topology, count = mesh.topology, mesh.n_faces
    pairs, edges = np.unique(np.sort(topology.edge_faces, axis=1), axis=0, return_index=True)
    graph = weighted_graph(1.0 + edges.astype(np.float64), pairs[:, 0], pairs[:, 1], count)
    tree = minimum_spanning_tree(graph).data.astype(np.int64) - 1
    sides = np.arange(len(mesh.corners)) - mesh.offsets[topology.corner_faces]
    first = topology.edge_corners[tree]
    swaps = (sides[first] + sides[topology.twins[first]]) % 2
    left, right = topology.edge_faces[tree].T
    starts = np.concatenate([left, left + count])
    ends = np.concatenate([right + swaps * count, right + (1 - swaps) * count])
    sets, pieces = (
        piece_labels(starts, ends, 2 * count),
        piece_labels(pairs[:, 0], pairs[:, 1], count),
    )
    _, roots, piece = np.unique(pieces, return_index=True, return_inverse=True)
    return (sets[:count] != sets[roots[piece]]).astype(np.int64)
