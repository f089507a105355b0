"""What the geometry promises, in figures: gaps, invariance under Möbius maps, equal optima.

python benchmarks/sphere_geometry.py
"""

import warnings

import numpy as np

from spheremesh import Mesh
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.nodes import (
    apply_mobius,
    central_spheres,
    edge_arcs,
    ellipsoid_mesh,
    enneper_mesh,
    face_planes,
    fit_spheres,
    inversion,
    roof_mesh,
    smoothed_spheres,
    torus_mesh,
    vase_mesh,
)


def gaps() -> None:
    """Gaps of central spheres in bisector mode, by the proportions of the torus."""
    for major, minor in ((2.0, 1.0), (2.0, 0.8), (3.0, 1.0)):
        net = torus_mesh(24, 12, major, minor)
        gap = edge_arcs(central_spheres(net), "bisector").gap / mean_edge_length(net)
        print(f"gap, torus {major:g} : {minor:g}  mean {gap.mean():.5f}  max {gap.max():.5f}")


def optimum(net: Mesh) -> float:
    """Energy of the optimum from the central spheres."""
    return minimize_angles(central_spheres(net))[1].energies[-1]


def invariance() -> None:
    """Equal optima from four starts, and before and after an inversion."""
    nets = {
        "vase": vase_mesh(24, 16),
        "enneper": enneper_mesh(),
        "torus": torus_mesh(24, 12),
        "ellipsoid": ellipsoid_mesh(),
        "roof": roof_mesh(),
    }
    for name, net in nets.items():
        starts = (fit_spheres, central_spheres, smoothed_spheres, face_planes)
        energies = [minimize_angles(start(net))[1].energies[-1] for start in starts]
        spread = (max(energies) - min(energies)) / min(energies)
        extent = np.ptp(net.vertices, axis=0)
        center = net.vertices.mean(axis=0) + extent * [3.0, 0.3, 0.7]
        turn = inversion(center=center, radius=float(extent[0]))
        image = apply_mobius(net, turn)
        change = abs(optimum(image) / optimum(net) - 1)
        mapped = apply_mobius(central_spheres(net), turn).spheres
        miss = np.abs(central_spheres(image).spheres - mapped).max()
        print(f"{name:10s}starts {spread:.1e}  inversion {change:.1e}  central {miss:.1e}")


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    gaps()
    invariance()
