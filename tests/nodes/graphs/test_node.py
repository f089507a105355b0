"""Registration: what a signature and a docstring become."""

from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

import spheremesh as sm
from spheremesh.nodes import GraphError, NodeWarning, Port, ReadPath, Units, WritePath, node
from spheremesh.nodes.graphs.node import REGISTRY, find_node
from spheremesh.nodes.graphs.ports import REQUIRED


class Circle(NamedTuple):
    """A circle.

    Attributes
    ----------
    center : (3,) float array
        Its centre.
    """

    center: NDArray[np.float64]
    angle: Annotated[float, Port(unit="deg")]


def fit_circle(
    points: NDArray[np.float64],
    angle: Annotated[float, Port(unit="deg", min=0, max=90)] = 30.0,
    kind: Literal["best", "fast"] = "best",
    source: ReadPath | None = None,
    *,
    out: WritePath = "out.txt",
    units: Units = "m",
) -> Circle:
    """Fit a circle.

    More about it.

    Parameters
    ----------
    points : (V, 3) float array
        Points to fit;
        at least three.
    angle, kind : float, str
        How to fit.

    Returns
    -------
    center : (3,) float array
        Centre of the circle.
    angle : float
        Its angle.

    Raises
    ------
    ValueError
        If there are none.
    """
    raise ValueError(points, angle, kind, source, out, units)


def test_a_node_is_the_function_unchanged() -> None:
    assert node(fit_circle) is fit_circle
    assert node(version="2")(fit_circle) is fit_circle
    assert find_node(fit_circle) is find_node("fit_circle")
    assert find_node("fit_circle").version == "2"


def test_the_signature_is_the_ports() -> None:
    node(fit_circle)
    record = find_node("fit_circle")
    assert list(record.inputs) == ["points", "angle", "kind", "source", "out", "units"]
    points, angle, kind, source, out, units = record.inputs.values()
    assert points.default is REQUIRED
    assert (angle.type, angle.default, angle.unit, angle.min, angle.max) == (
        float, 30.0, "deg", 0, 90,
    )  # fmt: skip
    assert kind.type == Literal["best", "fast"]
    assert source.reads
    assert not source.writes
    assert out.writes
    assert not out.reads
    assert units.graph_units
    assert list(record.outputs) == ["center", "angle"]
    assert record.outputs["angle"].unit == "deg"
    assert record.has_fields


def test_the_docstring_is_the_help() -> None:
    node(fit_circle)
    record = find_node("fit_circle")
    assert record.summary == "Fit a circle."
    assert "More about it." in record.help
    assert record.inputs["points"].help == "Points to fit; at least three."
    assert record.inputs["angle"].help == record.inputs["kind"].help == "How to fit."
    assert record.outputs["center"].help == "Centre of the circle."
    assert record.category == __name__.rpartition(".")[2]


def test_outputs_are_described_by_the_record_too() -> None:
    def plain() -> Circle:
        """A circle."""
        return Circle(np.zeros(3), 0.0)

    node(plain)
    assert find_node("plain").outputs["center"].help == "Its centre."


def test_one_output_is_called_result() -> None:
    def half(a: float) -> float:
        """Half of it.

        Returns
        -------
        float
            The half.
        """
        return a / 2

    node(half)
    assert find_node("half").outputs["result"].help == "The half."
    g = sm.Graph()
    step = g.add(half, a=3)
    assert g.run(step.result) == g.run(step) == g.run("half.result") == 1.5


def bare(a, b: int = 1) -> int:  # noqa: ANN001
    return a + b


def no_result(a: int):  # noqa: ANN201
    return a


def many(*items: int) -> int:
    return len(items)


def out_of_range(k: Annotated[int, Port(min=1)] = 0) -> int:
    return k


def none_by_default(k: float = None) -> float:  # noqa: RUF013
    return k


def unresolved(k: "Missing") -> float:  # noqa: F821
    return k


def unknown_content(k: Any = object()) -> float:  # noqa: ANN401, B008
    return k


class Named(NamedTuple):
    """An output with a name of a step's own."""

    name: str


def reserved() -> Named:
    return Named("")


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (bare, r"bare\.a: annotate the input"),
        (no_result, "node no_result: annotate its result"),
        (many, r"many\.items: an input must be a plain argument, not \*items"),
        (out_of_range, r"default of out_of_range\.k = 0: must be at least 1"),
        (none_by_default, r"default of none_by_default\.k = None: must be float"),
        (unresolved, "node unresolved: an annotation cannot be resolved: .*Missing"),
        (unknown_content, r"default of unknown_content\.k: a object cannot be told"),
        (reserved, "node reserved: an output cannot be called 'name'"),
    ],
)
def test_what_is_no_node(function: Any, message: str) -> None:  # noqa: ANN401
    with pytest.raises(GraphError, match=message):
        node(function)
    assert function.__name__ not in REGISTRY


def test_two_nodes_of_one_name() -> None:
    node(fit_circle)

    def other() -> float:
        return 0.0

    other.__name__ = "fit_circle"
    with pytest.raises(
        GraphError, match=r"two nodes .* 'fit_circle': .*\.fit_circle and .*other"
    ):
        node(other)


def test_a_function_defined_anew_is_seen() -> None:
    def define(factor: float) -> Any:  # noqa: ANN401
        @node
        def scale(a: float) -> float:
            return factor * a

        return scale

    g = sm.Graph()
    old = define(2)
    step = g.add(old, a=1)
    after = g.add("scale", "after", a=step)
    assert g.run(step) == 2
    assert g.messages == {}
    key = g._cache._entries.copy().keys()
    new = define(3)
    with pytest.warns(NodeWarning, match=r"step 'scale': its function scale was replaced"):
        assert g.run(step) == 2
    assert g._cache._entries.keys() == key, "the old step keeps its key"
    assert list(g.messages) == ["scale"]
    assert "add it again to use the new one" in g.messages["scale"][0]
    added = g.add(new, a=1)
    assert g.run(added) == 3
    assert list(g.messages) == ["scale"], "of the old step alone"
    with pytest.warns(NodeWarning, match="its function scale was replaced") as told:
        assert g.run(after) == 4
    assert [str(w.message).partition(":")[0] for w in told] == ["step 'scale'", "step 'after'"]
    with pytest.raises(
        GraphError, match="scale is not a node: decorate its present definition"
    ):
        g.add(old, a=1)
    assert sm.Graph.from_json(g.to_json()).run("scale") == 3


def test_a_plain_function_is_no_node() -> None:
    with pytest.raises(GraphError, match="len is not a node"):
        sm.Graph().add(len)
