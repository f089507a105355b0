"""Texts that stand for values: what is large, or nothing that Grasshopper knows.

A handle is made of the content of its value, so that equal values have equal handles, and one
that a store on disk holds is good after a restart. Texts in JSON that were given for a value
are known again, so that nothing is lost where JSON has no word for it.
"""

import itertools
import re
from collections import OrderedDict
from threading import Lock
from typing import Final

from ...kernel.errors import InputError
from ...nodes.graphs.annotations import Value
from ...nodes.graphs.running.keys import key_of
from ...nodes.graphs.stores.digests import digest
from ...nodes.graphs.stores.disk import DiskStore
from ...nodes.graphs.stores.entries import Entry, Store
from ...nodes.graphs.stores.results import own

_HANDLE: Final = re.compile(r"spheremesh:(\w+):(\S+)")
_MOST_HERE: Final = 256
_GONE: Final = (
    "this handle is no longer known here (the server was restarted, or holds too much): "
    "recompute the component before"
)


class Handles:
    """Values by the texts that stand for them, in the store of all results.

    Parameters
    ----------
    store : Store
    """

    def __init__(self, store: Store) -> None:
        self.store = store
        self._here: OrderedDict[str, Value] = OrderedDict()
        self._numbers = itertools.count(1)
        self._lock = Lock()

    def lasts(self, text: str) -> bool:
        """Whether a handle is good after a restart."""
        return isinstance(self.store, DiskStore) and ":here-" not in text

    def give(self, kind: str, value: Value) -> str:
        """The text that stands for a value.

        Parameters
        ----------
        kind : str
            What it is, for the eyes of the user: ``sphere_mesh``.

        Returns
        -------
        str
            Equal for equal values.
        """
        try:
            name = digest(value).hex()
        except TypeError:  # what nobody can tell from another is known by its number
            with self._lock:
                name = f"here-{next(self._numbers)}"
                self._here[name] = value
                while len(self._here) > _MOST_HERE:
                    self._here.popitem(last=False)
        else:
            self._keep(b"handle", name, value)
        return f"spheremesh:{kind}:{name}"

    def take(self, text: str, where: str) -> Value:
        """The value that a text stands for.

        Parameters
        ----------
        text : str
            A handle.
        where : str
            How messages name the input.

        Raises
        ------
        InputError
            If it is no longer known.
        """
        found = _HANDLE.fullmatch(text.strip())
        if not found:
            raise InputError(f"{where}: {text[:60]!r} is no handle of spheremesh")
        name = found[2]
        with self._lock:
            if name in self._here:
                return self._here[name]
        entry = self.store.get(key_of([b"handle", name.encode()]))
        if entry is None:
            raise InputError(f"{where}: {_GONE}")
        return own(entry.value)

    def remember(self, text: str, value: Value) -> None:
        """Know a text again that is given for a value.

        Parameters
        ----------
        text : str
            JSON, which may say less than the value.
        """
        self._keep(b"text", digest(text).hex(), value)

    def recall(self, text: str) -> Value:
        """The value that a text was given for; None if it was not, or long ago."""
        entry = self.store.get(key_of([b"text", digest(text).hex().encode()]))
        return None if entry is None else own(entry.value)

    def _keep(self, sort: bytes, name: str, value: Value) -> None:
        key = key_of([sort, name.encode()])
        if self.store.get(key) is None:
            self.store.put(key, Entry(value, made_by="handle"))


def is_handle(text: str) -> bool:
    """Whether a text means to be a handle."""
    return text.lstrip().startswith("spheremesh:")
