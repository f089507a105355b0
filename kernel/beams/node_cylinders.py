"""Node cylinders: the solids at which square cut beams end, about the node axes."""

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray, dot, sum_by
from ..support.node_axes import node_name
from .beams import Beams


@dataclass(frozen=True)
class NodeCylinders:
    """Cylinders of the nodes that carry beams, in the order of their vertices.

    Attributes
    ----------
    ids : tuple of str
        Stable names of the nodes, such as ``N0007``.
    vertices : (N,) int array
        Their vertices.
    origins : (N, 3) float array
        Centres of the outer discs, in model coordinates.
    directions : (N, 3) float array
        Unit vectors along the node axes, to the inner side.
    heights : (N,) float array
        Heights, in model units: from the outermost to the innermost corner of the beams.
    beam_ids : tuple of tuple of str
        Names of the beams that meet there.
    radius : float
        Radius of all, in model units.
    """

    ids: tuple[str, ...]
    vertices: IntArray
    origins: FloatArray
    directions: FloatArray
    heights: FloatArray
    beam_ids: tuple[tuple[str, ...], ...]
    radius: float

    @property
    def n_nodes(self) -> int:
        """Number of cylinders."""
        return len(self.vertices)


def node_cylinders(beams: Beams) -> NodeCylinders:
    """Cylinders about the node axes, as high as the end faces of the beams that meet there.

    One for each node that carries beams; none if the beams have no node radius.

    Notes
    -----
    The axis goes through the mean of the outer corners that the annuli have on it: where the
    node has no torsion that is its line, and the end planes of the beams are at the distance of
    radius and gap from it. Under panels a cylinder begins where it is clear of them.

    References
    ----------
    Meshes with Spherical Faces, Fig. 7.
    """
    annuli = beams.annuli
    radius = beams.node_radius
    nodes = annuli.edge_vertices.ravel()[: None if radius > 0 else 0]
    vertices, first, groups = np.unique(nodes, return_index=True, return_inverse=True)
    n_ends, count = len(nodes), len(vertices)
    # Seen from the first beam of each node, coordinates keep their digits.
    origins = np.repeat(annuli.origins, 2, axis=0)[:n_ends]
    shifts = origins - origins[first][groups]
    tops = annuli.corners[:, :, 0].reshape(-1, 3)[:n_ends] + shifts
    middles = sum_by(groups, tops, count) / np.bincount(groups, minlength=count)[:, None]
    directions = annuli.node_axes.reshape(-1, 3)[first]
    corners = beams.corners.reshape(-1, 6, 3)[:n_ends] + shifts[:, None]
    levels = dot(corners - middles[groups, None], directions[groups, None])
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(low, groups, levels.min(axis=1))
    np.maximum.at(high, groups, levels.max(axis=1))
    if beams.cylinder_tops is not None:
        starts = dot(tops - middles[groups], directions[groups])
        np.maximum.at(low, groups, starts + beams.cylinder_tops.ravel()[:n_ends])
    members: list[list[str]] = [[] for _ in range(count)]
    nodes_of_ends: list[int] = groups.tolist()
    for end, node in enumerate(nodes_of_ends):
        members[node].append(annuli.ids[end // 2])
    return NodeCylinders(
        tuple(node_name(vertex) for vertex in vertices.tolist()), vertices,
        origins[first] + middles + low[:, None] * directions, directions, high - low,
        tuple(map(tuple, members)), radius,
    )  # fmt: skip
