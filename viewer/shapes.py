"""Things to draw: triangles that find a surface, and the surface itself, drawn exactly."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ..kernel.arrays import FloatArray, IntArray, dot, norm, unit
from ..kernel.beams.beams import Beams
from ..kernel.beams.node_cylinders import NodeCylinders
from ..kernel.beams.triangles import BeamTriangles, beam_triangles, cylinder_triangles
from ..kernel.errors import InputError
from ..kernel.meshes.mesh import Mesh, face_normals
from ..kernel.panels.panels import Panels
from ..kernel.panels.tessellation import surface_rows, tessellate
from ..kernel.parts.colors import AXIS_COLOR, BEAM_COLOR, NODE_COLOR
from ..kernel.spheres.rows import center_radius

Finish = Literal["polish", "matt", "ink"]
"""What mirrors stripes and lamps, what does not, and what has its colour in any light."""

INK = (52, 56, 62)

SPHERE_STEPS = 24
"""Parts of a quarter of a sphere's equator: off by a thousandth of the radius."""


@dataclass(frozen=True)
class Joints:
    """Lines along the edges of surfaces.

    Attributes
    ----------
    first, degrees : (S,) int array
        First edge of each surface, and how many it has.
    edges : (H, 8) float array
        The cutting plane ``n, -d``, and the function (direction, constant) that runs along the
        edge from -1 to 1; local to the surface.
    length : float
        Mean length of an edge.
    """

    first: IntArray
    degrees: IntArray
    edges: FloatArray
    length: float


@dataclass(frozen=True)
class Shape:
    """A thing to draw, of S surfaces.

    Attributes
    ----------
    origin : (3,) float array
        Origin of all coordinates, in model coordinates.
    points, normals : (N, 3) float array
        Points of the triangles and unit normals there.
    triangles : (T, 3) int array
        Counter-clockwise about the normals.
    surfaces : (T,) int array
        Surface of each triangle.
    rows : (S, 5) float array
        Spheres and planes, seen from `centers`. Zero rows are neither: their normals are those
        of the points, interpolated.
    centers : (S, 3) float array
        What the rows are local to.
    colors : (S, 3) float array
        sRGB, from 0 to 255.
    finish : str
        See `Finish`.
    is_closed : bool
        Whether the backs of the triangles are never seen.
    is_veil : bool
        Whether one sees through, as through a cloth.
    joints : Joints, optional
        Lines along edges.
    """

    origin: FloatArray
    points: FloatArray
    normals: FloatArray
    triangles: IntArray
    surfaces: IntArray
    rows: FloatArray
    centers: FloatArray
    colors: FloatArray
    finish: Finish = "matt"
    is_closed: bool = False
    is_veil: bool = False
    joints: Joints | None = field(default=None)


def panel_shape(
    panels: Panels,
    colors: FloatArray,
    tolerance: FloatArray | float = 0.002,
    *,
    solid: bool = True,
    edges: bool = True,
) -> Shape:
    """Panels, each in its colour (P, 3), with lines along their edges or without.

    The tolerance is that of `tessellate`, of all panels or of each. Raises InputError if there
    are none.
    """
    if panels.n_panels == 0:
        raise InputError("there are no panels to draw")
    solid = solid and panels.thickness > 0
    skin = tessellate(panels, tolerance, solid=solid)
    owners = np.concatenate([np.arange(panels.n_panels)] * 2 + [panels.corner_panels])
    rows = surface_rows(panels)
    count = len(rows) if solid else panels.n_panels
    return Shape(
        skin.origin, skin.points, skin.normals, skin.triangles, skin.surfaces, rows[:count],
        (panels.origins - skin.origin)[owners[:count]], colors[owners[:count]], "polish", solid,
        joints=_panel_joints(panels, count) if edges else None,
    )  # fmt: skip


def _panel_joints(panels: Panels, count: int) -> Joints:
    ends = panels.corners[panels.next_corners]
    half = (ends - panels.corners) / 2
    along = half / dot(half, half)[:, None]
    middle = dot(along, (ends + panels.corners) / 2)
    columns = (panels.plane_normals, -panels.plane_offsets[:, None], along, -middle[:, None])
    walls = np.zeros(count, np.int64)
    first, degrees = walls.copy(), walls
    for side in range(2 if count > panels.n_panels else 1):
        part = slice(side * panels.n_panels, (side + 1) * panels.n_panels)
        first[part], degrees[part] = panels.offsets[:-1], panels.degrees
    return Joints(first, degrees, np.concatenate(columns, axis=1), float(2 * norm(half).mean()))


def beam_shapes(
    beams: Beams, color: ArrayLike = BEAM_COLOR, tolerance: float = 0.002
) -> list[Shape]:
    """Beams as they are before their ends are mitred, sides and ends plane."""
    return [_flat_shape(part, color) for part in beam_triangles(beams, tolerance)]


def node_shape(nodes: NodeCylinders, color: ArrayLike = NODE_COLOR) -> Shape:
    """Node cylinders."""
    drums = cylinder_triangles(
        nodes.origins, nodes.directions, nodes.heights, nodes.radius, 0.03
    )
    return _flat_shape(drums, color)


def sphere_shape(rows: ArrayLike, color: ArrayLike, *, is_veil: bool = False) -> Shape:
    """Whole spheres (n, 5), exact, each in its colour (3,) or (n, 3); planes are left out."""
    found = np.atleast_2d(np.asarray(rows, float))
    is_round = np.abs(found[:, 0]) > 0
    centers, radii = center_radius(found[is_round])
    if not len(radii):
        raise InputError("there are no spheres to draw: planes have no outline")
    unit_points, triangles = _unit_sphere(SPHERE_STEPS)
    radii = np.abs(radii)
    origin = centers.mean(axis=0)
    local = centers - origin
    count, size = len(radii), len(unit_points)
    # As rows about their own centres, which costs no digits: B = 0, N outwards.
    about = np.zeros((count, 5))
    about[:, 0], about[:, 4] = -0.5 / radii, radii / 2
    ids: IntArray = np.arange(count)
    colors = np.broadcast_to(np.asarray(color, float), (len(found), 3))[is_round]
    return Shape(
        origin,
        (local[:, None] + radii[:, None, None] * unit_points).reshape(-1, 3),
        np.tile(unit_points, (count, 1)),
        (triangles + size * ids[:, None, None]).reshape(-1, 3),
        np.repeat(ids, len(triangles)),
        about, local, colors, is_closed=not is_veil, is_veil=is_veil,
    )  # fmt: skip


def mesh_shape(
    mesh: Mesh, color: ArrayLike, *, smooth: bool = False, is_veil: bool = False
) -> Shape:
    """Faces of a mesh, flat each in itself or with normals that run from face to face.

    Faces are cut into triangles about their middles; one colour, or one for each (F, 3).
    """
    owners = mesh.topology.corner_faces
    middles = mesh.vertices[mesh.corners]
    counts = np.bincount(owners, minlength=mesh.n_faces)[:, None]
    origin = mesh.vertices.mean(axis=0)
    points = mesh.vertices - origin
    centers = np.zeros((mesh.n_faces, 3))
    np.add.at(centers, owners, middles - origin)
    centers /= np.maximum(counts, 1)
    flat = face_normals(mesh)
    at_vertices = np.zeros_like(points)
    np.add.at(at_vertices, mesh.corners, flat[owners])
    following = mesh.corners[mesh.topology.next_corners]
    triangles = np.stack([mesh.corners, following, mesh.n_vertices + owners], axis=1)
    rows = np.zeros((mesh.n_faces, 5))
    if not smooth:
        rows[:, 1:4] = flat
    colors = np.broadcast_to(np.asarray(color, float), (mesh.n_faces, 3))
    return Shape(
        origin, np.concatenate([points, centers]), unit(np.concatenate([at_vertices, flat])),
        triangles, owners, rows, centers, colors, is_veil=is_veil,
    )  # fmt: skip


def line_shape(
    starts: ArrayLike, ends: ArrayLike, radius: float, color: ArrayLike = INK
) -> Shape:
    """Straight rods from starts to ends (n, 3): axes, edges, pieces of circles."""
    first, last = np.asarray(starts, float), np.asarray(ends, float)
    lengths = norm(last - first)
    keep = lengths > 0
    if not keep.any():
        raise InputError("there are no lines to draw: each ends where it starts")
    rods = cylinder_triangles(
        first[keep], unit(last - first)[keep], lengths[keep], radius, 0.08
    )
    return replace(_flat_shape(rods, color), finish="ink")


def circle_shape(
    centers: ArrayLike,
    axes: ArrayLike,
    radii: ArrayLike,
    thickness: float,
    color: ArrayLike = INK,
) -> Shape:
    """Whole circles about axes (n, 3), as thin rods of a radius of half the thickness."""
    middle, up = (np.atleast_2d(np.asarray(each, float)) for each in (centers, axes))
    up = unit(up)
    other = np.eye(3)[np.argmin(np.abs(up), axis=1)]
    x = unit(np.cross(other, up))[:, None]
    y = np.cross(up, x[:, 0])[:, None]
    angles = np.linspace(0, 2 * np.pi, 97)[:, None]
    size = np.broadcast_to(np.asarray(radii, float), len(middle))[:, None, None]
    points = middle[:, None] + size * (np.cos(angles) * x + np.sin(angles) * y)
    return line_shape(
        points[:, :-1].reshape(-1, 3), points[:, 1:].reshape(-1, 3), thickness / 2, color
    )


def edge_shape(mesh: Mesh, radius: float, color: ArrayLike = INK) -> Shape:
    """The edges of a mesh as rods."""
    twins = mesh.topology.twins
    chosen = np.flatnonzero(twins < np.arange(len(twins)))
    starts, ends = mesh.corners[chosen], mesh.corners[mesh.topology.next_corners[chosen]]
    return line_shape(mesh.vertices[starts], mesh.vertices[ends], radius, color)


def axis_shape(axes: ArrayLike, radius: float, color: ArrayLike = AXIS_COLOR) -> Shape:
    """Node axes (n, 2, 3), two points each; those that have no direction are left out."""
    points = np.asarray(axes, float)
    return line_shape(points[:, 0], points[:, 1], radius, color)


def _flat_shape(part: BeamTriangles, color: ArrayLike) -> Shape:
    """Closed things with normals of their own; each side of a thing is told from the next."""
    count, size = part.points.shape[:2]
    ids: IntArray = np.arange(int(count))
    origin = part.points.reshape(-1, 3).mean(axis=0)
    triangles: IntArray = (part.triangles + int(size) * ids[:, None, None]).reshape(-1, 3)
    return Shape(
        origin, part.points.reshape(-1, 3) - origin, part.normals.reshape(-1, 3), triangles,
        np.repeat(ids, len(part.triangles)), np.zeros((int(count), 5)),
        np.zeros((int(count), 3)),
        np.broadcast_to(np.asarray(color, float), (int(count), 3)), is_closed=True,
    )  # fmt: skip


def _unit_sphere(steps: int) -> tuple[FloatArray, IntArray]:
    """Points and triangles of a cube of `steps` along each side, blown up to a sphere."""
    side = np.tan(np.linspace(-np.pi / 4, np.pi / 4, steps + 1))
    u, v = np.meshgrid(side, side, indexing="ij")
    flat = np.stack([u.ravel(), v.ravel(), np.ones(u.size)], axis=1)
    row: IntArray = np.arange(steps)
    corner = (row[:, None] * (steps + 1) + row).ravel()
    quads = np.stack([corner, corner + steps + 1, corner + steps + 2, corner + 1], axis=1)
    both = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    turns: Sequence[tuple[int, int, int, int]] = (
        (0, 1, 2, 1), (1, 2, 0, 1), (2, 0, 1, 1), (0, 1, 2, -1), (1, 2, 0, -1), (2, 0, 1, -1),
    )  # fmt: skip
    points: list[FloatArray] = []
    triangles: list[IntArray] = []
    for place, (i, j, k, sign) in enumerate(turns):
        turned = np.empty_like(flat)
        # A half turn about the first axis of the side keeps its orientation.
        turned[:, i], turned[:, j], turned[:, k] = (
            flat[:, 0],
            sign * flat[:, 1],
            sign * flat[:, 2],
        )
        points.append(turned)
        triangles.append(both + place * len(flat))
    return unit(np.concatenate(points)), np.concatenate(triangles)
