"""Arrays on their way into a function: shape, kind and size of numbers, counts that agree."""

from collections.abc import Callable
from typing import Annotated, Any, ClassVar, TypeAlias

import numpy as np
import pytest
from numpy.typing import NDArray

from spheremesh import Graph
from spheremesh.nodes import GraphError, NodeError, node
from spheremesh.nodes.graphs.annotations import ArrayFacts

Floats: TypeAlias = NDArray[np.float64]
Points: TypeAlias = Annotated[Floats, ArrayFacts("points", ("N", 3))]
Numbers: TypeAlias = Annotated[Floats, ArrayFacts("numbers", ("N",))]
Vector: TypeAlias = Annotated[Floats, ArrayFacts("vector", (3,))]
Labels: TypeAlias = Annotated[NDArray[np.int64], ArrayFacts("labels of faces", ("F",))]


class Net:
    """A record that says how many faces it has."""

    counts: ClassVar = {"F": 4}


@pytest.fixture(autouse=True)
def toys() -> None:
    """Nodes that give back what they were given."""

    @node
    def points(given: Points) -> Points:
        return given

    @node
    def vector(given: Vector) -> Vector:
        return given

    @node
    def weighed(points: Points, weights: float | Numbers = 1.0) -> Points:
        return points * np.asarray(weights)[..., None]

    @node
    def net() -> Net:
        return Net()

    @node
    def labelled(net: Net, labels: Labels) -> Labels:
        assert net.counts["F"] == len(labels)
        return labels

    @node
    def anything(given: Any) -> Any:  # noqa: ANN401
        return given

    @node
    def number(given: float) -> float:
        return given


def result(name: str, **inputs: object) -> object:
    graph = Graph()
    graph.add(name, "s", **inputs)
    return graph.run("s")


@pytest.mark.parametrize(
    ("given", "dtype"),
    [([], float), ([[1, 2, 3]], float), (np.ones((2, 3), np.int8), float)],
)
def test_an_array_comes_in_its_shape_and_type(given: object, dtype: type) -> None:
    found = result("points", given=given)
    assert isinstance(found, np.ndarray)
    assert found.shape == (len(np.asarray(given)), 3)
    assert found.dtype == dtype


@pytest.mark.parametrize(
    "given",
    [[[]], [1.0], [[1, 2], [3]], np.array([["a", "b", "c"]]), np.ones((1, 3)) * 1j],
    ids=["no columns", "flat", "ragged", "texts", "complex"],
)
def test_other_arrays_are_refused(given: object) -> None:
    with pytest.raises(GraphError, match=r"s\.given = .*: must be points \(N, 3\)"):
        result("points", given=given)


def test_no_rows_are_no_vector() -> None:
    with pytest.raises(GraphError, match=r"must be vector \(3,\)"):
        result("vector", given=[])


@pytest.mark.parametrize("given", [np.zeros(2), [[1.0]], ["a"]], ids=["array", "list", "texts"])
def test_what_comes_by_wire_is_looked_at_when_it_is_there(given: object) -> None:
    graph = Graph()
    source = graph.add("anything", "source", given=given)
    graph.add("points", "s", given=source)
    with pytest.raises(NodeError, match=r"s\.given = .* must be points \(N, 3\)") as caught:
        graph.run("s")
    assert isinstance(caught.value.cause, GraphError)


def test_counts_agree_or_one_stands_for_all() -> None:
    three = np.ones((3, 3))
    for weights in (2.0, [2.0], [2.0, 2.0, 2.0]):
        found = result("weighed", points=three, weights=weights)
        assert np.array_equal(np.asarray(found), 2 * three)
    assert np.shape(np.asarray(result("weighed", points=three[:1], weights=[1.0, 2.0]))) == (
        2,
        3,
    )
    for weights in ([], [1.0, 2.0]):
        with pytest.raises(
            NodeError, match=rf"s.weights: numbers for {len(weights)}, but s.po"
        ):
            result("weighed", points=three, weights=weights)


@pytest.mark.parametrize("count", [0, 1, 3, 5])
def test_a_record_knows_its_counts(count: int) -> None:
    graph = Graph()
    whole = graph.add("net")
    graph.add("labelled", "s", net=whole, labels=[1, 2, 3, 4])
    assert np.array_equal(np.asarray(graph.run("s")), [1, 2, 3, 4])
    graph.add("labelled", "t", net=whole, labels=[1] * count)
    with pytest.raises(NodeError, match=f"labels of faces for {count}, but t.net has 4"):
        graph.run("t")


def test_whole_numbers_are_labels_and_others_are_not() -> None:
    graph = Graph()
    whole = graph.add("net")
    graph.add("labelled", "s", net=whole, labels=[0.0, 1.0, 2.0, 3.0])
    assert np.asarray(graph.run("s")).dtype == np.int64
    for bad in ([0.5, 1, 2, 3], [np.nan, 1, 2, 3], [1e300, 1, 2, 3]):
        with pytest.raises(GraphError, match="must be labels of faces"):
            graph.add("labelled", net=whole, labels=bad)


NO_SIZES: list[tuple[str, Callable[[float], object]]] = [
    ("number", lambda x: x), ("points", lambda x: np.array([[0.0, x, np.inf]])),
]  # fmt: skip


@pytest.mark.parametrize(("name", "given"), NO_SIZES)
def test_numbers_that_nothing_has_are_refused(
    name: str, given: Callable[[float], object]
) -> None:
    for size in (0.0, 1e100, -1e100, np.inf):
        assert np.array_equal(np.asarray(result(name, given=given(size))), given(size))
    for size in (1e101, -1e308):
        with pytest.raises((GraphError, NodeError), match="1e\\+100"):
            result(name, given=given(size))


@pytest.mark.parametrize("size", [1e-101, -5e-324])
def test_lengths_too_small_to_be_squared_are_refused(size: float) -> None:
    with pytest.raises(GraphError, match="must be 0 or between 1e-100 and 1e"):
        result("number", given=size)
    assert np.array_equal(np.asarray(result("points", given=[[size, 0, 0]])), [[size, 0, 0]])
