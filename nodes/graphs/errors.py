"""What can go wrong with graphs, as types, and how a mistyped name is answered."""

import difflib
from collections.abc import Iterable


class GraphError(ValueError):
    """A node, a wire or a graph file is not valid; the message names both ends."""


class UnknownPortError(GraphError, AttributeError):
    """A step has no output of that name."""


class NodeError(RuntimeError):
    """A step failed while it ran.

    Parameters
    ----------
    message : str
        What failed and where.
    step, node : str
        Names of the step and of its node.
    cause : Exception, optional
        What the node raised. It is ``__cause__`` too, but that is lost between processes.
    reason : str
        What the node said, paths as the graph gives them.
    """

    def __init__(
        self, message: str, step: str = "", node: str = "", cause: Exception | None = None,
        reason: str = "",
    ) -> None:  # fmt: skip
        super().__init__(message)
        self.step = step
        self.node = node
        self.cause = cause
        self.reason = reason or str(cause)


def nearest(name: str, names: Iterable[str]) -> str:
    """The end of a message about an unknown name.

    Returns
    -------
    str
        The nearest name, or else all of them if they are few.

    Examples
    --------
    >>> nearest("msh", ["mesh", "ring"])
    "did you mean 'mesh'?"
    >>> nearest("x", ["mesh", "ring"])
    'there are mesh, ring'
    """
    known = list(names)
    is_quick = len(name) < 100 and len(known) < 1000
    close = difflib.get_close_matches(name, known, n=1, cutoff=0.5) if is_quick else []
    if close:
        return f"did you mean {close[0]!r}?"
    if not known:
        return "there are none"
    rest = f", ... {len(known) - 12} more" if len(known) > 12 else ""
    return f"there are {', '.join(known[:12])}{rest}"
