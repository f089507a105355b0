"""Fig. 20: a blob of triangles, flat and in spheres, in the reflection of a street."""

import numpy as np
from figure import Figure, View, cut, run

from spheremesh import Mesh
from spheremesh.nodes import face_planes, fit_spheres, minimize_angles, remesh_triangles


def blob(around: int = 72, rings: int = 36) -> Mesh:
    """A bubble that leans over the ground and runs out to one side.

    In the manner of The Blob by M. Fuksas, whose mesh the paper shows and we do not have.
    """
    turn = 2 * np.pi * np.arange(around) / around
    fall = np.radians(104) * np.arange(1, rings + 1)[:, None] / rings
    wide = 1.25 + 0.55 * np.cos(turn) * np.sin(fall) ** 2
    wide = wide + 0.14 * np.cos(2 * turn + 0.6) * np.sin(fall) + 0.1 * np.cos(3 * fall)
    ring = np.stack([np.cos(turn) * np.sin(fall), np.sin(turn) * np.sin(fall)], axis=-1)
    points = np.concatenate([ring, np.broadcast_to(np.cos(fall), wide.shape)[..., None]], -1)
    points *= wide[..., None] * [1.5, 1.0, 1.1]
    ids = 1 + np.arange(around * rings).reshape(rings, around)
    after = np.roll(ids, -1, axis=1)
    cap = [[0, a, b] for a, b in zip(ids[0].tolist(), after[0].tolist(), strict=True)]
    quads = np.stack([ids[:-1], ids[1:], after[1:], after[:-1]], axis=-1).reshape(-1, 4)
    return Mesh(np.vstack([[0, 0, 1.35 * 1.1], points.reshape(-1, 3)]), [*cap, *quads.tolist()])


def draw(*, small: bool = False) -> Figure:
    """Nearly equilateral triangles, with and without lines along their edges."""
    net = remesh_triangles(blob(36, 18) if small else blob(), 0.55 if small else 0.26)
    smooth = minimize_angles(fit_spheres(net))
    angles = smooth.report["angles_deg"]
    flat, spheres = cut(face_planes(net)), cut(smooth.sphere_mesh)
    street = {"shading": "mirror", "direction": (0.45, -1.0, 0.22)}
    views = [
        View(f"{kind}, {lines}", made, options={**street, "edges": lines == "edges"})
        for kind, made in (("flat", flat), ("spheres", spheres))
        for lines in ("edges", "no edges")
    ]
    planar, round_ = angles["planar"]["mean"], angles["spherical"]["mean"]
    return Figure(
        "Fig. 20",
        f"{net.n_faces} triangles meet at {planar:.2f}° on average, spheres on them at "
        f"{round_:.2f}°. The paper shows The Blob by M. Fuksas; this is a form like it.",
        round_ < planar,
        views,
        columns=2,
        shape=0.62,
    )


if __name__ == "__main__":
    run(draw)
