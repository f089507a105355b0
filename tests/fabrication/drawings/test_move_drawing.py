"""The drawing of the design and the moves of its vertices, read back."""

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.fabrication.drawings.moves import layout_moves, write_move_drawing
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import mean_edge_length, with_vertices
from spheremesh.nodes import roof_mesh, vase_mesh

ROOF = roof_mesh(4, 5)


def moved(mesh: Mesh, size: float = 0.02) -> tuple[Mesh, np.ndarray]:
    """Every vertex but the first moved by up to a share of the mean edge."""
    rng = np.random.default_rng(0)
    moves = rng.uniform(-1, 1, mesh.vertices.shape)
    moves *= size * mean_edge_length(mesh) / np.linalg.norm(moves, axis=1).max()
    moves[0] = 0
    return with_vertices(mesh, mesh.vertices + moves), np.linalg.norm(moves, axis=1)


@pytest.mark.parametrize("mesh", [ROOF, vase_mesh(6, 4)], ids=["open", "standing"])
def test_every_edge_and_every_move_is_drawn(mesh: Mesh, tmp_path: Path) -> None:
    import ezdxf

    after, lengths = moved(mesh)
    document = ezdxf.readfile(write_move_drawing(mesh, after, tmp_path / "moves.dxf").path)
    assert not document.audit().errors
    model = document.modelspace()
    topology = mesh.topology
    n_edges = len(topology.edge_corners) + int((topology.twins < 0).sum())
    assert len(model.query("LWPOLYLINE[layer=='PLAN']")) == n_edges
    radii = [circle.dxf.radius for circle in model.query("CIRCLE[layer=='MARK']")]
    factor = 0.4 * 1000 * mean_edge_length(mesh) / lengths.max() / 1000
    np.testing.assert_allclose(radii, 1000 * factor * lengths[1:], rtol=1e-3)
    texts = [text.dxf.text for text in model.query("TEXT")]
    assert f"up to {1000 * lengths.max():.3g} mm (0.02 mean edges" in texts[0]
    assert f"at vertex {lengths.argmax()}" in texts[0]
    assert f"{factor:.3g} times" in texts[1]


def test_an_open_mesh_is_seen_from_its_front() -> None:
    """A wall stands upright on the paper, and nothing is foreshortened."""
    wall = Mesh([[0, 0, 0], [3, 0, 0], [3, 0, 2], [0, 0, 2]], [[0, 1, 2, 3]])
    drawing = layout_moves(wall, wall)
    points = np.array([point[:2] for line in drawing.lines for point in line.points])
    np.testing.assert_allclose(np.ptp(points, axis=0), [3000, 2000])
    upper = points[points[:, 1] > 0]
    assert len(upper) == 4


def test_units_and_place_change_little() -> None:
    after, _ = moved(ROOF)
    drawing = layout_moves(ROOF, after)
    away, there = (Mesh(1000 * each.vertices + 5e4, each.faces) for each in (ROOF, after))
    same = layout_moves(away, there, "mm")
    radii, expected = ([circle.radius for circle in each.circles] for each in (same, drawing))
    np.testing.assert_allclose(radii, expected, rtol=1e-6)
    assert [text.text for text in same.texts] == [text.text for text in drawing.texts]


def test_what_did_not_move_is_said(tmp_path: Path) -> None:
    path = write_move_drawing(ROOF, ROOF, tmp_path / "moves.svg").path
    root = ElementTree.parse(path).getroot()  # noqa: S314
    texts = [text.text for text in root.iter("{http://www.w3.org/2000/svg}text")]
    assert texts == ["No vertex was moved."]
    assert not list(root.iter("{http://www.w3.org/2000/svg}circle"))


def test_two_meshes_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="not of two meshes"):
        write_move_drawing(ROOF, roof_mesh(4, 4), tmp_path / "moves.svg")
    with pytest.raises(InputError, match="pdf"):
        write_move_drawing(ROOF, ROOF, tmp_path / "moves.pdf")
    assert not list(tmp_path.iterdir())
