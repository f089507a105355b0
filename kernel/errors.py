"""What can go wrong, as types: the interfaces turn each into an exit code and one line."""


class SpheremeshError(Exception):
    """Base of every error that the library raises on purpose."""


class InputError(SpheremeshError, ValueError):
    """An input cannot be used; the message says what, where and what to do."""


class ConvergenceError(SpheremeshError, ArithmeticError):
    """An optimisation stopped short of its tolerance; the message names the remedy."""


class MissingLibraryError(SpheremeshError, ImportError):
    """A library of the system or an extra is missing; the message names the package."""


def name_ids(ids: "list[int]", limit: int = 8) -> str:
    """List element ids for a message, the first few in full.

    Parameters
    ----------
    ids : list of int
        The ids to name.
    limit : int
        How many are written out.

    Returns
    -------
    str
        For example ``[3, 17]`` or ``[0, 1, 2, ... 40 more]``.

    Examples
    --------
    >>> name_ids([3, 17])
    '[3, 17]'
    >>> name_ids(list(range(5)), limit=3)
    '[0, 1, 2, ... 2 more]'
    """
    shown = ", ".join(str(int(i)) for i in ids[:limit])
    rest = len(ids) - limit
    return f"[{shown}, ... {rest} more]" if rest > 0 else f"[{shown}]"
