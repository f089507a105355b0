"""How far are the end faces of beams apart that meet at a node? As exactness.py reports it."""

from collections import defaultdict

import numpy as np

from spheremesh import SphereMesh
from spheremesh.kernel.arrays import FloatArray, dot, norm, unit
from spheremesh.kernel.beams.beams import Beams
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.support.annuli import corner_mismatch
from spheremesh.kernel.support.node_axes import support_structure

MEETS = 1e-9
"""Annuli whose ends at a node lie this close, in mean edges, meet there."""


def judge_ends(beams: Beams, sphere_mesh: SphereMesh) -> None:
    """Print how well mitres meet: as planes, in lines on the axis and on the sides, in ends.

    Nodes where the annuli themselves meet, free of torsion and with spheres through the vertex,
    stand apart: elsewhere beams are as far apart as their planes are.
    """
    size = mean_edge_length(sphere_mesh.mesh)
    apart = np.zeros(sphere_mesh.mesh.n_vertices)
    np.maximum.at(apart, beams.annuli.edge_vertices, corner_mismatch(beams.annuli) / size)
    torsion = np.degrees(support_structure(sphere_mesh).torsion)
    found = node_misses(beams)
    nodes = np.array(sorted(found))
    misses = np.array([found[node] for node in nodes]) / size
    meets = apart[nodes] < MEETS
    print("mitres that meet, in mean edges: off the plane, the axis, the side, and their ends")
    for name, chosen in (("annuli meet", meets), ("annuli are apart", ~meets)):
        there = nodes[chosen]
        print(
            f"  {name}: {len(there)} nodes, torsion up to {torsion[there].max(initial=0):.1e} "
            f"deg, annuli apart {apart[there].max(initial=0):.1e}: "
            + ", ".join(f"{each:.1e}" for each in misses[chosen].max(axis=0, initial=0.0))
        )


def judge_square_ends(beams: Beams, sphere_mesh: SphereMesh) -> None:
    """Print how far square ends are from touching the cylinders of the nodes."""
    vertices = sphere_mesh.mesh.vertices[beams.annuli.edge_vertices]
    axes = beams.annuli.node_axes
    corners = beams.corners[:, :, :, [0, 2]]
    face = corners.reshape(beams.n_beams, 2, 4, 3)
    normals = unit(np.cross(face[:, :, 1] - face[:, :, 0], face[:, :, 2] - face[:, :, 0]))
    start = vertices - beams.annuli.origins[:, None]
    points = np.stack([start, start + beams.annuli.depth * axes], 2)
    heights = np.abs(dot(points - face[:, :, :1], normals[:, :, None]))
    wanted = beams.node_radius + beams.node_gap
    misses = np.abs(heights - wanted).max(axis=(1, 2)) / mean_edge_length(sphere_mesh.mesh)
    apart = corner_mismatch(beams.annuli).max(axis=1) / mean_edge_length(sphere_mesh.mesh)
    meets = apart < MEETS
    print("square ends, distance from the cylinders about the axes, in mean edges")
    for name, chosen in (("annuli meet", meets), ("annuli are apart", ~meets)):
        print(f"  {name}: {chosen.sum()} beams, {misses[chosen].max(initial=0.0):.1e}")


def node_misses(beams: Beams) -> dict[int, list[float]]:
    """Largest distances at each node, in model units."""
    ends: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for beam, vertices in enumerate(beams.annuli.edge_vertices.tolist()):
        for end, vertex in enumerate(vertices):
            ends[vertex].append((beam, end))
    return {vertex: _misses(beams, there) for vertex, there in ends.items() if len(there) > 1}


def _misses(beams: Beams, ends: list[tuple[int, int]]) -> list[float]:
    """Of all pairs of end faces that meet at a node, the largest distances.

    Of the corners from the other's plane; of the ridges from the other's ridge line; of the
    side lines from each other; of the ridges' corners from each other.
    """
    reference = beams.annuli.origins[ends[0][0]]
    faces: list[tuple[int, FloatArray]] = []
    for number, (beam, end) in enumerate(ends):
        corners = beams.corners[beam, end] + (beams.annuli.origins[beam] - reference)
        steps = [(1, 0), (1, 2)] if not beams.is_flat[beam, end] else []
        # Rows: ridge and side line, each from outer to inner corner.
        faces += [(number, corners[:, step].transpose(1, 0, 2)) for step in steps]
    worst = np.zeros(4)
    for owner, face in faces:
        others = [other for each, other in faces if each != owner]
        if not others:
            continue
        gaps = [_line_distance(face[1], other[1]) for other in others]
        nearest = others[int(np.argmin(gaps))]
        if _turn(face, nearest) < 0.5:
            continue  # a square end has no partner
        worst = np.maximum(
            worst,
            [
                _plane_distance(face, nearest), _line_distance(face[0], nearest[0]),
                min(gaps), norm(face[0] - nearest[0]).max(),
            ],
        )  # fmt: skip
    return worst.tolist()


def _line_distance(segment: FloatArray, other: FloatArray) -> float:
    """Largest distance of the ends of a segment from the line of another."""
    along = unit(other[1] - other[0])
    return float(norm(np.cross(segment - other[0], along)).max())


def _normal(face: FloatArray) -> FloatArray:
    return unit(np.cross(face[0, 1] - face[0, 0], face[1, 0] - face[0, 0]))


def _turn(face: FloatArray, other: FloatArray) -> float:
    """Cosine between the directions from ridge to side."""
    return float(dot(unit(face[1, 0] - face[0, 0]), unit(other[1, 0] - other[0, 0])))


def _plane_distance(face: FloatArray, other: FloatArray) -> float:
    corners = face.reshape(-1, 3) - other[0, 0]
    return float(np.abs(corners @ _normal(other)).max())
