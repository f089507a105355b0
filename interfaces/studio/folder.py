"""The folder of the user that the studio may read from and write to."""

import os
from pathlib import Path
from typing import Final

from ..hops.guard import RefusedError

MOST_LISTED: Final = 500
_DEEPEST: Final = 4
_HIDDEN: Final = (".history", ".contents", "__pycache__", "node_modules")


def inside(folder: Path, name: str) -> Path:
    """The path of a name in the folder.

    Raises RefusedError with the status 403 if it leads elsewhere, by links as well.
    """
    root = folder.resolve()
    try:
        path = (root / name).resolve()
    except (OSError, ValueError, RuntimeError) as error:
        raise RefusedError(403, f"{name[:80]!r} can be no path") from error
    if not name or path == root or not path.is_relative_to(root):
        raise RefusedError(
            403, f"{name[:80]!r} is outside of the studio's folder (--files); name a file in it"
        )
    return path


def listed(folder: Path, endings: tuple[str, ...] = ()) -> list[str]:
    """Names of the files in the folder and those below, a few levels deep."""
    found: list[str] = []
    for at, folders, files in os.walk(folder):
        here = Path(at).relative_to(folder)
        depth = len(here.parts)
        folders[:] = sorted(
            name
            for name in folders
            if not name.startswith(".") and not name.endswith(_HIDDEN) and depth < _DEEPEST
        )
        found += [
            (here / name).as_posix()
            for name in sorted(files)
            if not name.startswith(".") and (not endings or name.lower().endswith(endings))
        ]
        if len(found) >= MOST_LISTED:
            break
    return found[:MOST_LISTED]


def free_file(folder: Path, name: str) -> Path:
    """A path in the folder that is not taken: the name itself, or the same with a number."""
    path, number = folder / name, 2
    while path.exists():
        path = folder / f"{Path(name).stem} {number}{Path(name).suffix}"
        number += 1
    return path
