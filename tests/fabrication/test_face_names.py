"""Errors of meshes from files name faces as the user knows them: by line or by object."""

import numpy as np
import pytest

from spheremesh.fabrication.polygons import Polygons, to_mesh
from spheremesh.kernel.errors import InputError

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0, 1]], float)
FACES = np.array([0, 1, 2, 0, 2, 3, 1, 0, 4, 0, 1, 3])
SOURCES = (("mesh 'shell' on layer 'Roof'", 2), ("mesh 'wall' on layer 'Walls'", 2))


def test_faces_are_named_by_their_object() -> None:
    with pytest.raises(InputError) as error:
        to_mesh(Polygons(POINTS, FACES, np.full(4, 3)), SOURCES)
    message = str(error.value)
    assert "0 (mesh 'shell' on layer 'Roof')" in message
    assert "2 (mesh 'wall' on layer 'Walls'), 3 (mesh 'wall' on layer 'Walls')" in message


def test_faces_are_named_by_their_line() -> None:
    lines = np.array([7, 8, 9, 12])
    with pytest.raises(InputError, match=r"\[0 \(line 7\), 2 \(line 9\), 3 \(line 12\)\]"):
        to_mesh(Polygons(POINTS, FACES, np.full(4, 3), (), lines))


def test_long_lists_are_cut() -> None:
    fan = np.array([[0, 1, 2 + i] for i in range(30)])
    with pytest.raises(InputError, match=r"7 \(line 7\), \.\.\. 22 more\]"):
        to_mesh(
            Polygons(
                np.random.default_rng(0).normal(size=(32, 3)),
                fan.ravel(), np.full(30, 3), (), np.arange(30),
            )
        )  # fmt: skip
