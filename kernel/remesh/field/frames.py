"""Two directions in every triangle, combed over the cut mesh, and their singularities."""

from dataclasses import dataclass

import numpy as np

from ...arrays import BoolArray, ComplexArray, FloatArray, IntArray, dot, norm, sum_by
from ...meshes.topology import Topology, previous_corners
from ...meshes.vertex_fans import VertexFans
from .congruence_mesh import CongruenceMesh
from .conjugate_form import form_roots
from .smoothing import transport


@dataclass(frozen=True)
class CombedFrames:
    """A pair of directions in every face, with the same signs on both sides of most edges.

    Since the form carries its sign, the first directions form a field of lines and the second
    another: of the four symmetries of a cross field only the half turn is left.

    Attributes
    ----------
    first, second : (F,) float array
        Angles in the face frame; from the first to the second is a turn between 0 and π.
    is_real : (F,) bool array
        False where the form had no real roots, or roots that meet at less than the least angle.
    signs : (H,) float array
        -1 where both directions are reversed in the face beyond a half-edge; 1 elsewhere.
    is_seam : (H,) bool array
        Half-edges of the interior edges that are not in the dual spanning tree.
    indices : (V,) int array
        Index of the field at each vertex, in half turns; 0 on the boundary.
    """

    first: FloatArray
    second: FloatArray
    is_real: BoolArray
    signs: FloatArray
    is_seam: BoolArray
    indices: IntArray


def fan_signs(fans: VertexFans, signs: FloatArray) -> FloatArray:
    """Products of signs (H,) at the corners before each corner in its fan; 1 for the first."""
    turns = np.cumsum(signs[fans.corners] < 0) - (signs[fans.corners] < 0)
    vertices = np.repeat(np.arange(len(fans.is_closed)), np.diff(fans.offsets))
    result = np.empty(len(signs))
    result[fans.corners] = 1.0 - 2.0 * ((turns - turns[fans.offsets[:-1]][vertices]) % 2)
    return result


def comb_frames(
    surface: CongruenceMesh,
    fans: VertexFans,
    trace: FloatArray,
    deviator: ComplexArray,
    least: float,
) -> CombedFrames:
    """Directions in the faces from forms at the vertices, and where they are singular.

    Trace and deviator are (V,), in the coordinates of `vertex_frames`; `least` is the least
    angle between the two directions, in radians.
    """
    topology, faces = surface.topology, surface.topology.corner_faces
    corners = surface.triangles.ravel()
    turns = transport(surface.vertex_frames[corners], surface.face_frames[faces])
    face_trace = sum_by(faces, trace[corners], len(surface.triangles))
    moved = deviator[corners] * turns**2
    face_deviator = moved.reshape(-1, 3).sum(axis=1)
    first, second, is_real = form_roots(face_trace, face_deviator, least)
    passage = _passage(surface)
    signs = _match(topology, first, second, passage)
    is_tree, names = _comb(topology, signs)
    heads = np.where(topology.twins >= 0, faces[topology.twins], faces)
    signs = signs * names[faces] * names[heads]
    reversal = np.where(names < 0, np.pi, 0.0)
    first, second = first + reversal, second + reversal
    is_seam = (topology.twins >= 0) & ~is_tree
    indices = _indices(surface, fans, (first + second) / 2, signs, passage)
    return CombedFrames(first, second, is_real, signs, is_seam, indices)


def _passage(surface: CongruenceMesh) -> FloatArray:
    """Angle by which coordinates turn across each half-edge; 0 on the boundary."""
    topology = surface.topology
    heads = topology.corner_faces[np.maximum(topology.twins, 0)]
    frames = surface.face_frames
    turns = np.angle(transport(frames[topology.corner_faces], frames[heads]))
    return np.where(topology.twins >= 0, turns, 0.0)


def _match(
    topology: Topology, first: FloatArray, second: FloatArray, passage: FloatArray
) -> FloatArray:
    """The signs of the two directions beyond each half-edge that turn them least."""
    faces, twins = topology.corner_faces, topology.twins
    heads = faces[np.maximum(twins, 0)]
    likeness = np.cos(first[faces] + passage - first[heads])
    likeness += np.cos(second[faces] + passage - second[heads])
    signs = np.where((twins >= 0) & (likeness < 0), -1.0, 1.0)
    signs[twins[topology.edge_corners]] = signs[topology.edge_corners]
    return signs


def _comb(topology: Topology, signs: FloatArray) -> tuple[BoolArray, FloatArray]:
    """Half-edges of a dual spanning tree, and signs of the faces that are 1 across it."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import breadth_first_order

    faces, twins = topology.corner_faces, topology.twins
    left, right = topology.edge_faces.T
    count = int(faces[-1]) + 1
    graph = csr_array((np.ones(len(left)), (left, right)), shape=(count, count))
    _, parents = breadth_first_order(graph, 0, directed=False)
    parents = np.maximum(parents, 0)
    inner = np.flatnonzero(twins >= 0)
    entering = inner[parents[faces[twins[inner]]] == faces[inner]]
    entering = entering[faces[twins[entering]] != 0]
    children, first = np.unique(faces[twins[entering]], return_index=True)
    entering = entering[first]
    is_tree = np.zeros(len(faces), bool)
    is_tree[entering] = is_tree[twins[entering]] = True
    names = np.ones(count)
    names[children] = signs[entering]
    # Pointer doubling: signs multiply along the way to the root.
    while parents.any():
        names, parents = names * names[parents], parents[parents]
    return is_tree, names


def _indices(
    surface: CongruenceMesh,
    fans: VertexFans,
    middle: FloatArray,
    signs: FloatArray,
    passage: FloatArray,
) -> IntArray:
    """Turning of the field around each vertex, in half turns."""
    topology, faces = surface.topology, surface.topology.corner_faces
    crossed = previous_corners(topology)
    heads = faces[np.maximum(topology.twins[crossed], 0)]
    turning = middle[heads] + np.pi * (signs[crossed] < 0) - middle[faces]
    turning = (turning - passage[crossed] + np.pi) % (2 * np.pi) - np.pi
    here = surface.points[surface.triangles.ravel()]
    ahead = surface.points[np.roll(surface.triangles, -1, axis=1).ravel()] - here
    behind = surface.points[np.roll(surface.triangles, -2, axis=1).ravel()] - here
    angles = np.arctan2(norm(np.cross(ahead, behind)), dot(ahead, behind))
    total = sum_by(surface.triangles.ravel(), turning - angles, len(surface.points))
    indices = np.rint((total + 2 * np.pi) / np.pi).astype(np.int64)
    return np.where(fans.is_closed, indices, 0)
