"""Semi-regular patterns: regular nets become regular, spellings change nothing."""

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.arrays import norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import face_vector_areas
from spheremesh.kernel.patterns.semiregular import (
    COARSER,
    expanded,
    medial,
    semiregular_pattern,
    truncated,
)
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net
from spheremesh.nodes import panels
from spheremesh.nodes import semiregular_pattern as semiregular_node


def triangle_grid(n: int = 5) -> Mesh:
    """Equilateral triangles of edge 1."""
    i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    points = np.stack([i + j / 2, np.sqrt(0.75) * j, 0 * i], -1).reshape(-1, 3)
    a = (i * n + j)[:-1, :-1].ravel()
    up, down = np.stack([a, a + n, a + 1], 1), np.stack([a + n, a + n + 1, a + 1], 1)
    return Mesh(points, np.concatenate([up, down]))


def square_grid(n: int = 5) -> Mesh:
    i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    a = (i * n + j)[:-1, :-1].ravel()
    points = np.stack([i, j, 0 * i], -1).reshape(-1, 3).astype(float)
    return Mesh(points, np.stack([a, a + n, a + n + 1, a + 1], 1))


@pytest.mark.parametrize(
    ("kind", "pattern", "around"),
    [
        ("3.6.3.6", medial(triangle_grid()), {3: 2, 6: 2}),
        ("3.4.6.4", expanded(triangle_grid()), {3: 1, 4: 2, 6: 1}),
        ("4.8.8", truncated(square_grid(), 1 / COARSER["4.8.8"]), {4: 1, 8: 2}),
    ],
)
def test_law_regular_nets_become_regular_patterns(
    kind: str, pattern: Mesh, around: dict[int, int]
) -> None:
    size = 1 / COARSER[kind]
    inner = ~pattern.topology.is_boundary_vertex
    ends = pattern.topology.edge_vertices
    deep = inner[ends].all(axis=1)
    lengths = norm(pattern.vertices[ends[deep, 0]] - pattern.vertices[ends[deep, 1]])
    full = lengths[np.isclose(lengths, size)]
    assert len(full) > 0.5 * len(lengths)
    middle = np.argmin(norm(pattern.vertices - pattern.vertices.mean(axis=0)))
    faces = pattern.topology.corner_faces[pattern.corners == middle]
    degrees, counts = np.unique(pattern.degrees[faces], return_counts=True)
    assert dict(zip(degrees.tolist(), counts.tolist(), strict=True)) == around


@pytest.mark.parametrize("pattern", [medial, expanded, lambda m: truncated(m, 0.4)])
def test_law_patterns_cover_what_was_there(pattern) -> None:  # noqa: ANN001
    for net in (triangle_grid(), square_grid(), ellipsoid_net(12, 6, 1.0, 1.1, 1.0)):
        made = pattern(net)
        areas = face_vector_areas(made)
        if not net.vertices[:, 2].any():
            assert areas.sum(axis=0) == pytest.approx(face_vector_areas(net).sum(axis=0))
            assert (areas[:, 2] > 0).all()


@pytest.mark.parametrize("kind", list(COARSER))
def test_law_spheres_lessen_the_angle_by_forty_percent_and_all_panels_are_made(
    kind: str,
) -> None:
    surface = ellipsoid_net(24, 12, 1.0, 1.1, 1.0)
    made = semiregular_node(surface, 0.25, kind)
    assert made.report["gain"]["measured"] > 0.4
    assert made.report["status"] == "usable"
    assert panels(made.sphere_mesh, thickness=0.01).report["rejected"] == []
    scaled = Mesh(1024 * surface.vertices + 4096, surface.faces)
    again, judgement = semiregular_pattern(scaled, 1024 * 0.25, kind)  # type: ignore[arg-type]
    assert again.mesh.degrees.tolist() == made.sphere_mesh.mesh.degrees.tolist()
    assert np.degrees(judgement.angle) == pytest.approx(
        made.report["angles_deg"]["spheres"], rel=1e-5
    )


def test_kinds_that_are_none_are_refused() -> None:
    with pytest.raises(InputError, match="kind"):
        semiregular_pattern(ellipsoid_net(12, 6, 1.0, 1.1, 1.0), 0.2, "6.6.6")  # type: ignore[arg-type]
