"""The graph that is open: what it is now, what it was before, and where it is kept."""

import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from threading import RLock, Timer
from typing import Any, Final

from ...nodes.graphs.errors import GraphError
from ...nodes.graphs.graph import Graph
from ...nodes.graphs.specification.encoding import Contents
from ...nodes.graphs.specification.file import content_of, encode_graph, write_graph
from ...nodes.graphs.specification.specification import Specification
from .operations import Operation, applied

MOST_UNDONE: Final = 400
SAVED_AFTER: Final = 0.6
"""Seconds of rest until the file is written."""
HISTORY: Final = ".history"
MOST_KEPT: Final = 40
"""Earlier versions of a file."""
APART: Final = 120.0
"""Seconds between two of them."""


class StaleError(Exception):
    """An edit of a graph that has been changed since."""


class Document:
    """A graph that several pages edit: undo is a list of graphs.

    Parameters
    ----------
    specification : Specification
    path : Path, optional
        Its file; without one nothing is saved.
    on_change : callable
        Called with the revision after every change.
    """

    def __init__(
        self,
        specification: Specification,
        path: Path | None = None,
        on_change: Callable[[int], None] = lambda _: None,
    ) -> None:
        self.path = path
        self.rev = 1
        self.save_fault = ""
        self._now = specification
        self._past: list[Specification] = []
        self._future: list[Specification] = []
        self._gesture = ""
        self._on_change = on_change
        self._timer: Timer | None = None
        self._saved = _text_of(path)
        self._kept = 0.0
        self._lock = RLock()

    @property
    def specification(self) -> Specification:
        """The graph as it is now."""
        return self._now

    def edit(self, rev: int, operations: Sequence[Operation], gesture: str = "") -> int:
        """Change the graph; the new revision.

        Operations of one gesture, such as the drag of a slider, are undone together. Raises
        StaleError if the page does not know the present graph, GraphError if an operation
        cannot be done.
        """
        with self._lock:
            if rev != self.rev:
                raise StaleError
            contents: Contents = {}
            content_of(self._now, contents)
            after = applied(self._now, operations, contents)
            if after is self._now:
                return self.rev
            if not gesture or gesture != self._gesture:
                self._past = [*self._past[1 - MOST_UNDONE :], self._now]
            self._gesture = gesture
            self._future = []
            return self._become(after)

    def undo(self) -> int:
        """Take back the last edit, if there is one; the revision."""
        return self._step(self._past, self._future)

    def redo(self) -> int:
        """Do again what was taken back; the revision."""
        return self._step(self._future, self._past)

    def replace(self, specification: Specification, path: Path | None) -> int:
        """Open another graph; the one before is saved, and its edits are forgotten."""
        self.save()
        with self._lock:
            self._past, self._future = [], []
            self.path, self._saved, self._kept = path, _text_of(path), 0.0
            rev = self._become(specification)
            # What was only opened is not written.
            self._drop_timer()
            return rev

    def revert(self, specification: Specification) -> int:
        """Put another graph in the place of this one, as an edit that can be undone."""
        with self._lock:
            self._past = [*self._past, self._now]
            self._future, self._gesture = [], ""
            return self._become(specification)

    def content(self) -> dict[str, Any]:
        """What the pages are told of it; meshes and long arrays by digest alone."""
        with self._lock:
            return {
                "rev": self.rev,
                "undo": len(self._past),
                "redo": len(self._future),
                "file": self.path.name if self.path else "",
                "is_new": self._is_untouched(),
                "fault": self.save_fault,
                "graph": content_of(self._now, {}),
            }

    def save(self) -> None:
        """Write the file now, if something has changed."""
        with self._lock:
            self._drop_timer()
            if self.path is None:
                return
            try:
                text = encode_graph(self._now, {})
                if text != self._saved:
                    self._keep_version()
                    self.path.parent.mkdir(parents=True, exist_ok=True)
                    write_graph(self.path, self._now)
                    self._saved = _text_of(self.path)
                self.save_fault = ""
            except (OSError, GraphError) as error:
                self.save_fault = f"cannot save {self.path.name}: {error}"

    def versions(self) -> list[Path]:
        """Earlier versions of the file, the latest first."""
        folder = self._history_folder()
        return sorted(folder.glob("*.json"), reverse=True) if folder else []

    def _is_untouched(self) -> bool:
        """Whether there is no file yet: a template is written with its first edit."""
        return not self._past and self.path is not None and not self.path.exists()

    def _history_folder(self) -> Path | None:
        return None if self.path is None else self.path.with_suffix(HISTORY)

    def _keep_version(self) -> None:
        """Keep what stands in the file: now and then, and always if others have changed it."""
        folder, now = self._history_folder(), time.time()
        if self.path is None or folder is None or not self.path.is_file():
            return
        is_foreign = _text_of(self.path) != self._saved
        if not is_foreign and now - self._kept < APART:
            return
        folder.mkdir(exist_ok=True)
        stamp = time.strftime("%Y-%m-%d %H-%M-%S", time.localtime(now))
        (folder / f"{stamp}.json").write_bytes(self.path.read_bytes())
        self._kept = now
        for old in self.versions()[MOST_KEPT:]:
            with suppress(OSError):
                old.unlink()

    def _step(self, there: list[Specification], here: list[Specification]) -> int:
        with self._lock:
            if not there:
                return self.rev
            here.append(self._now)
            self._gesture = ""
            return self._become(there.pop())

    def _become(self, specification: Specification) -> int:
        self._now = specification
        self.rev += 1
        self._drop_timer()
        if self.path is not None:
            self._timer = Timer(SAVED_AFTER, self.save)
            self._timer.daemon = True
            self._timer.start()
        self._on_change(self.rev)
        return self.rev

    def _drop_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None


def opened(path: Path) -> Specification:
    """The graph of a file; steps that cannot be run are kept as they are."""
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of steps of other versions
        return Graph.load(path, unfinished=True).specification


def _text_of(path: Path | None) -> str:
    try:
        return "" if path is None else path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return ""
