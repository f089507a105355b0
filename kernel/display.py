"""How records show themselves: in a line of text, and in what floors above lend them.

The kernel draws nothing and knows no other library. It says which of its types can be looked
at; who can show them lends a function by name (`lend`), as `progress` knows who listens.
"""

from collections import Counter
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from .arrays import FloatArray, IntArray

_lent: dict[str, Callable[..., Any]] = {}

_PLURALS = {"vertex": "vertices", "annulus": "annuli"}
_POLYGONS = {3: "triangle", 4: "quad", 5: "pentagon", 6: "hexagon"}


def lend(name: str, function: Callable[..., Any]) -> None:
    """Lend what is shown a form.

    Parameters
    ----------
    name : str
        Of the method of `Shown` that asks for it.
    function : callable
        Given the record, and what the method was given.
    """
    _lent[name] = function


class Shown:
    """What can be looked at: it has a view in notebooks, and forms in other libraries."""

    def _repr_html_(self) -> str | None:
        """The view in a notebook; None where there is nothing to draw."""
        return _lent["_repr_html_"](self)

    def to_trimesh(self) -> Any:  # noqa: ANN401, another library's
        """Triangles on the exact surfaces, as a `trimesh.Trimesh`.

        Returns
        -------
        trimesh.Trimesh
            In model units; needs trimesh (extra ``formats``). What each triangle belongs to
            stands in ``face_attributes``.
        """
        return _lent["to_trimesh"](self)

    def to_pyvista(self) -> Any:  # noqa: ANN401, another library's
        """Surfaces with all numbers of their parts, as a `pyvista.PolyData`.

        Returns
        -------
        pyvista.PolyData
            In model units; needs pyvista (extra ``vtk``). Polygons stay polygons; curved parts
            come as triangles with exact normals.
        """
        return _lent["to_pyvista"](self)

    def to_cadquery(self, units: str = "m") -> Any:  # noqa: ANN401, another library's
        """Exact faces or solids, as a `cadquery.Assembly` in millimetres.

        Parameters
        ----------
        units : str
            Model units.

        Returns
        -------
        cadquery.Assembly
            A shape for every part, named by its id.
        """
        return _lent["to_cadquery"](self, units)


def counted(count: int, name: str) -> str:
    """A number of things.

    Returns
    -------
    str
        With the name in the plural but for one.

    Examples
    --------
    >>> counted(1, "panel"), counted(2, "panel"), counted(3, "vertex")
    ('1 panel', '2 panels', '3 vertices')
    """
    plural = _PLURALS.get(name, f"{name}s")
    return f"{count} {name if count == 1 else plural}"


def polygons_text(degrees: IntArray) -> str:
    """How many polygons there are of which kind.

    Returns
    -------
    str
        The most frequent first.

    Examples
    --------
    >>> polygons_text(np.array([4, 3, 4, 7]))
    '2 quads, 1 triangle, 1 7-gon'
    """
    counts: list[int] = degrees.tolist()
    kinds = Counter(counts).most_common()
    parts = [counted(count, _POLYGONS.get(degree, f"{degree}-gon")) for degree, count in kinds]
    return ", ".join(parts[:4] + ["..."] * (len(parts) > 4))


def size_text(points: FloatArray) -> str:
    """Extent of points (N, 3) along the axes.

    Returns
    -------
    str
        In the units of the points.

    Examples
    --------
    >>> size_text(np.array([[0.0, 0, 0], [12, 8, 2.125]]))
    '12 x 8 x 2.12'
    """
    if not len(points):
        return "empty"
    return " x ".join(f"{extent:.3g}" for extent in np.ptp(points, axis=0).tolist())


def radii_text(radii: FloatArray) -> str:
    """Range of radii; infinite ones are planes.

    Returns
    -------
    str
        As short as can be.

    Examples
    --------
    >>> radii_text(np.array([2.0, 5.25, np.inf])), radii_text(np.array([3.0, 3.0]))
    ('radii 2 to 5.25, 1 plane', 'radius 3')
    """
    curved = radii[np.isfinite(radii)]
    low, high = (f"{end:.3g}" for end in (curved.min(initial=np.inf), curved.max(initial=0)))
    flat = len(radii) - len(curved)
    parts = [f"radius {low}" if low == high else f"radii {low} to {high}"] * bool(len(curved))
    return ", ".join(parts + [counted(flat, "plane")] * bool(flat))


def brief(name: str, parts: Iterable[str]) -> str:
    """A record in a line: its name, and what is to be said of it."""
    return f"{name}({'; '.join(part for part in parts if part)})"
