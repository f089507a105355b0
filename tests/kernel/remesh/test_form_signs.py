"""Forms that vanish along curves: beyond, the sign is turned and nets stay regular (F8)."""

import numpy as np
import pytest
from scipy.sparse import coo_array

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.congruences.curvature_spheres import touching_spheres
from spheremesh.kernel.meshes.curvature import vertex_normals
from spheremesh.kernel.remesh.field.congruence_mesh import congruence_mesh
from spheremesh.kernel.remesh.field.conjugate_directions import conjugate_directions
from spheremesh.kernel.remesh.field.conjugate_form import conjugate_field
from spheremesh.kernel.remesh.field.jets import fit_jets
from spheremesh.kernel.remesh.field.smoothing import orient_forms
from spheremesh.kernel.remesh.field.tree_signs import tree_signs
from spheremesh.kernel.remesh.pipeline import remesh
from spheremesh.kernel.surfaces.triangulated import SampleShape, triangulated_surface


def bent_sheet(across: float, noise: float = 0.0) -> tuple[Mesh, FloatArray]:
    """A sheet bent up and down, developable if it is straight across, with its spheres."""
    flat = triangulated_surface("hypar", 0.1, seed=1)[0]
    x, y, _ = flat.vertices.T
    points = np.stack([x, y, 0.25 * np.sin(2.5 * x) + across * y * y], 1)
    points += noise * np.random.default_rng(3).normal(size=points.shape)
    mesh = Mesh(points, flat.faces)
    return mesh, touching_spheres(mesh.vertices, vertex_normals(mesh), 2.0)


@pytest.mark.parametrize(("across", "noise"), [(0.0, 0.0), (0.02, 0.0), (0.0, 0.001)])
def test_sheets_bent_to_both_sides_have_regular_nets(across: float, noise: float) -> None:
    mesh, spheres = bent_sheet(across, noise)
    if noise == 0:
        assert len(conjugate_directions(mesh, spheres).singular) == 0
    done = remesh(mesh, spheres, 0.25)
    assert done.n_irregular == done.n_folded == done.n_slivers == 0
    assert done.n_aligned == 4
    assert (done.sphere_mesh.mesh.degrees == 4).all()


@pytest.mark.parametrize("shape", ["hypar", "ellipsoid"])
def test_forms_keep_their_signs_elsewhere_and_get_them_back(shape: SampleShape) -> None:
    mesh, normals = triangulated_surface(shape, 0.15, seed=1)
    surface = congruence_mesh(mesh, touching_spheres(mesh.vertices, normals, 2.0))
    trace, deviator = conjugate_field(fit_jets(surface)[0])
    assert orient_forms(surface, trace, deviator)[1] is deviator
    signs = np.where(mesh.vertices[:, 0] < 0.3, 1.0, -1.0)
    found = orient_forms(surface, signs * trace, signs * deviator)
    ratios = (found[1] / deviator).real
    assert np.abs(ratios.sum()) > 0.99 * len(ratios)
    np.testing.assert_allclose(found[0], ratios * trace, atol=1e-12 * np.abs(trace).max())


def test_signs_follow_the_clearest_edges() -> None:
    # Around a triangle of likeness -1, 0.9 and 0.1 the last is left out.
    likeness = coo_array(([-1.0, 0.9, 0.1], ([0, 1, 0], [1, 2, 2])), shape=(3, 3)).tocsr()
    assert tree_signs(likeness).tolist() == [1, -1, -1]
