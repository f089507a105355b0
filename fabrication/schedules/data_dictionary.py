"""The data dictionary: what every column of the tidy tables says.

Names end in their unit. Texts are for people; ``docs/tables.md`` shows them.
"""

from typing import Final

_POSITION: Final = "in the coordinates of the model"

PANELS: Final = {
    "id": "name of the panel, the same in all files",
    "face": "face of the mesh, counted from 0",
    "mould": "number of the mould, from 1; empty without moulds",
    "same_as": "first of the panels of this shape",
    "shape": "sphere or plane",
    "bulge": "out, in or flat, seen from outside",
    "corners": "number of corners",
    "material": "as asked for",
    "thickness_mm": "thickness; 0 for surfaces",
    "radius_mm": "radius of the mould; empty for planes",
    "outer_radius_mm": "radius of the outer face; empty for planes",
    "inner_radius_mm": "radius of the inner face; empty for planes",
    "center_x_mm": f"centre of the spheres, {_POSITION}; empty for planes",
    "center_y_mm": "its y",
    "center_z_mm": "its z",
    "area_m2": "area of the outer face",
    "volume_m3": "volume; 0 for surfaces",
    "mass_kg": "mass; empty for surfaces",
    "mass_center_x_mm": f"centre of mass, {_POSITION}",
    "mass_center_y_mm": "its y",
    "mass_center_z_mm": "its z",
    "box_length_mm": "packing box of the whole panel, along the chord of edge 1",
    "box_width_mm": "its width",
    "box_height_mm": "its height, with the thickness",
    "blank_diameter_mm": "smallest cap of the mould that holds the panel",
    "blank_sagitta_mm": "height of that cap",
    "assembly_order": "place in an order from below, each beside one that stands",
    "warnings": "findings of the audit; - if there are none",
}

PANEL_EDGES: Final = {
    "panel": "name of the panel",
    "edge": "from this corner to the next, counter-clockwise seen from outside, from 1",
    "kind": "smooth, crease or rim",
    "neighbor": "panel beyond; - at the rim",
    "neighbor_edge": "edge of that panel",
    "length_mm": "length of the outer edge, along the arc",
    "chord_mm": "distance of its corners",
    "sagitta_mm": "height of the arc over the chord, positive if it bulges out",
    "arc_radius_mm": "radius of the outer edge; empty if straight",
    "diagonal_mm": "from this corner to the one after the next",
    "corner_angle_deg": "angle inside the outer face at this corner",
    "wall_tilt_deg": "of the wall against the surface normal",
    "neighbor_angle_deg": "between the spheres of this panel and the neighbour",
    "outer_x_mm": f"this corner of the outer face, {_POSITION}",
    "outer_y_mm": "its y",
    "outer_z_mm": "its z",
    "inner_x_mm": "this corner of the inner face; that of the outer for surfaces",
    "inner_y_mm": "its y",
    "inner_z_mm": "its z",
    "wall_x": "unit normal of the wall, into the panel",
    "wall_y": "its y",
    "wall_z": "its z",
}

MOULDS: Final = {
    "mould": "number of the mould, from 1",
    "radius_mm": "radius; empty for a flat mould",
    "panels": "number of panels",
    "shapes": "number of different ones",
    "blank_diameter_mm": "cap that holds every panel of the mould",
    "blank_sagitta_mm": "its height",
    "blank_opening_deg": "its opening, seen from the centre of the sphere",
    "panel_area_m2": "area of its panels",
}

BEAMS: Final = {
    "id": "name of the beam, the same in all files",
    "mesh_edge": "edge of the mesh",
    "left_panel": "panel on the left, seen from outside from start to end; - at the rim",
    "right_panel": "panel on the right",
    "start_node": "node at its start",
    "end_node": "node at its end",
    "material": "as asked for",
    "thickness_mm": "thickness",
    "width_mm": "distance of the two arcs in the middle",
    "length_mm": "longest chord between corners of the two ends",
    "chord_mm": "chord of the outer arc, in the middle of the thickness",
    "sagitta_mm": "height of the outer arc over it, positive to the outer side",
    "outer_length_mm": "length along the outer arc",
    "inner_length_mm": "length along the inner arc",
    "outer_radius_mm": "radius of the outer arc; empty if straight",
    "inner_radius_mm": "radius of the inner arc; empty if straight",
    "inner_chord_mm": "chord of the inner arc",
    "inner_sagitta_mm": "height of the inner arc over it, positive to the outer side",
    "volume_m3": "volume, without holes",
    "mass_kg": "mass",
    "mass_center_x_mm": f"centre of mass, {_POSITION}",
    "mass_center_y_mm": "its y",
    "mass_center_z_mm": "its z",
    "box_length_mm": "packing box, along the chord of the edge",
    "box_width_mm": "its width",
    "box_height_mm": "its height: the thickness",
    "tilt_deg": "against the surface",
    "holes": "number of drilled holes",
    "hole_diameter_mm": "their diameter; empty without",
    "origin_x_mm": f"origin of u, v and w in the middle of the thickness, {_POSITION}",
    "origin_y_mm": "its y",
    "origin_z_mm": "its z",
    "u_x": "unit vector u, along the edge from start to end",
    "u_y": "its y",
    "u_z": "its z",
    "v_x": "unit vector v, to the outer side; w = u × v is across the thickness, upwards",
    "v_y": "its y",
    "v_z": "its z",
    "assembly_order": "place in an order from below, each beside one that stands",
    "warnings": "findings of the audit; - if there are none",
}

BEAM_ENDS: Final = {
    "beam": "name of the beam",
    "end": "1 for the start, 2 for the end",
    "node": "node at which it ends",
    "outer_u_mm": "outer corner of the contour, in the middle of the thickness",
    "outer_v_mm": "its v",
    "inner_u_mm": "inner corner of the contour",
    "inner_v_mm": "its v",
    "depth_mm": "length on the node axis, before it is cut",
    "ridge_w_mm": "height at which the two cuts of the end meet",
    "lower_setback_mm": "how far the lower side ends before the contour; negative beyond it",
    "ridge_setback_mm": "the same of the ridge",
    "upper_setback_mm": "the same of the upper side",
    "lower_bevel_deg": "angle of the lower cut against the side, 90 if square; the ridge is "
    "the long side if the setback of the lower side is larger",
    "upper_bevel_deg": "the same of the upper cut",
    "twist_deg": "of the plane of the beam against the node axis",
    "mismatch_mm": "from the other ends at the node",
    "clearance_mm": "to the neighbour cut alike; empty if there is none",
    "outer_x_mm": f"outer corner on the node axis, {_POSITION}",
    "outer_y_mm": "its y",
    "outer_z_mm": "its z",
}

BEAM_HOLES: Final = {
    "beam": "name of the beam",
    "hole": "from 1, those of the start first, from the outer side",
    "end": "1 for the start, 2 for the end",
    "u_mm": "centre, in the plane of the beam",
    "v_mm": "its v",
    "diameter_mm": "diameter",
}

NODES: Final = {
    "id": "name of the node, the same in all files",
    "vertex": "vertex of the mesh, counted from 0",
    "x_mm": f"for setting out: mean of the outer corners of its beams, {_POSITION}",
    "y_mm": "its y",
    "z_mm": "its z",
    "axis_x": "unit vector of the node axis, to the inner side",
    "axis_y": "its y",
    "axis_z": "its z",
    "cylinder_radius_mm": "radius of the node cylinder; empty if beams are mitred",
    "cylinder_height_mm": "its height",
    "valence": "number of beams",
}

NODE_BEAMS: Final = {
    "beam_{}": "beams about the axis, counter-clockwise from outside; - where there are fewer",
    "angle_{}_deg": "from that beam to the next; the last to the first",
}
"""Columns that a node has for each of its beams, numbered from 1."""

TABLES: Final = {
    "panels": PANELS,
    "panel_edges": PANEL_EDGES,
    "moulds": MOULDS,
    "beams": BEAMS,
    "beam_ends": BEAM_ENDS,
    "beam_holes": BEAM_HOLES,
    "nodes": NODES,
}
"""Columns of each table, in order, and what they say."""
