"""How large a model is in its units, and whether a building can be so."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from ..kernel.meshes.mesh import Mesh, mean_edge_length
from .units import millimeters_per

SMALLEST_EDGE: Final = 5.0
"""Mean edge in millimetres below which a model is likely in another unit: panels of a building
are decimetres to metres wide, and those of models for an exhibition some centimetres."""

LARGEST_EDGE: Final = 100_000.0
"""The same above: no sheet, glass or casting is a tenth of that."""


def describe_size(extents: Sequence[float], mean_edge: float, units: str) -> str:
    """The size of a model, for people.

    Parameters
    ----------
    extents : sequence of 3 floats
        Along x, y and z.
    mean_edge : float
        Mean length of the edges.
    units : str
        Model units, of both.

    Returns
    -------
    str
        One phrase.

    Examples
    --------
    >>> describe_size([38.16, 12.1, 6.4], 1.2071, "m")
    '38.2 x 12.1 x 6.4 m, mean edge 1.21 m'
    """
    *sides, edge = (
        f"{each:.0f}" if 100 <= each < 1e12 else f"{each:.3g}" for each in (*extents, mean_edge)
    )
    return f"{' x '.join(sides)} {units}, mean edge {edge} {units}"


def doubt_size(mesh: Mesh, units: str) -> str:
    """A warning if no building has panels of this size; else nothing.

    Parameters
    ----------
    units : str
        Model units.

    Examples
    --------
    >>> doubt_size(Mesh([[0, 0, 0], [3, 0, 0], [3, 4, 0]], [[0, 1, 2]]), "mm")
    'no building has panels of this size: 3 x 4 x 0 mm, mean edge 4 mm; check the units'
    """
    mean_edge = mean_edge_length(mesh)
    if SMALLEST_EDGE <= millimeters_per(units) * mean_edge <= LARGEST_EDGE:
        return ""
    size = describe_size(model_extents(mesh), mean_edge, units)
    return f"no building has panels of this size: {size}; check the units"


def model_extents(mesh: Mesh) -> list[float]:
    """Size along x, y and z of what the faces cover.

    Returns
    -------
    list of 3 floats
        In model units.
    """
    return np.ptp(mesh.vertices[mesh.corners], axis=0).tolist()
