import json
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from spheremesh import Graph
from spheremesh.kernel.panels.panels import Panels
from spheremesh.nodes import (
    NodeWarning,
    audit,
    cluster_radii,
    fit_spheres,
    minimize_angles,
    mould_blanks,
    nest_parts,
    panel_report,
    panels,
    vase_mesh,
    write_report,
)
from spheremesh.viewer.report.charts import histogram
from spheremesh.viewer.report.diagram import graph_picture
from spheremesh.viewer.report.document import ReportFacts, report_text

VOID = {"meta", "img", "line", "rect", "path"}


class Tags(HTMLParser):
    """Whether every tag that is opened is closed, in order; what it asks for; its words."""

    def __init__(self) -> None:
        super().__init__()
        self.opened: list[str] = []
        self.asked: list[str] = []
        self.words = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note what is opened, and every address."""
        self.asked += [value or "" for name, value in attrs if name in {"src", "href"}]
        if tag not in VOID:
            self.opened.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Nothing is opened."""

    def handle_endtag(self, tag: str) -> None:
        """Close what was opened last."""
        assert self.opened.pop() == tag

    def handle_data(self, data: str) -> None:
        """Note words."""
        self.words += data


def read(text: str) -> Tags:
    tags = Tags()
    tags.feed(text)
    assert not tags.opened
    return tags


@pytest.fixture(scope="module")
def made() -> tuple[Panels, dict[str, Any]]:
    optimum = minimize_angles(fit_spheres(vase_mesh(12, 6)))
    moulds = cluster_radii(optimum.sphere_mesh, k=3)
    cut = panels(moulds.sphere_mesh, thickness=0.02, labels=moulds.labels)
    found = audit(cut.panels, cut.report)
    report = panel_report(
        moulds.sphere_mesh, optimum.report, cut.report, moulds.report,
        mould_blanks(cut.panels), found.report,
    )  # fmt: skip
    return cut.panels, dict(report)


def facts(report: dict[str, Any], **changes: object) -> ReportFacts:
    known = {
        "title": "Vase", "report": report, "angles": np.full(100, 9.0), "graph": "",
        "version": "1.2.3", "millimeters": 1000.0,
    }  # fmt: skip
    return ReportFacts(**{**known, **changes})


def test_report_has_every_chapter_and_asks_for_nothing(made: tuple[Panels, Any]) -> None:
    text = report_text(made[0], facts(made[1]))
    tags = read(text)
    for words in ("Before and after", "Angles between", "Moulds: 3 for 72", "Gaps", "1.2.3"):
        assert words in tags.words
    assert len(tags.asked) == 2
    assert all(address.startswith("data:image/jpeg;base64,") for address in tags.asked)
    assert "<script" not in text
    assert len(text) < 200_000


def test_names_stay_in_their_place(made: tuple[Panels, Any]) -> None:
    wicked = '</title><script>"Dächer" &'
    report = made[1] | {"warnings": ["<b>loud</b>"]}
    text = report_text(made[0], facts(report, title=wicked))
    assert wicked in read(text).words
    assert "<script" not in text
    assert "<b>loud" not in text


def test_what_is_wrong_is_sorted_and_counted(made: tuple[Panels, Any]) -> None:
    rejected = [{"id": f"P{i:04d}", "code": "P101", "reason": "too thin"} for i in range(20)]
    # The audit says of what is rejected that it cannot be made: no error more.
    errors = [
        {"code": "P101", "id": "P0003", "message": "cannot be made", "size": None},
        {"code": "P201", "id": "P0050", "message": "a step of 7 mm", "size": 7.0},
        {"code": "P201", "id": "P0051", "message": "a step of 9 mm", "size": 9.0},
        {"code": "B201", "id": "B0001", "message": "twisted", "size": 1.0},
    ]
    report = made[1] | {
        "panels": {"written": 52, "rejected": rejected},
        "beams": {"written": 30, "rejected": []},
        "audit": {"counts": {}, "errors": errors, "notes": []},
        "buildable": False,
    }
    text = report_text(made[0], facts(report))
    words = read(text).words
    assert "72 panels: 20 cannot be made, 2 more with errors; 30 beams: 1 with errors." in words
    assert "2 parts, worst P0051: a step of 9 mm" in words
    assert "20 of these panels cannot be made" in words
    assert "P0011 and 8 more" in words
    assert words.index("P101") < words.index("P201")
    assert words.count("P0003") == 1


def test_sharp_edges_are_told_apart(made: tuple[Panels, Any]) -> None:
    assert "stay sharp" not in read(report_text(made[0], facts(made[1]))).words
    for count, said in ((1, "One edge stays sharp"), (3, "3 edges stay sharp")):
        creases = {"angle_deg": 40.0, "count": count, "max_deg": 57.9, "edges": []}
        words = read(report_text(made[0], facts(made[1] | {"creases": creases}))).words
        assert said in words
        assert "57.9°" in words


def test_sheets_are_counted_where_pieces_are_nested(made: tuple[Panels, Any]) -> None:
    cut, report = made
    assert "Sheets" not in read(report_text(cut, facts(report))).words
    with pytest.warns(NodeWarning, match="larger than the sheet"):
        found = nest_parts(cut, sheet=(600.0, 600.0), margin=0.0)
    words = read(report_text(cut, facts(report, sheets=found))).words
    large = len(found["oversize"])
    assert 0 < large < 72
    assert f"Sheets: {found['sheets']} for {72 - large} pieces" in words
    assert f"{large} pieces are larger than a sheet" in words


def test_histograms_count_shares() -> None:
    values = np.array([0.5, 0.5, 0.5, 2.5, np.nan])
    text = histogram([("all", "#000", values), ("none", "#111", np.zeros(0))], "°", label="x")
    heights = [float(h) for h in re.findall(r'height="([\d.]+)" fill', text)]
    assert max(heights) == pytest.approx(3 * min(heights), rel=1e-2)
    assert len(heights) == 2
    assert histogram([("none", "#000", np.zeros(0))], "", label="x") == ""


def test_steps_stand_below_what_they_need() -> None:
    graph = {
        "steps": {
            "mesh": {"node": "vase_mesh", "inputs": {}},
            "fit": {"node": "fit_spheres", "inputs": {"mesh": {"wire": "mesh"}}},
            "many": {"node": "f", "inputs": {"x": {"each": {"wire": "fit.sphere_mesh"}}}},
            "both": {"node": "g", "inputs": {"x": [{"wire": "mesh"}, {"wire": "many"}]}},
        }
    }
    text = graph_picture(graph)
    tops = [int(y) for y in re.findall(r'<rect x="\d+" y="(\d+)"', text)]
    assert tops == sorted(tops)
    assert len(set(tops)) == 4
    assert text.count("<path") == 4
    assert graph_picture({}) == ""


def test_report_of_a_graph_tells_how_to_reproduce_it(tmp_path: Path) -> None:
    graph = Graph()
    mesh = graph.add("vase_mesh", n_around=12)
    best = graph.add("minimize_angles", sphere_mesh=graph.add("fit_spheres", mesh=mesh))
    cut = graph.add("panels", sphere_mesh=best.sphere_mesh)
    report = graph.add(
        "panel_report", sphere_mesh=best.sphere_mesh, optimum=best.report, cut=cut.report
    )
    path = tmp_path / "report.html"
    step = graph.add(
        write_report, report=report, panels=cut.panels, sphere_mesh=best.sphere_mesh,
        path=str(path),
    )  # fmt: skip
    graph.run(step)
    words = read(path.read_text("utf-8")).words
    assert "spheremesh run graph.json" in words
    for name in json.loads(json.dumps([*graph.steps])):
        assert name in words
