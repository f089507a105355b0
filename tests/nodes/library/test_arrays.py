"""Arrays of one element are refused where another's are asked for, with both ends named."""

from typing import Any

import numpy as np
import pytest

import spheremesh as sm
from spheremesh.nodes import GraphError, find_node
from spheremesh.nodes.graphs.annotations import (
    ArrayFacts,
    Member,
    element_type,
    members,
    type_name,
)
from spheremesh.nodes.graphs.kinds import fits
from spheremesh.nodes.graphs.node import REGISTRY, load_library
from spheremesh.nodes.library import arrays


def steps() -> sm.Graph:
    """A step of every node that gives an array."""
    g = sm.Graph()
    mesh = g.add("triangulated_surface", "bump")
    net = g.add("torus_mesh", "net")
    start = g.add("fit_spheres", "start", mesh=net)
    spheres = g.add("tangent_spheres", "tangent", mesh=mesh.mesh, offset=1.0)
    g.add("envelope", mesh=mesh.mesh, spheres=spheres)
    g.add("conjugate_directions", "conjugate", mesh=mesh.mesh, spheres=spheres)
    g.add("cluster_radii", "moulds", sphere_mesh=start, k=3)
    g.add("strip_weights", "strips", mesh=net)
    cut = g.add("panels", "cut", sphere_mesh=start)
    g.add("identical_panels", "shapes", panels=cut.panels)
    g.add("inversion", center=[0, 0, 9])
    for node in ("intersection_angles", "vertex_error", "planarity", "spiky_faces"):
        g.add(node, sphere_mesh=start)
    for node in ("edge_arcs", "classify_hexagons", "support_structure", "support_type"):
        g.add(node, sphere_mesh=start)
    g.add("mirror_points", sphere_mesh=start)
    g.add("edge_spheres", mesh=net)
    g.add("stereographic", points=mesh.normals)
    g.add("sphere_rows", "balls", centers=mesh.normals, radii=1.0)
    g.add("sphere_facts", spheres=spheres)
    g.add("sphere_pairs", first=spheres, second=spheres)
    g.add("pentaspherical_coordinates", spheres=spheres)
    g.add("sent_to_infinity", points=mesh.normals, transform=g.wire("inversion"))
    drawn = g.add("read_surface", "drawn", path="roof.3dm")
    g.add("surface_fields", "fields", surface=drawn)
    return g


WRONG = [
    ("fields.curvatures", "panels.labels"),
    ("tangent.result", "minimize_angles.edge_weights"),
    ("bump.normals", "envelope.spheres"),
    ("support_structure.axes", "p4_remesh.spheres"),
    ("support_structure.torsion", "minimize_angles.edge_weights"),
    ("support_structure.is_valid", "panels.labels"),
    ("conjugate.directions", "strip_weights.direction"),
    ("conjugate.is_real", "tangent_spheres.offset"),
    ("vertex_error.result", "optimize_spheres.fixed_radii"),
    ("strips.result", "optimize_spheres.fixed_radii"),
    ("intersection_angles.result", "tangent_spheres.offset"),
    ("edge_arcs.gap", "panels.labels"),
    ("moulds.labels", "optimize_spheres.edge_weights"),
    ("moulds.labels", "optimize_spheres.fixed_radii"),
    ("moulds.radii", "optimize_spheres.fixed_radii"),
    ("classify_hexagons.result", "panels.labels"),
    ("planarity.result", "panels.labels"),
    ("spiky_faces.result", "panels.labels"),
    ("envelope.points_plus", "tangent_sphere_shex.spheres"),
    ("envelope.is_real", "optimize_spheres.fixed_radii"),
    ("shapes.labels", "panels.labels"),
    ("support_type.omega", "sphere_bundle.center"),
    ("inversion.result", "relax_congruence.spheres"),
    ("inversion.result", "apply_mobius.geometry"),
    ("tangent.result", "apply_mobius.transform"),
    ("tangent.result", "compose.transforms"),
    ("mirror_points.points", "relax_congruence.spheres"),
    ("edge_spheres.result", "relax_congruence.spheres"),
    ("stereographic.result", "signed_distance.points"),
    ("balls.result", "signed_distance.points"),
    ("bump.normals", "inverse_stereographic.points"),
    ("sphere_facts.centers", "sphere_through_points.points"),
    ("sphere_facts.radii_squared", "signed_distance.points"),
    ("sphere_facts.kinds", "sphere_rows.radii"),
    ("sphere_pairs.angles", "panels.labels"),
    ("pentaspherical_coordinates.result", "signed_distance.points"),
    ("sent_to_infinity.result", "sphere_rows.radii"),
]  # fmt: skip


def wire_type(g: sm.Graph, source: str) -> Any:  # noqa: ANN401
    """Type of what comes by a wire."""
    wire: Any = g.wire(source)
    return wire.type


def needed(g: sm.Graph, node: str, but: str) -> dict[str, Any]:
    """Whatever else the node needs."""
    spheres = g.wire("tangent.result")
    found: dict[str, Any] = {
        "mesh": g.wire("net"), "sphere_mesh": g.wire("start"), "spheres": spheres,
        "offset": 1.0, "edge_length": 1.0, "geometry": g.wire("net"), "center": [0, 0, 9],
        "transform": g.wire("inversion"), "points": g.wire("bump.normals"),
        "centers": g.wire("bump.normals"),
    }  # fmt: skip
    inputs = find_node(node).inputs
    return {name: value for name, value in found.items() if name in inputs and name != but}


@pytest.mark.parametrize(("source", "target"), WRONG)
def test_a_wrong_array_is_refused_when_wired(source: str, target: str) -> None:
    g = steps()
    node, port = target.split(".")
    with pytest.raises(GraphError) as error:
        g.add(node, "wrong", **needed(g, node, port), **{port: g.wire(source)})
    given, wanted = wire_type(g, source), find_node(node).inputs[port].type
    ends = f"{source} ({type_name(given)}) into wrong.{port} ({type_name(wanted)})"
    assert str(error.value).partition(";")[0] == f"cannot wire {ends}"


def test_every_type_of_array_has_its_refusal() -> None:
    g = steps()
    refused = {m.facts for source, _ in WRONG for m in members(wire_type(g, source))}
    load_library()
    given = {
        member.facts
        for node in REGISTRY.values()
        for port in node.outputs.values()
        for member in members(port.type)
        if member.facts
    }
    assert given == refused & given


def find(name: str) -> ArrayFacts | None:
    """What an alias says."""
    (member,) = members(getattr(arrays, name))
    return member.facts


def test_every_array_of_the_library_says_what_it_is() -> None:
    load_library()

    def arrays_of(kind: Any) -> list[Member]:  # noqa: ANN401
        found = members(kind)
        inside = [
            m for each in found if each.kind is list for m in arrays_of(element_type(kind))
        ]
        return [m for m in found if m.kind is np.ndarray] + inside

    assert [
        f"{node.name}.{port.name}"
        for node in REGISTRY.values()
        if node.function.__module__.startswith("spheremesh.nodes.library")
        for port in (*node.inputs.values(), *node.outputs.values())
        if not all(member.facts for member in arrays_of(port.type))
        and node.name != "conjugacy"  # takes vectors of any length
    ] == []


ALIASES = [name for name, kind in vars(arrays).items() if hasattr(kind, "__metadata__")]


@pytest.mark.parametrize("name", ALIASES)
def test_an_array_fits_its_own_kind_and_those_that_do_not_say(name: str) -> None:
    kind = getattr(arrays, name)
    plain = kind.__origin__
    assert fits(kind, kind)
    assert fits(kind, plain)
    assert fits(plain, kind)
    assert fits(list[plain], list[kind])
    others = [getattr(arrays, other) for other in ALIASES]
    assert not all(fits(kind, other) for other in others)


@pytest.mark.parametrize(
    ("node", "port", "value"),
    [
        ("minimize_angles", "edge_weights", [[1.0, 2.0], [3.0, 4.0]]),
        ("minimize_angles", "edge_weights", np.ones((3, 1))),
        ("tangent_sphere_shex", "spheres", np.ones((4, 4))),
        ("tangent_sphere_shex", "spheres", [[1, 2, 3, 4, 5], [1, 2]]),
        ("sphere_bundle", "center", [0, 0]),
        ("apply_mobius", "transform", np.eye(4)),
        ("compose", "transforms", [np.eye(5), np.eye(4)]),
    ],
)
def test_a_literal_of_a_wrong_shape_is_refused(node: str, port: str, value: object) -> None:
    g = steps()
    with pytest.raises(GraphError, match=rf"wrong\.{port} = .*: must be .*\("):
        g.add(node, "wrong", **needed(g, node, port), **{port: value})


def test_right_arrays_are_wired() -> None:
    g = steps()
    start = g.wire("start")
    g.add("minimize_angles", sphere_mesh=start, edge_weights=g.wire("strips"))
    g.add("minimize_angles", sphere_mesh=start, edge_weights=np.ones(96))
    g.add("panels", sphere_mesh=start, labels=g.wire("moulds.labels"))
    g.add("tangent_spheres", mesh=g.wire("net"), offset=g.wire("vertex_error"))
    g.add("similarity", rotation=[0, 0, g.param("angle", 90.0)])
    moved = g.add("apply_mobius", geometry=g.wire("tangent"), transform=g.wire("inversion"))
    g.add("tangent_sphere_shex", mesh=g.wire("bump.mesh"), spheres=moved)
    transforms = [g.wire("inversion"), g.wire("similarity"), np.eye(5)]
    assert g.run(g.add("compose", transforms=transforms)).shape == (5, 5)
