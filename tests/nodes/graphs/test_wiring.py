"""Errors when wired: both ends are named, and the nearest valid name."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from graph_toys import (
    Round,
    Shape,
    fit_shape,
    measure,
    pick,
    read_shape,
    to_path,
    to_text,
    translate,
)
from numpy.typing import NDArray

import spheremesh as sm
from spheremesh.nodes import GraphError, NodeError, node


@pytest.fixture(autouse=True)
def toys() -> None:
    """Register the toys for one test."""
    for function in (read_shape, fit_shape, measure, pick, translate, to_path, to_text):
        node(function)


Wiring = Callable[[sm.Graph], object]

MISTAKES: list[tuple[Wiring, str]] = [
    (
        lambda g: g.add("fit_shapes"),
        "unknown node 'fit_shapes'; did you mean 'fit_shape'?",
    ),
    (
        lambda g: g.add(fit_shape, shap=1),
        "step 'fit_shape_2' (node fit_shape) has no input 'shap'; did you mean 'shape'?",
    ),
    (
        lambda g: g.add(fit_shape, "mine"),
        "step 'mine' (node fit_shape) misses its input 'shape' (Shape)",
    ),
    (
        lambda g: g.add(fit_shape, shape=g.wire("read_shape"), ring=1.5),
        "fit_shape_2.ring = 1.5: must be int",
    ),
    (
        lambda g: g.add(fit_shape, shape=g.wire("read_shape"), ring=6),
        "fit_shape_2.ring = 6: must be at least 0 and at most 5 steps",
    ),
    (
        lambda g: g.add(fit_shape, shape=g.wire("read_shape"), ring=g.param("n", -1)),
        "param n for fit_shape_2.ring = -1: must be at least 0 and at most 5 steps",
    ),
    (
        lambda g: g.add(measure, shape=g.wire("fit_shape")),
        "cannot wire fit_shape into measure.shape: it has several outputs; "
        "choose fit_shape.shape",
    ),
    (
        lambda g: g.add(pick, kind=g.wire("fit_shape")),
        "cannot wire fit_shape into pick.kind: it has several outputs; none is str",
    ),
    (
        lambda g: g.add(measure, shape=g.wire("read_shape")),
        "cannot wire read_shape.result (Shape) into measure.shape (Round)",
    ),
    (
        lambda g: g.add(measure, shape=g.wire("fit_shape").report),
        "cannot wire fit_shape.report (Mapping) into measure.shape (Round); "
        "fit_shape.shape would fit",
    ),
    (
        lambda g: g.add(measure, shape=Shape()),
        "must be Round",
    ),
    (
        lambda g: g.add(measure, shape=Round(), kind="volume"),
        "measure.kind = 'volume': must be 'area' or 'length'",
    ),
    (
        lambda g: g.add(measure, shape=Round(), labels=["x"]),
        "measure.labels = ['x']: must be Sequence of int or None",
    ),
    (
        lambda g: g.add(measure, shape=Round(), labels=[1, g.wire("fit_shape").report]),
        "cannot wire fit_shape.report (Mapping) into measure.labels[1] (int)",
    ),
    (
        lambda g: g.add(measure, shape=[g.wire("fit_shape").shape]),
        "measure.shape: a list, must be Round; use each(...)",
    ),
    (lambda g: g.add(pick, kind="c"), "pick.kind = 'c': must be one of 'a', 'b'"),
    (
        lambda g: g.add(translate, offset=[1, 2]),
        "translate.offset = [1, 2]: must be tuple of 3",
    ),
    (lambda g: g.wire("fit_shape").raport, "has no output 'raport'; did you mean 'report'?"),
    (lambda g: g.wire("fit_shap.report"), "no step 'fit_shap'; did you mean 'fit_shape'?"),
    (lambda g: g.run("fit_shape.ring"), "has no output 'ring'; there are shape, report"),
    (lambda g: g.run(), "run needs a target; there are read_shape, fit_shape"),
    (
        lambda g: g.add(measure, shape=sm.Graph().add(fit_shape, shape=Shape()).shape),
        "fit_shape.shape is part of another graph",
    ),
    (
        lambda g: g.add(fit_shape, shape=Shape(), ring=sm.Graph().param("k", 1)),
        "k is part of another graph",
    ),
    (
        lambda g: g.run(sm.Graph().add(read_shape, path="")),
        "read_shape is part of another graph",
    ),
    (lambda g: g.add(read_shape, "fit_shape", path=""), "there is a step 'fit_shape' already"),
    (lambda g: g.add(read_shape, "a.b", path=""), "step name 'a.b': use letters, digits"),
    (lambda g: g.param("a b", 1), "param name 'a b': use letters, digits"),
    (lambda g: [g.param("k", 1), g.param("k", 2)], "there is a param 'k' already"),
    (lambda g: g.param("k", 3, max=2), "param k = 3: must be at most 2"),
    (lambda g: g.param("k", float("nan"), max=2), "param k = nan: must be at most 2"),
    (lambda g: g.param("k", 3, choices=[1, 2]), "param k = 3: must be one of 1, 2"),
    (
        lambda g: [g.param("moulds", 1), g.set(mould=2)],
        "no param 'mould'; did you mean 'moulds'?",
    ),
]


@pytest.mark.parametrize(("wiring", "message"), MISTAKES, ids=[text for _, text in MISTAKES])
def test_mistakes_are_told_when_made(wiring: Wiring, message: str) -> None:
    g = sm.Graph()
    g.add(fit_shape, shape=g.add(read_shape, path="x"))
    with pytest.raises(GraphError) as error:
        wiring(g)
    assert message in str(error.value)
    assert list(g.steps) == ["read_shape", "fit_shape"]


def test_a_wrong_value_moves_no_slider() -> None:
    g = sm.Graph()
    n, m = g.param("n", 1), g.param("m", 1, max=3)
    g.add(fit_shape, shape=Shape(), ring=n)
    with pytest.raises(GraphError, match=r"param n for fit_shape\.ring = 9: .* at most 5"):
        g.set(m=2, n=9)
    with pytest.raises(GraphError, match="param m = 4: must be at most 3"):
        g.set(n=2, m=4)
    assert g.run(n, m) == (1, 1)
    g.set(n=np.int64(4))
    assert type(g.params["n"].value) is int


def test_hasattr_works_on_steps() -> None:
    step = sm.Graph().add(read_shape, path="x")
    assert hasattr(step, "result")
    assert not hasattr(step, "shape")


def test_names_of_inputs_cannot_collide() -> None:
    @node
    def odd(self: int, node: int, name: int) -> int:
        return self + node + name

    g = sm.Graph()
    assert g.run(g.add(odd, "mine", self=1, node=2, name=3)) == 6


def test_a_list_of_wires_that_is_no_array_is_refused_by_name() -> None:
    @node
    def shape_of(numbers: NDArray[np.float64]) -> int:
        return numbers.size

    @node
    def pair() -> list[Any]:
        return [1.0, 2.0]

    g = sm.Graph()
    g.add(shape_of, numbers=[1.0, g.add(pair)])
    with pytest.raises(NodeError, match=r"shape_of\.numbers = .*: must be float64 array"):
        g.run("shape_of")


def test_an_item_that_an_input_does_not_accept_is_refused_by_name() -> None:
    @node
    def rows() -> NDArray[np.float64]:
        return np.eye(3)

    @node
    def twice(number: float) -> float:
        return 2 * number

    g = sm.Graph()
    g.add(twice, number=sm.each(g.add(rows)))
    with pytest.raises(NodeError, match=r"twice\.number = .*: must be float"):
        g.run("twice")
