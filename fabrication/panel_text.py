"""What a workshop must know of each panel, as user text of a Rhino object."""

from itertools import pairwise
from typing import Final

import numpy as np

from ..kernel.arrays import FloatArray
from ..kernel.panels import Panels, neighbor_ids, panel_areas
from ..kernel.spheres import center_radius

TEXT_KEYS: Final = (
    "id", "face", "mould", "bulge", "radius", "center", "area", "thickness", "neighbors",
    "units",
)  # fmt: skip
"""Keys of the user text of every panel, see `panel_text`."""


def panel_text(panels: Panels, units: str) -> list[dict[str, str]]:
    """
    User text of panels: what a workshop needs without measuring.

    Parameters
    ----------
    panels : Panels
        P panels.
    units : str
        Model units.

    Returns
    -------
    list of dict of str to str
        P mappings with the keys `TEXT_KEYS`. ``bulge`` is out, in or flat, seen along the
        outward normal; ``radius`` is ``plane`` for planes, which have the center ``-``.
        ``mould`` counts from 01, as the layers do; ``-`` without mould. ``neighbors`` are the
        panels beyond each edge, in order; ``-`` where there is none. Lengths and areas are in
        model units.
    """
    centers, radii = centers_and_radii(panels)
    neighbors = [name or "-" for name in neighbor_ids(panels)]
    signs: list[float] = np.sign(panels.spheres[:, 0]).tolist()
    starts: list[int] = panels.offsets.tolist()
    lines = zip(
        panels.ids,
        map(str, panels.face_ids.tolist()),
        map(mould_number, panels.labels.tolist()),
        [{-1.0: "out", 0.0: "flat", 1.0: "in"}[sign] for sign in signs],
        [f"{r:.12g}" if np.isfinite(r) else "plane" for r in radii.tolist()],
        [" ".join(f"{x:.12g}" for x in c) if c[0] < np.inf else "-" for c in centers.tolist()],
        [f"{area:.12g}" for area in panel_areas(panels).tolist()],
        [f"{panels.thickness:.12g}"] * panels.n_panels,
        [" ".join(neighbors[i:j]) for i, j in pairwise(starts)],
        [units] * panels.n_panels,
        strict=True,
    )
    return [dict(zip(TEXT_KEYS, line, strict=True)) for line in lines]


def centers_and_radii(panels: Panels) -> tuple[FloatArray, FloatArray]:
    """
    Centres and radii of the outer faces.

    Parameters
    ----------
    panels : Panels
        P panels.

    Returns
    -------
    centers : (P, 3) float array
        In model coordinates; infinite for planes.
    radii : (P,) float array
        In model units; infinite for planes.
    """
    centers, squares = center_radius(panels.spheres)
    return centers + panels.origins, np.sqrt(squares)


def mould_number(label: int) -> str:
    """
    A mould as texts and layers name it.

    Parameters
    ----------
    label : int
        Mould, from 0; -1 for none.

    Returns
    -------
    str
        ``01``, ``02``, ...; ``-`` for none.
    """
    return f"{label + 1:02d}" if label >= 0 else "-"
