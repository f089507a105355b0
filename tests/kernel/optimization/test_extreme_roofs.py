"""Nearly flat roofs and long faces: optima there too, and never rougher than flat panels."""

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.optimization.energies.table import EnergyWeights
from spheremesh.kernel.optimization.whole_energy import Conditions, optimize_spheres
from spheremesh.kernel.sphere_meshes.fit import fit_spheres

SUPPORT = EnergyWeights(regularity=3.5, support=1.0)


def roof(radius: float, aspect: float) -> Mesh:
    """A paraboloid with curvatures 1 and 0.6 over the radius; faces of 1 by the aspect."""
    ticks = np.arange(7.0) - 3
    x, y = np.meshgrid(ticks, aspect * ticks, indexing="ij")
    z = -(x**2 + 0.6 * y**2) / (2 * radius)
    ids = np.arange(49).reshape(7, 7)
    faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
    return Mesh(np.stack([x, y, z], -1).reshape(-1, 3), faces.reshape(-1, 4))


@pytest.mark.parametrize("tolerance", [0.0, 0.02])
@pytest.mark.parametrize("weights", [EnergyWeights(), SUPPORT], ids=["angles", "support"])
@pytest.mark.parametrize("aspect", [1.0, 20.0])
@pytest.mark.parametrize("radius", [1e2, 1e6, 1e9])
def test_nearly_flat_and_long(
    radius: float, aspect: float, weights: EnergyWeights, tolerance: float
) -> None:
    start, _ = minimize_angles(fit_spheres(roof(radius, aspect)))
    found, report = optimize_spheres(start, weights, Conditions(tolerance=tolerance))
    assert report.converged
    assert report.lowest_eigenvalue >= -1e-8
    optimum, planes = (report.figures[name].mean for name in ("optimum", "planes"))
    assert optimum < planes / 3
    curvatures = -2 * found.local_spheres[:, 0] * radius
    assert (curvatures > 0.5).all()
    assert (curvatures < 1.0).all()
