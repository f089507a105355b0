"""Values on disk: exactly the same again, or refused."""

import json
import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import spheremesh as sm
from spheremesh.nodes.graphs.stores.digests import digest
from spheremesh.nodes.graphs.stores.footprints import footprint
from spheremesh.nodes.graphs.stores.packing import PackingError, pack, unpack


@dataclass(frozen=True)
class Record:
    """Two things."""

    a: object
    b: object = None


class Pair(NamedTuple):
    """Two things as well."""

    a: object
    b: object


def again(value: object) -> Any:  # noqa: ANN401
    """What comes back from JSON and blocks."""
    blocks: dict[str, bytes] = {}
    text = json.dumps(pack(value, blocks), allow_nan=False)
    return unpack(json.loads(text), blocks.__getitem__)


SCALARS = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(), st.text(), st.binary(),
    st.complex_numbers(),
)  # fmt: skip
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4),
        st.lists(inner, max_size=4).map(tuple),
        st.dictionaries(st.text(max_size=3) | st.integers(), inner, max_size=4),
        st.builds(Record, inner, inner),
        st.builds(Pair, inner, inner),
        st.sets(st.integers(), max_size=4),
        st.frozensets(st.text(max_size=3), max_size=4),
    ),
    max_leaves=12,
)


@given(VALUES)
def test_values_come_back(value: object) -> None:
    found = again(value)
    assert repr(found) == repr(value) or digest(found) == digest(value)
    assert type(found) is type(value)


@pytest.mark.parametrize("dtype", ["f8", "f4", "i8", "u1", "?", "c16", ">f8", "U3"])
@pytest.mark.parametrize("shape", [(), (0,), (3,), (2, 5), (40, 3), (2, 3, 4)])
def test_arrays_come_back_to_the_bit(dtype: str, shape: tuple[int, ...]) -> None:
    array = np.random.default_rng(0).normal(size=shape).astype(dtype)
    for given_array in (array, np.asfortranarray(array), array[..., ::2] if shape else array):
        found = again(given_array)
        assert (found.dtype, found.shape) == (given_array.dtype, given_array.shape)
        assert found.tobytes() == given_array.tobytes()
        assert not found.flags.writeable
        is_column_first = given_array.flags.f_contiguous and not given_array.flags.c_contiguous
        assert found.flags.f_contiguous or not is_column_first
    assert type(again(np.float32(0.1))) is np.float32
    assert math.isnan(again(np.float64("nan")))


def test_equal_arrays_are_one_block() -> None:
    blocks: dict[str, bytes] = {}
    array = np.arange(100.0)
    pack([array, array.copy(), Record(array)], blocks)
    assert list(map(len, blocks.values())) == [800]


def test_meshes_come_back() -> None:
    mesh = sm.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    found = again(mesh)
    assert digest(found) == digest(mesh)


class Mine(list[int]):
    """A list with a name."""


@pytest.mark.parametrize(
    "value", [object(), len, Mine([1]), [Mine()], np.array([None]), {1: object()}]
)
def test_what_has_no_form_is_refused(value: object) -> None:
    with pytest.raises(PackingError, match="has no form of its own on disk"):
        pack(value, {})


def test_records_that_hold_more_than_their_fields_are_refused() -> None:
    @dataclass
    class Inside:
        a: int

    with pytest.raises(PackingError, match="cannot be found again"):
        pack(Inside(1), {})
    record = Record(1)
    object.__setattr__(record, "more", 2)
    with pytest.raises(PackingError, match="holds more than its fields"):
        pack(record, {})


@pytest.mark.parametrize(
    "tree",
    [
        ["record", "antigravity", "Geohash", []],
        ["record", "os", "system", []],
        ["record", "pathlib", "Path", []],
        ["named", "builtins", "tuple", []],
        ["record", "spheremesh.kernel.meshes.mesh", "Mesh", [["__class__", 1]]],
        ["array", "O", [1], "C", "", ""],
        ["array", "f8", [2], "C", "", "AAAA"],
        ["what", 1],
        [],
        [[1]],
        {"a": 1},
    ],
)
def test_what_nobody_packed_is_refused_and_runs_nothing(tree: object) -> None:
    with pytest.raises((ValueError, TypeError, LookupError, AttributeError, ImportError)):
        unpack(tree, {}.__getitem__)


def test_bytes_of_values() -> None:
    array = np.zeros(1000)
    size = sum(footprint(array).values())
    assert 8000 <= size < 8200
    assert sum(footprint(array[:10]).values()) == size, "a view keeps the whole"
    both = sum(footprint([array, Record(array), {"a": array[1:]}]).values())
    assert size < both < size + 2000, "counted once"
    assert sum(footprint(list(range(1000))).values()) > 30_000
    assert footprint(1.5) == footprint(None) == {}
    ring: list[Any] = []
    ring.append(ring)
    assert len(footprint(ring)) == 1
