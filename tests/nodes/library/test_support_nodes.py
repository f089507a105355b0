"""The nodes of the category Support."""

import json
import warnings
from pathlib import Path

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.tolerances import VERTEX_MISS
from spheremesh.nodes import (
    Graph,
    annulus_support,
    beams,
    central_spheres,
    drilling_marks,
    face_planes,
    fit_spheres,
    land_nodes,
    minimize_angles,
    optimize_spheres,
    roof_mesh,
    support_structure,
    torus_mesh,
    vase_mesh,
    vertex_error,
    write_3dm,
    write_dxf,
)


def test_support_structure_gives_degrees_and_a_plain_report() -> None:
    found = support_structure(face_planes(torus_mesh()))
    assert found.is_valid.all()
    assert found.torsion.max() < 1e-9
    assert found.axes.shape == (len(found.torsion), 2, 3)
    assert json.loads(json.dumps(dict(found.report), allow_nan=False)) == found.report


def test_support_structure_warns_of_invalid_nodes() -> None:
    sphere_mesh = minimize_angles(central_spheres(roof_mesh())).sphere_mesh
    with pytest.warns(UserWarning, match="nodes are not valid"):
        found = support_structure(sphere_mesh)
    inside = ~sphere_mesh.mesh.topology.is_boundary_vertex
    assert found.report["torsion_deg"]["max"] == found.torsion[inside].max()
    assert found.report["valid"] == int(np.sum(found.is_valid))


@pytest.mark.parametrize("mesh", [vase_mesh(9, 7), roof_mesh(10, 14)])
def test_beams_of_landed_nodes_meet(mesh: Mesh) -> None:
    start = minimize_angles(central_spheres(mesh)).sphere_mesh
    optimum = optimize_spheres(start, regularity=3.5, support=1.0).sphere_mesh
    landed = land_nodes(optimum)
    assert json.loads(json.dumps(dict(landed.report), allow_nan=False)) == landed.report
    assert landed.report["landed"]
    edge = mean_edge_length(mesh)
    moves = norm(landed.sphere_mesh.mesh.vertices - mesh.vertices) / edge
    np.testing.assert_allclose(moves.max(), landed.report["moved"]["max"], rtol=1e-6)
    assert vertex_error(landed.sphere_mesh).max() < 1e-8 * edge
    before, after = (ends_apart(found) / edge for found in (optimum, landed.sphere_mesh))
    assert after < 1e-8
    assert after < 1e-5 * before


def test_misses_that_landing_takes_away_are_no_warning() -> None:
    mesh = roof_mesh(6, 8)
    noise = 0.01 * mean_edge_length(mesh) * np.random.default_rng(0).normal(size=(63, 3))
    rough = Mesh(mesh.vertices + noise, [list(face) for face in mesh.faces])
    start = minimize_angles(fit_spheres(rough)).sphere_mesh
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        optimum = optimize_spheres(start, regularity=3.5, support=1.0)
        landed = land_nodes(optimum.sphere_mesh)
    assert optimum.report["vertex_error"]["relative_to_edge"] > VERTEX_MISS
    assert landed.report["landed"]
    assert vertex_error(landed.sphere_mesh).max() < 1e-9
    assert not caught


def ends_apart(sphere_mesh: SphereMesh) -> float:
    """Largest distance of the ends of two beams at a node, inside or on a side with corners."""
    annuli = annulus_support(sphere_mesh, depth=0.1).annuli
    ends = (annuli.corners + annuli.origins[:, None, None]).reshape(-1, 2, 3)
    vertices = annuli.edge_vertices.ravel()
    valences = np.bincount(vertices)
    inner = ~sphere_mesh.mesh.topology.is_boundary_vertex
    judged = np.flatnonzero(inner | (valences.min() == 2))
    return max(float(np.ptp(ends[vertices == vertex], axis=0).max()) for vertex in judged)


def test_nodes_that_are_far_stay_where_they_are() -> None:
    start = minimize_angles(central_spheres(roof_mesh(8, 12))).sphere_mesh
    with pytest.warns(UserWarning, match=r"beams do not meet exactly: .* 1e-06 are allowed"):
        found = land_nodes(start, max_move=1e-6)
    assert found.sphere_mesh is start
    assert not found.report["landed"]


def test_spheres_that_are_built_as_planes_do_not_land_by_their_far_centers() -> None:
    """They share two points, one of them beyond a billion edges: no beam knows of that."""
    rows = vase_mesh(9, 7).vertices
    sheared = rows * [1, 1.2, 1] + 0.3 * rows[:, 2:] ** 2 * [1, 0, 0]
    mesh = Mesh(sheared, [list(face) for face in vase_mesh(9, 7).faces])
    nearly_plane = planes_on_far_centers(face_planes(mesh))
    with pytest.warns(UserWarning, match="too large to tell from planes"):
        found = land_nodes(nearly_plane)
    assert found.sphere_mesh is nearly_plane
    assert ends_apart(found.sphere_mesh) > 1e-3 * mean_edge_length(mesh)


def planes_on_far_centers(planes: SphereMesh) -> SphereMesh:
    """The planes bent to spheres of a billion edges."""
    rows = planes.local_spheres.copy()
    rows[:, 0] = 1e-10 / mean_edge_length(planes.mesh)
    return SphereMesh.from_local(planes.mesh, rows)


def test_annulus_support_reports_and_warns() -> None:
    sphere_mesh = minimize_angles(central_spheres(roof_mesh())).sphere_mesh
    with pytest.warns(UserWarning, match="annuli cannot be made"):
        found = annulus_support(sphere_mesh, depth=0.2)
    assert json.loads(json.dumps(dict(found.report), allow_nan=False)) == found.report
    assert found.report["made"] == found.annuli.n_annuli
    with pytest.raises(InputError, match="either a depth or a power"):
        annulus_support(sphere_mesh, depth=0.2, kappa=0.1)


def test_beams_reports_and_warns() -> None:
    sphere_mesh = face_planes(torus_mesh())
    annuli = annulus_support(sphere_mesh, depth=0.1).annuli
    made = beams(annuli, 0.02, node_gap=0.005)
    assert json.loads(json.dumps(dict(made.report), allow_nan=False)) == made.report
    assert made.report["written"] == made.beams.n_beams == annuli.n_annuli
    assert 0 < made.report["volume"] < annuli.n_annuli * made.report["longest"] * 0.1 * 0.02
    with pytest.warns(UserWarning, match="beams cannot be made"):
        thick = beams(annuli, 0.3)
    assert len(thick.report["rejected"]) + thick.report["written"] == annuli.n_annuli


def test_a_graph_from_spheres_to_drawings(tmp_path: Path) -> None:
    graph = Graph("support")
    mesh = graph.add(torus_mesh, n_around=8, n_across=6)
    spheres = graph.add(face_planes, mesh=mesh)
    annuli = graph.add(annulus_support, sphere_mesh=spheres, depth=0.1)
    cut = graph.add(beams, annuli=annuli.annuli, thickness=0.02)
    drawing = graph.add(write_dxf, beams=cut.beams, path=str(tmp_path / "b.dxf"))
    model = graph.add(write_3dm, beams=cut.beams, path=str(tmp_path / "b.3dm"))
    assert graph.run(drawing) == str(tmp_path / "b.dxf")
    assert graph.run(model) == str(tmp_path / "b.3dm")
    small = graph.add(
        write_dxf, beams=cut.beams, path=str(tmp_path / "s.dxf"), sheet=(500.0, 300.0)
    )
    with pytest.warns(UserWarning, match="larger than the sheet"):
        graph.run(small)


def test_drilling_marks_report_and_warn(tmp_path: Path) -> None:
    annuli = annulus_support(face_planes(torus_mesh(8, 6)), depth=0.3).annuli
    cut = beams(annuli, 0.05).beams
    drilled = drilling_marks(cut, 3)
    assert drilled.report == {
        "marked": cut.n_beams, "diameter": pytest.approx(0.025), "inset": pytest.approx(0.0375),
        "counts": {}, "notes": [],
    }  # fmt: skip
    with pytest.warns(UserWarning, match="beams get no drilling marks: B0000"):
        crowded = drilling_marks(cut, 2, diameter=0.2, inset=0.2)
    assert json.loads(json.dumps(dict(crowded.report), allow_nan=False)) == crowded.report
    assert crowded.report["counts"] == {"B208": cut.n_beams}
    assert crowded.report["marked"] == 0
    assert [note["id"] for note in crowded.report["notes"]] == list(cut.annuli.ids)
    # Nothing to draw is no error.
    for path in (
        write_dxf(crowded.beams, str(tmp_path / "d.dxf")),
        write_3dm(beams=crowded.beams, path=str(tmp_path / "d.3dm")),
    ):
        assert Path(path).stat().st_size > 1000


def test_rejected_beams_have_codes_in_reports() -> None:
    sphere_mesh = minimize_angles(central_spheres(roof_mesh())).sphere_mesh
    with pytest.warns(UserWarning, match="annuli cannot be made"):
        found = annulus_support(sphere_mesh, depth=0.2)
    assert {entry["code"] for entry in found.report["rejected"]} == {"B100"}
    annuli = annulus_support(face_planes(torus_mesh()), depth=0.1).annuli
    with pytest.warns(UserWarning, match="beams cannot be made"):
        thick = beams(annuli, 0.3)
    assert {entry["code"] for entry in thick.report["rejected"]} == {"B101"}
