"""The folder that a job writes into: nothing of the user's is overwritten there.

What spheremesh wrote it knows again by digest (SHA-256). Those of a panelling stand in its
``report.json`` under ``files``; those of other runs, and of files of earlier panellings that a
later one did not write anew, in the hidden file ``.spheremesh.json`` beside. A file with
another digest was changed since: it is the user's.
"""

import hashlib
import json
import os
import stat
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

from ..kernel.errors import InputError
from .files import check_target
from .folders import replacing_all

REPORT: Final = "report.json"
RECORD: Final = ".spheremesh.json"

_MOST_BYTES: Final = 2**26
"""Of a list of digests: nobody writes a longer one, so it need not be read."""

_NONE: Final[Mapping[str, str]] = {}


@dataclass(frozen=True, eq=False)
class OutputFolder:
    """A folder while a job writes its files, which stand beside until all are whole.

    Attributes
    ----------
    folder : Path
        Where the files will be.
    staging : Path
        Where they are meanwhile.
    known : mapping of str to str
        Digests of what spheremesh wrote earlier, by path within the folder.
    inputs : tuple of Path
        Files that the job is made from.
    renewed : str
        Name of the one file that may take the place of an input: the graph that is run.
    overwrite : bool
        Whether files of the user may be replaced.
    allow_outside : bool
        Whether files may be written elsewhere.
    outside : set of Path
        Where they were.
    digests : mapping of str to str
        Those of the files below `staging` that the report lists: they are not read twice.
    """

    folder: Path
    staging: Path
    known: Mapping[str, str]
    inputs: tuple[Path, ...] = ()
    renewed: str = ""
    overwrite: bool = False
    allow_outside: bool = False
    outside: set[Path] = field(default_factory=set[Path])
    digests: dict[str, str] = field(default_factory=dict[str, str])

    def place(self, path: str | os.PathLike[str]) -> Path:
        """Where to write a file until the job is done.

        Parameters
        ----------
        path : path
            Where it shall be; relative to the folder.

        Returns
        -------
        Path
            Below `staging`; elsewhere for a file outside of the folder.

        Raises
        ------
        InputError
            If it would be outside of the folder and may not.
        """
        target = self.located(path)
        name = self._name(target)
        if name is None:
            self.outside.add(target)
            return target
        staged = self.staging / name
        staged.parent.mkdir(parents=True, exist_ok=True)
        return staged

    def check(self, path: str | os.PathLike[str]) -> None:
        """Refuse a file that cannot be there, or that would replace one of the user's.

        Parameters
        ----------
        path : path
            Where it shall be; relative to the folder.

        Raises
        ------
        InputError
            The message says how to write all the same.
        """
        target = self.located(path)
        name = self._name(target)
        shown = target if name is None else self.folder / name
        check_target(shown)
        if name == RECORD:
            raise InputError(f"cannot write {shown}: spheremesh keeps it; choose another name")
        if self.overwrite or not os.path.lexists(target):
            return
        if any(_is_same(target, source) for source in self.inputs):
            if name == self.renewed:
                return
            raise InputError(
                f"cannot write {shown}: it is what the job is made from; choose another "
                "folder, or --overwrite"
            )
        known = self.known.get(str(target) if name is None else name)
        if known is None:
            raise InputError(
                f"cannot write {shown}: there is a file that spheremesh did not write; choose "
                "another folder, or --overwrite"
            )
        if known != _digest(target):
            raise InputError(
                f"cannot write {shown}: it was changed after spheremesh wrote it; choose "
                "another folder, or --overwrite"
            )

    def write_report(self, report: Mapping[str, Any]) -> dict[str, Any]:
        """Write the report of the job as its last file.

        Parameters
        ----------
        report : mapping

        Returns
        -------
        dict
            The same with ``files``: the digest of each file of the job. That of the report is
            taken with nothing in its own place.
        """
        self.digests.update(_digests(self.staging))
        self.digests.pop(REPORT, None)
        whole = {**report, "files": {**self.digests, REPORT: ""}}
        digest = hashlib.sha256(_text(whole).encode()).hexdigest()
        whole["files"][REPORT] = digest
        (self.staging / REPORT).write_text(_text(whole), encoding="utf-8", newline="\n")
        return whole

    def located(self, path: str | os.PathLike[str]) -> Path:
        """Where a file will be.

        Parameters
        ----------
        path : path
            Where it shall be; relative to the folder.

        Returns
        -------
        Path
            Links to its folder are followed.

        Raises
        ------
        InputError
            If it would be outside of the folder and may not.
        """
        wanted = self.folder / path
        try:
            target = wanted.parent.resolve() / wanted.name
        except (OSError, ValueError, RuntimeError) as error:
            raise InputError(f"cannot write {wanted}: {error}; choose another name") from error
        if wanted.name in ("", "..") or target == self.folder.resolve():
            raise InputError(f"cannot write {wanted}: it is a folder; name a file in it")
        if self._name(target) is None and not self.allow_outside:
            raise InputError(
                f"cannot write {path}: it is outside of the folder {self.folder}; choose a "
                "name in it, or --allow-outside"
            )
        return target

    def _name(self, target: Path) -> str | None:
        """Path within the folder; None if it is elsewhere."""
        root = self.folder.resolve()
        return target.relative_to(root).as_posix() if target.is_relative_to(root) else None


@contextmanager
def output_folder(
    folder: str | os.PathLike[str],
    *,
    inputs: tuple[Path, ...] = (),
    renewed: str = "",
    overwrite: bool = False,
    allow_outside: bool = False,
) -> Generator[OutputFolder]:
    """A folder whose files are written together when the block succeeds, or not at all.

    Parameters
    ----------
    folder : path
        Made if it does not exist.
    inputs : tuple of Path
    renewed : str
    overwrite, allow_outside : bool
        As in `OutputFolder`.

    Yields
    ------
    OutputFolder
        Says where to write. When the block raises, nothing is left below its folder.

    Raises
    ------
    InputError
        If the folder cannot be written to, or a file would replace one of the user's.
    """
    with replacing_all(folder) as staging:
        output = OutputFolder(
            Path(folder),
            staging.absolute(),
            {**_listed(Path(folder) / REPORT), **_listed(Path(folder) / RECORD)},
            inputs,
            renewed,
            overwrite,
            allow_outside,
        )
        yield output
        _finish(output)


def _finish(output: OutputFolder) -> None:
    """Check what was written, and keep a record of what no report lists."""
    staged = _digests(output.staging, output.digests)
    for name in staged:
        output.check(name)
    outside = {str(path): _digest(path) for path in output.outside if path.is_file()}
    if not staged and not outside:
        return
    kept = {
        name: digest
        for name, digest in output.known.items()
        if name not in staged and os.path.lexists(output.folder / name)
    }
    if REPORT in staged:
        record = {**kept, **outside}
    else:
        listed = _listed(output.folder / REPORT)
        kept = {name: digest for name, digest in kept.items() if listed.get(name) != digest}
        record = {**kept, **staged, **outside}
    if record or os.path.lexists(output.folder / RECORD):
        text = _text({"files": dict(sorted(record.items()))})
        (output.staging / RECORD).write_text(text, encoding="utf-8", newline="\n")


def _digests(folder: Path, known: Mapping[str, str] = _NONE) -> dict[str, str]:
    """Digests of all files below a folder, by their paths in it; some may be known."""
    files = (path for path in folder.rglob("*") if not path.is_dir())
    names = {path.relative_to(folder).as_posix(): path for path in files}
    return {name: known.get(name) or _digest(path) for name, path in names.items()}


def _listed(path: Path) -> dict[str, str]:
    """The digests that a file of spheremesh lists; none if it is not one."""
    try:
        status = path.lstat()
        if not stat.S_ISREG(status.st_mode) or status.st_size > _MOST_BYTES:
            return {}
        content: Any = json.loads(path.read_text(encoding="utf-8"))
        digests = {name: str(digest) for name, digest in content["files"].items() if digest}
        seal = digests.pop(REPORT, None)
        if path.name == REPORT:
            whole = {**content, "files": {**content["files"], REPORT: ""}}
            if hashlib.sha256(_text(whole).encode()).hexdigest() == seal:
                digests[REPORT] = _digest(path)
    except (OSError, ValueError, TypeError, LookupError, AttributeError, RecursionError):
        return {}
    return digests


def _text(content: Mapping[str, Any]) -> str:
    return json.dumps(content, indent=1, allow_nan=False) + "\n"


def _digest(path: Path) -> str:
    """SHA-256 of a regular file; empty for what is none, or cannot be read."""
    try:
        if not stat.S_ISREG(path.lstat().st_mode):
            return ""
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError:
        return ""


def _is_same(path: Path, other: Path) -> bool:
    try:
        return path.samefile(other)
    except (OSError, ValueError):
        return False
