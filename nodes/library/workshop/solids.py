"""Panels and beams as solids for CadQuery."""

from ....fabrication.solids.cadquery_assembly import beams_to_cadquery, to_cadquery
from ....kernel.beams.beams import Beams
from ....kernel.errors import InputError
from ....kernel.panels.panels import Panels
from ...graphs.node import node
from ...graphs.ports import Units


@node
def cadquery_solids(
    panels: Panels | None = None, beams: Beams | None = None, units: Units = "m"
) -> object:
    """Panels and beams as a CadQuery assembly, for further modelling.

    Parameters
    ----------
    panels : Panels, optional
        The panels; these or beams are needed.
    beams : Beams, optional
        The beams; of beams and panels the former are an assembly within the latter.
    units : str
        Model units; the assembly is in millimetres.

    Returns
    -------
    cadquery.Assembly
        A solid (without thickness a face) for every part, named by its id.

    Examples
    --------
    >>> from spheremesh.nodes import cadquery_solids, fit_spheres, panels, torus_mesh
    >>> torus = panels(fit_spheres(torus_mesh(8, 6)), thickness=0.02).panels
    >>> len(cadquery_solids(torus).children)
    48
    """
    if panels is None:
        if beams is None:
            raise InputError("cadquery_solids needs panels or beams")
        return beams_to_cadquery(beams, units)
    assembly = to_cadquery(panels, units)
    return assembly if beams is None else assembly.add(beams_to_cadquery(beams, units))
