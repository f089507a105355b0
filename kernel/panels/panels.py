"""Panels: pieces of spheres cut out by planes, exact each in itself.

A panel is its sphere, one cutting plane per edge, and the corners where the sphere meets two
consecutive planes. All geometry is local to the panel (its origin is the centroid of the mesh
face), so the site's coordinates cost no digits. `kernel.panels.cutting` makes panels.
"""

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, unit
from ..display import Shown, brief, counted, polygons_text, radii_text, size_text
from ..meshes.creases import crease_edges
from ..meshes.mesh import Mesh
from ..parts.records import PER_CORNER
from ..spheres.arcs import Arcs, patch_areas, sphere_arcs
from ..spheres.incidence import meet_lines
from ..spheres.rows import center_radius, recenter, rescale
from ..tolerances import PARALLEL_PLANES


@dataclass(frozen=True, repr=False)
class Panels(Shown):
    """Panels that can be made, in the order of their faces.

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
    design_spheres : (P, 5) float array
        Unit rows of the spheres that the panels were cut from, local, which are those of the
        moulds: the outer faces, the inner ones, or between, by the side of the thickness.
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
    edge_ids : (H,) int array
        Interior edge of the mesh, the same in both panels; -1 on the boundary.
    is_crease : (H,) bool array
        Edges along which the surface is not meant to be smooth: walls are mitred there.
    thicknesses : (P,) float array
        Distance of the inner from the outer face of each panel, in model units.
    thickness : float
        Thickness asked for, in model units; 0 for surfaces.
    joint_gap : float
        Width of the joint between neighbouring panels, in model units.
    """

    ids: tuple[str, ...]
    face_ids: IntArray
    labels: IntArray
    origins: FloatArray
    spheres: FloatArray
    inner_spheres: FloatArray
    design_spheres: FloatArray
    offsets: IntArray
    plane_normals: FloatArray = field(metadata=PER_CORNER)
    plane_offsets: FloatArray = field(metadata=PER_CORNER)
    corners: FloatArray = field(metadata=PER_CORNER)
    inner_corners: FloatArray = field(metadata=PER_CORNER)
    neighbors: IntArray = field(metadata=PER_CORNER)
    edge_ids: IntArray = field(metadata=PER_CORNER)
    is_crease: BoolArray = field(metadata=PER_CORNER)
    thicknesses: FloatArray
    thickness: float
    joint_gap: float

    def __repr__(self) -> str:
        moulds = len(np.unique(self.labels[self.labels >= 0]))
        return brief(
            "Panels",
            [
                polygons_text(self.degrees),
                size_text(self.corners + self.origins[self.corner_panels]),
                radii_text(self.radii),
                counted(moulds, "mould") if moulds else "",
                f"thickness {self.thickness:.3g}" if self.thickness else "surfaces",
            ],
        )

    @property
    def radii(self) -> FloatArray:
        """Radii of the spheres that panels were cut from, (P,); infinite for planes."""
        return np.sqrt(center_radius(self.design_spheres)[1])

    @property
    def centers(self) -> FloatArray:
        """Centres of these spheres in model coordinates, (P, 3); infinite for planes."""
        return center_radius(self.design_spheres)[0] + self.origins

    @property
    def planes(self) -> FloatArray:
        """Cutting planes ``n·x = d`` in model coordinates, (H, 4): n, into the panel, and d."""
        moved = dot(self.plane_normals, self.origins[self.corner_panels])
        return np.column_stack([self.plane_normals, self.plane_offsets + moved])

    @property
    def element_ids(self) -> IntArray:
        """Face of each panel, (P,)."""
        return self.face_ids

    @property
    def n_panels(self) -> int:
        """Number of panels."""
        return len(self.face_ids)

    @property
    def degrees(self) -> IntArray:
        """Number of corners of each panel, (P,)."""
        return np.diff(self.offsets)

    @property
    def corner_panels(self) -> IntArray:
        """Panel of each corner, (H,)."""
        return np.repeat(np.arange(self.n_panels), self.degrees)

    @property
    def next_corners(self) -> IntArray:
        """Following corner in the same panel, (H,)."""
        return _following(self.offsets)


def _following(offsets: IntArray) -> IntArray:
    following = np.arange(1, int(offsets[-1]) + 1)
    following[offsets[1:] - 1] = offsets[:-1]
    return following


def corner_points(
    rows: FloatArray,
    plane_normals: FloatArray,
    plane_offsets: FloatArray,
    offsets: IntArray,
    references: FloatArray,
) -> tuple[FloatArray, BoolArray]:
    """Points (H, 3) where spheres meet two consecutive cutting planes, nearest to references.

    Of each corner the local unit row (H, 5) of its panel, and the cutting plane of the edge
    that leaves it; the first corner of each panel (P + 1,). The reference where there is none;
    also whether the line of the planes meets the sphere.

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
    step, exists = meet_lines(near, foot, direction)
    points = references + foot + step[:, None] * direction
    return np.where(exists[:, None], points, references), exists


def mark_creases(panels: Panels, mesh: Mesh, crease: float) -> Panels:
    """Mark the edges at which the planes of faces turn by more than an angle, in radians."""
    beyond = np.zeros(1, bool)
    marks = np.concatenate([crease_edges(mesh, crease), beyond])
    return replace(panels, is_crease=marks[panels.edge_ids])


def opposite_corners(panels: Panels) -> IntArray:
    """The other panel's side of each edge, (H,).

    The corner from which the neighbour's edge leaves; -1 on the boundary and where the panel
    beyond is not among these.
    """
    result = np.full(len(panels.edge_ids), -1)
    order = np.argsort(panels.edge_ids, kind="stable")
    first, second = order[:-1], order[1:]
    edges = panels.edge_ids
    pairs = (edges[first] == edges[second]) & (edges[first] >= 0)
    result[first[pairs]], result[second[pairs]] = second[pairs], first[pairs]
    return result


def neighbor_ids(panels: Panels) -> list[str | None]:
    """Name of the panel beyond each of H edges.

    None on the boundary and where the panel beyond is not among these.
    """
    names = dict(zip(panels.face_ids.tolist(), panels.ids, strict=True))
    return [names.get(face) for face in panels.neighbors.tolist()]


def scale_panels(panels: Panels, factor: float) -> Panels:
    """Panels in another unit of length: every length is multiplied by the factor."""
    return replace(
        panels,
        origins=panels.origins * factor,
        spheres=rescale(panels.spheres, factor),
        inner_spheres=rescale(panels.inner_spheres, factor),
        design_spheres=rescale(panels.design_spheres, factor),
        plane_offsets=panels.plane_offsets * factor,
        corners=panels.corners * factor,
        inner_corners=panels.inner_corners * factor,
        thicknesses=panels.thicknesses * factor,
        thickness=panels.thickness * factor,
        joint_gap=panels.joint_gap * factor,
    )


def move_origins(panels: Panels, origins: FloatArray) -> Panels:
    """The same panels in coordinates local to other points (P, 3), near the old origins."""
    shifts = origins - panels.origins
    corner_shifts = shifts[panels.corner_panels]
    return replace(
        panels,
        origins=origins,
        spheres=recenter(panels.spheres, shifts),
        inner_spheres=recenter(panels.inner_spheres, shifts),
        design_spheres=recenter(panels.design_spheres, shifts),
        plane_offsets=panels.plane_offsets - dot(panels.plane_normals, corner_shifts),
        corners=panels.corners - corner_shifts,
        inner_corners=panels.inner_corners - corner_shifts,
    )


def panel_arcs(panels: Panels, face: Literal["outer", "inner"] = "outer") -> Arcs:
    """Edges of the outer or inner faces: H local arcs, arc h from corner h to the next."""
    if face == "outer":
        return _face_arcs(panels, panels.spheres, panels.corners)
    return _face_arcs(panels, panels.inner_spheres, panels.inner_corners)


def boundaries(panels: Panels) -> list[tuple[FloatArray, Arcs]]:
    """Faces of panels (P, 5) and their H edges: outer, and inner if there is a thickness."""
    outer = panels.spheres, panel_arcs(panels)
    if panels.thickness == 0:
        return [outer]
    return [outer, (panels.inner_spheres, panel_arcs(panels, "inner"))]


def _face_arcs(panels: Panels, rows: FloatArray, corners: FloatArray) -> Arcs:
    ends = corners[panels.next_corners]
    return sphere_arcs(rows[panels.corner_panels], panels.plane_normals, corners, ends)


def panel_areas(panels: Panels) -> FloatArray:
    """Areas of the outer faces, (P,), in closed form, in squared model units."""
    return patch_areas(panels.spheres, panel_arcs(panels), panels.corner_panels)
