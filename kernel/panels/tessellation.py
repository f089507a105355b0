"""Triangles for pictures and viewers: points and normals exact, only the faces between flat.

A panel is triangulated as a fan about its middle, in the stereographic chart of its sphere: the
chart keeps circles, so its outline stays as simple as the panel. Rings of points divide the
fan; the outermost ring lies on the arcs of the edges, with as many points as the finer of two
neighbours needs where they have the edge in common.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm, unit
from ..errors import InputError
from ..spheres.arcs import Arcs, arc_points
from ..spheres.incidence import normals, project
from .fans import are_stars, cut_ears, cut_fan
from .panels import Panels, boundaries, panel_arcs
from .rims import Rims, divide_edges

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
    steps : (H,) int array
        Steps along each edge of the panels. The last points of each face lie along its edges,
        so many on each.
    """

    origin: FloatArray
    points: FloatArray
    normals: FloatArray
    triangles: IntArray
    panels: IntArray
    surfaces: IntArray
    steps: IntArray


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
        Points of a panel agree to the bit where its faces and walls meet, and those of
        neighbours where their edges are the same (within `SAME_EDGE`); elsewhere there is the
        gap that there is between them (see `edge_gaps`).

    Raises
    ------
    InputError
        If the tolerance is not positive.

    Notes
    -----
    Works on all panels of one degree and the same steps at a time. Panels that cannot be
    seen whole from their middle are cut into ears along their outline, without inner points.
    """
    if not np.min(tolerance, initial=np.inf) > 0:
        raise InputError(f"the tolerance must be positive, not {tolerance}")
    sides = boundaries(panels) if solid else [(panels.spheres, panel_arcs(panels))]
    steps = _steps(panels, sides[0][1], tolerance)
    origin = panels.origins.mean(axis=0) if panels.n_panels else np.zeros(3)
    shifts = panels.origins - origin
    rims = divide_edges(panels, [arcs for _, arcs in sides], steps, shifts)
    pieces: list[_Piece] = []
    for members, edges, fan in _kinds(panels, steps, rims.steps):
        for side, (rows, arcs) in enumerate(sides):
            rim = _rim_points(rims, side, edges)
            faces = _face_pieces(rows[members], arcs, edges, rim, members, shifts, fan)
            pieces += faces if side == 0 else [_inside_out(piece, panels) for piece in faces]
    if len(sides) == 2:
        pieces += _wall_pieces(panels, rims)
    return _join(origin, pieces, rims.steps)


@dataclass(frozen=True)
class _Piece:
    """Points (n, m, 3), normals, triangles (t, 3) of n alike pieces, (n,) panels, surfaces.

    Points are seen from the common origin.
    """

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


@dataclass(frozen=True)
class _Fan:
    """How a face is divided: steps from its middle to the rim, and along each edge."""

    steps: int
    edges: tuple[int, ...]


def _kinds(
    panels: Panels, steps: IntArray, edge_steps: IntArray
) -> Iterator[tuple[IntArray, IntArray, _Fan]]:
    """Panels that are divided alike, their edges (n, k), and how they are divided."""
    for degree in np.unique(panels.degrees).tolist():
        members = np.flatnonzero(panels.degrees == degree)
        edges = panels.offsets[members][:, None] + np.arange(int(degree))
        keys = np.column_stack([steps[members], edge_steps[edges]])
        kinds, which = np.unique(keys, axis=0, return_inverse=True)
        for kind, (count, *along) in enumerate(kinds.tolist()):
            chosen = which.ravel() == kind
            yield members[chosen], edges[chosen], _Fan(count, tuple(along))


def _ring_points(arcs: Arcs, edges: IntArray, steps: int) -> FloatArray:
    """Points (n, k steps, 3) of the arcs of n panels, in as many steps each."""
    ids = edges.ravel()
    chosen = Arcs(arcs.starts[ids], arcs.ends[ids], arcs.rises[ids], arcs.sagittas[ids])
    points = arc_points(chosen, np.linspace(-1, 1, steps, endpoint=False))
    return points.reshape(len(edges), -1, 3)


def _rim_points(rims: Rims, side: int, edges: IntArray) -> FloatArray:
    """Points (n, m, 3) around panels that are divided alike."""
    count = int(rims.steps[edges[0]].sum())
    return rims.sides[side][rims.starts[edges[:, :1]] + np.arange(count)]


def _face_pieces(
    rows: FloatArray,
    arcs: Arcs,
    edges: IntArray,
    rim: FloatArray,
    panels: IntArray,
    shifts: FloatArray,
    fan: _Fan,
) -> list[_Piece]:
    """A fan for the panels that can be seen whole from their middle, ears for the others."""
    moved = shifts[panels][:, None]
    chart = _Chart.about(rows, (rim - moved).mean(axis=1))
    outline = chart.flatten(rim - moved)
    is_star = are_stars(outline)
    pieces: list[_Piece] = []
    if is_star.any():
        star = chart.select(is_star)
        rings = [star.middle[:, None]]
        for ring in range(1, fan.steps):
            inner = star.flatten(_ring_points(arcs, edges[is_star], ring))
            rings.append(star.lift(inner * (ring / fan.steps)))
        inside = np.concatenate(rings, axis=1) + moved[is_star]
        points = np.concatenate([inside, rim[is_star]], axis=1)
        triangles = cut_fan(fan.steps, fan.edges)
        pieces.append(_piece(rows[is_star], points, triangles, panels[is_star], moved[is_star]))
    for panel in np.flatnonzero(~is_star):
        one = slice(panel, panel + 1)
        triangles = cut_ears(outline[panel])
        pieces.append(_piece(rows[one], rim[one], triangles, panels[one], moved[one]))
    return pieces


def _piece(
    rows: FloatArray,
    points: FloatArray,
    triangles: IntArray,
    panels: IntArray,
    moved: FloatArray,
) -> _Piece:
    return _Piece(points, normals(rows[:, None], points - moved), triangles, panels, panels)


def _inside_out(piece: _Piece, panels: Panels) -> _Piece:
    """An inner face, which looks out of its panel against N."""
    surfaces = piece.surfaces + panels.n_panels
    turned = piece.triangles[:, ::-1]
    return _Piece(piece.points, -piece.normals, turned, piece.panels, surfaces)


def _wall_pieces(panels: Panels, rims: Rims) -> list[_Piece]:
    """Strips between the outer and the inner arc of each edge."""
    owners, ends = panels.corner_panels, rims.starts[panels.next_corners]
    pieces: list[_Piece] = []
    for steps in np.unique(rims.steps).tolist():
        edges = np.flatnonzero(rims.steps == steps)
        along = rims.starts[edges][:, None] + np.arange(int(steps))
        ids = np.concatenate([along, ends[edges][:, None]], axis=1)
        points = np.concatenate([side[ids] for side in rims.sides], axis=1)
        low: IntArray = np.arange(int(steps))
        high = low + steps + 1
        strip = (low, high, low + 1), (low + 1, high, high + 1)
        triangles = np.concatenate([np.stack(corners, 1) for corners in strip])
        outwards = np.broadcast_to(-panels.plane_normals[edges][:, None], points.shape)
        surfaces = 2 * panels.n_panels + edges
        pieces.append(_Piece(points, outwards, triangles, owners[edges], surfaces))
    return pieces


def _join(origin: FloatArray, pieces: list[_Piece], steps: IntArray) -> PanelTriangles:
    points = [piece.points.reshape(-1, 3) for piece in pieces]
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
        steps,
    )


def _numbered(piece: _Piece) -> IntArray:
    """Triangles (n, t, 3) of all pieces, their points counted through."""
    n, m = int(piece.points.shape[0]), int(piece.points.shape[1])
    starts: IntArray = m * np.arange(n)
    return starts[:, None, None] + piece.triangles


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
