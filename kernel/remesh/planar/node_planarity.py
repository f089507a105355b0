"""What the spheres around a node share: planarity in P⁴, node axes, real common points.

Meshes with Spherical Faces, Prop. 4.2 and 4.3.
"""

from dataclasses import dataclass

import numpy as np

from ...arrays import BoolArray, FloatArray, batches_by_count, dot, norm, sum_by, unit
from ...meshes.mesh import face_vector_areas, local_corners, mean_edge_length
from ...sphere_meshes.sphere_mesh import SphereMesh
from ...spheres.rows import recenter, rescale
from ...tolerances import DEGENERATE
from .conditions import must_be_planar


@dataclass(frozen=True)
class Nodes:
    """What the spheres around each node have in common.

    Attributes
    ----------
    is_inner : (V,) bool array
        Nodes inside the mesh.
    planarity : (V,) float array
        Fourth singular value of the rows seen from the node, relative to the first; zero for
        less than four spheres.
    axes : (V, 3) float array
        Unit directions of the node axes, through both common points; NaN where there is none:
        where spheres share a circle or all of them are planes, and at the nodes of the
        boundary with less than four faces.
    is_real : (V,) bool array
        Whether the spheres meet in two real points, by least squares; False where the boundary
        has no axis.
    """

    is_inner: BoolArray
    planarity: FloatArray
    axes: FloatArray
    is_real: BoolArray


def measure_nodes(sphere_mesh: SphereMesh) -> Nodes:
    """Planarity, axes and reality of the nodes; by least squares where they are not planar.

    Notes
    -----
    The spheres orthogonal to those of a node are a pencil. Its plane holds their centres: the
    axis is normal to it. Its points, null vectors of the product, are the common points.
    """
    mesh = sphere_mesh.mesh
    size = mean_edge_length(mesh)
    local = rescale(sphere_mesh.local_spheres, 1 / size)[mesh.topology.corner_faces]
    rows = recenter(local, local_corners(mesh) / size)
    planarity = np.zeros(mesh.n_vertices)
    axes = np.full((mesh.n_vertices, 3), np.nan)
    is_real = np.zeros(mesh.n_vertices, np.bool_)
    is_planar = must_be_planar(mesh)
    for group, around in batches_by_count(mesh.corners, mesh.n_vertices):
        if around.shape[1] < 3:
            continue
        nodes, corners = group[is_planar[group]], around[is_planar[group]]
        _, values, basis = np.linalg.svd(rows[corners])
        if values.shape[1] > 3:
            planarity[nodes] = values[:, 3] / values[:, 0]
        is_full = values[:, 2] > DEGENERATE * values[:, 0]
        # Forms on rows; the first and last coefficients trade places in the sphere they stand
        # for, so that without a last coefficient it is a plane.
        first, second = basis[:, 3], basis[:, 4]
        plane = second[:, 4:] * first[:, 1:4] - first[:, 4:] * second[:, 1:4]
        has_axis = is_full & (norm(plane) > DEGENERATE)
        axes[nodes[has_axis]] = unit(plane[has_axis])
        mixed = _form(first, second)
        is_real[nodes] = is_full & (mixed**2 > _form(first, first) * _form(second, second))
    return Nodes(~mesh.topology.is_boundary_vertex, planarity, axes, is_real)


def _form(first: FloatArray, second: FloatArray) -> FloatArray:
    """Minkowski product of the spheres that linear forms of rows stand for."""
    ends = first[:, 0] * second[:, 4] + first[:, 4] * second[:, 0]
    return dot(first[:, 1:4], second[:, 1:4]) - ends / 2


def node_axis_angles(sphere_mesh: SphereMesh, nodes: Nodes) -> FloatArray:
    """Angles (V,) between the node axes and the normals of the mesh, from 0 to π/2.

    NaN where there is no axis, or no normal since faces fold back.

    Notes
    -----
    The normals are sums of the vector areas of faces: nets that went wrong have them as well.
    """
    mesh = sphere_mesh.mesh
    areas = face_vector_areas(mesh)[mesh.topology.corner_faces]
    normals = unit(sum_by(mesh.corners, areas, mesh.n_vertices))
    across = norm(np.cross(nodes.axes, normals))
    angles = np.arctan2(across, np.abs(dot(nodes.axes, normals)))
    return np.where(norm(normals) > 0, angles, np.nan)
