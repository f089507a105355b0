"""Measures of meshes and sphere meshes: how flat, how circular, how upright, how near."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from .arrays import BoolArray, FloatArray, IntArray
from .errors import InputError
from .meshes.mesh import Mesh, face_centroids
from .optimization.angle_minimization import pencil_angles
from .panels.cutting import edge_arcs
from .sphere_meshes.fit import face_planes, fit_spheres
from .sphere_meshes.sphere_mesh import SphereMesh, intersection_angles
from .spheres.arcs import arc_points
from .spheres.circles import face_circles
from .spheres.incidence import project


def angle_summary(sphere_mesh: SphereMesh, counts: BoolArray | None = None) -> dict[str, float]:
    """``mean`` and ``max`` angle over the interior edges, in degrees; 0 if there are none.

    Over those marked by (E,), if they are given.
    """
    angles = np.degrees(intersection_angles(sphere_mesh))
    angles = angles if counts is None else angles[counts]
    if len(angles) == 0:
        return {"mean": 0.0, "max": 0.0}
    return {"mean": float(angles.mean()), "max": float(angles.max())}


def spiky_faces(sphere_mesh: SphereMesh) -> BoolArray:
    """Faces (F,) that bulge to the wrong side.

    The sphere bulges against the one fitted to the face's surroundings and meets a neighbour at
    a larger angle than the planes of the two faces do.

    References
    ----------
    Meshes with Spherical Faces, Fig. 27.
    """
    mesh = sphere_mesh.mesh
    circles, _ = face_circles(mesh)
    own = np.sin(pencil_angles(sphere_mesh, circles))
    around = np.sin(pencil_angles(fit_spheres(mesh), circles))
    is_sharper = intersection_angles(sphere_mesh) > intersection_angles(face_planes(mesh))
    has_sharp_edge = np.zeros(mesh.n_faces, bool)
    has_sharp_edge[mesh.topology.edge_faces[is_sharper]] = True
    return (own * around < 0) & has_sharp_edge


@dataclass(frozen=True)
class AngleHistogram:
    """Angles between neighbours, counted in bins.

    Attributes
    ----------
    bounds : (n + 1,) float array
        Bounds of the bins, in radians.
    spheres, planes : (n,) int array
        Number of interior edges per bin, between the spheres and between the face planes.
    """

    bounds: FloatArray
    spheres: IntArray
    planes: IntArray


def angle_histogram(sphere_mesh: SphereMesh, n_bins: int = 20) -> AngleHistogram:
    """Count the angles between neighbouring spheres, and between the planes they replace.

    The bins go from 0 to the largest angle of either kind; both counts sum to the number of
    interior edges.

    Raises
    ------
    InputError
        If `n_bins` is below 1.

    References
    ----------
    Meshes with Spherical Faces, Fig. 28, bottom row.
    """
    if n_bins < 1:
        raise InputError(f"a histogram needs at least 1 bin, not {n_bins}")
    spheres = intersection_angles(sphere_mesh)
    planes = intersection_angles(face_planes(sphere_mesh.mesh))
    largest = max(spheres.max(initial=0.0), planes.max(initial=0.0))
    bounds = np.linspace(0.0, largest if largest > 0 else np.pi, n_bins + 1)
    return AngleHistogram(
        bounds,
        np.histogram(spheres, bounds)[0].astype(np.int64),
        np.histogram(planes, bounds)[0].astype(np.int64),
    )


def deviation(sphere_mesh: SphereMesh, reference: Mesh) -> FloatArray:
    """How far the panels stand off a reference surface, whose polygons count as fans.

    Largest distance (F,) of a point of the panel from the reference, in model units, over its
    corners, nine points of each edge and the crown of the panel.
    """
    from igl import (  # pyright: ignore[reportMissingTypeStubs]
        point_mesh_squared_distance,  # pyright: ignore[reportUnknownVariableType]
    )

    mesh = sphere_mesh.mesh
    shift = reference.vertices.mean(axis=0)
    arcs = edge_arcs(sphere_mesh, "bisector")
    samples = arc_points(arcs, np.linspace(-1, 1, 9)).reshape(-1, 3)
    centroids = face_centroids(mesh)
    crowns = centroids + project(sphere_mesh.local_spheres, np.zeros_like(centroids))
    points = np.concatenate([samples, crowns]) - shift
    faces = np.concatenate([np.repeat(mesh.topology.corner_faces, 9), np.arange(mesh.n_faces)])
    distance: Any = point_mesh_squared_distance
    squares, _, _ = distance(points, reference.vertices - shift, _fans(reference))
    result = np.zeros(mesh.n_faces)
    np.maximum.at(result, faces, np.sqrt(np.asarray(squares, np.float64)))
    return result


def _fans(mesh: Mesh) -> IntArray:
    """Triangles (T, 3) of the faces, each a fan from its first corner."""
    first = np.repeat(mesh.offsets[:-1], mesh.degrees - 2)
    steps = np.arange(len(first)) - np.repeat(
        np.cumsum(mesh.degrees - 2) - (mesh.degrees - 2), mesh.degrees - 2
    )
    corners = np.stack([first, first + steps + 1, first + steps + 2], 1)
    return mesh.corners[corners]
