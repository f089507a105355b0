"""The bytes of a file, and what they are where they are not what the suffix says."""

import re
import stat
from pathlib import Path
from typing import Final

from ...kernel.errors import InputError

_KINDS: Final = (
    (stat.S_ISDIR, "a folder", "name a file in it"),
    (stat.S_ISFIFO, "a pipe", "save what comes out of it to a file"),
    (stat.S_ISSOCK, "a socket", "name a file"),
    (stat.S_ISCHR, "a device", "name a file"),
    (stat.S_ISBLK, "a device", "name a file"),
)
_OTHER_FORMATS: Final = (
    (re.compile(rb"3D Geometry File Format"), ".3dm"),
    (re.compile(rb"ply[ \t]*[\r\n]"), ".ply"),
    (re.compile(rb"(ST)?C?N?OFF\s"), ".off"),
    (re.compile(rb"solid\b[^\r\n]*[\r\n]+\s*facet\b", re.IGNORECASE), ".stl"),
    (re.compile(rb"glTF"), ".glb"),
    (re.compile(rb"# vtk DataFile"), ".vtk"),
    (re.compile(rb"<VTKFile|<\?xml[^>]*>\s*<VTKFile"), ".vtu"),
    (re.compile(rb"\$MeshFormat"), ".msh"),
)
_NOT_A_MESH: Final = (
    (re.compile(rb"\x1f\x8b|PK\x03\x04|BZh|7z\xbc\xaf|\xfd7zXZ|Rar!"), "compressed: unpack it"),
    (re.compile(rb"version https://git-lfs"), "a pointer of Git LFS: fetch what it stands for"),
    (
        re.compile(rb"\s*<(!doctype|html)", re.IGNORECASE),
        "a web page: fetch the file itself",
    ),
)
_PROBE: Final = 256
"""Bytes that tell what a file is."""


def read_bytes(path: Path) -> bytes:
    """Content of a regular file: pipes and devices may never end.

    Raises
    ------
    InputError
        If there is no such file, it is none, may not be read or is empty.
    """
    try:
        fault = _no_file(path.stat().st_mode)
        data = b"" if fault else path.read_bytes()
    except FileNotFoundError:
        raise InputError(f"cannot read {path}: there is no such file; check the path") from None
    except PermissionError:
        raise InputError(f"cannot read {path}: you may not; change its permissions") from None
    except MemoryError:
        raise InputError(f"cannot read {path}: it is larger than the memory") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"cannot read {path}: {reason}; check the path") from error
    if fault:
        raise InputError(f"cannot read {path}: {fault}")
    if not data.strip():
        raise InputError(f"cannot read {path}: the file is empty; export the mesh again")
    return data


def _no_file(mode: int) -> str:
    """What is there that is no regular file, and what to do."""
    found = (f"it is {kind}; {cure}" for is_kind, kind, cure in _KINDS if is_kind(mode))
    return next(found, "")


def check_kind(data: bytes, suffix: str) -> None:
    """Refuse text in two bytes a letter, packed files, and formats under another's suffix.

    Parameters
    ----------
    data : bytes
        Content of the file.
    suffix : str
        The format that its name says.

    Raises
    ------
    InputError
        If the first bytes are those of something else; the message says what to do.
    """
    start = data[:_PROBE]
    if _is_wide_text(start):
        raise InputError(
            "the file is text in UTF-16; save it as UTF-8 (Notepad: Save as, Encoding UTF-8)"
        )
    for pattern, what in _NOT_A_MESH:
        if pattern.match(start):
            raise InputError(f"the file is {what}")
    for pattern, other in _OTHER_FORMATS:
        if suffix != other and pattern.match(start):
            raise InputError(f"its content is that of a {other} file; rename it to {other}")


def _is_wide_text(start: bytes) -> bool:
    """Whether every other byte of the first letters is 0, as in UTF-16 and UTF-32."""
    has_mark = start.startswith((b"\xff\xfe", b"\xfe\xff"))
    letters = start[2 if has_mark else 0 :][:16]
    for plain, zero in ((letters[::2], letters[1::2]), (letters[1::2], letters[::2])):
        if len(zero) > 1 and not any(zero) and all(0 < byte < 128 for byte in plain):
            return True
    return start.startswith((b"\xff\xfe\0\0", b"\0\0\xfe\xff"))
