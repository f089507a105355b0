"""Other meshes of the same shape: triangulated, finer, or of even triangles."""

from typing import Annotated, Literal

from ...kernel import subdivision, triangulation
from ...kernel.mesh import Mesh
from ..node import node
from ..ports import Port

SCHEMES = {
    "loop": subdivision.subdivide_loop,
    "catmull-clark": subdivision.subdivide_catmull_clark,
    "midpoint": subdivision.subdivide_midpoint,
}


@node
def triangulate(mesh: Mesh) -> Mesh:
    """
    Cut polygons into triangles along their short diagonals.

    Parameters
    ----------
    mesh : Mesh
        Faces of any degree, convex or not.

    Returns
    -------
    Mesh
        Triangles on the same vertices; those of a face follow each other.
    """
    return triangulation.triangulate(mesh)


@node
def subdivide(
    mesh: Mesh,
    scheme: Literal["loop", "catmull-clark", "midpoint"] | None = None,
    iterations: Annotated[int, Port(min=0, max=8)] = 1,
) -> Mesh:
    """
    Split every face into smaller ones.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    scheme : {"loop", "catmull-clark", "midpoint"}, optional
        Smooth for triangles, smooth for faces of any degree (quadrilaterals come out), or
        without a change of shape. By default loop for triangles and catmull-clark for others.
    iterations : int
        How often; each multiplies the number of faces by about four.

    Returns
    -------
    Mesh
        The finer mesh; the smooth schemes draw it inwards, its boundary to a smooth curve.
    """
    if scheme is None:
        scheme = "loop" if (mesh.degrees == 3).all() else "catmull-clark"
    for _ in range(iterations):
        mesh = SCHEMES[scheme](mesh)
    return mesh
