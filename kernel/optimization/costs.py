"""What an optimisation will cost, said beforehand where it is much."""

from ..progress import tell_progress

WORTH_SAYING = 10_000
"""Faces from which the cost is said."""
SECONDS_PER_FACE = {"fixed": 0.8e-3, "moving": 12e-3}
"""Of one processor of 2020, with a support; the second where vertices move. Steps that fight
with saddles, or for a tolerance that is too small, take several times as long."""
MEGABYTES, MEGABYTES_PER_FACE = 150.0, 0.04
"""Memory at the most: of the libraries, and of factors and second derivatives."""


def expected_cost(n_faces: int, *, moves: bool) -> tuple[float, float]:
    """Seconds and megabytes that the whole energy takes, to a factor of about two.

    Both grow little faster than the number of faces.
    """
    seconds = n_faces * SECONDS_PER_FACE["moving" if moves else "fixed"]
    return seconds, MEGABYTES + n_faces * MEGABYTES_PER_FACE


def tell_cost(n_faces: int, *, moves: bool) -> None:
    """Say before it begins what the whole energy of a large mesh will take."""
    if n_faces < WORTH_SAYING:
        return
    seconds, megabytes = expected_cost(n_faces, moves=moves)
    time = f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min"
    tell_progress(0, 1, f"{n_faces:,} faces take about {time} and {megabytes:,.0f} MB")
