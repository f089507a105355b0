"""The surface that a mesh stands for, near each of its vertices: how far a move leaves it.

Around each vertex the surface is the quadric through the vertex that fits two rings of
neighbours, and its boundary the parabola through the two neighbours there. A move along either
is a slide; what it misses is a height, or a move across the rim. Faces would not do: on a mesh
of one degree a vertex that slides by half an edge on the smooth surface is off the facets by
as much as spheres are. All lengths are in mean edges.
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray, dot, norm, sum_by, unit
from ..meshes.mesh import Mesh, mean_edge_length
from ..support.beam_axes import upright_directions
from ..tolerances import LINE_CORNER, RIDGE

CENTER_WEIGHT = 10.0
"""How much more than its neighbours a vertex counts in its own quadric."""

SHORT_SIDE = 0.5
"""Edges shorter than this, in mean edges, narrow the slides of their ends in proportion."""


@dataclass(frozen=True)
class DesignSurface:
    """Quadrics at the vertices, parabolas along the boundary.

    Attributes
    ----------
    frames : (V, 3, 3) float array
        Two tangents and the normal of each vertex, in rows.
    polynomials : (V, 5) float array
        Height over the tangent plane: coefficients of ``u, w, u², u w, w²``.
    reach : (V,) float array
        Share of the slide that edges leave to each vertex: 1, less where they are short.
    rim : (R,) int array
        Vertices of the boundary.
    rim_tangents, rim_bends : (R, 3) float array
        Unit tangents and curvature vectors of the boundary; both zero at its corners.
    """

    frames: FloatArray
    polynomials: FloatArray
    reach: FloatArray
    rim: IntArray
    rim_tangents: FloatArray
    rim_bends: FloatArray


def design_surface(mesh: Mesh) -> DesignSurface:
    """Fit quadrics and parabolas to a mesh.

    Raises
    ------
    InputError
        If a vertex of a face has no normal.
    """
    points = mesh.vertices / mean_edge_length(mesh)
    upward = upright_directions(mesh)
    x_axis = unit(np.cross(upward, np.eye(3)[np.argmin(np.abs(upward), axis=1)]))
    frames = np.stack([x_axis, np.cross(upward, x_axis), upward], axis=1)
    tails, heads = mesh.corners, mesh.corners[mesh.topology.next_corners]
    sides = norm(points[heads] - points[tails])
    shortest = np.full(mesh.n_vertices, np.inf)
    np.minimum.at(shortest, tails, sides)
    np.minimum.at(shortest, heads, sides)
    around = np.concatenate([tails, heads])
    counts = np.bincount(around, minlength=mesh.n_vertices)
    spacing = sum_by(around, np.concatenate([sides, sides]), mesh.n_vertices)
    spacing = np.where(counts > 0, spacing / np.maximum(counts, 1), 1.0)
    return DesignSurface(
        frames,
        _polynomials(mesh, points, frames, spacing),
        np.minimum(shortest / SHORT_SIDE, 1.0),
        *_rim(mesh, points),
    )


def _polynomials(
    mesh: Mesh, points: FloatArray, frames: FloatArray, spacing: FloatArray
) -> FloatArray:
    """Weighted least squares over two rings; what these leave open is as small as can be."""
    centers, others = _two_rings(mesh)
    local = np.einsum("nij,nj->ni", frames[centers], points[others] - points[centers])
    u, w, z = (local / spacing[centers, None]).T
    # With the root of two, least coefficients do not depend on the tangents chosen.
    root = np.sqrt(2.0)
    basis = np.stack([np.ones_like(u), u, w, u * u, root * u * w, w * w], axis=1)
    weights = np.exp(-(u * u + w * w) / 2) + CENTER_WEIGHT * (centers == others)
    weighted = basis * (weights**2)[:, None]
    products = (weighted[:, :, None] * basis[:, None]).reshape(-1, 36)
    gram = sum_by(centers, products, mesh.n_vertices).reshape(-1, 6, 6)
    ridge = RIDGE * np.trace(gram, axis1=1, axis2=2)
    ridge[ridge == 0] = 1.0
    gram += ridge[:, None, None] * np.eye(6)
    right = sum_by(centers, weighted * z[:, None], mesh.n_vertices)
    found: FloatArray = np.asarray(np.linalg.solve(gram, right[..., None])[..., 0], np.float64)
    found[:, 4] *= root
    found[:, 3:] /= spacing[:, None]
    return found[:, 1:]


def _two_rings(mesh: Mesh) -> tuple[IntArray, IntArray]:
    """Pairs of vertices whose faces share a vertex."""
    from scipy.sparse import csr_array

    ones = np.ones(len(mesh.corners))
    shape = (mesh.n_faces, mesh.n_vertices)
    faces = csr_array((ones, mesh.corners, mesh.offsets), shape=shape)
    beside = faces.T @ faces
    pairs = (beside @ beside).tocoo()
    return pairs.row.astype(np.int64), pairs.col.astype(np.int64)


def _rim(mesh: Mesh, points: FloatArray) -> tuple[IntArray, FloatArray, FloatArray]:
    """Vertices, tangents and curvature vectors of the boundary."""
    topology = mesh.topology
    outer = np.flatnonzero(topology.twins < 0)
    tails, heads = mesh.corners[outer], mesh.corners[topology.next_corners[outer]]
    sides = points[heads] - points[tails]
    ahead, behind = np.zeros((2, mesh.n_vertices, 3))
    ahead[tails], behind[heads] = sides, sides
    rim = np.flatnonzero(topology.is_boundary_vertex)
    ahead, behind = ahead[rim], behind[rim]
    turn = unit(ahead) - unit(behind)
    tangents = unit(unit(ahead) + unit(behind))
    lengths = (norm(ahead) + norm(behind)) / 2
    bends = np.divide(
        turn, lengths[:, None], out=np.zeros_like(turn), where=lengths[:, None] > 0
    )
    bends -= dot(bends, tangents)[:, None] * tangents
    is_smooth = (norm(turn) <= 2 * np.sin(LINE_CORNER / 2))[:, None]
    return rim, tangents * is_smooth, bends * is_smooth


def heights(surface: DesignSurface, shifts: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Heights (V,) of shifted vertices over the surface, and their gradients (V, 3)."""
    u, w, z = np.einsum("vij,vj->iv", surface.frames, shifts)
    c = surface.polynomials.T
    lengths = z - (c[0] * u + c[1] * w + c[2] * u * u + c[3] * u * w + c[4] * w * w)
    by_u = -(c[0] + 2 * c[2] * u + c[3] * w)
    by_w = -(c[1] + c[3] * u + 2 * c[4] * w)
    slopes = np.stack([by_u, by_w, np.ones_like(z)], axis=1)
    return lengths, np.einsum("vi,vij->vj", slopes, surface.frames)


def slides(surface: DesignSurface, shifts: FloatArray) -> FloatArray:
    """Slides (V, 2) of shifted vertices, along the two tangents."""
    return np.einsum("vij,vj->vi", surface.frames[:, :2], shifts)


def across_rim(surface: DesignSurface, shifts: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Moves (R, 3) across the boundary, and their derivatives (R, 3, 3) by the shifts.

    At corners of the boundary every move counts.
    """
    moved, tangents, bends = shifts[surface.rim], surface.rim_tangents, surface.rim_bends
    along = dot(moved, tangents)
    lengths = moved - along[:, None] * tangents - (along**2 / 2)[:, None] * bends
    slopes = np.eye(3) - tangents[:, :, None] * tangents[:, None]
    slopes = slopes - (along[:, None] * bends)[:, :, None] * tangents[:, None]
    return lengths, slopes
