"""
Identical panels: which ones a motion brings onto each other, and by which motion.

Mirror images are different panels. Each panel is looked at from each of its corners in turn: in
the frame of N and the direction to that corner, identical panels have the same coordinates.
"""

from dataclasses import dataclass

import numpy as np

from .arcs import arc_points
from .arrays import FloatArray, IntArray, dot, norm, sum_by, unit
from .panels import Panels, panel_arcs
from .spheres import normals, project
from .tolerances import SAME_PANEL


@dataclass(frozen=True)
class PanelKinds:
    """
    Panels grouped by shape.

    Attributes
    ----------
    kinds : (P,) int array
        Kind of each panel, numbered by first appearance.
    representatives : (K,) int array
        First panel of each kind.
    rotations : (P, 3, 3) float array
        Rotation of the representative onto each panel.
    translations : (P, 3) float array
        Where the origin of the representative goes, in model coordinates: the point x local to
        the representative goes to ``rotation @ x + translation``.
    deviations : (P,) float array
        Largest distance of the corners and arcs of the moved representative from those of the
        panel, in model units.
    """

    kinds: IntArray
    representatives: IntArray
    rotations: FloatArray
    translations: FloatArray
    deviations: FloatArray


@dataclass(frozen=True)
class _Views:
    """n panels of degree k seen from each corner: coordinates (n, k, m), frames, feet."""

    coordinates: FloatArray
    frames: FloatArray
    feet: FloatArray
    sizes: FloatArray


def identical_panels(panels: Panels) -> PanelKinds:
    """
    Group panels that are equal up to a motion and share their mould.

    Parameters
    ----------
    panels : Panels
        P panels.

    Returns
    -------
    PanelKinds
        The kinds. Panels are identical to the first of their kind where corners (outer and
        inner) and arcs agree to `SAME_PANEL` of the panel's size.
    """
    first, rotations = np.arange(panels.n_panels), np.tile(np.eye(3), (panels.n_panels, 1, 1))
    translations, deviations = panels.origins.copy(), np.zeros(panels.n_panels)
    classes = np.stack([panels.degrees, panels.labels], 1)
    pairs: list[list[int]] = np.unique(classes, axis=0).tolist()
    for pair in pairs:
        ids = np.flatnonzero((classes == pair).all(1))
        views = _views(panels, ids)
        leaders, turns = _follow(views)
        moved = views.frames[np.arange(len(ids)), turns].transpose(0, 2, 1)
        rotations[ids] = moved @ views.frames[leaders, 0]
        feet = np.einsum("nij,nj->ni", rotations[ids], views.feet[leaders])
        translations[ids] = panels.origins[ids] + views.feet - feet
        seen = views.coordinates[np.arange(len(ids)), turns] - views.coordinates[leaders, 0]
        deviations[ids] = norm(seen.reshape(len(ids), -1, 3)).max(1)
        first[ids] = ids[leaders]
    representatives, kinds = np.unique(first, return_inverse=True)
    return PanelKinds(kinds, representatives, rotations, translations, deviations)


def _views(panels: Panels, ids: IntArray) -> _Views:
    degree = int(panels.degrees[ids[0]])
    corner_ids = panels.offsets[ids][:, None] + np.arange(degree)
    middles = arc_points(panel_arcs(panels), np.zeros(1))[:, 0]
    points = np.stack([panels.corners, middles, panels.inner_corners], 1)[corner_ids]
    rows = panels.spheres[ids]
    feet = project(rows, points[:, :, 0].mean(1))
    local = points - feet[:, None, None]
    upwards = unit(normals(rows, feet))[:, None]
    spokes = local[:, :, 0]
    forwards = unit(spokes - dot(spokes, upwards)[..., None] * upwards)
    upwards = np.broadcast_to(upwards, forwards.shape)
    frames = np.stack([forwards, np.cross(upwards, forwards), upwards], 2)
    turned = np.stack([np.roll(local, -turn, 1) for turn in range(degree)], 1)
    coordinates = np.einsum("nkij,nkabj->nkabi", frames, turned)
    sizes = norm(spokes).max(1)
    return _Views(coordinates.reshape(len(ids), degree, -1), frames, feet, sizes)


def _follow(views: _Views) -> tuple[IntArray, IntArray]:
    """The first identical panel (n,) of each, and from which corner it looks the same."""
    from scipy.spatial import cKDTree

    count, degree, width = views.coordinates.shape
    tree = cKDTree(views.coordinates.reshape(-1, width))
    reach = SAME_PANEL * views.sizes
    near = tree.query_ball_point(views.coordinates[:, 0], reach, p=np.inf)
    leaders, turns = np.full(count, -1), np.zeros(count, np.int64)
    for panel, seen in enumerate(near):
        if leaders[panel] < 0:
            other, turn = np.divmod(np.sort(np.array(seen)), degree)
            is_free = leaders[other] < 0
            # Of several corners the first: assigned backwards, it is the last one to be set.
            leaders[other[is_free]] = panel
            turns[other[is_free][::-1]] = turn[is_free][::-1]
            turns[panel] = 0
    return leaders, turns


def panel_kinds_report(kinds: PanelKinds) -> dict[str, float | int]:
    """
    How many panels are alike.

    Parameters
    ----------
    kinds : PanelKinds
        The kinds.

    Returns
    -------
    dict
        ``panels``, ``kinds``, ``repeated_kinds`` (of two panels or more), ``repeated_panels``
        (panels in these), ``largest_kind`` and ``deviation`` in model units.
    """
    ones = np.ones(len(kinds.kinds))
    counts = sum_by(kinds.kinds, ones, len(kinds.representatives))
    is_repeated = counts > 1
    return {
        "panels": len(kinds.kinds),
        "kinds": len(counts),
        "repeated_kinds": int(is_repeated.sum()),
        "repeated_panels": int(counts[is_repeated].sum()),
        "largest_kind": int(counts.max(initial=0)),
        "deviation": float(kinds.deviations.max(initial=0)),
    }
