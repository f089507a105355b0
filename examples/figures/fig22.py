"""Fig. 22: principal spheres of a face, and the central sphere that bisects their angle."""

import numpy as np
from figure import BLUE, GREEN, GREY, RED, SAND, Figure, View, run

from spheremesh import Mesh
from spheremesh.kernel.meshes.mesh import face_centroids
from spheremesh.kernel.spheres.circles import face_circles
from spheremesh.nodes import central_spheres, principal_spheres, sphere_pairs, vase_mesh
from spheremesh.viewer.shapes import Shape, circle_shape, edge_shape, mesh_shape, sphere_shape


def draw(*, small: bool = False) -> Figure:
    """A face of a vase, where it curves to both sides."""
    net = vase_mesh(12, 8) if small else vase_mesh(20, 12)
    first, second = principal_spheres(net)
    central = central_spheres(net)
    pairs = [sphere_pairs(central.spheres, each.spheres).angles for each in (first, second)]
    miss = float(np.abs(pairs[0] - pairs[1]).max())
    centers = face_centroids(net)
    face = int(np.argmin(np.linalg.norm(centers - [0.6, -1.1, 0.9], axis=1)))
    circles, _ = face_circles(net)
    size = float(np.sqrt(circles.radii_squared[face]))
    middle, normal = centers[face] + circles.centers[face], circles.normals[face]
    around: list[Shape] = [
        circle_shape([middle], [normal], [size], 0.06 * size),
        mesh_shape(Mesh(net.vertices[net.faces[face]], [[0, 1, 2, 3]]), SAND),
        edge_shape(net, 0.012 * size, GREY),
    ]
    spheres = {RED: first, BLUE: second, GREEN: central}

    def view(caption: str, *colors: tuple[int, int, int]) -> View:
        veils = [sphere_shape(spheres[c].spheres[face], c, is_veil=True) for c in colors]
        options = {"direction": np.add(normal, [0.5, 0.2, 0.3]), "frame": net.vertices}
        return View(caption, things=[*around, *veils], options=options)

    return Figure(
        "Fig. 22",
        f"at {net.n_faces} faces the central sphere meets both principal spheres at the same "
        f"angle within {miss:.0e}°.",
        miss < 1e-6,
        [
            view("a principal sphere of a face", RED),
            view("the other principal sphere", BLUE),
            view("the central sphere bisects them", GREEN),
        ],
    )


if __name__ == "__main__":
    run(draw)
