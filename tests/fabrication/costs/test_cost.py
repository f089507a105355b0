"""What a model costs: closed forms, and laws of adding up."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spheremesh import Mesh, SphereMesh
from spheremesh.fabrication.costs.cost import CostReport, model_cost
from spheremesh.fabrication.costs.prices import parse_prices
from spheremesh.fabrication.model import Model
from spheremesh.fabrication.units import MILLIMETERS
from spheremesh.kernel.beams.beams import Beams, beam_volumes
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.panels.panels import Panels, panel_areas, scale_panels
from spheremesh.nodes import (
    annulus_support,
    beams,
    cluster_radii,
    ellipsoid_mesh,
    fit_spheres,
    minimize_angles,
    model_change,
    panels,
    roof_mesh,
)

PRICES = {
    "moulds": [
        {"min_radius_m": 3.0, "max_diameter_m": 2.0, "each": 10.0},
        {"each": 100.0, "per_m2": 7.0},
    ],
    "blanks": {"each": 1.0, "per_m2": 20.0, "flat_per_m2": 5.0},
    "panels": {"per_m2": 30.0, "flat_per_m2": 11.0},
    "beams": {"per_kg": 2.0, "density_kg_m3": 2700.0, "per_cut": 3.0, "each": 4.0},
    "nodes": {"each": 50.0},
}


def plates(heights: list[float], size: float = 1.0) -> Panels:
    """Square plates apart from each other, whose corners lie on spheres of a crown height."""
    square = size / 2 * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0.0]])
    shifts = 3 * size * np.arange(len(heights))[:, None, None] * np.array([1.0, 0, 0])
    mesh = Mesh((square + shifts).reshape(-1, 3), np.arange(4 * len(heights)).reshape(-1, 4))
    rows = np.zeros((len(heights), 5))
    rim = size / np.sqrt(2)
    for i, height in enumerate(heights):
        rows[i] = [0, 0, 0, 1, 0]
        if height:
            radius = (rim**2 + height**2) / (2 * height)
            down = radius - height
            # |x - c|² - r² with c = (0, 0, -down), as a unit row that points up
            rows[i] = np.array([1, 0, 0, 2 * down, down**2 - radius**2]) / (2 * radius)
    return panels(SphereMesh.from_local(mesh, rows)).panels


@pytest.fixture(scope="module")
def structure() -> tuple[Panels, Beams]:
    sphere_mesh = model_change(ellipsoid_mesh(12, 6), radius=4.0)
    made = beams(annulus_support(sphere_mesh, depth=0.1).annuli, thickness=0.02)
    return panels(sphere_mesh, thickness=0.02).panels, made.beams


def cost_of(parts: Panels | None, made: Beams | None = None, units: str = "m") -> CostReport:
    return model_cost(Model(parts, made, units), parse_prices(PRICES))


def test_a_plate_and_two_domes_by_hand() -> None:
    height = 0.2
    found = cost_of(plates([0.0, height, height]))
    cap = np.pi * (0.5 + height**2)
    assert found["quantities"]["panels"] == 3
    assert found["quantities"]["flat_panels"] == 1
    assert found["quantities"]["flat_blank_m2"] == pytest.approx(1.0)
    assert found["quantities"]["flat_panel_m2"] == pytest.approx(1.0)
    assert found["quantities"]["curved_blank_m2"] == pytest.approx(2 * cap)
    radius = (0.5 + height**2) / (2 * height)
    [mould] = found["moulds"]
    assert mould["radius_mm"] == pytest.approx(1000 * radius)
    assert mould["diameter_mm"] == pytest.approx(1000 * np.sqrt(2))
    assert mould["panels"] == 2
    assert mould["cost"] == pytest.approx(100 + 7 * cap)  # too sharp for the first row
    assert found["parts"]["blanks"] == pytest.approx(3 + 5 + 20 * 2 * cap)
    assert found["total"] == pytest.approx(sum(found["parts"].values()))


def test_the_first_price_that_fits() -> None:
    assert [row["cost"] for row in cost_of(plates([0.05]))["moulds"]] == [10.0]
    assert cost_of(plates([0.05], size=1.5))["moulds"][0]["cost"] > 100  # too large a blank
    rim = np.sqrt(0.5)
    exact = 3.0 - np.sqrt(9.0 - rim**2)  # a radius of 3 m, but for rounding
    assert cost_of(plates([exact]))["moulds"][0]["cost"] == 10.0
    few = parse_prices({"moulds": {"max_diameter_m": 1.0, "each": 1.0}})
    with pytest.raises(InputError, match=r"no price for mould 1, of a radius of 5.0.* 1.414 m"):
        model_cost(Model(plates([0.05])), few)


def test_flat_panels_need_no_mould() -> None:
    found = cost_of(plates([0.0, 0.0]))
    assert found["moulds"] == []
    assert found["parts"]["moulds"] == 0


def test_beams_and_nodes(structure: tuple[Panels, Beams]) -> None:
    _, made = structure
    found = cost_of(None, made)
    mass = 2700 * beam_volumes(made).sum()
    assert found["quantities"]["beam_kg"] == pytest.approx(mass)
    assert found["parts"]["beams"] == pytest.approx(2 * mass + made.n_beams * (4 + 2 * 3))
    assert found["parts"]["nodes"] == 50 * len(np.unique(made.annuli.edge_vertices))
    assert found["per_m2"] is None


def test_parts_add_up(structure: tuple[Panels, Beams]) -> None:
    both, alone, steel = cost_of(*structure), cost_of(structure[0]), cost_of(None, structure[1])
    assert both["total"] == pytest.approx(alone["total"] + steel["total"])
    area = panel_areas(structure[0]).sum()
    assert both["per_m2"] == pytest.approx(both["total"] / area)
    assert both["unpriced"] == []
    none = model_cost(Model(*structure), parse_prices({"panels": {"each": 1.0}}))
    assert none["unpriced"] == ["moulds", "beams", "nodes"]


@settings(max_examples=10, deadline=None)
@given(st.sampled_from(sorted(MILLIMETERS)))
def test_units_change_no_price(units: str) -> None:
    sphere_mesh = minimize_angles(fit_spheres(roof_mesh(4, 5))).sphere_mesh
    few = cluster_radii(sphere_mesh, 3)
    made = panels(few.sphere_mesh, thickness=0.02, labels=few.labels).panels
    scaled = scale_panels(made, 1000 / MILLIMETERS[units])
    assert cost_of(scaled, units=units)["total"] == pytest.approx(cost_of(made)["total"])


def test_moulds_with_and_without_numbers() -> None:
    """Panels of one radius share a mould, numbered or not."""
    sphere_mesh = minimize_angles(fit_spheres(roof_mesh(4, 5))).sphere_mesh
    few = cluster_radii(sphere_mesh, 3)
    numbered = panels(few.sphere_mesh, labels=few.labels).panels
    free = panels(few.sphere_mesh).panels
    one, other = cost_of(numbered)["moulds"], cost_of(free)["moulds"]
    assert len(one) == len(other) == 3
    for a, b in zip(one, other, strict=True):
        assert {**a} == pytest.approx({**b}, rel=1e-6)


def test_nothing_to_price() -> None:
    with pytest.raises(InputError, match="no panels or beams to price"):
        cost_of(None)
