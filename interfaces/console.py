"""How commands end and what they say meanwhile: errors in one line, exit codes, progress."""

import signal
import sys
import traceback
import warnings
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

if TYPE_CHECKING:
    from .panel.job import Progress

FAULT: Final = 1
BAD_INPUT: Final = 3
NOT_CONVERGED: Final = 4
GATE_FAILED: Final = 5


_ENDING: Final = ("SIGINT", "SIGTERM", "SIGHUP")
"""Signals that end a program; not every system has all of them."""


def tidy_up_on_signals() -> None:
    """Let signals end the program as errors do, so that no file is left that is not whole.

    The exit code is that of shells, 128 and the number of the signal: 130 after Ctrl+C, 143
    after SIGTERM. What comes while the program tidies up is ignored.
    """
    numbers = [getattr(signal, name) for name in _ENDING if hasattr(signal, name)]

    def _end(number: int, _frame: object) -> None:
        for each in numbers:
            signal.signal(each, signal.SIG_IGN)
        sys.exit(128 + number)

    for each in numbers:
        # Who starts us may want a signal ignored, as nohup does.
        if signal.getsignal(each) is not signal.SIG_IGN:
            signal.signal(each, _end)


@contextmanager
def told_errors() -> Generator[None]:
    """Turn the library's errors into one line and an exit code."""
    from ..kernel.errors import ConvergenceError, MissingLibraryError, SpheremeshError
    from ..nodes.graphs.errors import GraphError, NodeError

    try:
        # Warnings of nodes are part of the report; they are printed with it.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except BrokenPipeError:
        raise  # whoever reads our output has seen enough; click ends in silence
    except (SpheremeshError, GraphError, NodeError, OSError) as error:
        cause = error.cause if isinstance(error, NodeError) else error
        text = error.reason if isinstance(error, NodeError) else str(error)
        code = NOT_CONVERGED if isinstance(cause, ConvergenceError) else BAD_INPUT
        if isinstance(cause, MissingLibraryError):
            code = FAULT
        # An OSError is the disk's or the system's: full, too many files.
        elif not isinstance(cause, SpheremeshError | GraphError | OSError):
            text, code = f"{error} ({_origin(cause)}): a fault of the node, report it", FAULT
        message = " ".join(text.split())
        click.echo(f"spheremesh: {message}", err=True)
        sys.exit(code)


def _origin(error: BaseException | None) -> str:
    """Kind of an error that no input should cause, and the line that raised it."""
    where = (
        traceback.extract_tb(error.__traceback__)[-1] if error and error.__traceback__ else None
    )
    at = f", {Path(where.filename).name} line {where.lineno}" if where else ""
    return type(error).__name__ + at


@contextmanager
def shown_progress() -> "Generator[Progress]":
    """Show the running step on a terminal; stay silent elsewhere."""
    if not sys.stderr.isatty():
        yield lambda _step, _state: None
        return
    from rich.console import Console

    console = Console(stderr=True)
    with console.status("reading") as status:

        def _show(step: str, state: str) -> None:
            if state == "running":
                status.update(step)
            else:
                console.print(f"{step}: {state}", style="dim")

        yield _show
