"""Moulds as surfaces: the cap of each, and where the panels lie on it."""

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray, dot, unit
from ..parts.colors import mould_name
from ..spheres.rows import normalize
from .mould_blanks import panel_caps
from .panels import Panels

_CORNERS = 4


@dataclass(frozen=True)
class MouldCaps:
    """Caps of M moulds, and where P panels lie on them.

    Attributes
    ----------
    caps : Panels
        A panel for each mould, called as the mould: its crown at the origin, bulging to z. Its
        outline is the rim of the smallest cap that holds every panel of the mould; of a flat
        mould, the square around that.
    members : (P,) int array
        The panels that have a mould.
    rows : (P,) int array
        Cap of each of them, a row of `caps`.
    rotations : (P, 3, 3) float array
        Rotation Q of the motion ``x ↦ Q x + t`` that brings the cap under the panel.
    translations : (P, 3) float array
        Translation t, in model coordinates.
    """

    caps: Panels
    members: IntArray
    rows: IntArray
    rotations: FloatArray
    translations: FloatArray


def mould_caps(panels: Panels) -> MouldCaps:
    """The caps of moulds, in the order of their labels.

    A mould serves panels that bulge out and in; these lie on it upside down.
    """
    found = panel_caps(panels)
    members = np.flatnonzero(panels.labels >= 0)
    labels, rows = np.unique(panels.labels[members], return_inverse=True)
    radii, curvatures = np.zeros((2, len(labels)))
    np.maximum.at(radii, rows, found.radii[members])
    np.maximum.at(curvatures, rows, 2 * np.abs(panels.design_spheres[members, 0]))
    count = int(panels.labels.max(initial=-1)) + 1
    names = tuple(mould_name(label, count) for label in labels.tolist())
    side = np.where(panels.design_spheres[members, 0] > 0, -1.0, 1.0)[:, None]
    z = side * found.axes[members]
    first = panels.offsets[members]
    chords = panels.corners[panels.next_corners[first]] - panels.corners[first]
    x = unit(chords - dot(chords, z)[:, None] * z)
    crowns = found.centers + found.sagittas[:, None] * found.axes
    return MouldCaps(
        _cap_panels(names, labels, radii, curvatures),
        members,
        rows,
        np.stack([x, np.cross(z, x), z], 2),
        crowns[members] + panels.origins[members],
    )


def _cap_panels(
    names: tuple[str, ...], labels: IntArray, radii: FloatArray, curvatures: FloatArray
) -> Panels:
    """Caps of rim radii and curvatures, as panels whose cutting planes are all the rim's."""
    n_caps = len(names)
    up = np.array([0.0, 0.0, 1.0])
    rows = np.zeros((n_caps, 5))
    rows[:, 0], rows[:, 3] = -curvatures / 2, 1.0
    rows = normalize(rows)
    sine = np.minimum(curvatures * radii, 1.0)
    depths = curvatures * radii**2 / (1 + np.sqrt(1 - sine**2))
    angles = np.pi / 4 + np.pi / 2 * np.arange(_CORNERS)
    reaches = np.where(curvatures > 0, radii, np.sqrt(2) * radii)
    outline = np.stack([np.cos(angles), np.sin(angles), 0 * angles], 1)
    corners = reaches[:, None, None] * outline - depths[:, None, None] * up
    corners = corners.reshape(-1, 3)
    n_corners = len(corners)
    nobody = np.full(n_corners, -1)
    return Panels(
        ids=names,
        face_ids=np.arange(n_caps),
        labels=labels,
        origins=np.zeros((n_caps, 3)),
        spheres=rows,
        inner_spheres=rows,
        design_spheres=rows,
        offsets=_CORNERS * np.arange(n_caps + 1),
        plane_normals=np.tile(up, (n_corners, 1)),
        plane_offsets=corners[:, 2],
        corners=corners,
        inner_corners=corners,
        neighbors=nobody,
        edge_ids=nobody,
        is_crease=np.zeros(n_corners, bool),
        thicknesses=np.zeros(n_caps),
        thickness=0.0,
        joint_gap=0.0,
    )
