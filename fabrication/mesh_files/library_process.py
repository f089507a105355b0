"""Reads a file with meshio or trimesh in a process of its own.

A damaged file may make those libraries loop, ask for all memory, print, or leave the program.
Here that ends this process alone. What was read goes to standard output as an npz archive.
"""

import importlib
import io
import os
import sys
import time
import warnings
from contextlib import redirect_stdout
from functools import partial
from math import ceil
from pathlib import Path
from typing import Any, Final

import numpy as np

from ...kernel.arrays import FloatArray, IntArray
from ...kernel.errors import InputError
from ..polygons import Polygons, join_polygons, transform_polygons

READERS: Final[dict[str, tuple[str, ...]]] = {
    ".avs": ("meshio.avsucd",),
    ".bdf": ("meshio.nastran",),
    ".fem": ("meshio.nastran",),
    ".glb": ("trimesh",),
    ".gltf": ("trimesh",),
    ".inp": ("meshio.abaqus",),
    ".mesh": ("meshio.medit",),
    ".msh": ("meshio.gmsh", "meshio.ansys"),
    ".nas": ("meshio.nastran",),
    ".su2": ("meshio.su2",),
    ".vtk": ("meshio.vtk",),
    ".vtu": ("meshio.vtu",),
}
"""Modules that read a suffix, in the order to try."""
_FACES: Final = {
    "triangle": 3, "triangle6": 3, "triangle7": 3, "quad": 4, "quad8": 4, "quad9": 4,
}  # fmt: skip
"""Corners of the cells of meshio that are faces; nodes on their sides are left out."""
_Z_UP: Final = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
_Untyped = Any


def main(arguments: list[str]) -> int:
    """Read the file and write what it holds, or a line on what is wrong.

    Parameters
    ----------
    arguments : list of str
        Path, suffix, most seconds and most bytes beyond what this process has by now.

    Returns
    -------
    int
        Exit code: 0, or 3 with a line on standard error.
    """
    path, suffix, seconds, memory = arguments
    for name in READERS[suffix]:
        importlib.import_module(name)  # what that takes is not the fault of the file
    _limit(int(seconds), int(memory))
    output = io.BytesIO()
    try:
        with redirect_stdout(io.StringIO()):
            polygons, notes = read_with_library(Path(path), suffix)
        np.savez(
            output, vertices=polygons.vertices, corners=polygons.corners,
            degrees=polygons.degrees, **notes,
        )  # fmt: skip
    except (InputError, MemoryError) as error:
        sys.stderr.write(f"\n{str(error) or 'it needs too much memory'}\n")
        return 3
    sys.stdout.buffer.write(output.getvalue())
    return 0


def _limit(seconds: int, memory: int) -> None:
    """Bound memory and time of this process, where the system can."""
    try:
        import resource
    except ImportError:  # Windows: the caller waits so long only
        return
    most = ceil(time.process_time()) + seconds
    resource.setrlimit(resource.RLIMIT_CPU, (most, most + 1))
    statistics = Path("/proc/self/statm")
    if statistics.exists():
        in_use = int(statistics.read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")
        resource.setrlimit(resource.RLIMIT_AS, (in_use + memory, in_use + memory))


def read_with_library(path: Path, suffix: str) -> tuple[Polygons, dict[str, _Untyped]]:
    """Polygons of a file, and notes on them.

    Parameters
    ----------
    path : Path
        The file.
    suffix : str
        Its format, one of `READERS`.

    Returns
    -------
    polygons : Polygons
        All faces; there may be none among the cells of meshio.
    notes : dict
        `others`, a text on cells that are no faces, and `is_single`, whether numbers are
        float32; of trimesh `names` and `counts` of the meshes.

    Raises
    ------
    InputError
        If the library cannot read it.
    """
    read = _read_gltf if READERS[suffix] == ("trimesh",) else _read_cells
    return read(path, suffix)


def _called(read: _Untyped, path: Path, faults: list[str]) -> _Untyped:
    """What a library reads, or None; what it raises becomes one line."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return read(path)
    # Damaged files make it raise whatever its parsing meets, and leave the program.
    except (Exception, SystemExit) as error:  # noqa: BLE001
        reason = " ".join(f"{type(error).__name__}: {error}".split()).removesuffix(":")
        faults.append(reason[:160])
        return None


def _read_cells(path: Path, suffix: str) -> tuple[Polygons, dict[str, _Untyped]]:
    """The faces among the cells that meshio reads, and how many others there are."""
    faults: list[str] = []
    for name in READERS[suffix]:
        found = _called(importlib.import_module(name).read, path, faults)
        if found is not None:
            return _faces(found)
    raise InputError(f"meshio says {faults[0]}; export the mesh as .obj, .ply or .vtu")


def _faces(found: _Untyped) -> tuple[Polygons, dict[str, _Untyped]]:
    points: FloatArray = np.asarray(found.points, np.float64)
    if points.ndim != 2 or not 2 <= points.shape[1] <= 3:
        raise InputError("its points have neither two nor three coordinates; export it again")
    points = np.hstack([points, np.zeros((len(points), 3 - points.shape[1]))])
    corners: list[IntArray] = [np.zeros(0, np.int64)]
    degrees: list[IntArray] = [np.zeros(0, np.int64)]
    others: dict[str, int] = {}
    for block in found.cells:
        kind = str(block.type)
        is_polygon = kind.startswith("polygon")
        if kind not in _FACES and not is_polygon:
            others[kind] = others.get(kind, 0) + len(block.data)
            continue
        for rows in block.data if is_polygon else [block.data]:
            table = np.atleast_2d(np.asarray(rows, np.int64))
            table = table[:, : _FACES.get(kind, table.shape[1])]
            corners.append(table.ravel())
            degrees.append(np.full(len(table), table.shape[1]))
    polygons = Polygons(points, np.concatenate(corners), np.concatenate(degrees))
    others_text = ", ".join(f"{count} {kind}" for kind, count in others.items())
    is_single = np.asarray(found.points).dtype == np.float32
    return polygons, {"others": others_text, "is_single": is_single}


def _read_gltf(path: Path, _: str) -> tuple[Polygons, dict[str, _Untyped]]:
    """The triangles of all meshes where they stand, turned from y upwards to z upwards."""
    trimesh: _Untyped = importlib.import_module("trimesh")
    faults: list[str] = []
    scene = _called(partial(trimesh.load_scene, process=False), path, faults)
    if scene is None:
        raise InputError(f"trimesh says {faults[0]}; export the mesh again")
    parts: list[Polygons] = []
    names: list[str] = []
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        geometry = scene.geometry[name]
        if isinstance(geometry, trimesh.Trimesh) and len(geometry.faces):
            triangles = np.asarray(geometry.faces, np.int64)
            points = np.asarray(geometry.vertices, np.float64)
            part = Polygons(points, triangles.ravel(), np.full(len(triangles), 3))
            parts.append(transform_polygons(part, _Z_UP @ np.asarray(transform, np.float64)))
            names.append(str(name))
    if not parts:
        raise InputError("the file has no triangles; export the model as a mesh")
    counts = [len(part.degrees) for part in parts]
    return join_polygons(parts), {"names": names, "counts": counts}


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
