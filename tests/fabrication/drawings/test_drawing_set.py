"""Sets of drawings: read back as PDF, DXF and SVG; nothing overlaps or is cut off."""

import re
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from math import atan, cos, hypot, pi, sin
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import ezdxf
import numpy as np
import pytest
from ezdxf.bbox import extents

from spheremesh.fabrication.drawings.drawing import Drawing
from spheremesh.fabrication.drawings.drawing_set import (
    DrawingOptions,
    drawing_pages,
    write_drawings,
)
from spheremesh.fabrication.drawings.pages import MARGIN, PAPERS, Page, usual_scale
from spheremesh.fabrication.drawings.pdf import bezier_arcs
from spheremesh.fabrication.model import Model
from spheremesh.kernel.beams.beams import Beams
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.beams.drilling import drill_beams
from spheremesh.kernel.errors import InputError, MissingLibraryError
from spheremesh.kernel.panels.panels import Panels
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import roof_net, vase_net


@pytest.fixture(scope="module")
def panels(moulded: Callable[..., Panels]) -> Panels:
    return moulded(face_planes(vase_net(10, 4, 1.0, 2.0, 0.3)), 0.02, 0.005)


@pytest.fixture(scope="module")
def roof(moulded: Callable[..., Panels]) -> Panels:
    return moulded(fit_spheres(roof_net(12, 18, 40.0)), 0.02, 0.005)


@pytest.fixture(scope="module")
def beams() -> Beams:
    vase = central_spheres(vase_net(10, 4, 1.0, 2.0, 0.3))
    annuli = annulus_support(vase, depth=0.1).annuli
    return drill_beams(cut_beams(annuli, 0.02, 0.005)[0], 2, 0.01, 0.05)[0]


FIXED = DrawingOptions(project="Vase", revision="B", date="2030-01-02")


def test_a_set_has_every_part_and_says_where(panels: Panels, beams: Beams) -> None:
    pages = drawing_pages(Model(panels, beams), FIXED)
    titles = [page.title.partition(",")[0] for page in pages]
    assert {"Mould 01", "Mould 02", "Mould 03", "Beams"} <= set(titles)
    assert titles[0].startswith(("Plan", "Elevation"))
    words = [{text.text for text in page.drawing.texts} for page in pages]
    for number, (page, found) in enumerate(zip(pages, words, strict=True), 1):
        assert {"Vase", "B", "2030-01-02", f"{number} / {len(pages)}", page.title} <= found
        assert {"project", "drawing", "scale", "revision", "date", "page"} <= found
    plans = set().union(*(w for t, w in zip(titles, words, strict=True) if "Mould" not in t))
    assert set(panels.ids) <= plans
    nodes = {f"N{vertex:04d}" for vertex in beams.annuli.edge_vertices.ravel().tolist()}
    assert {*beams.ids, *nodes} <= plans
    sheets = [w for t, w in zip(titles, words, strict=True) if "Mould" in t]
    for name in panels.ids:
        assert sum(name in found for found in sheets) >= 1


def test_no_text_leaves_the_frame(panels: Panels, roof: Panels, beams: Beams) -> None:
    long = replace(roof, ids=tuple(f"Dach-Süd-{name}-屋根" for name in roof.ids))
    for paper in ("A4", "A2"):
        options = replace(FIXED, paper=paper, project="Haus der Kulturen " * 4)
        for model in (Model(panels, beams), Model(long)):
            for page in drawing_pages(model, options):
                check_inside(page, PAPERS[paper])


def check_inside(page: Page, size: tuple[float, float]) -> None:
    drawing = page.drawing
    for text in drawing.texts:
        wide = sum(ord(letter) > 0x2E80 for letter in text.text)
        width = 0.72 * text.height * (len(text.text) + wide)
        share = {"left": (0, 1), "right": (-1, 0)}.get(text.align, (-0.5, 0.5))
        for s in share:
            x = text.x + s * width * cos(text.turn * pi / 180)
            y = text.y + s * width * sin(text.turn * pi / 180)
            assert MARGIN - 0.5 <= x <= size[0] - MARGIN + 0.5, text
            assert MARGIN - 0.5 <= y <= size[1] - MARGIN + 0.5, text
    for line in drawing.lines:
        points = np.array(line.points)[:, :2]
        assert (points >= MARGIN - 1e-6).all()
        assert (points <= np.array(size) - MARGIN + 1e-6).all()


def test_texts_of_a_panel_do_not_overlap(roof: Panels) -> None:
    for page in drawing_pages(Model(roof), FIXED):
        if not page.title.startswith("Mould"):
            continue
        boxes = np.array([text_box(page.drawing, i) for i in range(len(page.drawing.texts))])
        low, high = boxes[:, None, :2], boxes[:, None, 2:]
        meet = (low < boxes[:, 2:]).all(-1) & (high > boxes[:, :2]).all(-1)
        np.fill_diagonal(meet, val=False)
        pairs = np.argwhere(np.triu(meet)).tolist()
        texts = page.drawing.texts
        assert not [(texts[i].text, texts[j].text) for i, j in pairs]


def text_box(drawing: Drawing, i: int) -> tuple[float, float, float, float]:
    """The box of a text that lies along or across the page, as Helvetica has it."""
    text = drawing.texts[i]
    width, height = 0.72 * text.height * len(text.text), text.height
    along = {"left": (0.0, 1.0), "right": (-1.0, 0.0)}.get(text.align, (-0.5, 0.5))
    up = (-0.5, 0.5) if text.align == "middle" else (0.0, 1.0)
    c, s = abs(cos(text.turn * pi / 180)), abs(sin(text.turn * pi / 180))
    if text.turn == 0:
        return (
            text.x + along[0] * width, text.y + up[0] * height,
            text.x + along[1] * width, text.y + up[1] * height,
        )  # fmt: skip
    # Turned texts are in the middle of their points; a box across would claim too much.
    reach = (width * c + height * s) / 2 * 0.8, (width * s + height * c) / 2 * 0.8
    return text.x - reach[0], text.y - reach[1], text.x + reach[0], text.y + reach[1]


def test_dxf_is_sound_and_in_true_size(panels: Panels, beams: Beams, tmp_path: Path) -> None:
    document: Any = ezdxf.readfile(  # pyright: ignore
        write_drawings(Model(panels, beams), tmp_path / "d.dxf", FIXED).path
    )
    audit = document.audit()
    assert not audit.errors
    assert not audit.fixes
    space = document.modelspace()
    box = extents(space, fast=True)
    np.testing.assert_allclose(list(document.header["$EXTMIN"]), list(box.extmin), atol=1e-3)
    first = np.array(list(space.query("LWPOLYLINE[layer=='CUT']")[0].get_points("xy")))
    chords = np.hypot(*(np.roll(first, -1, axis=0) - first).T)
    widths = [
        w.dxf.text for w in space.query("TEXT[layer=='DIMENSION']") if "chord" in w.dxf.text
    ]
    assert f"{chords[2]:.1f}" in re.findall(r"chord ([\d.]+)", widths[0])
    assert any(
        point[2] for ring in space.query("LWPOLYLINE") for point in ring.get_points("xyb")
    )


def test_pdf_has_its_pages_and_svg_all(panels: Panels, tmp_path: Path) -> None:
    pytest.importorskip("reportlab")
    written = write_drawings(Model(panels), tmp_path / "d.pdf", FIXED)
    data = written.path.read_bytes()
    assert data.startswith(b"%PDF-")
    assert len(re.findall(rb"/Type /Page\b", data)) == written.counts["pages"]
    width, height = PAPERS["A3"]
    sizes = {
        tuple(float(word) * 25.4 / 72 for word in found.split())
        for found in re.findall(rb"/MediaBox \[ 0 0 ([\d. ]+) \]", data)
    }
    np.testing.assert_allclose([*sizes], [(width, height)], atol=1e-3)
    root = ElementTree.parse(  # noqa: S314
        write_drawings(Model(panels), tmp_path / "d.svg", FIXED).path
    ).getroot()
    texts = {node.text for node in root.iter("{http://www.w3.org/2000/svg}text")}
    assert set(panels.ids) <= texts


def test_the_same_set_has_the_same_bytes_at_the_same_date(
    panels: Panels, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("reportlab")
    few = select_parts(panels, np.arange(panels.n_panels) < 5)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1000000000")
    for suffix in ("pdf", "dxf", "svg"):
        first, second = (
            write_drawings(Model(few), tmp_path / f"{name}.{suffix}").path for name in "ab"
        )
        assert first.read_bytes() == second.read_bytes()
    assert "2001-09-09" in second.read_text("utf-8")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "soon")
    with pytest.raises(InputError, match="SOURCE_DATE_EPOCH is 'soon'"):
        write_drawings(Model(few), tmp_path / "c.svg")


def test_names_of_all_scripts_stand_in_pdf(panels: Panels, tmp_path: Path) -> None:
    pytest.importorskip("reportlab")
    few = select_parts(panels, np.arange(panels.n_panels) < 3)
    named = replace(few, ids=("屋根-1", "Крыша", "Dach-Süd"))
    data = write_drawings(Model(named), tmp_path / "d.pdf", FIXED).path.read_bytes()
    assert b"HeiseiKakuGo-W5" in data


@pytest.mark.parametrize("bulge", [0.02, -0.3, 1.0, 2.5, -0.9])
def test_curves_of_pdf_follow_their_arcs(bulge: float) -> None:
    start, end = (1.0, 2.0), (4.0, -1.0)
    points = [start]
    for ax, ay, bx, by, x, y in bezier_arcs(*start, *end, bulge):
        sx, sy = points[-1]
        for t in np.linspace(0, 1, 9)[1:]:
            u = 1 - t
            weights = u**3, 3 * u**2 * t, 3 * u * t**2, t**3
            points.append(
                (
                    float(np.dot(weights, (sx, ax, bx, x))),
                    float(np.dot(weights, (sy, ay, by, y))),
                )
            )
    assert points[-1] == pytest.approx(end)
    chord = hypot(end[0] - start[0], end[1] - start[1])
    length = sum(hypot(b[0] - a[0], b[1] - a[1]) for a, b in pairwise(points))
    sweep = 4 * atan(abs(bulge))
    radius = chord / 2 / sin(sweep / 2)
    assert length == pytest.approx(radius * sweep, rel=5e-3)
    # A positive bulge lies to the right of its chord.
    middle = points[len(points) // 2]
    side = (end[0] - start[0]) * (middle[1] - start[1]) - (end[1] - start[1]) * (
        middle[0] - start[0]
    )
    assert (side < 0) == (bulge > 0)


def test_scales_are_usual() -> None:
    assert [usual_scale(each) for each in (0.9, 1.0, 7.0, 11, 49)] == [1, 1, 7.5, 12.5, 50]


def test_what_cannot_be_drawn(
    panels: Panels, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(InputError, match="no panels or beams"):
        write_drawings(Model(), tmp_path / "d.pdf")
    with pytest.raises(InputError, match=r"end the name in \.pdf or \.dxf or \.svg"):
        write_drawings(Model(panels), tmp_path / "d.dwg")
    with pytest.raises(InputError, match="unknown paper 'B5'"):
        write_drawings(Model(panels), tmp_path / "d.pdf", replace(FIXED, paper="B5"))
    with pytest.raises(InputError, match="unknown material"):
        write_drawings(
            Model(panels), tmp_path / "d.pdf", replace(FIXED, panel_material="jelly")
        )
    monkeypatch.setitem(__import__("sys").modules, "reportlab.pdfgen", None)
    with pytest.raises(MissingLibraryError, match=r"install spheremesh\[drawings\]"):
        write_drawings(Model(panels), tmp_path / "d.pdf", FIXED)
    assert not list(tmp_path.iterdir())
