"""Files of a job move into their folder together, one job at a time.

No system renames several files at once. So what is whole stands in one hidden folder before
the first file moves, and signals that end programs wait until the last one has. Who is killed
even so leaves that folder: the next one that writes there moves the rest.
"""

import os
import shutil
import signal
import tempfile
import threading
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from ..kernel.errors import InputError
from .files import MARK, check_target, tidy, unwritable
from .locks import locked_file

_WHOLE: Final = f".{MARK}whole-"
"""How folders begin whose files are all there, and move."""

_LOCK: Final = f".{MARK}lock"

_PATIENCE: Final = 60.0
"""Seconds: moves take milliseconds."""

_ENDING: Final = ("SIGINT", "SIGTERM", "SIGHUP")
"""Signals that end programs; not every system has all of them."""


@contextmanager
def replacing_all(folder: str | os.PathLike[str]) -> Generator[Path]:
    """A temporary folder whose files move into `folder` together when the block succeeds.

    Parameters
    ----------
    folder : path
        Folder to write into; made if it does not exist. What an earlier job did not come to
        move there, as it was killed, is moved first.

    Yields
    ------
    Path
        Where to write; what goes into a folder below stands in one of the same name. When the
        block raises, nothing of it is left, nor a folder made here.
        The files move in the order in which they were written: whoever is killed meanwhile
        leaves whole files, and the last one is new only if all are.

    Raises
    ------
    InputError
        If the folder cannot be made or written to, or one of the files cannot.
    """
    target = Path(folder)
    made = [path for path in (target, *target.parents) if not path.exists()]
    try:
        target.mkdir(parents=True, exist_ok=True)
        finish_moves(target)
        temporary = Path(tempfile.mkdtemp(dir=target, prefix=f".{MARK}"))
    except OSError as error:
        _remove_empty(made)
        raise InputError(
            f"cannot write into the folder {target}: {error.strerror}; choose another"
        ) from error
    whole = temporary.with_name(_WHOLE + temporary.name.removeprefix(f".{MARK}"))
    try:
        yield temporary
        with _one_at_a_time(target), _signals_waiting():
            temporary.rename(whole)
            try:
                _move_all(whole, target)
            finally:
                shutil.rmtree(whole, ignore_errors=True)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)
        _remove_empty(made)
    tidy(target, f".{MARK}")


def finish_moves(folder: Path) -> None:
    """Move what a killed job did not come to move; what was changed since stays.

    Parameters
    ----------
    folder : Path
        Where jobs write.
    """
    if not any(folder.glob(f"{_WHOLE}*")):
        return
    with _one_at_a_time(folder), _signals_waiting():
        for whole in folder.glob(f"{_WHOLE}*"):
            killed = whole.stat().st_mtime_ns
            for path in _files(whole):
                target = folder / path.relative_to(whole)
                if os.path.lexists(target) and target.lstat().st_mtime_ns > killed:
                    path.unlink()
            _move_all(whole, folder)
            shutil.rmtree(whole)


def _move_all(whole: Path, folder: Path) -> None:
    """Move all files of one folder to their places in another, if all have one."""
    files = _files(whole)
    targets = [folder / path.relative_to(whole) for path in files]
    for target in targets:
        check_target(target)
    for path, target in zip(files, targets, strict=True):
        try:
            path.replace(target)
        except OSError as error:
            raise unwritable(target, error) from error


def _files(folder: Path) -> list[Path]:
    """The files below a folder in the order in which they were written."""
    files = [path for path in folder.rglob("*") if not path.is_dir()]
    return sorted(files, key=lambda path: path.stat().st_mtime_ns)


@contextmanager
def _one_at_a_time(folder: Path) -> Generator[None]:
    """Hold a folder against other jobs while files move into it."""
    end = time.monotonic() + _PATIENCE

    def _check() -> None:
        if time.monotonic() > end:
            raise InputError(
                f"cannot write into the folder {folder}: another job has been moving its files "
                f"there for {_PATIENCE:g} s; end that one, or choose another folder"
            )

    with locked_file(folder / _LOCK, _check):
        yield


@contextmanager
def _signals_waiting() -> Generator[None]:
    """Hold back signals that end the program until the block is done."""
    if threading.current_thread() is not threading.main_thread():
        yield  # signals reach the main thread alone
        return
    came: list[int] = []
    note: Callable[[int, object], None] = lambda number, _frame: came.append(number)  # noqa: E731
    numbers = [getattr(signal, name) for name in _ENDING if hasattr(signal, name)]
    handlers = {number: signal.getsignal(number) for number in numbers}
    # A handler that is not Python's cannot be put back: it stays where it is.
    before = {number: each for number, each in handlers.items() if each is not None}
    for number in before:
        signal.signal(number, note)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for number in came:
            signal.raise_signal(number)


def _remove_empty(folders: list[Path]) -> None:
    for folder in folders:
        if folder.is_dir() and not any(folder.iterdir()):
            folder.rmdir()
