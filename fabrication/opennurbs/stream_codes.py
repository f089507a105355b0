"""Codes of the openNURBS byte stream: types of chunks, ids of classes, checksums.

All numbers are little-endian: i = int32, q = int64, d = float64. A chunk is
``i type, q length`` and a body of that length. Where bit 15 of the type is set, the body ends
in the CRC-32 of those of its bytes that belong to no inner chunk; where bit 31 is set, there is
no body (`opennurbs_archive.cpp`). An object is::

    CLASS { CLASS_UUID { 16 bytes, crc }  CLASS_DATA { the object, crc }  CLASS_END }

A buffer is ``i size, i crc, byte method`` and bytes: themselves for method 0, a chunk of
deflated ones for method 1. It is no chunk: its bytes belong to the chunk around it.
"""

import struct
import zlib
from typing import Final, NamedTuple

CLASS: Final = 0x00027FFA
CLASS_UUID: Final = 0x0002FFFB
CLASS_DATA: Final = 0x0002FFFC
CLASS_END: Final = 0x80027FFF
ANONYMOUS: Final = 0x40008000
OBJECT_TABLE: Final = 0x10000013
OBJECT_RECORD: Final = 0x20008070

CRC_FLAG: Final = 0x8000
SHORT_FLAG: Final = 0x80000000

CHUNK_HEADER: Final = struct.Struct("<Iq")
CRC: Final = struct.Struct("<I")

ARC_CURVE: Final = bytes.fromhex("2abe33cfb409d411bffb0010830122f0")
LINE_CURVE: Final = bytes.fromhex("dbd4d74e47e9d311bfe50010830122f0")
NURBS_CURVE: Final = bytes.fromhex("ddd4d74e47e9d311bfe50010830122f0")
NURBS_SURFACE: Final = bytes.fromhex("ded4d74e47e9d311bfe50010830122f0")
PLANE_SURFACE: Final = bytes.fromhex("dfd4d74e47e9d311bfe50010830122f0")
BREP: Final = bytes.fromhex("c5dbb56060e6d311bfe40010830122f0")
MESH: Final = bytes.fromhex("e4d4d74e47e9d311bfe50010830122f0")

MESH_VERSION: Final = b"\x38"
BOUNDARY_TRIM: Final = 1
MATED_TRIM: Final = 2
SEAM_TRIM: Final = 3
OUTER_LOOP: Final = 1
INNER_LOOP: Final = 2


class Checksum(NamedTuple):
    """Place of a CRC-32 in a stream and the ranges (start, stop) of bytes that it covers.

    Its four bytes begin at the place; the ranges are the bytes of its chunk in no inner chunk.
    """

    place: int
    ranges: tuple[tuple[int, int], ...]

    def compute(self, stream: memoryview) -> int:
        """CRC-32 of the ranges, one after the other: what the four bytes should say."""
        value = 0
        for start, stop in self.ranges:
            value = zlib.crc32(stream[start:stop], value)
        return value
