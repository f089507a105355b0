"""Caps of moulds: they are the spheres of the panels, and hold them."""

from dataclasses import replace

import numpy as np
import pytest

from spheremesh.kernel.arrays import dot, norm, unit
from spheremesh.kernel.meshes.mesh import Mesh
from spheremesh.kernel.optimization.radius_clustering import cluster_radii
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.mould_blanks import panel_caps
from spheremesh.kernel.panels.mould_caps import mould_caps
from spheremesh.kernel.panels.panels import Panels, panel_areas
from spheremesh.kernel.panels.thickness import ThicknessSide
from spheremesh.kernel.sphere_meshes.sphere_mesh import SphereMesh
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.kernel.spheres.incidence import normals, signed_distance
from spheremesh.kernel.surfaces.circular_nets import roof_net


def clustered(side: ThicknessSide = "inward", scale: float = 1.0, shift: float = 0.0) -> Panels:
    """Domes, dishes and planes in five moulds; panel 4 is without."""
    mesh = roof_net(6, 5, 20.0)
    mesh = Mesh(scale * mesh.vertices + shift, mesh.faces)
    planes, great_spheres = circle_pencils(face_circles(mesh)[0])
    angles = np.random.default_rng(4).uniform(0.1, 0.5, mesh.n_faces)
    angles[1::3] *= -1
    angles[::5] = 0
    found = SphereMesh.from_local(mesh, pencil_spheres(planes, great_spheres, angles))
    found, clusters = cluster_radii(found, 5)
    panels, _ = cut_panels(found, "bisector", 0.05 * scale, 0.01 * scale, clusters.labels, side)
    labels = panels.labels.copy()
    labels[4] = -1
    return replace(panels, labels=labels)


@pytest.mark.parametrize("side", ["inward", "outward", "centred"])
def test_law_caps_are_the_moulds_and_hold_the_panels(side: ThicknessSide) -> None:
    panels = clustered(side)
    found = mould_caps(panels)
    caps = found.caps
    assert caps.ids == tuple(f"Mould {i:02d}" for i in range(1, 6))
    assert found.members.tolist() == [i for i in range(panels.n_panels) if i != 4]
    assert np.array_equal(caps.labels[found.rows], panels.labels[found.members])
    turns, shifts = found.rotations, found.translations
    assert np.abs(turns @ turns.transpose(0, 2, 1) - np.eye(3)).max() < 1e-12
    np.testing.assert_allclose(np.linalg.det(turns), 1)
    # The rim of the cap, brought under a panel, lies on the sphere of its mould.
    places = shifts - panels.origins[found.members]
    rims = caps.corners.reshape(-1, 4, 3)[found.rows]
    rows = panels.design_spheres[found.members]
    on_sphere = rims @ turns.transpose(0, 2, 1) + places[:, None]
    assert np.abs(signed_distance(rows[:, None], on_sphere)).max() < 1e-9
    assert np.abs(signed_distance(rows, places)).max() < 1e-9
    # Every panel, laid on the mould along its radii, lies within the rim; one touches it.
    single = panel_caps(panels)
    for label in range(5):
        radii = single.radii[panels.labels == label]
        rim = norm(caps.corners[4 * label, :2])
        wanted = radii.max() * (1 if caps.spheres[label, 0] else np.sqrt(2))
        assert rim == pytest.approx(wanted, rel=1e-12)
    assert (caps.spheres[:, 0] <= 0).all()
    crowns = normals(caps.spheres, np.zeros((5, 3)))
    assert np.abs(crowns - (0, 0, 1)).max() < 1e-12


def test_areas_of_caps_are_known() -> None:
    caps = mould_caps(clustered()).caps
    rims = norm(caps.corners.reshape(-1, 4, 3)[:, 0, :2])
    depths = -caps.corners[::4, 2]
    is_flat = caps.spheres[:, 0] == 0
    assert is_flat.sum() == 1
    round_caps = np.pi * (rims**2 + depths**2)
    np.testing.assert_allclose(panel_areas(caps), np.where(is_flat, 2 * rims**2, round_caps))


def test_dishes_lie_upside_down() -> None:
    panels = clustered()
    found = mould_caps(panels)
    side = dot(found.rotations[:, :, 2], unit(panels.spheres[found.members, 1:4]))
    curvatures = panels.design_spheres[found.members, 0]
    assert (side[curvatures > 0] < -0.9).all()
    assert (side[curvatures <= 0] > 0.9).all()


@pytest.mark.parametrize(("scale", "shift"), [(1e-3, 0.0), (1e3, 0.0), (1.0, 1e6)])
def test_law_scale_and_place_change_nothing(scale: float, shift: float) -> None:
    first, second = mould_caps(clustered()), mould_caps(clustered("inward", scale, shift))
    size = norm(first.caps.corners).max()
    precision = 1e-7 if shift else 1e-9
    apart = second.caps.corners / scale - first.caps.corners
    assert norm(apart).max() < precision * size
    moved = (second.translations - shift) / scale - first.translations
    assert norm(moved).max() < max(precision * size, 1e-9 * shift)
    assert np.abs(second.rotations - first.rotations).max() < 1e-6


def test_no_moulds_no_caps() -> None:
    panels = clustered()
    found = mould_caps(replace(panels, labels=np.full_like(panels.labels, -1)))
    assert found.caps.n_panels == len(found.members) == 0
