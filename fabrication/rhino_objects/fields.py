"""The four entries of an object of Rhino in JSON, and the stream that they hold."""

import base64
import binascii
from collections.abc import Mapping
from functools import cache
from typing import Any, Final, TypeAlias, cast

from ...kernel.errors import InputError
from ..opennurbs import stream_codes as codes

Fields: TypeAlias = dict[str, Any]
"""``version``, ``archive3dm``, ``opennurbs``, and ``data``: the stream in base64."""

_CLASS_ID: Final = slice(24, 40)
"""Where the id of the class stands in a stream: after the heads of two chunks."""


def object_stream(fields: object) -> bytes:
    """The stream of an object.

    Parameters
    ----------
    fields : mapping
        The object in JSON.

    Returns
    -------
    bytes
        What openNURBS wrote; not looked at.

    Raises
    ------
    InputError
        If there is none.
    """
    none: Mapping[str, object] = {}
    held = cast("Mapping[str, object]", fields) if isinstance(fields, Mapping) else none
    data = held.get("data")
    if not isinstance(data, str):
        raise InputError('it is no object of Rhino: its entry "data" is missing')
    try:
        stream = base64.b64decode(data, validate=True)
    except (binascii.Error, ValueError) as error:
        raise InputError('its entry "data" is damaged: it is no base64') from error
    if stream[:4] != codes.CLASS.to_bytes(4, "little") or len(stream) < _CLASS_ID.stop:
        raise InputError('its entry "data" holds no object of Rhino')
    return stream


def class_id(stream: bytes) -> bytes:
    """The id of the class of an object, one of those in `stream_codes`."""
    return stream[_CLASS_ID]


def object_fields(stream: bytes) -> Fields:
    """A stream that we have written as an object in JSON."""
    return {**_versions(), "data": base64.b64encode(stream).decode("ascii")}


@cache
def _versions() -> Fields:
    """The versions that go with our streams: those of any object of rhino3dm."""
    import rhino3dm

    point: Any = rhino3dm.Point(rhino3dm.Point3d(0, 0, 0))
    fields: Fields = point.Encode()
    return {name: item for name, item in fields.items() if name != "data"}


def decoded_objects(several: list[Fields]) -> list[Any]:
    """Objects of rhino3dm.

    It may never come back from a damaged one: call what calls this by `isolated`.

    Parameters
    ----------
    several : list of dict
        Objects in JSON.

    Returns
    -------
    list of rhino3dm.CommonObject
        In their order.

    Raises
    ------
    InputError
        If rhino3dm cannot read one.
    """
    import rhino3dm

    library: Any = rhino3dm
    objects: list[Any] = []
    for fields in several:
        object_stream(fields)
        try:
            versions = {name: int(fields[name]) for name in _versions()}
        except (KeyError, TypeError, ValueError) as error:
            raise InputError("it does not say which version of Rhino wrote it") from error
        found = library.CommonObject.Decode({**versions, "data": fields["data"]})
        if found is None:
            raise InputError("Rhino's library cannot read it")
        objects.append(found)
    return objects
