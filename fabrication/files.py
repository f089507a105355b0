"""Files are written whole or not at all: beside their target, then renamed over it."""

import os
import tempfile
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from ..kernel.errors import InputError


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Generator[Path]:
    """
    A temporary path beside `path` that takes its place when the block succeeds.

    Parameters
    ----------
    path : path
        File to write.

    Yields
    ------
    Path
        Where to write. It has the suffix of `path`. When the block raises, it is removed and
        an older file at `path` stays as it was.

    Raises
    ------
    InputError
        If the folder does not exist or cannot be written to.
    """
    target = Path(path)
    folder = target.parent
    if not folder.is_dir():
        raise InputError(f"cannot write {target}: there is no folder {folder}; create it first")
    if target.is_dir():
        raise InputError(f"cannot write {target}: it is a folder; name a file in it")
    try:
        handle, name = tempfile.mkstemp(
            dir=folder, prefix=f".{target.stem}-", suffix=target.suffix
        )
    except OSError as error:
        raise InputError(f"cannot write {target}: {error.strerror}") from error
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        temporary.chmod(0o666 & ~_umask())
        with temporary.open("rb") as written:
            os.fsync(written.fileno())
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
