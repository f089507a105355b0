"""The nodes of the category Support."""

import json

import numpy as np
import pytest

from spheremesh.kernel.errors import InputError
from spheremesh.nodes import (
    annulus_support,
    central_spheres,
    face_planes,
    minimize_angles,
    roof_mesh,
    support_structure,
    torus_mesh,
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
        annulus_support(sphere_mesh)
