"""Which points, directions and axes the curves and surfaces of a part have in common.

A wall of a panel and the two arcs on it have one centre and one axis; so have both arcs on a
side of a beam, and the side; its outer and inner face have one axis. A direction from which
angles are counted may be any that is not the axis: one serves many. What is one to
`SAME_GEOMETRY` of the size of the part is written once, which halves a file.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np

from ...kernel.arrays import BoolArray, FloatArray, IntArray, dot, norm, unit
from ...kernel.tolerances import SAME_GEOMETRY
from ..breps.records import BrepBatch, FaceBatch

_MARGIN: Final = 1e-3
"""Arcs keep so far (radians) from where angles begin."""

Key = tuple[str, int]


class Plan(NamedTuple):
    """Geometry of parts that share alike: points and directions by number, corners first.

    Placements are point, axis and direction from which angles are counted. Curves are lines of
    a direction, circles and ellipses of a placement; surfaces have a placement, and whether the
    face looks along their normals.
    """

    n_points: int
    n_directions: int
    placements: tuple[tuple[int, int, int], ...]
    curves: tuple[tuple[str, int], ...]
    surfaces: tuple[tuple[str, int, bool], ...]


@dataclass(frozen=True)
class SharedGeometry:
    """Geometry of those parts of a batch that share alike.

    Directions `is_far` reach to distant curves and need more digits. Radii are those of curves,
    one of a circle and two of an ellipse, then those of surfaces.
    """

    members: IntArray
    sizes: FloatArray  # (m,) longest side of the box of the corners
    plan: Plan
    points: FloatArray  # (m, n, 3)
    directions: FloatArray  # (m, k, 3)
    is_far: BoolArray  # (k,)
    radii: FloatArray  # (m, r)


def shared_geometry(batch: BrepBatch) -> list[SharedGeometry]:
    """Geometry of the parts of a batch, by what they share."""
    sharing = _Sharing(batch)
    members = (np.flatnonzero(group) for group in _groups(sharing.kinds()))
    return [sharing.of(rows) for rows in members]


def _groups(kinds: IntArray) -> Iterator[BoolArray]:
    _, labels = np.unique(kinds, axis=0, return_inverse=True)
    labels = labels.ravel()
    for label in range(int(labels.max(initial=-1)) + 1):
        yield labels == label


class _Table:
    """Vectors of parts by key, each once."""

    def __init__(self) -> None:
        self.keys: dict[Key, int] = {}
        self.values: list[FloatArray] = []

    def add(self, key: Key, values: FloatArray) -> int:
        if key not in self.keys:
            self.keys[key] = len(self.values)
            self.values.append(values)
        return self.keys[key]


class _Conics:
    """Circles and ellipses of parts: (m, c, ...), and three points of each arc."""

    def __init__(self, batch: BrepBatch) -> None:
        self.ids = [i for i, edge in enumerate(batch.edges) if edge.kind != "LINE"]
        edges = [batch.edges[i] for i in self.ids]
        self.is_circle = [edge.kind == "CIRCLE" for edge in edges]
        self.is_whole = [edge.start == edge.end for edge in edges]
        shape = (len(batch.rows), len(edges))
        numbers = np.zeros((*shape, 11))
        for c, edge in enumerate(edges):
            numbers[:, c, : edge.numbers.shape[1]] = edge.numbers
            numbers[:, c, 10] = edge.numbers[:, -1]
        self.centers, self.axes, self.x = (numbers[..., i : i + 3] for i in (0, 3, 6))
        self.radii = numbers[..., 9:]
        self.points = np.zeros((*shape, 3, 3))
        self.points[:, :, 0] = batch.corners[:, [edge.start for edge in edges]]
        self.points[:, :, 2] = batch.corners[:, [edge.end for edge in edges]]
        self._fill_middles()

    def _fill_middles(self) -> None:
        x, y = self.x, np.cross(self.axes, self.x)
        rays = self.points[:, :, ::2] - self.centers[:, :, None]
        major, minor = self.radii[..., :1], self.radii[..., 1:]
        angles = np.arctan2(dot(rays, y[:, :, None]) * major, dot(rays, x[:, :, None]) * minor)
        sweeps = (angles[..., 1] - angles[..., 0]) % (2 * np.pi)
        sweeps[:, self.is_whole] = 2 * np.pi
        middle = (angles[..., 0] + sweeps / 2)[..., None]
        self.points[:, :, 1] = (
            self.centers + major * np.cos(middle) * x + minor * np.sin(middle) * y
        )

    def fit(
        self, c: int, center: FloatArray, axis: FloatArray, start: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """How far arcs are from where a placement puts them, and their radii (m, 2) there.

        Infinite where the arc passes the direction from which angles are counted.
        """
        x = unit(start - dot(start, axis)[:, None] * axis)
        rays = self.points[:, c] - center[:, None]
        along, across, off = (dot(rays, each[:, None]) for each in (x, np.cross(axis, x), axis))
        radii = self.radii[:, c]
        if self.is_circle[c]:
            ends = np.hypot(along, across)[:, ::2].mean(axis=1)
            radii = np.stack([ends, ends], axis=1)
        across, along = across / radii[:, 1:], along / radii[:, :1]
        misses = np.abs(np.hypot(along, across) - 1) * radii[:, 1:]
        miss = np.maximum(misses, np.abs(off)).max(axis=1)
        angles = np.arctan2(across, along)
        if self.is_whole[c]:
            return miss + np.abs(angles[:, 0]) * radii[:, 0], radii
        angles %= 2 * np.pi
        is_apart = (angles[:, 0] > _MARGIN) & (angles[:, 2] < 2 * np.pi - _MARGIN)
        is_apart &= (angles[:, 0] <= angles[:, 1]) & (angles[:, 1] <= angles[:, 2])
        return np.where(is_apart, miss, np.inf), radii


class _Sharing:
    """What the parts of a batch share: owners of placements, axes and directions by conic."""

    def __init__(self, batch: BrepBatch) -> None:
        self.batch, self.conics = batch, _Conics(batch)
        self.sizes = np.ptp(batch.corners, axis=1).max(axis=1)
        self.near = SAME_GEOMETRY * self.sizes
        self.every = np.arange(len(batch.rows))
        curved = [f for f, face in enumerate(batch.faces) if face.kind != "PLANE"]
        self.hub = curved[0] if curved else -1
        count = len(self.conics.ids)
        shape = (len(batch.rows), count)
        self.owners, self.axis_owners = (
            np.broadcast_to(np.arange(count), shape).copy() for _ in range(2)
        )
        self.has_own_start = np.ones(shape, bool)
        self.centers, self.axes, self.starts, self.radii = (
            values.copy()
            for values in (
                self.conics.centers, self.conics.axes, self.conics.x, self.conics.radii
            )
        )  # fmt: skip
        for c in range(count):
            self._place(c)
        self.lines = {
            e: self._same_direction(e)
            for e, edge in enumerate(batch.edges)
            if edge.kind == "LINE"
        }
        self.faces = [self._face(f, face) for f, face in enumerate(batch.faces)]

    def _place(self, c: int) -> None:
        """The placement of an earlier conic, or an own one with the axis of an earlier."""
        conics, is_open = self.conics, np.ones(len(self.every), bool)
        earlier = [i for i in range(c) if conics.is_circle[i] == conics.is_circle[c]]
        for i in earlier:
            where = (self.centers[:, i], self.axes[:, i], self.starts[:, i])
            miss, radii = conics.fit(c, *where)
            fits = is_open & (miss < self.near) & (self.owners[:, i] == i)
            self.owners[fits, c], self.radii[fits, c] = i, radii[fits]
            is_open &= ~fits
        for i in earlier:
            fits = is_open & (self.axis_owners[:, c] == c)
            if not fits.any():
                break
            miss, _ = conics.fit(c, conics.centers[:, c], self.axes[:, i], -conics.x[:, c])
            fits &= miss < self.near
            self.axes[fits, c] = self.axes[fits, i]
            self.axis_owners[fits, c] = self.axis_owners[fits, i]
        start = self._hub_direction(c)
        if start is not None:
            miss, radii = conics.fit(c, conics.centers[:, c], self.axes[:, c], start)
            fits = is_open & (miss < self.near)
            self.starts[fits, c], self.radii[fits, c] = start[fits], radii[fits]
            self.has_own_start[fits, c] = False
        shared = ~is_open
        self.axis_owners[shared, c] = self.axis_owners[shared, self.owners[shared, c]]
        self.has_own_start[shared, c] = False

    def _hub_direction(self, c: int) -> FloatArray | None:
        """From the part to the axis of its curved face; along that axis for ellipses."""
        if self.hub < 0:
            return None
        if self.conics.is_circle[c]:
            return self.batch.faces[self.hub].numbers[:, 6:9]
        return self.axes[:, self.conics.is_circle.index(True)] if any(
            self.conics.is_circle
        ) else None  # fmt: skip

    def _same_direction(self, edge: int) -> IntArray:
        """The first line that is parallel, of each part."""
        lines = [e for e in range(edge) if self.batch.edges[e].kind == "LINE"]
        result = np.full(len(self.every), edge)
        for e in reversed(lines):
            change = norm(self.batch.edges[e].numbers - self.batch.edges[edge].numbers)
            result[change < SAME_GEOMETRY] = e
        return result

    def _face(self, f: int, face: FaceBatch) -> IntArray:
        """Whether a face has the placement of another (of an arc of its own, of the first
        sphere): 1, or -1 if its normal is reversed; 0 if it has its own.
        """  # noqa: D205 - one sentence
        c = self.arc_of(face)
        corners = self.batch.corners[:, self._corners_of(face)]
        if face.kind == "SPHERICAL_SURFACE":
            first = self.batch.faces[self.hub].numbers
            rays = norm(corners - first[:, None, :3])
            miss = np.abs(rays - face.numbers[:, 9:]).max(axis=1)
            miss += np.where(
                norm(first[:, :3] - face.numbers[:, :3]) < 1e-6 * face.numbers[:, 9], 0, np.inf
            )
            return ((miss < self.near) & (f != self.hub)).astype(np.int64)
        if c < 0:
            return np.zeros(len(self.every), np.int64)
        owners = self.owners[:, c]
        axis, center = self.axes[self.every, owners], self.centers[self.every, owners]
        rays = corners - center[:, None]
        level = dot(rays, axis[:, None])
        if face.kind == "PLANE":
            sense = np.sign(dot(axis, face.numbers[:, :3]))
            return (sense * (np.abs(level).max(axis=1) < self.near)).astype(np.int64)
        radii = norm(rays - level[..., None] * axis[:, None])
        return (np.abs(radii - face.numbers[:, 9:]).max(axis=1) < self.near).astype(np.int64)

    def _corners_of(self, face: FaceBatch) -> list[int]:
        edges = [edge for ring in (face.ring, *face.holes) for edge, _ in ring]
        return sorted(
            {c for e in edges for c in (self.batch.edges[e].start, self.batch.edges[e].end)}
        )

    def arc_of(self, face: FaceBatch) -> int:
        """The first conic on a plane, the first circle on a cylinder; -1 if there is none."""
        for edge, _ in face.ring:
            kind = self.batch.edges[edge].kind
            if kind == "CIRCLE" or (kind == "ELLIPSE" and face.kind == "PLANE"):
                return self.conics.ids.index(edge)
        return -1

    def kinds(self) -> IntArray:
        """What is shared, a row per part."""
        columns = [self.owners, self.axis_owners, self.has_own_start]
        columns += [np.reshape(x, (-1, 1)) for x in (*self.lines.values(), *self.faces)]
        return np.concatenate([np.asarray(x, np.int64) for x in columns], axis=1)

    def of(self, members: IntArray) -> SharedGeometry:
        """Geometry of members that share alike."""
        return _Planning(self, members).geometry()


class _Planning:
    """Entities of the geometry of parts that share alike, numbered as they are needed."""

    def __init__(self, sharing: _Sharing, members: IntArray) -> None:
        self.sharing, self.members, self.first = sharing, members, int(members[0])
        corners = sharing.batch.corners[members]
        self.points, self.directions = _Table(), _Table()
        for i in range(corners.shape[1]):
            self.points.add(("corner", i), corners[:, i])
        self.far: set[int] = set()
        self.placements: dict[tuple[int, int, int], int] = {}

    def geometry(self) -> SharedGeometry:
        sharing, batch = self.sharing, self.sharing.batch
        curves: list[tuple[str, int]] = []
        radii: list[FloatArray] = []
        for e, edge in enumerate(batch.edges):
            if edge.kind == "LINE":
                curves.append((edge.kind, self._line(e)))
                continue
            c = sharing.conics.ids.index(e)
            curves.append((edge.kind, self._conic(c)))
            count = 1 if edge.kind == "CIRCLE" else 2
            radii.append(sharing.radii[self.members, c, :count])
        surfaces = [self._surface(f, face) for f, face in enumerate(batch.faces)]
        radii += [x.numbers[self.members, 9:] for x in batch.faces if x.kind != "PLANE"]
        plan = Plan(
            len(self.points.values), len(self.directions.values), tuple(self.placements),
            tuple(curves), tuple(surfaces),
        )  # fmt: skip
        is_far = np.isin(np.arange(plan.n_directions), list(self.far))
        return SharedGeometry(
            self.members, sharing.sizes[self.members], plan, np.stack(self.points.values, 1),
            np.stack(self.directions.values, 1), is_far,
            np.concatenate([*radii, np.zeros((len(self.members), 0))], axis=1),
        )  # fmt: skip

    def _placement(self, point: int, axis: int, start: int) -> int:
        return self.placements.setdefault((point, axis, start), len(self.placements))

    def _line(self, e: int) -> int:
        first = int(self.sharing.lines[e][self.first])
        return self.directions.add(
            ("line", first), self.sharing.batch.edges[first].numbers[self.members]
        )

    def _axis(self, c: int) -> int:
        first = int(self.sharing.axis_owners[self.first, c])
        axis = self.directions.add(("axis", first), self.sharing.axes[self.members, first])
        self.far.add(axis)
        return axis

    def _surface_axis(self, f: int, kind: str) -> int:
        at = {"z": 3, "x": 6}[kind]
        numbers = self.sharing.batch.faces[f].numbers[self.members]
        return self.directions.add((kind, f), numbers[:, at : at + 3])

    def _conic(self, c: int) -> int:
        sharing = self.sharing
        c = int(sharing.owners[self.first, c])
        point = self.points.add(("centre", c), sharing.centers[self.members, c])
        axis = self._axis(c)
        if sharing.has_own_start[self.first, c]:
            start = self.directions.add(("start", c), sharing.starts[self.members, c])
        elif sharing.conics.is_circle[c]:
            start = self._surface_axis(sharing.hub, "x")
        else:
            start = self._axis(sharing.conics.is_circle.index(True))
        return self._placement(point, axis, start)

    def _surface(self, f: int, face: FaceBatch) -> tuple[str, int, bool]:
        shared = int(self.sharing.faces[f][self.first])
        if face.kind == "SPHERICAL_SURFACE" or not shared:
            place = self._own(self.sharing.hub if shared else f, face)
        else:
            place = self._conic(self.sharing.arc_of(face))
        return face.kind, place, face.is_along == (shared >= 0)

    def _own(self, f: int, face: FaceBatch) -> int:
        if face.kind == "PLANE":
            lines = [e for e, _ in face.ring if self.sharing.batch.edges[e].kind == "LINE"]
            axis = self.directions.add(("normal", f), face.numbers[self.members, :3])
            along = face.numbers[self.members, 3:]
            start = self._line(lines[0]) if lines else self.directions.add(("x", f), along)
            return self._placement(face.corner, axis, start)
        numbers = self.sharing.batch.faces[f].numbers[self.members]
        point = self.points.add(("origin", f), numbers[:, :3])
        axis, start = self._surface_axis(f, "z"), self._surface_axis(f, "x")
        if face.kind == "CYLINDRICAL_SURFACE":
            self.far.add(axis)
        return self._placement(point, axis, start)
