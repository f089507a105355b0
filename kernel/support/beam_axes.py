"""Node axes between which beams are flat: the axis problem.

A beam is flat and free of torsion if the axes at its two ends lie in one plane with its edge.
Vertices and spheres stay where they are, so a few axes have to please many edges: they are
found by least squares, as near to the normals as the edges let them.
"""

from typing import Final, NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray, dot, unit
from ..meshes.curvature import vertex_normals
from ..meshes.mesh import Mesh
from ..solvers.factorization import solve_definite
from ..tolerances import AXIS_STEP

LEAN_WEIGHT: Final = 0.02
"""Price of an axis that leans by one radian, in radians of twist of an edge."""

LOOSE_LEAN_WEIGHT: Final = 0.01
"""The same where edges outnumber what axes can please (triangles), and to judge feasibility."""

MOST_ROUNDS: Final = 24
"""Rounds of the descent; four to eight are usual."""


def beam_axes(mesh: Mesh, lean_weight: float) -> FloatArray:
    """Axes of the nodes, to the inner side, that make all beams as flat as they can be.

    Parameters
    ----------
    lean_weight : float
        How much an axis that leans counts against an edge that is twisted.

    Returns
    -------
    (V, 3) float array
        Unit vectors; zero for unused vertices.

    Notes
    -----
    Axes ``a = N + t`` minimise ``Σ det(a_i, a_j, e)² + w² Σ |t|²`` over all edges, the boundary
    included: e is the unit vector of the edge from i to j, N the normal of the mesh, t
    tangential and w the weight. All of it is angles, so neither units nor the length of an edge
    matter. Sparse Gauss-Newton steps, solved directly; each is taken only if the sum falls.
    """
    return -unit(_descend(*_problem(mesh, lean_weight)))


class _Problem(NamedTuple):
    """Ends (B, 2) and unit directions (B, 3) of the edges; frames (V, 3, 3), normals first."""

    ends: IntArray
    along: FloatArray
    frames: FloatArray
    weight: float


def _problem(mesh: Mesh, weight: float) -> tuple[_Problem, FloatArray]:
    """The problem, and the leans (V, 2) that it starts from."""
    ends = beam_edges(mesh)
    along = unit(mesh.vertices[ends[:, 1]] - mesh.vertices[ends[:, 0]])
    upright = upright_directions(mesh)
    x = unit(np.cross(upright, np.eye(3)[np.argmin(np.abs(upright), axis=1)]))
    frames = np.stack([upright, x, np.cross(upright, x)], 1)
    return _Problem(ends, along, frames, weight), np.zeros((mesh.n_vertices, 2))


def beam_edges(mesh: Mesh) -> IntArray:
    """Vertices (B, 2) of all edges, the boundary included, in the order of annuli."""
    twins = mesh.topology.twins
    first = np.flatnonzero((twins > np.arange(len(twins))) | (twins < 0))
    return np.stack([mesh.corners[first], mesh.corners[mesh.topology.next_corners[first]]], 1)


def upright_directions(mesh: Mesh) -> FloatArray:
    """Unit normals (V, 3) at the vertices; zero for unused ones."""
    used, corners = np.unique(mesh.corners, return_inverse=True)
    if len(used) == mesh.n_vertices:
        return vertex_normals(mesh)
    faces = np.split(corners, mesh.offsets[1:-1])
    result = np.zeros((mesh.n_vertices, 3))
    result[used] = vertex_normals(Mesh(mesh.vertices[used], faces))
    return result


def _axes(problem: _Problem, leans: FloatArray) -> FloatArray:
    return problem.frames[:, 0] + np.einsum("vk,vki->vi", leans, problem.frames[:, 1:])


def _residuals(problem: _Problem, leans: FloatArray) -> tuple[FloatArray, float]:
    """Twist of the edges, and the sum that is minimised."""
    axes = _axes(problem, leans)
    i, j = problem.ends.T
    twists = dot(np.cross(axes[i], axes[j]), problem.along)
    return twists, float(twists @ twists + problem.weight**2 * np.vdot(leans, leans))


def _descend(problem: _Problem, leans: FloatArray) -> FloatArray:
    twists, energy = _residuals(problem, leans)
    for _ in range(MOST_ROUNDS):
        step = _step(problem, leans, twists)
        share = 1.0
        while True:
            trial = leans + share * step
            trial_twists, trial_energy = _residuals(problem, trial)
            farthest = share * float(np.abs(step).max(initial=0.0))
            if trial_energy <= energy or farthest <= AXIS_STEP:
                break
            share /= 4
        if trial_energy > energy:
            break
        leans, twists, energy = trial, trial_twists, trial_energy
        if farthest <= AXIS_STEP:
            break
    return _axes(problem, leans)


def _step(problem: _Problem, leans: FloatArray, twists: FloatArray) -> FloatArray:
    """The Gauss-Newton step (V, 2)."""
    from scipy.sparse import csr_array

    axes, (i, j) = _axes(problem, leans), problem.ends.T
    toward = np.stack([np.cross(axes[j], problem.along), np.cross(problem.along, axes[i])], 1)
    slopes = np.einsum("bni,bnki->bnk", toward, problem.frames[problem.ends, 1:])
    columns = 2 * problem.ends[:, :, None] + np.arange(2)
    offsets = 4 * np.arange(len(twists) + 1)
    shape = (len(twists), leans.size)
    jacobian = csr_array((slopes.ravel(), columns.ravel(), offsets), shape=shape)
    pull = jacobian.T @ twists + problem.weight**2 * leans.ravel()
    return -solve_definite(jacobian.T @ jacobian, problem.weight**2, pull).reshape(-1, 2)
