"""Spheres of equal radii, to start a support from."""

from ....kernel.exact_supports.curvatures import common_curvatures, spheres_of_curvature
from ....kernel.meshes.mesh import Mesh
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...graphs.node import node


@node
def equal_radii(mesh: Mesh) -> SphereMesh:
    """Spheres of equal radius through the circles of the faces: a start for supports.

    Node axes are upright where radii are nearly equal from neighbour to neighbour. Start
    `optimize_spheres` here with a weight on the support and vertices that may slide.

    Parameters
    ----------
    mesh : Mesh

    Returns
    -------
    SphereMesh
        Spheres of the curvature at which neighbours that touch the surface meet at the least
        angle, one for each piece of the mesh, through the best circle of each face; planes
        where a piece is flat. On faces too large for that radius spheres are smaller.

    Examples
    --------
    >>> from spheremesh.nodes import equal_radii, intersection_angles, vase_mesh
    >>> angles = intersection_angles(equal_radii(vase_mesh(12, 6)))
    >>> float(angles.mean().round(1))
    14.8
    """
    return spheres_of_curvature(mesh, common_curvatures(mesh))
