"""What the whole energy promises: support, tolerance, few moulds, targets, strips, scale.

python benchmarks/whole_energy.py cmc1.obj heart.obj complete01.obj conical1.obj
"""

import sys
import warnings
from pathlib import Path

import numpy as np

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import norm
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.sphere_meshes.sphere_mesh import vertex_error
from spheremesh.nodes import (
    apply_mobius,
    beam_tilt,
    central_spheres,
    cluster_radii,
    fit_spheres,
    intersection_angles,
    inversion,
    minimize_angles,
    optimize_spheres,
    read_mesh,
    strip_weights,
    support_structure,
    vase_mesh,
)

TOLERANCES = {"cmc1": 0.02, "heart": 0.05, "complete01": 0.05}


def smooth(mesh: Mesh) -> SphereMesh:
    """Spheres of the smallest angles on a mesh as it is."""
    return minimize_angles(fit_spheres(mesh)).sphere_mesh


def support(name: str, mesh: Mesh) -> None:
    """Torsion, mirror points and tilt after asking for a support."""
    built = optimize_spheres(smooth(mesh), regularity=3.5, support=1)
    nodes = support_structure(built.sphere_mesh)
    tilt = np.percentile(beam_tilt(built.sphere_mesh), 95)
    print(
        f"{name}, support: torsion max {nodes.torsion.max():.2g} degrees, mirror points miss "
        f"{nodes.report['mirror_miss']:.2g} edges, tilt p95 {tilt:.2g} degrees, mean angle "
        f"{built.report['angles_deg']['spherical']['mean']:.3f}, converged "
        f"{built.report['converged']}"
    )
    if name == "vase":
        curvature, central = (
            np.median(np.abs(spheres.local_spheres[:, 0]))
            for spheres in (built.sphere_mesh, central_spheres(mesh))
        )
        print(f"  median curvature is {curvature / central:.2f} of that of central spheres")


def tolerance(name: str, mesh: Mesh, allowed: float) -> None:
    """Angles, moves and misses within a tolerance."""
    found = optimize_spheres(smooth(mesh), tolerance=allowed)
    move = norm(found.sphere_mesh.mesh.vertices - mesh.vertices).max() / mean_edge_length(mesh)
    miss = vertex_error(found.sphere_mesh).max() / mean_edge_length(mesh)
    planar, spherical = (
        found.report["angles_deg"][kind]["mean"] for kind in ("planar", "spherical")
    )
    print(
        f"{name}, tolerance {allowed}: planar {planar:.3f}, spheres {spherical:.3f} degrees, "
        f"corners {found.report['corners']}, converged {found.report['converged']}; vertices "
        f"move {move:.4f} and miss {miss:.2g} edges"
    )


def moulds() -> None:
    """484 faces on few moulds."""
    net = apply_mobius(vase_mesh(22, 22), inversion(center=(-3.6, -2.7, 1.1), radius=3.0))
    start = smooth(net)
    alone = intersection_angles(start).mean()
    for count in (6, 1, 1000):
        few = cluster_radii(start, count)
        radii = np.abs(1 / (2 * few.sphere_mesh.local_spheres[:, 0]))
        report = few.report
        mean = report["angles_deg"]["mean"]
        print(
            f"{net.n_faces} faces, k = {count}: {mean:.3f} degrees, {mean / alone:.4f} of "
            f"{alone:.3f}; radii that differ by a billionth: "
            f"{len(np.unique(np.round(radii, 9)))}; move {report['vertex_move']:.4f}"
        )


def targets() -> None:
    """Sixty degrees between two faces; strips around a vase."""
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0.3], [0, 1, 0.3], [0, 2, 0], [1, 2, 0]]
    pair = fit_spheres(Mesh(points, [[0, 1, 2, 3], [3, 2, 5, 4]]))
    for found in (
        minimize_angles(pair, target_angle=60, sides="both"),
        optimize_spheres(pair, target_angle=60),
    ):
        off = np.abs(intersection_angles(found.sphere_mesh) - 60).max()
        print(f"two faces, target 60 degrees: off by {off:.1e}")
    net = vase_mesh(15, 12)
    weights = strip_weights(net, 0)
    for found in (
        minimize_angles(fit_spheres(net), edge_weights=weights),
        optimize_spheres(fit_spheres(net), edge_weights=weights),
    ):
        rows = found.sphere_mesh.spheres
        off_axis = norm(rows[:, 1:3]) / (2 * np.abs(rows[:, 0]))
        angles = intersection_angles(found.sphere_mesh)[weights > 0]
        print(f"strips: {angles.max():.1e} degrees, centres {off_axis.max():.1e} off the axis")


def scales() -> None:
    """The pipeline in other units and far away."""
    net = vase_mesh(15, 15)

    def _angles(mesh: Mesh) -> np.ndarray:
        built = optimize_spheres(smooth(mesh), regularity=3.5, support=1)
        return intersection_angles(built.sphere_mesh)

    here = _angles(net)
    for scale, shift in ((0.1, 0.0), (10.0, 0.0), (1000.0, 0.0), (1.0, 1e6)):
        away = Mesh(scale * net.vertices + shift * mean_edge_length(net), net.faces)
        off = np.abs(_angles(away) - here).max()
        print(f"scale {scale:g}, {shift:g} edges away: angles differ by {off:.1e} degrees")


def main(paths: list[str]) -> None:
    """Print the figures."""
    warnings.simplefilter("ignore")
    support("vase", vase_mesh(15, 15))
    for path in map(Path, paths):
        if path.stem in TOLERANCES:
            tolerance(path.stem, read_mesh(path), TOLERANCES[path.stem])
        else:
            support(path.stem, read_mesh(path))
    moulds()
    targets()
    scales()


if __name__ == "__main__":
    main(sys.argv[1:])
