"""Toy nodes that several tests of graphs share; each test registers those that it needs."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

import spheremesh as sm
from spheremesh.nodes import Port
from spheremesh.nodes.graphs.node import running_graph


class Parts(NamedTuple):
    """Low and high."""

    low: float
    high: float


def split(value: float) -> Parts:
    return Parts(value / 4, 3 * value / 4)


def mix(
    a: float,
    weights: NDArray[np.float64] | None = None,
    facts: Mapping[str, Any] | None = None,
    limit: float = 1.0,
    name: str = "",
) -> float:
    total = 0.0 if weights is None else float(weights.sum())
    return a + total + len(facts or {}) + min(limit, 100) + len(name)


def quote_graph() -> str:
    return running_graph()


class Blob:
    """Has a content, but no form in JSON."""

    def content_key(self) -> bytes:
        """Equal for all."""
        return b""


def use_blob(blob: Blob) -> str:
    return running_graph() + type(blob).__name__


def mixed_graph() -> sm.Graph:
    """A graph of all that a file can hold of values."""
    g = sm.Graph("Dachfläche", units="mm")
    k = g.param("k", 8, min=1, max=60)
    g.param("kind", "best", choices=["best", "fast"])
    parts = g.add(split, value=k)
    g.add(
        mix, "mixed", name="x", a=parts.high, limit=float("inf"), facts={"a": [1, None]},
        weights=np.array([[1.5, 2.5]]),
    )  # fmt: skip
    g.add(mix, "mapped", a=sm.each([1, parts.low, k]), weights=[1, 2])
    return g


class Shape:
    """Something that has a content."""

    def content_key(self) -> bytes:
        """Equal for all."""
        return b""


class Round(Shape):
    """A kind of shape."""


class Fit(NamedTuple):
    """A shape and its report."""

    shape: Round
    report: Mapping[str, Any]


def read_shape(path: str) -> Shape:
    return Shape() if path else Round()


def fit_shape(shape: Shape, ring: Annotated[int, Port(min=0, max=5, unit="steps")] = 1) -> Fit:
    return Fit(Round(), {"ring": ring, "of": str(shape)})


def measure(
    shape: Round, kind: Literal["area", "length"] = "area", labels: Sequence[int] | None = None
) -> float:
    return len(kind) + len(labels or ()) + float(isinstance(shape, Round))


def pick(kind: Annotated[str, Port(choices=("a", "b"))]) -> str:
    return kind


def translate(offset: tuple[float, float, float]) -> tuple[float, float, float]:
    return offset


def to_path(path: Path) -> Path:
    return path / "x"


def to_text(text: str) -> str:
    return text.upper()
