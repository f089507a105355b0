"""Creases: where a surface turns too sharply to be taken for smooth."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spheremesh import Mesh
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.creases import crease_edges, edge_turns, joined_parts


def prism(sides: int) -> Mesh:
    """A tube of a regular polygon, one row of quads."""
    turn = 2 * np.pi / sides * np.arange(sides)
    ring = np.stack([np.cos(turn), np.sin(turn)], 1)
    points = np.concatenate([np.c_[ring, np.full(sides, z)] for z in (0.0, 1.0)])
    following = np.roll(np.arange(sides), -1)
    faces = np.stack([np.arange(sides), following, following + sides, np.arange(sides) + sides])
    return Mesh(points, faces.T)


@given(angle=st.floats(-3.0, 3.0))
def test_turns_of_a_fold(angle: float) -> None:
    c, s = np.cos(angle), np.sin(angle)
    points = [[-1, 0, 0], [0, 0, 0], [c, 0, s], [-1, 1, 0], [0, 1, 0], [c, 1, s]]
    turn = edge_turns(Mesh(points, [[0, 1, 4, 3], [1, 2, 5, 4]]))
    assert turn == pytest.approx([abs(angle)], abs=1e-12)


@pytest.mark.parametrize("sides", [9, 12, 18])
def test_turns_equal_to_the_angle_are_no_creases_anywhere(sides: int) -> None:
    """A tube of nine sides turns by 40 degrees at every edge, but for rounding."""
    mesh = prism(sides)
    angle = 2 * np.pi / sides
    rng = np.random.default_rng(0)
    for _ in range(20):
        frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        frame *= np.sign(np.linalg.det(frame))
        moved = Mesh(1e3 * mesh.vertices @ frame + 1e4 * rng.normal(size=3), mesh.faces)
        assert not crease_edges(moved, angle).any()
        assert crease_edges(moved, angle - 1e-3).all()


def test_no_edge_turns_by_more_than_a_half_turn() -> None:
    folded = Mesh([[-1, 0, 0], [0, 0, 0], [-1, 1, 0], [0, 1, 0], [-1, 0.5, 0]],
                  [[0, 1, 3, 2], [1, 4, 3]])  # fmt: skip
    assert edge_turns(folded) == pytest.approx([np.pi])
    assert not crease_edges(folded, np.pi).any()
    assert crease_edges(folded, np.radians(179)).all()


@pytest.mark.parametrize("angle", [-0.1, 3.2, np.nan])
def test_crease_angles_lie_between_0_and_180_degrees(angle: float) -> None:
    with pytest.raises(InputError, match="between 0 and 180 degrees"):
        crease_edges(prism(5), angle)


def test_parts_hang_together_by_their_edges() -> None:
    mesh = prism(6)
    joins = np.zeros(len(mesh.topology.edge_corners), bool)
    assert joined_parts(mesh, joins).tolist() == list(range(6))
    assert joined_parts(mesh, ~joins).tolist() == [0] * 6
    joins[0] = True
    labels = joined_parts(mesh, joins)
    left, right = mesh.topology.edge_faces[0]
    assert labels[left] == labels[right]
    assert labels.max() == 4
