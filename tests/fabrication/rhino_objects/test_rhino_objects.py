"""Objects of Rhino in JSON: what goes out comes back, what is damaged is refused."""

import base64
import json
import zlib
from contextlib import suppress
from typing import Any

import numpy as np
import pytest
import rhino3dm
from hypothesis import given, settings
from hypothesis import strategies as st

from spheremesh import Mesh
from spheremesh.fabrication.opennurbs.stream_reader import BufferPlace, buffer_content
from spheremesh.fabrication.rhino import isolation
from spheremesh.fabrication.rhino_objects.curves import (
    arc_fields,
    circle_fields,
    curves_of_fields,
)
from spheremesh.fabrication.rhino_objects.fields import object_stream
from spheremesh.fabrication.rhino_objects.meshes import mesh_fields, mesh_of_fields
from spheremesh.fabrication.rhino_objects.solids import axis_lines, beam_solids, panel_breps
from spheremesh.fabrication.rhino_objects.surfaces import surface_of_fields
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.spheres.circles import Circles
from spheremesh.kernel.surfaces.row_counts import GridSize
from spheremesh.nodes import (
    annulus_support,
    edge_arcs,
    ellipsoid_mesh,
    fit_spheres,
    model_change,
    panels,
    roof_mesh,
    vase_mesh,
)
from spheremesh.nodes import beams as make_beams

SIZES = st.floats(1e-6, 1e6)


@pytest.fixture
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(isolation, "_can_start", lambda: False)


def decoded(fields: dict[str, Any]) -> Any:  # noqa: ANN401
    return rhino3dm.CommonObject.Decode(json.loads(json.dumps(fields)))


@settings(max_examples=30, deadline=None)
@given(st.integers(3, 8), st.integers(1, 4), SIZES, st.floats(-1e6, 1e6))
def test_a_mesh_comes_back_to_the_last_bit(n: int, m: int, size: float, far: float) -> None:
    rng = np.random.default_rng(n * m)
    vase = vase_mesh(n, m)
    mesh = Mesh((vase.vertices + 0.01 * rng.normal(size=vase.vertices.shape) + far) * size,
                vase.faces)  # fmt: skip
    back = mesh_of_fields(json.loads(json.dumps(mesh_fields(mesh))))
    assert np.array_equal(back.vertices, mesh.vertices)
    assert np.array_equal(back.corners, mesh.corners)


def test_polygons_are_ngons_for_rhino() -> None:
    angles = 2 * np.pi * np.arange(7) / 7
    ring = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    mesh = Mesh(ring, [list(range(7))])
    fields = mesh_fields(mesh)
    assert decoded(fields).IsValid
    assert mesh_of_fields(fields).degrees.tolist() == [7]


@settings(max_examples=100, deadline=None)
@given(st.data())
def test_a_damaged_mesh_is_refused_or_read(data: st.DataObject) -> None:
    fields = mesh_fields(vase_mesh(4, 2))
    stream = bytearray(object_stream(fields))
    for place in data.draw(st.lists(st.integers(0, len(stream) - 1), min_size=1, max_size=4)):
        stream[place] = data.draw(st.integers(0, 255))
    if data.draw(st.booleans()):
        stream = stream[: data.draw(st.integers(0, len(stream)))]
    damaged = {**fields, "data": base64.b64encode(bytes(stream)).decode()}
    with suppress(InputError):
        assert isinstance(mesh_of_fields(damaged), Mesh)


def test_a_small_stream_does_not_grow_beyond_measure() -> None:
    packed = zlib.compress(bytes(2**20))
    whole = BufferPlace(0, len(packed), is_deflated=True)
    assert len(buffer_content(packed, whole)) == 2**20
    assert buffer_content(packed[:-8], whole) == b""


@pytest.mark.parametrize("fields", [None, 1, [], {}, {"data": 1}, {"data": "?"}, {"data": ""}])
def test_what_is_no_object_is_refused(fields: object) -> None:
    with pytest.raises(InputError, match="entry"):
        mesh_of_fields(fields)


def test_panels_are_exact_breps() -> None:
    made = panels(fit_spheres(vase_mesh(8, 4))).panels
    breps, rejected = panel_breps(made)
    assert (len(breps), rejected) == (made.n_panels, ())
    for i, fields in enumerate(breps):
        brep = decoded(fields)
        assert brep.IsValid
        points = [brep.Vertices[k].Location for k in range(len(brep.Vertices))]
        corners = made.corners[made.offsets[i] : made.offsets[i + 1]] + made.origins[i]
        got = np.array([[p.X, p.Y, p.Z] for p in points])
        assert np.abs(got[: len(corners)] - corners).max() < 1e-12


def test_beams_are_solids() -> None:
    sphere_mesh = model_change(ellipsoid_mesh(8, 4), radius=4.0)
    made = make_beams(annulus_support(sphere_mesh, depth=0.1).annuli, thickness=0.02).beams
    solids = [decoded(fields) for fields in beam_solids(made)]
    assert len(solids) == len(made.annuli.ids)
    assert all(solid.IsValid and solid.IsSolid for solid in solids)


@pytest.mark.parametrize("size", [1e-6, 1e6])
def test_arcs_come_back_from_curves_of_any_class(size: float) -> None:
    mesh = roof_mesh(2, 2)
    arcs = edge_arcs(fit_spheres(Mesh(mesh.vertices * size, mesh.faces))).arcs
    edge = float(np.linalg.norm(arcs.ends - arcs.starts, axis=1).mean())
    curves = arc_fields(arcs)
    nurbs = [dict(decoded(curve).ToNurbsCurve().Encode()) for curve in curves]
    back = curves_of_fields([*curves, *nurbs])
    for name, wanted in (("starts", arcs.starts), ("ends", arcs.ends)):
        misses = np.abs(getattr(back, name) - np.concatenate([wanted, wanted]))
        assert misses.max() < 1e-9 * edge
    sagittas = np.abs(np.concatenate([arcs.sagittas, arcs.sagittas]))
    assert np.abs(back.sagittas - sagittas).max() < 1e-9 * edge


@pytest.mark.usefixtures("in_this_process")
def test_circles_come_back_and_imaginary_ones_do_not() -> None:
    circles = Circles(
        np.array([[1.0, 2, 3], [0, 0, 0]]), np.array([[0.0, 0, 1], [1, 0, 0]]),
        np.array([4.0, -1]),
    )  # fmt: skip
    back = curves_of_fields(circle_fields(circles))
    assert np.allclose(back.centers, [[1.0, 2, 3]])
    assert np.allclose(back.radii_squared, [4.0])


@pytest.mark.usefixtures("in_this_process")
def test_other_curves_are_refused() -> None:
    points = [rhino3dm.Point3d(x, x**3, 0) for x in range(5)]
    curve = rhino3dm.Curve.CreateControlPointCurve(points, 3)
    with pytest.raises(InputError, match="neither an arc nor straight"):
        curves_of_fields([dict(curve.Encode())])
    circle = rhino3dm.ArcCurve.CreateFromCircle(rhino3dm.Circle(1.0))
    line = rhino3dm.LineCurve(points[0], points[1])
    with pytest.raises(InputError, match="some curves are circles and some are not"):
        curves_of_fields([dict(circle.Encode()), dict(line.Encode())])
    most = rhino3dm.ArcCurve.CreateFromArc(rhino3dm.Arc(rhino3dm.Circle(1.0), 4.0))
    with pytest.raises(InputError, match="longer than a half circle"):
        curves_of_fields([dict(most.Encode())])
    with pytest.raises(InputError, match="is no curve"):
        curves_of_fields([dict(rhino3dm.Point(points[0]).Encode())])


@pytest.mark.usefixtures("in_this_process")
def test_surfaces_are_read_with_their_normals() -> None:
    ball = rhino3dm.Sphere(rhino3dm.Point3d(1, 0, 0), 2.0).ToBrep()
    surface = surface_of_fields([dict(ball.Encode())], GridSize(6, 6))
    radial = (surface.mesh.vertices - [1, 0, 0]) / 2
    assert np.allclose(radial, surface.normals, atol=1e-9)
    with pytest.raises(InputError, match="is no surface"):
        surface_of_fields([mesh_fields(vase_mesh(4, 2))], GridSize(6, 6))
    with pytest.raises(InputError, match="which version"):
        surface_of_fields([{"data": dict(ball.Encode())["data"]}], GridSize(6, 6))


def test_axes_are_lines_and_those_that_are_not_finite_are_left_out() -> None:
    axes = np.array([[[0.0, 0, 0], [0, 0, 1]], [[np.nan, 0, 0], [0, 0, 1]]])
    (line,) = axis_lines(axes)
    assert line == {"From": {"X": 0, "Y": 0, "Z": 0}, "To": {"X": 0, "Y": 0, "Z": 1}}
