"""Spheres that are smooth along strips."""

import numpy as np

from ....kernel.errors import InputError
from ....kernel.meshes.mesh import Mesh
from ....kernel.optimization import strips
from ...graphs.node import node
from ..arrays import EdgeWeights, FaceVectors, Vector


@node
def strip_weights(mesh: Mesh, direction: int | Vector | FaceVectors = 0) -> EdgeWeights:
    """Weights that let spheres join smoothly along strips, and only there.

    Parameters
    ----------
    mesh : Mesh
        Quadrilaterals for a direction of the net; any faces for a direction in space.
    direction : int or float array
        0: strips run as the first quadrilateral does from its first to its second corner, and
        1 across; or a vector (3,), or one per face (F, 3), along which they run.

    Returns
    -------
    (E,) float array
        1 on the edges between neighbours of a strip, 0 on all others: for `minimize_angles`
        and `optimize_spheres`.

    Examples
    --------
    >>> from spheremesh.nodes import strip_weights, vase_mesh
    >>> weights = strip_weights(vase_mesh(12, 6), direction=0)
    >>> len(weights), int(weights.sum())
    (132, 72)
    """
    if not isinstance(direction, int | np.integer):
        return strips.strip_weights_along(mesh, direction)
    if direction not in (0, 1):
        raise InputError(f"a net has the directions 0 and 1, not {direction}")
    return strips.strip_weights(mesh, "second" if direction else "first")
