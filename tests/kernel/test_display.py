"""Records show themselves in a line or few, whatever their size."""

import numpy as np
import pytest

from spheremesh import Graph
from spheremesh.kernel.spheres.incidence import signed_distance
from spheremesh.nodes import (
    apply_mobius,
    axis_support,
    beams,
    face_planes,
    fit_spheres,
    mesh_report,
    panels,
    roof_mesh,
    similarity,
    torus_mesh,
)

SPHERES = fit_spheres(roof_mesh(6, 8))
CUT = panels(SPHERES, thickness=0.02, labels=np.arange(48) % 3)
SUPPORT = axis_support(SPHERES, depth=0.5)
FRAME = beams(SUPPORT.annuli, thickness=0.1)


@pytest.mark.parametrize(
    ("record", "line"),
    [
        (SPHERES.mesh, r"Mesh(63 vertices; 48 quads; 80 x 34.1 x 13.6)"),
        (face_planes(torus_mesh(6, 4)), "SphereMesh(24 quads; 6 x 5.2 x 2; 24 planes)"),
        (
            CUT.report,
            "CutReport(edge_gap={... 8 entries}, thickness={'min': 0.02, 'mean': 0.02",
        ),
        (Graph("a roof"), "Graph('a roof'; 0 steps; sliders none; m)"),
    ],
)
def test_a_record_in_a_line(record: object, line: str) -> None:
    assert repr(record).startswith(line)


@pytest.mark.parametrize(
    "record",
    [
        SPHERES,
        CUT.panels,
        CUT.report,
        CUT,
        SUPPORT.annuli,
        FRAME.beams,
        FRAME,
        mesh_report(SPHERES.mesh),
    ],
    ids=lambda record: type(record).__name__,
)
def test_it_is_short(record: object) -> None:
    text = repr(record)
    assert text.startswith(type(record).__name__ + "(")
    assert len(text) < 1000
    assert "\n" not in text


def test_radii_centres_and_planes_are_those_of_the_spheres() -> None:
    mesh, spheres = SPHERES.mesh, SPHERES
    corners = mesh.vertices[mesh.corners]
    owners = mesh.topology.corner_faces
    from_center = np.linalg.norm(corners - spheres.centers[owners], axis=1)
    off = np.abs(signed_distance(spheres.spheres[owners], corners))
    np.testing.assert_allclose(np.abs(from_center - spheres.radii[owners]), off, atol=1e-6)
    made = CUT.panels
    points = made.corners + made.origins[made.corner_panels]
    planes = made.planes
    np.testing.assert_allclose((points * planes[:, :3]).sum(1), planes[:, 3], atol=1e-9)
    np.testing.assert_allclose(made.radii, spheres.radii[made.face_ids])
    np.testing.assert_allclose(made.centers, spheres.centers[made.face_ids], rtol=1e-9)
    np.testing.assert_array_equal(
        FRAME.beams.planes, SUPPORT.annuli.planes[: FRAME.beams.n_beams]
    )


def test_flat_faces_have_no_centre_and_an_infinite_radius() -> None:
    flat = face_planes(torus_mesh(6, 4))
    assert np.isinf(flat.radii).all()
    assert not np.isfinite(flat.centers).any()


def test_centres_move_with_the_model() -> None:
    moved = apply_mobius(SPHERES, similarity(scale=2.0, translation=[1e5, 0, 0]))
    np.testing.assert_allclose(moved.radii, 2 * SPHERES.radii, rtol=1e-7)
    np.testing.assert_allclose(moved.centers, 2 * SPHERES.centers + [1e5, 0, 0], rtol=1e-7)
