"""Results that nobody can change for others."""

from collections import Counter, OrderedDict, defaultdict, deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import pytest

import spheremesh as sm
from spheremesh.nodes import node
from spheremesh.nodes.graphs.stores.results import own, snapshot


@dataclass(frozen=True)
class Record:
    """Holds anything."""

    rows: Any

    @cached_property
    def count(self) -> list[int]:
        """Found once."""
        return [len(self.rows)]


@dataclass(frozen=True, slots=True)
class Slim:
    """Without a dictionary."""

    rows: Any
    name: str = ""


@dataclass
class Open:
    """Fields can be set."""

    rows: Any
    others: list[Any] = field(default_factory=list[Any])


@dataclass(frozen=True, eq=False)
class Report(Mapping[str, Any]):
    """A record that reads like a dictionary."""

    rows: Any

    def __getitem__(self, key: str) -> Any:  # noqa: ANN401
        return getattr(self, key)

    def __iter__(self) -> Iterator[str]:
        return iter(("rows",))

    def __len__(self) -> int:
        return 1


class Pair(NamedTuple):
    """Two things."""

    first: Any
    second: Any


class Numbers(list[int]):
    """A list with a name."""

    name = "numbers"


def inside(value: Any) -> list[Any]:  # noqa: ANN401
    """What a value holds."""
    if isinstance(value, Record | Report | Slim | Open):
        return [value.rows]
    if isinstance(value, dict):
        return list(value.values())
    return list(value) if isinstance(value, list | tuple | deque) else []


def change(value: Any) -> None:  # noqa: ANN401
    """Do to a value and all within what a careless caller might."""
    for item in inside(value):
        change(item)
    if isinstance(value, dict):
        value["more"] = 99
    elif isinstance(value, Open):
        value.rows = 99
    elif isinstance(value, np.ndarray):
        with pytest.raises(ValueError, match="read-only"):
            value[...] = 99
    else:
        getattr(value, "append", getattr(value, "add", repr))(99)


MUTABLE: list[Any] = [
    [1, [2]],
    {"a": [1], "b": {"c": np.zeros(2)}},
    {1, 2},
    bytearray(b"ab"),
    deque([1, [2]], maxlen=5),
    OrderedDict(b=[1], a=[2]),
    defaultdict(list, a=[1]),
    Counter("abba"),
    Numbers([1, 2]),
    (1, [2]),
    Pair([1], 2),
    Record([1, 2]),
    Record(Record((1, {"a": [2]}))),
    Slim([1]),
    Report([{"a": 1}]),
    Open((1, 2)),
    Record(Open([1])),
    {"a": Pair(Record([1]), np.zeros(3))},
]


@pytest.mark.parametrize("value", MUTABLE, ids=lambda value: type(value).__name__)
def test_a_caller_changes_its_own_alone(value: Any) -> None:  # noqa: ANN401
    text = repr(value)

    @node
    def give() -> Any:  # noqa: ANN401
        return value

    @node
    def tell(given: Any) -> str:  # noqa: ANN401
        change(given)
        return repr(given)

    g = sm.Graph()
    step = g.add(give)
    assert repr(g.run(step)) == text
    assert type(g.run(step)) is type(value)
    change(g.run(step))
    g.run(g.add(tell, given=step))
    assert repr(g.run(step)) == text
    change(value)
    assert repr(g.run(step)) == text, "not even the node changes what it has given"


def test_what_holds_nothing_mutable_is_the_same_object() -> None:
    array = np.arange(3.0)
    array.flags.writeable = False
    for value in (
        array,
        Record((1, "a", array)),
        Slim(Record(None)),
        Pair(Record(array), (1.5, None)),
        sm.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
        frozenset([1]),
        Record,
        len,
    ):
        assert own(value) is value


def test_records_keep_what_they_have_found() -> None:
    @node
    def give() -> Record:
        return Record((1, 2))

    g = sm.Graph()
    step = g.add(give)
    assert g.run(step).count is g.run(step).count
    record = Record([1, 2])
    assert record.count == own(record).count == [2]


def test_arrays_are_not_copied() -> None:
    array = np.arange(3.0)
    owned = own(Record([array, {"a": array}]))
    assert owned.rows[0] is owned.rows[1]["a"] is array
    assert not array.flags.writeable


def test_what_holds_itself() -> None:
    ring: list[Any] = [1]
    ring.append(Record((ring,)))
    owned = own(ring)
    assert owned is not ring
    assert owned[1].rows[0] is owned
    both = [ring, ring]
    owned = own(both)
    assert owned[0] is owned[1]


def test_literals_are_taken_as_they_are_at_the_run() -> None:
    @node
    def same(given: Any) -> Any:  # noqa: ANN401
        return given

    g = sm.Graph()
    array = np.zeros(2)
    view = array[:]
    view.flags.writeable = False
    step = g.add(same, given={"a": [array], "b": view, "c": Record(array)})
    result = g.run(step)
    array[0] = 1
    assert result["a"][0][0] == result["b"][0] == result["c"].rows[0] == 0
    assert array.flags.writeable
    assert g.run(step)["a"][0][0] == 1
    array.flags.writeable = False
    assert snapshot(array) is array
