"""Panels and beams as solids for CadQuery."""

from ....fabrication.model import Model
from ....fabrication.solids.cadquery_assembly import to_cadquery
from ....kernel.beams.beams import Beams
from ....kernel.errors import InputError
from ....kernel.panels.panels import Panels
from ...graphs.node import node
from ...graphs.ports import Units


@node(version="2")
def cadquery_solids(
    panels: Panels | None = None, beams: Beams | None = None, units: Units = "m"
) -> object:
    """Panels, beams and nodes as a CadQuery assembly, for further modelling.

    Parameters
    ----------
    panels : Panels, optional
        The panels; these or beams are needed.
    beams : Beams, optional
        The beams, with their node cylinders if they have any, and the node axes.
    units : str
        Model units; the assembly is in millimetres.

    Returns
    -------
    cadquery.Assembly
        ``Panels``; with beams ``Model`` of ``Panels``, ``Beams``, ``Nodes`` and ``Axes``. A
        solid (without thickness a face) for every part, named by its id and coloured; its
        layer is in ``metadata["layer"]``.

    Examples
    --------
    >>> from spheremesh.nodes import cadquery_solids, fit_spheres, panels, torus_mesh
    >>> torus = panels(fit_spheres(torus_mesh(8, 6)), thickness=0.02).panels
    >>> len(cadquery_solids(torus).children)
    48
    """
    if panels is None and beams is None:
        raise InputError("cadquery_solids needs panels or beams")
    return to_cadquery(Model(panels, beams, units))
