"""Results on disk: shared by processes, bounded in bytes, whole or not there.

Below the folder, ``entries`` holds a file a key: a line with the digest of the rest, then JSON.
``blocks`` holds the arrays of all entries, each by its digest, so equal arrays are stored once.
Files are renamed into place, and every byte is held to its digest when read: what a killed
process or a full disk left behind is found out, removed and made again. ``locks`` holds an
empty file for each result in the making.
"""

import json
import os
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Final, NamedTuple

import xxhash

from ....fabrication.locks import locked_file
from ..annotations import Value
from ..errors import GraphError
from .digests import FileState, content_state
from .entries import Entry
from .flights import Flights
from .memory import MOST_BYTES as MEMORY_BYTES
from .memory import MemoryStore
from .origins import code_origin
from .packing import PackingError, block_name, pack, unpack

MOST_BYTES: Final = 2**32
_MARK: Final = b"spheremesh result 1 "
_DIGEST: Final = 32
"""Hexadecimal digits."""
_FILL: Final = 0.9
"""How full the folder is after it was tidied up."""
_SHARE: Final = 1 / 20
"""Of the bound: how much a process writes until it looks again."""
_ABANDONED: Final = 3600.0
"""Age in seconds at which an unfinished file is nobody's."""
_UNFINISHED: Final = ".unfinished-"
_PROCESS: Final = f"process {os.getpid()} {time.time_ns()}"
_DAMAGE: Final = (ValueError, TypeError, LookupError, AttributeError, ImportError)


def user_cache_folder() -> Path:
    """Where results are kept by default: the user's cache folder, or ``SPHEREMESH_CACHE``.

    Returns
    -------
    Path
        It need not exist.
    """
    chosen = os.environ.get("SPHEREMESH_CACHE")
    if chosen:
        return Path(chosen)
    home = Path.home()
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", home)) / "spheremesh" / "Cache"
    if sys.platform == "darwin":
        return home / "Library" / "Caches" / "spheremesh"
    return Path(os.environ.get("XDG_CACHE_HOME") or home / ".cache") / "spheremesh"


class DiskStore:
    """Results on disk, those of late in memory as well.

    Parameters
    ----------
    folder : path
        Made if it does not exist; any number of processes may share it.
    most_bytes : int
        How much is kept there.
    memory_bytes : int
        How much of it is kept in memory as well.

    Raises
    ------
    GraphError
        If the folder cannot be made.
    """

    def __init__(
        self,
        folder: str | os.PathLike[str],
        most_bytes: int = MOST_BYTES,
        memory_bytes: int = MEMORY_BYTES,
    ) -> None:
        self.folder = Path(folder).absolute()
        self.most_bytes = most_bytes
        self.memory = MemoryStore(memory_bytes, states=content_state)
        self._flights = Flights()
        self._messages: dict[bytes, tuple[str, ...]] = {}
        self._unlooked = int(most_bytes * _SHARE)
        self._lock = threading.Lock()
        try:
            for name in ("entries", "blocks", "locks"):
                (self.folder / name).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise GraphError(
                f"cannot keep results in {self.folder}: {error.strerror}; choose another folder"
            ) from error

    def get(self, key: bytes) -> Entry | None:
        """The result of a key, from memory or from disk.

        Returns
        -------
        Entry or None
            None too if a file that it wrote is gone or has changed, or if what is there is
            damaged.
        """
        entry = self.memory.get(key)
        if entry is not None:
            return entry
        entry = self._read(key)
        if entry is None or any(content_state(path) != state for path, state in entry.files):
            return None
        self.memory.put(key, entry)
        return entry

    def put(self, key: bytes, entry: Entry, *, is_lasting: bool = True) -> int:
        """Keep a result in memory and, where it has a form on disk, there.

        Parameters
        ----------
        is_lasting : bool
            Whether another process could ever ask for it.

        Returns
        -------
        int
            Bytes of the value in memory.
        """
        size = self.memory.put(key, entry)
        if is_lasting and size < self.most_bytes * _FILL:
            # A full disk or a folder that has gone slows us down, and is no fault of a result.
            with suppress(PackingError, RecursionError, OSError):
                self._write(key, entry)
        return size

    @contextmanager
    def flight(self, key: bytes, check: Callable[[], None]) -> Generator[None]:
        """Keep other threads and processes from making the same result.

        Yields
        ------
        None
            While the block runs, others wait; if we are killed, they do not.
        """
        path = self.folder / "locks" / key.hex()
        with self._flights.one(key, check):
            try:
                held = locked_file(path, check)
                held.__enter__()
            except OSError:  # no locks in that folder: results are right all the same
                yield
                return
            try:
                yield
            finally:
                held.__exit__(None, None, None)

    def messages(self, key: bytes) -> tuple[str, ...]:
        """What a step warned about, from its file if it was made by another process.

        Returns
        -------
        tuple of str
            Empty if it did not.
        """
        found = self.memory.messages(key)
        if found or key in self._messages:
            return found or self._messages[key]
        content = self._content(key)
        if content is None:
            return ()  # not made yet: another process may make it
        self._messages[key] = tuple(content["messages"])
        return self._messages[key]

    def file_state(self, path: str) -> FileState:
        """Size and digest of a file: times mean nothing on another machine.

        Returns
        -------
        FileState
            None if there is none.
        """
        return content_state(path)

    def origin(self, function: Callable[..., Any]) -> str:
        """A fingerprint of the code that gives a result.

        Returns
        -------
        str
            Unique in this process for functions without a source.
        """
        return code_origin(function) or _PROCESS

    def trim(self) -> None:
        """Forget in memory what was not used for longest, down to the bound."""
        self.memory.trim()

    def _entry_path(self, key: bytes) -> Path:
        name = key.hex()
        return self.folder / "entries" / name[:2] / name

    def _block_path(self, name: str) -> Path:
        return self.folder / "blocks" / name[:2] / name

    def _content(self, key: bytes) -> dict[str, Any] | None:
        """The JSON of an entry; None if it is missing, damaged or of another key."""
        path = self._entry_path(key)
        try:
            data = path.read_bytes()
        except OSError:
            return None
        start = len(_MARK) + _DIGEST + 1
        head, body = data[:start], data[start:]
        if head == _MARK + xxhash.xxh3_128_hexdigest(body).encode() + b"\n":
            content = json.loads(body)
            if content["key"] == key.hex():
                return content
        _remove(path)
        return None

    def _read(self, key: bytes) -> Entry | None:
        content = self._content(key)
        if content is None:
            return None
        path = self._entry_path(key)
        try:
            value = unpack(content["value"], self._block)
        except OSError:
            return None
        except _DAMAGE:
            _remove(path)
            return None
        with suppress(OSError):
            os.utime(path)
        files = tuple((path, tuple(state)) for path, state in content["files"])
        return Entry(
            value, tuple(content["messages"]), files, content["seconds"], content["made_by"]
        )

    def _block(self, name: str) -> bytes:
        path = self._block_path(name)
        data = path.read_bytes()
        if block_name(data) != name:
            _remove(path)
            raise ValueError(name)
        with suppress(OSError):
            os.utime(path)
        return data

    def _write(self, key: bytes, entry: Entry) -> None:
        blocks: dict[str, bytes] = {}
        content: dict[str, Value] = {
            "key": key.hex(),
            "value": pack(entry.value, blocks),
            "messages": list(entry.messages),
            "files": [[path, state] for path, state in entry.files if state],
            "seconds": entry.seconds,
            "made_by": entry.made_by,
        }
        if len(content["files"]) < len(entry.files):
            return  # it wrote nothing: it is to run again
        written = 0
        for name, block in blocks.items():
            path = self._block_path(name)
            try:
                os.utime(path)
            except OSError:
                written += _write_whole(path, block)
        body = json.dumps(content, separators=(",", ":")).encode()
        head = _MARK + xxhash.xxh3_128_hexdigest(body).encode() + b"\n"
        written += _write_whole(self._entry_path(key), head + body)
        self._account(written)

    def _account(self, written: int) -> None:
        with self._lock:
            self._unlooked += written
            if self._unlooked < self.most_bytes * _SHARE:
                return
            self._unlooked = 0
        self._tidy()

    def _tidy(self) -> None:
        """Remove the files that were not used for longest, and what killed processes left."""
        now = time.time()
        kept: list[_File] = []
        for file in _files(self.folder):
            is_left = _UNFINISHED in file.path or f"{os.sep}locks{os.sep}" in file.path
            if is_left and now - file.used > _ABANDONED:
                _remove(Path(file.path))
            else:
                kept.append(file)
        total = sum(file.size for file in kept)
        if total <= self.most_bytes:
            return
        for file in sorted(kept, key=lambda each: each.used):
            if total <= self.most_bytes * _FILL:
                return
            _remove(Path(file.path))
            total -= file.size


class _File(NamedTuple):
    path: str
    size: int
    used: float


def _files(folder: Path) -> Generator[_File]:
    pending = [str(folder)]
    while pending:
        with suppress(OSError), os.scandir(pending.pop()) as found:
            for item in found:
                if item.is_dir(follow_symlinks=False):
                    pending.append(item.path)
                    continue
                with suppress(OSError):
                    status = item.stat(follow_symlinks=False)
                    yield _File(item.path, status.st_size, status.st_mtime)


def _write_whole(path: Path, data: bytes) -> int:
    """Write a file beside its place and move it there: nobody sees half of it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=_UNFINISHED)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        Path(name).replace(path)
    except BaseException:
        _remove(Path(name))
        raise
    return len(data)


def _remove(path: Path) -> None:
    with suppress(OSError):
        path.unlink()
