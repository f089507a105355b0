"""What a workshop must know of each panel, as user text of a Rhino object."""

from itertools import pairwise
from typing import Final

import numpy as np

from ...kernel.panels.facts import panel_bulges, panel_radii
from ...kernel.panels.panels import Panels, neighbor_ids, panel_areas
from ...kernel.parts.colors import mould_number

TEXT_KEYS: Final = (
    "id", "face", "mould", "bulge", "radius", "center", "area", "thickness", "neighbors",
    "units",
)  # fmt: skip
"""Keys of the user text of every panel, see `panel_text`."""


def panel_text(panels: Panels, units: str) -> list[dict[str, str]]:
    """User text of panels: what a workshop needs without measuring, by the keys `TEXT_KEYS`.

    ``bulge`` is out, in or flat, seen along the outward normal; ``radius`` is that of the
    mould, as in the schedule, and ``plane`` for planes, which have the center ``-``. ``mould``
    counts from 01, as the layers do; ``-`` without mould. ``neighbors`` are the panels beyond
    each edge, in order; ``-`` where there is none. Lengths and areas are in model units.
    """
    found = panel_radii(panels)
    radii, centers = found.radii.tolist(), found.centers.tolist()
    neighbors = [name or "-" for name in neighbor_ids(panels)]
    count = int(panels.labels.max(initial=-1)) + 1
    starts: list[int] = panels.offsets.tolist()
    lines = zip(
        panels.ids,
        map(str, panels.face_ids.tolist()),
        [mould_number(label, count) for label in panels.labels.tolist()],
        panel_bulges(panels),
        [f"{r:.12g}" if np.isfinite(r) else "plane" for r in radii],
        [" ".join(f"{x:.12g}" for x in c) if c[0] < np.inf else "-" for c in centers],
        [f"{area:.12g}" for area in panel_areas(panels).tolist()],
        [f"{thickness:.12g}" for thickness in panels.thicknesses.tolist()],
        [" ".join(neighbors[i:j]) for i, j in pairwise(starts)],
        [units] * panels.n_panels,
        strict=True,
    )
    return [dict(zip(TEXT_KEYS, line, strict=True)) for line in lines]
