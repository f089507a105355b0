"""Property sets and quantities of panels and beams, as IFC has them: from the measured facts.

Lengths are in the unit of the file, areas and volumes in metres, angles in radians.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from ...kernel.beams.beams import Beams
from ...kernel.beams.facts import beam_facts
from ...kernel.panels.facts import panel_bulges, panel_facts
from ...kernel.panels.panels import Panels
from ...kernel.parts.colors import mould_name
from ..step.values import real, string


@dataclass(frozen=True)
class Properties:
    """Properties of a part: names and typed values, of its own set and of the quantities."""

    own: dict[str, str]
    quantities: dict[str, str]


def panel_properties(panels: Panels, scale: float, meters: float) -> Iterator[Properties]:
    """Of each panel; units of the file and metres per model unit."""
    facts, count = panel_facts(panels), int(panels.labels.max(initial=-1)) + 1
    bounds = panels.offsets.tolist()
    lengths, arc_radii = facts.edge_lengths.tolist(), facts.arc_radii.tolist()
    for row, (label, radius, area, volume, size, bulge, thickness) in enumerate(
        zip(
            panels.labels.tolist(), facts.radii.tolist(), facts.areas.tolist(),
            facts.volumes.tolist(), facts.sizes.tolist(), panel_bulges(panels),
            panels.thicknesses.tolist(), strict=True,
        )
    ):  # fmt: skip
        ring = slice(bounds[row], bounds[row + 1])
        own = {"Mould": _label(mould_name(label, count)), "Bulge": _label(bulge)}
        own |= _lengths({"Radius": radius, "Rise": size[2]}, scale)
        for name, values in (("EdgeLength", lengths), ("EdgeRadius", arc_radii)):
            edges = {f"{name}{i:02d}": value for i, value in enumerate(values[ring], 1)}
            own |= _lengths(edges, scale)
        quantities = {
            "Perimeter": _quantity("LENGTH", sum(lengths[ring]) * scale),
            "GrossArea": _quantity("AREA", area * meters**2),
            "NetArea": _quantity("AREA", area * meters**2),
        }
        if thickness > 0:
            quantities["Width"] = _quantity("LENGTH", thickness * scale)
            for name in ("GrossVolume", "NetVolume"):
                quantities[name] = _quantity("VOLUME", volume * meters**3)
        yield Properties(own, quantities)


def beam_properties(beams: Beams, scale: float, meters: float) -> Iterator[Properties]:
    """Of each beam; units of the file and metres per model unit."""
    facts = beam_facts(beams)
    for length, outer, inner, width, volume, bevels in zip(
        facts.lengths.tolist(), facts.outer_radii.tolist(), facts.inner_radii.tolist(),
        facts.widths.tolist(), facts.volumes.tolist(), facts.bevels.tolist(), strict=True,
    ):  # fmt: skip
        own = _lengths(
            {
                "OuterRadius": outer, "InnerRadius": inner, "Depth": width,
                "Thickness": beams.thickness,
            },
            scale,
        )  # fmt: skip
        for end, pair in zip(("Start", "End"), bevels, strict=True):
            for side, bevel in zip(("Lower", "Upper"), pair, strict=True):
                own[f"{end}Bevel{side}"] = f"IFCPLANEANGLEMEASURE({real(bevel)})"
        quantities = {"Length": _quantity("LENGTH", length * scale)}
        for name in ("GrossVolume", "NetVolume"):
            quantities[name] = _quantity("VOLUME", volume * meters**3)
        yield Properties(own, quantities)


def _label(text: str) -> str:
    return f"IFCLABEL({string(text)})"


def _lengths(values: dict[str, float], scale: float) -> dict[str, str]:
    """Lengths that are finite: planes and straight edges have no radius."""
    return {
        name: f"IFCLENGTHMEASURE({real(value * scale)})"
        for name, value in values.items()
        if math.isfinite(value)
    }


def _quantity(kind: str, value: float) -> str:
    return f"IFCQUANTITY{kind}('%s',$,$,{real(value)},$)"
