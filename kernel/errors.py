"""What can go wrong, as types: the interfaces turn each into an exit code and one line."""

from collections.abc import Callable


class SpheremeshError(Exception):
    """Base of every error that the library raises on purpose."""


class InputError(SpheremeshError, ValueError):
    """An input cannot be used; the message says what, where and what to do."""


class ArgumentError(InputError, TypeError):
    """A function is given what it does not take; the message names the right call."""


class MeshError(InputError):
    """Faces are no mesh; the message can name them as the user knows them.

    Parameters
    ----------
    text : str
        The message, with ``{0}``, ``{1}`` and so on for the faces one by one, or ``{faces}``
        for a list of all.
    faces : list of int
        The faces.

    Examples
    --------
    >>> error = MeshError("face {0} repeats face {1}", [30, 3])
    >>> str(error), str(error.naming(lambda i: f"{i} (line {i + 50})"))
    ('face 30 repeats face 3', 'face 30 (line 80) repeats face 3 (line 53)')
    """

    def __init__(self, text: str, faces: "list[int]") -> None:
        super().__init__(text.format(*faces, faces=name_ids(faces)))
        self.text, self.faces = text, faces

    def naming(self, name: Callable[[int], str]) -> InputError:
        """The same error with other names of the faces.

        Parameters
        ----------
        name : callable
            Gives what is to stand for a number.

        Returns
        -------
        InputError
            Without the list of faces.
        """
        names = [name(i) for i in self.faces[:8]]
        more = f", ... {len(self.faces) - 8} more" if len(self.faces) > 8 else ""
        return InputError(self.text.format(*names, faces=f"[{', '.join(names)}{more}]"))


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
