"""Volumes, centres of mass and boxes of parts, by OpenCASCADE."""

import numpy as np
import pytest
from OCP.Bnd import Bnd_Box
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
from OCP.BRepGProp import BRepGProp
from OCP.gp import gp_Ax3, gp_Dir, gp_Pnt, gp_Trsf
from OCP.GProp import GProp_GProps

from spheremesh import Mesh
from spheremesh.fabrication.solids.opencascade_beams import beam_shapes
from spheremesh.fabrication.solids.opencascade_panels import panel_shapes
from spheremesh.kernel.arrays import FloatArray, norm
from spheremesh.kernel.beams.beams import beam_volumes
from spheremesh.kernel.beams.centroids import beam_centroids
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.panels.centroids import panel_centroids
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.facts import packing_sizes, panel_volumes
from spheremesh.kernel.panels.panels import Panels
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import torus_net, vase_net


def measured(shape: object, *, is_surface: bool = False) -> tuple[float, FloatArray]:
    found = GProp_GProps()
    if is_surface:
        BRepGProp.SurfaceProperties_s(shape, found, 1e-10)  # pyright: ignore
    else:
        BRepGProp.VolumeProperties_s(shape, found, 1e-10)  # pyright: ignore
    middle = found.CentreOfMass()
    return found.Mass(), np.array([middle.X(), middle.Y(), middle.Z()])


def sharp(thickness: float) -> Panels:
    return cut_panels(fit_spheres(torus_net(7, 5, 3.0, 1.0)), thickness=thickness)[0]


@pytest.mark.parametrize(
    "panels",
    [
        sharp(0.1),
        sharp(0.0),
        cut_panels(fit_spheres(torus_net(16, 9, 3.0, 1.0)), thickness=0.3, side="outward")[0],
        cut_panels(face_planes(vase_net(9, 4, 1.0, 2.0, 0.3)), thickness=0.02)[0],
    ],
    ids=["sharp", "surfaces", "thick", "planes"],
)
def test_panels_balance_where_opencascade_says(panels: Panels) -> None:
    few = select_parts(panels, np.arange(panels.n_panels) < 12)
    shapes = list(panel_shapes(few, 1.0))
    is_surface = few.thickness == 0
    found = [measured(shape, is_surface=is_surface) for shape in shapes]
    np.testing.assert_allclose(panel_centroids(few), [c for _, c in found], atol=1e-7)
    if not is_surface:
        np.testing.assert_allclose(panel_volumes(few), [v for v, _ in found], rtol=1e-7)


def test_law_centres_move_with_the_panels_and_see_no_curvature_of_planes() -> None:
    """A nearly flat sphere balances where the plane does."""
    corners = np.array([[0, 0, 0], [3, 0, 0], [3.5, 2, 0], [0, 2, 0.0]])
    mesh = Mesh(corners + np.array([1e6, 0, 0]), [[0, 1, 2, 3]])
    flat = face_planes(mesh)
    plane = panel_centroids(cut_panels(flat, thickness=0.1)[0])
    for curvature in (1e-3, 1e-5, 1e-9):
        local = flat.local_spheres.copy()
        local[:, 0] = -curvature / 2
        bent = panel_centroids(cut_panels(type(flat).from_local(mesh, local), thickness=0.1)[0])
        assert norm(bent - plane).max() < 3 * curvature + 1e-9


@pytest.mark.parametrize("radius", [0.0, 0.06])
def test_beams_balance_where_opencascade_says(radius: float) -> None:
    annuli = annulus_support(central_spheres(vase_net(10, 4, 2.0, 5.0, 0.3)), depth=0.2).annuli
    beams = cut_beams(annuli, 0.04, 0.01, radius)[0]
    beams = select_parts(beams, np.arange(beams.n_beams) < 15)
    found = [measured(shape) for shape in beam_shapes(beams, 1.0)]
    np.testing.assert_allclose(beam_volumes(beams), [v for v, _ in found], rtol=1e-6)
    np.testing.assert_allclose(beam_centroids(beams), [c for _, c in found], atol=1e-6)


def test_panels_lie_in_their_packing_boxes() -> None:
    """The box has the sides of one that OpenCASCADE lays about the turned panel."""
    panels = select_parts(sharp(0.1), np.arange(35) < 8)
    first = panels.offsets[:-1]
    along = panels.corners[panels.next_corners[first]] - panels.corners[first]
    sizes = packing_sizes(panels)
    for i, shape in enumerate(panel_shapes(panels, 1.0)):
        turn = gp_Trsf()
        up = gp_Dir(*panels.spheres[i, 1:4].tolist())
        turn.SetTransformation(gp_Ax3(gp_Pnt(), up, gp_Dir(*along[i].tolist())))
        box = Bnd_Box()
        moved = BRepBuilderAPI_Transform(shape, turn, theCopyGeom=True).Shape()
        BRepBndLib.AddOptimal_s(moved, box, useTriangulation=False, useShapeTolerance=False)
        low, high = box.CornerMin(), box.CornerMax()
        expected = [high.X() - low.X(), high.Y() - low.Y(), high.Z() - low.Z()]
        np.testing.assert_allclose(sizes[i], expected, rtol=1e-4)
