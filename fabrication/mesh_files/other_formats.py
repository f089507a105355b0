"""Further formats, through meshio and trimesh: the extra ``formats``."""

import importlib
import io
import warnings
from contextlib import redirect_stderr, redirect_stdout
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np

from ...kernel.errors import InputError, MissingLibraryError
from ..polygons import FileContent, Polygons, join_polygons, transform_polygons
from .mending import SINGLE, Source, mended

_MESHIO: Final[dict[str, tuple[str, ...]]] = {
    ".avs": ("avsucd",),
    ".bdf": ("nastran",),
    ".fem": ("nastran",),
    ".inp": ("abaqus",),
    ".mesh": ("medit",),
    ".msh": ("gmsh", "ansys"),
    ".nas": ("nastran",),
    ".su2": ("su2",),
    ".vtk": ("vtk",),
    ".vtu": ("vtu",),
}
"""Modules of meshio that read a suffix, in the order to try."""
_GLTF: Final = (".glb", ".gltf")
OTHER_SUFFIXES: Final = (*sorted(_MESHIO), *_GLTF)
"""Formats that are read with the extra ``formats``."""

_FACES: Final = {
    "triangle": 3, "triangle6": 3, "triangle7": 3, "quad": 4, "quad8": 4, "quad9": 4,
}  # fmt: skip
"""Corners of the cells of meshio that are faces; nodes on their sides are left out."""
_Z_UP: Final = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
_Untyped = Any


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
        If the library cannot read the file or it holds no faces.
    MissingLibraryError
        If the library is not installed.
    """
    return _read_gltf(path) if suffix in _GLTF else _read_cells(path, suffix)


def _imported(name: str, suffix: str) -> _Untyped:
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise MissingLibraryError(
            f"{suffix} files need {name.partition('.')[0]}: {error}; install "
            "spheremesh[formats], or export the mesh as .obj, .off, .ply, .stl or .3dm"
        ) from error


def _read_cells(path: Path, suffix: str) -> FileContent:
    _imported("meshio", suffix)
    faults: list[str] = []
    for name in _MESHIO[suffix]:
        reader = _imported(f"meshio.{name}", suffix)
        found = _called(reader.read, path, faults)
        if found is not None:
            return _content(found)
    raise InputError(
        f"meshio cannot read it ({faults[0]}); export the mesh as .obj, .ply or .vtu"
    )


def _called(read: _Untyped, path: Path, faults: list[str]) -> _Untyped:
    """What a library reads, or None; what it prints and raises is kept to one line."""
    printed = io.StringIO()
    try:
        with warnings.catch_warnings(), redirect_stdout(printed), redirect_stderr(printed):
            warnings.simplefilter("ignore")
            return read(path)
    # Damaged files make it raise whatever its parsing meets, and leave the program.
    except (Exception, SystemExit) as error:  # noqa: BLE001
        reason = " ".join(f"{type(error).__name__}: {error}".split()).removesuffix(": ")
        faults.append(reason[:160])
        return None


def _content(found: _Untyped) -> FileContent:
    """The faces among the cells."""
    points = np.asarray(found.points, np.float64)
    if points.ndim != 2 or not 2 <= points.shape[1] <= 3:
        raise InputError("its points have neither two nor three coordinates; export it again")
    points = np.hstack([points, np.zeros((len(points), 3 - points.shape[1]))])
    corners: list[np.ndarray[Any, Any]] = [np.zeros(0, np.int64)]
    degrees: list[np.ndarray[Any, Any]] = [np.zeros(0, np.int64)]
    others: dict[str, int] = {}
    for block in found.cells:
        kind = str(block.type)
        is_polygon = kind.startswith("polygon")
        if kind not in _FACES and not is_polygon:
            others[kind] = others.get(kind, 0) + len(block.data)
            continue
        for row in [block.data] if not is_polygon else block.data:
            table = np.atleast_2d(np.asarray(row, np.int64))
            table = table[:, : _FACES.get(kind, table.shape[1])]
            corners.append(table.ravel())
            degrees.append(np.full(len(table), table.shape[1]))
    left_out = ", ".join(f"{count} {kind}" for kind, count in others.items())
    polygons = Polygons(points, np.concatenate(corners), np.concatenate(degrees))
    if not len(polygons.degrees):
        raise InputError(
            f"the file has no faces, but {left_out or 'no cells'}; extract the surface of the "
            "model and save it"
        )
    remarks = (f"left out: {left_out}; only faces are read",) if left_out else ()
    is_single = np.asarray(found.points).dtype == np.float32
    return mended(polygons, Source(SINGLE if is_single else 0), remarks)


def _read_gltf(path: Path) -> FileContent:
    trimesh = _imported("trimesh", path.suffix.lower())
    faults: list[str] = []
    scene = _called(partial(trimesh.load_scene, process=False), path, faults)
    if scene is None:
        raise InputError(f"trimesh cannot read it ({faults[0]}); export the mesh again")
    parts: list[Polygons] = []
    sources: list[tuple[str, int]] = []
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        geometry = scene.geometry[name]
        if isinstance(geometry, trimesh.Trimesh) and len(geometry.faces):
            triangles = np.asarray(geometry.faces, np.int64)
            points = np.asarray(geometry.vertices, np.float64)
            # Meshes of glTF repeat vertices where normals or textures differ.
            part = Polygons(points, triangles.ravel(), np.full(len(triangles), 3))
            parts.append(transform_polygons(part, _Z_UP @ np.asarray(transform, np.float64)))
            sources.append((f"mesh {name!r}", len(triangles)))
    if not parts:
        raise InputError("the file has no triangles; export the model as a mesh")
    remark = "glTF has y upwards: the model was turned, so that z is; its unit is the metre"
    content = mended(join_polygons(parts), Source(SINGLE, is_soup=True), (remark,))
    is_whole = len(content.polygons.degrees) == sum(count for _, count in sources)
    return FileContent(
        content.polygons, "m", content.remarks, tuple(sources) if is_whole else ()
    )
