"""Tidy tables of parts."""

from ....fabrication.model import Model
from ....fabrication.schedules import record_files
from ....kernel.beams.beams import Beams
from ....kernel.panels.panels import Panels
from ...graphs.node import node
from ...graphs.ports import Units, WritePath


@node
def write_tables(
    panels: Panels | None = None,
    path: WritePath = "tables.xlsx",
    units: Units = "m",
    beams: Beams | None = None,
    panel_material: str = "glass",
    beam_material: str = "steel",
) -> str:
    """Write tidy tables of panels, edges, moulds, beams, ends, holes and nodes.

    Parameters
    ----------
    panels : Panels, optional
        The panels; these or beams are needed.
    path : path
        Ends in .xlsx (a sheet for each table; with the extra ``excel``), or in .csv or .parquet
        (the table in which the name ends: panels, panel_edges, moulds, beams, beam_ends,
        beam_holes or nodes).
    units : str
    beams : Beams, optional
    panel_material, beam_material : str
        Glass, steel, stainless steel, aluminium, concrete or timber, or a name with its density
        in kg/m³, such as ``GFRC=1900``.

    Returns
    -------
    str
        The path.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from spheremesh.nodes import fit_spheres, panels, vase_mesh, write_tables
    >>> made = panels(fit_spheres(vase_mesh(12, 6)), thickness=0.02)
    >>> with TemporaryDirectory() as folder:
    ...     path = write_tables(made.panels, f"{folder}/panel_edges.csv")
    ...     len(Path(path).read_text("utf-8").splitlines())
    289
    """
    model = Model(panels, beams, units)
    return str(record_files.write_tables(model, path, panel_material, beam_material).path)
