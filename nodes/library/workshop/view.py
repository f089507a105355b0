"""A page on which a model turns, shines and answers."""

from collections.abc import Sequence

from ....fabrication.files import check_suffix, replacing
from ....fabrication.model import Model, check_model
from ....fabrication.schedules.columns import beam_columns, panel_columns
from ....fabrication.units import millimeters_per
from ....kernel.beams.beams import Beams
from ....kernel.meshes.mesh import Mesh
from ....kernel.panels.panels import Panels
from ....kernel.parts.findings import Finding
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ....viewer.page.document import PageTexts, page_text
from ...graphs.node import node
from ...graphs.ports import Units, WritePath
from ..fabricate import CutReport


@node
def write_view(
    panels: Panels | None = None,
    path: WritePath = "view.html",
    units: Units = "m",
    beams: Beams | None = None,
    findings: Sequence[Finding] = (),
    cut: CutReport | None = None,
    reference: Mesh | SphereMesh | None = None,
    title: str = "Spherical panels",
) -> str:
    """Write a page for any browser on which panels and beams turn, shine and answer.

    One file, which asks for nothing else and may be sent to anybody. Its surfaces are exact:
    their normals are those of the spheres at every point. It has daylight, zebra stripes and
    mirrored lamps, colours by mould, radius, angle, area and findings with a legend that
    filters, flat panels of the same mesh beside the spheres, sections, parts apart, a card for
    the part that was clicked and a table of all.

    Parameters
    ----------
    panels : Panels, optional
        The panels; these or beams are needed.
    path : path
        Ends in .html.
    units : str
    beams : Beams, optional
        The beams, with their node cylinders if they have any.
    findings : sequence of Finding, optional
        What the node `audit` found: shown on parts, errors red and notes amber.
    cut : CutReport, optional
        Report of the node `panels`: what it rejected is listed as missing.
    reference : Mesh or SphereMesh, optional
        What the panels were cut from: faces without a panel are drawn as outlines.
    title : str
        Heading of the page.

    Returns
    -------
    str
        The path.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from spheremesh.nodes import fit_spheres, panels, vase_mesh, write_view
    >>> made = panels(fit_spheres(vase_mesh(12, 6)), thickness=0.02)
    >>> with TemporaryDirectory() as folder:
    ...     write_view(made.panels, f"{folder}/vase.html").endswith("vase.html")
    True
    """
    check_suffix(path, ".html", ".htm")
    check_model(Model(panels, beams, units), path)
    texts = PageTexts(
        title,
        panel_columns(panels, units),
        beam_columns(beams, panels, units),
        tuple(findings),
        cut["rejected"] if cut is not None else (),
        millimeters_per(units),
    )
    mesh = reference.mesh if isinstance(reference, SphereMesh) else reference
    text = page_text(panels, beams, texts, mesh)
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return str(path)
