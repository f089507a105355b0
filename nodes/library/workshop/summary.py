"""The report of a panelling, to read and to print."""

import numpy as np

from .... import __version__
from ....fabrication.files import check_suffix, replacing
from ....fabrication.units import millimeters_per
from ....kernel.panels.panels import Panels
from ....kernel.sphere_meshes.fit import face_planes
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh, intersection_angles
from ....viewer.report.document import ReportFacts, report_text
from ...graphs.node import node, running_graph
from ...graphs.ports import WritePath
from .drawings import NestingReport
from .report import PanellingReport


@node
def write_report(
    report: PanellingReport,
    panels: Panels,
    sphere_mesh: SphereMesh,
    path: WritePath = "report.html",
    title: str = "Spherical panels",
    sheets: NestingReport | None = None,
) -> str:
    """Write what a panelling came to as a page to read, to send and to print.

    One file without scripts, which asks for nothing else: flat panels and spheres under the
    same stripes, angles as histograms, moulds with their counts and blanks, sheets, gaps, what
    is rejected and why, what it costs, and how to reproduce it, with the graph as a picture.

    Parameters
    ----------
    report : PanellingReport
        Result of `panel_report`.
    panels : Panels
        The panels.
    sphere_mesh : SphereMesh
        What they were cut from.
    path : path
        Ends in .html.
    title : str
        Heading of the page.
    sheets : NestingReport, optional
        Result of `nest_parts`: how many stock sheets beams or blanks are cut from.

    Returns
    -------
    str
        The path.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from spheremesh.nodes import fit_spheres, minimize_angles, panel_report, panels
    >>> from spheremesh.nodes import vase_mesh, write_report
    >>> found = minimize_angles(fit_spheres(vase_mesh(12, 6)))
    >>> made = panels(found.sphere_mesh, thickness=0.02)
    >>> report = panel_report(found.sphere_mesh, found.report, made.report)
    >>> with TemporaryDirectory() as folder:
    ...     path = write_report(report, made.panels, found.sphere_mesh, f"{folder}/report.html")
    ...     path.endswith("report.html")
    True
    """
    check_suffix(path, ".html", ".htm")
    flat = np.degrees(intersection_angles(face_planes(sphere_mesh.mesh)))
    facts = ReportFacts(
        title,
        report,
        flat,
        running_graph(),
        __version__,
        millimeters_per(report["input"]["units"]),
        sheets,
    )
    text = report_text(panels, facts)
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return str(path)
