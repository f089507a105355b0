"""What is shown of values: pictures that hold what was made, tables and histograms."""

import hashlib
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from spheremesh import nodes
from spheremesh.interfaces.studio.catalogue import Catalogue, family_of, field_of
from spheremesh.interfaces.studio.previews import preview
from spheremesh.kernel.meshes.mesh import Mesh
from spheremesh.nodes import find_node
from spheremesh.viewer.page.container import unpack_arrays
from spheremesh.viewer.page.grid import STEPS

SOURCE = Path(__file__).parents[3] / "interfaces" / "studio" / "source"

Value = Any


def shown(value: Value, *carriers: Value, name: str = "result") -> tuple[dict, dict]:
    return unpack_arrays(preview(value, carriers, name))


@pytest.fixture(scope="module")
def net() -> Mesh:
    return nodes.vase_mesh(10, 5)


@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_law_scn_faces_stand_where_their_mesh_has_them(net: Mesh, shift: float) -> None:
    """Within the steps of the grid, wherever the model sits."""
    moved = Mesh(net.vertices + shift, net.faces)
    head, arrays = shown(moved)
    size, center = head["size"], np.array(head["center"])
    points = arrays["outer_points"].reshape(-1, 5, 3) * (size / STEPS) + center
    np.testing.assert_allclose(
        points[:, 1:], moved.vertices[moved.corners].reshape(-1, 4, 3), atol=size / STEPS
    )
    assert len(head["panels"]["id"]) == net.n_faces


def test_values_lie_on_the_faces_edges_and_vertices_that_they_are_of(net: Mesh) -> None:
    heights = net.vertices[:, 2]
    head, arrays = shown(heights, net, name="height")
    np.testing.assert_allclose(arrays["value_0"], heights[net.corners], atol=1e-6)
    assert head["colors"] == [{"name": "height", "unit": "", "kind": "numbers"}]
    edges = np.arange(len(net.topology.edge_corners)) + 0.5
    head, arrays = shown(edges, net)
    found = arrays["value_0"]
    known = np.isfinite(found)
    assert sorted(found[known].tolist()) == sorted([*edges.tolist(), *edges.tolist()])
    assert np.count_nonzero(~known) == len(net.corners) - 2 * len(edges)
    labels = np.arange(net.n_faces) % 3
    head, arrays = shown(labels, net)
    assert head["colors"][0]["kind"] == "kinds"
    np.testing.assert_array_equal(arrays["value_0"], labels)


def test_every_kind_of_value_is_shown_and_said_in_words(net: Mesh) -> None:
    spheres = nodes.fit_spheres(net)
    held = nodes.bisector_support(spheres, depth=0.2)
    made = nodes.panels(spheres, thickness=0.02, labels=np.arange(50) % 4)
    beams = nodes.beams(held.annuli, node_radius=0.03).beams
    words = {
        "50 panels · 4 moulds": (made.panels,),
        "50 spheres": (spheres,),
        "50 faces · 60 vertices": (net,),
        f"{len(held.annuli.ids):,} annuli": (held.annuli,),
        f"{beams.n_beams} beams": (beams, made.panels),
        "60 axes": (held.axes, net),
        "60 points": (net.vertices,),
        "3 side by side": ([net, spheres, net],),
    }
    for text, values in words.items():
        head, _ = shown(*values, name=text.split()[-1] if text.startswith("60 a") else "points")
        assert (head["kind"], head["words"]) == ("model", text)
    arcs = nodes.edge_arcs(spheres).arcs
    assert shown(arcs)[0]["words"] == f"{len(arcs.starts)} arcs"


def test_reports_are_tables_and_numbers_histograms(net: Mesh) -> None:
    head, _ = shown(nodes.mesh_report(net))
    assert head["kind"] == "table"
    assert head["table"]["faces"] == 50
    head, arrays = shown(np.array([1.0, np.nan, 2.0]))
    assert (head["kind"], head["rows"]) == ("numbers", [1.0, None, 2.0])
    np.testing.assert_array_equal(arrays["values"], [1, 2])
    assert shown(np.array(["a", "b"]))[0] == {"kind": "text", "name": "result", "unit": "",
        "shape": [2], "rows": ["a", "b"], "text": "a\nb"}  # fmt: skip
    assert shown("words")[0]["text"] == "words"
    assert shown(None)[0]["text"] == "null"
    assert shown([nodes.mesh_report(net)] * 2)[0]["kind"] == "table"
    assert shown(np.zeros((0, 3)))[0]["kind"] == "numbers"
    assert shown(np.full((4, 3), np.inf), net)[0]["kind"] == "numbers"
    assert shown(np.zeros(7), net)[0]["kind"] == "numbers"


def test_a_field_is_made_of_the_facts_of_its_port() -> None:
    def field(node: str, port: str) -> str:
        return field_of(find_node(node).inputs[port])

    assert field("fit_spheres", "mesh") == ""
    assert field("fit_spheres", "ring") == "whole"
    assert field("minimize_angles", "target_angle") == "number"
    assert field("minimize_angles", "sides") == "choice"
    assert field("minimize_angles", "max_miss") == "number"
    assert field("minimize_angles", "edge_weights") == ""
    assert field("cluster_radii", "relax") == "switch"
    assert field("read_mesh", "path") == "file"
    assert field("read_mesh", "layer") == "text"
    assert field("inversion", "center") == "list"
    assert field("tangent_spheres", "offset") == "number"
    assert family_of(bool) == "switch"


def test_the_catalogue_knows_what_fits_what() -> None:
    content = Catalogue().content()
    nodes_of, fits = content["nodes"], content["fits"]

    def fit(source: str, target: str) -> bool:
        (one, out), (other, port) = source.split("."), target.split(".")
        a = next(p["type"] for p in nodes_of[one]["outputs"] if p["name"] == out)
        b = next(p["type"] for p in nodes_of[other]["inputs"] if p["name"] == port)
        return b in fits[a]

    assert fit("roof_mesh.result", "fit_spheres.mesh")
    assert not fit("roof_mesh.result", "panels.sphere_mesh")
    assert fit("cluster_radii.labels", "panels.labels")
    assert not fit("cluster_radii.radii", "panels.labels")
    json.dumps(content, allow_nan=False)


def test_bundle_was_made_of_this_source() -> None:
    digest = hashlib.sha256()
    kinds = {".js", ".mjs", ".jsx", ".css", ".html", ".json"}
    for path in sorted(path for path in SOURCE.iterdir() if path.suffix in kinds):
        digest.update(f"{path.name}\n{path.read_text(encoding='utf-8')}\n".encode())
    known = (SOURCE.parent / "bundle" / "source.sha256").read_text(encoding="utf-8").strip()
    assert digest.hexdigest() == known, "run `npm run build` in interfaces/studio/source"


def test_the_source_names_no_registry_and_the_bundle_keeps_its_licences() -> None:
    lock = json.loads((SOURCE / "package-lock.json").read_text(encoding="utf-8"))
    assert all("resolved" not in package for package in lock["packages"].values())
    licences = (SOURCE.parent / "bundle" / "licences.txt").read_text(encoding="utf-8")
    for name in ("@xyflow/react", "@dagrejs/dagre", "react-dom", "d3-zoom", "zustand"):
        assert f"{name} {lock['packages'][f'node_modules/{name}']['version']}" in licences
