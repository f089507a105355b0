"""
Streams of openNURBS objects: chunks with checksums, laid out once and filled for many objects.

All numbers are little-endian: i = int32, q = int64, d = float64. A chunk is
``i type, q length`` and a body of that length. Where bit 15 of the type is set, the body ends
in the CRC-32 of those of its bytes that belong to no inner chunk; where bit 31 is set, there is
no body (`opennurbs_archive.cpp`). An object is::

    CLASS { CLASS_UUID { 16 bytes, crc }  CLASS_DATA { the object, crc }  CLASS_END }

A buffer is ``i size, i crc, byte method`` and bytes: themselves for method 0, a chunk of
deflated ones for method 1. It is no chunk: its bytes belong to the chunk around it.
"""

import math
import struct
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

CLASS: Final = 0x00027FFA
CLASS_UUID: Final = 0x0002FFFB
CLASS_DATA: Final = 0x0002FFFC
CLASS_END: Final = 0x80027FFF
ANONYMOUS: Final = 0x40008000

CRC_FLAG: Final = 0x8000
SHORT_FLAG: Final = 0x80000000

CHUNK_HEADER: Final = struct.Struct("<Iq")
CRC: Final = struct.Struct("<I")


class Checksum(NamedTuple):
    """
    Place of a CRC-32 in a stream and the ranges (start, stop) of bytes that it covers.

    Attributes
    ----------
    place : int
        Where its four bytes begin.
    ranges : tuple of (int, int)
        The bytes of its chunk that are in no inner chunk.
    """

    place: int
    ranges: tuple[tuple[int, int], ...]

    def compute(self, stream: memoryview) -> int:
        """
        The checksum of a stream.

        Parameters
        ----------
        stream : memoryview
            The bytes.

        Returns
        -------
        int
            CRC-32 of the ranges, one after the other.
        """
        value = 0
        for start, stop in self.ranges:
            value = zlib.crc32(stream[start:stop], value)
        return value


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


class Buffer(NamedTuple):
    """Bytes with their size and checksum, not deflated."""

    content: Slot


Piece: TypeAlias = bytes | Slot | Chunk | Buffer


@dataclass(frozen=True)
class Template:
    """
    A stream whose numbers are still zero.

    Attributes
    ----------
    data : bytes
        The stream.
    slots : tuple of (Slot, int)
        The slots and where they begin.
    checksums : tuple of Checksum
        The checksums, inner ones first.
    """

    data: bytes
    slots: tuple[tuple[Slot, int], ...]
    checksums: tuple[Checksum, ...]


def assemble(piece: Piece) -> Template:
    """
    Lay out a piece: constant bytes, places of numbers, places of checksums.

    Parameters
    ----------
    piece : bytes, Slot, Chunk or Buffer
        The piece.

    Returns
    -------
    Template
        To be filled by `fill`.
    """
    if isinstance(piece, bytes):
        return Template(piece, (), ())
    if isinstance(piece, Slot):
        size = np.dtype(piece.dtype).itemsize * piece.size
        return Template(bytes(size), ((piece, 0),), ())
    if isinstance(piece, Buffer):
        inner = assemble(piece.content)
        head = 4 + CRC.size + 1
        data = ints(len(inner.data)) + bytes(CRC.size + 1) + inner.data
        return Template(data, ((piece.content, head),), (Checksum(4, ((head, len(data)),)),))
    return _assemble_chunk(piece)


def _assemble_chunk(chunk: Chunk) -> Template:
    data = bytearray(CHUNK_HEADER.size)
    slots: list[tuple[Slot, int]] = []
    checksums: list[Checksum] = []
    own: list[tuple[int, int]] = []
    for piece in chunk.body:
        inner, here = assemble(piece), len(data)
        slots += [(slot, here + place) for slot, place in inner.slots]
        checksums += [_shifted(checksum, here) for checksum in inner.checksums]
        data += inner.data
        if not isinstance(piece, Chunk):
            own.append((here, len(data)))
    if chunk.typecode & CRC_FLAG:
        checksums.append(Checksum(len(data), tuple(own)))
        data += bytes(CRC.size)
    CHUNK_HEADER.pack_into(data, 0, chunk.typecode, len(data) - CHUNK_HEADER.size)
    return Template(bytes(data), tuple(slots), tuple(checksums))


def _shifted(checksum: Checksum, by: int) -> Checksum:
    ranges = tuple((start + by, stop + by) for start, stop in checksum.ranges)
    return Checksum(checksum.place + by, ranges)


def fill(template: Template, numbers: Mapping[str, NDArray[Any]]) -> Iterator[bytes]:
    """
    Streams of a template.

    Parameters
    ----------
    template : Template
        The template.
    numbers : mapping of str to (n, count of slots, ...) array
        Numbers of the slots, one row per stream; more than a slot takes are left out.

    Yields
    ------
    bytes
        Each of the n streams.
    """
    rows = len(next(iter(numbers.values())))
    streams = np.tile(np.frombuffer(template.data, np.uint8), (rows, 1))
    for slot, place in template.slots:
        values = numbers[slot.name][:, slot.row]
        values = values.reshape(rows, math.prod(values.shape[1:]))[:, : slot.size]
        raw = np.ascontiguousarray(values, slot.dtype).view(np.uint8)
        streams[:, place : place + raw.shape[1]] = raw
    for row in streams:
        stream = bytearray(row.tobytes())
        with memoryview(stream) as view:
            for checksum in template.checksums:
                CRC.pack_into(stream, checksum.place, checksum.compute(view))
        yield bytes(stream)


def ints(*values: int) -> bytes:
    """
    Bytes of int32 numbers.

    Parameters
    ----------
    *values : int
        The numbers.

    Returns
    -------
    bytes
        Four each.
    """
    return struct.pack(f"<{len(values)}i", *values)


def doubles(*values: float) -> bytes:
    """
    Bytes of float64 numbers.

    Parameters
    ----------
    *values : float
        The numbers.

    Returns
    -------
    bytes
        Eight each.
    """
    return struct.pack(f"<{len(values)}d", *values)


def class_object(uuid: bytes, *body: Piece) -> Chunk:
    """
    An object of a class.

    Parameters
    ----------
    uuid : bytes
        Id of the class.
    *body : bytes, Slot, Chunk or Buffer
        What the class writes.

    Returns
    -------
    Chunk
        The object.
    """
    name = Chunk(CLASS_UUID, (uuid,))
    end = CHUNK_HEADER.pack(CLASS_END, 0)
    return Chunk(CLASS, (name, Chunk(CLASS_DATA, body), end))


def table(minor: int, records: Sequence[tuple[Piece, ...]]) -> Chunk:
    """
    Counted records.

    Parameters
    ----------
    minor : int
        Version 1.`minor` of the table.
    records : sequence of tuple of pieces
        The records.

    Returns
    -------
    Chunk
        An anonymous chunk.
    """
    pieces = (piece for record in records for piece in record)
    return Chunk(ANONYMOUS, (bytes([16 + minor]), ints(len(records)), *pieces))
