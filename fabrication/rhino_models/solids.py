"""Panels, beams and node cylinders as the streams of Breps, in model coordinates."""

from ...kernel.beams.beams import Beams
from ...kernel.beams.node_cylinders import NodeCylinders
from ...kernel.panels.panels import Panels
from ..breps.beam_geometry import beam_geometry
from ..breps.beams import beam_batches
from ..breps.nodes import cylinder_batch
from ..breps.panels import panel_batches
from ..opennurbs.brep_writer import brep_streams
from ..opennurbs.render_meshes import RenderMeshes
from ..opennurbs.solid_writer import solid_streams


def panel_streams(panels: Panels, meshes: RenderMeshes | None = None) -> list[bytes]:
    """Panels as streams of Breps: solids if they have a thickness, or their outer faces.

    Parameters
    ----------
    panels : Panels
    meshes : RenderMeshes, optional
        Triangles of faces without thickness, for viewers that mesh no Breps.

    Returns
    -------
    list of bytes
        In their order.
    """
    if not panels.thickness > 0:
        return brep_streams(panels, meshes)
    return solid_streams(panel_batches(panels), panels.origins)


def beam_streams(beams: Beams) -> list[bytes]:
    """Beams as streams of solid Breps.

    Parameters
    ----------
    beams : Beams

    Returns
    -------
    list of bytes
        In their order.
    """
    geometry = beam_geometry(beams)
    return solid_streams(beam_batches(geometry), geometry.places)


def cylinder_streams(cylinders: NodeCylinders) -> list[bytes]:
    """Node cylinders as streams of solid Breps.

    Parameters
    ----------
    cylinders : NodeCylinders

    Returns
    -------
    list of bytes
        In their order.
    """
    if not cylinders.n_nodes:
        return []
    batch = cylinder_batch(
        0 * cylinders.origins, cylinders.directions, cylinders.heights, cylinders.radius
    )
    return solid_streams([batch], cylinders.origins)
