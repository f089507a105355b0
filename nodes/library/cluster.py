"""Few moulds for many panels."""

from collections.abc import Mapping
from typing import Annotated, Any, NamedTuple

import numpy as np

from ...kernel.analysis import angle_summary
from ...kernel.optimization import clustering
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...kernel.tolerances import COMMON_VERTEX
from ..graphs.node import node, warn
from ..graphs.ports import Port
from .arrays import FaceLabels, MouldRadii


class Clusters(NamedTuple):
    """A sphere mesh of few radii."""

    sphere_mesh: SphereMesh
    labels: FaceLabels
    radii: MouldRadii
    report: Mapping[str, Any]


@node
def cluster_radii(
    sphere_mesh: SphereMesh,
    k: Annotated[int, Port(min=1)],
    relax: bool = True,  # noqa: FBT001, FBT002 - a toggle on the canvas
    tolerance: Annotated[float, Port(min=0)] = 0.05,
    regularity: Annotated[float, Port(min=0)] = 0.0,
    support: Annotated[float, Port(min=0)] = 0.0,
    seed: Annotated[int, Port(min=0)] = 0,
) -> Clusters:
    """
    Give all panels at most k radii.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.
    k : int
        Number of moulds.
    relax : bool
        Whether vertices move, so that the panels of given radii meet more smoothly.
    tolerance : float
        How far vertices move at most, in mean edges.
    regularity, support : float
        Weights that keep planes upright and nodes free of torsion while vertices move, as in
        `optimize_spheres`.
    seed : int
        Seed of the clustering.

    Returns
    -------
    sphere_mesh : SphereMesh
        Spheres with the radius of their mould: through the same circles, or relaxed, through
        moved vertices.
    labels : (F,) int array
        Mould of each face, 0 the sharpest.
    radii : (k,) float array
        Radii of the moulds, ascending; infinite for a flat one.
    report : mapping
        ``count``, ``radii`` (None for a flat mould), ``panels_per_mould``, ``angles_deg``
        (mean and max), ``unrelaxed_angles_deg``, ``reassigned`` (faces that are too large for
        the mould nearest to them), ``relaxed`` and ``vertex_move`` (in mean edges).
    """
    clustered, clusters = clustering.cluster_radii(sphere_mesh, k, seed)
    result, move = clustered, 0.0
    if relax and tolerance > 0:
        relaxed, run = clustering.relax_moulds(
            clustered, clusters, tolerance, regularity=regularity, support=support
        )
        if run.vertex_miss <= COMMON_VERTEX:
            result, move = relaxed, run.vertex_move
        else:
            warn(
                f"the vertices do not reach the moulds' spheres within {tolerance:g} mean "
                "edges: they stay where they were"
            )
    reassigned = np.flatnonzero(clusters.reassigned).tolist()
    if reassigned:
        warn(f"{len(reassigned)} faces are too large for their mould and moved to a larger one")
    if len(clusters.radii) < k:
        warn(f"{len(clusters.radii)} moulds suffice: no more radii differ")
    report = {
        "count": len(clusters.radii),
        "radii": [float(r) if np.isfinite(r) else None for r in clusters.radii],
        "panels_per_mould": clusters.counts.tolist(),
        "angles_deg": angle_summary(result),
        "unrelaxed_angles_deg": angle_summary(clustered),
        "reassigned": reassigned,
        "relaxed": result is not clustered,
        "vertex_move": move,
    }
    return Clusters(result, clusters.labels, clusters.radii, report)
