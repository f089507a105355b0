"""Few moulds: the radii of a sphere mesh gathered into clusters.

Curvatures are clustered, not radii: the radius of a nearly flat panel is arbitrarily large and
would decide alone. The side to which a panel curves is no property of the mould; it is kept.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from typing import NamedTuple

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, sum_by
from ..errors import InputError
from ..meshes.mesh import Mesh, mean_edge_length
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..spheres.circles import Circles, circle_pencils, face_circles, pencil_spheres
from ..tolerances import COMMON_VERTEX, SAME_CURVATURE
from .angle_minimization import pencil_angles
from .comparison import smoothness
from .energies.table import EnergyWeights
from .line_clusters import each_line_clusters, line_clusters
from .pieces import Piece, join_pieces, mesh_pieces
from .whole_energy import Conditions, Optimization, move_vertices

RELAXED_CLOSENESS = 0.05
"""Weight that keeps vertices where they were when nothing else matters."""


@dataclass(frozen=True)
class RadiusClusters:
    """Moulds and the panels that are made on them.

    Attributes
    ----------
    labels : (F,) int array
        Mould of each face, 0 the sharpest.
    radii : (k,) float array
        Radius of each mould, ascending; infinite for a flat one.
    counts : (k,) int array
        Number of faces per mould.
    reassigned : (F,) bool array
        Faces whose own mould would be smaller than their circle, moved to a larger one.
    """

    labels: IntArray
    radii: FloatArray
    counts: IntArray
    reassigned: BoolArray


def cluster_radii(
    sphere_mesh: SphereMesh, k: int, same_sagitta: float = 0.0
) -> tuple[SphereMesh, RadiusClusters]:
    """Replace the radii of all panels by at most k, vertices fixed.

    Parameters
    ----------
    k : int
        Number of moulds, at least 1; fewer come out where fewer can be told apart.
    same_sagitta : float
        Moulds whose sagittas over the largest blank differ by less than this length are one,
        and panels that bulge by less are flat.

    Returns
    -------
    sphere_mesh : SphereMesh
        Spheres through the same circles with the radius of their mould, curved to the same
        side: ``t = asin(ρ / R)``.
    clusters : RadiusClusters
        The moulds.

    Raises
    ------
    InputError
        If k is below 1, or the sagitta negative or not finite.

    Notes
    -----
    The least sum of squared differences of ``|κ|``, exactly (`line_clusters`); flat panels have
    a mould of their own where there are two or more. A panel cannot lie on a sphere smaller
    than its circle (R < ρ): such a face goes to the sharpest mould on which it lies, and the
    flattest mould grows, where necessary, to carry all of its faces.

    Spheres that have one radius already stay: they may pass through vertices that lie on no
    circle.

    References
    ----------
    Meshes with Spherical Faces, Sec. 4.3.
    """
    if k < 1:
        raise InputError(f"the number of moulds must be at least 1, not {k}")
    if not 0 <= same_sagitta < np.inf:
        raise InputError(
            f"sagittas of one mould differ by a length of 0 or more, not by {same_sagitta}"
        )
    own = 2 * np.abs(sphere_mesh.local_spheres[:, 0])
    if np.ptp(own) <= SAME_CURVATURE * own.min():
        return sphere_mesh, _one_mould(own)
    bends = _panel_bends(sphere_mesh, same_sagitta)
    return _on_moulds(bends, _centers(bends.of_moulds(k), k, bends.same))


def each_clustering(
    sphere_mesh: SphereMesh, same_sagitta: float = 0.0
) -> Iterator[tuple[SphereMesh, RadiusClusters]]:
    """What `cluster_radii` gives for k = 1, 2, ..., until no more moulds can be told apart.

    Circles are found once, and a mould more costs one search.

    Raises InputError, as the first is asked for, if the sagitta is negative or not finite.
    """
    first = cluster_radii(sphere_mesh, 1, same_sagitta)
    yield first
    if first[0] is sphere_mesh:
        return  # all have one radius already
    bends = _panel_bends(sphere_mesh, same_sagitta)
    ordered = bends.of_moulds(2)
    curved = np.sort(ordered[ordered > 0])
    if not len(curved):
        return
    is_mixed = len(curved) < len(ordered)
    flat = np.zeros(int(is_mixed))
    # Without a flat mould, the first of these has all panels and is known already.
    for centers in islice(_each_spaced_centers(curved, bends.same), int(not is_mixed), None):
        yield _on_moulds(bends, np.concatenate([flat, centers]))


@dataclass(frozen=True)
class _PanelBends:
    """How panels bend in the pencils of their circles, and what a workshop tells apart.

    Curvatures are absolute, `side` is -1 or 1; panels marked flat have a mould of their own
    where there are two. Curvatures that differ by less than `same` are one.
    """

    mesh: Mesh
    circles: Circles
    radii: FloatArray
    curvatures: FloatArray
    side: FloatArray
    is_flat: BoolArray
    same: float

    def of_moulds(self, k: int) -> FloatArray:
        """Curvatures (F,) as k moulds see them."""
        has_flat = k > 1 or self.is_flat.all()
        return np.where(self.is_flat & has_flat, 0.0, self.curvatures)


def _panel_bends(sphere_mesh: SphereMesh, same_sagitta: float) -> _PanelBends:
    circles, _ = face_circles(sphere_mesh.mesh)
    radii = np.sqrt(circles.radii_squared)
    angles = pencil_angles(sphere_mesh, circles)
    # What rounding leaves of a plane is no curvature.
    angles = np.where(np.abs(np.sin(angles)) < SAME_CURVATURE, 0.0, angles)
    curvatures = np.abs(np.sin(angles)) / radii
    # The sagitta of a blank of radius ρ is κρ²/2 to first order.
    same = 2 * same_sagitta / float(radii.max()) ** 2
    is_flat = curvatures < max(same, SAME_CURVATURE * curvatures.max())
    side = np.where(angles < 0, -1.0, 1.0)
    return _PanelBends(sphere_mesh.mesh, circles, radii, curvatures, side, is_flat, same)


def _on_moulds(bends: _PanelBends, centers: FloatArray) -> tuple[SphereMesh, RadiusClusters]:
    """Every panel on the mould next to it on which it lies; curvatures of moulds ascend."""
    radii, curvatures = bends.radii, bends.of_moulds(len(centers))
    centers = centers.copy()
    centers[0] = min(centers[0], 1 / radii.max())
    nearest = np.searchsorted((centers[1:] + centers[:-1]) / 2, curvatures)
    fitting = np.searchsorted(centers, 1 / radii, side="right") - 1
    chosen = np.minimum(nearest, np.maximum(fitting, 0))
    used, labels = np.unique(-centers[chosen], return_inverse=True)
    moulds = -used
    clustered = bends.side * np.arcsin(np.minimum(radii * moulds[labels], 1.0))
    planes, great_spheres = circle_pencils(bends.circles)
    rows = pencil_spheres(planes, great_spheres, clustered)
    with np.errstate(divide="ignore"):
        clusters = RadiusClusters(
            labels.astype(np.int64), 1 / moulds, np.bincount(labels), chosen != nearest
        )
    return SphereMesh.from_local(bends.mesh, rows), clusters


def _one_mould(curvatures: FloatArray) -> RadiusClusters:
    """The mould of panels that have one radius already."""
    count = len(curvatures)
    with np.errstate(divide="ignore"):
        radius = 1 / curvatures.mean()
    return RadiusClusters(
        np.zeros(count, np.int64),
        np.array([radius]),
        np.array([count]),
        np.zeros(count, bool),
    )


def relax_moulds(
    sphere_mesh: SphereMesh,
    clusters: RadiusClusters,
    tolerance: float,
    regularity: float = 0.0,
    support: float = 0.0,
    edge_weights: FloatArray | None = None,
) -> tuple[SphereMesh, Optimization]:
    """Let vertices and spheres of given radii move to where the angles are smallest.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        Spheres of the moulds' radii, as `cluster_radii` returns them.
    tolerance : float
        How far vertices may move, in mean edges of their piece.
    regularity, support : float
        Weights of upright planes and of nodes without torsion.
    edge_weights : (E,) float array, optional
        Weight of the angle over each interior edge; 1 by default.

    Returns
    -------
    sphere_mesh : SphereMesh
        The same radii, on moved vertices.
    optimization : Optimization
        Where its `vertex_miss` exceeds `COMMON_VERTEX`, the vertices could not reach the
        spheres within the tolerance.

    Raises
    ------
    InputError
        If the tolerance is negative or not finite.

    Notes
    -----
    Of a mesh of several pieces each is relaxed by itself, in its own mean edges; a piece whose
    vertices do not reach their spheres, or whose spheres would meet no more smoothly, stays as
    it is. What is said of the whole is in its mean edges, of the pieces that moved if any did.

    References
    ----------
    Meshes with Spherical Faces, Sec. 4.3.
    """
    mesh = sphere_mesh.mesh
    radii = np.maximum(clusters.radii[clusters.labels], _circle_radii(mesh))
    weights = EnergyWeights(closeness=RELAXED_CLOSENESS, regularity=regularity, support=support)
    smooth = np.ones(len(mesh.topology.edge_corners)) if edge_weights is None else edge_weights
    pieces = mesh_pieces(mesh)
    if len(pieces) == 1:
        conditions = Conditions(edge_weights=smooth, tolerance=tolerance, fixed_radii=radii)
        return move_vertices(sphere_mesh, weights, conditions)
    tried: list[_Relaxed] = []
    for piece in pieces:
        part, part_weights = piece.spheres(sphere_mesh), piece.edge_values(mesh, smooth)
        conditions = Conditions(
            edge_weights=part_weights, tolerance=tolerance, fixed_radii=radii[piece.faces]
        )
        found, run = move_vertices(part, weights, conditions)
        gain = smoothness(part, part_weights).mean - smoothness(found, part_weights).mean
        tried.append(_Relaxed(piece, found, run, gain))
    gained = [each for each in tried if each.is_better]
    kept = gained or tried
    result = join_pieces(
        sphere_mesh, [each.piece for each in kept], [each.found for each in kept]
    )
    return result, _of_pieces(kept, mesh_edge=mean_edge_length(mesh))


class _Relaxed(NamedTuple):
    """What became of a piece, and by how much its mean angle fell."""

    piece: Piece
    found: SphereMesh
    run: Optimization
    gain: float

    @property
    def is_better(self) -> bool:
        return self.run.vertex_miss <= COMMON_VERTEX and self.gain > 0


def _of_pieces(pieces: list[_Relaxed], mesh_edge: float) -> Optimization:
    """One report of several runs; what did not converge comes last."""
    pieces = sorted(pieces, key=lambda each: not each.run.converged)
    runs = [each.run for each in pieces]
    edges = [mean_edge_length(each.piece.mesh) / mesh_edge for each in pieces]
    return Optimization(
        tuple(stage for run in runs for stage in run.stages),
        "common",
        max(run.vertex_move * edge for run, edge in zip(runs, edges, strict=True)),
        max(run.vertex_miss * edge for run, edge in zip(runs, edges, strict=True)),
        all(run.is_held for run in runs),
        min(run.lowest_eigenvalue for run in runs),
    )


def _circle_radii(mesh: Mesh) -> FloatArray:
    return np.sqrt(face_circles(mesh)[0].radii_squared)


def _centers(curvatures: FloatArray, k: int, same: float) -> FloatArray:
    """Ascending cluster centres of the curvatures, at most k, at least `same` apart."""
    curved = np.sort(curvatures[curvatures > 0])
    if not len(curved):
        return np.zeros(1)
    if k == 1:
        return np.array([curvatures.mean()])
    if len(curved) == len(curvatures):
        return _spaced_centers(curved, k, same)
    return np.concatenate([[0.0], _spaced_centers(curved, k - 1, same)])


def _spaced_centers(ordered: FloatArray, k: int, same: float) -> FloatArray:
    """The most centres, up to k, of which none are closer than `same`."""
    values, weights = _distinct(ordered)
    if len(values) <= k and (np.diff(values) >= same).all():
        return values
    scale = float(ordered[-1])
    if same > 0:
        k = int(min(k, 1 + np.ptp(values) // same))
    found = line_clusters(values / scale, weights, min(k, len(values)))
    return scale * next(
        centers for centers in reversed(found) if (scale * np.diff(centers) >= same).all()
    )


def _each_spaced_centers(ordered: FloatArray, same: float) -> Iterator[FloatArray]:
    """What `_spaced_centers` gives for k = 1, 2, ..., until there can be no more."""
    values, weights = _distinct(ordered)
    scale, count = float(ordered[-1]), len(values)
    is_spaced = bool((np.diff(values) >= same).all())
    most = count if is_spaced else int(min(count, 1 + np.ptp(values) // same))
    spaced = values
    for k, centers in enumerate(each_line_clusters(values / scale, weights), 1):
        found = values if k == count else scale * centers
        spaced = found if (np.diff(found) >= same).all() else spaced
        yield spaced
        if k >= most:
            return


def _distinct(ordered: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Numbers that can be told apart, ascending, and how often each occurs."""
    is_next = np.diff(ordered) > SAME_CURVATURE * float(ordered[-1])
    groups = np.concatenate([np.zeros(1, np.int64), np.cumsum(is_next, dtype=np.int64)])
    weights = np.bincount(groups).astype(np.float64)
    return sum_by(groups, ordered, len(weights)) / weights, weights
