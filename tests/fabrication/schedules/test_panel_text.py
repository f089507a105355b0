"""User text in Rhino, rows of the schedule and layers of STEP say the same of a panel."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rhino3dm

from spheremesh.fabrication.drawings.moulds import write_mould_drawings
from spheremesh.fabrication.model import Model
from spheremesh.fabrication.rhino_models.writer import write_3dm
from spheremesh.fabrication.schedules.panels import panel_tables
from spheremesh.fabrication.step.writer import write_step
from spheremesh.kernel.optimization.radius_clustering import cluster_radii
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.panels import Panels
from spheremesh.kernel.panels.thickness import ThicknessRule, ThicknessSide
from spheremesh.kernel.sphere_meshes.sphere_mesh import SphereMesh
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.kernel.surfaces.circular_nets import roof_net

FOOT = 304.8


def roof(
    side: ThicknessSide = "inward", layer: ThicknessRule = "offset", plane_share: int = 5
) -> Panels:
    """Domes and dishes in moulds, some of them planes; one panel is without mould."""
    mesh = roof_net(5, 4, 20.0)
    planes, great_spheres = circle_pencils(face_circles(mesh)[0])
    angles = np.random.default_rng(2).uniform(0.1, 0.4, mesh.n_faces)
    angles[1::3] *= -1
    angles[::plane_share] = 0
    rows = pencil_spheres(planes, great_spheres, angles)
    clusters = cluster_radii(SphereMesh.from_local(mesh, rows), 4)[1]
    labels = np.where(np.arange(mesh.n_faces) == 3, -1, clusters.labels)
    panels, _ = cut_panels(
        SphereMesh.from_local(mesh, rows), "bisector", 0.05, 0.01, labels, side, layer
    )
    return panels


def texts(path: Path) -> dict[str, dict[str, str]]:
    """User text of the panels by name."""
    model: Any = rhino3dm.File3dm.Read(str(path))
    found = [dict(item.Attributes.GetUserStrings()) for item in model.Objects]
    return {text["id"]: text for text in found if "mould" in text}


@pytest.mark.parametrize(
    ("side", "layer"),
    [("inward", "offset"), ("outward", "offset"), ("centred", "offset"), ("inward", "power")],
)
def test_user_text_is_the_row_of_the_schedule(
    tmp_path: Path, side: ThicknessSide, layer: ThicknessRule
) -> None:
    panels = roof(side, layer, plane_share=5 if layer == "offset" else 10**9)
    found = texts(write_3dm(Model(panels, units="ft"), tmp_path / "p.3dm").path)
    rows = panel_tables(panels, "ft")["Panels"]
    assert set(found) == {row["id"] for row in rows}
    assert layer == "power" or {row["shape"] for row in rows} == {"sphere", "plane"}
    outer = [row["outer_radius_mm"] == row["radius_mm"] for row in rows if row["radius_mm"]]
    assert all(outer) if side == "inward" else not any(outer)
    for row in rows:
        text = found[row["id"]]
        assert text["units"] == "ft"
        assert text["face"] == str(row["face"])
        assert text["bulge"] == row["bulge"]
        assert text["mould"] == (f"{row['mould']:02d}" if row["mould"] else "-")
        assert text["neighbors"].split() == [name or "-" for name in row["neighbors"]]
        if row["shape"] == "plane":
            assert (text["radius"], text["center"]) == ("plane", "-")
        else:
            radius, center = float(text["radius"]), np.array(text["center"].split(), float)
            assert radius * FOOT == pytest.approx(row["radius_mm"], rel=1e-11)
            np.testing.assert_allclose(center * FOOT, row["center_mm"], rtol=1e-11)
        area = float(text["area"]) * FOOT**2 / 1e6
        assert area == pytest.approx(row["area_m2"], rel=1e-11)
        assert float(text["thickness"]) * FOOT == pytest.approx(row["thickness_mm"], rel=1e-11)


def test_moulds_have_one_name_in_every_file(tmp_path: Path) -> None:
    """A hundred moulds need three digits, everywhere."""
    panels = roof()
    panels = replace(panels, labels=np.where(panels.labels == 1, 99, panels.labels))
    model: Any = rhino3dm.File3dm.Read(str(write_3dm(Model(panels), tmp_path / "p.3dm").path))
    names = {layer.Name for layer in model.Layers if layer.Name.startswith("Mould")}
    text = write_step(Model(panels), tmp_path / "p.step").path.read_text("ascii")
    layers = set(re.findall(r"PRESENTATION_LAYER_ASSIGNMENT\('(Mould \d+)'", text))
    drawn = write_mould_drawings(Model(panels), tmp_path / "p.svg").path.read_text("utf-8")
    assert {"Mould 001", "Mould 003", "Mould 100"} < layers <= names
    assert set(re.findall(r"(Mould \d+):", drawn)) == layers
    numbers = {text["mould"] for text in texts(tmp_path / "p.3dm").values()}
    assert {f"Mould {number}" for number in numbers - {"-"}} == layers
