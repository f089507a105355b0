"""Few moulds for many panels."""

from collections.abc import Mapping
from typing import Annotated, Any, NamedTuple

import numpy as np

from ...kernel import clustering
from ...kernel.arrays import FloatArray, IntArray
from ...kernel.sphere_mesh import SphereMesh, intersection_angles
from ..node import node, warn
from ..ports import Port


class Clusters(NamedTuple):
    """A sphere mesh of few radii."""

    sphere_mesh: SphereMesh
    labels: IntArray
    radii: FloatArray
    report: Mapping[str, Any]


@node
def cluster_radii(
    sphere_mesh: SphereMesh,
    k: Annotated[int, Port(min=1)],
    seed: Annotated[int, Port(min=0)] = 0,
) -> Clusters:
    """
    Give all panels at most k radii; the vertices stay where they are.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.
    k : int
        Number of moulds.
    seed : int
        Seed of the clustering.

    Returns
    -------
    sphere_mesh : SphereMesh
        Spheres through the same circles with the radius of their mould.
    labels : (F,) int array
        Mould of each face, 0 the sharpest.
    radii : (k,) float array
        Radii of the moulds, ascending; infinite for a flat one.
    report : mapping
        ``count``, ``radii`` (None for a flat mould), ``panels_per_mould``, ``angles_deg``
        (mean and max) and ``reassigned`` (faces that are too large for the mould nearest to
        them).
    """
    result, clusters = clustering.cluster_radii(sphere_mesh, k, seed)
    reassigned = np.flatnonzero(clusters.reassigned).tolist()
    if reassigned:
        warn(f"{len(reassigned)} faces are too large for their mould and moved to a larger one")
    if len(clusters.radii) < k:
        warn(f"{len(clusters.radii)} moulds suffice: no more radii differ")
    angles = np.degrees(intersection_angles(result))
    report = {
        "count": len(clusters.radii),
        "radii": [float(r) if np.isfinite(r) else None for r in clusters.radii],
        "panels_per_mould": clusters.counts.tolist(),
        "angles_deg": {
            "mean": float(angles.mean()) if len(angles) else 0.0,
            "max": float(angles.max(initial=0.0)),
        },
        "reassigned": reassigned,
    }
    return Clusters(result, clusters.labels, clusters.radii, report)
