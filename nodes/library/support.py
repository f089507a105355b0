"""Nodes and beams that carry the panels."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ...kernel import support
from ...kernel.arrays import BoolArray, FloatArray
from ...kernel.errors import name_ids
from ...kernel.sphere_mesh import SphereMesh
from ..node import node, warn


class Nodes(NamedTuple):
    """The nodes of a support structure, one per vertex."""

    axes: FloatArray
    torsion: FloatArray
    is_valid: BoolArray
    report: Mapping[str, Any]


@node
def support_structure(sphere_mesh: SphereMesh) -> Nodes:
    """
    Find the axis of every node and how far its beams miss it.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.

    Returns
    -------
    axes : (V, 2, 3) float array
        Two points of each node axis: the vertex and its mirror image in the plane of the
        centres of its spheres. Where that is farther than 100,000 mean edges (planes) or
        at the vertex itself, the point of the axis one mean edge inside. On the boundary the
        axis lies in the planes of the beams that are there, as near to the normal as they let.
    torsion : (V,) float array
        Largest angle between the plane of a beam and the axis, in degrees.
    is_valid : (V,) bool array
        Where the torsion is at most 0.1 degrees and the axis leans at most 60 degrees from
        the normal.
    report : mapping
        ``torsion_deg`` (mean and max over interior vertices, ``boundary_max``),
        ``mirror_miss`` (largest distance of a mirror point from its spheres, in mean edges),
        ``beam_tilt_deg`` (p95, max), ``axes_without_mirror``, ``edges_without_circle``,
        ``valid`` and ``invalid`` (id, vertex and reason).
    """
    found = support.support_structure(sphere_mesh)
    report = support.support_report(sphere_mesh, found)
    is_valid = np.ones(len(found.torsion), bool)
    if report["invalid"]:
        bad = [entry["vertex"] for entry in report["invalid"]]
        is_valid[bad] = False
        warn(
            f"{len(bad)} of {len(is_valid)} nodes are not valid: vertices {name_ids(bad)} "
            f"({report['invalid'][0]['reason']})"
        )
    return Nodes(found.axes, np.degrees(found.torsion), is_valid, report)
