"""Random changes of a file: byte by byte, word by word, line by line."""

import random
import re
import struct

import numpy as np

NUMBERS = (
    b"0", b"-1", b"1", b"3", b"255", b"65536", b"2147483647", b"4294967295", b"999999999999",
    b"18446744073709551616", b"1e308", b"-1e-308", b"1e999", b"nan", b"inf", b"0.5", b"1.0D+2",
    b"1_0", b"", b"x", b"1/2", b"-9223372036854775808", b"9" * 5000,
)  # fmt: skip
PACKED = tuple(
    struct.pack(order + code, value)
    for order in "<>"
    for code, values in (
        ("B", (0, 1, 127, 255)), ("H", (0, 65535)), ("i", (-1, 0, 2**31 - 1, -(2**31))),
        ("I", (2**32 - 1, 10**9)), ("q", (-1, 2**63 - 1)), ("f", (np.nan, np.inf, 1e38, 1e-45)),
        ("d", (np.nan, -np.inf, 1e308, 5e-324)),
    )
    for value in values
)  # fmt: skip


def changed(data: bytes, others: list[bytes], rng: random.Random) -> bytes:
    """One of the seeds with a few random changes."""
    result = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 3, 8))):
        change = rng.choice(CHANGES)
        result = bytearray(change(bytes(result), others, rng))
        if not result:
            return data[: rng.randrange(1, len(data))]
    return bytes(result[:200_000])


def _span(data: bytes, rng: random.Random) -> tuple[int, int]:
    start = rng.randrange(len(data) + 1)
    return start, min(len(data), start + rng.choice((1, 1, 2, 4, 8, 30, 200)))


def _poke(data: bytes, _: list[bytes], rng: random.Random) -> bytes:
    start = rng.randrange(len(data))
    return data[:start] + bytes([rng.randrange(256)]) + data[start + 1 :]


def _pack(data: bytes, _: list[bytes], rng: random.Random) -> bytes:
    start, patch = rng.randrange(len(data)), rng.choice(PACKED)
    return data[:start] + patch + data[start + len(patch) :]


def _delete(data: bytes, _: list[bytes], rng: random.Random) -> bytes:
    start, end = _span(data, rng)
    return data[:start] + data[end:]


def _repeat(data: bytes, _: list[bytes], rng: random.Random) -> bytes:
    start, end = _span(data, rng)
    return data[:end] + data[start:end] * rng.choice((1, 2, 100)) + data[end:]


def _splice(data: bytes, others: list[bytes], rng: random.Random) -> bytes:
    other = rng.choice(others)
    start, end = _span(other, rng)
    at = rng.randrange(len(data) + 1)
    return data[:at] + other[start:end] + data[at + rng.choice((0, end - start)) :]


def _number(data: bytes, _: list[bytes], rng: random.Random) -> bytes:
    found = list(re.finditer(rb"[-+.\w/]+", data[:20_000]))
    if not found:
        return data
    word = rng.choice(found)
    return data[: word.start()] + rng.choice(NUMBERS) + data[word.end() :]


def _lines(data: bytes, _: list[bytes], rng: random.Random) -> bytes:
    lines = data.split(b"\n")
    i, j = rng.randrange(len(lines)), rng.randrange(len(lines))
    kind = rng.randrange(4)
    if kind == 0:
        lines[i], lines[j] = lines[j], lines[i]
    elif kind == 1:
        del lines[i]
    elif kind == 2:
        lines.insert(i, lines[j])
    else:
        lines[i] = lines[i].upper() if rng.random() < 0.5 else lines[i] + b" " + lines[j]
    return b"\n".join(lines)


def _cut(data: bytes, _: list[bytes], rng: random.Random) -> bytes:
    return data[: rng.randrange(1, len(data) + 1)]


CHANGES = (_poke, _pack, _pack, _delete, _repeat, _splice, _number, _number, _lines, _cut)
