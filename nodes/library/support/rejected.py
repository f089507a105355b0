"""Parts that cannot be made, named in a warning."""

from ....kernel.errors import name_ids
from ....kernel.parts.records import RejectedPart
from ...graphs.node import warn


def warn_of_rejected(rejected: tuple[RejectedPart, ...], what: str) -> None:
    """Warn of edges whose `what` cannot be made, with the reason of the first."""
    if rejected:
        warn(
            f"{len(rejected)} {what} cannot be made: edges "
            f"{name_ids([beam.element_id for beam in rejected])} "
            f"({rejected[0].id}: {rejected[0].reason})"
        )
