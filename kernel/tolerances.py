"""The only home of small numbers, by the room that uses them.

Every value is relative: to the mean edge of a mesh, to the size of a panel, to the magnitude
of the terms that cancel. None is a length in a unit. What a number means stands below it.
"""

from typing import Final

# Shared by several rooms

EPSILON: Final = 2.220446049250313e-16
"""Spacing of float64 at 1."""
DEGENERATE: Final = 1e-10
"""A face of less than this area, relative to its squared perimeter, has no plane."""
CIRCULAR: Final = 1e-6
"""Faces whose vertices lie this close to a common circle, in mean edges, are circular."""
SAME_PLANE: Final = 1e-6
"""Two spheres that meet at a smaller angle (radians) define no usable circle plane."""
CAP_ANGLE: Final = 1.3962634015954636
"""Half opening (80 degrees) beyond which a spherical cap is refused by CAD kernels."""
DAMPING: Final = 1e-12
"""Least damping of a Newton step; its inverse is the largest before a descent is given up."""
ENERGY_ROUNDING: Final = 1e-13
"""Relative rounding of a sum of energies: a rise below it is no rise."""
RESIDUAL_ROUNDING: Final = 1e-15
"""Rounding of residuals, in mean edges: it moves an energy by so much of its root."""
PARALLEL_PLANES: Final = 1e-6
"""Cutting planes that meet at a smaller angle (radians) are in line."""
SAME_CURVATURE: Final = 1e-9
"""Curvatures that differ by less, relative to the sharpest, share a mould without a choice."""
COMMON_VERTEX: Final = 1e-6
"""Spheres this close to a vertex, in mean edges, pass through it."""
LINE_CORNER: Final = 0.5235987755982988
"""A boundary or crease that turns at a vertex by more (30 degrees) has a corner there."""
NODE_ON_SPHERES: Final = 1e-6
"""Nodes of a planarised mesh lie this close to their spheres, in mean edges."""
SAME_PANEL: Final = 1e-6
"""Panels are identical where a motion brings all corners this close, in sizes (1 µm per m)."""
AXIS_SLACK: Final = 0.004363323129985824
"""By how much (0.25 degrees) a node axis may pass the bound on its angle."""

# Meshes

SAME_LENGTH: Final = 1e-6
"""Lengths that differ by a smaller share are equal, and an index decides."""
CREASE: Final = 0.6981317007977318
"""Faces that meet at a larger angle (40 degrees) make a crease, not a curved surface."""
SAME_TURN: Final = 1e-6
"""An angle between faces that passes another by less (radians) is equal to it."""

# Repair

SAME_PLACE: Final = 1e-6
"""Vertices closer than this, in mean edges, are one (1 µm per m)."""
WIDEST_WELD: Final = 1e-3
"""Vertices farther apart, in mean edges, are not one, however few digits a file has."""
ROUNDED_PLACES: Final = 4.0
"""Places differ by rounding if closer than this many spacings of their numbers."""
FARTHEST_PLACE: Final = 1e100
"""Coordinates beyond this are no places: their squares have no float64 to spare."""
WELL_KNOWN_DIGITS: Final = 15
"""Decimal digits that a float64 always keeps: numbers with fewer were rounded."""

# Surfaces

PARAMETER_SLACK: Final = 1e-9
"""Parameters outside of a domain by less, relative to its size or its ends, are at its end."""
POLE: Final = 1e-9
"""A side of a surface shorter than this share of the surface's size is a point."""
SMOOTH_JOINT: Final = 0.017453292519943295
"""Faces whose normals differ by less (1 degree, as in Rhino) where they meet join smoothly."""
SURFACE_CORNER: Final = 0.4363323129985824
"""A boundary of a face that turns by more (25 degrees) from edge to edge has a corner there."""
FLAT_TRIANGLE: Final = 1e-9
"""A triangle between points of a line has less than this share of a squared spacing as area."""

# Spheres

CROSSING: Final = 1e-9
"""How far from their ends, relative to the half chord, two arcs must meet to cross."""
LORENTZ: Final = 1e-9
"""How far a transform may miss the Lorentz group, relative to its squared size."""
TRANSFORM_DIGITS: Final = 1e-6
"""A transform whose rotation is rounded by more (radians) is refused."""

# Sphere meshes

APEX_SOLVE: Final = 1e-13
"""Relative residual to which the well conditioned system of smoothed apexes is solved."""
AT_INFINITY: Final = 1e-6
"""Vertices this close, in mean edges, to the point sent to infinity have no usable image."""
PLANAR: Final = 1e-6
"""Faces whose vertices lie this close to a common plane, in mean edges, are planar."""
SUPPORT_MISS: Final = 3e-4
"""Spheres that miss orthogonality to a common sphere by more (as a cosine) have none."""
NOISE_MARGIN: Final = 8.0
"""How many times its estimated noise a number must exceed to differ from zero."""

# Solvers

LINEAR_SOLVE: Final = 1e-6
"""Relative residual to which the linear system of a Newton step is solved."""
LEAST_SHIFT: Final = 1e-10
"""Least shift of a Hessian, lengths in mean edges: rounding moves nothing that is free."""
LEAST_DECREMENT: Final = 1e-26
"""A step that promises less energy than this is at rest: 1e-10 of a mean edge, weighted."""
LOWEST_EIGENVALUE: Final = 1e-8
"""Where the lowest eigenvalue of the Hessian is not below minus this, a minimum is reached."""
SAME_FALL: Final = 1e-6
"""Two falls of an energy that differ by a smaller share are equal."""

# Optimization

ANGLE_STEP: Final = 1e-9
"""An angle minimisation has converged when no unknown moves by more (radians)."""
ENERGY_CHANGE: Final = 1e-6
"""A descent has converged when a step lowers the energy by less than this share."""
AT_REST: Final = 1e-12
"""A descent is at rest when a step promises no more than this share of the energy."""
HELD: Final = 1e-8
"""What has to hold exactly holds when it misses by no more, in mean edges."""
HELD_AXES: Final = 1e-11
"""Nodes have axes when products of two curvatures miss by no more, in mean edges."""
SAME_OBJECTIVE: Final = 1e-9
"""The optimum is found when a round changes the rest of the energy by no larger share."""
SAME_ANGLES: Final = 1e-6
"""Mean angles that differ by a smaller share are equal."""
NEGATIVE_MODE: Final = 1e-8
"""An eigenvalue above minus this share of the largest entry of its matrix is not negative."""
SAME_ENERGY: Final = 1e-9
"""Energies that differ by a smaller share are equal, and the bulge decides."""
SAME_BULGE: Final = 1e-6
"""Optima whose spheres bulge alike up to this share bulge alike."""
OPENING: Final = 1.0471975511965976
"""Half opening (60 degrees) up to which a spherical cap is taken for a panel."""
LEAST_ENERGY: Final = 1e-16
"""An energy as good as zero: no residual above 1e-8 of a mean edge is left."""

# Panels

PLANE_SAGITTA: Final = 1e-6
"""A panel whose bulge is below this share of its size is built as a plane (1 µm per m)."""
NEAR_CENTER: Final = 1e-3
"""A layer of a panel needs more than this share of the radius of its sphere."""
SAME_EDGE: Final = 1e-7
"""Edges of neighbours this close, in chords, are one in triangles: float32 tells no more."""
THIN: Final = 1e-6
"""A panel whose thickness is below this share of its size is refused (1 µm per m)."""
ENCLOSING: Final = 1e-12
"""How far a point may stand out of a smallest enclosing cap, relative to its radius."""

# Support

NODE_TORSION: Final = 1.7453292519943296e-3
"""Torsion (0.1 degrees) beyond which a node is not called free of torsion."""
NODE_LINE: Final = 1e-2
"""A node whose arc planes miss a common line by more, in mean edges, is not valid."""
AXIS_LEAN: Final = 1.0471975511965976
"""A node axis that leans more (60 degrees) from the normal carries no beams."""
MIRROR_REACH: Final = 1e5
"""Mirror points farther than this, in mean edges, count as being at infinity."""
MIRROR_LEAST: Final = 1e-6
"""Mirror points nearer than this, in mean edges, do not tell the direction of an axis."""
BEAM_TILT: Final = 1.0471975511965976
"""A beam whose plane tilts more (60 degrees) from the bisecting plane does not stand."""
UPRIGHT_BEAMS: Final = 0.2617993877991494
"""Beams where spheres meet are upright if most tilt less (15 degrees)."""
AXIS_STEP: Final = 1e-12
"""Axes are at rest when none turns by more (radians)."""
RIM_LEAN: Final = 0.3490658503988659
"""Axes of the boundary may lean by this (20 degrees) to make the beams there flat."""
RIM_CLOSED: Final = 1e-7
"""Axes around a boundary that return this closely (radians), whatever the first is, fit."""

# Hexagons

STRAIGHT_CORNER: Final = 1e-9
"""A corner that turns the wrong way by less (radians) is straight."""
DUAL_EDGE: Final = 1e-9
"""A dual edge shorter than this share of the edge that it crosses has no direction."""
OFFSET_STEP: Final = 1e-6
"""Growing offsets are at rest when none moves by more, relative to the least."""
FAR_CORNER: Final = 0.6
"""A corner farther from its triangle than this share of the longest side is worth a warning."""

# Beams

MITRE_LIMIT: Final = 2.356194490192345
"""Half angle (135 degrees) between neighbouring beams beyond which ends are cut square."""
STRAIGHT_RULING: Final = 1e-10
"""A cut edge of a cylinder that bulges less, in thicknesses of the beam, is a straight line."""

# Remesh

NODE_EXACT: Final = 5e-10
"""Residuals of a node below this, in mean edges and radians, count as zero."""
NODE_ROUNDED: Final = 1e-14
"""Residuals of a node below this are rounding alone."""
FLATTEST: Final = 1e-3
"""Curvature, in inverse mean edges, below which a sphere is as good as a plane."""
BLEND_STEP: Final = 0.01
"""How sharply the least blend that makes a congruence fit is found."""
JET_RANK: Final = 1e-14
"""How much it counts that the coefficients of a polynomial are small, relative to its fit."""
LEAST_STIFFNESS: Final = 1e-3
"""Least weight of an edge or a vertex in the smoothing of a field, relative to the ordinary."""
UNDETERMINED: Final = 1e-9
"""Conjugate forms below this, relative to the largest that their terms allow, are zero."""
GAUGE_RANK: Final = 1e-9
"""A singular value below this, relative to the largest, belongs to a freedom of the problem."""
FOLD_SMOOTHING: Final = 1e-6
"""How sharp the barrier against folded triangles is in the end, relative to their area."""
FOLD_STEP: Final = 1e-3
"""Unfolding ends when a round lowers the distortion by less than this share."""
LATTICE_TIE: Final = 1e-7
"""A vertex this close to a line of a map, in steps of the map, is moved off it."""
ALIKE: Final = 1e-3
"""Squared differences of neighbours below this, relative to the mean, count no smaller."""
ON_SURFACE: Final = 1e-2
"""Nodes this close to a surface, in mean edges of their net, lie on it."""
ALIKE_NEIGHBORS: Final = 2e-4
"""Spheres of neighbours that meet at a smaller angle (radians) are turned apart to it."""
NODE_LANDED: Final = 1e-7
"""Torsion (radians) of a node whose beams meet exactly, up to rounding."""
UMBILIC: Final = 1e-3
"""Second derivatives of spheres that vary less with the direction, relatively, tell none."""
PLANAR_DAMPING: Final = 1e-11
"""Least damping of a step towards planar nodes: with less, rounding is larger than the step."""

# Exact supports

RIDGE: Final = 1e-9
"""How much it counts that a quadric is flat, relative to its fit, where neighbours tell not."""
EXACT_ENERGY: Final = 1e-26
"""Sum of squared misses of all conditions, in mean edges and radians, that is rounding."""
STEP_RIDGE: Final = 1e-12
"""Least damping of a step, relative to the diagonal of its system: rounding."""

# Fabrication

COINCIDENT: Final = 1e-6
"""Vertices of separate meshes closer than this, in mean edges, are one (1 µm per m)."""
CURVE_SHAPE: Final = 1e-9
"""A curve that lies this close to an arc or a line, in chords, is one."""
EXACT_BREP: Final = 1e-12
"""How far the parts of a Brep may lie apart, relative to the radius of its sphere."""
BREP_VOLUME: Final = 1e-4
"""How far the volume of a solid in a file may be from that of its part, relative to it: that of
sharply tilted panels is integrated over layers, which converges slowly (2.7e-5 seen)."""
ROUNDED_FILE: Final = 0.01
"""Coordinates of a file rounded by more, in mean edges, are worth a remark (1 cm per m)."""
SINGLE_EPSILON: Final = 1.1920928955078125e-07
"""Spacing of float32 at 1."""
EDGE_MISS: Final = 0.01
"""A trimmed face whose edges lie farther off its surface, in edge lengths, is refused."""
SAME_BOX: Final = 0.01
"""A mesh whose box differs by less from that of a surface, relatively, was made from it."""
CLOSED: Final = 1e-6
"""A surface whose ends lie this close, relative to its size, is closed there."""
ON_EDGE: Final = 1e-12
"""Points of a surface this close to an edge, relative to the surface's size, lie on it."""
SINGLE_IS_ENOUGH: Final = 0.01
"""Share of the error of a triangulation that rounding its points to float32 may add."""

SAME_GEOMETRY: Final = 1e-12
"""Points, curves and axes of a part that lie closer, relative to its size, are written once."""
ROUNDED_PART: Final = 1e-12
"""Last digit of points in a file, relative to the size of their part (1e-9 mm per m)."""

# Warnings of nodes

VERTEX_MISS: Final = 0.01
"""Vertices farther from their sphere than this share of the mean edge are worth a warning."""
FLATTENED: Final = 0.25
"""Spheres of which less than this share of the curvature is left have become nearly planes."""
DEEP_CAP: Final = 0.5235987755982988
"""Caps that open by less (30 degrees) from their middle can be cut as well as planes."""
LITTLE_GAIN: Final = 0.05
"""A relative gain of spheres over planes that is worth saying to be small."""
MOSTLY_EVEN: Final = 0.95
"""Share of edges of nearly the length asked for below which remeshing warns."""
TORSION_FREE: Final = 1e-8
"""Fourth singular value of the spheres around a node, relative to the first, that is none."""
ROUGHER: Final = 1e-3
"""Spheres whose mean angle is larger than that of planes by more, relatively, are rougher."""
WIDER_GAP: Final = 1e-3
"""Gaps that are wider by more than this share of the mean edge are worth a warning."""
DOWNWARD: Final = 0.25
"""Share of the area of a mesh, seen from below, that makes it a roof turned over."""
