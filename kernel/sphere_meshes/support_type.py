"""The sphere ω to which all spheres of a mesh are orthogonal, and what kind of sphere it is.

A triangular sphere mesh with a support structure has one: real, imaginary or a point, and the
planes and axes of the structure pass through its centre. It may be a plane as well, or, for a
mesh of planes, infinity.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..arrays import FloatArray, dot, norm
from ..meshes.mesh import face_centroids
from ..spheres.minkowski import minkowski
from ..spheres.pentaspherical import SIGNATURE, from_pentaspherical, pentaspherical
from ..spheres.rows import lift_points, recenter
from ..tolerances import EPSILON, NOISE_MARGIN, SUPPORT_MISS
from .sphere_mesh import SphereMesh

SupportKind = Literal["real", "imaginary", "point", "plane", "infinity", "none"]


@dataclass(frozen=True)
class SupportType:
    """What all spheres of a mesh have in common.

    Attributes
    ----------
    kind : {"real", "imaginary", "point", "plane", "infinity", "none"}
        What ω is: a sphere that all meet at a right angle; an imaginary one, whose real
        representative all meet in great circles; a point through which all pass; a plane on
        which all are centred; infinity, through which planes pass; or that there is none.
    omega : (5,) float array
        Row of ω in model coordinates: of norm 1 (with A > 0, or a plane), -1 (with A > 0) or 0
        (A = 1; for infinity ``(0, 0, 0, 0, 1)``). If there is none, the row that comes nearest.
    residual : float
        Root mean square of the products ``<<s, ω>>``, with the rows of the spheres and of ω of
        Euclidean length 1, in coordinates about the middle of the mesh and of its size.
    """

    kind: SupportKind
    omega: FloatArray
    residual: float


def support_type(sphere_mesh: SphereMesh, tolerance: float = SUPPORT_MISS) -> SupportType:
    """Find the sphere, plane or point orthogonal to all spheres of a mesh.

    The tolerance is the largest residual at which there is said to be one. Kind, ω and residual
    are independent of units, place and numbering.

    Notes
    -----
    ω is J times the last right singular vector of the stacked rows, each of Euclidean length 1
    (unit rows of small spheres are long, and would weigh more than they know). The last
    singular value σ₅ measures what of the rows is noise; by Wedin's theorem it turns ω by an
    angle of at most about σ₅ / σ, where σ is the least singular value above the noise, and so
    changes ``<<ω, ω>>``, the number whose sign tells the kind, by twice that. A norm within
    `NOISE_MARGIN` times this is taken for 0: a mesh of spheres through a point, blurred by
    noise, stays one, and no small real or imaginary ω is invented from noise. This holds for
    systematic errors as for random ones. With four spheres or fewer nothing is left to tell
    the noise from: then it is taken to be rounding.

    If several ω fit equally well (all spheres one sphere, or of revolution about an axis) one
    of them is returned; infinity if it is among them.

    References
    ----------
    Meshes with Spherical Faces, Lemma 5.1 and Prop. 5.2.
    """
    rows, middle, size = _rows_about_middle(sphere_mesh)
    count = len(rows)
    padded = np.concatenate([rows, np.zeros((5, 5))])
    _, values, vectors = np.linalg.svd(padded @ SIGNATURE, full_matrices=False)
    vector = vectors[-1]
    noise = max(
        float(values[4]) * np.sqrt(count / max(count - 4, 1)), 64 * EPSILON * float(values[0])
    )
    residual = float(values[4] / np.sqrt(count))
    flat = np.array([0.0, 0.0, 0.0, 0.0, 1.0])
    if norm(rows[:, 3] - rows[:, 4]) <= NOISE_MARGIN * noise and residual <= tolerance:
        return SupportType("infinity", flat, residual)
    least_clear = values[values > NOISE_MARGIN * noise].min(initial=values[0])
    uncertainty = NOISE_MARGIN * noise / float(least_clear)
    row = from_pentaspherical(vector)
    kind = _kind(row, uncertainty) if residual <= tolerance else "none"
    return SupportType(kind, _to_model(row, kind, middle, size), residual)


def _rows_about_middle(sphere_mesh: SphereMesh) -> tuple[FloatArray, FloatArray, float]:
    """Pentaspherical rows (F, 5) of length 1, about the mean corner, in units of the size."""
    mesh = sphere_mesh.mesh
    first = mesh.vertices[mesh.corners[0]]
    relative = mesh.vertices[mesh.corners] - first
    shift = relative.mean(axis=0)
    spread = relative - shift
    size = float(np.sqrt(dot(spread, spread).mean()))
    away = shift - (face_centroids(mesh) - first)
    rows = recenter(sphere_mesh.local_spheres, away)
    rows = pentaspherical(rows * np.array([size, 1, 1, 1, 1 / size]))
    return rows / norm(rows)[:, None], first + shift, size


def _kind(row: FloatArray, uncertainty: float) -> SupportKind:
    """Kind of a row whose pentaspherical length is 1 and which is known to an angle."""
    square = float(minkowski(row, row))
    if abs(square) <= 2 * uncertainty:
        return "point"
    if square < 0:
        return "imaginary"
    return "plane" if abs(float(row[0])) <= uncertainty else "real"


def _to_model(
    row: FloatArray, kind: SupportKind, middle: FloatArray, size: float
) -> FloatArray:
    """Row in model coordinates, scaled and oriented as `SupportType` says."""
    if kind == "point":
        return lift_points(middle + size * row[1:4] / (2 * row[0]))
    row = row * np.copysign(1.0, row[0])
    if kind == "plane":
        row = np.concatenate([np.zeros(1), row[1:]])
        row *= np.copysign(1.0, row[1:4][np.argmax(np.abs(row[1:4]))])
    row = row / np.sqrt(abs(float(minkowski(row, row))))
    return recenter(row * np.array([1 / size, 1, 1, 1, size]), -middle)
