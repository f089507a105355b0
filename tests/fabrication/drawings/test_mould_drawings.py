"""Drawings of moulds: read back by ezdxf and by an XML parser."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import ImageFont

from spheremesh import Mesh
from spheremesh.fabrication.drawings.moulds import layout_moulds, write_mould_drawings
from spheremesh.fabrication.drawings.outlines import CLOSE_MM, axis_frames
from spheremesh.fabrication.model import Model
from spheremesh.kernel.arrays import norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.mould_blanks import panel_caps
from spheremesh.kernel.panels.panels import Panels, panel_arcs, scale_panels
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.spheres.arcs import arc_points
from spheremesh.kernel.surfaces.circular_nets import vase_net


@pytest.fixture(scope="module")
def panels(moulded: Callable[..., Panels]) -> Panels:
    return moulded(face_planes(vase_net(12, 6, 1.0, 2.0, 0.3)), 0.02, 0.005)


def test_dxf_is_sound_and_complete(panels: Panels, tmp_path: Path) -> None:
    import ezdxf

    path = write_mould_drawings(Model(panels), tmp_path / "moulds.dxf").path
    document = ezdxf.readfile(path)
    assert not document.audit().errors
    assert document.units == 4
    model = document.modelspace()
    for layer in ("OUTER", "INNER"):
        outlines = model.query(f"LWPOLYLINE[layer=='{layer}']")
        assert len(outlines) == panels.n_panels
        assert all(outline.closed for outline in outlines)
    diameters = 2000 * panel_caps(panels).radii
    radii = sorted(circle.dxf.radius for circle in model.query("CIRCLE"))
    expected = [diameters[panels.labels == label].max() / 2 for label in panels.labels]
    np.testing.assert_allclose(radii, sorted(expected), rtol=1e-9)
    texts = [text.dxf.text for text in model.query("TEXT")]
    assert set(panels.ids) <= set(texts)
    titles = [text for text in texts if text.startswith("Mould")]
    assert [title[:8] for title in titles] == ["Mould 01", "Mould 02", "Mould 03"]
    assert all("radius" in title and "blank" in title for title in titles)


def test_svg_is_sound_and_complete(panels: Panels, tmp_path: Path) -> None:
    path = write_mould_drawings(Model(panels), tmp_path / "moulds.svg").path
    root = ElementTree.parse(path).getroot()  # noqa: S314
    name = "{http://www.w3.org/2000/svg}"
    groups = {group.get("id"): group for group in root.findall(f"{name}g")}
    assert len(groups["OUTER"].findall(f"{name}path")) == panels.n_panels
    assert len(groups["INNER"].findall(f"{name}path")) == panels.n_panels
    assert len(groups["BLANK"].findall(f"{name}circle")) == panels.n_panels
    texts = {text.text for text in groups["TEXT"].findall(f"{name}text")}
    assert set(panels.ids) <= texts
    _, _, width, height = map(float, (root.get("viewBox") or "").split())
    for circle in groups["BLANK"].findall(f"{name}circle"):
        x, y, r = (float(circle.get(key) or "nan") for key in ("cx", "cy", "r"))
        assert r <= x <= width - r
        assert r <= y <= height - r


def test_outlines_lie_in_their_rims_and_rims_apart(panels: Panels) -> None:
    drawing = layout_moulds(panels)
    rims = np.array([circle[1:] for circle in drawing.circles])
    outer, inner = (
        [np.array(line.points)[:, :2] for line in drawing.lines if line.layer == layer]
        for layer in ("OUTER", "INNER")
    )
    assert len(outer) == len(inner) == len(rims)
    # Walls lean by the tilt of the surface against the axis: the inner face shifts a little.
    for outlines, slack in ((outer, 1.0 + 1e-6), (inner, 1.05)):
        for points, (x, y, radius) in zip(outlines, rims, strict=True):
            assert norm(points - [x, y]).max() <= slack * radius
    apart = norm(rims[:, None, :2] - rims[:, :2]) - (rims[:, None, 2] + rims[:, 2])
    assert apart[~np.eye(len(rims), dtype=bool)].min() > 0
    assert min(text.height for text in drawing.texts) > 0


def test_outlines_are_arcs_as_close_as_anybody_cuts(panels: Panels, tmp_path: Path) -> None:
    """Points of the edges in space, seen along the axis of the blank, lie on the arcs."""
    import ezdxf
    from ezdxf.path import make_path

    made = scale_panels(panels, 1000.0)
    caps, arcs = panel_caps(made), panel_arcs(made)
    owners = made.corner_panels
    frames = axis_frames(made, caps.axes)[owners]
    relative = arc_points(arcs, np.linspace(-1, 1, 41)) - caps.centers[owners][:, None]
    expected = np.einsum("hij,hnj->hni", frames, relative)
    document = ezdxf.readfile(write_mould_drawings(Model(panels), tmp_path / "m.dxf").path)
    space = document.modelspace()
    rims, names = list(space.query("CIRCLE")), list(space.query("TEXT"))
    labels = [text.dxf.text for text in names if text.dxf.text in panels.ids]
    rings = list(space.query("LWPOLYLINE[layer=='OUTER']"))
    assert max(map(len, rings)) <= 16
    for name, rim, ring in zip(labels, rims, rings, strict=True):
        points = expected[owners == panels.ids.index(name)].reshape(-1, 2)
        outline = np.array([list(p)[:2] for p in make_path(ring).flattening(1e-4, 64)])
        outline = outline - list(rim.dxf.center)[:2]
        starts, steps = outline[:-1], np.diff(outline, axis=0)
        share = ((points[:, None] - starts) * steps).sum(-1) / (steps**2).sum(-1)
        nearest = starts + np.clip(share, 0, 1)[..., None] * steps
        assert norm(points[:, None] - nearest).min(1).max() < 1.1 * CLOSE_MM
    assert not document.audit().errors
    np.testing.assert_allclose(list(space.dxf.extmin), list(document.header["$EXTMIN"]))


def test_flat_panels_are_drawn_in_true_size() -> None:
    corners = np.array([[0, 0, 0], [0, 2, 0], [0, 2, 1], [0, 0, 1.0]])
    panels, _ = cut_panels(face_planes(Mesh(corners, [[0, 1, 2, 3]])))
    drawing = layout_moulds(panels, "m")
    ((layer, ring, is_closed),) = drawing.lines
    assert layer == "OUTER"
    assert is_closed
    points = np.array(ring)[:, :2]
    assert not np.array(ring)[:, 2].any()
    sides = norm(np.roll(points, -1, axis=0) - points)
    np.testing.assert_allclose(sides, [2000, 1000, 2000, 1000], rtol=1e-12)
    x, y = points.T
    area = (x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
    assert area == pytest.approx(2e6, rel=1e-12)  # counter-clockwise: seen from outside
    texts = [text.text for text in drawing.texts]
    assert texts[0] == "Without mould: 1 panel, largest blank 2236.1 x 0.0 mm"
    assert texts[1:] == ["P0000", "2236.1 x 0.0 flat"]


def test_no_text_runs_out_of_the_drawing(panels: Panels) -> None:
    """A mould with one panel has a title that is wider than its blank."""
    one = select_parts(panels, np.arange(panels.n_panels) == 0)
    for name in ("P0000", "屋根の板" * 20, "Dachplatte-" * 30):
        drawing = layout_moulds(replace(one, ids=(name,)))
        assert len(drawing.texts) == 3
        for label in drawing.texts:
            # Capitals of a sans-serif font are 0.7 em high, and letters of East Asia 1 em wide.
            em = label.height / 0.7
            font = ImageFont.load_default(100.0)
            latin = em * font.getlength(label.text.replace("屋根の板", "")) / 100.0
            length = latin + em * 4 * label.text.count("屋根の板")
            start = label.x - (length / 2 if label.align == "center" else 0)
            assert start >= 0
            assert start + length <= drawing.high[0]


def test_the_same_drawing_has_the_same_bytes(panels: Panels, tmp_path: Path) -> None:
    for suffix in ("dxf", "svg"):
        first = write_mould_drawings(Model(panels), tmp_path / f"a.{suffix}").path
        second = write_mould_drawings(Model(panels), tmp_path / f"b.{suffix}").path
        assert first.read_bytes() == second.read_bytes()


def test_what_cannot_be_drawn(panels: Panels, tmp_path: Path) -> None:
    none = select_parts(panels, np.zeros(panels.n_panels, bool))
    with pytest.raises(InputError, match="no panels to write"):
        write_mould_drawings(Model(none), tmp_path / "m.dxf")
    with pytest.raises(InputError, match=r"end the name in \.dxf or \.svg"):
        write_mould_drawings(Model(panels), tmp_path / "m.pdf")
    assert not list(tmp_path.iterdir())
