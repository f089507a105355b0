"""What every reader does at its end: weld, leave out slivers, say what is doubtful."""

from dataclasses import dataclass, replace
from math import floor, log10
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from ...kernel.arrays import BoolArray, IntArray
from ...kernel.errors import InputError, name_ids
from ...kernel.tolerances import ROUNDED_FILE, SINGLE_EPSILON
from ..polygons import FileContent, Polygons, mean_side, weld

ROUNDED_DIGITS: Final = (6, 7)
"""Significant digits that programs write unless told otherwise; by hand, numbers have fewer."""
SINGLE: Final = -1
"""Stands for the digits of float32."""


@dataclass(frozen=True)
class Source:
    """What a reader knows of how a file was written.

    Attributes
    ----------
    digits : int
        Significant digits of the coordinates, `SINGLE` for float32; 0 if not known.
    is_soup : bool
        Whether the format lets each face have vertices of its own, as STL does: equal ones
        are joined without a word.
    has_end : bool
        Whether the last line of a text has an end.
    """

    digits: int = 0
    is_soup: bool = False
    has_end: bool = True


def mended(polygons: Polygons, source: Source, remarks: tuple[str, ...] = ()) -> FileContent:
    """Polygons of a file as they are meant, with remarks on what was done or is doubtful.

    Parameters
    ----------
    polygons : Polygons
        As the file lists them.
    source : Source
        How the file was written.
    remarks : tuple of str
        What the reader has said already.

    Returns
    -------
    FileContent
        Where every face has vertices of its own, equal vertices are one; triangles with equal
        corners are left out. Faces without corners, corners out of range and coordinates that
        are not finite stay as they are, for `to_mesh` to report.

    Raises
    ------
    InputError
        If coordinates were rounded when the file was written so that corners coincide.
    """
    n_vertices, corners = len(polygons.vertices), polygons.corners
    is_sound = ((corners >= 0) & (corners < n_vertices)).all() and len(corners)
    is_sound = is_sound and (polygons.degrees > 0).all()
    if not is_sound or not np.isfinite(polygons.vertices).all():
        return FileContent(polygons, remarks=remarks)
    said = list(remarks)
    rounding = _rounding(polygons, source)
    if rounding:
        said.append(rounding)
    if source.is_soup or _is_unwelded(polygons):
        polygons, remark = _welded(polygons)
        said += [] if source.is_soup else [remark]
    else:
        said += _doubles(polygons)
    said += _unused(polygons)
    polygons, sentences = _without_slivers(polygons)
    said += sentences
    if not source.has_end:
        said.append(
            "the last line of the file has no end: if the file was cut off there, faces are "
            "missing; compare, or export the mesh again"
        )
    return FileContent(polygons, remarks=tuple(said))


def _rounding(polygons: Polygons, source: Source) -> str:
    """Say where the digits of the file are too few for its coordinates."""
    largest = float(np.abs(polygons.vertices).max())
    if not largest or source.digits not in (*ROUNDED_DIGITS, SINGLE):
        return ""
    if source.digits == SINGLE:
        step, digits = largest * SINGLE_EPSILON, "single precision"
    else:
        step = 10.0 ** (floor(log10(largest)) + 1 - source.digits)
        digits = f"{source.digits} significant digits"
    with np.errstate(over="ignore"):  # coordinates near the largest numbers
        side = mean_side(polygons)
    if step <= ROUNDED_FILE * side:
        return ""
    fact = (
        f"the coordinates have {digits}: near {largest:.3g} they are rounded to {step:.3g}, "
        f"and a mean edge is {side:.2g}"
    )
    cure = "move the model to the origin and export it again, or with more digits"
    n_lost = int((~_side_has_length(polygons)).sum())
    if n_lost:
        fact += f"; {_count(n_lost, 'side', 'sides')} of faces have no length left"
    if n_lost or step > side:
        raise InputError(f"{fact}; {cure}")
    return f"{fact}; {cure}"


def _side_has_length(polygons: Polygons) -> BoolArray:
    before = _before(polygons.degrees)
    points = polygons.vertices[polygons.corners]
    return (points != points[before]).any(axis=1)


def _before(degrees: IntArray) -> IntArray:
    """The corner before each corner, around its face."""
    ends = np.cumsum(degrees)
    before = np.arange(int(degrees.sum())) - 1
    before[ends - degrees] = ends - 1
    return before


def _is_unwelded(polygons: Polygons) -> bool:
    """Whether there are faces and none shares a vertex with another."""
    counts = np.bincount(polygons.corners, minlength=1)
    return len(polygons.degrees) > 1 and int(counts.max()) == 1


def _welded(polygons: Polygons) -> tuple[Polygons, str]:
    """Join equal vertices; those that no face uses go."""
    points = polygons.vertices[polygons.corners]
    vertices, corners = weld(points)
    if len(vertices) == len(points):
        return polygons, (
            "no face shares a vertex with another, and no two vertices are equal: each face "
            "stays alone; join neighbours with repair_mesh, or weld the mesh before the export"
        )
    remark = (
        f"every face has vertices of its own: {len(points)} were joined to {len(vertices)} "
        "where they are equal"
    )
    return replace(polygons, vertices=vertices, corners=corners, vertex_lines=()), remark


def _doubles(polygons: Polygons) -> list[str]:
    """Say where vertices of faces coincide and are not one."""
    used = np.unique(polygons.corners)
    n_equal = len(used) - len(weld(polygons.vertices[used])[0])
    if not n_equal:
        return []
    count = _count(
        n_equal,
        "vertex lies exactly on another and is not joined to it",
        "vertices lie exactly on others and are not joined to them",
    )
    cure = "if they should meet, use repair_mesh, or weld the mesh before the export"
    return [f"{count}: faces stay apart there; {cure}"]


def _unused(polygons: Polygons) -> list[str]:
    is_used = np.zeros(len(polygons.vertices), bool)
    is_used[polygons.corners] = True
    unused = np.flatnonzero(~is_used)
    if not len(unused):
        return []
    count = _count(len(unused), "vertex belongs", "vertices belong")
    where = _places(unused, polygons.vertex_lines, "vertices")
    return [f"{count} to no face: {where}; check that no faces are missing"]


def _without_slivers(polygons: Polygons) -> tuple[Polygons, list[str]]:
    """Leave out triangles with equal corners, unless there is nothing else."""
    is_repeated = polygons.corners == polygons.corners[_before(polygons.degrees)]
    owners = np.repeat(np.arange(len(polygons.degrees)), polygons.degrees)
    has_repeat = np.bincount(owners[is_repeated], minlength=len(polygons.degrees)) > 0
    is_sliver = has_repeat & (polygons.degrees == 3)
    if not is_sliver.any() or is_sliver.all():
        return polygons, []
    slivers = np.flatnonzero(is_sliver)
    count = _count(len(slivers), "triangle has", "triangles have")
    where = _places(slivers, polygons.face_lines, "faces")
    lines = np.asarray(polygons.face_lines)
    kept = replace(
        polygons,
        corners=polygons.corners[~is_sliver[owners]],
        degrees=polygons.degrees[~is_sliver],
        face_lines=lines[~is_sliver] if len(lines) else lines,
    )
    return kept, [f"{count} equal corners and no area: left out {where} of the file"]


def _places(ids: IntArray, lines: ArrayLike, kind: str) -> str:
    """Lines of the file, or ids from 0 where it has no lines."""
    known = np.asarray(lines)
    if len(known):
        return f"lines {name_ids(known[ids].tolist())}"
    return f"{kind} {name_ids(ids.tolist())}"


def _count(count: int, one: str, more: str) -> str:
    return f"{count} {one if count == 1 else more}"
