"""What is said of a mesh, valid or not, in numbers that closed forms give."""

import json

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.repair.description import describe, describe_lines, size_words
from spheremesh.kernel.repair.raw_mesh import RawMesh, raw_from_faces, raw_from_mesh
from spheremesh.kernel.surfaces.circular_nets import torus_net, vase_net


def box() -> tuple[list[list[int]], list[list[int]]]:
    points = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return points, faces


def test_a_box_is_six_quads_with_twelve_creases() -> None:
    report = describe(raw_from_faces(*box()))
    assert report.is_mesh
    assert not report.problem
    assert not report.repair
    assert report.faces_by_degree == {"4": 6}
    assert (report.pieces, report.boundary_loops, report.lone_faces) == (1, 0, 0)
    assert report.crease_edges == 12
    assert report.sharpest_edge_deg == pytest.approx(90)
    assert report.size == [1, 1, 1]
    assert report.mean_edge == report.shortest_edge == 1
    assert describe_lines(report) == ("6 quads; 1 piece; no boundary loops; 12 crease edges",)


def test_circular_nets_are_circular_and_their_boundary_is_counted(
    nets: dict[str, Mesh],
) -> None:
    loops = {"torus": 0, "ellipsoid": 2, "egg": 2, "catenoid": 2, "vase": 2, "enneper": 1,
             "roof": 1}  # fmt: skip
    for name, mesh in nets.items():
        report = describe(raw_from_mesh(mesh))
        assert report.boundary_loops == loops[name]
        assert report.circularity is not None
        assert report.circularity["relative_to_edge"] < 1e-12
        assert report.planarity is not None
        assert report.planarity["relative_to_edge"] < 1e-12


def test_umbilicity_tells_spheres_from_minimal_surfaces(
    nets: dict[str, Mesh], ball: Mesh
) -> None:
    minimal = describe(raw_from_mesh(nets["catenoid"])).umbilicity
    round_ = describe(raw_from_mesh(ball)).umbilicity
    assert minimal == pytest.approx(2, abs=0.1)
    assert round_ == pytest.approx(0, abs=0.1)


def faulty() -> RawMesh:
    """Two quads apart in a vertex, one of them turned over, a hexagon twice, a T-junction."""
    points = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [2, 0, 0], [4, 0, 0], [4, 2, 0],
              [1, 0, 0], [0, -1, 0], [1, -1, 0]]  # fmt: skip
    return raw_from_faces(points, [[0, 1, 2, 3], [2, 6, 5, 4], [0, 8, 9, 7], [7, 9, 8, 0]])


def test_what_is_no_mesh_is_described_with_its_cause_and_its_repair() -> None:
    report = describe(faulty())
    assert not report.is_mesh
    assert "face 3 repeats face 2 turned over" in report.problem
    assert report.repair == {
        "welded_vertices": 1, "duplicate_faces": 1, "t_junctions": 1, "flipped_faces": 1
    }  # fmt: skip
    assert (report.unwelded_vertices, report.t_junctions) == (1, 1)
    assert (report.faces, report.pieces) == (4, 1)
    assert "--repair would weld 1 place, drop 1 repeated face" in describe_lines(report)[1]
    assert report.advice[0].startswith("repair_mesh (--repair) would weld 1 place")


@pytest.mark.parametrize(
    "faces", [[], [[0, 1]], [[0, 1, 9]], [[0, 0, 0]], [[0, 1, 2, 3, 1, 4, 5, 2, 4]]]
)
def test_what_no_repair_makes_a_mesh_is_described_too(faces: list[list[int]]) -> None:
    points = [[0, 0, 0], [2, 2, 0], [2, 0, 0], [0, 2, 0], [3, 1, 0], [5, 7, np.inf]]
    report = describe(raw_from_faces(points, faces))
    assert not report.is_mesh
    assert report.problem
    assert not report.suits
    assert (report.pieces, report.faces) == (0, len(faces))
    assert describe_lines(report)


def test_triangles_are_told_that_they_carry_no_support() -> None:
    report = describe(raw_from_faces([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 1]],
                                     [[0, 1, 2], [0, 2, 3]]))  # fmt: skip
    assert any("Lemma 5.1" in text for text in report.advice)
    quads = describe(raw_from_mesh(torus_net(8, 6, 3.0, 1.0)))
    assert not any("Lemma 5.1" in text for text in quads.advice)
    assert "optimize_spheres" in quads.suits


def test_lone_faces_are_counted() -> None:
    mesh = torus_net(8, 6, 3.0, 1.0)
    apart = mesh.vertices[mesh.corners] + np.repeat(np.arange(48.0), 4)[:, None] * 9
    report = describe(raw_from_faces(apart, np.arange(192).reshape(48, 4)))
    assert (report.lone_faces, report.pieces, report.boundary_loops) == (48, 48, 48)
    assert not report.repair
    assert any("without a neighbour: 48 of 48" in text for text in report.advice)


def test_reports_are_plain_and_follow_the_scale() -> None:
    mesh = vase_net(12, 6, 1.0, 3.0, 0.3)
    one = describe(raw_from_mesh(mesh))
    other = describe(raw_from_faces(mesh.vertices * 1000, mesh.faces))
    assert json.loads(json.dumps(dict(one))) == dict(one)
    for name in ("mean_edge", "shortest_edge"):
        assert other[name] == pytest.approx(1000 * one[name])
    for name in ("pieces", "boundary_loops", "crease_edges", "suits", "repair"):
        assert other[name] == one[name]
    assert size_words(one, "m").endswith(f" m, mean edge {one.mean_edge:.3g} m")
    assert size_words(one, "m").count(" x ") == 2


@pytest.mark.parametrize("size", [1e-300, 1e-160, 1e160, 1e300])
def test_sizes_beyond_reason_are_described(size: float) -> None:
    points, faces = box()
    report = describe(raw_from_faces(np.multiply(points, size), faces))
    assert report.faces == 6
    assert report.is_mesh == (size < 1)
    assert ("beyond 1e100" in report.problem) == (size > 1)
