"""The repair: all steps in their order, and what they did."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from ..arrays import IntArray
from ..errors import InputError
from ..meshes.mesh import Mesh
from ..reports import Report
from .faces import drop_narrow_and_repeated, drop_repeats, usable_faces
from .holes import faces_with_repeats, triangulate_holes
from .raw_mesh import RawMesh, keep_faces
from .separation import separate_and_unify
from .t_junctions import split_t_junctions
from .welding import rounding_error, weld_tolerance, weld_vertices


@dataclass(frozen=True, eq=False)
class RepairReport(Report):
    """What a repair did; numbers are those of the input, from 0.

    Attributes
    ----------
    tolerance : float
        Distance within which places were one, in model units.
    welded_vertices : list of list of int
        Vertices that became one, those of each place.
    unusable_faces : list of int
        Dropped: less than three corners, vertices that are missing, not finite or beyond 1e100.
    sliver_faces : list of int
        Dropped: all corners on a line.
    duplicate_faces : list of list of int
        Dropped: each with the face that it repeats.
    shortened_faces : list of int
        Faces of which coinciding corners became one.
    triangulated_faces : list of int
        Faces that passed a vertex twice, such as faces with a hole.
    t_junctions : list of list of int
        Faces and vertices on their edges that became corners of them.
    flipped_faces : list of int
        Faces that were turned over: of every piece the fewer.
    separated_vertices : list of int
        Vertices that are several now: at edges with more than two faces, or where faces met
        without sharing an edge.
    unused_vertices : list of int
        Dropped: no face is left that uses them.
    face_ids : list of int
        Face of the input that each face of the result is from.
    """

    tolerance: float
    welded_vertices: list[list[int]]
    unusable_faces: list[int]
    sliver_faces: list[int]
    duplicate_faces: list[list[int]]
    shortened_faces: list[int]
    triangulated_faces: list[int]
    t_junctions: list[list[int]]
    flipped_faces: list[int]
    separated_vertices: list[int]
    unused_vertices: list[int]
    face_ids: list[int]


def repair(raw: RawMesh, tolerance: float | None = None) -> tuple[Mesh, RepairReport]:
    """Make a mesh of faces that are none, and change nothing else.

    Parameters
    ----------
    raw : RawMesh
        Faces as they were read.
    tolerance : float, optional
        Distance within which places are one, in model units; by default a few spacings of the
        numbers that the coordinates were written with, between 1e-6 and 1e-3 mean edges.

    Returns
    -------
    mesh : Mesh
        The faces that are left, in their order, triangles of cut ones at the end; vertices in
        their order, separated ones at the end.
    report : RepairReport
        What was done, in numbers of the input.

    Raises
    ------
    InputError
        If no face is left, or a face cannot be cut into triangles.

    Notes
    -----
    The steps on faces run until none has something to do: where a sliver was, there is a
    T-junction.
    """
    is_usable = usable_faces(raw)
    state = keep_faces(raw, is_usable)
    distance = weld_tolerance(state) if tolerance is None else tolerance
    distance = max(distance, rounding_error(state))
    state = weld_vertices(state, distance)
    done = _Done.nothing()
    for _ in range(max(state.n_faces, 1)):
        mended, step = _mend_faces(state, distance)
        done = done.and_then(step)
        if not step.has_changed:
            break
        state = mended
    if not state.n_faces:
        raise InputError(
            f"no face is left of {raw.n_faces}: none has three corners that span an area; "
            "export the model as a polygon mesh"
        )
    state, is_flipped = separate_and_unify(state)
    mesh, used = _as_mesh(state)
    merged, separated = _moves(state)
    report = RepairReport(
        tolerance=distance,
        welded_vertices=merged,
        unusable_faces=np.flatnonzero(~is_usable).tolist(),
        sliver_faces=sorted(done.slivers.tolist()),
        duplicate_faces=done.repeats.tolist(),
        shortened_faces=_unique(done.shortened, state.face_ids),
        triangulated_faces=_unique(done.triangulated, state.face_ids),
        t_junctions=done.junctions.tolist(),
        flipped_faces=_unique(state.face_ids[is_flipped], state.face_ids),
        separated_vertices=separated,
        unused_vertices=_unused(raw, used, merged),
        face_ids=state.face_ids.tolist(),
    )
    return mesh, report


@dataclass(frozen=True)
class _Done:
    """What was done to faces so far, in numbers of the input."""

    slivers: IntArray
    repeats: IntArray
    shortened: IntArray
    triangulated: IntArray
    junctions: IntArray

    @staticmethod
    def nothing() -> "_Done":
        none, no_pairs = np.zeros(0, np.int64), np.zeros((0, 2), np.int64)
        return _Done(none, no_pairs, none, none, no_pairs)

    @property
    def has_changed(self) -> bool:
        return any(len(getattr(self, name)) for name in self.__dataclass_fields__)

    def and_then(self, other: "_Done") -> "_Done":
        return _Done(
            *(
                np.concatenate([getattr(self, name), getattr(other, name)])
                for name in self.__dataclass_fields__
            )
        )


def _mend_faces(state: RawMesh, distance: float) -> tuple[RawMesh, _Done]:
    """One round of the steps on faces."""
    shorter = drop_repeats(state)
    shortened = state.face_ids[shorter.degrees < state.degrees]
    state, slivers, repeats = drop_narrow_and_repeated(shorter, distance)
    folded = faces_with_repeats(state)
    triangulated = state.face_ids[folded]
    if len(folded):
        state = triangulate_holes(state, folded)
    state, junctions = split_t_junctions(state, distance)
    junctions = np.stack([state.face_ids[junctions[:, 0]], junctions[:, 1]], 1)
    return state, _Done(slivers, repeats, shortened, triangulated, junctions)


def _as_mesh(state: RawMesh) -> tuple[Mesh, IntArray]:
    """The mesh on the vertices that are used, and the input numbers of these vertices."""
    used, corners = np.unique(state.corners, return_inverse=True)
    corners = corners.reshape(-1)
    degrees = state.degrees
    faces: IntArray | Iterable[IntArray] = (
        corners.reshape(-1, int(degrees[0]))
        if (degrees == degrees[0]).all()
        else np.split(corners, state.offsets[1:-1])
    )
    return Mesh(state.vertices[used], faces), np.unique(state.corner_ids)


def _moves(state: RawMesh) -> tuple[list[list[int]], list[int]]:
    """Input vertices that became one, group by group, and those that became several."""
    moves = np.unique(np.stack([state.corners, state.corner_ids], 1), axis=0)
    places, counts = np.unique(moves[:, 0], return_counts=True)
    many = np.isin(moves[:, 0], places[counts > 1])
    groups = np.split(moves[many, 1], np.cumsum(counts[counts > 1])[:-1])
    merged = [group.tolist() for group in groups if len(group)]
    ids, copies = np.unique(moves[:, 1], return_counts=True)
    return merged, ids[copies > 1].tolist()


def _unused(raw: RawMesh, used: IntArray, merged: list[list[int]]) -> list[int]:
    is_used = np.zeros(len(raw.vertices), bool)
    is_used[used] = True
    is_used[[vertex for group in merged for vertex in group]] = True
    return np.flatnonzero(~is_used).tolist()


def _unique(faces: IntArray, left: IntArray) -> list[int]:
    """Faces once each, those that are left."""
    return np.intersect1d(faces, left).tolist()


WORDS: Final = {
    "welded_vertices": ("weld", "welded", "place", "places"),
    "unusable_faces": ("drop", "dropped", "unusable face", "unusable faces"),
    "sliver_faces": ("drop", "dropped", "sliver", "slivers"),
    "duplicate_faces": ("drop", "dropped", "repeated face", "repeated faces"),
    "shortened_faces": (
        "shorten",
        "shortened",
        "face with coinciding corners",
        "faces with coinciding corners",
    ),
    "triangulated_faces": ("triangulate", "triangulated", "face", "faces"),
    "t_junctions": ("split", "split", "T-junction", "T-junctions"),
    "flipped_faces": ("turn over", "turned over", "face", "faces"),
    "separated_vertices": ("separate", "separated", "vertex", "vertices"),
    "unused_vertices": ("drop", "dropped", "unused vertex", "unused vertices"),
}
"""Kinds of repairs: what is to be done, what was done, of one and of more."""


def repair_counts(report: RepairReport) -> dict[str, int]:
    """How often each kind of repair was made, the kinds that were not left out."""
    return {name: len(report[name]) for name in WORDS if report[name]}


def repair_words(counts: Mapping[str, int], *, is_done: bool) -> str:
    """What a repair does, or did, in the words of a message; empty if nothing.

    Examples
    --------
    >>> repair_words({"welded_vertices": 38, "sliver_faces": 1}, is_done=True)
    'welded 38 places, dropped 1 sliver'
    """
    parts: list[str] = []
    for name, count in counts.items():
        to_do, did, one, more = WORDS[name]
        parts.append(f"{did if is_done else to_do} {count} {one if count == 1 else more}")
    return ", ".join(parts)
