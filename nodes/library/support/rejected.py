"""Parts that cannot be made, named in a warning."""

from ....kernel.errors import name_ids
from ....kernel.parts.records import RejectedPart
from ...graphs.node import warn


def warn_of_rejected(rejected: tuple[RejectedPart, ...], what: str) -> None:
    """Warn of edges whose beams cannot be made, with the reason of the first.

    Parameters
    ----------
    rejected : tuple of RejectedPart
        The beams; without any nothing is said.
    what : str
        What they are called.
    """
    if rejected:
        warn(
            f"{len(rejected)} {what} cannot be made: edges "
            f"{name_ids([beam.element_id for beam in rejected])} "
            f"({rejected[0].id}: {rejected[0].reason})"
        )
