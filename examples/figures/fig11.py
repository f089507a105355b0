"""Fig. 11: spheres through the circles of faces and apexes that Laplacian smoothing places."""

import numpy as np
from figure import SAND, Figure, View, cut, drawn_mesh, run

from spheremesh import Mesh
from spheremesh.nodes import face_planes, intersection_angles, smoothed_spheres, vase_mesh


def draw(*, small: bool = False) -> Figure:
    """A vase: the net, its faces with apexes, its spheres."""
    net = vase_mesh(14, 8) if small else vase_mesh(24, 14)
    smooth = smoothed_spheres(net)
    flat = intersection_angles(smooth, reference="planes").mean()
    angle = intersection_angles(smooth).mean()
    centers, radii = smooth.centers, smooth.radii
    corners = net.vertices[net.corners].reshape(-1, 4, 3)
    out = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    out /= np.linalg.norm(out, axis=1)[:, None]
    side = np.sign(((corners.mean(axis=1) - centers) * out).sum(axis=1))[:, None]
    apexes = centers + side * radii[:, None] * out
    tops = net.n_vertices + np.arange(net.n_faces)
    following = net.corners[net.topology.next_corners]
    tents = Mesh(
        np.concatenate([net.vertices, apexes]),
        np.stack([net.corners, following, np.repeat(tops, 4)], axis=1),
    )
    return Figure(
        "Fig. 11",
        f"{net.n_faces} spheres meet at {angle:.2f}° on average, the planes of the circular "
        f"mesh at {flat:.2f}°.",
        bool(angle < flat),
        [
            View("a circular mesh", cut(face_planes(net))),
            View("apexes above the faces, smoothed", things=drawn_mesh(tents, SAND)),
            View("spheres through circles and apexes", cut(smooth)),
        ],
    )


if __name__ == "__main__":
    run(draw)
