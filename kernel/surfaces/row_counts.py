"""How many edges of a mesh stand on each edge of a polysurface, so that its faces meet."""

from typing import NamedTuple

import numpy as np

from ..arrays import FloatArray, IntArray, norm
from ..errors import InputError
from ..solvers.weighted_graphs import piece_labels
from .face_plans import FacePlan
from .trimmed_faces import Polysurface

_SHARES = np.linspace(0, 1, 65)
_SWEEPS = 12
_MOST_FACES = 1_000_000


class GridSize(NamedTuple):
    """How fine a mesh on surfaces is to be.

    Attributes
    ----------
    n_u, n_v : int
        Quads along u and v of every face, where no length is given.
    edge_length : float, optional
        Length of the edges, in model units.
    """

    n_u: int
    n_v: int
    edge_length: float | None = None


class RowCounts(NamedTuple):
    """Numbers of mesh edges.

    Attributes
    ----------
    trims : list of list of IntArray
        For each face and loop, on each trim.
    plans : list of FacePlan
        The plans, without those that the numbers do not fit.
    """

    trims: list[list[IntArray]]
    plans: list[FacePlan]


def edge_lengths_along(polysurface: Polysurface) -> list[FloatArray]:
    """Lengths of the edges up to each of 65 shares of their parameters.

    Returns
    -------
    list of (65,) float array
        From 0 to the length of the edge, in model units.
    """
    return [
        np.concatenate([[0.0], np.cumsum(norm(np.diff(edge(_SHARES), axis=0)))])
        for edge in polysurface.edges
    ]


def count_rows(
    polysurface: Polysurface, plans: list[FacePlan], lengths: FloatArray, size: GridSize
) -> RowCounts:
    """Numbers of mesh edges on all edges.

    Parameters
    ----------
    plans : list of FacePlan
        One for each face.
    lengths : (E,) float array
        Of the edges, in model units.

    Returns
    -------
    RowCounts
        Opposite sides of a grid have the same number, all sides of a fan have the same even
        one, that around a disc is a multiple of four.

    Raises
    ------
    InputError
        If the mesh would have more than a million faces.

    Notes
    -----
    Edges that must have the same number are one class. Each face says how many it wants; a
    class takes the mean of the wishes that come from lengths, and the largest of those that
    are numbers. Sides of several edges are then filled up in sweeps.
    """
    ids = _numbered(polysurface)
    book = _Book(polysurface, plans, ids, lengths, size)
    for _ in range(_SWEEPS):
        if not book.fill_up():
            break
    kept = [
        plan if book.is_met(i) else FacePlan("triangles", plan.sides)
        for i, plan in enumerate(plans)
    ]
    counts = book.counts()
    return RowCounts([[counts[loop] for loop in loops] for loops in ids], kept)


def _numbered(polysurface: Polysurface) -> list[list[IntArray]]:
    """Ids of the edges of all trims; poles have ids of their own after those of the edges."""
    following = len(polysurface.edges)
    ids: list[list[IntArray]] = []
    for face in polysurface.faces:
        ids.append([])
        for loop in face.loops:
            edges = np.array([trim.edge for trim in loop], np.int64)
            n_poles = int((edges < 0).sum())
            edges[edges < 0] = np.arange(following, following + n_poles)
            following += n_poles
            ids[-1].append(edges)
    return ids


class _Book:
    """Classes of edges and their numbers."""

    def __init__(
        self,
        polysurface: Polysurface,
        plans: list[FacePlan],
        ids: list[list[IntArray]],
        lengths: FloatArray,
        size: GridSize,
    ) -> None:
        count = max([len(lengths), *(int(e.max()) + 1 for loops in ids for e in loops)])
        self.plans, self.ids, self.size = plans, ids, size
        self.lengths = np.zeros(count)
        self.lengths[: len(lengths)] = lengths
        self.classes = self._classes(count)
        wishes: list[list[float]] = [[] for _ in range(count)]
        for i in range(len(plans)):
            for edge, wish in self._wishes(i):
                wishes[int(self.classes[edge])].append(wish)
        self.values = np.ones(count, np.int64)
        for i, each in enumerate(wishes):
            if each:
                wish = max(each) if size.edge_length is None else float(np.mean(each))
                self.values[i] = max(1, round(min(wish, _MOST_FACES)))
        for face in polysurface.faces:
            for trim in (trim for loop in face.loops for trim in loop):
                # A closed edge of fewer is no curve any more.
                if trim.edge >= 0 and trim.ends[0] == trim.ends[1] and size.edge_length:
                    self._raise(np.array([trim.edge]), 3)
        self._refuse_too_many()

    def _classes(self, count: int) -> IntArray:
        pairs: list[tuple[int, int]] = []
        for plan, loops in zip(self.plans, self.ids, strict=True):
            sides = [loops[0][side] for side in plan.sides]
            linked = {"grid": ((0, 2), (1, 3)), "fan": [(0, i) for i in range(len(sides))]}
            pairs += [
                (int(sides[a][0]), int(sides[b][0]))
                for a, b in linked.get(plan.kind, ())
                if len(sides[a]) == len(sides[b]) == 1
            ]
        a, b = np.array(pairs, np.int64).reshape(-1, 2).T
        return piece_labels(a, b, count)

    def _sides(self, index: int) -> list[IntArray]:
        return [self.ids[index][0][side] for side in self.plans[index].sides]

    def _wishes(self, index: int) -> list[tuple[int, float]]:
        """Edges of a face and the numbers that it wants there."""
        plan, size, loops = self.plans[index], self.size, self.ids[index]
        length = size.edge_length
        if plan.kind == "grid":
            rows = (size.n_u, size.n_v) if plan.is_first_u else (size.n_v, size.n_u)
            found: list[tuple[int, float]] = []
            for d, side in enumerate(self._sides(index)):
                wish = rows[d % 2] if length is None else plan.extents[d % 2] / length
                total = self.lengths[side].sum()
                parts = self.lengths[side] / total if total else np.ones(len(side))
                found += [(int(e), float(wish * p)) for e, p in zip(side, parts, strict=True)]
            return found
        edges = np.concatenate(loops)
        if length is not None:
            return [(int(e), float(self.lengths[e]) / length) for e in edges if self.lengths[e]]
        most = max(size.n_u, size.n_v)
        if plan.kind == "fan":
            return [(int(e), most + most % 2) for e in edges]
        around = most if plan.kind == "disc" else 2 * (size.n_u + size.n_v)
        total = float(self.lengths[loops[0]].sum()) or 1.0
        return [(int(e), around * float(self.lengths[e]) / total) for e in edges]

    def _raise(self, edges: IntArray, least: int) -> bool:
        """Raise the numbers on a side, on its longest edge, until there are as many."""
        missing = least - self._total(edges)
        if missing <= 0:
            return False
        chosen = self.classes[edges[np.argmax(self.lengths[edges])]]
        times = int((self.classes[edges] == chosen).sum())
        self.values[chosen] += -(-missing // times)
        return True

    def _total(self, edges: IntArray) -> int:
        return int(self.values[self.classes[edges]].sum())

    def _targets(self, index: int) -> list[tuple[IntArray, int]]:
        """Sides or loops of a face, and how many mesh edges they need."""
        plan, loops = self.plans[index], self.ids[index]
        sides = self._sides(index)
        totals = [self._total(side) for side in sides]
        if plan.kind == "grid":
            return [(side, max(totals[d], totals[(d + 2) % 4])) for d, side in enumerate(sides)]
        if plan.kind == "fan":
            most = max(totals)
            return [(side, most + most % 2) for side in sides]
        if plan.kind == "disc":
            return [(loops[0], max(4, -(-self._total(loops[0]) // 4) * 4))]
        return [(loop, 3) for loop in loops]

    def fill_up(self) -> bool:
        """Raise the numbers that faces need raised: whether there are any."""
        is_raised = False
        for i in range(len(self.plans)):
            for side, least in self._targets(i):
                is_raised |= self._raise(side, least)
        return is_raised

    def is_met(self, index: int) -> bool:
        return all(self._total(side) == least for side, least in self._targets(index))

    def counts(self) -> IntArray:
        return self.values[self.classes]

    def _refuse_too_many(self) -> None:
        total = 0
        for i, plan in enumerate(self.plans):
            sides = [self._total(side) for side in self._sides(i)]
            total += sides[0] * sides[1] if plan.kind == "grid" else sum(sides) ** 2 // 16
        if total > _MOST_FACES and self.size.edge_length is not None:
            raise InputError(
                f"an edge length of {self.size.edge_length:g} gives some {total} faces, more "
                f"than {_MOST_FACES}; ask for longer edges"
            )
