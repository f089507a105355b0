"""Triangles for pictures and viewers: points and normals exact, only the faces between flat.

A panel is triangulated as a fan about its middle, in the stereographic chart of its sphere: the
chart keeps circles, so its outline stays as simple as the panel. Rings of points divide the
fan; the outermost ring lies on the arcs of the edges.
"""

from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm, unit
from ..errors import InputError
from ..spheres.arcs import Arcs, arc_points
from ..spheres.incidence import normals, project
from .panels import Panels, boundaries, panel_arcs

MAX_STEPS = 32


@dataclass(frozen=True)
class PanelTriangles:
    """Triangulated panels.

    Attributes
    ----------
    origin : (3,) float array
        Origin of the points, in model coordinates: near the panels, so that single precision
        is enough for a viewer wherever the model sits.
    points : (N, 3) float array
        Points on the surfaces, relative to the origin.
    normals : (N, 3) float array
        Exact unit normals there, pointing out of the panel (along N without thickness).
    triangles : (T, 3) int array
        Points of each triangle, counter-clockwise about the normals.
    panels : (T,) int array
        Panel of each triangle.
    surfaces : (T,) int array
        Surface of each triangle, a row of `surface_rows`.
    """

    origin: FloatArray
    points: FloatArray
    normals: FloatArray
    triangles: IntArray
    panels: IntArray
    surfaces: IntArray


def surface_rows(panels: Panels) -> FloatArray:
    """All surfaces that bound panels, oriented outwards: unit rows (2P + H, 5), local.

    The outer faces, the inner faces, the side walls.
    """
    walls = np.zeros((len(panels.corners), 5))
    walls[:, 1:4] = -panels.plane_normals
    walls[:, 4] = -panels.plane_offsets
    return np.concatenate([panels.spheres, -panels.inner_spheres, walls])


def tessellate(
    panels: Panels, tolerance: FloatArray | float = 0.002, *, solid: bool = True
) -> PanelTriangles:
    """Triangulate panels.

    Parameters
    ----------
    tolerance : float or (P,) float array
        Largest distance of a triangle from its surface, relative to the radius of the panel
        (its farthest corner), of all panels or of each; reached by at most `MAX_STEPS` steps
        per edge.
    solid : bool
        Whether panels with a thickness get their inner faces and side walls.

    Returns
    -------
    PanelTriangles
        Points of a panel agree to the bit where its faces and walls meet. Neighbours agree as
        well as their arcs do (see `edge_gaps`) where both take the same number of steps, else
        within the tolerance.

    Raises
    ------
    InputError
        If the tolerance is not positive.

    Notes
    -----
    Works on all panels of one degree and number of steps at a time. Panels that cannot be
    seen whole from their middle are cut into ears along their outline, without inner points.
    """
    if not np.min(tolerance, initial=np.inf) > 0:
        raise InputError(f"the tolerance must be positive, not {tolerance}")
    sides = boundaries(panels) if solid else [(panels.spheres, panel_arcs(panels))]
    steps = _steps(panels, sides[0][1], tolerance)
    pieces: list[_Piece] = []
    kinds = np.unique(np.stack([panels.degrees, steps], 1), axis=0)
    for degree, count in kinds.tolist():
        members = np.flatnonzero((panels.degrees == degree) & (steps == count))
        edges = panels.offsets[members][:, None] + np.arange(int(degree))
        rims = [_rim_points(arcs, edges, count) for _, arcs in sides]
        for side, (rows, arcs) in enumerate(sides):
            faces = _face_pieces(rows[members], arcs, edges, rims[side], members)
            pieces += faces if side == 0 else [_inside_out(piece, panels) for piece in faces]
        if len(sides) == 2:
            pieces.append(_wall_piece(panels, edges, rims, members))
    return _join(panels, pieces)


@dataclass(frozen=True)
class _Piece:
    """Points (n, m, 3), normals, triangles (t, 3) of n alike pieces, (n,) panels, surfaces."""

    points: FloatArray
    normals: FloatArray
    triangles: IntArray
    panels: IntArray
    surfaces: IntArray


def _steps(panels: Panels, arcs: Arcs, tolerance: FloatArray | float) -> IntArray:
    """Steps per edge and from the middle to the rim that keep the chords within tolerance."""
    sizes = np.maximum.reduceat(norm(panels.corners), panels.offsets[:-1])
    rises = np.maximum.reduceat(np.abs(arcs.sagittas), panels.offsets[:-1])
    bulge = np.abs(panels.spheres[:, 0]) * sizes**2 / 4
    count = np.ceil(np.sqrt(np.maximum(rises, bulge) / (tolerance * sizes)))
    return np.clip(count, 1, MAX_STEPS).astype(np.int64)


def _select(arcs: Arcs, ids: IntArray) -> Arcs:
    return Arcs(arcs.starts[ids], arcs.ends[ids], arcs.rises[ids], arcs.sagittas[ids])


def _edge_points(arcs: Arcs, edges: IntArray, steps: int) -> FloatArray:
    """Points (n, k, steps, 3) of the arcs of n panels, the start of each arc to the bit."""
    parameters = np.linspace(-1, 1, steps, endpoint=False)
    points = arc_points(_select(arcs, edges.ravel()), parameters)
    points[:, 0] = arcs.starts[edges.ravel()]
    return points.reshape(*edges.shape, steps, 3)


def _rim_points(arcs: Arcs, edges: IntArray, steps: int) -> FloatArray:
    points = _edge_points(arcs, edges, steps)
    return points.reshape(len(edges), -1, 3)


def _face_pieces(
    rows: FloatArray, arcs: Arcs, edges: IntArray, rim: FloatArray, panels: IntArray
) -> list[_Piece]:
    """A fan for the panels that can be seen whole from their middle, ears for the others."""
    degree = edges.shape[1]
    steps = rim.shape[1] // degree
    chart = _Chart.about(rows, rim.mean(axis=1))
    outline = chart.flatten(rim)
    turns = _cross(outline, np.roll(outline, -1, axis=1))
    is_star = np.all(turns > 0, axis=1)
    pieces: list[_Piece] = []
    if is_star.any():
        star = chart.select(is_star)
        rings = [star.middle[:, None]]
        for ring in range(1, steps):
            inner = star.flatten(_rim_points(arcs, edges[is_star], ring))
            rings.append(star.lift(inner * (ring / steps)))
        points = np.concatenate([*rings, rim[is_star]], axis=1)
        pieces.append(_piece(rows[is_star], points, _fan(degree, steps), panels[is_star]))
    for panel in np.flatnonzero(~is_star):
        one = slice(panel, panel + 1)
        pieces.append(_piece(rows[one], rim[one], cut_ears(outline[panel]), panels[one]))
    return pieces


def _piece(
    rows: FloatArray, points: FloatArray, triangles: IntArray, panels: IntArray
) -> _Piece:
    return _Piece(points, normals(rows[:, None], points), triangles, panels, panels)


def _inside_out(piece: _Piece, panels: Panels) -> _Piece:
    """An inner face, which looks out of its panel against N."""
    surfaces = piece.surfaces + panels.n_panels
    turned = piece.triangles[:, ::-1]
    return _Piece(piece.points, -piece.normals, turned, piece.panels, surfaces)


def _wall_piece(
    panels: Panels, edges: IntArray, rims: list[FloatArray], members: IntArray
) -> _Piece:
    """Strips between the outer and the inner arc of each edge."""
    outer, inner = (_open_edges(rim, edges.shape[1]) for rim in rims)
    steps = int(outer.shape[1]) - 1
    low: IntArray = np.arange(steps)
    high = low + steps + 1
    strip = (low, high, low + 1), (low + 1, high, high + 1)
    triangles = np.concatenate([np.stack(corners, 1) for corners in strip])
    points = np.concatenate([outer, inner], axis=1)
    outwards = -panels.plane_normals[edges.ravel()][:, None]
    owners = np.repeat(members, edges.shape[1])
    surfaces = 2 * panels.n_panels + edges.ravel()
    return _Piece(points, np.broadcast_to(outwards, points.shape), triangles, owners, surfaces)


def _open_edges(rim: FloatArray, degree: int) -> FloatArray:
    """Points (n k, steps + 1, 3) of each edge, both ends included."""
    edges = rim.reshape(len(rim), degree, -1, 3)
    ends = np.roll(edges[:, :, :1], -1, axis=1)
    closed = np.concatenate([edges, ends], axis=2)
    return closed.reshape(-1, closed.shape[2], 3)


def _join(panels: Panels, pieces: list[_Piece]) -> PanelTriangles:
    origin = panels.origins.mean(axis=0) if panels.n_panels else np.zeros(3)
    shifts = panels.origins - origin
    points = [(piece.points + shifts[piece.panels][:, None]).reshape(-1, 3) for piece in pieces]
    vectors = [piece.normals.reshape(-1, 3) for piece in pieces]
    first = np.cumsum([0, *(len(part) for part in points)])
    triangles = [
        (start + _numbered(piece)).reshape(-1, 3)
        for start, piece in zip(first.tolist(), pieces, strict=False)
    ]
    owners = [np.repeat(piece.panels, len(piece.triangles)) for piece in pieces]
    surfaces = [np.repeat(piece.surfaces, len(piece.triangles)) for piece in pieces]
    none, nobody = np.zeros((0, 3)), np.zeros(0, np.int64)
    return PanelTriangles(
        origin,
        np.concatenate([none, *points]),
        np.concatenate([none, *vectors]),
        np.concatenate([nobody.reshape(0, 3), *triangles]),
        np.concatenate([nobody, *owners]),
        np.concatenate([nobody, *surfaces]),
    )


def _numbered(piece: _Piece) -> IntArray:
    """Triangles (n, t, 3) of all pieces, their points counted through."""
    n, m = int(piece.points.shape[0]), int(piece.points.shape[1])
    starts: IntArray = m * np.arange(n)
    return starts[:, None, None] + piece.triangles


def _fan(degree: int, steps: int) -> IntArray:
    """Triangles of a fan of `degree` sectors, each divided in ``steps²``.

    Point 0 is the middle; ring j of ``degree * j`` points follows ring j - 1.
    """

    def point(ring: int, index: IntArray) -> IntArray:
        first = 1 + degree * ring * (ring - 1) // 2 if ring else 0
        return first + index % max(degree * ring, 1)

    triangles: list[IntArray] = []
    sector: IntArray = np.arange(degree)[:, None]
    for ring in range(1, steps + 1):
        index: IntArray = np.arange(ring)
        inner, outer = sector * (ring - 1) + index, sector * ring + index
        corners = (point(ring - 1, inner), point(ring, outer), point(ring, outer + 1))
        triangles.append(np.stack(corners, -1).reshape(-1, 3))
        inner, outer = inner[:, :-1], outer[:, :-1] + 1
        corners = (point(ring - 1, inner), point(ring, outer), point(ring - 1, inner + 1))
        triangles.append(np.stack(corners, -1).reshape(-1, 3))
    return np.concatenate(triangles)


@dataclass(frozen=True)
class _Chart:
    """Stereographic charts of spheres, planes included.

    A point d from the middle has the chart coordinates ``(d·x, d·y) / (1 - A d·N)``.
    """

    middle: FloatArray
    frame: FloatArray
    curvatures: FloatArray

    @classmethod
    def about(cls, rows: FloatArray, points: FloatArray) -> "_Chart":
        middle = project(rows, points)
        axis = unit(normals(rows, middle))
        # Any direction across the axis will do: take the cross product with the most distant
        # coordinate axis.
        other = np.eye(3)[np.argmin(np.abs(axis), axis=1)]
        first = unit(np.cross(other, axis))
        return cls(middle, np.stack([first, np.cross(axis, first), axis], 1), rows[:, 0])

    def select(self, keep: BoolArray) -> "_Chart":
        return _Chart(self.middle[keep], self.frame[keep], self.curvatures[keep])

    def flatten(self, points: FloatArray) -> FloatArray:
        local = np.einsum("nij,nmj->nmi", self.frame, points - self.middle[:, None])
        return local[..., :2] / (1 - self.curvatures[:, None] * local[..., 2])[..., None]

    def lift(self, flat: FloatArray) -> FloatArray:
        square = self.curvatures[:, None] * dot(flat, flat)
        local = np.concatenate([flat, square[..., None]], axis=-1)
        local /= (1 + self.curvatures[:, None] * square)[..., None]
        return self.middle[:, None] + np.einsum("nij,nmi->nmj", self.frame, local)


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def cut_ears(outline: FloatArray) -> IntArray:
    """Triangulate a simple polygon (n, 2), counter-clockwise, by its ears: (n - 2, 3).

    A polygon that crosses itself, and has no ear left, is closed by triangles that may overlap.

    Examples
    --------
    >>> arrow = np.array([[0.0, 0.0], [2.0, -1.0], [1.0, 0.0], [2.0, 1.0]])
    >>> cut_ears(arrow).tolist()
    [[0, 1, 2], [0, 2, 3]]
    """
    left = list(range(len(outline)))
    triangles: list[tuple[int, int, int]] = []
    while len(left) > 3:
        best = max(range(len(left)), key=lambda i: _ear_quality(outline, left, i))
        triangles.append((left[best - 1], left[best], left[(best + 1) % len(left)]))
        del left[best]
    triangles.append((left[0], left[1], left[2]))
    return np.array(triangles, np.int64)


def _ear_quality(outline: FloatArray, left: list[int], index: int) -> float:
    """Height over base of the triangle at a corner; below 0 where it is no ear."""
    others = [left[index - 1], left[index], left[(index + 1) % len(left)]]
    a, b, c = outline[others]
    area = float(_cross(b - a, c - a))
    rest = outline[[i for i in left if i not in others]]
    is_inside = (
        (_cross(b - a, rest - a) >= 0)
        & (_cross(c - b, rest - b) >= 0)
        & (_cross(a - c, rest - c) >= 0)
    )
    longest = max(float(dot(side, side)) for side in (b - a, c - b, a - c))
    return area / longest if area > 0 and not is_inside.any() else -1.0
