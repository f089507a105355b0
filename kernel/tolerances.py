"""
The only home of small numbers.

Every value is relative: to the mean edge of a mesh, to the size of a panel, to the magnitude
of the terms that cancel. None is a length in a unit.
"""

from typing import Final

EPSILON: Final = 2.220446049250313e-16
"""Spacing of float64 at 1."""

DEGENERATE: Final = 1e-10
"""A face of less than this area, relative to its squared perimeter, has no plane."""

PLANE_SAGITTA: Final = 1e-6
"""A panel whose bulge is below this share of its size is built as a plane (1 µm per m)."""

CIRCULAR: Final = 1e-6
"""Faces whose vertices lie this close to a common circle, in mean edges, are circular."""

SAME_PLANE: Final = 1e-6
"""Two spheres that meet at a smaller angle (radians) define no usable circle plane."""

CAP_ANGLE: Final = 1.3962634015954636
"""Half opening (80 degrees) beyond which a spherical cap is refused by CAD kernels."""

ANGLE_STEP: Final = 1e-9
"""An angle minimisation has converged when no unknown moves by more (radians)."""

DAMPING: Final = 1e-12
"""Least damping of a Newton step; its inverse is the largest before a descent is given up."""

ENERGY_ROUNDING: Final = 1e-13
"""Relative rounding of a sum of energies: a rise below it is no rise."""

LINEAR_SOLVE: Final = 1e-6
"""Relative residual to which the linear system of a Newton step is solved."""

APEX_SOLVE: Final = 1e-13
"""Relative residual to which the well conditioned system of smoothed apexes is solved."""

PARALLEL_PLANES: Final = 1e-6
"""Cutting planes that meet at a smaller angle (radians) are in line."""

CROSSING: Final = 1e-9
"""How far from their ends, relative to the half chord, two arcs must meet to cross."""

SAME_CURVATURE: Final = 1e-9
"""Curvatures that differ by less, relative to the sharpest, share a mould without a choice."""

VERTEX_MISS: Final = 0.01
"""Vertices farther from their sphere than this share of the mean edge are worth a warning."""

LITTLE_GAIN: Final = 0.05
"""A relative gain of spheres over planes that is worth saying to be small."""

COINCIDENT: Final = 1e-6
"""Vertices of separate meshes closer than this, in mean edges, are one (1 µm per m)."""
EXACT_BREP: Final = 1e-12
"""How far the parts of a Brep may lie apart, relative to the radius of its sphere."""

LORENTZ: Final = 1e-9
"""How far a transform may miss the Lorentz group, relative to its squared size."""

TRANSFORM_DIGITS: Final = 1e-6
"""A transform whose rotation is rounded by more (radians) is refused."""

AT_INFINITY: Final = 1e-6
"""Vertices this close, in mean edges, to the point sent to infinity have no usable image."""

JET_RANK: Final = 1e-11
"""Squared singular values of a polynomial fit below this, relative to the largest: noise."""

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
