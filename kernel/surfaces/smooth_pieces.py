"""Polysurfaces whose faces and edges are smooth: divided where a surface or a curve has a kink.

A row of vertices then stands on every kink, instead of faces that cut it off.
"""

from itertools import pairwise
from typing import TypeAlias

import numpy as np

from ..arrays import FloatArray, IntArray, dot, norm, unit
from ..tolerances import CLOSED, POLE, SMOOTH_JOINT
from .nurbs import NurbsSurface, evaluate_nurbs
from .poles import find_poles, surface_size
from .trimmed_faces import Polysurface, ShareCurve, Trim, TrimmedFace

_SAMPLES = 17
_BESIDE = 1e-9
_SEARCH = 257
_HALVINGS = 60


def whole_surface(surface: NurbsSurface, *, is_reversed: bool = False) -> Polysurface:
    """A surface over its whole domain: one face, or several between its kinks.

    Parameters
    ----------
    is_reversed : bool
        Whether the faces look against the normal of the surface.

    Returns
    -------
    Polysurface
        Opposite sides that coincide are one edge, a seam; sides that are a point have none.
    """
    u, v = (_divisions(surface, axis) for axis in (0, 1))
    n, m = len(u) - 1, len(v) - 1
    vertices = np.arange((n + 1) * (m + 1)).reshape(n + 1, m + 1)
    # Edges along u stand on the lines of constant v, and the other way round.
    along_u = np.arange(n * (m + 1)).reshape(n, m + 1)
    along_v = along_u.size + np.arange((n + 1) * m).reshape(n + 1, m)
    if _is_closed(surface, 0):
        vertices[-1], along_v[-1] = vertices[0], along_v[0]
    if _is_closed(surface, 1):
        vertices[:, -1], along_u[:, -1] = vertices[:, 0], along_u[:, 0]
    for pole in find_poles(surface):
        line, ids = (vertices, along_v) if pole.axis == 0 else (vertices.T, along_u.T)
        # The pole of a closed surface is one vertex, and so is what was merged with it.
        line[np.isin(line, line[-pole.end])] = line[-pole.end, 0]
        ids[-pole.end] = -1
    edges: list[ShareCurve] = [
        _on_surface(surface, _segment((a, w), (b, w))) for a, b in pairwise(u) for w in v
    ]
    edges += [_on_surface(surface, _segment((w, a), (w, b))) for w in u for a, b in pairwise(v)]
    faces: list[TrimmedFace] = []
    for i in range(n):
        for j in range(m):
            ring = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
            ids = [along_u[i, j], along_v[i + 1, j], along_u[i, j + 1], along_v[i, j]]
            trims = [
                Trim(
                    int(edge),
                    side > 1,
                    (int(vertices[a]), int(vertices[b])),
                    _segment((u[a[0]], v[a[1]]), (u[b[0]], v[b[1]])),
                )
                for side, (edge, a, b) in enumerate(
                    zip(ids, ring, ring[1:] + ring[:1], strict=True)
                )
            ]
            faces.append(TrimmedFace(surface, [trims], is_reversed))
    return Polysurface(faces, edges)


def _divisions(surface: NurbsSurface, axis: int) -> list[float]:
    """Ends of the domain, and the parameters between them where the surface has a kink."""
    knots = (surface.knots_u, surface.knots_v)[axis]
    degree, (low, high) = surface.degrees[axis], surface.domain[axis]
    values, counts = np.unique(knots, return_counts=True)
    inner = (values > low) & (values < high) & (counts >= degree)
    kinks = [t for t in values[inner].tolist() if _has_kink(surface, axis, t)]
    return [float(low), *kinks, float(high)]


def _has_kink(surface: NurbsSurface, axis: int, parameter: float) -> bool:
    (low, high), (start, stop) = surface.domain[axis], surface.domain[1 - axis]
    sides: list[FloatArray] = []
    for step in (-_BESIDE, _BESIDE):
        uv = np.empty((_SAMPLES, 2))
        uv[:, axis] = parameter + step * (high - low)
        uv[:, 1 - axis] = np.linspace(start, stop, _SAMPLES)
        jet = evaluate_nurbs(surface, *uv.T)
        sides.append(jet.u if axis == 0 else jet.v)
    # At a pole there is no direction that could break.
    least = POLE * surface_size(surface) / (high - low)
    has_direction = np.minimum(*map(norm, sides)) > least
    turned = dot(unit(sides[0]), unit(sides[1])) < np.cos(SMOOTH_JOINT)
    return bool((turned & has_direction).any())


def _is_closed(surface: NurbsSurface, axis: int) -> bool:
    start, stop = surface.domain[1 - axis]
    ends: list[FloatArray] = []
    for end in surface.domain[axis]:
        uv = np.empty((_SAMPLES, 2))
        uv[:, axis] = end
        uv[:, 1 - axis] = np.linspace(start, stop, _SAMPLES)
        ends.append(evaluate_nurbs(surface, *uv.T).points)
    return bool(norm(ends[0] - ends[1]).max() <= CLOSED * surface_size(surface))


def _segment(start: tuple[float, float], end: tuple[float, float]) -> ShareCurve:
    first, last = np.array(start), np.array(end)
    # Both ends are exact: a domain must not be left by rounding.
    return lambda share: (1 - share)[:, None] * first + share[:, None] * last


def _on_surface(surface: NurbsSurface, curve: ShareCurve) -> ShareCurve:
    return lambda share: evaluate_nurbs(surface, *curve(share).T).points


_Pieces: TypeAlias = dict[int, tuple[list[int], list[int], FloatArray]]
"""Of an edge: the edges in its place, the vertices between them, and their places."""


def split_edges(polysurface: Polysurface, kinks: list[list[float]]) -> Polysurface:
    """The polysurface with edges divided, and with them the trims on both of their sides.

    Parameters
    ----------
    kinks : list of list of float
        For each edge, shares of its parameters where it is divided, rising, between 0 and 1.

    Returns
    -------
    Polysurface
        The first piece of an edge keeps its number.
    """
    if not any(kinks):
        return polysurface
    edges = list(polysurface.edges)
    ends = [t.ends for f in polysurface.faces for loop in f.loops for t in loop]
    vertex = 1 + max(max(pair) for pair in ends)
    pieces: _Pieces = {}
    for i, shares in enumerate(kinks):
        if not shares:
            continue
        curve = polysurface.edges[i]
        ids = [i, *range(len(edges), len(edges) + len(shares))]
        bounds = [0.0, *shares, 1.0]
        for edge, (a, b) in zip(ids, pairwise(bounds), strict=True):
            edges[edge : edge + 1] = [_piece(curve, a, b)]
        pieces[i] = ids, list(range(vertex, vertex + len(shares))), curve(np.array(shares))
        vertex += len(shares)
    faces = [
        face._replace(
            loops=[
                [part for trim in loop for part in _split_trim(face, trim, pieces)]
                for loop in face.loops
            ]
        )
        for face in polysurface.faces
    ]
    return Polysurface(faces, edges)


def _split_trim(
    face: TrimmedFace,
    trim: Trim,
    pieces: _Pieces,
) -> list[Trim]:
    if trim.edge not in pieces:
        return [trim]
    edges, inner, places = pieces[trim.edge]
    if trim.is_reversed:
        edges, inner, places = edges[::-1], inner[::-1], places[::-1]
    bounds = [0.0, *_shares_of(face, trim, places), 1.0]
    vertices = [trim.ends[0], *inner, trim.ends[1]]
    return [
        Trim(edge, trim.is_reversed, pair, _piece(trim.curve, *span))
        for edge, pair, span in zip(edges, pairwise(vertices), pairwise(bounds), strict=True)
    ]


def _shares_of(face: TrimmedFace, trim: Trim, places: FloatArray) -> list[float]:
    """Shares of a trim nearest to points on its edge: a sample, then halvings of steps."""

    def _places(shares: FloatArray) -> FloatArray:
        uv = np.clip(trim.curve(shares), *face.surface.domain.T)
        return evaluate_nurbs(face.surface, *uv.T).points

    samples = np.linspace(0, 1, _SEARCH)
    points = _places(samples)
    nearest = norm(points[None, 1:-1] - places[:, None]).argmin(1) + 1
    best, step = samples[nearest], 1 / (_SEARCH - 1)
    for _ in range(_HALVINGS):
        step /= 2
        tries = np.clip(best + step * np.array([[-1.0], [0.0], [1.0]]), 0, 1)
        away = norm(_places(tries.ravel()).reshape(3, -1, 3) - places)
        best = tries[away.argmin(0), np.arange(len(best))]
    return np.sort(best).tolist()


def _piece(curve: ShareCurve, start: float, end: float) -> ShareCurve:
    return lambda share: curve((1 - share) * start + share * end)


def kink_shares(curve: ShareCurve, candidates: FloatArray) -> list[float]:
    """Those of some shares of a curve where its direction breaks.

    Parameters
    ----------
    candidates : (n,) float array
        Shares between 0 and 1, rising.

    Returns
    -------
    list of float
        Where the curve turns by more than the angle of a smooth joint.
    """
    if not len(candidates):
        return []
    steps: IntArray = np.array([[-2], [-1], [1], [2]])
    points = curve((candidates + steps * np.sqrt(_BESIDE)).ravel()).reshape(
        4, len(candidates), -1
    )
    before, after = unit(points[1] - points[0]), unit(points[3] - points[2])
    return candidates[dot(before, after) < np.cos(SMOOTH_JOINT)].tolist()
