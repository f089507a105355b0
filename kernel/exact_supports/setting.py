"""What a search for an exact support is made of: what stays fixed, and the unknowns.

Lengths are in mean edges, rows seen from the centroid of their face at the start.
"""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from ..arrays import FloatArray, IntArray, dot, norm, sum_by, unit
from ..meshes.mesh import Mesh, local_corners, mean_edge_length, with_vertices
from ..solvers.blocks import Layout
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..spheres.incidence import normals
from ..spheres.rows import recenter, rescale
from ..tolerances import FLATTEST
from .curvatures import spheres_of_curvature
from .design_surface import DesignSurface


class Unknown(IntEnum):
    """Groups of unknowns."""

    ROW = 0
    SHIFT = 1
    POLE = 2


UNKNOWN_WIDTHS = (5, 3, 3)

VANISHING_EDGE = 1e-3
"""Edges shorter than this, in mean edges, may vanish."""


@dataclass(frozen=True)
class Bounds:
    """How far vertices may move, in mean edges.

    Attributes
    ----------
    height, slide : float
        Off the surface; within it.
    """

    height: float
    slide: float


@dataclass(frozen=True)
class SlidState:
    """Values of the unknowns.

    Attributes
    ----------
    rows : (F, 5) float array
        Spheres.
    shifts : (V, 3) float array
        How far each vertex has moved.
    poles : (N, 3) float array
        Of each node the vector p along its axis with ``A = p · N`` for all of its spheres:
        they meet in the vertex v and in ``v + p / |p|²``.
    """

    rows: FloatArray
    shifts: FloatArray
    poles: FloatArray


@dataclass(frozen=True)
class SlideSetting:
    """What stays fixed.

    Attributes
    ----------
    corners : (H, 3) float array
        Corners at the start, local to their face.
    nodes : (N,) int array
        Vertices of faces: beams along the boundary share axes as well.
    spokes, spoke_nodes : (S,) int array
        Corners at nodes, and the number of their node.
    pairs : (P, 2) int array
        Corners at one vertex of two faces that share an edge there.
    beam_nodes : (m, 2) int array
        Nodes at both ends of the edges, those of the boundary included.
    beam_edges : (m, 3) float array
        These edges at the start.
    edges : (n, 2) int array
        Vertices of all edges, those of the boundary included.
    edge_slopes : (n, 3) float array
        Unit vectors along the edges, divided by their lengths.
    curvatures : (F,) float array
        What the curvature of each sphere shall be near.
    scales : (F,), node_scales : (N,) float array
        Half of their size: units of A and of the poles.
    has_one_radius : bool
        Whether spheres keep exactly the curvatures that they start with.
    is_flat : bool
        Whether flatness of beams is a condition of its own.
    """

    mesh: Mesh
    surface: DesignSurface
    bounds: Bounds
    corners: FloatArray
    nodes: IntArray
    spokes: IntArray
    spoke_nodes: IntArray
    pairs: IntArray
    beam_nodes: IntArray
    beam_edges: FloatArray
    edges: IntArray
    edge_slopes: FloatArray
    curvatures: FloatArray
    scales: FloatArray
    node_scales: FloatArray
    has_one_radius: bool
    is_flat: bool

    @property
    def layout(self) -> Layout:
        """Layout of the unknowns in a vector."""
        return Layout(
            (self.mesh.n_faces, self.mesh.n_vertices, len(self.nodes)), UNKNOWN_WIDTHS
        )


def make_setting(
    mesh: Mesh,
    surface: DesignSurface,
    bounds: Bounds,
    curvatures: FloatArray,
    *,
    has_one_radius: bool = False,
    is_flat: bool = False,
) -> SlideSetting:
    """Measure a mesh for a search; curvatures (F,) per mean edge."""
    topology = mesh.topology
    nodes = np.flatnonzero(np.bincount(mesh.corners, minlength=mesh.n_vertices))
    node_of = np.full(mesh.n_vertices, -1)
    node_of[nodes] = np.arange(len(nodes))
    spokes = np.flatnonzero(node_of[mesh.corners] >= 0)
    first, heads = topology.edge_corners, topology.next_corners
    second = topology.twins[first]
    ends = [np.stack([first, heads[second]], 1), np.stack([heads[first], second], 1)]
    once = np.flatnonzero((topology.twins < 0) | (topology.twins > np.arange(len(heads))))
    tails, tips = mesh.corners[once], mesh.corners[heads[once]]
    along = (mesh.vertices[tips] - mesh.vertices[tails]) / mean_edge_length(mesh)
    beams = node_of[np.stack([tails, tips], axis=1)]
    scales = np.maximum(np.abs(curvatures), FLATTEST) / 2
    at = node_of[mesh.corners[spokes]]
    counts = np.bincount(at, minlength=len(nodes))
    return SlideSetting(
        mesh=mesh,
        surface=surface,
        bounds=bounds,
        corners=local_corners(mesh) / mean_edge_length(mesh),
        nodes=nodes,
        spokes=spokes,
        spoke_nodes=at,
        pairs=np.concatenate(ends),
        beam_nodes=beams,
        beam_edges=along,
        edges=np.stack([tails, tips], axis=1),
        edge_slopes=along / np.maximum(dot(along, along), VANISHING_EDGE**2)[:, None],
        curvatures=curvatures,
        scales=scales,
        node_scales=sum_by(at, scales[topology.corner_faces[spokes]], len(nodes)) / counts,
        has_one_radius=has_one_radius,
        is_flat=is_flat,
    )


def first_state(setting: SlideSetting) -> SlidState:
    """Spheres of the curvatures through the faces' circles, upright axes, no shifts."""
    mesh = setting.mesh
    spheres = spheres_of_curvature(mesh, setting.curvatures).local_spheres
    return upright_state(setting, rescale(spheres, 1 / mean_edge_length(mesh)))


def upright_state(setting: SlideSetting, rows: FloatArray) -> SlidState:
    """Spheres (F, 5), axes along the mean normals of their nodes, no shifts."""
    mesh = setting.mesh
    faces = mesh.topology.corner_faces[setting.spokes]
    arrows = normals(rows[faces], setting.corners[setting.spokes])
    count = len(setting.nodes)
    upward = unit(sum_by(setting.spoke_nodes, arrows, count))
    sizes = sum_by(setting.spoke_nodes, rows[faces, 0], count)
    sizes /= np.bincount(setting.spoke_nodes, minlength=count)
    return SlidState(rows, np.zeros((mesh.n_vertices, 3)), sizes[:, None] * upward)


def slid_by(setting: SlideSetting, state: SlidState, step: FloatArray) -> SlidState:
    """The state after a step, a flat vector."""
    rows, shifts, poles = setting.layout.split(step)
    return SlidState(state.rows + rows, state.shifts + shifts, state.poles + poles)


def assembled(setting: SlideSetting, state: SlidState) -> SphereMesh:
    """The sphere mesh of a state, in model units."""
    mesh = setting.mesh
    size = mean_edge_length(mesh)
    drift = sum_by(mesh.topology.corner_faces, state.shifts[mesh.corners], mesh.n_faces)
    drift /= mesh.degrees[:, None]
    moved = with_vertices(mesh, mesh.vertices + size * state.shifts)
    return SphereMesh.from_local(moved, rescale(recenter(state.rows, drift), size))


def shifts_between(before: Mesh, after: Mesh) -> FloatArray:
    """How far the vertices of a mesh have moved, (V, 3), in its mean edges."""
    return (after.vertices - before.vertices) / mean_edge_length(before)


def farthest(vectors: FloatArray) -> float:
    """Length of the longest of vectors (n, k); 0 if there are none."""
    return float(norm(vectors).max(initial=0.0))
