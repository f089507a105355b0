"""Landing: nodes that are nearly planar, as those of an optimised support, made so in place.

The plane of the circle of two spheres is as exact as they are, divided by their angle. Nodes
cannot be made free of torsion through neighbours that meet at a millionth: to turn the plane
they would have to change by more than they differ. Turned apart by an angle that no workshop
sees, they tell their plane, and the others follow.
"""

import numpy as np

from ...arrays import BoolArray, FloatArray, IntArray, dot, sum_by, unit
from ...meshes.mesh import Mesh, local_corners, mean_edge_length
from ...sphere_meshes.sphere_mesh import SphereMesh, intersection_angles, vertex_error
from ...spheres.minkowski import minkowski
from ...spheres.rows import recenter
from ...support.node_axes import arc_planes, support_structure
from ...tolerances import (
    ALIKE_NEIGHBORS,
    NODE_LANDED,
    NODE_ON_SPHERES,
    NODE_ROUNDED,
    PARALLEL_PLANES,
)
from .conditions import must_be_planar
from .planarize import Planarization, is_kept, planarize


def planarize_near(sphere_mesh: SphereMesh, farthest: float) -> tuple[Planarization, bool]:
    """Make nodes planar if that moves them by at most `farthest` mean edges.

    The nodes are nearly planar, as those of an optimised support structure. Also whether the
    beams of the result meet, none of its nodes moved farther, and it stayed a net.

    Notes
    -----
    Where neighbours meet nearly smoothly, the plane of their circle is far less exact than they
    are. So the descent goes on to rounding, as near as it gets; and neighbours that are all but
    one sphere are turned apart before (`turn_apart`). Spheres so large that they are built as
    planes can share points far off, and their beams share nothing: beams are the judge.
    """
    result = planarize(turn_apart(sphere_mesh), exact=NODE_ROUNDED)
    found = result.sphere_mesh
    gap = vertex_error(found).max() / mean_edge_length(found.mesh)
    torsion = support_structure(found).torsion[must_be_planar(found.mesh)]
    is_near = (
        torsion.max(initial=0.0) <= NODE_LANDED
        and gap <= NODE_ON_SPHERES
        and result.shifts.max(initial=0.0) <= farthest
        and is_kept(sphere_mesh.mesh, found.mesh)
    )
    return result, bool(is_near)


def turn_apart(sphere_mesh: SphereMesh) -> SphereMesh:
    """Let neighbours meet at a sensible angle where the axes of their edge's nodes are known.

    Spheres of the edges concerned are turned apart by `ALIKE_NEIGHBORS` about the circle in
    which they meet the plane of the edge and of its two node axes. Where other beams leave an
    axis open, as within a piece of one sphere, all stays as it is.
    """
    mesh, topology = sphere_mesh.mesh, sphere_mesh.mesh.topology
    is_alike = intersection_angles(sphere_mesh) < ALIKE_NEIGHBORS
    if not is_alike.any():
        return sphere_mesh
    planes = arc_planes(sphere_mesh)
    told = planes.exists & ~is_alike
    axes, is_known = _axes(mesh, topology.edge_vertices[told], planes.normals[told])
    chosen = np.flatnonzero(is_alike & is_known[topology.edge_vertices].all(axis=1))
    return _turned(sphere_mesh, chosen, axes[topology.edge_vertices[chosen]])


def _axes(
    mesh: Mesh, ends: IntArray, plane_normals: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Axes (V, 3), up to sign, of planes between the vertices `ends`; and which are known."""
    products = (plane_normals[:, :, None] * plane_normals[:, None]).reshape(-1, 9)
    around = np.concatenate([products, products])
    gram = sum_by(ends.T.ravel(), around, mesh.n_vertices).reshape(-1, 3, 3)
    values, basis = np.linalg.eigh(gram)
    # Values are squares of sines: an axis is known where planes meet at a thousandth or more.
    return basis[..., 0], values[:, 1] > PARALLEL_PLANES * values[:, 2]


def _turned(sphere_mesh: SphereMesh, edges: IntArray, axes: FloatArray) -> SphereMesh:
    """Turn the spheres of edges apart about their circles in the planes of axes (e, 2, 3)."""
    mesh, topology = sphere_mesh.mesh, sphere_mesh.mesh.topology
    sides = topology.edge_corners[edges], topology.twins[topology.edge_corners[edges]]
    starts = local_corners(mesh)
    ends = starts[topology.next_corners]
    chords, middles = (ends - starts)[sides[0]], (starts + ends) / 2
    second = axes[:, 1] * np.where(dot(axes[:, 0], axes[:, 1]) < 0, -1.0, 1.0)[:, None]
    planes = unit(np.cross(chords, axes[:, 0] + second))
    rows = sphere_mesh.local_spheres.copy()
    seen = [recenter(rows[topology.corner_faces[h]], middles[h]) for h in sides]
    differ = dot(seen[1][:, 1:4] - seen[0][:, 1:4], planes)
    step = np.zeros((len(edges), 5))
    step[:, 1:4] = np.copysign(ALIKE_NEIGHBORS / 2, differ)[:, None] * planes
    for h, sign in zip(sides, (-1, 1), strict=True):
        # The plane passes through the chord, so that its row vanishes there.
        np.add.at(rows, topology.corner_faces[h], sign * recenter(step, -middles[h]))
    return SphereMesh.from_local(mesh, rows / np.sqrt(minkowski(rows, rows))[:, None])
