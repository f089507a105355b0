"""panel --repair, the first lines, and the causes that are named without it."""

import json
import warnings
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from spheremesh import Graph, Mesh
from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.interfaces.cli import main
from spheremesh.interfaces.panel import PanelOptions, panel_graph
from spheremesh.kernel.repair.description import describe_lines
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net
from spheremesh.nodes.graphs.node import NodeWarning

DOME = ellipsoid_net(12, 4, 3.0, 2.0, 1.0)


def write_obj(path: Path, points: object, faces: list[list[int]]) -> Path:
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(points, float).tolist()]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")
    return path


def panel(path: Path, out: Path, *options: str) -> Result:
    return CliRunner().invoke(main, ["panel", str(path), "-o", str(out), *options])


def faces_of(mesh: Mesh) -> list[list[int]]:
    return [face.tolist() for face in mesh.faces]


def test_faults_are_named_with_their_cure_and_the_cure_helps(tmp_path: Path) -> None:
    faces = faces_of(DOME)
    for i in (3, 17, 20):
        faces[i].reverse()
    path = write_obj(tmp_path / "a.obj", DOME.vertices, [*faces, DOME.faces[5].tolist()])
    refused = panel(path, tmp_path / "out")
    assert refused.exit_code == 3
    assert "face 48 (line 109) repeats face 5 (line 66)" in refused.stderr
    assert "--repair" in refused.stderr
    assert len(refused.stderr.splitlines()) == 1
    done = panel(path, tmp_path / "out", "--repair")
    assert done.exit_code == 0, done.stderr
    assert "dropped 1 repeated face, turned over 3 faces" in done.stderr
    assert "48 quads; 1 piece; 2 boundary loops" in done.stdout
    report = json.loads((tmp_path / "out" / "report.json").read_text(encoding="utf-8"))
    assert report["repair"]["flipped_faces"] == [3, 17, 20]
    assert report["repair"]["duplicate_faces"] == [[48, 5]]
    assert report["mesh"]["pieces"] == 1
    assert report["input"]["path"] == str(path)
    assert report["panels"]["written"] == 48
    assert any("turned over 3 faces" in text for text in report["warnings"])
    graph = Graph.load(tmp_path / "out" / "graph.json")
    with pytest.warns(NodeWarning, match="turned over 3 faces"):
        assert graph.run("mesh.mesh").n_faces == 48


def test_a_clean_mesh_is_panelled_alike_with_and_without_repair(tmp_path: Path) -> None:
    path = write_mesh(DOME, tmp_path / "dome.obj")
    plain, repaired = (
        panel_graph(PanelOptions(mesh=path, repair=repair)).run("panels.panels", "description")
        for repair in (False, True)
    )
    for name in ("spheres", "plane_normals", "corners", "neighbors"):
        assert np.array_equal(getattr(plain[0], name), getattr(repaired[0], name))
    assert plain[1].repair == repaired[1].repair == {}
    assert plain[1].is_mesh


def test_what_is_partly_apart_says_what_repair_would_do(tmp_path: Path) -> None:
    faces = faces_of(DOME)
    points = [*DOME.vertices.tolist(), DOME.vertices[faces[0][0]].tolist()]
    faces[0][0] = len(points) - 1
    graph = panel_graph(PanelOptions(mesh=write_obj(tmp_path / "a.obj", points, faces)))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NodeWarning)  # of the reader
        report = graph.run("description")
    assert "--repair would weld 1 place" in describe_lines(report)[1]


SQUARE = [
    [0, 0, 0],
    [3, 0, 0],
    [3, 3, 0],
    [0, 3, 0],
    [1, 1, 0],
    [2, 1, 0],
    [2, 2, 0],
    [1, 2, 0],
]


@pytest.mark.parametrize(
    ("faces", "cause"),
    [
        ([[0, 1, 2, 3, 0, 4, 7, 6, 5, 4]], "face 0 (line 9) has a hole"),
        ([[0, 1, 2, 3], [3, 2, 1, 0]], "face 1 (line 10) repeats face 0 (line 9) turned over"),
        ([[0, 1, 2], [2, 3, 0], [0, 1, 5], [7, 1, 0]], "edge 0-1 is non-manifold"),
        ([[0, 1, 5], [1, 2, 5], [2, 5, 6]], "normals of 1 of 3 faces [2] disagree"),
        ([[0, 1, 4], [4, 5, 6]], "vertex 4 is non-manifold"),
    ],
)
def test_the_true_cause_is_named(faces: list[list[int]], cause: str, tmp_path: Path) -> None:
    result = panel(write_obj(tmp_path / "a.obj", SQUARE, faces), tmp_path / "out")
    assert result.exit_code == 3
    assert cause in result.stderr
    assert "--repair" in result.stderr
    assert "Traceback" not in result.stderr


def test_corners_that_coincide_are_named(tmp_path: Path) -> None:
    points = [*SQUARE[:4], SQUARE[0]]
    path = write_obj(tmp_path / "a.obj", points, [[0, 1, 2, 4], [2, 3, 4]])
    result = panel(path, tmp_path / "out")
    assert result.exit_code == 3
    assert (
        "two corners of faces [0 (line 6)] coincide, such as vertices 4 and 0" in result.stderr
    )
