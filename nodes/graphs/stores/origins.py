"""The code that a result comes from, as a fingerprint: results on disk outlive it."""

import inspect
import platform
import sys
from collections.abc import Callable
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, Final

import xxhash

_ROOT: Final = __name__.partition(".")[0]
_ROOMS: Final = ("kernel", "nodes", "fabrication", "viewer")
_COMPUTE: Final = ("numpy", "scipy", "libigl")
"""Libraries in whose versions results may differ."""


def code_origin(function: Callable[..., Any]) -> str:
    """A fingerprint of the code of a node.

    Parameters
    ----------
    function : callable
        Of the node.

    Returns
    -------
    str
        Of the library: its version and sources. Of other modules: the file that the function
        stands in, whole, for it may call others there. Empty if there is no source to go by.
    """
    module = function.__module__
    if module.partition(".")[0] == _ROOT:
        return library_origin()
    own = _module_origin(module) or _source_digest(function)
    return f"{library_origin()} {module} {own}" if own else ""


@cache
def library_origin() -> str:
    """A fingerprint of the library and of what it computes with.

    Returns
    -------
    str
        Versions, and a digest of all sources.
    """
    state = xxhash.xxh3_128()
    for room in _ROOMS:
        for folder in sys.modules[f"{_ROOT}.nodes"].__path__:
            root = Path(folder).parent / room
            for path in sorted(root.rglob("*.py")):
                state.update(path.relative_to(root).as_posix().encode())
                state.update(path.read_bytes())
    versions = [f"{name} {_version(name)}" for name in (_ROOT, *_COMPUTE)]
    python = f"python {sys.version_info.major}.{sys.version_info.minor} {platform.machine()}"
    return " ".join([*versions, python, state.hexdigest()])


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""


@cache
def _module_origin(name: str) -> str:
    """Digest of the file of a module; empty for those that have none, such as notebooks."""
    path = getattr(sys.modules.get(name), "__file__", None)
    try:
        return xxhash.xxh3_128_hexdigest(Path(path).read_bytes()) if path else ""
    except OSError:
        return ""


def _source_digest(function: Callable[..., Any]) -> str:
    try:
        return xxhash.xxh3_128_hexdigest(inspect.getsource(function).encode())
    except (OSError, TypeError):
        return ""
