"""Tidy tables: what they say, that programs read them, and that people find it explained."""

import csv
import io
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from spheremesh.fabrication.model import Model
from spheremesh.fabrication.schedules.beam_records import beam_records
from spheremesh.fabrication.schedules.data_dictionary import NODE_BEAMS, TABLES
from spheremesh.fabrication.schedules.materials import Material, parse_material
from spheremesh.fabrication.schedules.panel_records import panel_records
from spheremesh.fabrication.schedules.record_files import write_tables
from spheremesh.kernel.beams.beams import Beams, scale_beams
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.beams.drilling import drill_beams
from spheremesh.kernel.errors import InputError, MissingLibraryError
from spheremesh.kernel.panels.panels import Panels, scale_panels
from spheremesh.kernel.parts.assembly_order import assembly_order
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import vase_net

pd = pytest.importorskip("pandas")
openpyxl = pytest.importorskip("openpyxl")
pytest.importorskip("xlsxwriter")

DOCS = Path(__file__).parents[3] / "docs" / "tables.md"
TEXTS = {
    "id", "same_as", "shape", "bulge", "material", "warnings", "panel", "kind", "neighbor",
    "left_panel", "right_panel", "start_node", "end_node", "beam", "node",
}  # fmt: skip
VASE = central_spheres(vase_net(10, 6, 2.0, 5.0, 0.3))
STEEL, GLASS = parse_material("steel"), parse_material("glass")


def cut(radius: float = 0.06) -> Beams:
    annuli = annulus_support(VASE, depth=0.2).annuli
    return drill_beams(cut_beams(annuli, 0.04, 0.01, radius)[0], 2, 0.03, 0.04)[0]


BEAMS = cut()


@pytest.fixture(scope="module")
def panels(moulded: Callable[..., Panels]) -> Panels:
    some = face_planes(vase_net(10, 6, 2.0, 5.0, 0.3))
    return moulded(some, 0.02, 0.005)


def columns_of(name: str, found: Any) -> tuple[list[str], list[str]]:  # noqa: ANN401
    """Columns as the dictionary has them, and as they are, those of a node's beams left out."""
    about = [column for column in found if column.startswith(("beam_", "angle_"))]
    return list(TABLES[name]), [c for c in found if name != "nodes" or c not in about]


def test_pandas_reads_numbers_where_numbers_are(panels: Panels, tmp_path: Path) -> None:
    for name in TABLES:
        path = write_tables(Model(panels, BEAMS), tmp_path / f"roof_{name}.csv").path
        table = pd.read_csv(path)
        expected, found = columns_of(name, table.columns)
        assert found == expected
        assert len(table) > 0
        for column in table:
            is_text = column in TEXTS or (name, str(column)[:5]) == ("nodes", "beam_")
            assert pd.api.types.is_numeric_dtype(table[column]) != is_text, column
            words = str(column).split("_")
            if not is_text and table[column].dtype == float and len(words) > 1:
                assert words[-1] in {"mm", "deg", "m2", "m3", "kg", "x", "y", "z"} or (
                    column in {"neighbor_edge"}
                )


def test_nothing_is_lost_from_a_workbook_to_csv(panels: Panels, tmp_path: Path) -> None:
    book = write_tables(Model(panels, BEAMS), tmp_path / "all.xlsx").path
    sheets = pd.read_excel(book, sheet_name=None)
    assert list(sheets) == list(TABLES)
    for name, sheet in sheets.items():
        path = write_tables(Model(panels, BEAMS), tmp_path / f"{name}.csv").path
        again = pd.read_csv(io.StringIO(sheet.to_csv(index=False)))
        first = pd.read_csv(path)
        pd.testing.assert_frame_equal(again, first, check_exact=True, check_dtype=False)


def test_parquet_says_the_same(panels: Panels, tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    for name in ("panels", "beam_ends"):
        first = pd.read_csv(write_tables(Model(panels, BEAMS), tmp_path / f"{name}.csv").path)
        file = write_tables(Model(panels, BEAMS), tmp_path / f"{name}.parquet").path
        pd.testing.assert_frame_equal(pd.read_parquet(file), first, check_dtype=False)


def test_numbers_have_no_noise(panels: Panels, tmp_path: Path) -> None:
    path = write_tables(Model(panels), tmp_path / "panel_edges.csv").path
    with path.open(encoding="utf-8-sig", newline="") as file:
        for row in csv.DictReader(file):
            for name, word in row.items():
                assert not (name.endswith("_mm") and len(word.partition(".")[2]) > 3)
                assert "e" not in word or name in TEXTS
                assert word != "-0.0"


def test_edges_of_neighbours_lie_at_each_other(panels: Panels) -> None:
    rows = pd.DataFrame(panel_records(panels, "m", GLASS)["panel_edges"])
    rows = rows.set_index(["panel", "edge"])
    inner = rows[rows.neighbor != "-"]
    twins = rows.loc[list(zip(inner.neighbor, inner.neighbor_edge, strict=True))]
    assert twins.neighbor.to_list() == inner.index.get_level_values("panel").to_list()
    np.testing.assert_allclose(twins.neighbor_angle_deg, inner.neighbor_angle_deg)
    assert set(rows[rows.neighbor == "-"].kind) == {"rim"}


def test_nodes_count_their_beams_about_the_axis() -> None:
    tables = beam_records(BEAMS, "m", STEEL)
    beams = pd.DataFrame(tables["beams"])
    nodes = pd.DataFrame(tables["nodes"])
    for node in nodes.to_dict("records"):
        names = [node[f"beam_{i}"] for i in range(1, 5) if node[f"beam_{i}"] != "-"]
        angles = [node[f"angle_{i}_deg"] for i in range(1, len(names) + 1)]
        meet = beams[(beams.start_node == node["id"]) | (beams.end_node == node["id"])]
        assert set(names) == set(meet.id)
        assert len(names) == node["valence"]
        assert sum(angles) == pytest.approx(360, abs=1e-3)
        assert min(angles) > 30
        # Between two beams that follow each other lies the panel on the left of the first.
        for first, second in zip(names, names[1:] + names[:1], strict=True):
            sides = [set(meet.loc[meet.id == beam, ["left_panel", "right_panel"]].iloc[0])
                     for beam in (first, second)]  # fmt: skip
            assert node["valence"] < 4 or sides[0] & sides[1]
    ends = pd.DataFrame(tables["beam_ends"]).groupby("node")[["outer_x_mm"]].mean()
    np.testing.assert_allclose(ends.loc[nodes.id, "outer_x_mm"], nodes.x_mm, atol=2e-3)


def test_masses_come_from_the_material(panels: Panels) -> None:
    table = panel_records(panels, "m", Material("GFRC", 1900.0))["panels"]
    np.testing.assert_allclose(table["mass_kg"], 1900 * np.array(table["volume_m3"]), atol=6e-4)
    surfaces = replace(panels, thickness=0.0, thicknesses=0 * panels.thicknesses)
    assert set(panel_records(surfaces, "m", GLASS)["panels"]["mass_kg"]) == {None}


def test_parts_are_put_up_from_below_beside_one_that_stands() -> None:
    order = assembly_order(np.array([3.0, 0.0, 1.0, 9.0, 0.5]), np.array([[1, 0], [0, 2]]))
    assert order.tolist() == [2, 1, 3, 5, 4]
    tables = beam_records(BEAMS, "m", STEEL)["beams"]
    assert sorted(tables["assembly_order"]) == list(range(1, BEAMS.n_beams + 1))


@pytest.mark.parametrize(("units", "scale"), [("mm", 1000.0), ("ft", 1 / 0.3048)])
def test_law_millimetres_do_not_depend_on_units(
    panels: Panels, units: str, scale: float
) -> None:
    first = panel_records(panels, "m", GLASS) | beam_records(BEAMS, "m", STEEL)
    second = panel_records(scale_panels(panels, scale), units, GLASS)
    second |= beam_records(scale_beams(BEAMS, scale), units, STEEL)
    for name, table in first.items():
        for column, values in table.items():
            if column in TEXTS or isinstance(values[0], str):
                assert second[name][column] == values
            else:
                found, expected = (
                    np.array(each, float) for each in (second[name][column], values)
                )
                np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1.1e-3)


def test_the_page_explains_every_column() -> None:
    lines = DOCS.read_text("utf-8").splitlines()
    for name, columns in TABLES.items():
        start = lines.index(f"### `{name}`")
        page = [f"| `{column}` | {text} |" for column, text in columns.items()]
        if name == "nodes":
            page += [
                f"| `{column.format(1)}`, … | {text} |" for column, text in NODE_BEAMS.items()
            ]
        assert lines[start + 2 : start + 4] == ["| column | what it says |", "|---|---|"]
        assert lines[start + 4 : start + 4 + len(page)] == page


def test_what_cannot_be_written(
    panels: Panels, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = Model(panels)
    with pytest.raises(InputError, match="end its name in one of panels, panel_edges"):
        write_tables(model, tmp_path / "roof.csv")
    with pytest.raises(InputError, match="no beams to write"):
        write_tables(model, tmp_path / "nodes.csv")
    with pytest.raises(InputError, match=r"end the name in \.csv or \.xlsx or \.parquet"):
        write_tables(model, tmp_path / "panels.txt")
    for material in ("granite", "granite=", "=3", "granite=-1", "granite=nan"):
        with pytest.raises(InputError, match="unknown material"):
            write_tables(model, tmp_path / "panels.csv", panel_material=material)
    none = select_parts(panels, np.zeros(panels.n_panels, bool))
    with pytest.raises(InputError, match="no panels to write"):
        write_tables(Model(none), tmp_path / "panels.csv")
    for library, name in (("xlsxwriter", "a.xlsx"), ("pyarrow", "panels.parquet")):
        monkeypatch.setitem(sys.modules, library, None)
        with pytest.raises(MissingLibraryError, match=r"install spheremesh\["):
            write_tables(model, tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_a_workbook_has_the_same_bytes(panels: Panels, tmp_path: Path) -> None:
    first, second = (
        write_tables(Model(panels), tmp_path / f"{name}.xlsx").path.read_bytes()
        for name in "ab"
    )
    assert first == second
    assert openpyxl.load_workbook(tmp_path / "a.xlsx").sheetnames[0] == "panels"
