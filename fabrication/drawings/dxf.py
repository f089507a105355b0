"""DXF documents in millimetres, without dates and random identifiers."""

import io
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from typing import Any, TypeAlias
from unicodedata import east_asian_width

from ...kernel.errors import MissingLibraryError

# What comes from ezdxf is partly untyped.
_Untyped: TypeAlias = Any

_MILLIMETERS = 4
"""Code of the unit in a DXF file."""

_LETTER = 0.9
"""Width of letters, in heights; twice as wide in the scripts of East Asia."""


@contextmanager
def fixed_ezdxf() -> Generator[_Untyped]:
    """Import ezdxf, without time and random identifiers in what it writes.

    Raises MissingLibraryError if it is missing.
    """
    try:
        import ezdxf
    except ImportError as error:
        raise MissingLibraryError(f"DXF needs ezdxf: {error}; install ezdxf") from error
    library: _Untyped = ezdxf
    options = library.options
    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield library
    finally:
        options.write_fixed_meta_data_for_testing = before


def millimeter_drawing(library: _Untyped, layers: Mapping[str, int]) -> _Untyped:
    """An empty drawing in millimetres, with layers and their colours by AutoCAD's index."""
    document = library.new("R2010")
    document.units = _MILLIMETERS
    document.header["$MEASUREMENT"] = 1
    for name, color in layers.items():
        document.layers.add(name, color=color)
    return document


def drawing_text(document: _Untyped) -> str:
    """The drawing as text; the same entities give the same text."""
    # Left alone, ezdxf declares the classes in use in the order of their hashes.
    for name in sorted(document.entitydb.dxf_types_in_use()):
        document.classes.add_class(name)
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue()


def text_width(text: str) -> float:
    """Width of a line of text, on the safe side: in heights of its capitals."""
    wide = sum(east_asian_width(letter) in "WF" for letter in text)
    return _LETTER * (len(text) + wide)
