"""The schedule: what stands in it, and that people and programs can read it."""

import csv
import json
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from spheremesh.fabrication.model import Model
from spheremesh.fabrication.schedules.panels import panel_tables
from spheremesh.fabrication.schedules.writer import write_schedule
from spheremesh.kernel.errors import InputError, MissingLibraryError
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.facts import panel_volumes
from spheremesh.kernel.panels.mould_blanks import panel_caps
from spheremesh.kernel.panels.panels import (
    Panels,
    panel_areas,
    scale_panels,
)
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.surfaces.circular_nets import torus_net


@pytest.fixture(scope="module")
def panels(moulded: Callable[..., Panels]) -> Panels:
    return moulded(face_planes(torus_net(16, 8, 10.0, 3.0)), 0.05, 0.01, side="outward")


def test_rows_say_what_the_panels_are(panels: Panels) -> None:
    rows = panel_tables(panels, "m")["Panels"]
    assert [row["id"] for row in rows] == list(panels.ids)
    np.testing.assert_allclose([row["area_m2"] for row in rows], panel_areas(panels))
    np.testing.assert_allclose([row["volume_m3"] for row in rows], panel_volumes(panels))
    assert {row["thickness_mm"] for row in rows} == {50.0}
    for row in rows:
        change = row["outer_radius_mm"] - row["inner_radius_mm"]
        assert change == pytest.approx(50.0 if row["bulge"] == "out" else -50.0)
        # Outward: the mould makes the inner face.
        assert row["radius_mm"] == pytest.approx(row["inner_radius_mm"], rel=1e-12)
        corners = np.array(row["corners_mm"]) - row["center_mm"]
        reach = np.sqrt((corners**2).sum(axis=1))
        np.testing.assert_allclose(reach, row["outer_radius_mm"], rtol=1e-9)
        assert len(row["edge_lengths_mm"]) == len(row["neighbors"]) == len(corners) == 4
        assert all(60 < angle < 120 for angle in row["corner_angles_deg"])
    assert rows[0]["same_as"] == "P0000"
    assert len({row["same_as"] for row in rows}) == 4
    assert {row["mould"] for row in rows} == {1, 2, 3}


def test_moulds_and_their_blanks(panels: Panels) -> None:
    rows = panel_tables(panels, "m")["Moulds"]
    assert [row["mould"] for row in rows] == [1, 2, 3]
    diameters = 2000 * panel_caps(panels).radii
    listed = panel_tables(panels, "m")["Panels"]
    for row in rows:
        members = [panel for panel in listed if panel["mould"] == row["mould"]]
        assert row["panels"] == len(members) == len(row["ids"])
        assert row["shapes"] == len({panel["same_as"] for panel in members})
        for panel in members:
            assert panel["radius_mm"] == pytest.approx(row["radius_mm"], rel=1e-9)
        largest = diameters[panels.labels == row["mould"] - 1].max()
        assert row["blank_diameter_mm"] == pytest.approx(largest, rel=1e-12)
        half = np.radians(row["blank_opening_deg"] / 2)
        assert 2 * row["radius_mm"] * np.sin(half) == pytest.approx(largest, rel=1e-9)
        rise = row["radius_mm"] * (1 - np.cos(half))
        assert row["blank_sagitta_mm"] == pytest.approx(rise, rel=1e-6)
    assert (
        panel_tables(cut_panels(face_planes(torus_net(8, 6, 10.0, 3.0)))[0], "m")["Moulds"]
        == []
    )


@pytest.mark.parametrize(("units", "scale"), [("mm", 1000.0), ("ft", 1 / 0.3048)])
def test_law_millimetres_do_not_depend_on_units(
    panels: Panels, units: str, scale: float
) -> None:
    expected = panel_tables(panels, "m")["Panels"]
    found = panel_tables(scale_panels(panels, scale), units)["Panels"]
    for a, b in zip(found, expected, strict=True):
        assert a.keys() == b.keys()
        for name, value in a.items():
            if name == "warnings" or isinstance(value, str | None) or name == "edge_kinds":
                assert value == b[name]
            elif name != "neighbors":
                np.testing.assert_allclose(value, b[name], rtol=1e-9, atol=1e-9)


def test_csv_opens_in_spreadsheets_and_programs(panels: Panels, tmp_path: Path) -> None:
    path = write_schedule(Model(panels), tmp_path / "schedule.csv").path
    assert path.read_bytes().startswith(b"\xef\xbb\xbfid,face,mould,")
    with path.open(encoding="utf-8-sig", newline="") as file:
        rows = list(csv.DictReader(file))
    expected = panel_tables(panels, "m")["Panels"]
    assert len(rows) == len(expected)
    for row, other in zip(rows, expected, strict=True):
        assert row["id"] == other["id"]
        assert float(row["radius_mm"]) == pytest.approx(other["radius_mm"], rel=1e-8)
        lengths = [float(word) for word in row["edge_lengths_mm"].split()]
        np.testing.assert_allclose(lengths, other["edge_lengths_mm"], rtol=1e-8)
        points = [[float(x) for x in point.split()] for point in row["corners_mm"].split(";")]
        np.testing.assert_allclose(points, other["corners_mm"], rtol=1e-7, atol=1e-5)
        assert row["neighbors"].split() == [name or "-" for name in other["neighbors"]]


def test_csv_keeps_the_digits_of_site_coordinates(panels: Panels, tmp_path: Path) -> None:
    """A thousand kilometres from the origin, corners are still told to a micrometre."""
    far = replace(panels, origins=panels.origins + np.array([1e6, -2e6, 5e5]))
    path = write_schedule(Model(far), tmp_path / "schedule.csv").path
    with path.open(encoding="utf-8-sig", newline="") as file:
        rows = list(csv.DictReader(file))
    for row, other in zip(rows, panel_tables(far, "m")["Panels"], strict=True):
        points = [[float(x) for x in point.split()] for point in row["corners_mm"].split(";")]
        np.testing.assert_allclose(points, other["corners_mm"], rtol=0, atol=1e-3)
        center = [float(x) for x in row["center_mm"].split()]
        np.testing.assert_allclose(center, other["center_mm"], rtol=0, atol=1e-3)


def test_json_is_strict(panels: Panels, tmp_path: Path) -> None:
    path = write_schedule(Model(panels), tmp_path / "schedule.json").path
    content = json.loads(path.read_text("utf-8"))
    assert content["units"] == "mm"
    assert content["panels"] == json.loads(json.dumps(panel_tables(panels, "m")["Panels"]))
    assert content["moulds"] == json.loads(json.dumps(panel_tables(panels, "m")["Moulds"]))


def test_xlsx_has_numbers_as_numbers(panels: Panels, tmp_path: Path) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    path = write_schedule(Model(panels), tmp_path / "schedule.xlsx").path
    book = openpyxl.load_workbook(path)
    assert book.sheetnames == ["Panels", "Moulds"]
    header, *rows = book["Panels"].iter_rows(values_only=True)
    expected = panel_tables(panels, "m")["Panels"]
    assert list(header) == list(expected[0])
    assert len(rows) == panels.n_panels
    column = header.index("radius_mm")
    np.testing.assert_allclose(
        [row[column] for row in rows], [row["radius_mm"] for row in expected]
    )
    assert book["Moulds"].max_row == 4


def test_text_in_xlsx_is_what_it_is(panels: Panels, tmp_path: Path) -> None:
    """Neighbours begin with a dash at the boundary; names may look like formulas."""
    openpyxl = pytest.importorskip("openpyxl")
    some = select_parts(panels, panels.face_ids % 8 > 2)
    names = ("=1+1", "-1", "+2", "@A", *some.ids[4:])
    named = replace(some, ids=names)
    book = openpyxl.load_workbook(write_schedule(Model(named), tmp_path / "schedule.xlsx").path)
    header, *rows = book["Panels"].iter_rows()
    cells = [{key.value: cell for key, cell in zip(header, row, strict=True)} for row in rows]
    assert [row["id"].value for row in cells] == list(names)
    assert {row["id"].data_type for row in cells} == {"s"}
    for row, expected in zip(cells, panel_tables(named, "m")["Panels"], strict=True):
        neighbors = " ".join(name or "-" for name in expected["neighbors"])
        assert row["neighbors"].value == neighbors
    assert any(row["neighbors"].value.startswith("- ") for row in cells)


def test_xlsx_without_xlsxwriter_names_the_extra(
    panels: Panels, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "xlsxwriter", None)
    with pytest.raises(MissingLibraryError, match=r"install spheremesh\[excel\]"):
        write_schedule(Model(panels), tmp_path / "schedule.xlsx")
    assert not list(tmp_path.iterdir())


def test_warnings_stand_in_the_row_of_their_panel(panels: Panels, tmp_path: Path) -> None:
    small = scale_panels(panels, 0.002)
    rows = panel_tables(small, "m")["Panels"]
    assert all(row["warnings"].startswith("P103 an edge of ") for row in rows)
    assert not any("P103" in row["warnings"] for row in panel_tables(panels, "m")["Panels"])
    write_schedule(Model(small), tmp_path / "schedule.csv")


def test_what_cannot_be_written(panels: Panels, tmp_path: Path) -> None:
    none = select_parts(panels, np.zeros(panels.n_panels, bool))
    for name in ("s.csv", "s.json", "s.xlsx"):
        with pytest.raises(InputError, match="no panels to write"):
            write_schedule(Model(none), tmp_path / name)
    with pytest.raises(InputError, match=r"end the name in \.csv or \.json or \.xlsx"):
        write_schedule(Model(panels), tmp_path / "s.txt")
    with pytest.raises(InputError, match="unknown units 'mile'"):
        write_schedule(Model(panels, units="mile"), tmp_path / "s.csv")
    assert not list(tmp_path.iterdir())
