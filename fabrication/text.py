"""Text files of numbers: lines, words, and errors that name the line."""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from ..kernel.arrays import FloatArray, IntArray
from ..kernel.errors import InputError
from ..kernel.meshes.mesh import Mesh
from .polygons import Polygons


def decode(data: bytes) -> str:
    """The text of a file with plain newlines, without a byte order mark.

    Bytes that are not UTF-8 (old comments, names) do no harm.
    """
    text = data.decode("utf-8-sig", errors="replace")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def numbered_words(text: str, first: int = 1) -> Iterator[tuple[int, list[str]]]:
    """Number and words of each line that is not blank, without its comment.

    ``#`` at the start of a line or of a word starts a comment; lines count from `first`.
    """
    for number, line in enumerate(text.split("\n"), first):
        words = line.split()
        if "#" in line:
            words = words[: next((i for i, word in enumerate(words) if word[0] == "#"), None)]
        if words:
            yield number, words


def face_words(mesh: Mesh, first: int) -> list[str]:
    """The vertex numbers of each face, from `first` on, as words separated by blanks."""
    words = list(map(str, (mesh.corners + first).tolist()))
    return [" ".join(words[start:end]) for start, end in pairwise(mesh.offsets.tolist())]


def to_count(word: str) -> int:
    """A word of a text file as a number of elements; -1 if it is none that a file could hold.

    Examples
    --------
    >>> to_count("12"), to_count("-3"), to_count("9" * 40)
    (12, -1, -1)
    """
    return int(word) if word.isdecimal() and len(word) <= 15 else -1


def to_floats(words: Sequence[str], lines: Sequence[int], per_line: int) -> FloatArray:
    """Words of a text file as numbers (N, per_line), so many from each of the lines.

    Raises InputError if a word is not a number; the message names its line.
    """
    try:
        if _are_plain(words):
            return np.array(list(map(float, words)), np.float64).reshape(-1, per_line)
    except ValueError:
        pass  # perhaps Fortran's numbers: they take longer
    try:
        return np.array(list(map(_float, words)), np.float64).reshape(-1, per_line)
    except ValueError:
        index = next(i for i, word in enumerate(words) if not _can_read(word, _float))
        raise InputError(_not_a_number(lines[index // per_line], words[index])) from None


def _to_integers(words: Sequence[str], lines: Sequence[int], counts: Sequence[int]) -> IntArray:
    """Words as integers, so many from each line."""
    try:
        read = int if _are_plain(words) else _integer
        return np.array(list(map(read, words)), np.int64)
    except (ValueError, OverflowError):
        index = next(i for i, word in enumerate(words) if not _can_read(word, _integer))
        line = int(np.repeat(lines, counts)[index])
        raise InputError(_not_a_number(line, words[index])) from None


def significant_digits(words: Sequence[str], enough: int = 8) -> int:
    """Most digits that a number is written with, without leading zeros and exponents.

    Parameters
    ----------
    words : sequence of str
        Numbers as written.
    enough : int
        Counting ends at a number of so many.

    Returns
    -------
    int
        The most, at least `enough` if counting ended.

    Examples
    --------
    >>> significant_digits(["0.0150", "-5.4e+06", "120"])
    3
    """
    most = 0
    for word in words:
        mantissa = word.lower().replace("d", "e").partition("e")[0]
        most = max(most, len(mantissa.lstrip("+-").replace(".", "").lstrip("0")))
        if most >= enough:
            break
    return most


def unended(data: bytes) -> bool:
    """Whether the last line of a text has no end, as where a file was cut off."""
    return not data.endswith((b"\n", b"\r"))


@dataclass
class TextPolygons:
    """Polygons as the lines of a text file give them, one after the other.

    Three words of coordinates for each vertex; the vertex numbers of all faces, whose degrees
    are their numbers of corners; the lines that they come from.
    """

    coordinates: list[str] = field(default_factory=list[str])
    vertex_lines: list[int] = field(default_factory=list[int])
    corner_words: list[str] = field(default_factory=list[str])
    degrees: list[int] = field(default_factory=list[int])
    face_lines: list[int] = field(default_factory=list[int])

    def add_vertex(self, line: int, words: list[str]) -> None:
        """Add a vertex; more than three words are left out, fewer raise InputError."""
        if len(words) < 3:
            raise InputError(f"line {line}: a vertex needs three coordinates")
        self.coordinates += words[:3]
        self.vertex_lines.append(line)

    def add_face(self, line: int, words: list[str]) -> None:
        """Add a face by its vertex numbers."""
        self.corner_words += words
        self.degrees.append(len(words))
        self.face_lines.append(line)

    def polygons(self) -> Polygons:
        """The polygons, once all lines are read, with vertex numbers as they are written.

        Raises InputError if a word is not a number; the message names its line.
        """
        return Polygons(
            to_floats(self.coordinates, self.vertex_lines, 3),
            _to_integers(self.corner_words, self.face_lines, self.degrees),
            np.array(self.degrees, np.int64),
            self.vertex_lines,
            self.face_lines,
        )


_FORTRAN = re.compile(r"([+-]?[0-9.]+)[dD]([+-]?[0-9]+)")


def _are_plain(words: Sequence[str]) -> bool:
    """Whether no word has what Python reads as a number and files do not mean: 1_000, ١٢."""
    text = "".join(words)
    return text.isascii() and "_" not in text


def _float(word: str) -> float:
    """A number as it is written, in Fortran with D before the exponent."""
    if not _are_plain([word]):
        raise ValueError(word)
    fortran = _FORTRAN.fullmatch(word)
    return float(f"{fortran[1]}e{fortran[2]}" if fortran else word)


def _integer(word: str) -> int:
    if not _are_plain([word]):
        raise ValueError(word)
    return int(np.int64(word))


def _can_read(word: str, read: Callable[[str], float]) -> bool:
    try:
        read(word)
    except (ValueError, OverflowError):
        return False
    return True


def _not_a_number(line: int, word: str) -> str:
    return (
        f"line {line}: {word[:40]!r} is not a usable number; write coordinates with a decimal "
        "point and vertex numbers as integers"
    )
