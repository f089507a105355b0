"""Curvatures of a surface: across its edges, and the one that suits all of its spheres."""

import numpy as np

from ..arrays import FloatArray, dot, norm
from ..meshes.mesh import Mesh, face_centroids, face_normals, mean_edge_length
from ..solvers.weighted_graphs import piece_labels
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..spheres.circles import circle_pencils, face_circles, pencil_spheres

LEAST_CURVATURE = 0.25
"""Least common curvature, in medians of those along the edges: planes tell no node axis."""

HALF_OPENING = 0.95
"""Largest share of its great circle that a face may take at the start."""


def edge_curvatures(mesh: Mesh) -> tuple[FloatArray, FloatArray]:
    """Normal curvature across each interior edge, and the distance across, in mean edges.

    ``k = -ΔN·Δc / |Δc|²`` with the normals N and centroids c of the two faces, (E,) each;
    positive where the surface bends towards N.
    """
    size = mean_edge_length(mesh)
    unit_normals, centroids = face_normals(mesh), face_centroids(mesh)
    left, right = mesh.topology.edge_faces.T
    across = (centroids[right] - centroids[left]) / size
    turned = unit_normals[right] - unit_normals[left]
    squares = dot(across, across)
    bends = -dot(turned, across)
    curvatures = np.divide(bends, squares, out=np.zeros_like(bends), where=squares > 0)
    return curvatures, norm(across)


def common_curvatures(mesh: Mesh) -> FloatArray:
    """The curvature (F,), per mean edge, at which spheres fit a surface best.

    One for each connected piece: the weighted median, which minimises ``Σ |k_e - κ| h_e``, and
    so the mean angle of neighbouring spheres that touch the surface. It is kept away from 0,
    because axes of nodes between planes are not defined; pieces that are flat get 0.
    """
    topology = mesh.topology
    curvatures, lengths = edge_curvatures(mesh)
    left, right = topology.edge_faces.T
    pieces = piece_labels(left, right, mesh.n_faces)
    result = np.zeros(mesh.n_faces)
    for piece in range(int(pieces.max()) + 1):
        chosen = pieces[topology.edge_faces[:, 0]] == piece
        result[pieces == piece] = _median(curvatures[chosen], lengths[chosen])
    return result


def one_curvature(mesh: Mesh) -> FloatArray:
    """Curvatures (F,) of one size, with the sign that each connected piece has by itself."""
    curvatures, lengths = edge_curvatures(mesh)
    signs = np.sign(common_curvatures(mesh))
    left = mesh.topology.edge_faces[:, 0]
    return signs * _median(signs[left] * curvatures, lengths)


def _median(curvatures: FloatArray, weights: FloatArray) -> float:
    if not len(curvatures):
        return 0.0
    order = np.argsort(curvatures)
    sums: FloatArray = np.cumsum(weights[order])
    place = int((sums < sums[-1] / 2).sum())
    best = float(curvatures[order][place])
    least = LEAST_CURVATURE * float(np.median(np.abs(curvatures)))
    return best if abs(best) >= least else float(np.copysign(least, best))


def spheres_of_curvature(mesh: Mesh, curvatures: FloatArray) -> SphereMesh:
    """Spheres of given curvatures (F,), per mean edge, through the best circle of each face."""
    circles, _ = face_circles(mesh)
    radii = np.sqrt(circles.radii_squared) / mean_edge_length(mesh)
    angles = np.arcsin(np.clip(radii * curvatures, -HALF_OPENING, HALF_OPENING))
    rows = pencil_spheres(*circle_pencils(circles), angles)
    return SphereMesh.from_local(mesh, rows)
