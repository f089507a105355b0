"""
Panels: pieces of spheres cut out by planes, exact each in itself.

A panel is its sphere, one cutting plane per edge, and the corners where the sphere meets two
consecutive planes. Neighbours share their cutting plane; their two arcs in it may differ by a
gap, which is measured here. All geometry is local to the panel (its origin is the centroid of
the mesh face), so the site's coordinates cost no digits.
"""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from .arcs import Arcs, arc_points, patch_areas, sphere_arcs
from .arrays import BoolArray, FloatArray, IntArray, dot, norm, unit
from .errors import InputError
from .mesh import face_centroids, local_corners, mean_edge_length
from .sphere_mesh import SphereMesh
from .spheres import angle, evaluate, normals, offset, recenter, rescale
from .tolerances import CAP_ANGLE, CROSSING, PARALLEL_PLANES, PLANE_SAGITTA, SAME_PLANE

EdgeMode = Literal["bisector", "intersection"]


@dataclass(frozen=True)
class Panels:
    """
    Panels that can be made, in the order of their faces.

    Attributes
    ----------
    ids : tuple of str
        Stable names ``P0000``, one per panel.
    face_ids : (P,) int array
        Face of the sphere mesh.
    labels : (P,) int array
        Mould of each panel, from 0; -1 where panels were not clustered.
    origins : (P, 3) float array
        Origin of the coordinates local to each panel, in model coordinates.
    spheres : (P, 5) float array
        Unit rows of the outer faces, local; N points outwards.
    inner_spheres : (P, 5) float array
        Unit rows of the inner faces, local, oriented as the outer ones.
    offsets : (P + 1,) int array
        First corner of each panel, and H. Corners run counter-clockwise about N.
    plane_normals : (H, 3) float array
        Unit normal of the cutting plane of the edge from corner h to the next; points into
        the panel.
    plane_offsets : (H,) float array
        Offset d of each cutting plane ``n·x = d``, local.
    corners : (H, 3) float array
        Corners of the outer faces, local.
    inner_corners : (H, 3) float array
        Corners of the inner faces, local; equal to `corners` without thickness.
    neighbors : (H,) int array
        Face beyond each edge; -1 on the boundary.
    thickness : float
        Distance of the inner from the outer faces, in model units; 0 for surfaces.
    joint_gap : float
        Width of the joint between neighbouring panels, in model units.
    """

    ids: tuple[str, ...]
    face_ids: IntArray
    labels: IntArray
    origins: FloatArray
    spheres: FloatArray
    inner_spheres: FloatArray
    offsets: IntArray
    plane_normals: FloatArray
    plane_offsets: FloatArray
    corners: FloatArray
    inner_corners: FloatArray
    neighbors: IntArray
    thickness: float
    joint_gap: float

    @property
    def n_panels(self) -> int:
        """
        Number of panels.

        Returns
        -------
        int
            P.
        """
        return len(self.face_ids)

    @property
    def degrees(self) -> IntArray:
        """
        Number of corners of each panel, (P,).

        Returns
        -------
        (P,) int array
            Number of corners of each panel, (P,).
        """
        return np.diff(self.offsets)

    @property
    def corner_panels(self) -> IntArray:
        """
        Panel of each corner, (H,).

        Returns
        -------
        (H,) int array
            Panel of each corner, (H,).
        """
        return np.repeat(np.arange(self.n_panels), self.degrees)

    @property
    def next_corners(self) -> IntArray:
        """
        Following corner in the same panel, (H,).

        Returns
        -------
        (H,) int array
            Following corner in the same panel, (H,).
        """
        return _following(self.offsets)


@dataclass(frozen=True)
class RejectedPanel:
    """
    A panel that cannot be made.

    Attributes
    ----------
    id : str
        Name of the panel.
    face_id : int
        Its face.
    reason : str
        What is wrong, for a person.
    """

    id: str
    face_id: int
    reason: str


def _following(offsets: IntArray) -> IntArray:
    following = np.arange(1, int(offsets[-1]) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    return following


def flatten_nearly_plane(sphere_mesh: SphereMesh) -> SphereMesh:
    """
    Replace spheres that bulge less than a workshop can tell by planes.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.

    Returns
    -------
    SphereMesh
        The same, with A = 0 where the bulge ``L² / 8r`` of a face of size L is below
        `PLANE_SAGITTA` L. To be applied before cutting, so that neighbours agree.
    """
    mesh = sphere_mesh.mesh
    corners = local_corners(mesh)
    size = 2 * np.maximum.reduceat(norm(corners), mesh.offsets[:-1])
    rows = sphere_mesh.local_spheres.copy()
    is_flat = size * np.abs(rows[:, 0]) / 4 < PLANE_SAGITTA
    direction = unit(rows[:, 1:4])
    # The corners of a face average to the local origin: the plane through it is the mean one,
    # shifted by the sphere's own mean miss.
    heights = np.add.reduceat(
        evaluate(rows[mesh.topology.corner_faces], corners), mesh.offsets[:-1]
    )
    flat = np.zeros_like(rows)
    flat[:, 1:4] = direction
    flat[:, 4] = heights / mesh.degrees
    rows[is_flat] = flat[is_flat]
    return SphereMesh.from_local(mesh, rows)


def cutting_planes(sphere_mesh: SphereMesh, edges: EdgeMode) -> tuple[FloatArray, FloatArray]:
    """
    Plane that cuts each panel along each of its edges.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.
    edges : {"bisector", "intersection"}
        ``bisector``: the plane through the two vertices that bisects the two spheres' normals.
        ``intersection``: the plane of the circle in which the two spheres meet; where they
        are the same sphere or one is a plane, the bisecting one. Boundary edges are cut by the
        plane through their vertices and the normal of their sphere.

    Returns
    -------
    plane_normals : (H, 3) float array
        Unit normals that point into the face of their corner; zero where two faces fold back
        onto each other, which no plane bisects.
    plane_offsets : (H,) float array
        Offsets of ``n·x = d`` in the coordinates local to the face.

    References
    ----------
    Meshes with Spherical Faces, Fig. 26 (a) and (d).
    """
    mesh, topology = sphere_mesh.mesh, sphere_mesh.mesh.topology
    faces, twins = topology.corner_faces, topology.twins
    starts = local_corners(mesh)
    ends = starts[topology.next_corners]
    middles = (starts + ends) / 2
    rows = recenter(sphere_mesh.local_spheres[faces], middles)
    upright = unit(rows[:, 1:4])
    other = rows[twins]
    is_interior = twins >= 0
    upright = np.where(is_interior[:, None], upright + upright[twins], upright)
    # No plane bisects two faces that fold back onto each other.
    upright[norm(upright) < SAME_PLANE] = 0
    plane_normals = unit(np.cross(upright, ends - starts))
    plane_offsets = dot(plane_normals, middles)
    if edges == "intersection":
        radical = other[:, :1] * rows[:, 1:4] - rows[:, :1] * other[:, 1:4]
        constant = other[:, 0] * rows[:, 4] - rows[:, 0] * other[:, 4]
        length = norm(radical)
        scale = np.abs(rows[:, 0]) + np.abs(other[:, 0])
        # A plane meets a sphere in its own plane, which cannot cut it.
        curved = (rows[:, 0] != 0) & (other[:, 0] != 0)
        distinct = (length > SAME_PLANE * scale) & (angle(rows, other) > SAME_PLANE)
        use = is_interior & curved & distinct
        use &= upright.any(axis=1)
        side = np.where(dot(radical, plane_normals) < 0, -1.0, 1.0)
        divisor = np.where(use, side * length, 1.0)
        radical, constant = radical / divisor[:, None], constant / divisor
        plane_normals = np.where(use[:, None], radical, plane_normals)
        plane_offsets = np.where(use, constant + dot(radical, middles), plane_offsets)
    return plane_normals, plane_offsets


def corner_points(
    rows: FloatArray,
    plane_normals: FloatArray,
    plane_offsets: FloatArray,
    offsets: IntArray,
    references: FloatArray,
) -> tuple[FloatArray, BoolArray]:
    """
    Points in which spheres meet two consecutive cutting planes, nearest to references.

    Parameters
    ----------
    rows : (H, 5) float array
        Unit row of the panel of each corner, local.
    plane_normals, plane_offsets : (H, 3), (H,) float array
        Cutting planes of the edges that leave the corners.
    offsets : (P + 1,) int array
        First corner of each panel.
    references : (H, 3) float array
        Points near the corners.

    Returns
    -------
    points : (H, 3) float array
        Corners; the reference where there is none.
    exists : (H,) bool array
        Whether the line of the planes meets the sphere.

    Notes
    -----
    Where the two planes are parallel (edges in line), the corner is sought along N in the
    plane of the edge that leaves it.
    """
    previous = np.empty(len(rows), np.int64)
    previous[_following(offsets)] = np.arange(len(rows))
    leaving, entering = plane_normals, plane_normals[previous]
    level_leaving = plane_offsets - dot(leaving, references)
    level_entering = plane_offsets[previous] - dot(entering, references)
    near = recenter(rows, references)
    direction = np.cross(entering, leaving)
    square = dot(direction, direction)
    is_parallel = square < PARALLEL_PLANES**2
    weight = np.where(is_parallel, 1.0, square)[:, None]
    foot = (
        level_entering[:, None] * np.cross(leaving, direction)
        + level_leaving[:, None] * np.cross(direction, entering)
    ) / weight
    foot = np.where(is_parallel[:, None], level_leaving[:, None] * leaving, foot)
    upright = near[:, 1:4] - dot(near[:, 1:4], leaving)[:, None] * leaving
    direction = unit(np.where(is_parallel[:, None], upright, direction))
    step, exists = _small_root(near, foot, direction)
    points = references + foot + step[:, None] * direction
    return np.where(exists[:, None], points, references), exists


def _small_root(
    rows: FloatArray, points: FloatArray, directions: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Parameter of least magnitude at which lines meet spheres, without cancellation."""
    slope = dot(normals(rows, points), directions)
    value = evaluate(rows, points)
    discriminant = slope**2 - 4 * rows[:, 0] * value
    exists = discriminant >= 0
    denominator = slope + np.copysign(np.sqrt(np.maximum(discriminant, 0)), slope)
    exists &= (denominator != 0) | (value == 0)
    root = np.divide(2 * value, denominator, out=np.zeros_like(slope), where=denominator != 0)
    return root, exists


def edge_gaps(sphere_mesh: SphereMesh, edges: EdgeMode) -> FloatArray:
    """
    Largest distance between the two arcs of each interior edge.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.
    edges : {"bisector", "intersection"}
        How panels are cut, see `cutting_planes`.

    Returns
    -------
    (E,) float array
        Gaps at the ends and in the middle of the edges, the larger of them, in model units.

    References
    ----------
    Meshes with Spherical Faces, Fig. 26 (d).
    """
    mesh, topology = sphere_mesh.mesh, sphere_mesh.mesh.topology
    rows = sphere_mesh.local_spheres[topology.corner_faces]
    plane_normals, plane_offsets = cutting_planes(sphere_mesh, edges)
    starts = local_corners(mesh)
    ends = starts[topology.next_corners]
    points, _ = corner_points(rows, plane_normals, plane_offsets, mesh.offsets, starts)
    shifts = points - starts
    middles = (starts + ends) / 2
    rises = unit(np.cross(ends - starts, plane_normals))
    feet = middles + (plane_offsets - dot(plane_normals, middles))[:, None] * plane_normals
    heights, _ = _small_root(rows, feet, rises)

    first, second = topology.edge_corners, topology.twins[topology.edge_corners]
    following = topology.next_corners
    middle_gap = np.abs(heights[first] - heights[second])
    start_gap = norm(shifts[first] - shifts[following[second]])
    end_gap = norm(shifts[following[first]] - shifts[second])
    return np.maximum(middle_gap, np.maximum(start_gap, end_gap))


def cut_panels(
    sphere_mesh: SphereMesh,
    edges: EdgeMode = "bisector",
    thickness: float = 0.0,
    joint_gap: float = 0.0,
    labels: IntArray | None = None,
) -> tuple[Panels, tuple[RejectedPanel, ...]]:
    """
    Cut a panel out of the sphere of every face.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.
    edges : {"bisector", "intersection"}
        How panels are cut, see `cutting_planes`.
    thickness : float
        Distance of the inner from the outer face, against N, in model units.
    joint_gap : float
        Width of the joint between neighbours, in model units; every cutting plane, those of
        the boundary included, moves into the panel by half of it.
    labels : (F,) int array, optional
        Mould of each face.

    Returns
    -------
    panels : Panels
        The panels that can be made.
    rejected : tuple of RejectedPanel
        All others, each with its reason.

    Raises
    ------
    InputError
        If thickness or gap is negative or not finite, or the thickness reaches the centre of
        a sphere.
    """
    _check_lengths(thickness, joint_gap)
    sphere_mesh = flatten_nearly_plane(sphere_mesh)
    mesh, topology = sphere_mesh.mesh, sphere_mesh.mesh.topology
    rows = sphere_mesh.local_spheres
    inner_rows = _inner_spheres(rows, thickness, panel_ids(mesh.n_faces))
    plane_normals, plane_offsets = cutting_planes(sphere_mesh, edges)
    plane_offsets = plane_offsets + joint_gap / 2
    faces = topology.corner_faces
    references = local_corners(mesh)
    corners, exists = corner_points(
        rows[faces], plane_normals, plane_offsets, mesh.offsets, references
    )
    inner_corners, inner_exists = corner_points(
        inner_rows[faces], plane_normals, plane_offsets, mesh.offsets, corners
    )
    beyond = np.append(faces, -1)[topology.twins]
    panels = Panels(
        panel_ids(mesh.n_faces), np.arange(mesh.n_faces),
        np.full(mesh.n_faces, -1) if labels is None else np.asarray(labels, np.int64),
        face_centroids(mesh), rows, inner_rows, mesh.offsets, plane_normals, plane_offsets,
        corners, inner_corners, beyond, float(thickness), float(joint_gap),
    )  # fmt: skip
    reasons = _reasons(panels, references, exists, inner_exists)
    rejected = tuple(
        RejectedPanel(panels.ids[face], face, reason)
        for face, reason in sorted(reasons.items())
    )
    keep = np.ones(mesh.n_faces, bool)
    keep[list(reasons)] = False
    return select_panels(panels, keep), rejected


def panel_ids(n_faces: int) -> tuple[str, ...]:
    """
    Stable names of the panels of a mesh.

    Parameters
    ----------
    n_faces : int
        Number of faces.

    Returns
    -------
    tuple of str
        ``P0000``, ``P0001``, ... with as many digits as the last needs, at least four.
    """
    width = max(4, len(str(n_faces - 1)))
    return tuple(f"P{face:0{width}d}" for face in range(n_faces))


def select_panels(panels: Panels, keep: BoolArray) -> Panels:
    """
    Some of the panels.

    Parameters
    ----------
    panels : Panels
        P panels.
    keep : (P,) bool array
        Which ones.

    Returns
    -------
    Panels
        The chosen panels, in the same order.
    """
    if keep.all():
        return panels
    chosen = np.flatnonzero(keep)
    corner_keep = keep[panels.corner_panels]
    return replace(
        panels,
        ids=tuple(panels.ids[i] for i in chosen),
        face_ids=panels.face_ids[chosen],
        labels=panels.labels[chosen],
        origins=panels.origins[chosen],
        spheres=panels.spheres[chosen],
        inner_spheres=panels.inner_spheres[chosen],
        offsets=np.concatenate([[0], np.cumsum(panels.degrees[chosen])]),
        plane_normals=panels.plane_normals[corner_keep],
        plane_offsets=panels.plane_offsets[corner_keep],
        corners=panels.corners[corner_keep],
        inner_corners=panels.inner_corners[corner_keep],
        neighbors=panels.neighbors[corner_keep],
    )


def scale_panels(panels: Panels, factor: float) -> Panels:
    """
    Panels in another unit of length.

    Parameters
    ----------
    panels : Panels
        P panels.
    factor : float
        Positive number of new units in an old one.

    Returns
    -------
    Panels
        The same panels; every length is multiplied by the factor.
    """
    return replace(
        panels,
        origins=panels.origins * factor,
        spheres=rescale(panels.spheres, factor),
        inner_spheres=rescale(panels.inner_spheres, factor),
        plane_offsets=panels.plane_offsets * factor,
        corners=panels.corners * factor,
        inner_corners=panels.inner_corners * factor,
        thickness=panels.thickness * factor,
        joint_gap=panels.joint_gap * factor,
    )


def move_origins(panels: Panels, origins: FloatArray) -> Panels:
    """
    The same panels in coordinates local to other points.

    Parameters
    ----------
    panels : Panels
        P panels.
    origins : (P, 3) float array
        New origins, in model coordinates, near the old ones.

    Returns
    -------
    Panels
        Panels at the same place.
    """
    shifts = origins - panels.origins
    corner_shifts = shifts[panels.corner_panels]
    return replace(
        panels,
        origins=origins,
        spheres=recenter(panels.spheres, shifts),
        inner_spheres=recenter(panels.inner_spheres, shifts),
        plane_offsets=panels.plane_offsets - dot(panels.plane_normals, corner_shifts),
        corners=panels.corners - corner_shifts,
        inner_corners=panels.inner_corners - corner_shifts,
    )


def panel_arcs(panels: Panels) -> Arcs:
    """
    Edges of the outer faces, in local coordinates.

    Parameters
    ----------
    panels : Panels
        P panels with H corners.

    Returns
    -------
    Arcs
        H arcs, arc h from corner h to the next.
    """
    return _layer_arcs(panels, panels.spheres, panels.corners)


def inner_panel_arcs(panels: Panels) -> Arcs:
    """
    Edges of the inner faces, in local coordinates.

    Parameters
    ----------
    panels : Panels
        P panels with H corners.

    Returns
    -------
    Arcs
        H arcs, arc h from inner corner h to the next.
    """
    return _layer_arcs(panels, panels.inner_spheres, panels.inner_corners)


def _layer_arcs(panels: Panels, rows: FloatArray, corners: FloatArray) -> Arcs:
    ends = corners[panels.next_corners]
    return sphere_arcs(rows[panels.corner_panels], panels.plane_normals, corners, ends)


def panel_areas(panels: Panels) -> FloatArray:
    """
    Areas of the outer faces, in closed form.

    Parameters
    ----------
    panels : Panels
        P panels.

    Returns
    -------
    (P,) float array
        Areas, in squared model units.
    """
    return patch_areas(panels.spheres, panel_arcs(panels), panels.corner_panels)


_LAYERS, _LAYER_WEIGHTS = np.polynomial.legendre.leggauss(16)


def panel_volumes(panels: Panels) -> FloatArray:
    """
    Volumes between the outer and inner faces.

    Parameters
    ----------
    panels : Panels
        P panels.

    Returns
    -------
    (P,) float array
        Volumes, in cubed model units: the areas of the parallel layers between the two faces,
        integrated over the thickness with 16 Gauss points.
    """
    total = np.zeros(panels.n_panels)
    for node, weight in zip(_LAYERS, _LAYER_WEIGHTS, strict=True):
        rows = offset(panels.spheres, -panels.thickness * (1 + node) / 2)
        corners, _ = corner_points(
            rows[panels.corner_panels], panels.plane_normals, panels.plane_offsets,
            panels.offsets, panels.corners,
        )  # fmt: skip
        arcs = _layer_arcs(panels, rows, corners)
        total += weight * patch_areas(rows, arcs, panels.corner_panels)
    return total * panels.thickness / 2


def _check_lengths(thickness: float, joint_gap: float) -> None:
    for name, value in (("thickness", thickness), ("joint gap", joint_gap)):
        if not (np.isfinite(value) and value >= 0):
            raise InputError(f"{name} must be a length of at least 0, not {value}")


def _inner_spheres(rows: FloatArray, thickness: float, ids: tuple[str, ...]) -> FloatArray:
    sharpest = int(np.argmin(rows[:, 0]))
    if 1 + 2 * rows[sharpest, 0] * thickness <= 0:
        radius = -1 / (2 * rows[sharpest, 0])
        raise InputError(
            f"thickness {thickness:g} is not less than the smallest inner radius {radius:.6g} "
            f"(panel {ids[sharpest]}); use thinner panels or larger moulds"
        )
    return offset(rows, -thickness)


def _reasons(
    panels: Panels, references: FloatArray, exists: BoolArray, inner_exists: BoolArray
) -> dict[int, str]:
    """Why panels cannot be made; the first reason that applies."""
    owners = panels.corner_panels
    reasons: dict[int, str] = {}

    def note(is_bad: BoolArray, reason: str) -> None:
        for panel in np.flatnonzero(is_bad):
            reasons.setdefault(int(panel), reason)

    def any_corner(is_bad: BoolArray) -> BoolArray:
        return np.logical_or.reduceat(is_bad, panels.offsets[:-1])

    is_fold = (panels.plane_normals == 0).all(axis=1)
    note(any_corner(is_fold), "the face folds back onto a neighbour")
    note(any_corner(~exists), "two cutting planes do not meet on the sphere at a corner")
    note(any_corner(~inner_exists), "the thickness leaves no corner on the inner face")
    sides = references[panels.next_corners] - references
    arcs, inner_arcs = panel_arcs(panels), inner_panel_arcs(panels)
    layers = [(panels.spheres, arcs, "outer")]
    if panels.thickness > 0:
        layers.append((panels.inner_spheres, inner_arcs, "inner"))
    has_sides = panels.thickness > 0 or panels.joint_gap > 0
    for rows, layer, name in layers:
        backwards = dot(layer.ends - layer.starts, sides) <= 0
        note(any_corner(backwards), f"an edge of the {name} face vanishes or runs backwards")
        note(_crossing(panels, rows, layer), f"the boundary of the {name} face crosses itself")
        if has_sides:
            leans = any_corner(_leaning(rows[owners], layer))
            note(leans, f"a cutting plane leans over the {name} face: cut it by bisectors")
        steep = any_corner(_steep(rows[owners], layer))
        note(steep, f"the cap of the {name} face opens more than 80 degrees: split the face")
    sound = ~np.isin(np.arange(panels.n_panels), list(reasons))
    # The others may reach where the area integral has no origin.
    areas = np.ones(panels.n_panels)
    areas[sound] = panel_areas(select_panels(panels, sound))
    note(areas <= 0, "the boundary runs clockwise about the face normal")
    return reasons


def _leaning(rows: FloatArray, arcs: Arcs) -> BoolArray:
    """Whether panels begin on the wrong side of a plane, or arcs exceed a half circle."""
    middles = (arcs.starts + arcs.ends) / 2
    return dot(normals(rows, middles), arcs.rises) <= 0


def _steep(rows: FloatArray, arcs: Arcs) -> BoolArray:
    """Whether arcs reach beyond the largest cap about the local origin."""
    axis = unit(rows[:, 1:4])[:, None]
    points = arc_points(arcs, np.array([-1.0, 0.0]))
    return (dot(normals(rows[:, None], points), axis) < np.cos(CAP_ANGLE)).any(axis=1)


def _crossing(panels: Panels, rows: FloatArray, arcs: Arcs) -> BoolArray:
    """Whether two arcs of a panel meet elsewhere than in their common corner."""
    result = np.zeros(panels.n_panels, bool)
    for degree in np.unique(panels.degrees):
        members = np.flatnonzero(panels.degrees == degree)
        first = panels.offsets[members]
        for i in range(degree):
            for j in range(i + 1, degree):
                result[members] |= _arcs_meet(rows[members], panels, arcs, first + i, first + j)
    return result


def _arcs_meet(
    rows: FloatArray, panels: Panels, arcs: Arcs, first: IntArray, second: IntArray
) -> BoolArray:
    n, m = panels.plane_normals[first], panels.plane_normals[second]
    direction = np.cross(n, m)
    square = dot(direction, direction)
    is_parallel = square < PARALLEL_PLANES**2
    weight = np.where(is_parallel, 1.0, square)[:, None]
    foot = (
        panels.plane_offsets[first][:, None] * np.cross(m, direction)
        + panels.plane_offsets[second][:, None] * np.cross(direction, n)
    ) / weight
    direction = unit(direction)
    slope = dot(normals(rows, foot), direction)
    value = evaluate(rows, foot)
    discriminant = slope**2 - 4 * rows[:, 0] * value
    is_real = (discriminant >= 0) & ~is_parallel
    half = (slope + np.copysign(np.sqrt(np.maximum(discriminant, 0)), slope)) / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        near, far = value / half, half / rows[:, 0]
    meets = np.zeros(len(first), bool)
    for root in (near, far):
        is_finite = is_real & np.isfinite(root)
        point = foot + np.where(is_finite, root, 0.0)[:, None] * direction
        meets |= is_finite & _inside(arcs, first, point) & _inside(arcs, second, point)
    return meets


def _inside(arcs: Arcs, ids: IntArray, points: FloatArray) -> BoolArray:
    """Whether points of the circles of arcs lie strictly between the ends of the arcs."""
    half = (arcs.ends[ids] - arcs.starts[ids]) / 2
    relative = points - (arcs.starts[ids] + arcs.ends[ids]) / 2
    along = dot(relative, half) / dot(half, half)
    across = dot(relative, arcs.rises[ids])
    sagitta = arcs.sagittas[ids]
    on_this_side = np.abs(across - sagitta) <= np.abs(sagitta) + CROSSING * norm(half)
    return (np.abs(along) < 1 - CROSSING) & on_this_side


def gap_report(sphere_mesh: SphereMesh, edges: EdgeMode) -> dict[str, float]:
    """
    Summary of the gaps between neighbouring arcs.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.
    edges : {"bisector", "intersection"}
        How panels are cut.

    Returns
    -------
    dict of str to float
        ``max`` and ``mean`` in model units, ``relative_to_edge`` the maximum over the mean
        edge length; zeros for a mesh without interior edges.
    """
    gaps = edge_gaps(flatten_nearly_plane(sphere_mesh), edges)
    largest = float(gaps.max(initial=0.0))
    mean = float(gaps.mean()) if len(gaps) else 0.0
    edge = mean_edge_length(sphere_mesh.mesh)
    return {"max": largest, "mean": mean, "relative_to_edge": largest / edge}
