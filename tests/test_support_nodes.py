"""The nodes of the category Support."""

import json
from pathlib import Path

import numpy as np
import pytest

from spheremesh.kernel.errors import InputError
from spheremesh.nodes import (
    Graph,
    annulus_support,
    beams,
    central_spheres,
    face_planes,
    minimize_angles,
    roof_mesh,
    support_structure,
    torus_mesh,
    write_3dm,
    write_dxf,
)


def test_support_structure_gives_degrees_and_a_plain_report() -> None:
    found = support_structure(face_planes(torus_mesh()))
    assert found.is_valid.all()
    assert found.torsion.max() < 1e-9
    assert found.axes.shape == (len(found.torsion), 2, 3)
    assert json.loads(json.dumps(found.report, allow_nan=False)) == found.report


def test_support_structure_warns_of_invalid_nodes() -> None:
    sphere_mesh = minimize_angles(central_spheres(roof_mesh())).sphere_mesh
    with pytest.warns(UserWarning, match="nodes are not valid"):
        found = support_structure(sphere_mesh)
    inside = ~sphere_mesh.mesh.topology.is_boundary_vertex
    assert found.report["torsion_deg"]["max"] == found.torsion[inside].max()
    assert found.report["valid"] == int(np.sum(found.is_valid))


def test_annulus_support_reports_and_warns() -> None:
    sphere_mesh = minimize_angles(central_spheres(roof_mesh())).sphere_mesh
    with pytest.warns(UserWarning, match="annuli cannot be made"):
        found = annulus_support(sphere_mesh, depth=0.2)
    assert json.loads(json.dumps(found.report, allow_nan=False)) == found.report
    assert found.report["made"] == found.annuli.n_annuli
    with pytest.raises(InputError, match="either a depth or a power"):
        annulus_support(sphere_mesh, depth=0.2, kappa=0.1)


def test_beams_reports_and_warns() -> None:
    sphere_mesh = face_planes(torus_mesh())
    annuli = annulus_support(sphere_mesh, depth=0.1).annuli
    made = beams(annuli, 0.02, node_gap=0.005)
    assert json.loads(json.dumps(made.report, allow_nan=False)) == made.report
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
