"""Nesting: nothing overlaps, and few sheets are needed."""

import sys
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from ezdxf.path import make_path
from hypothesis import given, settings
from hypothesis import strategies as st

from spheremesh.fabrication.drawings.beams import SheetOptions, write_dxf
from spheremesh.fabrication.drawings.nesting import Nesting, Stock, nest_rectangles
from spheremesh.fabrication.drawings.stock_sheets import blank_sizes, nest_model
from spheremesh.fabrication.model import Model
from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.beams.beams import Beams
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.errors import InputError, MissingLibraryError
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.facts import packing_sizes
from spheremesh.kernel.panels.panels import scale_panels
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import roof_net, torus_net

rectpack = pytest.importorskip("rectpack")
shapely = pytest.importorskip("shapely")
box, Polygon = shapely.box, shapely.Polygon


@pytest.fixture(scope="module")
def beams() -> Beams:
    annuli = annulus_support(central_spheres(torus_net(16, 9, 3.0, 1.0)), depth=0.2).annuli
    return cut_beams(annuli, 0.04, 0.01)[0]


def roof_beams() -> FloatArray:
    """Sizes of 300 pieces, as of the beams of a roof: long, and of one width."""
    generator = np.random.default_rng(4)
    lengths = np.sort(generator.normal(1300, 150, 300))
    return np.stack([lengths, 250 + 0.01 * lengths + generator.uniform(0, 3, 300)], 1)


def check_nesting(sizes: FloatArray, stock: Stock, found: Nesting) -> None:
    lying = np.where(found.is_turned[:, None], sizes[:, ::-1], sizes)
    assert stock.grain == "any" or not found.is_turned.any()
    fits = np.ones(len(sizes), bool)
    fits[found.oversize] = False
    assert (found.places[fits] >= stock.margin - 1e-9).all()
    reach = found.places[fits] + lying[fits]
    assert (reach <= np.array(stock.size) - stock.margin + 1e-6).all()
    for sheet in np.unique(found.sheets).tolist():
        here = np.flatnonzero(found.sheets == sheet)
        low, high = found.places[here], found.places[here] + lying[here]
        gap = np.maximum(low[:, None] - high, low - high[:, None]).max(-1)
        np.fill_diagonal(gap, np.inf)
        assert gap.min() >= stock.kerf - 1e-6


@given(
    st.lists(st.tuples(st.floats(20, 900), st.floats(20, 400)), min_size=1, max_size=25),
    st.sampled_from(["along", "any"]),
    st.floats(0, 12),
    st.floats(0, 40),
)
@settings(max_examples=15, deadline=None)
def test_law_pieces_keep_apart_and_off_the_rim(
    sizes: list[tuple[float, float]], grain: str, kerf: float, margin: float
) -> None:
    rectangles = np.array(sizes)
    stock = Stock((800.0, 600.0), kerf, margin, grain)  # pyright: ignore
    found = nest_rectangles(rectangles, stock)
    check_nesting(rectangles, stock, found)
    assert found.count >= found.bound
    assert 0 <= found.waste < 1 or not found.count
    room = np.array(stock.size) - 2 * margin
    large = ~(rectangles <= room).all(1)
    if grain == "any":
        large &= ~(rectangles[:, ::-1] <= room).all(1)
    assert found.oversize == np.flatnonzero(large).tolist()


@pytest.mark.parametrize("grain", ["along", "any"])
def test_300_beams_need_hardly_more_sheets_than_any_way_of_rectpack(grain: str) -> None:
    sizes, stock = roof_beams(), Stock(grain=grain)  # pyright: ignore
    found = nest_rectangles(sizes, stock)
    check_nesting(sizes, stock, found)
    least = found.count
    for rule in ("MaxRectsBl", "GuillotineBssfMaxas"):
        packer = rectpack.newPacker(
            pack_algo=getattr(rectpack, rule), rotation=grain == "any"
        )  # fmt: skip
        for i, (width, height) in enumerate(np.ceil(sizes + stock.kerf).astype(int).tolist()):
            packer.add_rect(width, height, i)
        packer.add_bin(2984, 1484, count=float("inf"))
        packer.pack()
        least = min(least, len(packer))
    assert found.count <= 1.05 * least


def test_nested_beams_do_not_overlap_in_the_file(beams: Beams, tmp_path: Path) -> None:
    options = SheetOptions(
        size=(2000.0, 1800.0), spacing=5.0, margin=12.0, nesting="rectangles", grain="any"
    )
    file = write_dxf(Model(beams=beams), tmp_path / "nested.dxf", options)
    rows = write_dxf(Model(beams=beams), tmp_path / "rows.dxf", SheetOptions((2000.0, 1800.0)))
    assert file.counts["sheets"] <= rows.counts["sheets"]
    document = ezdxf.readfile(file.path)
    assert not document.audit().errors
    space = document.modelspace()
    pieces = [
        Polygon([(p.x, p.y) for p in make_path(ring).flattening(0.01)])
        for ring in space.query("LWPOLYLINE[layer=='CUT']")
    ]
    sheets = [
        box(*(np.array(list(ring.get_points("xy")))[[0, 2]].ravel().tolist()))
        for ring in space.query("LWPOLYLINE[layer=='SHEET']")
    ]
    assert len(pieces) == beams.n_beams
    first, second = shapely.STRtree(pieces).query(pieces, predicate="dwithin", distance=4.9)
    assert (first == second).all()
    for piece in pieces:
        assert sum(sheet.buffer(-11.9).contains(piece) for sheet in sheets) == 1
    # Names lie on their pieces.
    for i, text in enumerate(space.query("TEXT[layer=='ENGRAVE']")):
        place = text.dxf.align_point
        assert (
            pieces[i // 3]
            .buffer(1e-6)
            .contains(box(place.x, place.y, place.x, place.y).centroid)
        )


def test_blanks_of_panels_are_longer_than_panels_where_these_bulge() -> None:
    flat = cut_panels(face_planes(roof_net(4, 5, 20.0)), thickness=0.02)[0]
    np.testing.assert_allclose(blank_sizes(flat), packing_sizes(flat)[:, :2])
    round_ = scale_panels(cut_panels(central_spheres(torus_net(8, 6, 3.0, 1.0)))[0], 1000.0)
    assert (blank_sizes(round_) > 1.0005 * packing_sizes(round_)[:, :2]).all()
    found, rows = nest_model(Model(round_, units="mm"), Stock())
    assert [row["id"] for row in rows] == list(round_.ids)
    assert max(row["sheet"] for row in rows) == found.count + len(found.oversize)


def test_what_cannot_be_nested(beams: Beams, monkeypatch: pytest.MonkeyPatch) -> None:
    sizes = np.full((2, 2), 100.0)
    for stock in (
        Stock((0.0, 10.0)),
        Stock(kerf=-1.0),
        Stock(margin=800.0),
        Stock(kerf=np.nan),
    ):
        with pytest.raises(InputError, match="must be lengths"):
            nest_rectangles(sizes, stock)
    made = cut_panels(face_planes(roof_net(4, 5, 20.0)))[0]
    with pytest.raises(InputError, match="nest one of both"):
        nest_model(Model(made, beams), Stock())
    with pytest.raises(InputError, match="no beams to write"):
        nest_model(Model(), Stock())
    monkeypatch.setitem(sys.modules, "rectpack", None)
    with pytest.raises(MissingLibraryError, match=r"install spheremesh\[drawings\]"):
        nest_rectangles(sizes, Stock())
