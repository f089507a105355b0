"""Writes the byte stream of openNURBS objects: laid out once, filled for many objects.

A stream is built of pieces (constant bytes, numbers to be filled in, chunks, buffers), which
are laid out as a template with the places of its numbers and checksums.
"""

import math
import struct
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from . import stream_codes as codes


class Slot(NamedTuple):
    """Numbers filled in for each object: `size` of them, row `row` of the named array."""

    name: str
    row: int
    size: int
    dtype: str = "<f8"


class Chunk(NamedTuple):
    """A typed piece of a stream."""

    typecode: int
    body: "tuple[Piece, ...]"


class PlainBuffer(NamedTuple):
    """Bytes with their size and checksum, not deflated."""

    content: Slot


class Encoded(NamedTuple):
    """A chunk that is laid out and filled: no checksum around it covers its bytes."""

    data: bytes


Piece: TypeAlias = bytes | Slot | Chunk | PlainBuffer | Encoded


class _Template(NamedTuple):
    """A stream of zeros, the places of its slots, and its checksums, inner ones first."""

    data: bytes
    slots: tuple[tuple[Slot, int], ...]
    checksums: tuple[codes.Checksum, ...]


def _assemble(piece: Piece) -> _Template:
    if isinstance(piece, bytes):
        return _Template(piece, (), ())
    if isinstance(piece, Encoded):
        return _Template(piece.data, (), ())
    if isinstance(piece, Slot):
        size = np.dtype(piece.dtype).itemsize * piece.size
        return _Template(bytes(size), ((piece, 0),), ())
    if isinstance(piece, PlainBuffer):
        inner = _assemble(piece.content)
        head = 4 + codes.CRC.size + 1
        data = ints(len(inner.data)) + bytes(codes.CRC.size + 1) + inner.data
        return _Template(
            data, ((piece.content, head),), (codes.Checksum(4, ((head, len(data)),)),)
        )
    return _assemble_chunk(piece)


def _assemble_chunk(chunk: Chunk) -> _Template:
    data = bytearray(codes.CHUNK_HEADER.size)
    slots: list[tuple[Slot, int]] = []
    checksums: list[codes.Checksum] = []
    own: list[tuple[int, int]] = []
    for piece in chunk.body:
        inner, here = _assemble(piece), len(data)
        slots += [(slot, here + place) for slot, place in inner.slots]
        checksums += [_shifted(checksum, here) for checksum in inner.checksums]
        data += inner.data
        if not isinstance(piece, Chunk | Encoded):
            # One range for pieces that follow one another: a call for each would take long.
            start = own.pop()[0] if own and own[-1][1] == here else here
            own.append((start, len(data)))
    if chunk.typecode & codes.CRC_FLAG:
        checksum = codes.Checksum(len(data), tuple(own))
        if any(isinstance(piece, Slot | PlainBuffer) for piece in chunk.body):
            checksums.append(checksum)
            data += bytes(codes.CRC.size)
        else:
            data += codes.CRC.pack(checksum.compute(memoryview(bytes(data))))
    codes.CHUNK_HEADER.pack_into(data, 0, chunk.typecode, len(data) - codes.CHUNK_HEADER.size)
    return _Template(bytes(data), tuple(slots), tuple(checksums))


def _shifted(checksum: codes.Checksum, by: int) -> codes.Checksum:
    ranges = tuple((start + by, stop + by) for start, stop in checksum.ranges)
    return codes.Checksum(checksum.place + by, ranges)


def fill(piece: Piece, numbers: Mapping[str, NDArray[Any]]) -> Iterator[bytes]:
    """Streams of one layout.

    Numbers of the slots by name are (n, count of slots, ...), one row per stream; more than a
    slot takes are left out.
    """
    template = _assemble(piece)
    rows = len(next(iter(numbers.values())))
    streams = np.tile(np.frombuffer(template.data, np.uint8), (rows, 1))
    for slot, place in template.slots:
        values = numbers[slot.name][:, slot.row]
        values = values.reshape(rows, math.prod(values.shape[1:]))[:, : slot.size]
        raw = np.ascontiguousarray(values, slot.dtype).view(np.uint8)
        streams[:, place : place + raw.shape[1]] = raw
    pack_into = codes.CRC.pack_into
    for row in streams:
        stream = bytearray(row.tobytes())
        with memoryview(stream) as view:
            for checksum in template.checksums:
                pack_into(stream, checksum.place, checksum.compute(view))
        yield bytes(stream)


def encode(piece: Piece) -> bytes:
    """The stream of a piece without slots."""
    return next(fill(piece, {"": np.zeros((1, 0))}))


def ints(*values: int) -> bytes:
    """Bytes of int32 numbers."""
    return struct.pack(f"<{len(values)}i", *values)


def doubles(*values: float) -> bytes:
    """Bytes of float64 numbers."""
    return struct.pack(f"<{len(values)}d", *values)


def class_object(uuid: bytes, *body: Piece) -> Chunk:
    """An object of the class with an id."""
    name = Chunk(codes.CLASS_UUID, (uuid,))
    end = codes.CHUNK_HEADER.pack(codes.CLASS_END, 0)
    return Chunk(codes.CLASS, (name, Chunk(codes.CLASS_DATA, body), end))


def table(minor: int, records: Sequence[tuple[Piece, ...]]) -> Chunk:
    """Counted records in a table of version 1.`minor`."""
    pieces = (piece for record in records for piece in record)
    return Chunk(codes.ANONYMOUS, (bytes([16 + minor]), ints(len(records)), *pieces))
