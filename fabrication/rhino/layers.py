"""Layers of a Rhino file: which are on, and which a user means."""

from typing import Any, NamedTuple

from ...kernel.errors import InputError

RhinoObject = Any
"""An object of rhino3dm, whose stubs lack iteration and half of the methods."""


class LayerChoice(NamedTuple):
    """Layers to read.

    Attributes
    ----------
    paths : dict of int to str
        Full path of each layer of the file, by index.
    chosen : set of int, or None
        Layers that were asked for, sublayers included; None for all, and for objects that are
        on no layer.
    hidden : set of int
        Layers that are off.
    remarks : tuple of str
        Layers that are read although they are off.
    """

    paths: dict[int, str]
    chosen: set[int] | None
    hidden: set[int]
    remarks: tuple[str, ...]


def choose_layers(model: RhinoObject, names: str) -> LayerChoice:
    """The layers that names mean, and those that are off.

    Parameters
    ----------
    model : rhino3dm.File3dm
        The file.
    names : str
        Layers by full path (``Roof::Glass``), or by the end of it if no full path fits, several
        with commas; capitals do not matter. Empty for all layers that are on.

    Returns
    -------
    LayerChoice
        A layer that is asked for by name is read even if it is off, with those sublayers that
        come on with it; sublayers that are off themselves are not.

    Raises
    ------
    InputError
        If a name fits no layer; the message lists what there is.
    """
    layers = {each.Index: each for each in model.Layers}
    paths: dict[int, str] = {index: each.FullPath for index, each in layers.items()}
    chains = _chains(layers)
    hidden = {i for i, chain in chains.items() if not all(layers[j].Visible for j in chain)}
    if not names.strip():
        return LayerChoice(paths, None, hidden, ())
    roots = [i for name in _split(paths, names) for i in _matches(paths, hidden, name)]
    chosen = {i for i, chain in chains.items() if set(chain) & set(roots)}
    opened = {
        i
        for root in hidden.intersection(roots)
        for i, chain in chains.items()
        if root in chain
        and all(_comes_on(layers[j]) for j in chain[: chain.index(root)] if j not in roots)
    }
    off = sorted({paths[i] for i in hidden.intersection(roots)})
    remarks = tuple(f"layer {path!r} is off; it is read as it was asked for" for path in off)
    return LayerChoice(paths, chosen, hidden - opened, remarks)


def list_layers(paths: dict[int, str], hidden: set[int]) -> str:
    """The layers of a file, for a message.

    Returns
    -------
    str
        For example ``'Roof', 'Old' (off)``; at most 30 of them.
    """
    named = [f"{path!r}{' (off)' if i in hidden else ''}" for i, path in paths.items()]
    more = f" and {len(named) - 30} more" if len(named) > 30 else ""
    return (", ".join(named[:30]) or "none") + more


def _chains(layers: dict[int, RhinoObject]) -> dict[int, list[int]]:
    """Each layer with those above it, from below; a damaged file may go round in circles."""
    ids = {str(each.Id): index for index, each in layers.items()}
    parents = {i: ids.get(str(each.ParentLayerId)) for i, each in layers.items()}
    chains: dict[int, list[int]] = {}
    for index in layers:
        chain: list[int] = []
        above: int | None = index
        while above is not None and above not in chain:
            chain.append(above)
            above = parents[above]
        chains[index] = chain
    return chains


def _comes_on(layer: RhinoObject) -> bool:
    """Whether a layer is on when those above it are: Rhino keeps that while they are off."""
    return bool(layer.Visible or layer.GetPersistentVisibility())


def _split(paths: dict[int, str], names: str) -> list[str]:
    """Names between commas, unless a layer has commas in its own name."""
    if names.strip().casefold() in {path.casefold() for path in paths.values()}:
        return [names.strip()]
    return [name.strip() for name in names.split(",") if name.strip()]


def _matches(paths: dict[int, str], hidden: set[int], name: str) -> list[int]:
    """Layers of this path: exactly, without regard to capitals, or as its end."""
    folded = name.casefold()
    plain = {index: path.casefold() for index, path in paths.items()}
    for found in (
        [index for index, path in paths.items() if path == name],
        [index for index, path in plain.items() if path == folded],
        [index for index, path in plain.items() if path.endswith(f"::{folded}")],
    ):
        if found:
            return found
    raise InputError(
        f"nothing is on layer {name!r}; the file has layers {list_layers(paths, hidden)}"
    )
