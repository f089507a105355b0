"""Reads the byte stream of openNURBS objects: where numbers and checksums stand."""

import struct
import zlib
from collections.abc import Generator
from contextlib import contextmanager
from typing import Final, NamedTuple

from . import stream_codes as codes

_MOST_INFLATED: Final = 2**29
"""Bytes of a buffer: a stream of a kilobyte can hold a megabyte of zeros."""


class UnreadableError(Exception):
    """A stream that is not what it should be; the message says where."""


class BufferPlace(NamedTuple):
    """A buffer: where its bytes stand, and whether they are deflated."""

    start: int
    stop: int
    is_deflated: bool


class StreamReader:
    """Reads a stream from front to back.

    Every method that reads raises `UnreadableError` where the stream ends too early or holds
    something else. `position` is where the next byte is; `checksums`, and `numbers` (places and
    counts of float64 numbers), are those passed so far.
    """

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.position = 0
        self.limit = len(data)
        self.checksums: list[codes.Checksum] = []
        self.own: list[tuple[int, int]] = []
        self.begin = 0
        self.numbers: list[tuple[int, int]] = []

    def take(self, count: int) -> int:
        """Pass bytes: where they begin."""
        start = self.position
        if not 0 <= count <= self.limit - start:
            raise UnreadableError(f"the stream is cut short at byte {start}")
        self.position += count
        return start

    def ints(self, count: int) -> tuple[int, ...]:
        """Read int32 numbers."""
        return struct.unpack_from(f"<{count}i", self.data, self.take(4 * count))

    def doubles(self, count: int) -> int:
        """Pass float64 numbers: where they begin."""
        start = self.take(8 * count)
        self.numbers.append((start, count))
        return start

    def counted_ints(self) -> tuple[int, ...]:
        """Read int32 numbers that follow their count."""
        return self.ints(self.ints(1)[0])

    def expect(self, expected: bytes, name: str) -> None:
        """Pass known bytes; the name says what they are, for the message."""
        start = self.take(len(expected))
        if self.data[start : self.position] != expected:
            raise UnreadableError(f"{name} expected at byte {start}")

    @contextmanager
    def chunk(self, typecode: int) -> Generator[None]:
        """Read a chunk; the block begins at its body and must consume it."""
        start = self.take(codes.CHUNK_HEADER.size)
        found, length = codes.CHUNK_HEADER.unpack_from(self.data, start)
        if found != typecode:
            raise UnreadableError(f"chunk {typecode:#x} expected at byte {start}")
        tail = codes.CRC.size if typecode & codes.CRC_FLAG else 0
        if not tail <= length <= self.limit - self.position:
            raise UnreadableError(f"the chunk at byte {start} reaches beyond its end")
        outer_limit, outer_own = self.limit, [*self.own, (self.begin, start)]
        self.limit = self.position + length - tail
        self.own, self.begin = [], self.position
        yield
        if self.position != self.limit:
            raise UnreadableError(f"the chunk at byte {start} has bytes left over")
        if tail:
            ranges = (*self.own, (self.begin, self.position))
            self.checksums.append(codes.Checksum(self.position, ranges))
        self.limit, self.own = outer_limit, outer_own
        self.take(tail)
        self.begin = self.position

    @contextmanager
    def object(self) -> Generator[bytes]:
        """Read an object: the id of its class; the block must consume it."""
        with self.chunk(codes.CLASS):
            with self.chunk(codes.CLASS_UUID):
                start = self.take(16)
            with self.chunk(codes.CLASS_DATA):
                yield self.data[start : start + 16]
            self.expect(codes.CHUNK_HEADER.pack(codes.CLASS_END, 0), "the end of an object")

    @contextmanager
    def table(self, minor: int = 0) -> Generator[int]:
        """Read a table of version 1.0 to 1.`minor`: its number of records.

        The block must consume them.
        """
        with self.chunk(codes.ANONYMOUS):
            version = self.data[self.take(1)]
            if version not in range(16, 17 + minor):
                raise UnreadableError(f"a table of unknown version before {self.position}")
            yield self.ints(1)[0]

    def skip_chunk(self) -> None:
        """Pass a chunk of any type."""
        start = self.take(codes.CHUNK_HEADER.size)
        self.take(codes.CHUNK_HEADER.unpack_from(self.data, start)[1])

    def buffer(self, expected: int | None = None) -> BufferPlace:
        """Pass a buffer; it must hold so many bytes if that is given."""
        begin = self.position
        (size,) = self.ints(1)
        if expected not in (None, size):
            raise UnreadableError(f"the buffer at byte {begin} does not hold {expected} bytes")
        if size == 0:
            return BufferPlace(self.position, self.position, is_deflated=False)
        place = self.take(codes.CRC.size)
        method = self.data[self.take(1)]
        if method == 0:
            start = self.take(size)
            self.checksums.append(codes.Checksum(place, ((start, self.position),)))
            return BufferPlace(start, self.position, is_deflated=False)
        with self.chunk(codes.ANONYMOUS):
            start = self.take(self.limit - self.position)
            found = BufferPlace(start, self.position, is_deflated=True)
        content = buffer_content(self.data, found)
        (checksum,) = codes.CRC.unpack_from(self.data, place)
        if len(content) != size or checksum != zlib.crc32(content):
            raise UnreadableError(f"the buffer at byte {begin} does not inflate to its content")
        return found


def buffer_content(data: bytes, buffer: BufferPlace) -> bytes:
    """Content of a buffer; empty if deflated bytes are damaged, or inflate beyond measure."""
    content = data[buffer.start : buffer.stop]
    if not buffer.is_deflated:
        return content
    stream = zlib.decompressobj()
    try:
        inflated = stream.decompress(content, _MOST_INFLATED)
    except zlib.error:
        return b""
    return inflated if stream.eof else b""
