"""The fewest moulds are the fewest: every number of moulds says so, asked one by one."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import spheremesh as sm
from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.optimization.radius_clustering import each_clustering
from spheremesh.nodes import (
    GraphError,
    cluster_radii,
    fewest_moulds,
    fit_spheres,
    minimize_angles,
    roof_mesh,
    vase_mesh,
)

ROOM = 1 + 1e-12
"""Bounds are met up to rounding: models of other sizes have other last digits."""


def optimum(mesh: Mesh) -> SphereMesh:
    return minimize_angles(fit_spheres(mesh)).sphere_mesh


def noisy_roof(seed: int) -> SphereMesh:
    """A roof whose vertices lie off any surface: no number of moulds is like the next."""
    mesh = roof_mesh(6, 7)
    noise = np.random.default_rng(seed).normal(size=mesh.vertices.shape)
    return optimum(Mesh(mesh.vertices + 0.03 * noise, mesh.faces))


@pytest.fixture(scope="module", params=["roof", "vase", "noisy"])
def spheres(request: pytest.FixtureRequest) -> SphereMesh:
    made = {"roof": roof_mesh(8, 9), "vase": vase_mesh(16, 9)}
    return optimum(made[request.param]) if request.param in made else noisy_roof(0)


@pytest.mark.filterwarnings("ignore")
def test_every_number_of_moulds_agrees(spheres: SphereMesh) -> None:
    everything = [
        cluster_radii(spheres, k, relax=False).report["angles_deg"]
        for k in range(1, spheres.mesh.n_faces + 1)
    ]
    means = np.array([each["mean"] for each in everything])
    largest = np.array([each["max"] for each in everything])
    for bound in np.quantile(means, [0, 0.03, 0.3, 0.9]):
        found = fewest_moulds(spheres, max_angle=bound)
        assert found.k == 1 + np.argmax(means <= bound)
        assert found.report["mean_deg"] == means[: found.k].tolist()
        assert found.report["max_deg"] == largest[: found.k].tolist()
        highest = float(largest[found.k - 1 :].min())
        both = fewest_moulds(spheres, max_angle=float(means.max()), max_angle_largest=highest)
        assert both.k == 1 + np.argmax(largest <= highest)
        assert both.report["angles_deg"]["max"] <= highest


@pytest.mark.filterwarnings("ignore")
def test_one_walk_gives_all_clusterings(spheres: SphereMesh) -> None:
    for same in (0.0, 1e-3, 0.02):
        walked = [clusters.radii for _, clusters in each_clustering(spheres, same)]
        for k in (1, 2, 3, 7, len(walked), len(walked) + 5):
            alone = cluster_radii(spheres, k, relax=False, same_sagitta=same, units="mm")
            assert np.array_equal(alone.radii, walked[min(k, len(walked)) - 1])


@settings(max_examples=6, deadline=None)
@given(st.floats(-3, 3), st.integers(0, 9))
def test_size_and_numbering_change_nothing(power: float, seed: int) -> None:
    spheres = noisy_roof(1)
    mesh, scale = spheres.mesh, 10**power
    order = np.random.default_rng(seed).permutation(mesh.n_faces)
    other = SphereMesh.from_local(
        Mesh(scale * mesh.vertices, [mesh.faces[i] for i in order]),
        (spheres.local_spheres * [1 / scale, 1, 1, 1, scale])[order],
    )
    found = fewest_moulds(spheres, max_angle=16.43, same_sagitta=0.0)
    bound = found.report["angles_deg"]["mean"] * ROOM
    again = fewest_moulds(other, max_angle=bound, same_sagitta=0.0)
    assert again.k == found.k
    assert again.report["mean_deg"] == pytest.approx(found.report["mean_deg"], rel=1e-6)


def test_creases_do_not_count() -> None:
    corners = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    cube = fit_spheres(Mesh(corners, faces), ring=0)
    assert fewest_moulds(cube, max_angle=0.0, max_angle_largest=0.0).k == 1
    with pytest.raises(InputError, match="even with a mould per panel they meet at 90 degrees"):
        fewest_moulds(optimum(Mesh(corners, faces)), max_angle=60.0, crease=180)


def test_what_cannot_be_reached_is_said() -> None:
    spheres = optimum(roof_mesh(6, 6))
    with pytest.raises(
        InputError, match=r"no number of moulds .* 0.1 degrees in the mean"
    ) as it:
        fewest_moulds(spheres, max_angle=0.1)
    assert "--tolerance" in str(it.value)
    with pytest.raises(InputError, match=r"0.1 degrees in the mean and 0.2 degrees at most"):
        fewest_moulds(spheres, max_angle=0.1, max_angle_largest=0.2)
    with pytest.raises(InputError, match="needs max_angle"):
        fewest_moulds(spheres)
    graph = sm.Graph()
    start = graph.add("fit_spheres", mesh=graph.add("roof_mesh"))
    with pytest.raises(GraphError, match="at most 180 deg"):
        graph.add("fewest_moulds", sphere_mesh=start, max_angle=181)
