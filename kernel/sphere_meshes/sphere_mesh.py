"""The sphere mesh: a mesh with a sphere for every face."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import FloatArray, dot, read_only, sum_by
from ..display import Shown, brief, polygons_text, radii_text, size_text
from ..errors import InputError, name_ids
from ..meshes.mesh import Mesh, face_centroids, face_normals, local_corners
from ..spheres.incidence import evaluate, signed_distance
from ..spheres.minkowski import angle, minkowski
from ..spheres.row_checks import check_rows
from ..spheres.rows import center_radius, from_center_radius, recenter
from ..tolerances import EPSILON


@dataclass(frozen=True, init=False, eq=False, repr=False)
class SphereMesh(Shown):
    """A mesh whose faces are pieces of spheres or planes.

    Parameters
    ----------
    mesh : Mesh
    spheres : (F, 5) array_like of float
        Real rows ``(A, Bx, By, Bz, C)`` of any positive scale, in model coordinates. N agrees
        with the normal of the face.

    Attributes
    ----------
    mesh : Mesh
    spheres : (F, 5) float array
        Unit rows in model coordinates; read-only.
    local_spheres : (F, 5) float array
        The same rows seen from the centroid of their face; read-only. They keep all digits
        wherever the model sits: every computation starts from them.

    Raises
    ------
    InputError
        If the rows do not match the faces, are not finite, or are no real spheres or planes.

    Notes
    -----
    A row in model coordinates at distance D from the origin rounds its last coefficient by
    about ``ε A D²``. Where the corners of the face say which value within that rounding is
    meant, the local row takes it from them.
    """

    mesh: Mesh
    spheres: FloatArray
    local_spheres: FloatArray = field(repr=False)

    def __init__(self, mesh: Mesh, spheres: ArrayLike) -> None:
        rows = np.array(spheres, np.float64)
        check_rows(rows, mesh.n_faces, "face")
        _fill(self, mesh, _localize(mesh, rows))

    @classmethod
    def from_local(cls, mesh: Mesh, local_spheres: FloatArray) -> "SphereMesh":
        """A sphere mesh from rows in the coordinates local to each face.

        Parameters
        ----------
        mesh : Mesh
        local_spheres : (F, 5) float array
            Rows of any positive scale, seen from the centroid of their face.

        Returns
        -------
        SphereMesh
            The sphere mesh.

        Raises
        ------
        InputError
            As the constructor.
        """
        check_rows(local_spheres, mesh.n_faces, "face")
        result = cls.__new__(cls)
        _fill(result, mesh, local_spheres)
        return result

    @classmethod
    def from_centers(cls, mesh: Mesh, centers: ArrayLike, radii: ArrayLike) -> "SphereMesh":
        """A sphere mesh from the centres and radii of its spheres.

        Parameters
        ----------
        mesh : Mesh
        centers : (F, 3) array_like of float
            In model coordinates.
        radii : (F,) array_like of float
            Positive and finite; planes are rows, for the constructor.

        Returns
        -------
        SphereMesh
            Each sphere turned so that its normal agrees with that of its face.
        """
        points, sizes = np.asarray(centers, np.float64), np.asarray(radii, np.float64)
        count = mesh.n_faces
        if points.shape != (count, 3) or sizes.shape != (count,) or not (sizes > 0).all():
            raise InputError(
                f"a mesh of {count} faces needs centres of shape ({count}, 3) and positive "
                f"radii of shape ({count},), not {points.shape} and {sizes.shape}"
            )
        local = from_center_radius(points - face_centroids(mesh), sizes**2)
        inwards = dot(local[:, 1:4], face_normals(mesh)) < 0
        local[inwards] *= -1
        return cls.from_local(mesh, local)

    def __repr__(self) -> str:
        mesh = self.mesh
        sizes = [polygons_text(mesh.degrees), size_text(mesh.vertices)]
        return brief("SphereMesh", [*sizes, radii_text(self.radii)])

    @property
    def radii(self) -> FloatArray:
        """Radius of the sphere of each face.

        Returns
        -------
        (F,) float array
            In model units; infinite for planes.
        """
        return np.sqrt(center_radius(self.local_spheres)[1])

    @property
    def centers(self) -> FloatArray:
        """Centre of the sphere of each face: the mesh of centres, which is dual to the mesh.

        Returns
        -------
        (F, 3) float array
            In model coordinates; infinite for planes.
        """
        return center_radius(self.local_spheres)[0] + face_centroids(self.mesh)

    @property
    def counts(self) -> dict[str, int]:
        """Numbers of elements by the letters that stand for them in shapes of arrays.

        Returns
        -------
        dict
            Of vertices "V", faces "F" and interior edges "E".
        """
        return self.mesh.counts


def _fill(target: SphereMesh, mesh: Mesh, local_spheres: FloatArray) -> None:
    norms = minkowski(local_spheres, local_spheres)
    bad = np.flatnonzero(~(norms > 0))
    if len(bad):
        raise InputError(
            f"the spheres of faces {name_ids(bad.tolist())} are imaginary or points"
        )
    local_spheres = local_spheres / np.sqrt(norms)[:, None]
    spheres = recenter(local_spheres, -face_centroids(mesh))
    object.__setattr__(target, "mesh", mesh)
    object.__setattr__(target, "spheres", read_only(spheres))
    object.__setattr__(target, "local_spheres", read_only(local_spheres))


def _localize(mesh: Mesh, rows: FloatArray) -> FloatArray:
    centroids = face_centroids(mesh)
    local = recenter(rows, centroids)
    faces = mesh.topology.corner_faces
    residuals = evaluate(local[faces], local_corners(mesh))
    excess = sum_by(faces, residuals, mesh.n_faces) / mesh.degrees
    square = dot(centroids, centroids)
    size = (
        np.abs(rows[:, 4]) + np.abs(dot(rows[:, 1:4], centroids)) + np.abs(rows[:, 0]) * square
    )
    rounding = 8 * EPSILON * size
    local[:, 4] -= np.clip(excess, -rounding, rounding)
    return local


def vertex_error(sphere_mesh: SphereMesh) -> FloatArray:
    """Distance of each vertex from the farthest of the spheres of its faces.

    Parameters
    ----------
    sphere_mesh : SphereMesh

    Returns
    -------
    (V,) float array
        Distances, in model units; zero for unused vertices.
    """
    mesh = sphere_mesh.mesh
    rows = sphere_mesh.local_spheres[mesh.topology.corner_faces]
    distances = np.abs(signed_distance(rows, local_corners(mesh)))
    result = np.zeros(mesh.n_vertices)
    np.maximum.at(result, mesh.corners, distances)
    return result


def intersection_angles(sphere_mesh: SphereMesh) -> FloatArray:
    """Oriented angle at which the spheres of neighbouring faces meet.

    Parameters
    ----------
    sphere_mesh : SphereMesh

    Returns
    -------
    (E,) float array
        Angles over the interior edges, in radians from 0 (smooth) to π (a spike).

    References
    ----------
    Meshes with Spherical Faces, eq. (5), in its oriented form.
    """
    mesh, topology = sphere_mesh.mesh, sphere_mesh.mesh.topology
    starts = local_corners(mesh)
    middles = (starts + starts[topology.next_corners]) / 2
    first, second = topology.edge_corners, topology.twins[topology.edge_corners]
    left, right = topology.edge_faces.T
    return angle(
        recenter(sphere_mesh.local_spheres[left], middles[first]),
        recenter(sphere_mesh.local_spheres[right], middles[second]),
    )
