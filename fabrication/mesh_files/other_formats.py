"""Further formats, through meshio and trimesh: the extra ``formats``."""

import importlib.util
import io
import os
import subprocess
import sys
from pathlib import Path
from typing import Any, Final
from zipfile import BadZipFile

import numpy as np

from ...kernel.errors import InputError, MissingLibraryError
from ..polygons import FileContent, Polygons
from .library_process import READERS
from .mending import SINGLE, Source, mended

OTHER_SUFFIXES: Final = tuple(READERS)
"""Formats that are read with the extra ``formats``."""
SPARE_BYTES, BYTES_PER_BYTE = 400_000_000, 30
SPARE_SECONDS, SECONDS_PER_BYTE = 3.0, 2e-6
"""What a process may take: a little, and so much for each byte of its file."""
_BAD_INPUT: Final = 3
_START: Final = 120.0
"""Seconds in which a process has started on any machine."""


def read_other(path: Path, suffix: str) -> FileContent:
    """Polygons of a file that meshio or trimesh reads.

    Parameters
    ----------
    path : Path
        The file, known to be a regular one.
    suffix : str
        Its format, one of `OTHER_SUFFIXES`.

    Returns
    -------
    FileContent
        Triangles, quads and polygons in the order in which the library gives them; cells that
        are no faces are counted in a remark. glTF is turned from y upwards to z upwards, its
        unit is the metre.

    Raises
    ------
    InputError
        If the library cannot read the file within limits of time and memory, or it holds no
        faces.
    MissingLibraryError
        If the library is not installed.
    """
    library = READERS[suffix][0].partition(".")[0]
    if importlib.util.find_spec(library) is None:
        raise MissingLibraryError(
            f"{suffix} files need {library}: install spheremesh[formats], or export the mesh "
            "as .obj, .off, .ply, .stl or .3dm"
        )
    found = _answer(path, suffix, library)
    polygons = Polygons(found["vertices"], found["corners"], found["degrees"])
    if library == "trimesh":
        return _scene(polygons, found)
    left_out = str(found["others"])
    if not len(polygons.degrees):
        raise InputError(
            f"the file has no faces, but {left_out or 'no cells'}; extract the surface of the "
            "model and save it"
        )
    remarks = (f"left out: {left_out}; only faces are read",) if left_out else ()
    return mended(polygons, Source(SINGLE if found["is_single"] else 0), remarks)


def _scene(polygons: Polygons, found: dict[str, Any]) -> FileContent:
    remark = "glTF has y upwards: the model was turned, so that z is; its unit is the metre"
    # Meshes of glTF repeat vertices where normals or textures differ.
    content = mended(polygons, Source(SINGLE, is_soup=True), (remark,))
    counts = found["counts"].tolist()
    names = [f"mesh {name!r}" for name in found["names"].tolist()]
    is_whole = len(content.polygons.degrees) == sum(counts)
    sources = tuple(zip(names, counts, strict=True)) if is_whole else ()
    return FileContent(content.polygons, "m", content.remarks, sources)


def _answer(path: Path, suffix: str, library: str) -> dict[str, Any]:
    """What a process of its own has read."""
    folders = os.pathsep.join(each for each in sys.path if each)
    size = path.stat().st_size
    seconds = int(SPARE_SECONDS + SECONDS_PER_BYTE * size)
    memory = SPARE_BYTES + BYTES_PER_BYTE * size
    module = f"{__package__}.library_process"
    try:
        # -P: the working folder of the user holds no modules of ours.
        ended = subprocess.run(  # noqa: S603
            [sys.executable, "-P", "-m", module, str(path), suffix, str(seconds), str(memory)],
            env={**os.environ, "PYTHONPATH": folders, "OPENBLAS_NUM_THREADS": "1"},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=_START + seconds,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise InputError(f"{library} does not come to an end; export the mesh again") from None
    if ended.returncode == _BAD_INPUT:
        raise InputError(ended.stderr.decode(errors="replace").strip().split("\n")[-1])
    try:
        with np.load(io.BytesIO(ended.stdout), allow_pickle=False) as archive:
            return dict(archive)
    except (BadZipFile, OSError, ValueError, EOFError):
        raise InputError(
            f"the file is damaged: {library} fails on it, or takes more than "
            f"{seconds} seconds or too much memory; export the mesh again"
        ) from None
