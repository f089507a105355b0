"""Values both ways: numbers in any language, texts, points, planes, curves, Breps; no NaN."""

import json
import math
from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
import pytest
import rhino3dm
from hypothesis import given
from hypothesis import strategies as st

from spheremesh import Graph, Mesh
from spheremesh.fabrication.rhino_objects.curves import arc_fields
from spheremesh.fabrication.rhino_objects.meshes import mesh_fields, mesh_of_fields
from spheremesh.interfaces.hops.handles import Handles
from spheremesh.interfaces.hops.parameters import CODED, Form
from spheremesh.interfaces.hops.values_out import (
    UNSET,
    Exchange,
    encoder,
    number_text,
    text_items,
)
from spheremesh.kernel.panels.panels import Panels
from spheremesh.kernel.sphere_meshes.sphere_mesh import SphereMesh
from spheremesh.nodes import (
    MemoryStore,
    edge_arcs,
    fit_spheres,
    plane_rows,
    reflection,
    triangulated_surface,
    vase_mesh,
)

pytestmark = pytest.mark.filterwarnings("ignore::spheremesh.nodes.NodeWarning")
Value: TypeAlias = Any
FINITE = st.floats(allow_nan=False, allow_infinity=False)


@given(FINITE)
def test_numbers_are_the_same_in_every_language(number: float) -> None:
    text = number_text(number)
    assert float(text) == number
    assert not set(text) - set("0123456789E-")


def no_panels(_: SphereMesh) -> Panels:
    raise AssertionError


@given(st.lists(st.floats(), max_size=20))
def test_nan_never_leaves(numbers: list[float]) -> None:
    exchange = Exchange(Handles(MemoryStore()), no_panels)
    array = np.array(numbers)
    for form in (Form("Number", is_list=True), CODED):
        items = encoder(form)(array, exchange, "node.port")
        assert not any(word in json.dumps(items).lower() for word in ("nan", "inf"))
    items = encoder(Form("Number", is_list=True))(array, exchange, "node.port")
    for item, number in zip(items, numbers, strict=True):
        got = float(item["data"])
        if math.isfinite(number):
            assert got == number
        else:
            assert math.isfinite(got)
            assert abs(got) > 1e308
            assert (got == UNSET) == math.isnan(number)
    assert bool(exchange.warnings) == (not np.isfinite(array).all())


def test_what_is_not_set_is_no_point(gh: Value) -> None:
    exchange = Exchange(Handles(MemoryStore()), no_panels)
    points = np.array([[0.0, 1, 2], [np.nan, 0, 0]])
    first, second = encoder(Form("Point", is_list=True))(points, exchange, "node.port")
    assert json.loads(first["data"]) == {"X": 0.0, "Y": 1.0, "Z": 2.0}
    assert set(json.loads(second["data"]).values()) == {UNSET}
    assert exchange.warnings[0].startswith("node.port: 1 of 2 are not defined")
    with pytest.raises(Exception, match="coordinates are not finite"):
        gh.solve("stereographic", points=[[UNSET, UNSET, UNSET]])


@pytest.mark.parametrize(
    "text",
    ["", "roof", "Übersicht 屋根 🏠", "a \\ b", "line\nline", "12", "null", "[1, 2]", "{0;1}"],
)
def test_texts_are_read_alike_by_old_and_new_clients(
    opened: Callable[..., Any], text: str
) -> None:
    client = opened().gh  # its rules compare both readings
    (item,) = text_items([text])
    values = [{"ParamName": "a", "InnerTree": {"{0}": [item]}}]
    answer = json.dumps({"values": values, "errors": [], "warnings": []}).encode()
    client.send = lambda *_, **__: (200, "application/json", answer)
    assert client.ask("any", [], ["a"]) == {"a": [text]}


@given(st.dictionaries(st.text(max_size=5), st.text(max_size=9), max_size=3))
def test_reports_are_read_alike(report: dict[str, str]) -> None:
    (item,) = text_items([json.dumps(report, ensure_ascii=False)])
    assert json.loads(json.loads(item["data"])) == report


def flower() -> Mesh:
    """A hexagon with a square on every side, a triangle between, and a pentagon at one end."""
    angles = np.radians(60 * np.arange(6))
    inner = np.column_stack([np.cos(angles), np.sin(angles), 0.1 * np.cos(3 * angles)])
    faces = [list(range(6))]
    points = inner.tolist()
    for i in range(6):
        j, n = (i + 1) % 6, len(points)
        out = (inner[i] + inner[j]) / 2
        points += [(inner[j] + out).tolist(), (inner[i] + out).tolist()]
        faces.append([j, i, n + 1, n])
    n = len(points)
    points += [(2.2 * inner[0]).tolist()]
    faces.append([6, 7, n])
    return Mesh(points, faces)


def test_a_mesh_with_ngons_comes_back_as_it_was(gh: Value) -> None:
    mesh = flower()
    assert set(mesh.degrees.tolist()) == {3, 4, 6}
    back = mesh_of_fields(gh.solve("repair_mesh", mesh=mesh_fields(mesh))["mesh"][0])
    assert np.array_equal(back.corners, mesh.corners)
    assert np.array_equal(back.vertices, mesh.vertices)


def test_an_unwelded_mesh_is_welded(gh: Value) -> None:
    box = rhino3dm.Mesh()
    for shift in (0.0, 1.0):
        first = [
            box.Vertices.Add(x + shift, y, 0.0) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))
        ]
        del first
    box.Faces.AddFace(0, 1, 2, 3)
    box.Faces.AddFace(4, 5, 6, 7)
    found = gh.solve("triangulate", mesh=box.Encode())
    assert len(mesh_of_fields(found["mesh"][0]).vertices) == 6


def test_a_plane_is_a_sphere_without_curvature(opened: Callable[..., Any]) -> None:
    one = opened()
    plane = {
        "Origin": {"X": 0.0, "Y": 0.0, "Z": 3.0},
        "XAxis": {"X": 1.0, "Y": 0.0, "Z": 0.0}, "YAxis": {"X": 0.0, "Y": 1.0, "Z": 0.0},
        "ZAxis": {"X": 0.0, "Y": 0.0, "Z": 1.0},
    }  # fmt: skip
    row = plane_rows(np.array([[0.0, 0, 1]]), 3.0)[0]
    found = one.gh.solve("reflection", mirror_plane=plane)["transform"]
    assert np.array_equal(json.loads(found[0]), reflection(row))
    assert found == one.gh.solve("reflection", mirror=json.dumps(row.tolist()))["transform"]
    distances = one.gh.solve("signed_distance", spheres_plane=plane, points=[[1, 1, 5.0]])
    assert abs(distances["numbers"][0]) == 2.0
    with pytest.raises(Exception, match="give mirror or mirror_plane, not both"):
        one.gh.solve("reflection", mirror_plane=plane, mirror=json.dumps(row.tolist()))
    with pytest.raises(Exception, match="mirror or mirror_plane is missing"):
        one.gh.solve("reflection")


@pytest.mark.usefixtures("in_this_process")
def test_arcs_go_and_come_as_curves(opened: Callable[..., Any]) -> None:
    one = opened()
    sphere_mesh = fit_spheres(vase_mesh(8, 4))
    handle = one.service.solver.handles.give("sphere_mesh", sphere_mesh)
    found = one.gh.solve("edge_arcs", sphere_mesh=handle)
    arcs = edge_arcs(sphere_mesh).arcs
    assert found["curves"] == arc_fields(arcs)
    same = json.dumps(np.eye(5).tolist())
    moved = one.gh.solve("apply_mobius", geometry_curve=found["curves"], transform=same)
    assert len(moved["curves"]) == len(arcs.sagittas)
    back = one.service.solver.handles.take(moved["geometry"][0], "here")
    assert np.allclose(back.starts, arcs.starts, atol=1e-12)
    assert np.allclose(back.sagittas, np.abs(arcs.sagittas), atol=1e-12)


@pytest.mark.usefixtures("in_this_process")
def test_a_brep_comes_as_a_surface(gh: Value) -> None:
    ball = rhino3dm.Sphere(rhino3dm.Point3d(0, 0, 0), 2.0).ToBrep()
    found = gh.solve("surface_fields", surface_brep=ball.Encode())
    mesh = mesh_of_fields(found["mesh"][0])
    assert np.allclose(np.linalg.norm(mesh.vertices, axis=1), 2.0)
    assert len(found["normals"]) == len(mesh.vertices)


def test_one_number_or_many_go_into_one_input(gh: Value) -> None:
    mesh = triangulated_surface("bump", edge_length=0.4).mesh
    same = [0.1] * len(mesh.vertices)
    one = gh.solve("tangent_spheres", mesh=mesh_fields(mesh), offset=[0.1])
    many = gh.solve("tangent_spheres", mesh=mesh_fields(mesh), offset=same)
    assert one["spheres"] == many["spheres"]


def test_units_are_those_of_the_document(opened: Callable[..., Any]) -> None:
    one = opened()
    handle = one.service.solver.handles.give("sphere_mesh", fit_spheres(vase_mesh(8, 4)))
    for units, scale in (("Meters", 1000.0), ("Millimeters", 1.0)):
        text = one.gh.solve("cluster_radii", units, sphere_mesh=handle, k=2)["report"][0]
        asked = Graph(units={1000.0: "m", 1.0: "mm"}[scale])
        fitted = asked.add("fit_spheres", mesh=vase_mesh(8, 4))
        wanted = asked.run(asked.add("cluster_radii", sphere_mesh=fitted, k=2).report)
        assert json.loads(text)["radii"] == list(wanted["radii"])
    with pytest.raises(Exception, match=r"cluster_radii.units: the document is in Miles"):
        one.gh.solve("cluster_radii", "Miles", sphere_mesh=handle, k=2)
    with pytest.raises(Exception, match=r"cluster_radii.units: the document is without units"):
        one.gh.solve("cluster_radii", "None", sphere_mesh=handle, k=2)
    assert one.gh.solve("cluster_radii", "", sphere_mesh=handle, k=2)
    assert one.gh.solve("cluster_radii", "Miles", sphere_mesh=handle, k=2, units="ft")


def data(kind: str, text: str) -> dict[str, str]:
    return {"type": kind, "data": text}


REAL, WHOLE, MESH = "System.Double", "System.Int32", "Rhino.Geometry.Mesh"
POINT = json.dumps(rhino3dm.Point(rhino3dm.Point3d(0, 0, 0)).Encode())


@pytest.mark.parametrize(
    ("name", "port", "item", "message"),
    [
        ("vase_mesh", "n_around", data(REAL, "2.5"), "no whole number"),
        ("vase_mesh", "height", data(REAL, '"NaN"'), "no finite number"),
        ("vase_mesh", "height", data(REAL, "NaN"), "no finite number"),
        ("vase_mesh", "height", data("System.String", '"high"'), "is no number"),
        ("roof_mesh", "length", data(REAL, "-1"), "must be at least"),
        ("triangulate", "mesh", data(MESH, "{}"), "no object of"),
        ("triangulate", "mesh", data(MESH, '{"data": "?"}'), "no base64"),
        ("triangulate", "mesh", data(MESH, '{"data": "AAAA"}'), "no object of"),
        ("face_planes", "mesh", data(MESH, POINT), "no mesh"),
        ("intersection_angles", "sphere_mesh", data("", '"hello"'), "is no handle"),
        ("intersection_angles", "sphere_mesh", data("", "[1, 2]"), "must be SphereMesh"),
        ("intersection_angles", "sphere_mesh", data("", "spheremesh:x"), "no handle of"),
        ("edge_arcs", "mode", data("", '"both"'), "must be 'intersection' or 'bisector'"),
    ],
)
def test_what_is_wrong_is_said_with_its_place(
    opened: Callable[..., Any], name: str, port: str, item: dict[str, str], message: str
) -> None:
    one = opened()
    values = [{"ParamName": port, "InnerTree": {"{0}": [item]}}]
    if name == "edge_arcs":
        handle = one.service.solver.handles.give("sphere_mesh", fit_spheres(vase_mesh(6, 3)))
        tree = {"{0}": [data("System.String", handle)]}
        values.append({"ParamName": "sphere_mesh", "InnerTree": tree})
    with pytest.raises(Exception, match=f"{name}.{port}.*{message}"):
        one.gh.ask(name, values, [])
    assert one.gh.status == 500
