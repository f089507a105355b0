"""As a fabricator works: parts rebuilt from drawings and tables alone are those of STEP."""

from pathlib import Path
from typing import Any

import cadquery as cq
import ezdxf
import numpy as np
import pytest
from OCP.BRepExtrema import BRepExtrema_DistShapeShape

from spheremesh.fabrication.drawings.drawing_set import write_drawings
from spheremesh.fabrication.model import Model
from spheremesh.fabrication.schedules.record_files import write_tables
from spheremesh.fabrication.step.writer import write_step
from spheremesh.kernel.arrays import FloatArray, norm, unit
from spheremesh.nodes import (
    axis_support,
    beams,
    fit_spheres,
    minimize_angles,
    panels,
    roof_mesh,
)

pd = pytest.importorskip("pandas")

CLOSE_MM = 0.01


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What a fabricator is given: tables, drawings in true size, and STEP to compare with."""
    spheres = minimize_angles(fit_spheres(roof_mesh(n_span=5, n_length=6))).sphere_mesh
    support = axis_support(spheres, depth=0.25)
    cut = panels(spheres, edges="axis", axes=support.axes, thickness=0.03, joint_gap=0.01)
    frame = beams(support.annuli, thickness=0.04, panels=cut.panels)
    model = Model(cut.panels, frame.beams, "m")
    given = tmp_path_factory.mktemp("given")
    for name in ("panels", "panel_edges", "beams", "beam_ends"):
        write_tables(model, given / f"{name}.csv")
    write_drawings(Model(beams=frame.beams), given / "beams.dxf")
    write_step(Model(cut.panels), given / "panels.step")
    write_step(Model(beams=frame.beams), given / "beams.step")
    return given


def points(row: Any, *names: str) -> FloatArray:  # noqa: ANN401
    return np.array([[row[f"{name}_{axis}_mm"] for axis in "xyz"] for name in names])


def half_space(point: FloatArray, inward: FloatArray, size: float) -> cq.Workplane:
    """A block on the inner side of a plane."""
    plane = cq.Plane(tuple(point.tolist()), normal=tuple(inward.tolist()))
    return cq.Workplane(plane).rect(size, size).extrude(size)


def apart(built: cq.Shape, expected: cq.Shape) -> float:
    """Greatest distance of vertices and middles of edges and faces of each from the other."""
    farthest = 0.0
    for one, other in ((built, expected), (expected, built)):
        marks = [v.Center() for v in one.Vertices()]
        marks += [e.positionAt(0.5) for e in one.Edges()]
        for mark in marks:
            vertex = cq.Vertex.makeVertex(*mark.toTuple())
            shells = cq.Compound.makeCompound(other.Faces())
            found = BRepExtrema_DistShapeShape(vertex.wrapped, shells.wrapped)
            farthest = max(farthest, found.Value())
    return farthest


@pytest.mark.parametrize("row", [0, 17])
def test_a_panel_is_rebuilt_from_its_rows(folder: Path, row: int) -> None:
    panel = pd.read_csv(folder / "panels.csv").iloc[row]
    edges = pd.read_csv(folder / "panel_edges.csv").query("panel == @panel.id")
    center = cq.Vector(panel.center_x_mm, panel.center_y_mm, panel.center_z_mm)
    radii = sorted((panel.inner_radius_mm, panel.outer_radius_mm))
    small, large = (
        cq.Solid.makeSphere(r, angleDegrees1=-90).moved(cq.Location(center)) for r in radii
    )
    corners = np.concatenate([points(edge, "outer") for _, edge in edges.iterrows()])
    size = 4 * norm(corners - corners.mean(axis=0)).max()
    solid = cq.Workplane(cq.Solid.makeBox(size, size, size)).translate(
        tuple((corners.mean(axis=0) - size / 2).tolist())
    )
    for _, edge in edges.iterrows():
        wall = edge[["wall_x", "wall_y", "wall_z"]].to_numpy(float)
        solid = solid.intersect(half_space(points(edge, "outer")[0], wall, 2 * size))
    built = solid.intersect(cq.Workplane(large)).cut(cq.Workplane(small)).val()
    expected = cq.importers.importStep(str(folder / "panels.step")).solids().vals()[row]
    assert built.Volume() == pytest.approx(1e9 * panel.volume_m3, rel=1e-5)
    assert abs(built.Volume() - expected.Volume()) < CLOSE_MM * expected.Area()
    assert apart(built, expected) < CLOSE_MM


def drawn_contour(folder: Path, beam: str) -> FloatArray:
    """Corners and bulges of a beam in the sheets, which are in true size."""
    space = ezdxf.readfile(folder / "beams.dxf").modelspace()  # pyright: ignore
    name = next(t for t in space.query("TEXT") if t.dxf.text == beam and t.dxf.layer == "TEXT")
    at = np.array(list(name.dxf.insert)[:2])
    rings = [
        np.array(list(ring.get_points("xyb")))
        for ring in space.query("LWPOLYLINE[layer=='CUT']")
    ]
    below = [ring for ring in rings if (ring[:, 1] < at[1]).all() and ring[:, 0].mean() > at[0]]
    return min(below, key=lambda ring: norm(ring[:, :2].mean(axis=0) - at))


def circle_of(start: FloatArray, end: FloatArray, bulge: float) -> tuple[FloatArray, float]:
    chord = end - start
    height = norm(chord) * (1 - bulge**2) / (4 * bulge)
    center = (start + end) / 2 + height * np.array([-chord[1], chord[0]]) / norm(chord)
    return center, float(norm(start - center))


@pytest.mark.parametrize("row", [0, 30])
def test_a_beam_is_rebuilt_from_its_drawing_and_its_rows(folder: Path, row: int) -> None:
    beam = pd.read_csv(folder / "beams.csv").iloc[row]
    ends = pd.read_csv(folder / "beam_ends.csv").query("beam == @beam.id")
    ring = drawn_contour(folder, beam.id)
    first = ends.iloc[0]
    # The drawing says how the contour is, the table where it stands.
    ring[:, :2] += [first.inner_u_mm - ring[0, 0], first.inner_v_mm - ring[0, 1]]
    last = ends.iloc[1]
    np.testing.assert_allclose(ring[2, :2], [last.outer_u_mm, last.outer_v_mm], atol=0.005)
    half = beam.thickness_mm / 2
    plate = cq.Workplane("XY", origin=(0, 0, -half))
    solid = plate.rect(4 * beam.length_mm, 4 * beam.length_mm).extrude(2 * half)
    for side in (0, 2):
        center, radius = circle_of(ring[side, :2], ring[(side + 1) % 4, :2], ring[side, 2])
        disc = plate.center(*center).circle(radius).extrude(2 * half)
        # The piece is on the left of its contour.
        solid = solid.intersect(disc) if ring[side, 2] > 0 else solid.cut(disc)
    for _, end in ends.iterrows():
        top = np.array([end.outer_u_mm, end.outer_v_mm])
        along = unit(np.array([end.inner_u_mm, end.inner_v_mm]) - top)
        out = np.array([along[1], -along[0]]) * (1 if end.end == 2 else -1)
        if (out @ [1.0, 0.0] > 0) != (end.end == 2):
            out = -out
        ridge = np.array([-end.ridge_setback_mm, end.ridge_w_mm])
        for setback, height in ((end.lower_setback_mm, -half), (end.upper_setback_mm, half)):
            # The cut goes through the ridge and the rim of its side, along the end.
            slope = np.array([-setback, height]) - ridge
            point = np.array([*(top + ridge[0] * out), ridge[1]])
            across = np.array([*(slope[0] * out), slope[1]])
            normal = np.cross(across, [*along, 0.0])
            normal *= -np.sign(normal @ [*out, 0.0])
            solid = solid.intersect(half_space(point, normal, 4 * beam.length_mm))
    u = cq.Vector(beam.u_x, beam.u_y, beam.u_z)
    v = cq.Vector(beam.v_x, beam.v_y, beam.v_z)
    origin = (beam.origin_x_mm, beam.origin_y_mm, beam.origin_z_mm)
    built = solid.val().moved(cq.Location(cq.Plane(origin, xDir=u, normal=u.cross(v))))
    expected = cq.importers.importStep(str(folder / "beams.step")).solids().vals()[row]
    assert built.Volume() == pytest.approx(1e9 * beam.volume_m3, rel=1e-5)
    assert abs(built.Volume() - expected.Volume()) < CLOSE_MM * expected.Area()
    assert apart(built, expected) < CLOSE_MM
