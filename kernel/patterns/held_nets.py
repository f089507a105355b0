"""Nets planarised on their surface, the most faithful first, and trimmed at the boundary.

Cells at the boundary that cross themselves lose the corner that no other cell needs.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ..arrays import IntArray
from ..meshes.mesh import Mesh
from ..remesh.field.smooth_surface import SmoothSurface
from ..remesh.planar.conditions import node_distances
from ..remesh.planar.landing import planarize_near
from ..remesh.planar.planarize import planarize
from ..sphere_meshes.sphere_mesh import SphereMesh

FARTHEST_NODE = 0.02
"""Largest distance of a node from the surface, in mean edges, for a net of that surface."""

HELD_LEAN = np.radians(12)
"""Node axes that lean farther are turned back on the way to the surface."""

APPROACH_PATIENCE = 0.1
"""The way to the surface ends when a step lowers what is missed by a smaller share."""

SLACK = 0.012
"""Distance from the surface, in mean edges, that nets may use."""

FEWEST_CORNERS = 3
"""Corners that a cell keeps."""

HELD_RIM_WEIGHTS = (1.0, 0.0)
"""How much the boundary counts on the way."""


class HeldNet(NamedTuple):
    """A net whose nodes are planar.

    Attributes
    ----------
    net : SphereMesh
    distance : float
        Largest distance of a node inside from the surface, in mean edges.
    iterations : int
        Linear systems that were solved for it.
    """

    net: SphereMesh
    distance: float
    iterations: int


def held_nets(start: SphereMesh, surface: SmoothSurface) -> Iterator[HeldNet]:
    """Planarise a net on its surface: with its boundary, without, and anywhere.

    Notes
    -----
    Near lines where the spheres have a principal curvature of the surface, neighbours are all
    but one sphere: there nets leave the surface unless they are led onto it first, patiently,
    and the plane of two such spheres is rounding unless they are turned apart at last.
    """
    for weight in HELD_RIM_WEIGHTS:
        found = planarize(
            start,
            1.0,
            surface,
            weight,
            lean=HELD_LEAN,
            approach=APPROACH_PATIENCE,
            slack=SLACK,
        )
        landed, is_near = planarize_near(found.sphere_mesh, FARTHEST_NODE)
        net = landed.sphere_mesh if is_near else found.sphere_mesh
        inner = ~net.mesh.topology.is_boundary_vertex
        distance = float(node_distances(surface, net.mesh)[inner].max(initial=0.0))
        yield HeldNet(net, distance, found.iterations + landed.iterations)


def without_loose_corners(net: SphereMesh, faces: IntArray) -> SphereMesh:
    """A net whose given faces have no corners that belong to them alone.

    Spheres and all other nodes stay as they are, so that planar nodes stay planar; triangles
    keep their corners.
    """
    mesh = net.mesh
    is_chosen = np.zeros(mesh.n_faces, bool)
    is_chosen[faces] = True
    of_corners = mesh.topology.corner_faces
    valence = np.bincount(mesh.corners, minlength=mesh.n_vertices)
    is_loose = (valence[mesh.corners] == 1) & is_chosen[of_corners]
    left = mesh.degrees - np.bincount(of_corners[is_loose], minlength=mesh.n_faces)
    is_loose &= (left >= FEWEST_CORNERS)[of_corners]
    if not is_loose.any():
        return net
    kept = ~is_loose
    degrees = np.bincount(of_corners[kept], minlength=mesh.n_faces)
    used, corners = np.unique(mesh.corners[kept], return_inverse=True)
    pieces = np.split(corners.ravel(), np.cumsum(degrees)[:-1])
    return SphereMesh(Mesh(mesh.vertices[used], pieces), net.spheres)
