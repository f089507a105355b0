"""Tidy tables of panels, of their edges, and of moulds, in millimetres and degrees."""

from typing import Final

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, norm
from ...kernel.panels.centroids import panel_centroids
from ...kernel.panels.facts import PanelFacts, edge_angles, packing_sizes, panel_bulges
from ...kernel.panels.mould_blanks import mould_blanks
from ...kernel.panels.panels import Panels, neighbor_ids, opposite_corners
from ...kernel.parts.assembly_order import assembly_order
from ..audit.panels import PanelSubject, check_panels, panel_subject, same_shapes
from ..audit.subjects import warning_texts
from ..units import CUBIC_METER, SQUARE_METER
from .materials import Material
from .records import SAME_HEIGHT, Record, make_record, split_points, text_column

_CENTER: Final = ("center_x_mm", "center_y_mm", "center_z_mm")
_MASS_CENTER: Final = ("mass_center_x_mm", "mass_center_y_mm", "mass_center_z_mm")
_BOX: Final = ("box_length_mm", "box_width_mm", "box_height_mm")


def panel_records(
    panels: Panels, units: str, material: Material, name: str | None = None
) -> dict[str, Record]:
    """The tables ``panels``, ``panel_edges`` and ``moulds``, or one of them.

    Their columns are told by `data_dictionary`.
    """
    subject = panel_subject(panels, units)
    makers = {
        "panels": lambda: _panels(subject, material),
        "panel_edges": lambda: _edges(subject.parts, subject.facts),
        "moulds": lambda: _moulds(subject.parts, subject.facts),
    }
    return {table: make() for table, make in makers.items() if name in (None, table)}


def _panels(subject: PanelSubject, material: Material) -> Record:
    made, facts = subject.parts, subject.facts
    warnings = warning_texts(check_panels(subject))
    same = same_shapes(made)
    first: list[int] = same.representatives[same.labels].tolist()
    bulges, centroids = panel_bulges(made), panel_centroids(made)
    volumes = facts.volumes / CUBIC_METER
    has_mass = made.thicknesses > 0
    return make_record(
        {
            "id": made.ids,
            "face": made.face_ids.tolist(),
            "mould": [label + 1 if label >= 0 else None for label in made.labels.tolist()],
            "same_as": [made.ids[row] for row in first],
            "shape": ["plane" if bulge == "flat" else "sphere" for bulge in bulges],
            "bulge": bulges,
            "corners": made.degrees.tolist(),
            "material": [material.name] * made.n_panels,
            "thickness_mm": made.thicknesses,
            "radius_mm": facts.radii,
            "outer_radius_mm": facts.outer_radii,
            "inner_radius_mm": facts.inner_radii,
            **split_points(_CENTER, facts.centers),
            "area_m2": facts.areas / SQUARE_METER,
            "volume_m3": volumes,
            "mass_kg": np.where(has_mass, volumes * material.density, np.nan),
            **split_points(_MASS_CENTER, centroids),
            **split_points(_BOX, packing_sizes(made)),
            "blank_diameter_mm": 2 * facts.caps.radii,
            "blank_sagitta_mm": np.abs(facts.caps.sagittas),
            "assembly_order": panel_order(made, centroids).tolist(),
            "warnings": text_column(map(warnings.get, made.ids)),
        }
    )


def panel_order(panels: Panels, centroids: FloatArray) -> IntArray:
    """Place of each panel in an order of assembly from below, from 1."""
    twins, owners = opposite_corners(panels), panels.corner_panels
    first = np.flatnonzero(twins > np.arange(len(twins)))
    pairs = np.stack([owners[first], owners[twins[first]]], 1)
    return assembly_order(np.round(centroids[:, 2], SAME_HEIGHT), pairs)


def _edges(made: Panels, facts: PanelFacts) -> Record:
    owners, following = made.corner_panels, made.next_corners
    inner = made.inner_corners + made.origins[owners]
    numbers = np.arange(len(owners)) - made.offsets[owners] + 1
    twins = opposite_corners(made)
    kinds = np.where(made.is_crease, "crease", np.where(made.edge_ids < 0, "rim", "smooth"))
    chords = norm(made.corners[following] - made.corners)
    diagonals = norm(made.corners[following[following]] - made.corners)
    return make_record(
        {
            "panel": [made.ids[row] for row in owners.tolist()],
            "edge": numbers.tolist(),
            "kind": kinds.tolist(),
            "neighbor": text_column(neighbor_ids(made)),
            "neighbor_edge": [
                number if twin >= 0 else None
                for number, twin in zip(numbers[twins].tolist(), twins.tolist(), strict=True)
            ],
            "length_mm": facts.edge_lengths,
            "chord_mm": chords,
            "sagitta_mm": facts.sagittas,
            "arc_radius_mm": facts.arc_radii,
            "diagonal_mm": diagonals,
            "corner_angle_deg": np.degrees(facts.corner_angles),
            "wall_tilt_deg": np.degrees(facts.wall_tilts),
            "neighbor_angle_deg": np.degrees(edge_angles(made)),
            **split_points(("outer_x_mm", "outer_y_mm", "outer_z_mm"), facts.corners),
            **split_points(("inner_x_mm", "inner_y_mm", "inner_z_mm"), inner),
            **split_points(("wall_x", "wall_y", "wall_z"), made.plane_normals),
        }
    )


def _moulds(made: Panels, facts: PanelFacts) -> Record:
    blanks = mould_blanks(made, same_shapes(made), caps=facts.caps)
    areas = [float(facts.areas[made.labels == label].sum()) for label in blanks.labels]
    return make_record(
        {
            "mould": (blanks.labels + 1).tolist(),
            "radius_mm": blanks.radii,
            "panels": blanks.counts.tolist(),
            "shapes": blanks.shapes.tolist(),
            "blank_diameter_mm": blanks.diameters,
            "blank_sagitta_mm": blanks.sagittas,
            "blank_opening_deg": np.degrees(blanks.openings),
            "panel_area_m2": np.array(areas) / SQUARE_METER,
        }
    )
