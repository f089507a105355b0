"""Drawings: for cutting, of moulds, and whole sets of them; how pieces lie on sheets."""

from dataclasses import dataclass
from typing import Any, Literal

from ....fabrication.drawings import beams as dxf
from ....fabrication.drawings import drawing_set, moves, stock_sheets
from ....fabrication.drawings import moulds as mould_drawings
from ....fabrication.drawings.nesting import Stock
from ....fabrication.model import Model
from ....kernel.beams.beams import Beams
from ....kernel.meshes.mesh import Mesh
from ....kernel.panels.panels import Panels
from ....kernel.reports import Report
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...graphs.node import node, warn
from ...graphs.ports import Length, Units, WritePath
from ..fabricate import told_path


@node(version="2")
def write_dxf(
    beams: Beams,
    path: WritePath,
    units: Units = "m",
    sheet: tuple[float, float] = (3000.0, 1500.0),
    spacing: Length = 10.0,
    margin: Length | None = None,
    nesting: Literal["rows", "rectangles"] = "rows",
    grain: Literal["along", "any"] = "along",
) -> str:
    """Write cutting drawings of beams: exact contours, nested on sheets, in millimetres.

    Parameters
    ----------
    beams : Beams
    path : path
        Ends in .dxf.
    units : str
    sheet : (float, float)
        Width and height of the sheets, in millimetres.
    spacing : float
        Distance between pieces, the cut included, in millimetres.
    margin : float, optional
        Distance from the rim, in millimetres; the spacing by default.
    nesting : {"rows", "rectangles"}
        One row above the other; or rectangles about the beams on as few sheets as a short
        search finds (with the extra ``drawings``).
    grain : {"along", "any"}
        Whether nested beams lie along the width of the sheets, or may be turned.

    Returns
    -------
    str
        The path. Layers: CUT, ENGRAVE (ids, nodes, bevels of the ends in degrees), DRILL
        (drilling marks) and SHEET.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from spheremesh.nodes import annulus_support, beams, ellipsoid_mesh, model_change
    >>> from spheremesh.nodes import write_dxf
    >>> sphere_mesh = model_change(ellipsoid_mesh(12, 6), radius=4.0)
    >>> made = beams(annulus_support(sphere_mesh, depth=0.1).annuli, thickness=0.02)
    >>> with TemporaryDirectory() as folder:
    ...     write_dxf(made.beams, f"{folder}/beams.dxf").endswith("beams.dxf")
    True
    """
    options = dxf.SheetOptions(sheet, spacing, margin, nesting, grain)
    return told_path(dxf.write_dxf(Model(beams=beams, units=units), path, options))


@node(version="2")
def write_mould_drawings(panels: Panels, path: WritePath, units: Units = "m") -> str:
    """Draw every panel in the blank of its mould, with radius, sizes and ids, in millimetres.

    Parameters
    ----------
    panels : Panels
    path : path
        Ends in .dxf or .svg.
    units : str

    Returns
    -------
    str
        The path.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from spheremesh.nodes import fit_spheres, panels, vase_mesh, write_mould_drawings
    >>> made = panels(fit_spheres(vase_mesh(12, 6)))
    >>> with TemporaryDirectory() as folder:
    ...     write_mould_drawings(made.panels, f"{folder}/panels.svg").endswith("panels.svg")
    True
    """
    return told_path(mould_drawings.write_mould_drawings(Model(panels, units=units), path))


@node
def write_move_drawing(
    mesh: Mesh, sphere_mesh: SphereMesh, path: WritePath, units: Units = "m"
) -> str:
    """Draw the design and how far its vertices moved, in millimetres.

    Parameters
    ----------
    mesh : Mesh
        The design.
    sphere_mesh : SphereMesh
        The same mesh with vertices that an optimisation moved.
    path : path
        Ends in .dxf or .svg.
    units : str

    Returns
    -------
    str
        The path. Layers: PLAN (edges of the design), MARK (a circle about every vertex that
        moved, as large as its move in one scale) and TEXT (the largest move, and the scale).

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from spheremesh.nodes import fit_spheres, optimize_spheres, vase_mesh
    >>> from spheremesh.nodes import write_move_drawing
    >>> mesh = vase_mesh(12, 6)
    >>> optimum = optimize_spheres(fit_spheres(mesh), tolerance=0.02)
    >>> with TemporaryDirectory() as folder:
    ...     write_move_drawing(mesh, optimum.sphere_mesh, f"{folder}/moves.svg")[-9:]
    'moves.svg'
    """
    return told_path(moves.write_move_drawing(mesh, sphere_mesh.mesh, path, units))


@node
def write_drawings(  # noqa: PLR0913, PLR0917 - a node has an input per choice
    panels: Panels | None = None,
    path: WritePath = "drawings.pdf",
    units: Units = "m",
    beams: Beams | None = None,
    paper: Literal["A4", "A3", "A2", "A1", "A0"] = "A3",
    project: str = "spheremesh",
    revision: str = "-",
    date: str = "",
    panel_material: str = "glass",
    beam_material: str = "steel",
) -> str:
    """Write a set of drawings: key plans, panels mould by mould, beams with their ends.

    Parameters
    ----------
    panels : Panels, optional
        The panels; these or beams are needed.
    path : path
        Ends in .pdf (with the extra ``drawings``), .svg, or .dxf, where all is in true size.
    units : str
    beams : Beams, optional
    paper : {"A4", "A3", "A2", "A1", "A0"}
        Size of the pages, which lie across.
    project, revision, date : str
        For the title blocks; without a date that of the environment variable
        ``SOURCE_DATE_EPOCH``, or today.
    panel_material, beam_material : str
        As `write_tables` takes them.

    Returns
    -------
    str
        The path.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from spheremesh.nodes import fit_spheres, panels, vase_mesh, write_drawings
    >>> made = panels(fit_spheres(vase_mesh(12, 6)), thickness=0.02)
    >>> with TemporaryDirectory() as folder:
    ...     write_drawings(made.panels, f"{folder}/vase.dxf").endswith("vase.dxf")
    True
    """
    options = drawing_set.DrawingOptions(
        paper, project, revision, date, panel_material, beam_material
    )
    return told_path(drawing_set.write_drawings(Model(panels, beams, units), path, options))


@dataclass(frozen=True, eq=False)
class NestingReport(Report):
    """How many stock sheets there must be, and where pieces lie on them.

    Attributes
    ----------
    sheets : int
        Number of sheets, without those of the oversize.
    bound : int
        Sheets that the areas of the pieces need alone: no nesting has fewer.
    waste : float
        Share of the sheets that becomes no piece.
    oversize : list of str
        Pieces that are larger than a sheet.
    pieces : list of dict
        ``id``, ``sheet`` (from 1), ``x_mm`` and ``y_mm`` of the lower left corner, ``width_mm``
        and ``height_mm`` as it lies, ``is_turned``.
    """

    sheets: int
    bound: int
    waste: float
    oversize: list[str]
    pieces: list[dict[str, Any]]


@node
def nest_parts(
    panels: Panels | None = None,
    units: Units = "m",
    beams: Beams | None = None,
    sheet: tuple[float, float] = (3000.0, 1500.0),
    kerf: Length = 4.0,
    margin: Length = 10.0,
    grain: Literal["along", "any"] = "any",
) -> NestingReport:
    """Nest the flat blanks of panels, or beams, as rectangles on stock sheets.

    Parameters
    ----------
    panels : Panels, optional
        The panels, of which each needs a flat sheet that is formed; these or beams are needed,
        not both.
    units : str
    beams : Beams, optional
    sheet : (float, float)
        Width and height of the sheets, in millimetres.
    kerf : float
        What a cut takes, in millimetres.
    margin : float
        Distance from the rim, in millimetres.
    grain : {"along", "any"}
        Whether pieces lie along the width of the sheets, or may be turned by a right angle.

    Returns
    -------
    NestingReport
        Sheets, waste and places.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, nest_parts, panels, vase_mesh
    >>> found = nest_parts(panels(fit_spheres(vase_mesh(12, 6)), thickness=0.02).panels)
    >>> len(found["pieces"]), found["sheets"] - found["bound"] <= 1
    (72, True)
    """
    found, pieces = stock_sheets.nest_model(
        Model(panels, beams, units), Stock(sheet, kerf, margin, grain)
    )
    oversize = [pieces[row]["id"] for row in found.oversize]
    if oversize:
        warn(f"{len(oversize)} pieces are larger than the sheet: {', '.join(oversize[:8])}")
    return NestingReport(found.count, found.bound, found.waste, oversize, pieces)
