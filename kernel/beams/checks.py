"""What keeps beams from being written: names, and numbers that are not finite."""

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import BoolArray
from ..errors import InputError, name_ids
from ..parts.names import check_part_names

if TYPE_CHECKING:
    from .beams import Beams


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
