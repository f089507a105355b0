"""Other meshes of the same shape: triangulated, subdivided, remeshed."""

from typing import Annotated, Literal

import numpy as np

from ...kernel.meshes import isotropic_remeshing, subdivision, triangulation
from ...kernel.meshes.mesh import Mesh
from ...kernel.tolerances import MOSTLY_EVEN
from ..graphs.node import node, warn
from ..graphs.ports import Port

SCHEMES = {
    "loop": subdivision.subdivide_loop,
    "catmull-clark": subdivision.subdivide_catmull_clark,
    "midpoint": subdivision.subdivide_midpoint,
}


@node
def triangulate(mesh: Mesh) -> Mesh:
    """Cut polygons into triangles along their short diagonals.

    Parameters
    ----------
    mesh : Mesh
        Faces of any degree, convex or not.

    Returns
    -------
    Mesh
        Triangles on the same vertices; those of a face follow each other.

    Examples
    --------
    >>> from spheremesh.nodes import triangulate, vase_mesh
    >>> triangulate(vase_mesh(12, 6)).n_faces
    144
    """
    return triangulation.triangulate(mesh)


@node
def subdivide(
    mesh: Mesh,
    scheme: Literal["loop", "catmull-clark", "midpoint"] | None = None,
    iterations: Annotated[int, Port(min=0, max=8)] = 1,
) -> Mesh:
    """Split every face into smaller ones.

    Parameters
    ----------
    mesh : Mesh
    scheme : {"loop", "catmull-clark", "midpoint"}, optional
        Smooth for triangles, smooth for faces of any degree (quadrilaterals come out), or
        without a change of shape. By default loop for triangles and catmull-clark for others.
    iterations : int
        How often; each multiplies the number of faces by about four.

    Returns
    -------
    Mesh
        The finer mesh; the smooth schemes draw it inwards, its boundary to a smooth curve.

    Examples
    --------
    >>> from spheremesh.nodes import subdivide, vase_mesh
    >>> subdivide(vase_mesh(12, 6)).n_faces
    288
    """
    if scheme is None:
        scheme = "loop" if (mesh.degrees == 3).all() else "catmull-clark"
    for _ in range(iterations):
        mesh = SCHEMES[scheme](mesh)
    return mesh


@node
def remesh_triangles(
    mesh: Mesh,
    edge_length: Annotated[float, Port(min=0)],
    iterations: Annotated[int, Port(min=0, max=100)] = 10,
    crease_angle: Annotated[float, Port(unit="deg", min=0, max=180)] = 40.0,
) -> Mesh:
    """Cover the surface of a mesh with triangles whose edges have nearly one length.

    Parameters
    ----------
    mesh : Mesh
        The surface; polygons are cut into triangles first.
    edge_length : float
        Length that edges shall have, in model units.
    iterations : int
        How often all edges are gone over.
    crease_angle : float
        Edges at which the surface turns more sharply are kept, as the boundary is.

    Returns
    -------
    Mesh
        Triangles with their vertices on the surface.

    Examples
    --------
    >>> from spheremesh.nodes import remesh_triangles, vase_mesh
    >>> mesh = remesh_triangles(vase_mesh(12, 6), edge_length=0.6, iterations=3)
    >>> set(mesh.degrees.tolist())
    {3}
    """
    result = isotropic_remeshing.remesh_triangles(
        mesh, edge_length, iterations, float(np.radians(crease_angle))
    )
    share = isotropic_remeshing.even_share(result, edge_length)
    if iterations and share < MOSTLY_EVEN:
        warn(
            f"only {100 * share:.0f} % of the edges are between 0.5 and 1.6 times as long as "
            "asked for: the mesh has finer details, corners or creases; choose shorter "
            "edges or a larger crease angle"
        )
    return result
