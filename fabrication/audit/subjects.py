"""What an audit looks at: parts in millimetres, their measures, and what a workshop can do."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, Generic, TypeVar

import numpy as np

from ...kernel.arrays import BoolArray, FloatArray
from ...kernel.beams.beams import Beams
from ...kernel.panels.panels import Panels
from ...kernel.parts.findings import Finding, Severity


@dataclass(frozen=True)
class AuditLimits:
    """What a workshop can do."""

    corner_deg: float = 15.0  # corners of panels and bevels of beams sharper than this break
    edge_mm: float = 20.0  # edges and beams shorter than this are hard to cut
    wall_tilt_deg: float = 30.0  # walls and beams that lean more need another tool
    step_mm: float = 5.0  # larger steps of neighbours, or of the ends of beams, do not fit
    gap_mm: float = 5.0  # wider gaps along joints and holes at nodes cannot be closed
    overlap_mm: float = 0.01  # parts that overlap by less touch
    thickness_share: float = 0.2  # thicker against the smallest radius is hard to form
    thickness_change: float = 0.2  # share by which it may differ from the one asked for
    blank_mm: float = float("inf")  # largest blank to be had; infinite for any
    twist_deg: float = 0.1  # beams that miss a node axis by more do not fit there
    depth_share: float = 2.0  # beams shallower than this many thicknesses are none any more
    beam_mm: float = float("inf")  # longest piece that can be cut; infinite for any


USUAL_LIMITS: Final = AuditLimits()

PartsT = TypeVar("PartsT", bound=Panels | Beams)
FactsT = TypeVar("FactsT")


@dataclass(frozen=True)
class Subject(Generic[PartsT, FactsT]):
    """What checks look at: parts and their measures in millimetres, and the limits."""

    parts: PartsT
    facts: FactsT
    limits: AuditLimits

    def found(
        self,
        code: str,
        sizes: FloatArray,
        is_found: BoolArray,
        message: str,
        severity: Severity = "note",
    ) -> list[Finding]:
        """The findings of one check, in the order of the parts.

        The sizes (n,) are how much was found on each; the message has a field for the size.
        """
        ids = self.parts.ids
        values: list[float] = sizes.tolist()
        return [
            Finding(code, ids[i], message.format(values[i]), values[i], severity)
            for i in np.flatnonzero(is_found).tolist()
        ]


def warning_texts(findings: Iterable[Finding]) -> dict[str, str]:
    """Findings of each part in a line, by its id: codes and messages, after semicolons."""
    lines: dict[str, list[str]] = {}
    for finding in findings:
        lines.setdefault(finding.id, []).append(f"{finding.code} {finding.message}")
    return {name: "; ".join(texts) for name, texts in lines.items()}
