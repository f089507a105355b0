"""Runs a function in a process of its own, with limits on time and memory.

rhino3dm reads damaged files without looking: it may loop for ever, ask for gigabytes, or end
the process. A fresh interpreter is started for every call: nothing is forked, ``__main__`` is
not run again, and threads, notebooks and workers may call it alike. Where there is none to
start (frozen programs, browsers) the function runs here, without limits.
"""

import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from queue import Empty, SimpleQueue
from typing import IO, Final, ParamSpec, TypeVar, cast

from ...kernel.errors import InputError, SpheremeshError

P = ParamSpec("P")
T = TypeVar("T")

QUIET_SECONDS: Final = 3
"""Time of the processor until the next `allow_seconds`, which may ask for more; rhino3dm reads
tens of megabytes a second."""

SLOWNESS: Final = 10
"""How much slower the clock may be: machines are busy; some cannot limit that time."""

MEMORY: Final = 384 * 2**20
"""Bytes that may be used beyond those of the libraries, and beyond PER_BYTE."""

PER_BYTE: Final = 24
"""Bytes that may be used for each byte of the arguments: the file, its objects, copies."""

BYTES_PER_SECOND: Final = 2**20
"""Arguments of so many bytes lengthen the time by a second."""

_PROGRAM: Final = (
    "import pickle, sys; sys.path[:] = pickle.load(sys.stdin.buffer); "
    f"from {__name__} import serve; serve()"
)
_ALIVE, _RESULT, _ERROR = b".", b"+", b"-"
_FAILURE: Final = (
    "Rhino's library fails on it, or takes too much time or memory: the file is damaged; open "
    "it in Rhino, audit it (Audit3dmFile) and save it again"
)


class _Limits:
    """What `allow_seconds` works with; set in the process that is limited."""

    pipe: "IO[bytes] | None" = None
    seconds: int = 0


def isolated(function: Callable[P, T], *arguments: P.args, **options: P.kwargs) -> T:
    """What a function returns, run in a process of its own.

    Parameters
    ----------
    function : callable
        A function of a module; it may call `allow_seconds`.
    *arguments, **options
        What it takes; these and its result are pickled.

    Returns
    -------
    object
        Its result. Its errors are raised here.

    Raises
    ------
    InputError
        If the process dies, takes too long, or uses too much memory.
    """
    if not _can_start():
        return function(*arguments, **options)
    call = pickle.dumps((function, arguments, options), protocol=5)
    with _start() as child:
        lines: SimpleQueue[tuple[bytes, bytes]] = SimpleQueue()
        pipe = cast("IO[bytes]", child.stdout)
        threading.Thread(target=_listen, args=(pipe, lines), daemon=True).start()
        threading.Thread(target=_tell, args=(child.stdin, call), daemon=True).start()
        sign, content = _ALIVE, b"%d" % QUIET_SECONDS
        try:
            while sign == _ALIVE:
                sign, content = lines.get(timeout=SLOWNESS * int(content))
        except Empty:
            sign = b""
        finally:
            child.kill()
    if not sign:
        raise InputError(_FAILURE)
    result = pickle.loads(content)  # noqa: S301 - from our own process
    if sign == _ERROR:
        raise result
    return cast("T", result)


def allow_seconds(seconds: int = QUIET_SECONDS) -> None:
    """Begin a part of the work that may take so long; does nothing in other processes.

    Parameters
    ----------
    seconds : int
        Time of the processor from now on; large arguments have more.
    """
    pipe = _Limits.pipe
    if pipe is None:
        return
    seconds += _Limits.seconds
    _limit_time(seconds)
    pipe.write(b"%b%d\n" % (_ALIVE, seconds))
    pipe.flush()


def serve() -> None:
    """What the process of its own does: the call on standard input, its result to output."""
    pipe = os.fdopen(os.dup(1), "wb")
    silence = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silence, 1)  # libraries may print
    os.dup2(silence, 2)
    size = int(sys.stdin.buffer.readline())
    function, arguments, options = pickle.loads(sys.stdin.buffer.read(size))  # noqa: S301
    _Limits.pipe, _Limits.seconds = pipe, size // BYTES_PER_SECOND
    _limit_memory(MEMORY + PER_BYTE * size)
    allow_seconds()
    try:
        sign, content = _RESULT, function(*arguments, **options)
    except (SpheremeshError, ImportError) as error:
        sign, content = _ERROR, error
    except Exception as error:  # noqa: BLE001 - whatever rhino3dm makes of a damaged file
        cause = f"{type(error).__name__}: {error}"
        sign, content = _ERROR, InputError(f"{_FAILURE} ({cause})")
    pipe.write(sign + b"\n" + pickle.dumps(content, protocol=5))
    pipe.flush()
    os._exit(0)  # what is broken by a damaged file need not be tidied up


def _can_start() -> bool:
    is_program = bool(sys.executable) and not getattr(sys, "frozen", False)
    return is_program and sys.platform not in ("emscripten", "wasi")


def _start() -> "subprocess.Popen[bytes]":
    return subprocess.Popen(  # noqa: S603 - our own interpreter
        [sys.executable, "-c", _PROGRAM],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
        creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
    )


def _tell(pipe: IO[bytes], call: bytes) -> None:
    """Where to look for libraries, and the call; a process that dies first says why itself."""
    with suppress(OSError), pipe:
        pipe.write(pickle.dumps(sys.path))
        pipe.write(b"%d\n" % len(call))
        pipe.write(call)


def _listen(pipe: IO[bytes], lines: "SimpleQueue[tuple[bytes, bytes]]") -> None:
    """Hand on each sign with what follows it; no sign at the end of a process that has died."""
    sign = _ALIVE
    with suppress(OSError, ValueError):  # closed when time is up
        while sign == _ALIVE:
            line = pipe.readline()
            sign = line[:1]
            lines.put((sign, line[1:] if sign == _ALIVE else pipe.read()))


def _limit_time(seconds: int) -> None:
    """Processor time from now on, where the system can limit it."""
    with suppress(ImportError):
        import resource

        used = resource.getrusage(resource.RUSAGE_SELF)
        hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
        limit = int(used.ru_utime + used.ru_stime) + 1 + seconds
        with suppress(ValueError, OSError):  # the system's own limit is lower
            resource.setrlimit(resource.RLIMIT_CPU, (limit, hard))


def _limit_memory(more: int) -> None:
    """Address space beyond what is in use, where the system tells that (Linux)."""
    with suppress(ImportError, OSError, ValueError):
        import resource
        from pathlib import Path

        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
        hard = resource.getrlimit(resource.RLIMIT_AS)[1]
        limit = pages * resource.getpagesize() + more
        resource.setrlimit(resource.RLIMIT_AS, (limit, hard))
