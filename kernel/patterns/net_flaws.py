"""What keeps a net of spheres from being built, by face and cause."""

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray, dot, norm, sum_by, unit
from ..beams.cutting import cut_beams
from ..hexagons.face_shapes import CONVEX, CROSSING_FACE, face_shapes
from ..meshes.mesh import Mesh, face_vector_areas, local_corners, mean_edge_length
from ..panels.cutting import cut_panels
from ..panels.mould_blanks import panel_caps
from ..remesh.planar.node_planarity import measure_nodes, node_axis_angles
from ..remesh.planar.planarize import SHORT_EDGE
from ..sphere_meshes.fit import face_planes
from ..sphere_meshes.sphere_mesh import SphereMesh, intersection_angles
from ..support.annulus_construction import annulus_support

PLANAR_NODE = 1e-6
"""Largest fourth singular value of the spheres around a node, relative to the first."""

LARGEST_CAP = np.radians(60)
"""Largest half opening of a panel, seen from the centre of its sphere."""

LARGEST_LEAN = np.radians(20)
"""Largest angle of node axes with the normals, at 95 % of the nodes."""

DEPTH, THICKNESS, PLATE = 0.1, 0.05, 0.02
"""Depth and thickness of the beams and thickness of the panels of the trial, in mean edges."""


class Flaw(NamedTuple):
    """One thing that keeps a face from being built.

    Attributes
    ----------
    face : int or None
        The face; None for the net as a whole.
    cause : str
        What is wrong with it.
    """

    face: int | None
    cause: str


@dataclass(frozen=True)
class PatternJudgement:
    """Measures of a pattern of spheres, lengths in mean edges, angles in radians.

    Attributes
    ----------
    flaws : tuple of Flaw
        What keeps it from being built; nothing if it is usable.
    shortest : float
        Shortest edge.
    cap : float
        Largest half opening of a panel.
    angle, flat_angle : float
        Mean angle between neighbouring spheres, and between the planes of the same faces.
    convex_share : float
        Share of the faces that are visually convex.
    rejected_panels, rejected_beams : int
        Parts that cannot be made; beams are tried where nodes have axes.
    planarity : float
        Worst over the nodes, 0 where none are asked for.
    lean_p95, lean_max : float
        Angles of node axes with the normals, 0 where none are asked for.
    """

    flaws: tuple[Flaw, ...]
    shortest: float
    cap: float
    angle: float
    flat_angle: float
    convex_share: float
    rejected_panels: int
    rejected_beams: int = 0
    planarity: float = 0.0
    lean_p95: float = 0.0
    lean_max: float = 0.0

    @property
    def is_usable(self) -> bool:
        """Whether the pattern can be built as it is."""
        return not self.flaws

    @property
    def flawed_faces(self) -> list[int]:
        """Faces with flaws, in rising order."""
        return sorted({flaw.face for flaw in self.flaws if flaw.face is not None})

    @property
    def roughness(self) -> float:
        """Mean angle relative to that of planes."""
        return self.angle / self.flat_angle if self.flat_angle > 0 else 1.0


def judge_faces(
    sphere_mesh: SphereMesh,
    edges: Literal["bisector", "intersection"],
    *,
    convex: bool,
    shortest: float = 0.0,
) -> PatternJudgement:
    """Judge faces by their shape, and by panels that are cut on trial.

    Parameters
    ----------
    edges : {"bisector", "intersection"}
        How panels are cut.
    convex : bool
        Whether faces that are not visually convex are flawed.
    shortest : float
        Least edge, in mean edges.

    Returns
    -------
    PatternJudgement
        What was measured, and the flaws.
    """
    mesh = sphere_mesh.mesh
    shapes = face_shapes(sphere_mesh) if convex else np.full(mesh.n_faces, CONVEX)
    sides = _shortest_sides(mesh)
    panel_flaws, cap, n_panels = _trial_panels(sphere_mesh, edges)
    flaws = [
        *(
            Flaw(face, f"its shape is {shapes[face]}, not convex")
            for face in np.flatnonzero(shapes != CONVEX).tolist()
        ),
        *_short(sides, shortest),
        *panel_flaws,
    ]
    return PatternJudgement(
        tuple(flaws),
        float(sides.min()),
        cap,
        _mean(intersection_angles(sphere_mesh)),
        _mean(intersection_angles(face_planes(mesh))),
        float((shapes == CONVEX).mean()),
        n_panels,
    )


def judge_net(sphere_mesh: SphereMesh) -> PatternJudgement:
    """Judge a net as a workshop would: its nodes, faces, and a trial of panels and beams."""
    mesh = sphere_mesh.mesh
    nodes = measure_nodes(sphere_mesh)
    leans = node_axis_angles(sphere_mesh, nodes)[nodes.is_inner]
    lean_p95, lean_max = _upper(leans)
    shapes, sides = face_shapes(sphere_mesh), _shortest_sides(mesh)
    panel_flaws, cap, n_panels = _trial_panels(sphere_mesh, "intersection")
    beam_flaws = _trial_beams(sphere_mesh)
    flaws = [
        *_named(_turned_over(mesh), "turned over against its neighbours"),
        *_named(shapes == CROSSING_FACE, "its boundary crosses itself"),
        *_short(sides, SHORT_EDGE),
        *panel_flaws,
        *beam_flaws,
    ]
    planarity = float(nodes.planarity.max(initial=0.0))
    if planarity >= PLANAR_NODE:
        flaws.append(Flaw(None, f"nodes have torsion: planarity {planarity:.1e}"))
    if lean_p95 >= LARGEST_LEAN:
        flaws.append(
            Flaw(None, f"node axes lean {np.degrees(lean_p95):.0f} degrees at 5 % of the nodes")
        )
    return PatternJudgement(
        flaws=tuple(flaws),
        shortest=float(sides.min()),
        cap=cap,
        angle=_mean(intersection_angles(sphere_mesh)),
        flat_angle=_mean(intersection_angles(face_planes(mesh))),
        convex_share=float((shapes == CONVEX).mean()),
        rejected_panels=n_panels,
        rejected_beams=len(beam_flaws),
        planarity=planarity,
        lean_p95=lean_p95,
        lean_max=lean_max,
    )


def _mean(angles: FloatArray) -> float:
    return float(angles.mean()) if len(angles) else 0.0


def _upper(angles: FloatArray) -> tuple[float, float]:
    """95th percentile and largest of the angles; nodes without an axis count as lying flat."""
    if len(angles) == 0:
        return 0.0, 0.0
    known = np.nan_to_num(angles, nan=np.pi / 2)
    return float(np.percentile(known, 95)), float(known.max())


def _shortest_sides(mesh: Mesh) -> FloatArray:
    """Shortest side (F,) of each face, in mean edges."""
    points = local_corners(mesh)
    lengths = norm(points[mesh.topology.next_corners] - points)
    return np.minimum.reduceat(lengths, mesh.offsets[:-1]) / mean_edge_length(mesh)


def _turned_over(mesh: Mesh) -> BoolArray:
    """Faces (F,) that look to the other side than the faces around their corners do."""
    own = unit(face_vector_areas(mesh))
    around = sum_by(mesh.corners, own[mesh.topology.corner_faces], mesh.n_vertices)
    ring = sum_by(mesh.topology.corner_faces, around[mesh.corners], mesh.n_faces)
    return dot(own, ring) - mesh.degrees < 0


def _named(is_bad: BoolArray, cause: str) -> list[Flaw]:
    return [Flaw(face, cause) for face in np.flatnonzero(is_bad).tolist()]


def _short(sides: FloatArray, least: float) -> list[Flaw]:
    return [
        Flaw(face, f"an edge of {sides[face]:.2g} mean edges, shorter than {least:g}")
        for face in np.flatnonzero(sides < least).tolist()
    ]


def _trial_panels(
    sphere_mesh: SphereMesh, edges: Literal["bisector", "intersection"]
) -> tuple[list[Flaw], float, int]:
    """Flaws of panels, their largest half opening, and how many are rejected."""
    panels, rejected = cut_panels(
        sphere_mesh, edges, PLATE * mean_edge_length(sphere_mesh.mesh)
    )
    flaws = [Flaw(part.element_id, f"no panel: {part.reason}") for part in rejected]
    openings = panel_caps(panels).openings / 2 if panels.n_panels else np.zeros(0)
    flaws += [
        Flaw(int(panels.face_ids[i]), f"a cap of {np.degrees(openings[i]):.0f} degrees")
        for i in np.flatnonzero(openings > LARGEST_CAP).tolist()
    ]
    return flaws, float(openings.max(initial=0.0)), len(rejected)


def _trial_beams(sphere_mesh: SphereMesh) -> list[Flaw]:
    """Beams that are rejected."""
    mesh = sphere_mesh.mesh
    size = mean_edge_length(mesh)
    support = annulus_support(sphere_mesh, depth=DEPTH * size)
    _, cut_away = cut_beams(support.annuli, THICKNESS * size)
    beside = _faces_beside(mesh)
    return [
        Flaw(int(beside[part.element_id]), f"no beam {part.id}: {part.reason}")
        for part in (*support.rejected, *cut_away)
    ]


def _faces_beside(mesh: Mesh) -> IntArray:
    """A face (B,) beside each edge, those of the boundary included."""
    twins = mesh.topology.twins
    first = (twins > np.arange(len(twins))) | (twins < 0)
    return mesh.topology.corner_faces[first]


def flaw_counts(flaws: tuple[Flaw, ...]) -> dict[str, Any]:
    """Flaws as plain values: the number of faces, and ``face`` and ``cause`` of each."""
    faces = {flaw.face for flaw in flaws if flaw.face is not None}
    return {
        "faces": len(faces),
        "list": [{"face": flaw.face, "cause": flaw.cause} for flaw in flaws],
    }
