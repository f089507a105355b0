"""The eight exchanges between Grasshopper's client and a server."""

import json
from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
import pytest

from spheremesh.fabrication.rhino_objects.meshes import mesh_fields
from spheremesh.nodes import deviation, fit_spheres, signed_distance, sphere_rows, vase_mesh

Value: TypeAlias = Any

pytestmark = pytest.mark.filterwarnings("ignore::spheremesh.nodes.NodeWarning")


def test_a_list_makes_the_menu(gh: Value) -> None:
    status, found = gh.get("/")
    assert status == 200
    assert isinstance(found, list)
    by_name = {each["Uri"]: each for each in found}
    assert len(by_name) == len(found) > 100
    for uri, each in by_name.items():
        assert uri == f"/{each['Name']}"
        assert each == gh.get(uri)[1]
    cluster = by_name["/cluster_radii"]
    assert [(port["Name"], port["ParamType"]) for port in cluster["Inputs"][:3]] == [
        ("sphere_mesh", "Text"), ("k", "Integer"), ("relax", "Boolean"),
    ]  # fmt: skip
    assert cluster["Inputs"][2]["Default"] is True
    names = [(port["Name"], port["ParamType"]) for port in cluster["Outputs"]]
    assert names == [
        ("sphere_mesh", "Text"), ("spheres", "Brep"), ("labels", "Integer"),
        ("radii", "Number"), ("report", "Text"),
    ]  # fmt: skip


def test_a_description_makes_the_component(gh: Value) -> None:
    found = gh.describe("fit_spheres")
    mesh, ring = found["inputs"]
    assert (mesh["Name"], mesh["ParamType"]) == ("mesh", "Mesh")
    assert (mesh["AtLeast"], mesh["AtMost"], ring["AtLeast"], ring["AtMost"]) == (1, 1, 1, 1)
    assert (ring["Default"], ring["Minimum"]) == (1, 0)
    assert found["outputnames"] == ["sphere_mesh", "spheres"]
    weights = gh.describe("minimize_angles")["inputs"][2]
    assert (weights["AtLeast"], weights["ParamType"]) == (0, "Number")
    assert "Default" not in weights


def test_an_unknown_component_is_told_with_the_nearest_name(
    gh: Value, error_of: type[Exception]
) -> None:
    with pytest.raises(error_of, match="did you mean 'fit_spheres'"):
        gh.describe("fit_sphers")


def test_an_item_is_solved(gh: Value) -> None:
    mesh = vase_mesh(8, 4)
    found = gh.solve("fit_spheres", mesh=mesh_fields(mesh), ring=1)
    assert found["sphere_mesh"][0].startswith("spheremesh:sphere_mesh:")
    assert len(found["spheres"]) == mesh.n_faces


def test_paths_come_back_and_whole_numbers_do_at_number_inputs(
    opened: Callable[..., Any],
) -> None:
    one = opened()
    handle = one.service.solver.handles.give("sphere_mesh", fit_spheres(vase_mesh(8, 4)))
    found = one.gh.solve(
        "minimize_angles", sphere_mesh={"{0;3}": handle}, target_angle={"{0;3}": 5}
    )
    report = json.loads(found["report"][0])
    assert report["angles_deg"]["spherical"]["mean"] > 0
    values = [
        {"ParamName": "sphere_mesh", "InnerTree": {"{0;3}": [text(handle)]}},
        {"ParamName": "target_angle", "InnerTree": {"{0;3}": [whole(5)]}},
    ]
    status, _, body = one.gh.send("POST", "/solve", json.dumps({
        "pointer": "minimize_angles", "values": values,
    }).encode())  # fmt: skip
    assert status == 203  # a handle in memory is gone with the server
    assert {tuple(tree["InnerTree"]) for tree in json.loads(body)["values"]} == {("{0;3}",)}


def text(value: str) -> dict[str, str]:
    return {"type": "System.String", "data": json.dumps(value)}


def whole(value: int) -> dict[str, str]:
    return {"type": "System.Int32", "data": str(value)}


def test_a_tree_comes_back_branch_by_branch(opened: Callable[..., Any]) -> None:
    one = opened()
    rows = sphere_rows(np.zeros((1, 3)), 1.0)
    points = {"{0;0}": [[0.0, 0, 0]], "{0;1}": [[1.0, 2, 3], [1, 2, 4]]}
    found = one.gh.solve("signed_distance", spheres=json.dumps(rows.tolist()), points=points)
    for path, several in points.items():
        wanted = signed_distance(np.repeat(rows, len(several), 0), np.array(several, float))
        assert found["numbers"][path] == wanted.tolist()
    handle = one.service.solver.handles.give("sphere_mesh", fit_spheres(vase_mesh(8, 4)))
    mesh = vase_mesh(16, 8)
    far = one.gh.solve("deviation", sphere_mesh=handle, mesh=mesh_fields(mesh))["distances"]
    assert far == deviation(fit_spheres(vase_mesh(8, 4)), mesh).tolist()
    assert one.gh.status == 200


def test_a_lost_handle_is_an_error_that_nobody_keeps(
    gh: Value, error_of: type[Exception]
) -> None:
    lost = f"spheremesh:sphere_mesh:{'0' * 32}"
    for _ in range(2):
        with pytest.raises(error_of, match=r"cluster_radii.sphere_mesh: .* recompute"):
            gh.solve("cluster_radii", sphere_mesh=lost, k=12)
        assert gh.status == 500
    assert not gh.kept


def test_files_are_written_again_and_texts_are_read_as_they_are(
    opened: Callable[..., Any],
) -> None:
    one = opened()
    handle = one.gh.solve("fit_spheres", mesh=mesh_fields(vase_mesh(8, 4)))["sphere_mesh"]
    panels = one.gh.solve("panels", sphere_mesh=handle)["panels"]
    for _ in range(2):
        found = one.gh.solve("write_schedule", panels=panels, path="out/Übersicht.csv")
        path = one.files / "out" / "Übersicht.csv"
        assert found["path"] == [str(path)]
        assert one.gh.status == 203
        assert path.is_file()
        path.unlink()


def test_any_text_of_a_handle_that_is_gone_is_told_so(gh: Value) -> None:
    with pytest.raises(Exception, match=r"cluster_radii.sphere_mesh: this handle is no longer"):
        gh.solve("cluster_radii", sphere_mesh="spheremesh:sphere_mesh:gone", k=12)
