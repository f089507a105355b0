"""What an audit looks at: parts in millimetres, their measures, and what a workshop can do."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, Generic, TypeVar

from ...kernel.arrays import BoolArray, FloatArray
from ...kernel.beams.beams import Beams
from ...kernel.panels.panels import Panels
from ...kernel.parts.findings import Finding, Severity, findings_where


@dataclass(frozen=True)
class AuditLimits:
    """
    What a workshop can do.

    Attributes
    ----------
    corner_deg : float
        Corners of panels and bevels of beams sharper than this break.
    edge_mm : float
        Edges and beams shorter than this are hard to cut.
    wall_tilt_deg : float
        Walls and beams that lean more than this from upright need another tool.
    step_mm : float
        Steps between neighbours, and between the ends of beams at a node, larger than this are
        seen.
    thickness_share : float
        Panels thicker than this share of their smallest radius are hard to form.
    thickness_change : float
        Thicknesses that differ by more than this share from the one asked for.
    blank_mm : float
        Largest blank to be had; infinite for any.
    twist_deg : float
        Beams whose plane misses a node axis by more than this do not fit there.
    depth_share : float
        Beams shallower than this many thicknesses are no beams any more.
    beam_mm : float
        Longest piece that can be cut; infinite for any.
    """

    corner_deg: float = 15.0
    edge_mm: float = 20.0
    wall_tilt_deg: float = 30.0
    step_mm: float = 5.0
    thickness_share: float = 0.2
    thickness_change: float = 0.2
    blank_mm: float = float("inf")
    twist_deg: float = 1.0
    depth_share: float = 2.0
    beam_mm: float = float("inf")


USUAL_LIMITS: Final = AuditLimits()

PartsT = TypeVar("PartsT", bound=Panels | Beams)
FactsT = TypeVar("FactsT")


@dataclass(frozen=True)
class Subject(Generic[PartsT, FactsT]):
    """
    What checks look at.

    Attributes
    ----------
    parts : Panels or Beams
        The parts, in millimetres.
    facts : PanelFacts or BeamFacts
        Their measures, in millimetres.
    limits : AuditLimits
        What the workshop can do.
    """

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
        """
        The findings of one check, see `findings_where`.

        Parameters
        ----------
        code : str
        sizes : (n,) float array
        is_found : (n,) bool array
        message : str
        severity : {"error", "note"}

        Returns
        -------
        list of Finding
            In the order of the parts.
        """
        return findings_where(self.parts.ids, code, sizes, is_found, message, severity)


def warning_texts(findings: Iterable[Finding]) -> dict[str, str]:
    """
    Findings of each part in a line.

    Parameters
    ----------
    findings : iterable of Finding

    Returns
    -------
    dict of str to str
        Codes and messages, separated by semicolons, by the id of the part.
    """
    lines: dict[str, list[str]] = {}
    for finding in findings:
        lines.setdefault(finding.id, []).append(f"{finding.code} {finding.message}")
    return {name: "; ".join(texts) for name, texts in lines.items()}
