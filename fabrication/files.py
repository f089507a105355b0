"""Files are written whole or not at all: beside their target, then renamed over it."""

import os
import shutil
import tempfile
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from ..kernel.errors import InputError


def check_suffix(path: str | os.PathLike[str], *suffixes: str) -> None:
    """
    Refuse a file name that does not say what will be in the file.

    Parameters
    ----------
    path : path
        File to write.
    *suffixes : str
        What its name may end in, in lower case.

    Raises
    ------
    InputError
        If it ends in something else.
    """
    if Path(path).suffix.lower() not in suffixes:
        raise InputError(f"cannot write {path}: end the name in {' or '.join(suffixes)}")


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


@contextmanager
def replacing_all(folder: str | os.PathLike[str]) -> Generator[Path]:
    """
    A temporary folder whose files move into `folder` together when the block succeeds.

    Parameters
    ----------
    folder : path
        Folder to write into; made if it does not exist.

    Yields
    ------
    Path
        Where to write. When the block raises, nothing of it is left, nor a folder made here.

    Raises
    ------
    InputError
        If the folder cannot be made or written to.
    """
    target = Path(folder)
    made = [path for path in (target, *target.parents) if not path.exists()]
    try:
        target.mkdir(parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(dir=target, prefix=".spheremesh-"))
    except OSError as error:
        _remove_empty(made)
        raise InputError(
            f"cannot write into the folder {target}: {error.strerror}; choose another"
        ) from error
    try:
        yield temporary
        for written in sorted(temporary.iterdir()):
            written.replace(target / written.name)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)
        _remove_empty(made)


def _remove_empty(folders: list[Path]) -> None:
    for folder in folders:
        if folder.is_dir() and not any(folder.iterdir()):
            folder.rmdir()
