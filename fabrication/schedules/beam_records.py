"""Tidy tables of beams, of their ends and holes, and of nodes, in millimetres and degrees."""

from typing import Any, Final

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, dot, norm, sum_by
from ...kernel.beams.beams import Beams, insets_at, section_arcs
from ...kernel.beams.centroids import beam_centroids
from ...kernel.beams.contours import beam_contours
from ...kernel.beams.drilling import mark_centers
from ...kernel.beams.node_cylinders import node_cylinders
from ...kernel.parts.assembly_order import assembly_order
from ...kernel.spheres.arcs import arc_circles
from ...kernel.support.node_axes import node_name
from ..audit.beams import BeamSubject, beam_subject, check_beams
from ..audit.subjects import warning_texts
from ..units import CUBIC_METER
from .materials import Material
from .records import SAME_HEIGHT, Record, make_record, round_column, split_points, text_column

_MASS_CENTER: Final = ("mass_center_x_mm", "mass_center_y_mm", "mass_center_z_mm")
_ORIGIN: Final = ("origin_x_mm", "origin_y_mm", "origin_z_mm")


def beam_records(
    beams: Beams, units: str, material: Material, name: str | None = None
) -> dict[str, Record]:
    """The tables ``beams``, ``beam_ends``, ``beam_holes`` and ``nodes``, or one of them.

    Their columns are told by `data_dictionary`.
    """
    subject = beam_subject(beams, units)
    makers = {
        "beams": lambda: _beams(subject, material),
        "beam_ends": lambda: _ends(subject),
        "beam_holes": lambda: _holes(subject.parts),
        "nodes": lambda: _nodes(subject.parts),
    }
    return {table: make() for table, make in makers.items() if name in (None, table)}


def _beams(subject: BeamSubject, material: Material) -> Record:
    made, annuli, facts = subject.parts, subject.parts.annuli, subject.facts
    warnings = warning_texts(check_beams(subject))
    inner = section_arcs(made)[1]
    volumes, centroids = facts.volumes / CUBIC_METER, beam_centroids(made)
    counts, diameter = _hole_counts(made), made.marks.diameter if made.marks else np.nan
    start, end = (
        [node_name(vertex) for vertex in each] for each in annuli.edge_vertices.T.tolist()
    )
    return make_record(
        {
            "id": annuli.ids,
            "mesh_edge": annuli.edge_ids.tolist(),
            "left_panel": text_column(pair[0] for pair in annuli.panel_ids),
            "right_panel": text_column(pair[1] for pair in annuli.panel_ids),
            "start_node": start,
            "end_node": end,
            "material": [material.name] * made.n_beams,
            "thickness_mm": np.full(made.n_beams, made.thickness),
            "width_mm": facts.widths,
            "length_mm": facts.lengths,
            "chord_mm": facts.chords,
            "sagitta_mm": facts.sagittas,
            "outer_length_mm": facts.outer_lengths,
            "inner_length_mm": facts.inner_lengths,
            "outer_radius_mm": facts.outer_radii,
            "inner_radius_mm": arc_circles(inner).radii,
            "inner_chord_mm": norm(inner.ends - inner.starts),
            "inner_sagitta_mm": inner.sagittas,
            "volume_m3": volumes,
            "mass_kg": volumes * material.density,
            **split_points(_MASS_CENTER, centroids),
            **split_points(("box_length_mm", "box_width_mm"), facts.sizes),
            "box_height_mm": np.full(made.n_beams, made.thickness),
            "tilt_deg": np.degrees(facts.tilts),
            "holes": counts.tolist(),
            "hole_diameter_mm": np.where(counts > 0, diameter, np.nan),
            **split_points(_ORIGIN, annuli.origins),
            **split_points(("u_x", "u_y", "u_z"), annuli.frames[:, 0]),
            **split_points(("v_x", "v_y", "v_z"), annuli.frames[:, 1]),
            "assembly_order": beam_order(made, centroids).tolist(),
            "warnings": text_column(map(warnings.get, annuli.ids)),
        }
    )


def beam_order(beams: Beams, centroids: FloatArray) -> IntArray:
    """Place of each beam in an order of assembly from below, from 1."""
    nodes = beams.annuli.edge_vertices.ravel()
    order = np.argsort(nodes, kind="stable")
    # Beams of a node in a row: each touches the next.
    follows = nodes[order[1:]] == nodes[order[:-1]]
    pairs = np.stack([order[:-1][follows], order[1:][follows]], 1) // 2
    return assembly_order(np.round(centroids[:, 2], SAME_HEIGHT), pairs)


def _hole_counts(beams: Beams) -> IntArray:
    if beams.marks is None:
        return np.zeros(beams.n_beams, np.int64)
    return np.where(beams.marks.fits, beams.marks.holes.shape[1], 0)


def _ends(subject: BeamSubject) -> Record:
    made, annuli, facts = subject.parts, subject.parts.annuli, subject.facts
    contours = beam_contours(made).corners
    middle = insets_at(made.levels, made.insets, np.zeros(made.n_beams))[..., None]
    setbacks = (made.insets - middle).reshape(-1, 3)
    outer, inner = contours[:, [3, 2]].reshape(-1, 2), contours[:, [0, 1]].reshape(-1, 2)
    bevels = np.degrees(facts.bevels).reshape(-1, 2)
    return make_record(
        {
            "beam": [name for name in annuli.ids for _ in range(2)],
            "end": [1, 2] * made.n_beams,
            "node": [node_name(vertex) for vertex in annuli.edge_vertices.ravel().tolist()],
            **split_points(("outer_u_mm", "outer_v_mm"), outer),
            **split_points(("inner_u_mm", "inner_v_mm"), inner),
            "depth_mm": facts.depths.ravel(),
            "ridge_w_mm": made.levels[:, :, 1].ravel(),
            **split_points(
                ("lower_setback_mm", "ridge_setback_mm", "upper_setback_mm"), setbacks
            ),
            **split_points(("lower_bevel_deg", "upper_bevel_deg"), bevels),
            "twist_deg": np.degrees(facts.twists).ravel(),
            "mismatch_mm": facts.mismatches.ravel(),
            "clearance_mm": facts.clearances.ravel(),
            **split_points(
                ("outer_x_mm", "outer_y_mm", "outer_z_mm"), facts.ends.reshape(-1, 3)
            ),
        }
    )


def _holes(beams: Beams) -> Record:
    if beams.marks is None:
        fits, centers, diameter = np.zeros(beams.n_beams, bool), np.zeros((0, 2)), 0.0
        count = 0
    else:
        fits, diameter = beams.marks.fits, beams.marks.diameter
        centers = mark_centers(beams, beams.marks)[fits]
        count = centers.shape[1]
    names = [beams.ids[row] for row in np.flatnonzero(fits).tolist()]
    return make_record(
        {
            "beam": [name for name in names for _ in range(count)],
            "hole": [hole + 1 for _ in names for hole in range(count)],
            "end": [1 + 2 * hole // count for _ in names for hole in range(count)],
            **split_points(("u_mm", "v_mm"), centers.reshape(-1, 2)),
            "diameter_mm": np.full(len(names) * count, diameter),
        }
    )


def _nodes(beams: Beams) -> Record:
    annuli = beams.annuli
    ends = annuli.edge_vertices.ravel()
    vertices, first, groups = np.unique(ends, return_index=True, return_inverse=True)
    count = len(vertices)
    valences = np.bincount(groups, minlength=count)
    tops = (annuli.corners[:, :, 0] + annuli.origins[:, None]).reshape(-1, 3)
    # Seen from one end per node, means keep their digits.
    apart = tops - tops[first][groups]
    points = tops[first] + sum_by(groups, apart, count) / valences[:, None]
    axes = annuli.node_axes.reshape(-1, 3)[first]
    cylinders = node_cylinders(beams)
    has_cylinders = cylinders.n_nodes > 0
    return make_record(
        {
            "id": [node_name(vertex) for vertex in vertices.tolist()],
            "vertex": vertices.tolist(),
            **split_points(("x_mm", "y_mm", "z_mm"), points),
            **split_points(("axis_x", "axis_y", "axis_z"), axes),
            "cylinder_radius_mm": np.full(count, cylinders.radius if has_cylinders else np.nan),
            "cylinder_height_mm": cylinders.heights
            if has_cylinders
            else np.full(count, np.nan),
            "valence": valences.tolist(),
        }
    ) | _beams_about_nodes(beams, groups, axes)


def _beams_about_nodes(
    beams: Beams, groups: IntArray, axes: FloatArray
) -> dict[str, list[Any]]:
    """Columns of the beams of each node, counter-clockwise seen against its axis."""
    outer = beams.annuli.corners[:, :, 0]
    leaving = np.stack([outer[:, 1] - outer[:, 0], outer[:, 0] - outer[:, 1]], 1).reshape(-1, 3)
    up = -axes
    _, starts = np.unique(groups, return_index=True)
    right = leaving[starts] - dot(leaving[starts], up)[:, None] * up
    ahead = np.cross(up, right)
    turns = np.arctan2(dot(leaving, ahead[groups]), dot(leaving, right[groups])) % (2 * np.pi)
    # The first beam is at 0, but for rounding.
    turns[starts] = 0.0
    order = np.lexsort((turns, groups))
    valences = np.bincount(groups)
    bounds = np.concatenate([[0], np.cumsum(valences)])
    places = np.arange(len(order)) - bounds[groups[order]]
    last = places == valences[groups[order]] - 1
    following = np.roll(turns[order], -1)
    following[last] = 2 * np.pi
    angles = np.degrees(following - turns[order])
    columns: dict[str, list[Any]] = {}
    names = beams.ids
    for place in range(int(valences.max(initial=0))):
        here = places == place
        rows = groups[order][here]
        known: list[str | None] = [None] * len(axes)
        for row, end in zip(rows.tolist(), order[here].tolist(), strict=True):
            known[row] = names[end // 2]
        found = np.full(len(axes), np.nan)
        found[rows] = angles[here]
        angle = f"angle_{place + 1}_deg"
        columns |= {f"beam_{place + 1}": text_column(known), angle: round_column(angle, found)}
    return columns
