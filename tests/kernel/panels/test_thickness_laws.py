"""Laws of thickness: on which side it goes, and layers of constant power (E5)."""

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.panels.cutting import cut_panels, thickness_report
from spheremesh.kernel.panels.facts import panel_volumes
from spheremesh.kernel.panels.panels import (
    Panels,
    opposite_corners,
    panel_arcs,
    panel_areas,
)
from spheremesh.kernel.panels.thickness import ThicknessRule, ThicknessSide, panel_faces
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.spheres.arcs import arc_points
from spheremesh.kernel.spheres.incidence import evaluate
from spheremesh.kernel.spheres.rows import center_radius, from_center_radius

SIDES: list[ThicknessSide] = ["inward", "outward", "centred"]
SHARES = {"inward": 0.0, "outward": 1.0, "centred": 0.5}


@pytest.fixture(scope="module")
def optimum(nets: dict[str, Mesh]) -> dict[str, SphereMesh]:
    names = ["torus", "ellipsoid", "egg", "roof"]
    return {name: minimize_angles(face_planes(nets[name]))[0] for name in names}


def octants(octahedron: Mesh, sign: float) -> SphereMesh:
    """The unit sphere in eight, N outwards or inwards."""
    mesh = octahedron
    if sign > 0:
        mesh = Mesh(mesh.vertices, [face[::-1] for face in mesh.faces])
    return SphereMesh(mesh, np.tile([sign * 0.5, 0, 0, 0, -sign * 0.5], (8, 1)))


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_law_shells_of_octants_on_every_side(
    octahedron: Mesh, side: ThicknessSide, sign: float
) -> None:
    t = 0.3
    found = octants(octahedron, sign)
    panels, rejected = cut_panels(found, thickness=t, side=side)
    assert not rejected
    share = SHARES[side]
    outer, inner = 1 - sign * share * t, 1 - sign * (share - 1) * t
    for rows, radius in (
        (panels.spheres, outer),
        (panels.inner_spheres, inner),
        (panels.design_spheres, 1.0),
    ):
        center, square = center_radius(rows)
        np.testing.assert_allclose(square, radius**2, rtol=1e-12)
        np.testing.assert_allclose(center + panels.origins, 0, atol=1e-12)
    np.testing.assert_allclose(panel_areas(panels), np.pi / 2 * outer**2, rtol=1e-10)
    expected = np.pi / 6 * abs(outer**3 - inner**3)
    np.testing.assert_allclose(panel_volumes(panels), expected, rtol=1e-9)
    np.testing.assert_allclose(panels.thicknesses, t, rtol=1e-14)


@pytest.mark.parametrize("name", ["torus", "egg", "roof"])
@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("layer", ["offset", "power"])
def test_law_corners_lie_on_both_faces_of_any_layer(
    optimum: dict[str, SphereMesh], name: str, side: ThicknessSide, layer: ThicknessRule
) -> None:
    edge = mean_edge_length(optimum[name].mesh)
    panels, rejected = cut_panels(
        optimum[name], thickness=0.05 * edge, joint_gap=0.01 * edge, side=side, layer=layer
    )
    assert layer == "power" or not rejected
    owners = panels.corner_panels
    for rows, corners in (
        (panels.spheres, panels.corners),
        (panels.inner_spheres, panels.inner_corners),
    ):
        assert np.abs(evaluate(rows[owners], corners)).max() < 1e-11 * edge
    reach = norm(panels.corners - panels.inner_corners)
    assert (reach > 0.999 * panels.thicknesses[owners]).all()


def steps(panels: Panels, *, inner: bool) -> FloatArray:
    """Distances of the middles of the two arcs of each edge."""
    arcs = panel_arcs(panels, "inner") if inner else panel_arcs(panels)
    middles = arc_points(arcs, np.zeros(1))[:, 0] + panels.origins[panels.corner_panels]
    twins = opposite_corners(panels)
    first = np.flatnonzero(twins > np.arange(len(twins)))
    assert len(first) > 0
    return norm(middles[first] - middles[twins[first]])


@pytest.mark.parametrize("name", ["torus", "ellipsoid", "egg"])
@pytest.mark.parametrize("side", SIDES)
def test_law_e5_layers_of_constant_power_meet_in_the_same_planes(
    optimum: dict[str, SphereMesh], name: str, side: ThicknessSide
) -> None:
    found = optimum[name]
    edge = mean_edge_length(found.mesh)
    rows = found.local_spheres
    assert (rows[:, 0] < 0).mean() > 0.5
    keep = rows[:, 0] < 0
    t = 0.05 * edge
    layers = panel_faces(rows, t, side, "power")
    outer, inner = (center_radius(x)[1] for x in (layers.outer_spheres, layers.inner_spheres))
    square = center_radius(rows)[1]
    # Radii are large against κ: their squares cancel.
    power = (outer - inner)[keep]
    tolerance = 1e-9 * square.max()
    np.testing.assert_allclose(power, power[0], rtol=1e-7, atol=tolerance)
    np.testing.assert_allclose(
        (outer - square)[keep], SHARES[side] * power, rtol=1e-7, atol=tolerance
    )
    assert layers.thicknesses[rows[:, 0] != 0].mean() == pytest.approx(t, rel=1e-12)
    assert layers.thicknesses[keep].max() > 1.01 * layers.thicknesses[keep].min()


@pytest.mark.parametrize("side", SIDES)
def test_law_e5_both_layers_are_watertight_with_constant_power(
    optimum: dict[str, SphereMesh], side: ThicknessSide
) -> None:
    found = optimum["ellipsoid"]
    edge = mean_edge_length(found.mesh)
    cut = [
        cut_panels(found, "intersection", 0.05 * edge, side=side, layer=layer)[0]
        for layer in ("power", "offset")
    ]
    for inner in (False, True):
        power, offset = (steps(panels, inner=inner).max() / edge for panels in cut)
        assert power < 1e-9
        is_given = (side, inner) in (("inward", False), ("outward", True))
        assert (offset < 1e-9) == is_given


def test_law_constant_power_is_covariant(optimum: dict[str, SphereMesh]) -> None:
    rows = optimum["egg"].local_spheres
    t = 0.05 * mean_edge_length(optimum["egg"].mesh)
    expected = panel_faces(rows, t, "centred", "power").thicknesses
    for scale in (1e-3, 1e3):
        scaled = rows * [1 / scale, 1, 1, 1, scale]
        found = panel_faces(scaled, scale * t, "centred", "power").thicknesses
        np.testing.assert_allclose(found, scale * expected, rtol=1e-11)


def test_constant_power_on_two_radii_in_closed_form() -> None:
    radii = np.array([2.0, 5.0])
    rows = from_center_radius(np.zeros((2, 3)), radii**2)
    rows /= 2 * radii[:, None] * np.sign(-rows[:, :1])  # unit, N outwards
    assert (rows[:, 0] < 0).all()
    layers = panel_faces(rows, 0.5, "inward", "power")
    inner = np.sqrt(center_radius(layers.inner_spheres)[1])
    np.testing.assert_allclose(radii - inner, layers.thicknesses, rtol=1e-12)
    np.testing.assert_allclose(np.diff(inner**2), 21.0, rtol=1e-12)
    assert layers.thicknesses.mean() == pytest.approx(0.5, rel=1e-12)


def test_planes_have_no_layer_of_constant_power(octahedron: Mesh) -> None:
    rows = octants(octahedron, -1.0).spheres.copy()
    rows[3] = face_planes(octahedron).spheres[3]
    panels, rejected = cut_panels(SphereMesh(octahedron, rows), thickness=0.1, layer="power")
    assert [r.id for r in rejected] == ["P0003"]
    assert "planes have no thickness" in rejected[0].reason
    np.testing.assert_allclose(panels.thicknesses, 0.1, rtol=1e-12)
    panels, rejected = cut_panels(face_planes(octahedron), thickness=0.1, layer="power")
    assert panels.n_panels == 0
    assert len(rejected) == 8


@pytest.mark.parametrize("thickness", [0.9995, 1.0, 30.0])
def test_constant_power_up_to_the_centre_is_rejected(
    octahedron: Mesh, thickness: float
) -> None:
    _, rejected = cut_panels(octants(octahedron, -1.0), thickness=thickness, layer="power")
    assert len(rejected) == 8
    assert "reaches the centre" in rejected[0].reason


def test_thickness_below_what_can_be_told_is_rejected(octahedron: Mesh) -> None:
    _, rejected = cut_panels(octants(octahedron, -1.0), thickness=1e-9)
    assert len(rejected) == 8
    assert "thinner than a millionth" in rejected[0].reason


def test_unknown_sides_and_layers_are_named(octahedron: Mesh) -> None:
    found = octants(octahedron, -1.0)
    with pytest.raises(InputError, match="side must be inward, outward or centred, not 'up'"):
        cut_panels(found, side="up")  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match="layer must be offset or power, not 'thick'"):
        cut_panels(found, layer="thick")  # pyright: ignore[reportArgumentType]
    message = "edges must be bisector, intersection or axis, not 'sharp'"
    with pytest.raises(InputError, match=message):
        cut_panels(found, "sharp")  # pyright: ignore[reportArgumentType]


@pytest.mark.parametrize("side", SIDES)
def test_law_panels_of_constant_power_are_those_of_their_own_thickness(
    optimum: dict[str, SphereMesh], side: ThicknessSide
) -> None:
    found = optimum["egg"]
    edge = mean_edge_length(found.mesh)
    panels, _ = cut_panels(found, thickness=0.1 * edge, side="inward", layer="power")
    volumes, areas = panel_volumes(panels), panel_areas(panels)
    for i in np.argsort(panels.thicknesses)[[0, len(areas) // 2, -1]].tolist():
        own, _ = cut_panels(found, thickness=panels.thicknesses[i])
        assert volumes[i] == pytest.approx(panel_volumes(own)[i], rel=1e-9)
    centred, _ = cut_panels(found, thickness=0.1 * edge, side=side, layer="power")
    summary = thickness_report(centred)
    assert summary["mean"] == pytest.approx(0.1 * edge, rel=1e-9)
    assert summary["min"] < summary["mean"] < summary["max"]
