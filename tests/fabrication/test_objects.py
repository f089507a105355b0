"""Meshes, panels and beams in trimesh, pyvista, COMPAS and CadQuery, and back."""

import sys
from functools import cache
from typing import Any

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.beams.beams import Beams, beam_volumes
from spheremesh.kernel.errors import ArgumentError, InputError, MissingLibraryError
from spheremesh.kernel.panels.panels import panel_areas
from spheremesh.nodes import axis_support, beams, fit_spheres, panels, vase_mesh

datastructures: Any = pytest.importorskip("compas.datastructures")
pyvista: Any = pytest.importorskip("pyvista")
trimesh: Any = pytest.importorskip("trimesh")

MIXED = Mesh(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0.5, 0]], [[0, 1, 2, 3], [1, 4, 2]]
)


@cache
def vase() -> SphereMesh:
    return fit_spheres(vase_mesh(12, 6))


@cache
def frame() -> Beams:
    return beams(axis_support(vase(), depth=0.1).annuli, thickness=0.02).beams


def same(left: Mesh, right: Mesh) -> bool:
    return (
        np.array_equal(left.vertices, right.vertices)
        and np.array_equal(left.corners, right.corners)
        and np.array_equal(left.offsets, right.offsets)
    )


@pytest.mark.parametrize("mesh", [MIXED, vase().mesh], ids=["mixed", "vase"])
def test_polygons_go_through_pyvista_and_compas_and_come_back(mesh: Mesh) -> None:
    assert same(Mesh.from_pyvista(mesh.to_pyvista()), mesh)
    faces = [face.tolist() for face in mesh.faces]
    other = datastructures.Mesh.from_vertices_and_faces(mesh.vertices.tolist(), faces)
    assert same(Mesh.from_compas(other), mesh)


def test_trimesh_has_triangles() -> None:
    back = Mesh.from_trimesh(MIXED.to_trimesh())
    assert back.degrees.tolist() == [3, 3, 3]
    np.testing.assert_array_equal(back.vertices, MIXED.vertices)
    assert MIXED.to_trimesh().face_attributes["face"].tolist() == [0, 0, 1]
    assert Mesh.from_trimesh(trimesh.creation.icosphere(1)).n_faces == 80


def test_panels_keep_their_areas_radii_and_exact_normals() -> None:
    made = panels(vase(), labels=np.arange(72) % 3).panels
    triangles = made.to_trimesh()
    areas = np.bincount(triangles.face_attributes["face"], triangles.area_faces)
    np.testing.assert_allclose(areas, panel_areas(made), rtol=2e-3)
    np.testing.assert_array_equal(
        triangles.face_attributes["radius"], made.radii[triangles.face_attributes["face"]]
    )
    surface = made.to_pyvista()
    assert set(surface.cell_data.keys()) == {"face", "mould", "radius"}
    faces = surface.faces.reshape(-1, 4)[:, 1:]
    centers, radii = made.centers[surface["face"]], made.radii[surface["face"]]
    points, normals = surface.points[faces[:, 0]], surface.point_data["Normals"][faces[:, 0]]
    np.testing.assert_allclose(
        np.abs(((points - centers) * normals).sum(axis=1)), radii, rtol=1e-6
    )


def test_beams_are_closed_and_keep_their_volumes() -> None:
    """Their ends are square, where those of beams are mitred."""
    triangles = frame().to_trimesh()
    triangles.merge_vertices(merge_norm=True, digits_vertex=9)
    pieces = triangles.split(only_watertight=True)
    assert len(pieces) == frame().n_beams
    volumes = sorted(piece.volume for piece in pieces)
    np.testing.assert_allclose(volumes, np.sort(beam_volumes(frame())), rtol=5e-2)


def test_annuli_are_strips_between_their_circles() -> None:
    annuli = frame().annuli
    strips = annuli.to_trimesh()
    edges = strips.face_attributes["edge"]
    places = np.searchsorted(annuli.edge_ids, edges)
    points = strips.vertices[strips.faces[:, 0]]
    planes = annuli.planes[places]
    assert np.abs((points * planes[:, :3]).sum(axis=1) - planes[:, 3]).max() < 1e-9
    radii = np.linalg.norm(points - annuli.centers[places], axis=1)
    off = np.abs(radii[:, None] - annuli.radii[places])
    assert np.isfinite(annuli.radii).all()
    assert off.min(axis=1).max() < 1e-6 * radii.max()
    ends = (annuli.corners + annuli.origins[:, None, None]).reshape(-1, 3)
    strip = strips.vertices.reshape(annuli.n_annuli, -1, 2, 3)[:, [0, -1]]
    np.testing.assert_allclose(strip.reshape(-1, 3), ends, atol=1e-9)


def test_sphere_meshes_are_given_by_centres_and_radii() -> None:
    given = SphereMesh.from_centers(vase().mesh, vase().centers, vase().radii)
    np.testing.assert_allclose(given.spheres, vase().spheres, atol=1e-9)
    with pytest.raises(
        InputError, match=r"a mesh of 72 faces needs centres of shape \(72, 3\)"
    ):
        SphereMesh.from_centers(vase().mesh, vase().centers[:5], vase().radii)


def test_cadquery_has_a_shape_for_every_part() -> None:
    assert len(panels(vase(), thickness=0.02).panels.to_cadquery().children) == 72
    assert len(frame().to_cadquery(units="mm").children) == frame().n_beams
    with pytest.raises(InputError, match="annuli have no thickness: give them one with"):
        frame().annuli.to_cadquery()


def test_what_is_no_mesh_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(
        ArgumentError, match=r"^Mesh\.from_trimesh needs a trimesh\.Trimesh, not"
    ):
        Mesh.from_trimesh([[0, 0, 0]])
    grid = pyvista.ImageData(dimensions=(3, 3, 1))
    with pytest.raises(ArgumentError, match=r"needs a pyvista\.PolyData, not ImageData"):
        Mesh.from_pyvista(grid)
    with pytest.raises(ArgumentError, match=r"needs a compas\.datastructures\.Mesh, not Mesh"):
        Mesh.from_compas(MIXED)
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(MissingLibraryError, match=r"pip install 'spheremesh\[vtk\]'"):
        MIXED.to_pyvista()
