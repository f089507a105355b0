"""What keeps a beam from being made: planes that lie flat, ends that lean or cross."""

from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from .arrays import BoolArray, dot, norm
from .errors import InputError, name_ids
from .part_names import check_part_names
from .spheres import normals
from .tolerances import AXIS_LEAN, DEGENERATE

if TYPE_CHECKING:
    from .annuli import Annuli
    from .beams import Beams

NO_ANNULUS: Final = "B100"
"""Code of a beam whose edge has no annulus."""

NO_CUT: Final = "B101"
"""Code of a beam whose annulus cannot be cut at the nodes."""


@dataclass(frozen=True)
class RejectedBeam:
    """
    A beam that cannot be made.

    Attributes
    ----------
    id : str
        Name of the beam.
    edge_id : int
        Its edge.
    reason : str
        What is wrong, for a person.
    code : str
        Number of the finding that it is: `NO_ANNULUS` or `NO_CUT`.
    """

    id: str
    edge_id: int
    reason: str
    code: str


def standing_reasons(annuli: "Annuli", is_real: BoolArray, max_tilt: float) -> dict[int, str]:
    """
    Why annuli cannot stand, whatever their depth; of several reasons the first.

    Parameters
    ----------
    annuli : Annuli
        B annuli, without inner arcs.
    is_real : (B,) bool array
        Whether their circles are real and meet the lines of both ends.
    max_tilt : float
        Largest angle to the bisecting plane, in radians.

    Returns
    -------
    dict of int to str
        Reason by row; annuli that stand do not occur.
    """
    reasons: dict[int, str] = {}
    for row in np.flatnonzero(~is_real).tolist():
        reasons[row] = "the two spheres do not meet in a circle near the edge"
    tilt = np.degrees(annuli.tilt)
    for row in np.flatnonzero(annuli.tilt > max_tilt).tolist():
        reasons.setdefault(
            row,
            f"the plane tilts {tilt[row]:.3g} degrees from the bisecting plane, more than "
            f"{np.degrees(max_tilt):.3g}",
        )
    inward = -annuli.frames[:, None, 1]
    lean = 2 * np.arctan2(
        norm(annuli.end_directions - inward), norm(annuli.end_directions + inward)
    ).max(axis=1)
    for row in np.flatnonzero(lean > AXIS_LEAN).tolist():
        reasons.setdefault(
            row, f"a node axis leans {np.degrees(lean[row]):.3g} degrees along the beam"
        )
    return reasons


def inner_reasons(annuli: "Annuli", size: float) -> dict[int, str]:
    """
    Why annuli have no inner arc; of several reasons the first.

    Parameters
    ----------
    annuli : Annuli
        B annuli.
    size : float
        Mean edge of the mesh.

    Returns
    -------
    dict of int to str
        Reason by row; sound annuli do not occur.
    """
    reasons: dict[int, str] = {}
    deep = np.flatnonzero(-2 * annuli.outer[:, 0] * annuli.depth >= 1).tolist()
    for row in deep:
        radius = -1 / (2 * annuli.outer[row, 0])
        reasons[row] = (
            f"the depth {annuli.depth:g} is not less than the radius {radius:.6g} of the arc"
        )
    outer_chords = annuli.corners[:, 1, 0] - annuli.corners[:, 0, 0]
    inner_chords = annuli.corners[:, 1, 1] - annuli.corners[:, 0, 1]
    backwards = dot(outer_chords, inner_chords) <= 0
    for row in np.flatnonzero(backwards).tolist():
        reasons.setdefault(row, "the lines of the two ends cross within the depth")
    heights = norm(annuli.corners[:, :, 1] - annuli.corners[:, :, 0]).min(axis=1)
    for row in np.flatnonzero(heights <= DEGENERATE * size).tolist():
        reasons.setdefault(
            row, "the arc is straight, and a constant power gives it no depth: give a depth"
        )
    across = [
        dot(annuli.end_directions, normals(rows[:, None], points)) >= 0
        for rows, points in (
            (annuli.outer, annuli.corners[:, :, 0]),
            (annuli.inner, annuli.corners[:, :, 1]),
        )
    ]
    for row in np.flatnonzero(np.any(across, axis=(0, 2))).tolist():
        reasons.setdefault(row, "a node axis leans across the arc at its end")
    sides = dot(annuli.corners[:, :, 1] - annuli.corners[:, :, 0], annuli.end_directions)
    for row in np.flatnonzero(sides[:, 0] * sides[:, 1] < 0).tolist():
        reasons.setdefault(row, "the two arcs cross: one end reaches inside, one outside")
    return reasons


def finite_beams(beams: "Beams") -> BoolArray:
    """
    Which beams have finite numbers only.

    Parameters
    ----------
    beams : Beams
        B beams.

    Returns
    -------
    (B,) bool array
        Whether origins, frames, circles, axes, cuts and corners are finite.
    """
    annuli = beams.annuli
    numbers = [
        array.reshape(beams.n_beams, np.prod(array.shape[1:], dtype=int))
        for array in (
            annuli.origins, annuli.frames, annuli.outer, annuli.inner, annuli.corners,
            annuli.end_directions, annuli.node_axes, beams.levels, beams.insets, beams.corners,
            beams.sections,
        )
    ]  # fmt: skip
    return np.asarray(np.isfinite(np.hstack(numbers)).all(axis=1))


def check_writable_beams(beams: "Beams", target: object) -> None:
    """
    Refuse beams that no file can hold.

    Parameters
    ----------
    beams : Beams
        B beams.
    target : path
        The file, for the message.

    Raises
    ------
    InputError
        If there is no beam, two have the same name, a name is no line of text, or one has
        numbers that are not finite.
    """
    ids = beams.annuli.ids
    if not ids:
        raise InputError(f"there are no beams to write to {target}")
    check_part_names(ids, "beam")
    for name, count in Counter(ids).items():
        if count > 1:
            rows = [i for i, other in enumerate(ids) if other == name]
            edges = name_ids(beams.annuli.edge_ids[rows].tolist())
            raise InputError(
                f"{count} beams are called {name!r} (edges {edges}): give each a name of its "
                "own"
            )
    broken = [ids[i] for i in np.flatnonzero(~finite_beams(beams))]
    if broken:
        raise InputError(f"beam {broken[0]} ({len(broken)} in all) is not finite")
