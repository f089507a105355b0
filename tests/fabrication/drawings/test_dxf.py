"""Cutting drawings, read back by ezdxf."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from ezdxf.bbox import extents
from ezdxf.math import Vec2, bulge_radius, is_point_in_polygon_2d
from ezdxf.path import make_path

from spheremesh.fabrication.drawings.beams import SheetOptions, write_dxf
from spheremesh.fabrication.model import Model
from spheremesh.kernel.arrays import FloatArray, norm
from spheremesh.kernel.beams.beams import Beams, section_arcs
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.beams.drilling import drill_beams
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.spheres.arcs import arc_circles
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net, torus_net


@pytest.fixture(scope="module")
def beams() -> Beams:
    """Beams of a torus, in metres."""
    sphere_mesh = central_spheres(torus_net(16, 9, 3.0, 1.0))
    return cut_beams(annulus_support(sphere_mesh, depth=0.2).annuli, 0.04, 0.01)[0]


@pytest.fixture(scope="module")
def path(beams: Beams, tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("dxf") / "beams.dxf"
    file = write_dxf(Model(beams=beams), target)
    assert file.path == target
    assert file.notes == ()
    return target


@pytest.fixture(scope="module")
def drawing(path: Path) -> Any:  # noqa: ANN401
    return ezdxf.readfile(path)  # pyright: ignore


def rings(drawing: Any, layer: str) -> list[FloatArray]:  # noqa: ANN401
    found = drawing.modelspace().query(f'LWPOLYLINE[layer=="{layer}"]')
    assert all(ring.closed for ring in found)
    return [np.array(list(ring.get_points("xyb"))) for ring in found]


def test_the_drawing_is_sound(drawing: Any, beams: Beams) -> None:  # noqa: ANN401
    audit = drawing.audit()
    assert len(audit.errors) == 0
    assert len(audit.fixes) == 0
    assert drawing.units == ezdxf.units.MM  # pyright: ignore
    assert {"CUT", "ENGRAVE", "SHEET"} <= {layer.dxf.name for layer in drawing.layers}
    assert {entity.dxf.layer for entity in drawing.modelspace()} == {"CUT", "ENGRAVE", "SHEET"}
    assert len(rings(drawing, "CUT")) == beams.n_beams


def test_law_e6_contours_in_the_file_are_exact(drawing: Any, beams: Beams) -> None:  # noqa: ANN401
    outer, inner = section_arcs(beams)
    radii = [arc_circles(arcs).radii * 1000 for arcs in (outer, inner)]
    for i, ring in enumerate(rings(drawing, "CUT")):
        assert len(ring) == 4
        assert (ring[[1, 3], 2] == 0).all()
        points = ring[:, :2]
        lengths = norm(np.roll(points, -1, axis=0) - points)
        assert abs(lengths[0] - 1000 * norm(inner.ends[i] - inner.starts[i])) < 1e-9
        assert abs(lengths[2] - 1000 * norm(outer.ends[i] - outer.starts[i])) < 1e-9
        for end in (0, 1):
            side = 1000 * norm(beams.sections[i, end, 0] - beams.sections[i, end, 1])
            assert abs(lengths[3 if end == 0 else 1] - side) < 1e-9
        for corner, expected in ((0, radii[1][i]), (2, radii[0][i])):
            start, end = points[corner], points[(corner + 1) % 4]
            radius = bulge_radius(start, end, ring[corner, 2])
            assert abs(radius / expected - 1) < 1e-9
        # the outer arc bulges out of the counter-clockwise contour where it is a dome
        assert (ring[2, 2] > 0) == (beams.annuli.outer[i, 0] < 0)
        assert (ring[0, 2] < 0) == (beams.annuli.inner[i, 0] < 0)


def test_pieces_lie_apart_on_their_sheets(drawing: Any) -> None:  # noqa: ANN401
    sheets = rings(drawing, "SHEET")
    used = np.zeros(len(sheets), int)
    for ring in rings(drawing, "CUT"):
        inside = [
            (ring[:, :2] > sheet[0, :2]).all() and (ring[:, :2] < sheet[2, :2]).all()
            for sheet in sheets
        ]
        assert sum(inside) == 1
        used[int(np.argmax(inside))] += 1
    assert (used > 0).all()
    assert np.abs(sheets[0][2, :2] - sheets[0][0, :2] - [3000, 1500]).max() == 0


@pytest.mark.parametrize("depth", [0.05, 0.1, 0.3])
@pytest.mark.parametrize("size", [0.03, 1.0])
def test_labels_stay_on_bowed_beams_of_models_and_buildings(
    tmp_path: Path, depth: float, size: float
) -> None:
    found = central_spheres(torus_net(7, 5, 3.0 * size, size))
    bowed = cut_beams(annulus_support(found, depth * size).annuli, 0.02 * size, 0.03 * size)[0]
    drawing: Any = ezdxf.readfile(write_dxf(Model(beams=bowed), tmp_path / "b.dxf").path)  # pyright: ignore
    space = drawing.modelspace()
    texts = list(space.query("TEXT"))
    for i, ring in enumerate(space.query('LWPOLYLINE[layer=="CUT"]')):
        outline = list(make_path(ring).flattening(1e-3 * size))
        for text in texts[3 * i : 3 * i + 3]:
            turned = text.copy()
            turned.rotate_axis((0, 0, 1), -np.radians(text.dxf.rotation))
            box = extents([turned])
            for x in (box.extmin.x, box.extmax.x):
                for y in (box.extmin.y, box.extmax.y):
                    corner = Vec2(x, y).rotate_deg(text.dxf.rotation)
                    assert is_point_in_polygon_2d(corner, Vec2.list(outline)) == 1


def test_labels_name_the_beam_and_its_nodes(drawing: Any, beams: Beams) -> None:  # noqa: ANN401
    space = drawing.modelspace()
    texts = list(space.query('TEXT[layer=="ENGRAVE"]'))
    contours = list(space.query('LWPOLYLINE[layer=="CUT"]'))
    assert len(texts) == 3 * len(contours) == 3 * beams.n_beams
    for i, contour in enumerate(contours):
        first, name, last = texts[3 * i : 3 * i + 3]
        assert name.dxf.text == beams.annuli.ids[i]
        start, end = beams.annuli.edge_vertices[i]
        assert first.dxf.text.split(" ")[0] == f"N{start:04d}"
        assert last.dxf.text.split(" ")[0] == f"N{end:04d}"
        outline = Vec2.list(make_path(contour).flattening(1.0))
        for text in (first, name, last):
            place = Vec2(text.dxf.align_point)
            assert is_point_in_polygon_2d(place, outline) == 1
        length = max(p.x for p in outline) - min(p.x for p in outline)
        assert sum(t.dxf.height * len(t.dxf.text) for t in (first, name, last)) < 1.2 * length


def test_the_same_beams_give_the_same_bytes(beams: Beams, path: Path, tmp_path: Path) -> None:
    again = write_dxf(Model(beams=beams), tmp_path / "again.dxf").path
    assert again.read_bytes() == path.read_bytes()


def test_units_of_the_model(beams: Beams, tmp_path: Path) -> None:
    few = select_parts(beams, np.arange(beams.n_beams) < 3)
    for units, factor in (("mm", 1.0), ("ft", 304.8)):
        file = write_dxf(Model(beams=few, units=units), tmp_path / "u.dxf")
        ring = rings(ezdxf.readfile(file.path), "CUT")[0]  # pyright: ignore
        outer, _ = section_arcs(few)
        length = norm(ring[3, :2] - ring[2, :2])
        assert abs(length - factor * norm(outer.ends[0] - outer.starts[0])) < 2e-9


def test_pieces_larger_than_a_sheet_get_their_own(beams: Beams, tmp_path: Path) -> None:
    file = write_dxf(
        Model(beams=beams), tmp_path / "small.dxf", SheetOptions(size=(1300.0, 900.0))
    )
    drawing = ezdxf.readfile(file.path)  # pyright: ignore
    note = re.match(r"(\d+) beams are larger than the sheet: ", file.notes[0])
    assert note
    n_oversize = int(note[1])
    assert 0 < n_oversize < beams.n_beams
    assert len(rings(drawing, "CUT")) == beams.n_beams
    assert len(rings(drawing, "SHEET")) == file.counts["sheets"] > n_oversize
    assert len(drawing.audit().errors) == 0


def test_straight_beams_have_no_arcs(tmp_path: Path) -> None:
    planes = face_planes(ellipsoid_net(12, 5, 2.0, 3.0, 1.0))
    straight, _ = cut_beams(annulus_support(planes, depth=0.1).annuli, 0.02)
    file = write_dxf(Model(beams=straight), tmp_path / "straight.dxf")
    for ring in rings(ezdxf.readfile(file.path), "CUT"):  # pyright: ignore
        assert (ring[:, 2] == 0).all()


def test_what_cannot_be_written(beams: Beams, tmp_path: Path) -> None:
    target = tmp_path / "b.dxf"
    with pytest.raises(InputError, match="no beams"):
        write_dxf(Model(beams=select_parts(beams, np.zeros(beams.n_beams, bool))), target)
    with pytest.raises(InputError, match="unknown units 'km'"):
        write_dxf(Model(beams=beams, units="km"), target)
    with pytest.raises(InputError, match="must be lengths"):
        write_dxf(Model(beams=beams), target, SheetOptions(size=(0.0, 100.0)))
    with pytest.raises(InputError, match="must be lengths"):
        write_dxf(Model(beams=beams), target, SheetOptions(spacing=float("nan")))
    with pytest.raises(InputError, match=r"end the name in \.dxf"):
        write_dxf(Model(beams=beams), tmp_path / "b.dwg")
    with pytest.raises(InputError, match="no folder"):
        write_dxf(Model(beams=beams), tmp_path / "none" / "b.dxf")
    assert not list(tmp_path.iterdir())


def test_the_file_says_how_far_it_reaches(drawing: Any) -> None:  # noqa: ANN401
    box = extents(drawing.modelspace(), fast=True)
    for name, corner in (("$EXTMIN", box.extmin), ("$EXTMAX", box.extmax)):
        np.testing.assert_allclose(list(drawing.header[name])[:2], list(corner)[:2])
    np.testing.assert_allclose(list(drawing.modelspace().dxf.extmax), drawing.header["$EXTMAX"])


@pytest.mark.parametrize(("units", "factor"), [("m", 1000.0), ("ft", 304.8)])
def test_law_e6_drilling_marks_in_the_file(
    beams: Beams, tmp_path: Path, units: str, factor: float
) -> None:
    """Circles lie in their own contour, at the inset from the side of its end."""
    drilled, refused = drill_beams(beams, 2, 0.03, 0.3)
    assert 0 < len(refused) < beams.n_beams
    drawing = ezdxf.readfile(
        write_dxf(Model(beams=drilled, units=units), tmp_path / "d.dxf").path
    )  # pyright: ignore
    assert len(drawing.audit().errors) == 0
    circles = drawing.modelspace().query('CIRCLE[layer=="DRILL"]')
    assert drilled.marks is not None
    fits = np.flatnonzero(drilled.marks.fits)
    assert len(circles) == len(drawing.modelspace().query("CIRCLE")) == 4 * len(fits)
    np.testing.assert_allclose([c.dxf.radius for c in circles], 0.015 * factor)
    contours = list(drawing.modelspace().query('LWPOLYLINE[layer=="CUT"]'))
    centers = np.array([list(c.dxf.center)[:2] for c in circles]).reshape(-1, 2, 2, 2)
    for i, pairs in zip(fits.tolist(), centers, strict=True):
        outline = Vec2.list(make_path(contours[i]).flattening(0.1))
        corners = np.array(list(contours[i].get_points("xy")))
        # Inner start, inner end, outer end, outer start.
        for pair, (a, b) in zip(pairs, (corners[[0, 3]], corners[[1, 2]]), strict=True):
            assert all(is_point_in_polygon_2d(Vec2(p), outline) == 1 for p in pair)
            along = (b - a) / norm(b - a)
            across = np.abs((pair - a) @ [-along[1], along[0]])
            assert np.ptp(across) < 1e-8 * factor
            # The cut leans: the contour is its section in the middle.
            assert 0.3 * factor - 1e-6 < across[0] < 0.35 * factor


def test_bad_beams_are_named(beams: Beams, tmp_path: Path) -> None:
    sections = beams.sections.copy()
    sections[4] = np.nan
    with pytest.raises(InputError, match=r"beam B0004 \(1 in all\) is not finite"):
        write_dxf(Model(beams=replace(beams, sections=sections)), tmp_path / "n.dxf")
    twice = replace(beams, annuli=replace(beams.annuli, ids=("B",) * beams.n_beams))
    with pytest.raises(InputError, match=r"beams are called 'B' \(edges \[0, 1,"):
        write_dxf(Model(beams=twice), tmp_path / "n.dxf")
    assert not list(tmp_path.iterdir())
