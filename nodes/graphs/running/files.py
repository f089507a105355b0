"""The files of a run: where paths lead, and that no step writes over what another reads."""

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias, TypeGuard, cast

from ....fabrication.output_folder import OutputFolder
from ..annotations import Value
from ..errors import GraphError
from ..ports import Port
from ..specification.wires import Each, Param, Step, Wire, sources

_Key: TypeAlias = str | tuple[int, int]


@dataclass(frozen=True, eq=False)
class Folders:
    """Where the relative paths of a run are; in the working directory by default.

    Attributes
    ----------
    read_from : Path, optional
    write_to : Path or OutputFolder, optional
        An output folder also says where a step may not write.
    """

    read_from: Path | None = None
    write_to: Path | OutputFolder | None = None

    @property
    def is_staged(self) -> bool:  # numpydoc ignore=RT01
        """Whether files are written elsewhere and moved when the job is done."""
        folder = self.write_to
        return isinstance(folder, OutputFolder) and folder.staging != folder.folder.absolute()

    @property
    def is_overwriting(self) -> bool:  # numpydoc ignore=RT01
        """Whether the user allows to replace what is read."""
        return isinstance(self.write_to, OutputFolder) and self.write_to.overwrite

    def source(self, value: Value) -> Value:
        """The paths of an input that reads; paths and lists of them alike."""
        folder = self.read_from
        return value if folder is None else _each_path(value, partial(_beside, folder))

    def target(self, value: Value) -> Value:
        """The paths that an input that writes is told, for the time being."""
        folder = self.write_to
        if isinstance(folder, OutputFolder):
            return _each_path(value, lambda path: str(folder.place(path)))
        return value if folder is None else _each_path(value, partial(_beside, folder))

    def end(self, path: str) -> Path:
        """Where a file that is written will be when the run is over."""
        if isinstance(self.write_to, OutputFolder):
            return self.write_to.located(path)
        return Path(_beside(self.write_to, path))

    def check(self, path: str) -> None:
        """Refuse a file that would be where it must not."""
        if isinstance(self.write_to, OutputFolder):
            self.write_to.check(path)

    def as_given(self, text: str) -> str:
        """A message without the folder of the run, which is none of the user's."""
        folder = self.write_to
        folder = folder.staging if isinstance(folder, OutputFolder) else folder
        return text if folder is None else text.replace(f"{folder}{os.sep}", "")


@dataclass(frozen=True, eq=False)
class FileUses:
    """Which step reads a file, and which writes it; files are told apart as the disk does.

    Attributes
    ----------
    readers, writers : dict of key to str
        ``step.port`` by path and by number on the disk.
    """

    folders: Folders
    readers: dict[_Key, str] = field(default_factory=dict[_Key, str])
    writers: dict[_Key, str] = field(default_factory=dict[_Key, str])

    def note(self, step: Step, port: Port, given: Value) -> None:
        """Note the files of an input.

        Parameters
        ----------
        given : object
            Its paths, as the graph gives them.

        Raises
        ------
        GraphError
            If a step would write over what a step reads.
        InputError
            If it would write where it must not.
        """
        where = f"{step.name}.{port.name}"
        for path in paths_of(given):
            if port.writes:
                keys = _keys(self.folders.end(path))
                self.writers.update(dict.fromkeys(keys, where))
                self._refuse(path, keys, self.readers, where)
                self.folders.check(path)
            else:
                keys = _keys(Path(cast("str", self.folders.source(path))))
                self.readers.update(dict.fromkeys(keys, where))
                self._refuse(path, keys, self.writers, where)

    def _refuse(
        self, path: str, keys: Iterable[_Key], others: Mapping[_Key, str], where: str
    ) -> None:
        other = next((others[key] for key in keys if key in others), None)
        if other is None or self.folders.is_overwriting:
            return
        writer, reader = (other, where) if others is self.writers else (where, other)
        advice = "choose another name"
        if isinstance(self.folders.write_to, OutputFolder):
            advice = "choose another folder or name, or --overwrite"
        raise GraphError(f"{writer} would write over {path}, which {reader} reads; {advice}")


def note_known_files(uses: FileUses, steps: Iterable[Step], values: Mapping[str, Any]) -> None:
    """Note the files that are known before anything is run, and refuse what must not be.

    Parameters
    ----------
    uses : FileUses
    steps : iterable of Step
    values : mapping of str to object
        Of the sliders.

    Raises
    ------
    GraphError, InputError
        As `FileUses.note` does.
    """
    files = [
        (step, port, step.inputs.get(port.name, port.default))
        for step in steps
        for port in step.node.file_inputs
    ]
    # Those that are read first, so that the message says which step reads a file.
    for step, port, given in sorted(files, key=lambda each: each[1].writes):
        if not is_wired(given):
            uses.note(step, port, _literal(given, values))


def is_file(port: Port) -> bool:
    """Whether an input is a path."""
    return port.reads or port.writes


def is_wired(given: Value) -> bool:
    """Whether a value comes from another step."""
    return any(isinstance(source, Wire) for source in sources(given))


def is_written(given: Value) -> bool:
    """Whether a path comes from a step that writes."""
    return any(isinstance(w, Wire) and w.step.node.is_writer for w in sources(given))


def paths_of(value: Value) -> list[str]:
    """The files of an input that takes paths: none, one, or one for each item."""
    if _is_path(value):
        return [os.fspath(value)]
    if not isinstance(value, list | tuple):
        return []
    return [path for item in cast("Sequence[Value]", value) for path in paths_of(item)]


def _is_path(value: Value) -> TypeGuard[str | os.PathLike[str]]:
    """Some inputs take a path or a value of another kind."""
    return isinstance(value, str | os.PathLike)


def _literal(given: Value, values: Mapping[str, Any]) -> Value:
    if isinstance(given, Each):
        return _literal(given.items, values)
    if isinstance(given, Param):
        return values[given.name]
    if isinstance(given, list | tuple):
        return [_literal(item, values) for item in cast("list[Value]", given)]
    return given


def _each_path(value: Value, change: Callable[[str], Value]) -> Value:
    """Paths changed; what is no path stays as it is."""
    if isinstance(value, list | tuple):
        return [_each_path(path, change) for path in cast("list[Value]", value)]
    return change(os.fspath(value)) if _is_path(value) else value


def _beside(folder: Path | None, path: str) -> str:
    return path if folder is None else str(folder / path)


def _keys(path: Path) -> list[_Key]:
    """What is the same for all spellings of a path; nothing for what cannot be one."""
    keys: list[_Key] = []
    with suppress(OSError, ValueError):
        keys.append(os.path.normcase(os.path.realpath(path)))
        status = path.stat()
        keys.append((status.st_dev, status.st_ino))
    return keys
