"""Fingerprints by content."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import spheremesh as sm
from spheremesh.nodes.graphs.stores.digests import digest


@dataclass(frozen=True)
class Record:
    """Two things."""

    a: object
    b: object = None


@dataclass(frozen=True)
class Other:
    """Two things as well."""

    a: object
    b: object = None


class Keyed:
    """Says itself what it holds."""

    def __init__(self, text: str) -> None:
        self.text = text

    def content_key(self) -> bytes:
        """The text."""
        return self.text.encode()


SAME: list[tuple[Any, Any]] = [
    ({"a": 1, "b": 2}, {"b": 2, "a": 1}),
    ([1, (2, 3)], (1, [2, 3])),
    ({1, 2, 3}, frozenset([3, 2, 1])),
    (np.arange(6).reshape(2, 3), np.asfortranarray(np.arange(6).reshape(2, 3))),
    (np.arange(10)[::2], np.array([0, 2, 4, 6, 8])),
    (np.float64(0.1), 0.1),
    (Path("a/b"), "a/b"),
    (Record(np.zeros(3)), Record(np.zeros(3))),
    (Keyed("a"), Keyed("a")),
    (float("nan"), float("nan")),
    (
        sm.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
        sm.Mesh(np.array([[0, 0, 0], [1, 0, 0], [0, 1.0, 0]]), np.array([[0, 1, 2]])),
    ),
]
DIFFERENT: list[Any] = [
    None, True, False, 0, 1, 0.0, -0.0, 1.0, "", "1", "None", b"", b"1", [], [[]], [1, 2], [12],
    [[1], 2], ["a", "b"], ["ab"], ["ab", ""],
    {}, {"a": "b"}, {"b": "a"}, {"a": {"b": 1}},
    {"a"}, np.zeros(0), np.zeros(2), np.zeros((2, 1)), np.zeros((1, 2)),
    np.zeros(2, np.float32), np.zeros(2, np.int64), np.array(["a"]), np.array(0.0),
    np.zeros((0, 3)),
    Record(1), Record(1, 1),
    Record(None, 1), Other(1), Keyed("a"), Keyed(""), 1j, float("nan"), float("inf"),
    sm.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
    sm.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1, 2, 0]]),
]  # fmt: skip


@pytest.mark.parametrize(("a", "b"), SAME)
def test_equal_contents(a: Any, b: Any) -> None:  # noqa: ANN401
    assert digest(a) == digest(b)


def test_different_contents() -> None:
    digests = [digest(value) for value in DIFFERENT]
    clashes = [
        (DIFFERENT[i], DIFFERENT[j])
        for i in range(len(digests))
        for j in range(i)
        if digests[i] == digests[j]
    ]
    assert clashes == []


@pytest.mark.parametrize(
    "value", [object(), len, [object()], {"a": len}, Record(len), np.array([None])]
)
def test_what_has_no_content(value: Any) -> None:  # noqa: ANN401
    with pytest.raises(TypeError, match="cannot be told from another by its content"):
        digest(value)
