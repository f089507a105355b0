"""Files are written whole or not at all: beside their target, then renamed over it.

A process that is killed cannot tidy up: what it was writing stays beside the target, hidden.
The next one that writes the same target removes it, once it is a day old: what is younger may
still be in the making.
"""

import glob
import os
import shutil
import tempfile
import time
from collections.abc import Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from ..kernel.errors import InputError

MARK: Final = "spheremesh-"
"""In the names of temporary files and folders, which nobody else would choose."""

_RANDOM: Final = "????????"
"""What `tempfile` puts into names."""

_LONGEST: Final = 200
"""Bytes of a name that are kept in that of its temporary file: systems end names at 255."""

_ABANDONED: Final = 86400.0
"""Age in seconds at which what is unfinished is nobody's."""


def check_suffix(path: str | os.PathLike[str], *suffixes: str) -> None:
    """Refuse a file name that does not say what will be in the file.

    Parameters
    ----------
    *suffixes : str
        What its name may end in, in lower case.

    Raises
    ------
    InputError
        If it ends in something else.
    """
    if Path(path).suffix.lower() not in suffixes:
        raise InputError(f"cannot write {path}: end the name in {' or '.join(suffixes)}")


def check_target(path: str | os.PathLike[str]) -> None:
    """Refuse a file that cannot be there.

    Raises
    ------
    InputError
        If its folder does not exist, it is a folder itself, there is such a file and it is
        read-only, or no file can have that name.
    """
    target = Path(path)
    folder = target.parent
    try:
        has_folder, is_folder = folder.is_dir(), target.is_dir()
        # A rename would pass over the mark of a file that is to stay.
        is_read_only = target.exists() and not os.access(target, os.W_OK)
    except (OSError, ValueError) as error:
        raise unwritable(target, error) from error
    if not has_folder:
        raise InputError(f"cannot write {target}: there is no folder {folder}; create it first")
    if is_folder:
        raise InputError(f"cannot write {target}: it is a folder; name a file in it")
    if is_read_only:
        raise InputError(f"cannot write {target}: it is read-only; choose another name")


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Generator[Path]:
    """A temporary path beside `path` that takes its place when the block succeeds.

    Yields
    ------
    Path
        Where to write. It has the suffix of `path`. When the block raises, it is removed and
        an older file at `path` stays as it was.

    Raises
    ------
    InputError
        If the folder does not exist, or the file cannot be written: no rights, a full disk, a
        program that holds it.
    """
    check_target(path)
    target = Path(path)
    stem = os.fsencode(target.stem)[:_LONGEST].decode(errors="ignore")
    prefix, suffix = f".{stem}-{MARK}", target.suffix
    try:
        handle, name = tempfile.mkstemp(dir=target.parent, prefix=prefix, suffix=suffix)
    except (OSError, ValueError) as error:
        raise unwritable(target, error) from error
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        with temporary.open("r+b") as written:  # Windows refuses fsync if only for reading
            os.fsync(written.fileno())
        temporary.chmod(0o666 & ~_umask())
        temporary.replace(target)
    except OSError as error:
        raise unwritable(target, error) from error
    finally:
        with suppress(OSError):  # Windows keeps what a program holds: the next one tidies up
            temporary.unlink(missing_ok=True)
    tidy(target.parent, prefix, suffix)


def tidy(folder: Path, prefix: str, suffix: str = "") -> None:
    """Remove what killed processes have left of a target; what resists stays."""
    with suppress(OSError):
        for left in folder.glob(glob.escape(prefix) + _RANDOM + glob.escape(suffix)):
            if time.time() - left.stat().st_mtime > _ABANDONED:
                shutil.rmtree(left) if left.is_dir() else left.unlink()


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def unwritable(target: Path, error: OSError | ValueError) -> InputError:
    """What to raise where the system refuses to write a file."""
    reason = getattr(error, "strerror", None) or error
    return InputError(
        f"cannot write {target}: {reason}; check the name, the disk, and whether a program has "
        "the file open"
    )
