"""Named arrays and a head as bytes, compact once compressed.

Four bytes with the length of the head, the head as JSON, then the arrays in its order. Whole
numbers are written as differences from row to row, signs folded into the last bit; of all
numbers first the lowest bytes, then the next: neighbours are alike, and so are their bytes.
"""

import json
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

Arrays = Mapping[str, NDArray[Any]]

_TYPES: Final = {"f": "f4", "i": "i4", "u": "u1", "b": "u1"}
"""How numbers are written, by the kind of their type: 32 bits, and bytes."""


def pack_arrays(head: Mapping[str, Any], arrays: Arrays) -> bytes:
    """A head of plain values and arrays as bytes.

    Floats are written with 32 bits, integers as differences of 32 bits, unsigned ones and
    truth values as bytes.

    Examples
    --------
    >>> head, arrays = unpack_arrays(pack_arrays({"a": 1}, {"x": np.array([[3, 5], [4, 5]])}))
    >>> head["a"], arrays["x"].tolist()
    (1, [[3, 5], [4, 5]])
    """
    entries: list[list[Any]] = []
    pieces: list[bytes] = []
    for name, array in arrays.items():
        kind = _TYPES[array.dtype.kind]
        entries.append([name, kind, list(array.shape)])
        pieces.append(_encode(array, kind))
    text = json.dumps({**head, "arrays": entries}, allow_nan=False, separators=(",", ":"))
    start = text.encode()
    return b"".join((len(start).to_bytes(4, "little"), start, *pieces))


def unpack_arrays(data: bytes) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """What `pack_arrays` has written, as a page reads it: the head and the arrays."""
    start = 4 + int.from_bytes(data[:4], "little")
    head: dict[str, Any] = json.loads(data[4:start])
    arrays: dict[str, NDArray[Any]] = {}
    entries: list[tuple[str, str, list[int]]] = head.pop("arrays")
    for name, kind, shape in entries:
        size = int(np.prod(shape)) * int(kind[1])
        arrays[name] = _decode(data[start : start + size], kind, shape)
        start += size
    return head, arrays


def _encode(array: NDArray[Any], kind: str) -> bytes:
    if kind == "u1" or array.size == 0:
        return array.astype("u1").tobytes()
    numbers = array.astype(f"<{kind}")
    if kind == "i4":
        rows = numbers.reshape(len(numbers), -1)
        steps = np.diff(rows, axis=0, prepend=np.zeros_like(rows[:1]))
        numbers = (steps << 1) ^ (steps >> 31)
    # All of one column stand together.
    columns = np.ascontiguousarray(numbers.reshape(len(array), -1).T)
    return columns.view("u1").reshape(-1, 4).T.tobytes()


def _decode(data: bytes, kind: str, shape: list[int]) -> NDArray[Any]:
    if kind == "u1" or not data:
        return np.frombuffer(data, f"<{kind}").reshape(shape)
    numbers = np.ascontiguousarray(np.frombuffer(data, "u1").reshape(4, -1).T).view(f"<{kind}")
    rows = np.ascontiguousarray(numbers.reshape(-1, shape[0]).T)
    if kind == "i4":
        folded = rows.view("<u4")
        steps = (folded >> 1).astype("<i4") ^ -(folded & 1).astype("<i4")
        rows = np.cumsum(steps, axis=0, dtype="<i4")
    return rows.reshape(shape)
