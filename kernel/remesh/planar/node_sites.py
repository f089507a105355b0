"""Where nodes may be: on a surface, and those of its boundary on the boundary."""

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np

from ...arrays import FloatArray, dot, norm, unit
from ...meshes.mesh import Mesh, mean_edge_length
from ...tolerances import LINE_CORNER
from ..field.smooth_surface import SmoothSurface, surface_heights


class Misses(NamedTuple):
    """
    How far nodes are from where they shall be.

    Attributes
    ----------
    lengths : (V, k) float array
        Distances, in mean edges.
    slopes : (V, k, 3) float array
        Their gradients.
    """

    lengths: FloatArray
    slopes: FloatArray


Site: TypeAlias = Callable[[FloatArray], Misses]
"""From shifts (V, 3) of the nodes, in mean edges, to what they miss."""


def anywhere(shifts: FloatArray) -> Misses:
    """
    Let nodes be where they like.

    Parameters
    ----------
    shifts : (V, 3) float array
        How far they moved.

    Returns
    -------
    Misses
        None, of shape (V, 0).
    """
    return Misses(np.zeros((len(shifts), 0)), np.zeros((len(shifts), 0, 3)))


def on_surface(surface: SmoothSurface, mesh: Mesh, weights: FloatArray) -> Site:
    """
    Keep nodes on a smooth surface.

    Parameters
    ----------
    surface : SmoothSurface
        The surface.
    mesh : Mesh
        The net at the start, in model coordinates; its boundary lies on that of the surface.
    weights : (V,) float array
        How much the height of each node counts; 0 where it does not.

    Returns
    -------
    Site
        Height over the surface; for nodes of the boundary the distance from its tangent at the
        start, for those at a corner that from the corner.
    """
    size = mean_edge_length(mesh)
    unit_length = surface.mesh.size
    points, step = (mesh.vertices - surface.mesh.origin) / unit_length, size / unit_length
    _, upward = surface_heights(surface, points)
    held = _held_directions(mesh, upward)

    def _misses(shifts: FloatArray) -> Misses:
        heights, gradients = surface_heights(surface, points + step * shifts)
        heights, gradients = heights * weights, gradients * weights[:, None]
        across = np.einsum("vki,vi->vk", held, shifts)
        lengths = np.concatenate([heights[:, None] / step, across], axis=1)
        return Misses(lengths, np.concatenate([gradients[:, None], held], axis=1))

    return _misses


def node_distances(surface: SmoothSurface, mesh: Mesh) -> FloatArray:
    """
    Distances of the nodes of a net from a smooth surface.

    Parameters
    ----------
    surface : SmoothSurface
        The surface.
    mesh : Mesh
        The net, in model coordinates.

    Returns
    -------
    (V,) float array
        In mean edges of the net.
    """
    points = (mesh.vertices - surface.mesh.origin) / surface.mesh.size
    heights, _ = surface_heights(surface, points)
    return np.abs(heights) * surface.mesh.size / mean_edge_length(mesh)


def _held_directions(mesh: Mesh, upward: FloatArray) -> FloatArray:
    """Tangents (V, 2, 3) along which nodes stay: across the boundary, at corners both."""
    topology = mesh.topology
    leaving = np.flatnonzero(topology.twins < 0)
    tails, heads = mesh.corners[leaving], mesh.corners[topology.next_corners[leaving]]
    sides = unit(mesh.vertices[heads] - mesh.vertices[tails])
    ahead, behind = np.zeros((2, mesh.n_vertices, 3))
    ahead[tails], behind[heads] = sides, sides
    along = unit(ahead + behind)
    along = unit(along - dot(along, upward)[:, None] * upward)
    is_corner = norm(ahead - behind) > 2 * np.sin(LINE_CORNER / 2)
    across = np.cross(upward, along)
    return np.stack([across, along * is_corner[:, None]], axis=1)
