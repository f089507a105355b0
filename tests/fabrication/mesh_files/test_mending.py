"""What readers mend and say: unwelded faces, slivers, lost digits, cut files."""

from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spheremesh import Graph, Mesh
from spheremesh.fabrication.mesh_files.reader import read_content, read_mesh
from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.fabrication.polygons import FileContent
from spheremesh.kernel.errors import InputError
from spheremesh.nodes import NodeWarning
from spheremesh.nodes import read_mesh as read_mesh_node

ErrorOf: TypeAlias = Callable[..., str]
Content: TypeAlias = Callable[..., FileContent]


def grid(n: int = 3, m: int = 4) -> Mesh:
    """A net of quads over a curved surface."""
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(m + 1.0), indexing="ij")
    points = np.stack([x, y, np.sin(x) + y**2 / 9], axis=-1).reshape(-1, 3)
    ids = np.arange(len(points)).reshape(n + 1, m + 1)
    quads = [ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]]
    return Mesh(points, np.stack(quads, axis=-1).reshape(-1, 4))


def alone(mesh: Mesh) -> Mesh:
    """The same faces, each with vertices of its own."""
    return Mesh(
        mesh.vertices[mesh.corners], np.arange(len(mesh.corners)).reshape(mesh.n_faces, -1)
    )


def points_of(mesh: Mesh) -> np.ndarray:
    return mesh.vertices[mesh.corners]


@pytest.mark.parametrize("suffix", [".obj", ".off", ".ply"])
@settings(max_examples=15, deadline=None)
@given(n=st.integers(1, 4), m=st.integers(2, 4), far=st.sampled_from([0.0, 1e6 / 7]))
def test_faces_that_share_no_vertex_are_joined_where_they_are_equal(
    tmp_path_factory: pytest.TempPathFactory, suffix: str, n: int, m: int, far: float
) -> None:
    mesh = grid(n, m)
    mesh = Mesh(mesh.vertices * np.pi + far, mesh.faces)
    path = write_mesh(alone(mesh), tmp_path_factory.mktemp("alone") / f"a{suffix}")
    found = read_content(path)
    assert len(found.remarks) == 1
    assert f"{4 * mesh.n_faces} were joined to {mesh.n_vertices}" in found.remarks[0]
    back = read_mesh(path)
    assert back.n_vertices == mesh.n_vertices
    assert np.array_equal(points_of(back), points_of(mesh))


def test_faces_that_nearly_meet_stay_alone_and_it_is_said(content: Content) -> None:
    lone = alone(grid())
    rng = np.random.default_rng(1)
    noisy = lone.vertices + rng.uniform(1e-9, 2e-9, lone.vertices.shape)
    text = "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in noisy.tolist())
    text += "".join("f " + " ".join(map(str, face + 1)) + "\n" for face in lone.faces)
    found = content("a.obj", text)
    assert len(found.polygons.vertices) == len(noisy)
    assert ["repair_mesh" in each for each in found.remarks] == [True]


def test_one_face_and_faces_that_share_are_not_called_unwelded(content: Content) -> None:
    assert content("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").remarks == ()
    assert content("b.obj", TWO_TRIANGLES).remarks == ()


TWO_TRIANGLES = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"


def test_vertices_that_coincide_and_are_not_joined_are_counted(content: Content) -> None:
    text = TWO_TRIANGLES + "v 1 1 0\nv 2 0 0\nf 2 6 5\n"
    found = content("a.obj", text)
    assert len(found.polygons.vertices) == 6
    assert [each.startswith("1 vertex lies") for each in found.remarks] == [True]


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.obj", TWO_TRIANGLES + "f 3 4 4\n"),
        ("a.off", "OFF\n4 3 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n3 2 3 3\n"),
    ],
)
def test_slivers_are_left_out_and_said_with_their_lines(
    content: Content, name: str, text: str
) -> None:
    found = content(name, text)
    assert found.polygons.degrees.tolist() == [3, 3]
    number = text.count("\n")
    assert [f"lines [{number}]" in each for each in found.remarks] == [True]
    assert "no area" in found.remarks[0]


def test_slivers_of_binary_files_are_said_with_their_numbers(
    content: Content, tmp_path: Path
) -> None:
    triangles = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    data = bytearray(write_mesh(triangles, tmp_path / "a.stl").read_bytes())
    sliver = np.zeros(12, "<f4")
    sliver[3:] = [0, 0, 0, 1, 0, 0, 1, 0, 0]
    data[80:84] = (3).to_bytes(4, "little")
    found = content("b.stl", bytes(data) + sliver.tobytes() + bytes(2))
    assert found.polygons.degrees.tolist() == [3, 3]
    assert "faces [2]" in found.remarks[0]


@pytest.mark.parametrize("face", ["1 2 1 4", "1 2 5 5"])
def test_a_corner_named_twice_in_a_larger_face_is_refused(error_of: ErrorOf, face: str) -> None:
    message = error_of("a.obj", "v 5 5 5\n" + TWO_TRIANGLES + f"f {face}\n")
    assert "line 8" in message
    assert "repeated corner" in message


def test_a_sentence_for_vertices_that_no_face_uses(content: Content) -> None:
    found = content("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nv 6 6 6\nf 1 2 3\n")
    assert found.remarks == (
        "2 vertices belong to no face: lines [4, 5]; check that no faces are missing",
    )


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.obj", TWO_TRIANGLES),
        ("a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"),
        (
            "a.ply",
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n"
            "property double z\nelement face 2\nproperty list uchar int vertex_indices\n"
            "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
        ),
    ],
)
def test_a_last_line_without_end_is_said(content: Content, name: str, text: str) -> None:
    assert content(name, text).remarks == ()
    found = content(name, text[:-1])
    assert ["no end" in each for each in found.remarks] == [True]
    assert content(name, text.replace("\n", "\r\n")).remarks == ()


PLY_TEXT = """ply
format ascii 1.0
element vertex 6
property double x
property double y
property double z
element face 3
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
10.5 1 0
0 1 0
2 0 0
2 1 0
4 0 1 2 3
3 1 4 5
3 1 5 2
"""
OFF_TEXT = "OFF\n6 3 0\n" + PLY_TEXT.partition("end_header\n")[2]
OBJ_TEXT = (
    "v 0 0 0\nv 1 0 0\nv 10.5 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nf 2 5 6\nf 1 2 3 4\nf 2 6 3\n"
)


@pytest.mark.parametrize(
    ("name", "text"), [("a.obj", OBJ_TEXT), ("a.off", OFF_TEXT), ("a.ply", PLY_TEXT)]
)
def test_text_cut_anywhere_is_refused_or_said_or_has_lost_nothing(
    content: Content, name: str, text: str
) -> None:
    whole = content(name, text)
    assert whole.remarks == ()
    silent = []
    for size in range(1, len(text)):
        try:
            found = content(name, text[:size])
        except InputError:
            continue
        if not found.remarks:
            silent.append(text[:size])
    # What no reader can know: an OBJ file cut at the end of a line, all its vertices used.
    assert silent == ([OBJ_TEXT.removesuffix("f 2 6 3\n")] if name == "a.obj" else [])


def rounded(digits: int, *, far: float) -> str:
    mesh = grid(5, 6)
    points = mesh.vertices + np.array([far / 12, far, 0.0])
    text = "".join(f"v {x:.{digits}g} {y:.{digits}g} {z:.{digits}g}\n" for x, y, z in points)
    return text + "".join("f " + " ".join(map(str, face + 1)) + "\n" for face in mesh.faces)


def test_coordinates_that_rounding_has_spoiled_are_named(
    content: Content, error_of: ErrorOf
) -> None:
    message = error_of("a.obj", rounded(6, far=5.4e6))
    assert "6 significant digits" in message
    assert "rounded to 10" in message
    assert "origin" in message
    assert content("b.obj", rounded(6, far=5.4e3)).remarks == ()
    found = content("c.obj", rounded(6, far=5.4e4))
    assert ["rounded to 0.1" in each for each in found.remarks] == [True]
    assert content("d.obj", rounded(17, far=5.4e6)).remarks == ()
    assert content("e.obj", rounded(6, far=0.0)).remarks == ()


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_lost_digits_do_not_depend_on_units(content: Content, scale: float) -> None:
    mesh = grid(5, 6)
    for far, count in ((5.4e4, 1), (5.4e1, 0)):
        points = (mesh.vertices + np.array([0, far, 0])) * scale
        text = "".join(f"v {x:.6g} {y:.6g} {z:.6g}\n" for x, y, z in points)
        text += "".join("f " + " ".join(map(str, face + 1)) + "\n" for face in mesh.faces)
        assert len(content("a.obj", text).remarks) == count


def test_single_precision_far_from_the_origin_is_named(content: Content) -> None:
    mesh = grid(5, 6)
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {mesh.n_vertices}\n"
        f"property float x\nproperty float y\nproperty float z\nelement face {mesh.n_faces}\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    faces = b"".join(b"\x04" + face.astype("<i4").tobytes() for face in mesh.faces)
    for far, count in ((0.0, 0), (4e5, 1)):
        points = (mesh.vertices + np.array([0, far, 0])).astype("<f4").tobytes()
        found = content("a.ply", header.encode() + points + faces)
        assert len(found.remarks) == count
    assert "single precision" in found.remarks[0]


def test_numbers_written_by_hand_are_not_called_rounded(content: Content) -> None:
    text = "".join(f"v {100 + 2 * i} 0 4.475\nv {100 + 2 * i} 2 4.5\n" for i in range(4))
    text += "".join(f"f {i} {i + 2} {i + 3} {i + 1}\n" for i in (1, 3, 5))
    assert content("a.obj", text).remarks == ()


def test_the_largest_numbers_do_no_harm(content: Content) -> None:
    text = "v 0 0 0\nv 1.23456e308 0 0\nv 0 -1.23456e308 0\nf 1 2 3\n"
    assert content("a.obj", text).remarks == ()


def test_the_node_hands_remarks_on(tmp_path: Path) -> None:
    path = write_mesh(alone(grid()), tmp_path / "a.obj")
    with pytest.warns(NodeWarning, match="vertices of its own"):
        assert read_mesh_node(path).n_vertices == grid().n_vertices
    graph = Graph("remarks")
    step = graph.add("read_mesh", path=str(path))
    with pytest.warns(NodeWarning):
        graph.run(step)
    assert ["vertices of its own" in each for each in graph.messages[step.name]] == [True]
