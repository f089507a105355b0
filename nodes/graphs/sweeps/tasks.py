"""One point, wherever it is run: in this process or another, with what JSON can carry."""

import contextlib
import importlib
import json
import time
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any, Final
from uuid import uuid4

from ....fabrication.files import replacing
from ....fabrication.output_folder import OutputFolder
from ..annotations import Value
from ..errors import NodeError
from ..graph import Graph
from ..running.events import RunCancelledError
from ..stores.disk import DiskStore
from ..stores.entries import Store
from ..stores.memory import MemoryStore

RECORD = "point.json"


@dataclass(frozen=True)
class Study:
    """What the points of a sweep have in common.

    Attributes
    ----------
    text : str
        The graph as JSON.
    targets : tuple of str
    modules : tuple of str
        Where its nodes are defined.
    read_from : str
        Folder of the relative paths that are read.
    cache : str
        Folder of the store; empty for one in memory.
    name : str
        Of this sweep alone.
    """

    text: str
    targets: tuple[str, ...]
    modules: tuple[str, ...]
    read_from: str
    cache: str = ""
    name: str = field(default_factory=lambda: uuid4().hex)


@dataclass(frozen=True)
class Outcome:
    """What became of a point.

    Attributes
    ----------
    error : str
        Empty if there is a value.
    """

    value: Any = None
    error: str = ""
    warnings: tuple[str, ...] = ()
    seconds: float = 0.0
    steps_run: int | None = None


@dataclass
class _Count:
    """How many steps a run has run, and how many are left."""

    run: int = field(default=0)

    def note(self, step: str, state: str) -> None:
        del step
        self.run += state == "running"


DIED: Final = "the process that ran it died: out of memory, killed, or a library at fault"
_MOST_STARTS: Final = 2


def run_task(study: Study, number: int, point: Mapping[str, Any], folder: str) -> Outcome:
    """Run a point in a process of its own.

    Parameters
    ----------
    number : int
        Of the point.
    folder : str
        Where its files go; empty for none.

    Returns
    -------
    Outcome
        Failures are outcomes too.
    """
    starts = Path(study.cache, "locks", f"{study.name}-{number}") if study.cache else None
    if starts is not None and not _may_start(starts):
        return Outcome(error=DIED)
    try:
        return _run_anew(study, point, folder)
    finally:
        if starts is not None:
            with contextlib.suppress(OSError):
                starts.unlink()


def _may_start(starts: Path) -> bool:
    """Whether a point has not killed too many processes already: each start adds a byte.

    A scheduler tries again what died, and would lose worker after worker.
    """
    try:
        starts.parent.mkdir(parents=True, exist_ok=True)
        with starts.open("ab") as file:
            file.write(b".")
        return starts.stat().st_size <= _MOST_STARTS
    except OSError:
        return True


def _run_anew(study: Study, point: Mapping[str, Any], folder: str) -> Outcome:
    try:
        for module in study.modules:
            importlib.import_module(module)
        graph = Graph.from_json(study.text, cache=_store(study.cache, study.text))
    except Exception as error:  # noqa: BLE001, whatever it is, the other points go on
        return Outcome(error=_described(error))
    return run_point(graph, study.targets, point, folder, study.read_from)


@lru_cache(maxsize=2)
def _store(folder: str, text: str) -> Store:
    """What the points of one sweep share within a process."""
    del text
    return DiskStore(folder) if folder else MemoryStore()


def run_point(
    graph: Graph,
    targets: tuple[str, ...],
    point: Mapping[str, Any],
    folder: str,
    read_from: str | None = None,
) -> Outcome:
    """Run a point on a graph whose sliders nobody else moves.

    Returns
    -------
    Outcome
        Failures are outcomes too; a folder of files has a ``point.json`` that says so.
    """
    began, count, value, error = time.perf_counter(), _Count(), None, ""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # they are part of the outcome
        try:
            graph.set(**point)
            output = _output(folder) if folder else None
            value = graph.run(
                *targets, on_step=count.note, write_to=output, read_from=read_from
            )
        except RunCancelledError:
            raise
        except Exception as fault:  # noqa: BLE001, whatever it is, the other points go on
            error = _described(fault)
    texts = dict.fromkeys(text for several in graph.messages.values() for text in several)
    outcome = Outcome(value, error, tuple(texts), time.perf_counter() - began, count.run)
    if folder:
        _record(Path(folder), point, outcome)
    return outcome


def _output(folder: str) -> OutputFolder:
    """The folder of a point: all of it is ours, and nothing is written elsewhere."""
    path = Path(folder).absolute()
    path.mkdir(parents=True, exist_ok=True)
    return OutputFolder(path, path, {}, overwrite=True)


def _record(folder: Path, point: Mapping[str, Any], outcome: Outcome) -> None:
    content = {
        "point": {name: _plain(value) for name, value in point.items()},
        "error": outcome.error,
        "warnings": list(outcome.warnings),
        "seconds": round(outcome.seconds, 4),
    }
    with contextlib.suppress(Exception), replacing(folder / RECORD) as temporary:
        temporary.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def _plain(value: Value) -> Value:
    return value if value is None or isinstance(value, bool | int | float | str) else str(value)


def _described(error: Exception) -> str:
    text = " ".join(str(error).split())
    if isinstance(error, NodeError | ValueError):
        return text
    return f"{type(error).__name__}: {text}"
