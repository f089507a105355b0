"""Types of inputs: which values they take, and which wires."""

import os
import typing
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar, TypeVarTuple

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
from numpy.typing import ArrayLike, NDArray

import spheremesh as sm
from spheremesh.nodes import Port, node
from spheremesh.nodes.graphs.annotations import ArrayFacts, type_name
from spheremesh.nodes.graphs.kinds import accepts, convert, fits, record_fault


@dataclass(frozen=True)
class Report(Mapping[str, Any]):
    """A record that reads like a dictionary."""

    count: int

    def __getitem__(self, key: str) -> Any:  # noqa: ANN401
        return getattr(self, key)

    def __iter__(self) -> Iterator[str]:
        return iter(("count",))

    def __len__(self) -> int:
        return 1


class CutReport(Report):
    """Of a cut."""


class AngleReport(Report):
    """Of angles."""


@pytest.fixture(autouse=True)
def toys() -> None:
    """Register the toys for one test."""
    for function in (read_shape, fit_shape, measure, pick, translate, to_path, to_text):
        node(function)


def test_paths_and_lists_take_the_form_that_the_function_expects() -> None:
    g = sm.Graph()
    path = g.add(to_path, path="folder")
    assert g.run(path) == Path("folder/x")
    assert g.run(g.add(to_text, text=path)) == os.fspath(Path("FOLDER/X"))
    assert g.run(g.add(translate, offset=[1, 2, 3])) == (1, 2, 3)


Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Texts = NDArray[np.str_]
Weights = Annotated[Floats, ArrayFacts("weights of edges", ("E",)), Port(unit="deg")]
Labels = Annotated[Ints, ArrayFacts("labels of faces", ("F",))]
Spheres = Annotated[Floats, ArrayFacts("spheres of vertices", ("V", 5))]
Rows = Annotated[Floats, ArrayFacts("rows", ("N", 5))]
Transform = Annotated[Floats, ArrayFacts("transform", (5, 5))]
Either = TypeVar("Either", Shape, Spheres)

FIT = [
    (int, float),
    (bool, bool),
    (np.float64, float),
    (Round, Shape),
    (Shape, Round | Shape),
    (Floats, Ints),
    (Floats, Floats | None),
    (Floats, ArrayLike),
    (Floats, Sequence[float]),
    (Floats, Any),
    (list[float], Floats),
    (list[list[int]], Floats),
    (list[int], Sequence[float]),
    (list[float], tuple[float, ...]),
    (dict[str, Any], Mapping[str, Any]),
    (Any, int),
    (int, Any),
    (float, object),
    (str, Path),
    (Path, str | os.PathLike[str]),
    (Literal["a"], str),
    (str, Literal["a"]),
    (float | None, float),
    (Annotated[int, Port(min=1)], float),
    (Callable[[int], int], Callable[[int], int]),
    (CutReport, CutReport | None),
    (CutReport, Report),
    (CutReport, CutReport | AngleReport),
    (CutReport, Mapping[str, Any]),
    (Texts, NDArray[Any]),
    (Weights, Weights | None),
    (Weights, Floats),
    (Floats, Weights),
    (list[float], Weights),
    (Ints, Weights),
    (Spheres, Rows),
    (Rows, Spheres),
    (Spheres, float | Spheres),
    (list[Transform], list[Transform]),
    (Spheres, Either),
    (Either, Spheres),
]
MISFIT = [
    (float, int),
    (bool, int),
    (int, bool),
    (str, float),
    (float, str),
    (None, float),
    (Shape, Round),
    (Shape, Floats),
    (Floats, float),
    (str, Floats),
    (Floats, Shape | None),
    (list[Shape], Floats),
    (str, Sequence[str]),
    (list[str], Sequence[float]),
    (Sequence[int], Mapping[str, int]),
    (Mapping[str, Any], Shape),
    (Literal["c"], Literal["a", "b"]),
    (CutReport, AngleReport | None),
    (Report, CutReport),
    (Mapping[str, Any], CutReport),
    (CutReport, Floats),
    (list[CutReport], list[AngleReport]),
    (float, Floats),
    (Texts, Floats),
    (Floats, Texts),
    (Spheres, Weights),
    (Weights, Spheres | None),
    (Weights, Labels),
    (Transform, Spheres),
    (Transform, Rows),
    (Rows, Weights),
    (list[Spheres], list[Transform]),
    (Weights, Either),
]


@pytest.mark.parametrize(("source", "target"), FIT)
def test_types_that_fit(source: Any, target: Any) -> None:  # noqa: ANN401
    assert fits(source, target)


@pytest.mark.parametrize(("source", "target"), MISFIT)
def test_types_that_do_not_fit(source: Any, target: Any) -> None:  # noqa: ANN401
    assert not fits(source, target)


@pytest.mark.parametrize(
    ("kind", "good", "bad"),
    [
        (float, [1, 1.5, np.float32(1), np.int8(1)], [True, "1", None, 1j, [1.0]]),
        (int, [1, np.int64(3)], [1.0, True, "1"]),
        (bool, [True, np.bool_(0)], [1, 0.0, "True"]),
        (str, ["a", Path("a")], [1, b"a"]),
        (Floats, [np.zeros(2), [1, 2], [[1.5], (2,)]], [1.0, "abc", ["a"], [None], {}]),
        (Weights | None, [None, [1, 2], [], np.ones(3)], [1.0, [[1]], np.ones((3, 1)), "a"]),
        (Spheres, [np.ones((2, 5)), [[1, 2, 3, 4, 5]]], [np.ones(5), [[1, 2], [3]], [[1]]]),
        (list[Transform], [[], [np.eye(5)]], [np.eye(5), [np.eye(4)]]),
        (ArrayLike, [np.zeros(2), [1, 2], 1.5], [None, {1}, object()]),
        (Sequence[int], [[1], (1, 2), np.arange(2)], ["ab", [1.5], 3]),
        (Literal[1, "a"], [1, "a"], [True, 2, "b"]),
        (tuple[int, str], [(1, "a"), [1, "a"]], [(1,), ("a", 1)]),
        (Mapping[str, int] | None, [{}, {"a": 1}, None], [[], 1]),
        (Shape, [Shape(), Round()], [object(), None]),
        (Any, [None, object()], []),
    ],
)
def test_values(kind: Any, good: list[Any], bad: list[Any]) -> None:  # noqa: ANN401
    assert [value for value in good if not accepts(kind, value)] == []
    assert [value for value in bad if accepts(kind, value)] == []


def test_type_statements_are_what_they_stand_for() -> None:
    """``NDArray`` is one with numpy 2.5; before Python 3.12 only typing_extensions has them."""
    place = "typing" if hasattr(typing, "TypeAliasType") else "typing_extensions"
    alias = pytest.importorskip(place).TypeAliasType
    first, second, several = TypeVar("first"), TypeVar("second"), TypeVarTuple("several")
    array = alias("array", np.ndarray[Any, np.dtype[first]], type_params=(first,))
    pair = alias("pair", tuple[second, first], type_params=(first, second))
    same = alias("same", first, type_params=(first,))
    row = alias("row", tuple[*several], type_params=(several,))
    length = alias("length", Annotated[float, Port(min=0)])
    floats, numbers = array[np.float64], list[array[np.int64]] | None
    assert list(map(type_name, (floats, numbers, array, length))) == [
        "float64 array",
        "list of int64 array or None",
        "array",
        "float",
    ]
    good = [(floats, [1, 2]), (pair[int, str], ("a", 1)), (same[int], 1), (length, 1.5)]
    bad = [(floats, "ab"), (pair[int, str], (1, "a")), (same[int], "a"), (numbers, [1])]
    assert [case for case in good if not accepts(*case)] == []
    assert [case for case in bad if accepts(*case)] == []
    assert accepts(row[int, str], (1, "a"))  # not told apart
    assert fits(Floats, floats)
    assert fits(floats, floats | None)
    assert not fits(Shape, floats)
    assert not fits(floats, length)
    assert convert(floats | None, [1, 2]).dtype == np.float64
    weights = Annotated[floats, ArrayFacts("weights of edges", ("E",))]
    assert type_name(weights) == "weights of edges (E,)"
    assert fits(weights, Weights)
    assert not fits(Spheres, weights)


def test_a_mapping_of_its_fields_is_a_report() -> None:
    assert accepts(CutReport | None, {"count": 3})
    assert convert(CutReport | None, {"count": 3}) == CutReport(3)
    faults = {
        "": {"count": 3},
        ": CutReport misses 'count', has no entry 'cuont'": {"cuont": 3},
        ": CutReport has no entry 'more'": {"count": 3, "more": 1},
        ": CutReport 'count' is none": {"count": "three"},
    }
    for text, given in faults.items():
        assert record_fault(CutReport | None, given) == text
        assert accepts(CutReport, given) == (not text)
