"""A sphere for every face to start from, and spheres and planes one by one."""

from typing import Annotated, NamedTuple

import numpy as np

from ...kernel.meshes.mesh import Mesh, edge_middles
from ...kernel.sphere_meshes import central_spheres as central
from ...kernel.sphere_meshes import fit
from ...kernel.sphere_meshes import smoothed_spheres as smoothing
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...kernel.spheres import circles, minkowski, rows
from ..graphs.node import node
from ..graphs.ports import Port
from .arrays import Angles, EdgeSpheres, Marks, Names, Numbers, Points, Quadruples, Spheres


class PrincipalSpheres(NamedTuple):
    """Two sphere meshes, one per direction."""

    first: SphereMesh
    second: SphereMesh


@node
def face_planes(mesh: Mesh) -> SphereMesh:
    """The plane of every face: the start that any mesh allows, and the one to compare with.

    Parameters
    ----------
    mesh : Mesh

    Returns
    -------
    SphereMesh
        Planes through the centroids of the faces.

    Examples
    --------
    >>> from spheremesh.nodes import face_planes, intersection_angles, vase_mesh
    >>> angles = intersection_angles(face_planes(vase_mesh(12, 6)))
    >>> float(angles.mean().round(1))
    24.9
    """
    return fit.face_planes(mesh)


@node
def fit_spheres(mesh: Mesh, ring: Annotated[int, Port(min=0, max=10)] = 1) -> SphereMesh:
    """Spheres by least squares on each face and the faces around it.

    Parameters
    ----------
    mesh : Mesh
    ring : int
        How many rings of faces around each face take part.

    Returns
    -------
    SphereMesh
        On circular faces spheres through the circle, else the best of all (Pratt's norm).

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, vase_mesh, vertex_error
    >>> sphere_mesh = fit_spheres(vase_mesh(12, 6))
    >>> sphere_mesh.spheres.shape, bool((vertex_error(sphere_mesh) < 1e-12).all())
    ((72, 5), True)
    """
    return fit.fit_spheres(mesh, ring)


@node
def central_spheres(mesh: Mesh) -> SphereMesh:
    """Spheres of the mean curvature at each face of a circular mesh: close to the optimum.

    Parameters
    ----------
    mesh : Mesh
        Every face needs a circumcircle; quads along curvature lines are best.

    Returns
    -------
    SphereMesh
        Discrete central spheres: a Möbius map of the mesh maps them along.

    Examples
    --------
    >>> from spheremesh.nodes import central_spheres, intersection_angles, vase_mesh
    >>> angles = intersection_angles(central_spheres(vase_mesh(12, 6)))
    >>> float(angles.mean().round(1))
    15.5
    """
    return central.central_spheres(mesh)


@node
def smoothed_spheres(mesh: Mesh) -> SphereMesh:
    """Spheres through the circle of each face and an apex above it, placed by smoothing.

    Parameters
    ----------
    mesh : Mesh
        Faces of any degree; those without a circumcircle take the best circle.

    Returns
    -------
    SphereMesh
        Spheres somewhat flatter than the central ones.

    Examples
    --------
    >>> from spheremesh.nodes import intersection_angles, smoothed_spheres, vase_mesh
    >>> angles = intersection_angles(smoothed_spheres(vase_mesh(12, 6)))
    >>> float(angles.mean().round(1))
    18.3
    """
    return smoothing.smoothed_spheres(mesh)


@node
def principal_spheres(mesh: Mesh) -> PrincipalSpheres:
    """Spheres that follow the curvature of a circular quad mesh in one direction each.

    Parameters
    ----------
    mesh : Mesh
        Quads, every one with a circumcircle.

    Returns
    -------
    first : SphereMesh
        Spheres of the curvature across two opposite sides of each quad, in the same direction
        along every strip of quads.
    second : SphereMesh
        Those across the other two sides.

    Examples
    --------
    >>> from spheremesh.nodes import intersection_angles, principal_spheres, vase_mesh
    >>> first, second = principal_spheres(vase_mesh(12, 6))
    >>> [float(intersection_angles(kind).mean().round(1)) for kind in (first, second)]
    [16.8, 14.6]
    """
    return PrincipalSpheres(*central.principal_spheres(mesh))


@node
def edge_spheres(mesh: Mesh) -> EdgeSpheres:
    """Spheres of the edges of a circular mesh: through the circles of both faces.

    Parameters
    ----------
    mesh : Mesh
        Every face needs a circumcircle.

    Returns
    -------
    (E, 5) float array
        Rows over the interior edges, whose normals agree with the first face of each. Opposite
        ones of a quad are bisected by its principal spheres.

    Examples
    --------
    >>> from spheremesh.nodes import edge_spheres, sphere_facts, torus_mesh
    >>> spheres = edge_spheres(torus_mesh(12, 6, major_radius=3.0))
    >>> len(spheres), set(sphere_facts(spheres).kinds.tolist())
    (144, {'sphere'})
    """
    return rows.recenter(central.edge_spheres(mesh), -edge_middles(mesh))


class SphereFacts(NamedTuple):
    """What rows stand for."""

    centers: Points
    radii_squared: Numbers
    kinds: Names


class SpherePairs(NamedTuple):
    """How spheres meet."""

    angles: Angles
    pencils: Names
    is_orthogonal: Marks
    is_tangent: Marks


class Bisectors(NamedTuple):
    """Both bisectors of pairs of spheres."""

    acute: Spheres
    obtuse: Spheres


@node
def sphere_rows(centers: Points, radii: float | Numbers) -> Spheres:
    """Rows (A, Bx, By, Bz, C) of spheres: the points x with A x·x - B·x + C = 0.

    Parameters
    ----------
    centers : (N, 3) float array
    radii : float or (N,) float array
        Not zero.

    Returns
    -------
    (N, 5) float array
        Rows with B·B - 4 A C = 1, whose normals point to the centres; minus the row is the
        sphere with normals outwards.

    Examples
    --------
    >>> import numpy as np
    >>> from spheremesh.nodes import sphere_rows
    >>> sphere_rows(np.zeros((1, 3)), 2.0).tolist()
    [[0.25, 0.0, 0.0, 0.0, -1.0]]
    """
    radii = np.asarray(radii, float)[..., None]
    centers, radii = np.broadcast_arrays(np.asarray(centers, float), radii)
    return rows.normalize(rows.from_center_radius(centers, radii[..., 0] ** 2))


@node
def plane_rows(normals: Points, distances: float | Numbers) -> Spheres:
    """Rows (0, n, d) of the planes n·x = d.

    Parameters
    ----------
    normals : (N, 3) float array
        Unit normals.
    distances : float or (N,) float array
        Signed distances of the origin, along the normals.

    Returns
    -------
    (N, 5) float array
        Rows with A = 0.

    Examples
    --------
    >>> import numpy as np
    >>> from spheremesh.nodes import plane_rows
    >>> plane_rows(np.array([[0.0, 0.0, 1.0]]), 3.0).tolist()
    [[0.0, 0.0, 0.0, 1.0, 3.0]]
    """
    return rows.from_plane(normals, np.asarray(distances, float))


@node
def sphere_facts(spheres: Spheres) -> SphereFacts:
    """Centres, squared radii and kinds of rows.

    Parameters
    ----------
    spheres : (N, 5) float array
        Rows of any scale.

    Returns
    -------
    centers : (N, 3) float array
        Infinite for planes.
    radii_squared : (N,) float array
        Infinite for planes, negative for imaginary spheres.
    kinds : (N,) str array
        "sphere", "plane", "point" or "imaginary".

    Examples
    --------
    >>> import numpy as np
    >>> from spheremesh.nodes import plane_rows, sphere_facts
    >>> sphere_facts(plane_rows(np.array([[0.0, 0.0, 1.0]]), 3.0)).kinds.tolist()
    ['plane']
    """
    names = np.array([kind.name.lower() for kind in rows.Kind])
    return SphereFacts(*rows.center_radius(spheres), names[rows.kind(spheres)])


@node
def sphere_pairs(first: Spheres, second: Spheres) -> SpherePairs:
    """Angles at which spheres or planes meet, and the pencils that they span.

    Parameters
    ----------
    first, second : (N, 5) float array
        Unit rows of real spheres or planes.

    Returns
    -------
    angles : (N,) float array in deg
        Between the normals, from 0 to 180; 0 or 180 also where they do not meet.
    pencils : (N,) str array
        "elliptic" (they meet in a circle), "parabolic" (in a point) or "hyperbolic" (not).
    is_orthogonal, is_tangent : (N,) bool array
        Up to rounding.

    Examples
    --------
    >>> import numpy as np
    >>> from spheremesh.nodes import sphere_pairs, sphere_rows
    >>> sphere_pairs(*sphere_rows(np.array([[0.0, 0, 0], [0, 0, 4]]), 2.0)[:, None]).pencils
    array(['parabolic'], dtype='<U10')
    """
    kinds = circles.pencil_kind(first, second)
    names = np.array([kind.name.lower() for kind in circles.PencilKind])
    return SpherePairs(
        np.degrees(minkowski.angle(first, second)),
        names[kinds],
        minkowski.is_orthogonal(first, second),
        kinds == circles.PencilKind.PARABOLIC,
    )


@node
def bisectors(first: Spheres, second: Spheres) -> Bisectors:
    """Both spheres that bisect the angles of two spheres or planes.

    Parameters
    ----------
    first, second : (N, 5) float array
        Unit rows of spheres or planes that meet.

    Returns
    -------
    acute, obtuse : (N, 5) float array
        Unit rows of the bisectors of the smaller and of the larger angle, orthogonal to each
        other; NaN where nothing is bisected.

    Examples
    --------
    >>> import numpy as np
    >>> from spheremesh.nodes import bisectors, plane_rows
    >>> bisectors(*plane_rows(np.eye(3)[:2], 0.0)[:, None]).acute.round(3).tolist()
    [[0.0, 0.707, 0.707, 0.0, 0.0]]
    """
    return Bisectors(*central.bisectors(first, second))


@node
def intersection_circles(first: Spheres, second: Spheres) -> circles.Circles:
    """Circles in which spheres meet.

    Parameters
    ----------
    first, second : (N, 5) float array
        Unit rows; at most one of two is a plane.

    Returns
    -------
    Circles
        Centres, normals from the first centre to the second, and squared radii; negative where
        the spheres do not meet.

    Examples
    --------
    >>> import numpy as np
    >>> from spheremesh.nodes import intersection_circles, sphere_rows
    >>> balls = sphere_rows(np.array([[0.0, 0, 0], [0, 0, 2]]), np.sqrt(2))
    >>> intersection_circles(*balls[:, None]).radii_squared.round(9).tolist()
    [1.0]
    """
    return circles.intersection_circles(first, second)


@node
def sphere_through_points(points: Quadruples) -> Spheres:
    """Spheres or planes through four points.

    Parameters
    ----------
    points : (N, 4, 3) float array
        Points, no four on a circle.

    Returns
    -------
    (N, 5) float array
        Unit rows of either orientation; NaN where the points coincide.

    Examples
    --------
    >>> import numpy as np
    >>> from spheremesh.nodes import sphere_facts, sphere_through_points
    >>> corners = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0]])
    >>> sphere_facts(sphere_through_points(corners[None])).radii_squared.round(9).tolist()
    [1.0]
    """
    return circles.sphere_through_points(points)
