"""Beams of a support structure, and the marks for drilling them."""

from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

from ....kernel.beams.beams import Beams, beam_lengths, beam_volumes
from ....kernel.beams.cutting import cut_beams
from ....kernel.beams.drilling import drill_beams
from ....kernel.beams.layers import beams_under_panels
from ....kernel.errors import InputError
from ....kernel.panels.panels import Panels
from ....kernel.parts.findings import findings_report, rejected_report
from ....kernel.reports import Report
from ....kernel.support.annuli import Annuli, corner_mismatch, mean_end_depth
from ...graphs.node import node, warn
from ...graphs.ports import Port
from .rejected import warn_of_rejected


@dataclass(frozen=True, eq=False)
class BeamsReport(Report):
    """The beams that can be made, and the others.

    Attributes
    ----------
    written : int
    rejected : list of dict
        ``id``, ``code`` and ``reason`` of each beam that cannot be made.
    volume, longest : float
        Of all beams, in cubed model units; of the longest piece.
    end_mismatch : float
        How far the ends at a node are apart.
    """

    written: int
    rejected: list[dict[str, str]]
    volume: float
    longest: float
    end_mismatch: float


@dataclass(frozen=True, eq=False)
class DrillingReport(Report):
    """The beams that are marked, and the others.

    Attributes
    ----------
    marked : int
        Number of beams.
    diameter, inset : float
        In model units.
    counts : dict
        Number of notes by code.
    notes : list of dict
        ``code``, ``id``, ``message`` and ``size`` on each beam into which the holes do not fit.
    """

    marked: int
    diameter: float
    inset: float
    counts: dict[str, int]
    notes: list[dict[str, Any]]


class BeamSet(NamedTuple):
    """The beams that can be made, and what was found while cutting them."""

    beams: Beams
    report: BeamsReport


class MarkedBeams(NamedTuple):
    """Beams with drilling marks, and those without."""

    beams: Beams
    report: DrillingReport


@node(version="2")
def beams(
    annuli: Annuli,
    thickness: Annotated[float | None, Port(min=0)] = None,
    node_gap: Annotated[float, Port(min=0)] = 0.0,
    node_radius: Annotated[float, Port(min=0)] = 0.0,
    panels: Panels | None = None,
    bearing: Annotated[float, Port(min=0)] = 0.0,
) -> BeamSet:
    """Give annuli a thickness and cut their ends where beams meet at the nodes.

    Parameters
    ----------
    annuli : Annuli
    thickness : float, optional
        Thickness of the beams, half to either side, in model units; by default a tenth of the
        mean depth at the nodes.
    node_gap : float
        Width of the gap between neighbouring beams, or between beams and node cylinders.
    node_radius : float
        Radius of cylinders about the node axes before which beams end square. With 0 the ends
        are mitred: cut by the half planes through the axis that bisect the angles between
        neighbours.
    panels : Panels, optional
        Panels that rest on the beams: beams keep their depth, and begin below the inner faces
        of the panels beside them; those of a node begin at one level of its axis.
    bearing : float
        Clear distance from panel to beam, in model units.

    Returns
    -------
    beams : Beams
        The beams that can be made.
    report : BeamsReport
        Number and size, and the beams that cannot be made.

    Examples
    --------
    >>> from spheremesh.nodes import annulus_support, beams, ellipsoid_mesh, model_change
    >>> sphere_mesh = model_change(ellipsoid_mesh(12, 6), radius=4.0)
    >>> annuli = annulus_support(sphere_mesh, depth=0.1).annuli
    >>> beams(annuli, thickness=0.02).report["written"]
    156
    """
    if thickness is None:
        if annuli.n_annuli == 0:
            raise InputError(
                "there is no annulus to make a beam of: the report of annulus_support lists "
                "the rejected ones with reasons"
            )
        thickness = mean_end_depth(annuli) / 10
    if panels is None:
        made, rejected = cut_beams(annuli, thickness, node_gap, node_radius)
    else:
        made, rejected = beams_under_panels(
            annuli, panels, thickness, node_gap, node_radius, bearing
        )
    warn_of_rejected(rejected, "beams")
    report = BeamsReport(
        written=made.n_beams,
        rejected=rejected_report(rejected),
        volume=float(beam_volumes(made).sum()),
        longest=float(beam_lengths(made).max(initial=0.0)),
        end_mismatch=float(corner_mismatch(made.annuli).max(initial=0.0)),
    )
    return BeamSet(made, report)


@node
def drilling_marks(
    beams: Beams,
    count: Annotated[int, Port(min=1, max=1000)] = 2,
    diameter: Annotated[float | None, Port(min=0)] = None,
    inset: Annotated[float | None, Port(min=0)] = None,
) -> MarkedBeams:
    """Mark where beams are to be drilled at their ends, along the lines of the node axes.

    Parameters
    ----------
    beams : Beams
    count : int
        Number of holes at each end, in a row; each has the same share of it.
    diameter : float, optional
        Diameter of the holes, in model units; by default the thickness of the beams, and at
        most a quarter of each hole's share of the mean depth.
    inset : float, optional
        Distance of their centres from the end, from where its cut reaches farthest into the
        beam; by default one and a half diameters.

    Returns
    -------
    beams : Beams
        The same beams with their marks: circles in the drawing and in the Rhino file.
    report : DrillingReport
        Number and size of the marks, and the beams into which they do not fit.

    Examples
    --------
    >>> from spheremesh.nodes import annulus_support, beams, drilling_marks, ellipsoid_mesh
    >>> from spheremesh.nodes import model_change
    >>> sphere_mesh = model_change(ellipsoid_mesh(12, 6), radius=4.0)
    >>> made = beams(annulus_support(sphere_mesh, depth=0.1).annuli, thickness=0.02).beams
    >>> drilling_marks(made, diameter=0.01).report["marked"]
    156
    """
    if diameter is None:
        diameter = min(beams.thickness, mean_end_depth(beams.annuli) / (4 * count))
    if inset is None:
        inset = 1.5 * diameter
    marked, findings = drill_beams(beams, count, diameter, inset)
    if findings:
        first = findings[0]
        warn(f"{len(findings)} beams get no drilling marks: {first.id}: {first.message}")
    found = findings_report(findings)
    report = DrillingReport(
        beams.n_beams - len(findings), diameter, inset, found["counts"], found["notes"]
    )
    return MarkedBeams(marked, report)
