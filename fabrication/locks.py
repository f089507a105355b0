"""Files that one process holds against others."""

import errno
import os
import sys
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

_FIRST_WAIT: Final = 0.002
_LONGEST_WAIT: Final = 0.1
"""Seconds between two looks at what another process holds."""
_NO_LOCKS: Final = {errno.ENOLCK, errno.ENOSYS, errno.ENOTSUP, errno.EOPNOTSUPP}
"""What file systems say that know no locks: there everybody goes on without."""


@contextmanager
def locked_file(path: Path, check: Callable[[], None]) -> Generator[None]:
    """Hold a file against other processes; the system lets go of it when we are killed.

    Parameters
    ----------
    path : Path
        A file of this purpose, made and removed here.
    check : callable
        Called while waiting; raises to give up.

    Yields
    ------
    None
        While the block runs, other processes wait.
    """
    wait = _FIRST_WAIT
    while (handle := _try_lock(path)) is None:
        time.sleep(wait)
        wait = min(2 * wait, _LONGEST_WAIT)
        check()
    try:
        yield
    finally:
        # Removed while it is held: who opened it meanwhile sees that it is not there any more.
        if sys.platform != "win32":
            with suppress(OSError):
                path.unlink()
        os.close(handle)
        if sys.platform == "win32":
            with suppress(OSError):  # somebody waits for it
                path.unlink()


def _try_lock(path: Path) -> int | None:
    """The open file if it is ours now; None if somebody holds it."""
    try:
        handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    except PermissionError:
        if sys.platform == "win32":  # it is being removed
            return None
        raise
    try:
        _lock(handle)
        if os.path.samestat(os.fstat(handle), path.stat()):
            return handle
    except OSError as error:  # held, or removed since
        if error.errno in _NO_LOCKS:
            return handle
    os.close(handle)
    return None


def _lock(handle: int) -> None:
    if sys.platform == "win32":
        import msvcrt

        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
