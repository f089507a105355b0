"""Polygon File Format (PLY): ascii or binary of either byte order, polygons of any degree."""

import re
import struct
from dataclasses import dataclass
from itertools import islice
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import IntArray
from ...kernel.errors import InputError
from ...kernel.meshes.mesh import Mesh
from ..polygons import FileContent, Polygons
from ..text import (
    TextPolygons,
    decode,
    numbered_words,
    significant_digits,
    to_count,
    unended,
)
from .mending import SINGLE, Source, mended

_AGAIN = "export the mesh again"
_ORDERS: Final = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_CODES: Final = {
    "char": "b", "int8": "b", "uchar": "B", "uint8": "B",
    "short": "h", "int16": "h", "ushort": "H", "uint16": "H",
    "int": "i", "int32": "i", "uint": "I", "uint32": "I",
    "float": "f", "float32": "f", "double": "d", "float64": "d",
}  # fmt: skip
_FACE_LISTS: Final = ("vertex_indices", "vertex_index")
_END: Final = re.compile(rb"(?<=[\r\n])end_header[ \t]*(\r\n|\n|\r)")
_NO_FACE_LIST: Final = f"the faces have no list {' or '.join(_FACE_LISTS)}; {_AGAIN}"


@dataclass(frozen=True)
class _Property:
    name: str
    code: str
    count_code: str = ""


@dataclass(frozen=True)
class _Element:
    name: str
    count: int
    properties: tuple[_Property, ...]


@dataclass(frozen=True)
class _Header:
    order: str
    elements: tuple[_Element, ...]
    n_lines: int
    size: int


def read_ply(data: bytes) -> FileContent:
    """Polygons of a PLY file.

    Parameters
    ----------
    data : bytes
        Content of the file. Of its elements, ``x``, ``y``, ``z`` of ``vertex`` and the list
        ``vertex_indices`` (or ``vertex_index``) of ``face`` are read.

    Returns
    -------
    FileContent
        Faces in the order of the file; all vertices, used or not, unless every face has
        vertices of its own.

    Raises
    ------
    InputError
        If the header or a line cannot be read or the file is cut short; the message names
        the line of text files.
    """
    header = _read_header(data)
    names = [element.name for element in header.elements]
    if "face" not in names and "tristrips" in names:
        raise InputError(
            f"the faces are strips of triangles, which are not read; {_AGAIN} with faces"
        )
    if not header.order:
        return _read_ascii(data, header)
    return _read_binary(data[header.size :], header)


def _read_header(data: bytes) -> _Header:
    end = _END.search(data)
    if not data.startswith(b"ply") or not end:
        raise InputError(f"line 1: the header does not run from ply to end_header; {_AGAIN}")
    # Where lines end in \r alone, a \n behind the last is a number.
    size = end.end() if b"\n" in data[: end.start()] else end.start(1) + 1
    lines = decode(data[:size]).split("\n")[:-1]
    order = None
    elements: list[_Element] = []
    for number, line in enumerate(lines, 1):
        match line.split():
            case ["format", name, "1.0"] if name in _ORDERS:
                order = _ORDERS[name]
            case ["element", name, count] if to_count(count) >= 0:
                elements.append(_Element(name, to_count(count), ()))
            case ["property", *words] if elements and (new := _read_property(words)):
                last = elements[-1]
                elements[-1] = _Element(last.name, last.count, (*last.properties, new))
            case [] | ["ply"] | ["comment" | "obj_info" | "end_header", *_]:
                pass
            case _:
                # A line left out would shift the columns that it describes.
                raise InputError(f"line {number}: cannot read {line.strip()[:60]!r}; {_AGAIN}")
    if order is None:
        raise InputError(f"line 2: the header names no format; {_AGAIN}")
    return _Header(order, tuple(elements), len(lines), size)


def _read_property(words: list[str]) -> _Property | None:
    match words:
        case ["list", count, item, name] if count in _CODES and item in _CODES:
            # Counts and vertices are whole numbers, or the rows could not be walked.
            whole = _CODES[count] + (_CODES[item] if name in _FACE_LISTS else "")
            is_sound = not set(whole) & {"f", "d"}
            return _Property(name, _CODES[item], _CODES[count]) if is_sound else None
        case [item, name] if item in _CODES:
            return _Property(name, _CODES[item])
        case _:
            return None


def _coordinate_columns(element: _Element) -> list[int]:
    names = [each.name for each in element.properties if not each.count_code]
    if len(names) < len(element.properties) or not {"x", "y", "z"} <= set(names):
        raise InputError(f"the vertices have no plain properties x, y and z; {_AGAIN}")
    return [names.index(axis) for axis in "xyz"]


def _read_ascii(data: bytes, header: _Header) -> FileContent:
    rows = numbered_words(decode(data[header.size :]), header.n_lines + 1)
    found = TextPolygons()
    last = header.n_lines
    for element in header.elements:
        columns = _coordinate_columns(element) if element.name == "vertex" else []
        n_read = 0
        for n_read, (last, words) in enumerate(islice(rows, element.count), 1):  # noqa: B007
            if element.name == "vertex":
                _check_width(last, words, len(element.properties))
                found.add_vertex(last, [words[i] for i in columns if i < len(words)])
            elif element.name == "face":
                found.add_face(last, _ascii_corners(last, words, element))
        if n_read < element.count:
            raise InputError(
                f"line {last}: the file ends after {n_read} of {element.count} rows of element "
                f"{element.name}; {_AGAIN}"
            )
    behind = next(rows, None)
    remarks = (_goes_on(f"line {behind[0]}: the file"),) if behind else ()
    source = Source(significant_digits(found.coordinates), has_end=not unended(data))
    return mended(found.polygons(), source, remarks)


def _goes_on(what: str) -> str:
    return f"{what} goes on after the rows that its header counts; what follows is left out"


def _check_width(number: int, words: list[str], width: int) -> None:
    if len(words) > width:
        raise InputError(
            f"line {number}: the row has {len(words)} numbers where the header names {width}; "
            f"{_AGAIN}"
        )


def _ascii_corners(number: int, words: list[str], element: _Element) -> list[str]:
    start = 0
    corners: list[str] | None = None
    for each in element.properties:
        if not each.count_code:
            start += 1
            continue
        count = to_count(words[start]) if start < len(words) else -1
        start += 1 + count
        if count < 0 or start > len(words):
            raise InputError(f"line {number}: the list {each.name} is not complete; {_AGAIN}")
        if each.name in _FACE_LISTS:
            corners = words[start - count : start]
    if corners is None:
        raise InputError(_NO_FACE_LIST)
    _check_width(number, words, start)
    return corners


def _read_binary(body: bytes, header: _Header) -> FileContent:
    digits = 0
    vertices, corners, degrees = np.zeros((0, 3)), np.zeros(0, np.int64), np.zeros(0, np.int64)
    start = 0
    for element in header.elements:
        if any(each.count_code for each in element.properties):
            found = _binary_lists(body, start, element, header.order)
            if element.name == "face":
                corners, degrees = found[0], found[1]
            start = found[2]
            continue
        codes = [header.order + each.code for each in element.properties]
        record = np.dtype([(f"f{column}", code) for column, code in enumerate(codes)])
        if len(body) < start + element.count * record.itemsize:
            raise _cut_short(element)
        if element.name == "vertex":
            names = [f"f{column}" for column in _coordinate_columns(element)]
            table = np.frombuffer(body, record, element.count, start)
            with np.errstate(invalid="ignore"):  # a signalling NaN; Mesh refuses it
                is_single = all(record[name] == np.float32 for name in names)
                digits = SINGLE if is_single else 0
                vertices = np.stack([table[name].astype(np.float64) for name in names], axis=1)
        start += element.count * record.itemsize
    n_behind = len(body) - start
    remarks = (_goes_on("the file"),) if n_behind and body[start:].strip() else ()
    return mended(Polygons(vertices, corners, degrees), Source(digits), remarks)


def _binary_lists(
    body: bytes, start: int, element: _Element, order: str
) -> tuple[IntArray, IntArray, int]:
    """Walk records of varying size: the corners and degrees found, and where they end."""
    layout = [
        (
            struct.Struct(order + each.count_code) if each.count_code else None,
            struct.calcsize(order + each.code),
            each.name in _FACE_LISTS,
        )
        for each in element.properties
    ]
    starts: list[int] = []
    counts: list[int] = []
    at = start
    try:
        for _ in range(element.count):
            for counter, size, is_face in layout:
                if counter is None:
                    at += size
                    continue
                count = counter.unpack_from(body, at)[0]
                at += counter.size
                if count < 0:
                    raise InputError(f"element {element.name} has a list of {count}; {_AGAIN}")
                if is_face:
                    starts.append(at)
                    counts.append(count)
                at += int(count) * size
    except struct.error:
        raise _cut_short(element) from None
    if at > len(body):
        raise _cut_short(element)
    degrees = np.array(counts, np.int64)
    codes = [each.code for each in element.properties if each.name in _FACE_LISTS]
    if element.name == "face" and not codes:
        raise InputError(_NO_FACE_LIST)
    if not codes:
        return np.zeros(0, np.int64), np.zeros(0, np.int64), at
    item = np.dtype(order + codes[0])
    # Where each corner stands in the file: the start of its list, and so many items on.
    owners = np.repeat(np.arange(len(degrees)), degrees)
    within = np.arange(len(owners)) - (np.cumsum(degrees) - degrees)[owners]
    positions = np.array(starts, np.int64)[owners] + within * item.itemsize
    gathered = np.frombuffer(body, np.uint8)[positions[:, None] + np.arange(item.itemsize)]
    return gathered.view(item).ravel().astype(np.int64), degrees, at


def _cut_short(element: _Element) -> InputError:
    return InputError(
        f"the file is cut short: it ends before its {element.count} rows of element "
        f"{element.name}; {_AGAIN}"
    )


def format_ply(mesh: Mesh) -> bytes:
    """A mesh as a binary PLY file with float64 coordinates: content of the file."""
    count_type, count = ("uchar", np.dtype("u1"))
    if mesh.degrees.max() > 255:
        count_type, count = ("uint", np.dtype("<u4"))
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {mesh.n_vertices}\n"
        "property double x\nproperty double y\nproperty double z\n"
        f"element face {mesh.n_faces}\n"
        f"property list {count_type} int vertex_indices\n"
        "end_header\n"
    )
    # Each face is its degree and its corners: find where each of them goes.
    starts = mesh.offsets[:-1] * 4 + np.arange(mesh.n_faces) * count.itemsize
    corner_starts = (
        np.arange(len(mesh.corners)) * 4 + (mesh.topology.corner_faces + 1) * count.itemsize
    )
    faces = np.empty(len(mesh.corners) * 4 + mesh.n_faces * count.itemsize, np.uint8)
    faces[starts[:, None] + np.arange(count.itemsize)] = _bytes(mesh.degrees, count)
    faces[corner_starts[:, None] + np.arange(4)] = _bytes(mesh.corners, np.dtype("<i4"))
    return header.encode() + mesh.vertices.astype("<f8").tobytes() + faces.tobytes()


def _bytes(values: IntArray, kind: np.dtype[Any]) -> NDArray[np.uint8]:
    return values.astype(kind).view(np.uint8).reshape(len(values), -1)
