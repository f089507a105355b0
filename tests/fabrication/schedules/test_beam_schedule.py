"""The schedule of beams: what stands in it, and that people and programs can read it."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from spheremesh.fabrication.model import Model
from spheremesh.fabrication.schedules.beams import beam_tables
from spheremesh.fabrication.schedules.writer import write_schedule
from spheremesh.kernel.beams.beams import Beams, beam_volumes, scale_beams
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.beams.drilling import drill_beams
from spheremesh.kernel.beams.facts import beam_facts
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.panels import Panels
from spheremesh.kernel.parts.records import part_ids, select_parts
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import vase_net

VASE = central_spheres(vase_net(10, 6, 2.0, 5.0, 0.3))


def made(radius: float = 0.06) -> Beams:
    annuli = annulus_support(VASE, depth=0.2).annuli
    return drill_beams(cut_beams(annuli, 0.04, 0.01, radius)[0], 2, 0.03, 0.04)[0]


BEAMS = made()


@pytest.fixture(scope="module")
def panels() -> Panels:
    return cut_panels(VASE, "intersection", 0.02)[0]


def test_rows_say_what_the_beams_are() -> None:
    rows, facts = beam_tables(BEAMS, "m")["Beams"], beam_facts(BEAMS)
    assert [row["id"] for row in rows] == list(BEAMS.annuli.ids)
    np.testing.assert_allclose([row["volume_m3"] for row in rows], beam_volumes(BEAMS))
    for name, values in (
        ("outer_length_mm", facts.outer_lengths), ("inner_length_mm", facts.inner_lengths),
        ("outer_radius_mm", facts.outer_radii), ("chord_mm", facts.chords),
        ("length_mm", facts.lengths), ("size_mm", facts.sizes), ("depths_mm", facts.depths),
        ("ends_mm", facts.ends),
    ):  # fmt: skip
        np.testing.assert_allclose(
            [row[name] for row in rows], 1000 * values, rtol=1e-12, atol=1e-9
        )
    assert {row["thickness_mm"] for row in rows} == {40.0}
    bevels = [row["bevels_deg"] for row in rows]
    np.testing.assert_allclose(bevels, 90, rtol=0, atol=1e-10)  # pyright: ignore
    assert {row["holes"] for row in rows} == {4}
    tilted = facts.tilts > np.pi / 6
    assert ["B201" in row["warnings"] for row in rows] == tilted.tolist()
    assert 0 < sum(row["warnings"] == "" for row in rows) < len(rows)
    mesh = VASE.mesh
    for row in rows:
        nodes = [int(name[1:]) for name in row["nodes"]]
        assert nodes == BEAMS.annuli.edge_vertices[rows.index(row)].tolist()
        beside = [name and int(name[1:]) for name in row["panels"]]
        assert all(set(nodes) <= set(mesh.faces[f].tolist()) for f in beside if f is not None)
    # Of the two rings on the rim, each beam has one panel.
    assert sum(row["panels"][1] is None for row in rows) == 20


def test_rows_of_straight_beams_have_no_radius() -> None:
    annuli = annulus_support(face_planes(VASE.mesh), depth=0.2).annuli
    rows = beam_tables(cut_beams(annuli, 0.04)[0], "m")["Beams"]
    assert all(row["outer_radius_mm"] is row["inner_radius_mm"] is None for row in rows)
    assert {row["sagitta_mm"] for row in rows} == {0.0}
    assert {row["holes"] for row in rows} == {0}


def test_warnings_stand_in_the_row_of_their_beam() -> None:
    rows = beam_tables(scale_beams(BEAMS, 0.01), "m")["Beams"]
    assert all("B205 is only" in row["warnings"] for row in rows)


def test_rows_of_nodes() -> None:
    rows = beam_tables(BEAMS, "m")["Nodes"]
    assert [row["id"] for row in rows] == [f"N{row['vertex']:04d}" for row in rows]
    ends = {row["id"]: set[str]() for row in rows}
    for beam in beam_tables(BEAMS, "m")["Beams"]:
        for name in beam["nodes"]:
            ends[name].add(beam["id"])
    for row in rows:
        assert set(row["beams"]) == ends[row["id"]]
        assert row["radius_mm"] == 60.0
        assert np.linalg.norm(row["direction"]) == pytest.approx(1)
        assert row["height_mm"] > 150
    assert beam_tables(made(0.0), "m")["Nodes"] == []


@pytest.mark.parametrize(("units", "scale"), [("mm", 1000.0), ("ft", 1 / 0.3048)])
def test_law_millimetres_do_not_depend_on_units(units: str, scale: float) -> None:
    scaled = scale_beams(BEAMS, scale)
    found_tables, expected_tables = beam_tables(scaled, units), beam_tables(BEAMS, "m")
    for table, rows in expected_tables.items():
        for a, b in zip(found_tables[table], rows, strict=True):
            assert a.keys() == b.keys()
            for name, value in a.items():
                if name in {"panels", "nodes", "beams", "id", "warnings"}:
                    assert value == b[name]
                else:
                    found, expected = (np.array(v, np.float64) for v in (value, b[name]))
                    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-8)


def test_csv_opens_in_spreadsheets_and_programs(tmp_path: Path) -> None:
    path = write_schedule(Model(beams=BEAMS), tmp_path / "beams.csv").path
    assert path.read_bytes().startswith(b"\xef\xbb\xbfid,edge,panels,nodes,")
    with path.open(encoding="utf-8-sig", newline="") as file:
        rows = list(csv.DictReader(file))
    expected = beam_tables(BEAMS, "m")["Beams"]
    assert len(rows) == len(expected)
    for row, other in zip(rows, expected, strict=True):
        assert row["id"] == other["id"]
        assert row["nodes"].split() == other["nodes"]
        assert row["panels"].split() == [name or "-" for name in other["panels"]]
        assert float(row["outer_length_mm"]) == pytest.approx(
            other["outer_length_mm"], rel=1e-8
        )
        bevels = [[float(x) for x in end.split()] for end in row["bevels_deg"].split(";")]
        np.testing.assert_allclose(bevels, other["bevels_deg"], rtol=1e-8)


def test_json_holds_panels_as_before_and_beams(panels: Panels, tmp_path: Path) -> None:
    alone = json.loads(
        write_schedule(Model(panels), tmp_path / "p.json").path.read_text("utf-8")
    )
    assert set(alone) == {"units", "panels", "moulds"}
    both = write_schedule(Model(panels, BEAMS), tmp_path / "b.json").path
    content = json.loads(both.read_text("utf-8"))
    assert {name: content[name] for name in alone} == alone
    assert content["beams"] == json.loads(json.dumps(beam_tables(BEAMS, "m")["Beams"]))
    assert content["nodes"] == json.loads(json.dumps(beam_tables(BEAMS, "m")["Nodes"]))
    beside = {name for row in content["beams"] for name in row["panels"]} - {None}
    assert beside <= set(part_ids("P", VASE.mesh.n_faces))


def test_xlsx_has_sheets_of_beams_and_nodes(panels: Panels, tmp_path: Path) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    path = write_schedule(Model(panels, BEAMS), tmp_path / "s.xlsx").path
    book = openpyxl.load_workbook(path)
    assert book.sheetnames == ["Panels", "Moulds", "Beams", "Nodes"]
    header, *rows = book["Beams"].iter_rows(values_only=True)
    column = header.index("chord_mm")
    expected = [row["chord_mm"] for row in beam_tables(BEAMS, "m")["Beams"]]
    np.testing.assert_allclose([row[column] for row in rows], expected)


def test_what_cannot_be_written(panels: Panels, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no panels or beams to write"):
        write_schedule(Model(), tmp_path / "s.csv")
    with pytest.raises(InputError, match="holds one table: write panels and beams to a"):
        write_schedule(Model(panels, BEAMS), tmp_path / "s.csv")
    none = select_parts(BEAMS, np.zeros(BEAMS.n_beams, bool))
    with pytest.raises(InputError, match="no beams to write"):
        write_schedule(Model(beams=none), tmp_path / "s.csv")
    corners = BEAMS.corners.copy()
    corners[2] = np.nan
    with pytest.raises(InputError, match=r"beam B0002 \(1 in all\) is not finite"):
        write_schedule(Model(beams=replace(BEAMS, corners=corners)), tmp_path / "s.csv")
    assert not list(tmp_path.iterdir())
