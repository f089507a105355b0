"""What panels and beams may be called, so that every kind of file can say it."""

from collections.abc import Iterable
from typing import Final
from unicodedata import category

from ..errors import InputError

_UNWRITABLE: Final = frozenset({"Cc", "Cs", "Zl", "Zp"})
"""Unicode's categories of control characters, halves of characters, and ends of lines."""

_NO_CHARACTERS: Final = frozenset("\ufffe\uffff")


def check_part_names(names: Iterable[str], kind: str) -> None:
    r"""
    Refuse names that some kinds of files cannot hold, or would change.

    Parameters
    ----------
    names : iterable of str
        Names of parts.
    kind : str
        What the parts are, for the message.

    Raises
    ------
    InputError
        If a name is empty, begins or ends with a blank, or has a character that is no text:
        ends of lines, tabs and other control characters, halves of characters.

    Examples
    --------
    >>> check_part_names(["Dach 1", "屋根"], "panel")
    >>> check_part_names(["A\n1"], "panel")
    Traceback (most recent call last):
    ...
    spheremesh.kernel.errors.InputError: panel 0 is called 'A\n1': a name is one line of ...
    """
    for number, name in enumerate(names):
        if name != name.strip() or not name or any(map(_is_unwritable, name)):
            raise InputError(
                f"{kind} {number} is called {name!a}: a name is one line of text, without "
                "blanks at its ends and control characters"
            )


def _is_unwritable(character: str) -> bool:
    return category(character) in _UNWRITABLE or character in _NO_CHARACTERS
