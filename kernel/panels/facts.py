"""What is to be known of every panel: for schedules, drawings, files and audits."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray, dot, norm, unit
from ..spheres.arcs import (
    Arcs,
    arc_circles,
    arc_lengths,
    arc_points,
    arc_reaches,
    arc_tangents,
    patch_areas,
    sphere_arcs,
)
from ..spheres.incidence import normals, project
from ..spheres.minkowski import angle
from ..spheres.rows import center_radius, offset, recenter
from .joints import panel_joints
from .mould_blanks import PanelCaps, panel_caps
from .panels import (
    Panels,
    boundaries,
    corner_points,
    opposite_corners,
    panel_arcs,
    panel_areas,
)


@dataclass(frozen=True)
class PanelRadii:
    """Centres and radii of panels, in the unit of the panels; points in model coordinates.

    Attributes
    ----------
    radii : (P,) float array
        Radius of the sphere that a panel was cut from, which is that of its mould; infinite
        for planes.
    outer_radii, inner_radii : (P,) float array
        Radii of the outer and inner faces.
    centers : (P, 3) float array
        Centre of all three; infinite for planes.
    """

    radii: FloatArray
    outer_radii: FloatArray
    inner_radii: FloatArray
    centers: FloatArray


@dataclass(frozen=True)
class PanelFacts(PanelRadii):
    """Measures of panels, in the unit of the panels; points in model coordinates.

    Attributes
    ----------
    areas : (P,) float array
        Areas of the outer faces.
    volumes : (P,) float array
        Volumes; 0 without thickness.
    sizes : (P, 3) float array
        Length, width and rise of the box around the outer face, its length along the chord of
        the first edge.
    corners : (H, 3) float array
        Corners of the outer faces.
    corner_angles : (H,) float array
        Angle between the two edges at each corner, inside the outer face, in radians.
    edge_lengths : (H,) float array
        Lengths of the outer edges, along the arcs.
    arc_radii : (H,) float array
        Radii of the outer edges; infinite for straight ones.
    sagittas : (H,) float array
        Heights of the outer arcs over their chords.
    wall_tilts : (H,) float array
        Angle, in radians, between the cutting plane and the surface normal in the middle of
        the edge, averaged with the neighbour's. That of a beam is measured against the faces
        of the mesh, and on the boundary a beam has a plane of its own.
    steps, gaps, holes : (H,) float array
        How edges and corners fit those of the neighbours, see `PanelJoints`.
    caps : PanelCaps
        Smallest caps of the moulds that hold the panels.
    """

    areas: FloatArray
    volumes: FloatArray
    sizes: FloatArray
    corners: FloatArray
    corner_angles: FloatArray
    edge_lengths: FloatArray
    arc_radii: FloatArray
    sagittas: FloatArray
    wall_tilts: FloatArray
    steps: FloatArray
    gaps: FloatArray
    holes: FloatArray
    caps: PanelCaps


def panel_radii(panels: Panels) -> PanelRadii:
    """Measure the spheres of panels."""
    centers, squares = center_radius(panels.design_spheres)
    return PanelRadii(
        radii=np.sqrt(squares),
        outer_radii=np.sqrt(center_radius(panels.spheres)[1]),
        inner_radii=np.sqrt(center_radius(panels.inner_spheres)[1]),
        centers=centers + panels.origins,
    )


def edge_angles(panels: Panels) -> FloatArray:
    """Angles (H,) at which spheres meet those of their neighbours, in radians.

    NaN where there is no neighbour among the panels.
    """
    owners, twins = panels.corner_panels, opposite_corners(panels)
    following = panels.corners[panels.next_corners]
    middles = (panels.corners + following) / 2
    beyond = owners[twins]
    # Both rows seen from the middle of the edge keep their digits.
    own = recenter(panels.spheres[owners], middles)
    shifts = middles + panels.origins[owners] - panels.origins[beyond]
    angles = angle(own, recenter(panels.spheres[beyond], shifts))
    return np.where(twins >= 0, angles, np.nan)


def corner_misses(panels: Panels) -> FloatArray:
    """How far corners are off the plane through their middle, (P,), at most."""
    first: IntArray = panels.offsets[:-1]
    owners = panels.corner_panels
    middles = np.add.reduceat(panels.corners, first) / panels.degrees[:, None]
    arms = panels.corners - middles[owners]
    # The normal of the polygon, whose length is twice its area.
    up = unit(np.add.reduceat(np.cross(arms, arms[panels.next_corners]), first))
    misses: FloatArray = np.maximum.reduceat(np.abs(dot(arms, up[owners])), first)
    return misses


def panel_bulges(panels: Panels) -> list[str]:
    """To which side panels bulge, along the face normals: ``out``, ``in`` or ``flat``."""
    words = {-1.0: "out", 0.0: "flat", 1.0: "in"}
    signs: list[float] = np.sign(panels.design_spheres[:, 0]).tolist()
    return [words[sign] for sign in signs]


def panel_facts(panels: Panels) -> PanelFacts:
    """Measure panels."""
    arcs = panel_arcs(panels)
    return PanelFacts(
        **vars(panel_radii(panels)),
        areas=panel_areas(panels),
        volumes=panel_volumes(panels),
        sizes=bounding_sizes(panels),
        corners=panels.corners + panels.origins[panels.corner_panels],
        corner_angles=corner_angles(panels),
        edge_lengths=arc_lengths(arcs),
        arc_radii=arc_circles(arcs).radii,
        sagittas=arcs.sagittas,
        wall_tilts=wall_tilts(panels),
        **vars(panel_joints(panels)),
        caps=panel_caps(panels),
    )


_LAYERS, _LAYER_WEIGHTS = np.polynomial.legendre.leggauss(4)


def panel_volumes(panels: Panels) -> FloatArray:
    """Volumes (P,) between the outer and inner faces, in cubed model units.

    The areas of the parallel layers between the two faces, integrated over the thickness with
    4 Gauss points.
    """
    total = np.zeros(panels.n_panels)
    for weight, rows, arcs in panel_layers(panels):
        total += weight * patch_areas(rows, arcs, panels.corner_panels)
    return total * panels.thicknesses / 2


def panel_layers(panels: Panels) -> Iterator[tuple[float, FloatArray, Arcs]]:
    """Layers between the outer and the inner faces: their Gauss weights, rows and edges.

    The weights add up to 2.
    """
    owners = panels.corner_panels
    for node, weight in zip(_LAYERS.tolist(), _LAYER_WEIGHTS.tolist(), strict=True):
        rows = offset(panels.spheres, -panels.thicknesses * (1 + node) / 2)
        corners, _ = corner_points(
            rows[owners], panels.plane_normals, panels.plane_offsets, panels.offsets,
            panels.corners,
        )  # fmt: skip
        ends = corners[panels.next_corners]
        yield weight, rows, sphere_arcs(rows[owners], panels.plane_normals, corners, ends)


def corner_angles(panels: Panels) -> FloatArray:
    """From the edge that leaves a corner counter-clockwise about N to the one that enters."""
    leaving, entering = arc_tangents(panel_arcs(panels))
    back = np.empty_like(entering)
    back[panels.next_corners] = -entering
    up = unit(normals(panels.spheres[panels.corner_panels], panels.corners))
    sine, cosine = dot(np.cross(leaving, back), up), dot(leaving, back)
    return np.arctan2(sine, cosine) % (2 * np.pi)


def wall_tilts(panels: Panels) -> FloatArray:
    """Angles (H,) of walls to the normals in the middle of edges, those of both neighbours."""
    owners, twins = panels.corner_panels, opposite_corners(panels)
    middles = arc_points(panel_arcs(panels), np.zeros(1))[:, 0]
    up = unit(normals(panels.spheres[owners], middles))
    mean = np.where((twins >= 0)[:, None], up + up[twins], up)
    return np.arcsin(np.clip(np.abs(dot(unit(mean), panels.plane_normals)), 0.0, 1.0))


def bounding_sizes(panels: Panels) -> FloatArray:
    """Length, width and rise (P, 3) of the boxes around the outer faces."""
    arcs = panel_arcs(panels)
    return _box_sizes(panels, [(panels.spheres, arcs)])


def packing_sizes(panels: Panels) -> FloatArray:
    """Length, width and height (P, 3) of the boxes around whole panels, thickness included.

    Their length is along the chord of the first edge, as in `bounding_sizes`.
    """
    return _box_sizes(panels, boundaries(panels))


def _box_sizes(panels: Panels, faces: list[tuple[FloatArray, Arcs]]) -> FloatArray:
    first: IntArray = panels.offsets[:-1]
    up = unit(panels.spheres[:, 1:4])
    along = panels.corners[panels.next_corners[first]] - panels.corners[first]
    along = unit(along - dot(along, up)[:, None] * up)
    axes = np.stack([along, np.cross(up, along), up], 1)
    directions = axes[panels.corner_panels]
    low, high = np.full((2, panels.n_panels, 3), np.inf)
    high = -high
    for rows, arcs in faces:
        low = np.minimum(low, -np.maximum.reduceat(_reaches(panels, arcs, -directions), first))
        high = np.maximum(high, np.maximum.reduceat(_reaches(panels, arcs, directions), first))
        # The crown of the patch, above (or below) the local origin, belongs to the box too.
        crown = dot(project(rows, np.zeros((panels.n_panels, 3))), up)
        low[:, 2], high[:, 2] = np.minimum(low[:, 2], crown), np.maximum(high[:, 2], crown)
    return high - low


def _reaches(panels: Panels, arcs: Arcs, directions: FloatArray) -> FloatArray:
    """How far edges reach in directions (H, 3, 3) of their own."""
    planes = panels.plane_normals
    reaches: list[FloatArray] = []
    for direction in np.moveaxis(directions, 1, 0):
        across = dot(direction, planes)
        within = direction - across[:, None] * planes
        share = norm(within)
        reaches.append(
            share * arc_reaches(arcs, unit(within)) + across * dot(arcs.starts, planes)
        )
    return np.stack(reaches, 1)
