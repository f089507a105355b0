"""Values as pictures: what the viewer of the page draws, in its own binary format.

Panels, beams and node cylinders are drawn as on the page, exact in every point. Meshes are
drawn face by face; values of faces, edges and vertices as pieces of faces, each of one colour.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import FloatArray, IntArray, norm, unit
from ...kernel.beams.beams import Beams
from ...kernel.beams.node_cylinders import NodeCylinders, node_cylinders
from ...kernel.meshes.mesh import Mesh, face_centroids, face_normals
from ...kernel.panels.facts import panel_radii
from ...kernel.panels.panels import Panels, panel_areas
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...kernel.spheres.incidence import normals
from ...viewer.light import sky_maps
from ...viewer.page.beams import beam_arrays, beam_points, node_arrays
from ...viewer.page.container import pack_arrays
from ...viewer.page.faces import COARSE, FINE, Faces, cover, face_arrays, panel_faces
from ...viewer.page.grid import Grid, grid_about
from ...viewer.page.sky import (
    GROUND,
    REACH,
    ground_openness,
    panel_openness,
    point_sky,
    point_spacing,
)

MANY: Final = 300
"""Panels from which on a picture is made quickly rather than for close looks."""


@dataclass(frozen=True)
class Colors:
    """Values that parts are coloured by.

    Attributes
    ----------
    name, unit : str
    values : (P,) array
        A number each; NaN for none. Whole numbers are kinds, such as moulds.
    """

    name: str
    values: NDArray[Any]
    unit: str = ""


@dataclass(frozen=True)
class Polygons:
    """Polygons that are drawn, each a part: its corners around its middle.

    Attributes
    ----------
    points : (H, 3) float array
    offsets : (P + 1,) int array
        First corner of each polygon, and H.
    middles, normals : (P, 3) float array
        A point on the surface of each, and the unit normal there.
    curvatures : (P,) float array
        A of the spheres; 0 for planes.
    """

    points: FloatArray
    offsets: IntArray
    middles: FloatArray
    normals: FloatArray
    curvatures: FloatArray


@dataclass
class Scene:
    """What is drawn together.

    Attributes
    ----------
    panels : Panels, optional
    polygons : Polygons, optional
        In place of panels.
    beams : Beams, optional
    nodes : NodeCylinders, optional
    colors : sequence of Colors
        Of panels or polygons; the first is shown.
    ids : sequence of str
        Names of panels or polygons.
    words : str
        What it is: "1,440 panels".
    edges : bool
        Whether polygons have edges of their own.
    is_ghost : bool
        Whether panels are only there to show where beams are.
    """

    panels: Panels | None = None
    polygons: Polygons | None = None
    beams: Beams | None = None
    nodes: NodeCylinders | None = None
    colors: Sequence[Colors] = ()
    ids: Sequence[str] = ()
    words: str = ""
    edges: bool = True
    is_ghost: bool = False


def packed_scene(scene: Scene) -> bytes:
    """A scene as the viewer reads it."""
    faces = [] if scene.panels is None else panel_faces(scene.panels, _tolerance(scene.panels))
    points = [side.points for side in faces]
    if scene.polygons is not None:
        points.append(np.concatenate([scene.polygons.points, scene.polygons.middles]))
    if scene.beams is not None:
        points.append(beam_points(scene.beams))
    if scene.nodes is not None and not points:
        points.append(_node_points(scene.nodes))
    grid = grid_about(*points)
    arrays: dict[str, NDArray[Any]] = {}
    if scene.panels is not None:
        arrays |= face_arrays(scene.panels, faces, grid)
    if scene.polygons is not None:
        arrays |= polygon_arrays(scene.polygons, grid)
    if scene.beams is not None:
        arrays |= beam_arrays(scene.beams, grid)
    if scene.nodes is not None:
        arrays |= node_arrays(scene.nodes, grid)
    ground = _add_light(arrays, scene, faces, points, grid)
    arrays["missing"] = np.zeros((0, 3), np.int64)
    colors: list[dict[str, str]] = []
    for number, color in enumerate(scene.colors):
        arrays[f"value_{number}"] = _stored(color.values)
        kind = "kinds" if color.values.dtype.kind in "iu" else "numbers"
        colors.append({"name": color.name, "unit": color.unit, "kind": kind})
    return pack_arrays(_head(scene, points, grid, ground, colors, len(faces) == 2), arrays)


def _tolerance(panels: Panels) -> float:
    """How far triangles may be off: where there are many panels, each is small."""
    return FINE if panels.n_panels < MANY else COARSE


def _head(
    scene: Scene, points: list[FloatArray], grid: Grid, ground: Mapping[str, Any],
    colors: list[dict[str, str]], is_solid: bool,  # noqa: FBT001
) -> dict[str, Any]:  # fmt: skip
    low = (np.min([each.min(axis=0) for each in points], axis=0) - grid.center) / grid.size
    beams, nodes = scene.beams, scene.nodes
    # Without neighbours every wall is drawn.
    degrees: list[int] = [] if scene.panels is None else scene.panels.degrees.tolist()
    alone = [[None] * degree for degree in degrees]
    return {
        "kind": "model",
        "words": scene.words,
        "solid": is_solid,
        "low": low.tolist(),
        "high": (-low).tolist(),
        "home": [0.5, -0.8, 0.5] if low[0] <= low[1] else [0.8, 0.5, 0.5],
        "size": grid.size,
        "center": grid.center.tolist(),
        "ground": ground,
        "panels": {"id": list(scene.ids), "neighbors": alone},
        "beams": {"id": list(beams.ids) if beams is not None else []},
        "beam_thickness": beams.thickness / grid.size if beams is not None else 0.0,
        "nodes": {"id": list(nodes.ids) if nodes is not None else []},
        "node_radius": nodes.radius / grid.size if nodes is not None else 0.0,
        "missing": [],
        "colors": colors,
        "edges": scene.edges,
        "ghost": scene.is_ghost,
    }


def _stored(values: NDArray[Any]) -> NDArray[Any]:
    return values.astype(np.int64 if values.dtype.kind in "iu" else np.float64)


def polygon_arrays(polygons: Polygons, grid: Grid) -> dict[str, NDArray[Any]]:
    """Arrays of a page for polygons, as `face_arrays` gives them for panels."""
    degrees = np.diff(polygons.offsets)
    kinds: dict[int, int] = {n: k for k, n in enumerate(np.unique(degrees).tolist())}
    patterns = [_fan(degree) for degree in kinds]
    first = np.arange(len(degrees)) + polygons.offsets[:-1]
    points = np.empty((len(polygons.points) + len(degrees), 3))
    is_middle = np.zeros(len(points), bool)
    is_middle[first] = True
    points[first], points[~is_middle] = polygons.middles, polygons.points
    lookup = np.zeros(max(kinds) + 1, np.int64)
    lookup[list(kinds)] = range(len(kinds))
    return {
        "degrees": degrees,
        "normals": polygons.normals,
        "curvatures": polygons.curvatures * grid.size,
        "outer_points": grid.steps(points),
        "outer_kinds": lookup[degrees],
        "outer_sizes": np.array([(degree + 1, degree) for degree in kinds], np.int64),
        "outer_triangles": np.concatenate(patterns),
        "outer_rims": np.ones(sum(kinds), np.int64),
    }


def _fan(degree: int) -> IntArray:
    rim = np.arange(degree)
    return np.stack([0 * rim, 1 + rim, 1 + (rim + 1) % degree], axis=1)


def _add_light(
    arrays: dict[str, NDArray[Any]], scene: Scene, faces: list[Faces],
    points: list[FloatArray], grid: Grid,
) -> dict[str, Any]:  # fmt: skip
    """Light of the sky on what is drawn and on the ground; where that lies."""
    seen = points[0]
    if faces:
        sky = sky_maps(seen, cover(faces[0]))
    elif scene.polygons is not None:
        sky = sky_maps(seen, _fans(scene.polygons))
    else:
        sky = point_sky(seen, point_spacing(seen))
    for name, side in zip(("outer", "inner"), faces, strict=False):
        outwards = side.normals if name == "outer" else -side.normals
        arrays[f"{name}_light"] = panel_openness(side.points, outwards, sky).astype(np.uint8)
    if scene.polygons is not None:
        polygons = scene.polygons
        light = panel_openness(polygons.middles, polygons.normals, sky)
        sizes = np.diff(polygons.offsets) + 1
        arrays["outer_light"] = np.repeat(light, sizes, axis=0).astype(np.uint8)
    arrays["ground"] = ground_openness(seen, sky).astype(np.uint8)
    low, high = seen.min(axis=0), seen.max(axis=0)
    middle = (np.array([*(low + high)[:2] / 2, low[2]]) - grid.center) / grid.size
    size = REACH * float((high - low).max()) / grid.size
    return {"points": GROUND, "size": size, "middle": middle.tolist()}


def _fans(polygons: Polygons) -> IntArray:
    """Triangles (T, 3) of polygons: their corners, then their middles."""
    owners = np.repeat(np.arange(len(polygons.middles)), np.diff(polygons.offsets))
    corners: IntArray = np.arange(len(polygons.points))
    following = corners + 1
    following[polygons.offsets[1:] - 1] = polygons.offsets[:-1]
    return np.stack([len(corners) + owners, corners, following], axis=1)


def _node_points(nodes: NodeCylinders) -> FloatArray:
    ends = nodes.origins + nodes.directions * nodes.heights[:, None]
    return np.concatenate([nodes.origins, ends])


def counted(count: int, what: str) -> str:
    """A number of things: "1 panel", "1,440 panels"."""
    return f"{count:,} {what}{'' if count == 1 else 's'}"


def panels_scene(panels: Panels) -> Scene:
    """Panels, coloured by mould and by size."""
    colors: list[Colors] = []
    moulds = np.unique(panels.labels[panels.labels >= 0])
    if len(moulds):
        colors.append(Colors("Mould", panels.labels + 1))
    colors += [
        Colors("Radius", np.asarray(panel_radii(panels).radii, float)),
        Colors("Area", panel_areas(panels)),
    ]
    words = [counted(panels.n_panels, "panel"), counted(len(moulds), "mould")]
    said = " · ".join(words if len(moulds) else words[:1])
    return Scene(panels, colors=colors, ids=panels.ids, words=said)


def beams_scene(beams: Beams, panels: Panels | None, words: str) -> Scene:
    """Beams and their node cylinders, under panels if there are any."""
    nodes = node_cylinders(beams)
    ids = () if panels is None else panels.ids
    return Scene(
        panels, beams=beams, nodes=nodes if nodes.n_nodes else None, ids=ids, words=words,
        is_ghost=True,
    )  # fmt: skip


def lines_scene(
    starts: FloatArray, ends: FloatArray, polygons: Polygons | None, words: str
) -> Scene:
    """Straight lines as thin rods, over a pale mesh if there is one."""
    lengths = norm(ends - starts)
    size = float(np.ptp(np.concatenate([starts, ends]), axis=0).max()) or 1.0
    kept = lengths > 0
    rods = NodeCylinders(
        tuple(f"{i}" for i in np.flatnonzero(kept).tolist()), np.flatnonzero(kept),
        starts[kept], unit(ends[kept] - starts[kept]), lengths[kept], (), 0.0012 * size,
    )  # fmt: skip
    count = 0 if polygons is None else len(polygons.middles)
    ids = [f"F{i}" for i in range(count)]
    return Scene(polygons=polygons, nodes=rods, ids=ids, words=words, is_ghost=True)


def mesh_polygons(mesh: Mesh, spheres: FloatArray | None = None) -> Polygons:
    """The faces of a mesh; with local rows of spheres they shine as these do."""
    middles, outwards = face_centroids(mesh), face_normals(mesh)
    curvatures = np.zeros(mesh.n_faces)
    if spheres is not None:
        outwards = unit(normals(spheres, np.zeros((mesh.n_faces, 3))))
        curvatures = spheres[:, 0]
    return Polygons(mesh.vertices[mesh.corners], mesh.offsets, middles, outwards, curvatures)


def mesh_scene(mesh: Mesh | SphereMesh, words: str, colors: Sequence[Colors] = ()) -> Scene:
    """A mesh or a sphere mesh, its faces coloured by values if there are any."""
    net = mesh.mesh if isinstance(mesh, SphereMesh) else mesh
    rows = mesh.local_spheres if isinstance(mesh, SphereMesh) else None
    ids = [f"P{i:04d}" for i in range(net.n_faces)]
    return Scene(polygons=mesh_polygons(net, rows), colors=colors, ids=ids, words=words)


def vertex_scene(mesh: Mesh, colors: Colors, words: str) -> Scene:
    """Values of vertices: each corner of a face has the colour of its vertex."""
    topology = mesh.topology
    starts, ends = (
        mesh.vertices[mesh.corners],
        mesh.vertices[mesh.corners[topology.next_corners]],
    )
    middles = (starts + ends) / 2
    before = np.empty_like(topology.next_corners)
    before[topology.next_corners] = np.arange(len(before))
    faces = topology.corner_faces
    kites = np.stack([starts, middles, face_centroids(mesh)[faces], middles[before]], axis=1)
    values = colors.values[mesh.corners]
    ids = [f"V{i}" for i in mesh.corners.tolist()]
    return _pieces(mesh, kites, Colors(colors.name, values, colors.unit), ids, words)


def edge_scene(mesh: Mesh, colors: Colors, words: str) -> Scene:
    """Values of interior edges: the triangles beside an edge have its colour."""
    topology = mesh.topology
    starts, ends = (
        mesh.vertices[mesh.corners],
        mesh.vertices[mesh.corners[topology.next_corners]],
    )
    edges = np.full(len(starts), -1)
    ids: IntArray = np.arange(len(topology.edge_corners))
    edges[topology.edge_corners] = ids
    edges[topology.twins[topology.edge_corners]] = ids
    triangles = np.stack([starts, ends, face_centroids(mesh)[topology.corner_faces]], axis=1)
    known = np.append(colors.values.astype(float), np.nan)
    names = [f"edge {i}" if i >= 0 else "boundary" for i in edges.tolist()]
    return _pieces(
        mesh, triangles, Colors(colors.name, known[edges], colors.unit), names, words
    )


def _pieces(
    mesh: Mesh, corners: FloatArray, colors: Colors, ids: Sequence[str], words: str
) -> Scene:
    """Pieces (H, n, 3) of the faces of a mesh, one for each corner."""
    count, degree = len(corners), int(corners.shape[1])
    offsets: IntArray = np.arange(count + 1) * degree
    outwards = face_normals(mesh)[mesh.topology.corner_faces]
    polygons = Polygons(
        corners.reshape(-1, 3), offsets, corners.mean(axis=1), outwards, np.zeros(count)
    )
    return Scene(polygons=polygons, colors=[colors], ids=ids, words=words, edges=False)


def row_scene(meshes: Sequence[Mesh | SphereMesh], words: str) -> Scene:
    """Several meshes in a row along x, coloured by the curvature of their spheres."""
    several = [mesh_scene(each, "").polygons for each in meshes]
    polygons = [each for each in several if each is not None]
    widths = [float(np.ptp(each.points[:, 0])) for each in polygons]
    starts = [float(each.points[:, 0].min()) for each in polygons]
    shifts = np.cumsum([0.0, *widths[:-1]]) * 1.12 - np.array(starts)
    moves = [np.array([shift, 0.0, 0.0]) for shift in shifts.tolist()]
    moved = list(zip(polygons, moves, strict=True))
    counts = np.cumsum([0, *(len(each.points) for each in polygons)]).tolist()
    offsets: IntArray = np.concatenate(
        [[0], *(each.offsets[1:] + n for each, n in zip(polygons, counts, strict=False))]
    )
    curvatures: FloatArray = np.concatenate([each.curvatures for each in polygons])
    joined = Polygons(
        np.concatenate([each.points + move for each, move in moved]),
        offsets,
        np.concatenate([each.middles + move for each, move in moved]),
        np.concatenate([each.normals for each in polygons]),
        curvatures,
    )
    ids = [
        f"{k + 1}: P{i:04d}"
        for k, each in enumerate(polygons)
        for i in range(len(each.middles))
    ]
    return Scene(
        polygons=joined,
        colors=[Colors("Curvature", 2 * curvatures)],
        ids=ids,
        words=words,
    )
