"""Objects of a .3dm file as records, set into the file that rhino3dm makes without them.

rhino3dm writes what a file has once: settings, layers, materials, views, document strings.
Objects are written here, byte by byte (`opennurbs_archive.cpp`,
`opennurbs_3dm_attributes.cpp`, `opennurbs_userdata.cpp`), in a tenth of the time that calls for
each of them take. A record is::

    RECORD { TYPE  CLASS { the object }  ATTRIBUTES { crc }  [USERDATA { text }]  END  crc }

Attributes 2.13 are a byte, the id, i layer, and items in order, each a byte and its value: 1
name, 4 i material, 6 colour (three bytes and 0), 12 mode, 13 source of the colour, 16 source of
the material, 18 counted groups; 0 ends them. User text is a list of pairs of texts in chunks;
its header, which names versions, is copied from what rhino3dm writes.
"""

import base64
import struct
import zlib
from collections.abc import Mapping, Sequence
from datetime import datetime
from functools import cache
from pathlib import Path
from typing import Any, Final, NamedTuple
from uuid import UUID

from ...kernel.errors import InputError
from ...kernel.parts.colors import Color
from ..dates import file_date
from ..opennurbs.stream_codes import (
    ANONYMOUS,
    CHUNK_HEADER,
    CRC,
    CRC_FLAG,
    OBJECT_RECORD,
    OBJECT_TABLE,
    SHORT_FLAG,
)
from ..opennurbs.stream_writer import class_object, doubles, encode, ints

_RECORD_TYPE: Final = 0x82000071
_ATTRIBUTES: Final = 0x02008072
_USER_DATA: Final = 0x02000073
_RECORD_END: Final = CHUNK_HEADER.pack(0x8200007F, 0)
_CLASS_USER_DATA: Final = 0x00027FFD
_USER_DATA_HEADER: Final = 0x0002FFF9
_CLASS_END: Final = CHUNK_HEADER.pack(0x80027FFF, 0)
_TABLE_END: Final = CHUNK_HEADER.pack(0xFFFFFFFF, 0)
_PROPERTY_TABLE: Final = 0x10000014
_HISTORY: Final = 0x20008021
_END_OF_FILE: Final = 0x7FFF
_FILE_HEADER: Final = 32

_INSTANCE_REFERENCE: Final = UUID("f9cfb638-b9d4-4340-87e3-c56e7865d96a").bytes_le

_TYPES: Final = {
    "Point": 1, "LineCurve": 4, "ArcCurve": 4, "PolylineCurve": 4, "Brep": 16, "Mesh": 32,
    "InstanceReference": 4096, "TextDot": 8192,
}  # fmt: skip
"""Types of objects by openNURBS's names."""

_BLOCK_MEMBER: Final = 3

_COUNT: Final = struct.Struct("<i")


class ObjectAttributes(NamedTuple):
    """What a file says of an object besides its geometry.

    It has the colour and material of its layer unless it has its own; members of blocks stand
    in blocks only.
    """

    id: UUID
    name: str
    layer: int
    material: int | None = None
    groups: tuple[int, ...] = ()
    color: Color | None = None
    text: Mapping[str, str] = {}
    is_member: bool = False


class FileObject(NamedTuple):
    """An object to be written: its kind by openNURBS's name, its stream, its attributes."""

    kind: str
    stream: bytes
    attributes: ObjectAttributes


def instance_stream(definition: UUID, rotation: Any, translation: Any) -> bytes:  # noqa: ANN401
    """A block set into the model, as an `ON_InstanceRef`.

    Parameters
    ----------
    definition : UUID
        Id of the block.
    rotation : (3, 3) float array
        How the block is turned.
    translation : (3,) float array
        Where its origin goes.

    Returns
    -------
    bytes
        The stream.
    """
    rows = [
        [*turn, shift]
        for turn, shift in zip(rotation.tolist(), translation.tolist(), strict=True)
    ]
    matrix = doubles(*(x for row in rows for x in row), 0, 0, 0, 1)
    box = doubles(1, 0, 0, -1, 0, 0)
    body = b"\x10", definition.bytes_le, matrix, box
    return encode(class_object(_INSTANCE_REFERENCE, *body))


def write_archive(
    library: Any,  # noqa: ANN401
    data: bytes,
    objects: Sequence[FileObject],
    path: Path,
) -> None:
    """Write a file with objects, after those that it has.

    Parameters
    ----------
    library : module
        rhino3dm.
    data : bytes
        A file of version 6 or later, as rhino3dm encodes it.
    objects : sequence of FileObject
        With layers, materials and groups of the file.
    path : Path
        The file; a record at a time, as the whole may be large.

    Raises
    ------
    InputError
        If the file has no table of objects, which is a fault of the library.
    """
    header = _text_header(library, int(data[24:32].decode("ascii", "replace") or 0))
    start, length = _find(data, _FILE_HEADER, OBJECT_TABLE)
    end = start + length - len(_TABLE_END)
    if data[end : start + length] != _TABLE_END:
        raise InputError(f"cannot write {path}: rhino3dm did not encode a table of objects")
    place, _ = _find(data, start + length, _END_OF_FILE)
    data = _dated(data, file_date())
    with path.open("wb") as file:
        file.write(data[:end])
        added = sum(file.write(_record(each, header)) for each in objects)
        file.write(data[end:])
        file.seek(start - CHUNK_HEADER.size)
        file.write(CHUNK_HEADER.pack(OBJECT_TABLE, length + added))
        file.seek(place + added)
        file.write(struct.pack("<q", len(data) + added))


def is_sound(
    library: Any,  # noqa: ANN401
    path: Path,
    ids: Sequence[UUID],
) -> bool:
    """Whether openNURBS reads from a file what was written, and finds all of it valid.

    Parameters
    ----------
    library : module
        rhino3dm.
    path : Path
        The file.
    ids : sequence of UUID
        Of the objects that it is to hold, in their order.

    Returns
    -------
    bool
        Whether all of them are there, in their order.
    """
    model = library.File3dm.Read(str(path))
    if model is None or len(model.Objects) != len(ids):
        return False
    pairs = zip(model.Objects, ids, strict=True)
    return all(item.Attributes.Id == each and item.Geometry.IsValid for item, each in pairs)


def refused_objects(
    library: Any,  # noqa: ANN401
    path: Path,
    objects: Sequence[FileObject],
) -> list[FileObject]:
    """Objects that openNURBS does not read, or finds invalid, one by one.

    Parameters
    ----------
    library : module
        rhino3dm.
    path : Path
        The file of them that is not sound.
    objects : sequence of FileObject
        As they were written.

    Returns
    -------
    list of FileObject
        At least one.

    Raises
    ------
    InputError
        If the file is not sound although each object is.
    """
    fields: dict[str, Any] = library.Point(library.Point3d(0, 0, 0)).Encode()
    refused: list[FileObject] = []
    for each in objects:
        fields["data"] = base64.b64encode(each.stream).decode("ascii")
        found = library.CommonObject.Decode(fields)
        if found is None or not found.IsValid:
            refused.append(each)
    if not refused:
        raise InputError(f"cannot write {path}: openNURBS reads another model from it")
    return refused


def _dated(data: bytes, date: datetime) -> bytes:
    """The file as if made then: its history names the first and the last time it was saved.

    The history is a byte, two pairs of a text (who) and a C `tm` of eight integers, a count.
    """
    start, _ = _find(data, _FILE_HEADER, _PROPERTY_TABLE)
    start, length = _find(data, start, _HISTORY)
    day = date.timetuple()
    time = struct.pack(
        "<8i", day.tm_sec, day.tm_min, day.tm_hour, day.tm_mday, day.tm_mon - 1,
        day.tm_year - 1900, (day.tm_wday + 1) % 7, day.tm_yday - 1,
    )  # fmt: skip
    body = bytearray(data[start : start + length - CRC.size])
    place = 1
    for _ in range(2):
        (letters,) = struct.unpack_from("<i", body, place)
        place += 4 + 2 * letters
        body[place : place + len(time)] = time
        place += len(time)
    end = start + length
    return data[:start] + bytes(body) + CRC.pack(zlib.crc32(body)) + data[end:]


def _find(data: bytes, start: int, wanted: int) -> tuple[int, int]:
    """Begin and length of the body of a chunk, among those from a place on."""
    while start + CHUNK_HEADER.size <= len(data):
        typecode, length = CHUNK_HEADER.unpack_from(data, start)
        start += CHUNK_HEADER.size
        if typecode == wanted:
            return start, length
        start += 0 if typecode & SHORT_FLAG else length
    raise InputError(f"cannot write the file: rhino3dm encoded no chunk {wanted:#x}")


def _text_header(library: Any, version: int) -> bytes:  # noqa: ANN401
    """The chunk before user text that names its class and the versions of file and library."""
    sample = library.File3dm()
    attributes = library.ObjectAttributes()
    attributes.SetUserString("key", "text")
    sample.Objects.AddPoint(library.Point3d(0, 0, 0), attributes)
    options = library.File3dmWriteOptions()
    options.Version = version // 10
    data = base64.b64decode(sample.Encode(options))
    start = _FILE_HEADER
    for typecode in (OBJECT_TABLE, OBJECT_RECORD, _USER_DATA):
        start, _ = _find(data, start, typecode)
    start, _ = _find(data, start, _CLASS_USER_DATA)
    # A byte with a version comes first.
    place, length = _find(data, start + 1, _USER_DATA_HEADER)
    return data[start : place + length]


def _record(each: FileObject, header: bytes) -> bytes:
    parts = [
        CHUNK_HEADER.pack(_RECORD_TYPE, _TYPES[each.kind]),
        each.stream,
        _chunk(_ATTRIBUTES, _attributes(each.attributes)),
    ]
    if each.attributes.text:
        parts.append(_user_text(each.attributes.text, header))
    body = b"".join((*parts, _RECORD_END))
    return CHUNK_HEADER.pack(OBJECT_RECORD, len(body) + CRC.size) + body + CRC.pack(0)


def _chunk(typecode: int, own: bytes, inner: bytes = b"") -> bytes:
    """A chunk of own bytes and of inner chunks, which its checksum leaves out."""
    tail = CRC.pack(zlib.crc32(own)) if typecode & CRC_FLAG else b""
    head = CHUNK_HEADER.pack(typecode, len(own) + len(inner) + len(tail))
    return b"".join((head, own, inner, tail))


def _text(value: str) -> bytes:
    if not value:
        return ints(0)
    coded = value.encode("utf-16-le") + b"\0\0"
    return ints(len(coded) // 2) + coded


@cache
def _key(text: str) -> bytes:
    """How an entry with that key begins; keys are few."""
    return ints(1, 0) + _text(text)


def _attributes(each: ObjectAttributes) -> bytes:
    items = [b"\x2d", each.id.bytes_le, ints(each.layer)]
    if each.name:
        items += [b"\x01", _text(each.name)]
    if each.material is not None:
        items += [b"\x04", ints(each.material)]
    if each.color is not None:
        items += [b"\x06", bytes(each.color), b"\0"]
    if each.is_member:
        items += [b"\x0c", bytes([_BLOCK_MEMBER])]
    if each.color is not None:
        items.append(b"\x0d\x01")
    if each.material is not None:
        items.append(b"\x10\x01")
    if each.groups:
        items += [b"\x12", ints(len(each.groups), *each.groups)]
    return b"".join((*items, b"\0"))


def _user_text(text: Mapping[str, str], header: bytes) -> bytes:
    pairs = [_pair(key, value) for key, value in text.items() if value]
    listed = _chunk(ANONYMOUS, ints(1, 0, len(pairs)), b"".join(pairs))
    whole = _chunk(ANONYMOUS, b"", listed)
    data = _chunk(_CLASS_USER_DATA, header + whole)
    return _chunk(_USER_DATA, b"", data + _CLASS_END)


def _pair(key: str, value: str) -> bytes:
    """An entry of user text: a file has hundreds of thousands."""
    coded = value.encode("utf-16-le")
    body = b"%b%b%b\0\0" % (_key(key), _COUNT.pack(len(coded) // 2 + 1), coded)
    head = CHUNK_HEADER.pack(ANONYMOUS, len(body) + CRC.size)
    return b"%b%b%b" % (head, body, CRC.pack(zlib.crc32(body)))
