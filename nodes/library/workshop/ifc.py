"""Panels and beams in building models."""

from typing import Literal

from ....fabrication.ifc import writer as ifc
from ....fabrication.model import Model
from ....kernel.beams.beams import Beams
from ....kernel.panels.panels import Panels
from ...graphs.node import node
from ...graphs.ports import Units, WritePath


@node(version="2")
def write_ifc(
    panels: Panels | None = None,
    beams: Beams | None = None,
    path: WritePath = "model.ifc",
    units: Units = "m",
    ifc_units: Literal["mm", "m"] = "mm",
    shapes: Literal["both", "exact", "triangles"] = "both",
    spheres: Literal["polynomial", "rational", "spherical"] = "polynomial",
    title: str = "Spherical panels",
) -> str:
    """Write panels and beams to an IFC4 file: a curtain wall of plates and members.

    Parameters
    ----------
    panels : Panels, optional
        The panels; these or beams are needed.
    beams : Beams, optional
        The beams, with their node cylinders if they have any.
    path : path
        Ends in .ifc.
    units : str
    ifc_units : {"mm", "m"}
        Unit of length of the file; areas and volumes are in metres.
    shapes : {"both", "exact", "triangles"}
        Exact solids with triangles beside them as ``Body-Fallback``, or one of the two.
    spheres : {"polynomial", "rational", "spherical"}
        How exact solids have their spheres: as polynomials, within a billionth of the size of a
        panel and read as they are; as rational patches, exact, of which IfcOpenShell drops the
        weights; or as spherical surfaces, which few programs read.
    title : str
        Name of the project: GlobalIds are made of it and of the ids of the parts.

    Returns
    -------
    str
        The path.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from spheremesh.nodes import fit_spheres, panels, vase_mesh, write_ifc
    >>> made = panels(fit_spheres(vase_mesh(12, 6)), thickness=0.02)
    >>> with TemporaryDirectory() as folder:
    ...     write_ifc(made.panels, path=f"{folder}/vase.ifc").endswith("vase.ifc")
    True
    """
    options = ifc.IfcOptions(ifc_units, title, shapes, spheres)
    return str(ifc.write_ifc(Model(panels, beams, units), path, options).path)
