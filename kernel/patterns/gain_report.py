"""What spheres gain in each pattern, in numbers and in a sentence."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from ..arrays import FloatArray
from ..errors import InputError
from ..reports import Report
from .expected_angles import (
    convex_side,
    hexagon_angles,
    quad_angles,
    smoothest,
    triangle_angles,
)
from .surface_curvatures import SurfaceCurvatures

SHARP_TURN = 1.0
"""Turn of the surface over an edge, in radians at 95 % of the area, that an edge can span."""

ROUND_GAP = 0.1
"""Ranges of k1 and k2 that lie nearer, in inverse edges, leave K no room between them."""

ROUND_SHARE = 0.4
"""Difference of k1 and k2, relative to the larger, of a surface that is all but a sphere."""

WORTH = 0.1
"""Least gain that spheres are worth."""

GainMap = Literal["spheres", "one-radius", "planes", "hexagons", "triangles"]


@dataclass(frozen=True, eq=False)
class GainReport(Report):
    """Expected angles between neighbours, means over the area, in degrees.

    Attributes
    ----------
    edge_length : float
    one_radius : dict
        ``curvature`` that suits all quads best, the median of all principal curvatures, and
        its ``radius``; None for planes.
    quads : dict
        ``planes``, ``spheres`` of smallest angles, spheres of ``one_radius``; ``gain``, the
        share by which spheres lessen the angle of planes, and ``one_radius_gain``.
    hexagons : dict
        ``planes``, convex ``spheres`` on the side the surface bends to, ``gain``.
    triangles : dict
        ``planes``, ``spheres``, ``gain``.
    turn_deg : dict
        Turn of the surface over an edge: ``median`` and ``p95``.
    is_round : bool
        Whether k1 and k2 are so near, as on a sphere, that quads find no directions.
    best : {"quads", "hexagons", "triangles"}
        The pattern whose spheres meet most smoothly.
    advice : str
        What to make of it.
    """

    edge_length: float
    one_radius: dict[str, float | None]
    quads: dict[str, float]
    hexagons: dict[str, float]
    triangles: dict[str, float]
    turn_deg: dict[str, float]
    is_round: bool
    best: str
    advice: str


def check_edge(edge: float) -> None:
    """Refuse lengths of edges that are none.

    Raises
    ------
    InputError
        If the length is not positive and finite.
    """
    if not 0 < edge < np.inf:
        raise InputError(
            f"the edge length must be positive, not {edge:g}; choose one in model units"
        )


def gain_map(
    found: SurfaceCurvatures, edge: float, which: GainMap, convex: FloatArray | None = None
) -> FloatArray:
    """Expected angles (V,) in one pattern, in radians.

    Planes and spheres of one radius are those of quads, as spheres of smallest angles are. The
    spheres of hexagons have given curvatures (V,), or the largest radii that there can be.
    """
    first, second = found.first, found.second
    if which == "hexagons":
        if convex is None:
            convex = convex_side(first, second, _side(found))
        return hexagon_angles(first, second, edge, convex, convex)
    if which == "triangles":
        return triangle_angles(first, second, edge, smoothest(first, second))
    choices = {"spheres": smoothest(first, second), "one-radius": found.best, "planes": 0.0}
    return quad_angles(first, second, edge, choices[which])


def gain_maps(
    found: SurfaceCurvatures,
    edge: float,
    which: Literal["hexagons", "triangles"],
    convex: FloatArray | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Expected angles (V,) with planes and with spheres, in radians."""
    first, second = found.first, found.second
    if which == "triangles":
        return triangle_angles(first, second, edge, 0.0), gain_map(found, edge, which)
    grown = convex_side(first, second, _side(found)) if convex is None else convex
    flat = hexagon_angles(first, second, edge, 0.0, grown)
    return flat, gain_map(found, edge, which, grown)


def _side(found: SurfaceCurvatures) -> int:
    return 1 if found.mean(found.first + found.second) >= 0 else -1


def is_round(found: SurfaceCurvatures, edge: float) -> bool:
    """Whether k1 and k2 are so near each other that the surface is all but a sphere.

    Their middle halves leave K no room, and most of the surface turns alike to all sides. The
    second condition spares surfaces on which the two ranges merely overlap.
    """
    gap = found.quantile(found.first, 0.25) - found.quantile(found.second, 0.75)
    largest = found.quantile(np.maximum(np.abs(found.first), np.abs(found.second)), 0.5)
    apart = found.quantile(found.first - found.second, 0.75)
    return bool(gap < ROUND_GAP / edge and apart < ROUND_SHARE * largest)


def turn_p95(found: SurfaceCurvatures, edge: float) -> float:
    """Turn of the surface over an edge at 95 % of the area, in radians."""
    largest = np.maximum(np.abs(found.first), np.abs(found.second))
    return found.quantile(largest, 0.95) * edge


def gain_report(
    found: SurfaceCurvatures, edge: float, convex: FloatArray | None = None
) -> GainReport:
    """The report of what spheres gain on a surface, with edges of a length.

    The spheres of hexagons may be given by their curvatures (V,).
    """
    first, second, best = found.first, found.second, found.best

    def _mean(angles: FloatArray) -> float:
        return float(np.degrees(found.mean(angles)))

    planes = _mean(gain_map(found, edge, "planes"))
    spheres = _mean(gain_map(found, edge, "spheres"))
    one = _mean(gain_map(found, edge, "one-radius"))
    quads = {
        "planes": planes, "spheres": spheres, "one_radius": one,
        "gain": _gain(planes, spheres), "one_radius_gain": _gain(planes, one),
    }  # fmt: skip
    others: dict[str, Any] = {}
    for name in ("hexagons", "triangles"):
        before, after = (_mean(each) for each in gain_maps(found, edge, name, convex))
        others[name] = {"planes": before, "spheres": after, "gain": _gain(before, after)}
    largest = np.maximum(np.abs(first), np.abs(second))
    angles = {"quads": spheres, **{name: each["spheres"] for name, each in others.items()}}
    turn = turn_p95(found, edge)
    rounded = is_round(found, edge)
    return GainReport(
        edge_length=float(edge),
        one_radius={"curvature": best, "radius": 1 / best if best else None},
        quads=quads,
        hexagons=others["hexagons"],
        triangles=others["triangles"],
        turn_deg={
            "median": float(np.degrees(found.quantile(largest, 0.5) * edge)),
            "p95": float(np.degrees(turn)),
        },
        is_round=rounded,
        best=min(angles, key=lambda name: angles[name]),
        advice=_advice(quads, turn=turn, rounded=rounded, edge=edge),
    )


def _gain(planes: float, spheres: float) -> float:
    return 1 - spheres / planes if planes > 0 else 0.0


def _advice(quads: dict[str, float], *, turn: float, rounded: bool, edge: float) -> str:
    if turn > SHARP_TURN:
        return (
            f"the surface turns by {np.degrees(turn):.0f} degrees over an edge at 5 % of its "
            f"area: panels are larger than its ribs; choose edges of "
            f"{edge * SHARP_TURN / turn:.3g} or less"
        )
    if quads["planes"] == 0:
        return "the surface is flat: planes are smooth already"
    if rounded:
        return (
            "both principal curvatures are nearly the same: spheres all but fit the surface, "
            "but quads find no directions; use upright beams (--support bisector) or hexagons"
        )
    share = 100 * quads["gain"]
    if quads["gain"] < WORTH:
        return (
            f"spheres gain {share:.0f} % over planes in quads: the surface bends to both "
            "sides everywhere, and planes do as well"
        )
    return (
        f"spheres lessen the angle between neighbours by {share:.0f} % in quads, of one radius "
        f"by {100 * quads['one_radius_gain']:.0f} %"
    )
