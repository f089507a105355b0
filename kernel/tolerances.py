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

UNIT_ROW: Final = 1e-9
"""How far a row's norm may be from 1 and still count as unit."""

PLANE_SAGITTA: Final = 1e-6
"""A panel whose bulge is below this share of its size is built as a plane (1 µm per m)."""

CIRCULAR: Final = 1e-6
"""Faces whose vertices lie this close to a common circle, in mean edges, are circular."""

SAME_PLANE: Final = 1e-6
"""Two spheres that meet at a smaller angle (radians) define no usable circle plane."""

CAP_ANGLE: Final = 1.3962634015954636
"""Half opening (80 degrees) beyond which a spherical cap is refused by CAD kernels."""

GRADIENT: Final = 1e-11
"""An angle minimisation has converged when the largest torque per face falls below this."""

PARALLEL_PLANES: Final = 1e-6
"""Cutting planes that meet at a smaller angle (radians) are in line."""

CROSSING: Final = 1e-9
"""How far from their ends, relative to the half chord, two arcs must meet to cross."""

EXACT_BREP: Final = 1e-12
"""How far the parts of a Brep may lie apart, relative to the radius of its sphere."""
