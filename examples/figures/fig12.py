"""Fig. 12: the same surface in planes, in as many spheres, and in a quarter as many."""

from figure import Figure, View, cut, run

from spheremesh.nodes import ellipsoid_mesh, face_planes, fit_spheres, minimize_angles


def draw(*, small: bool = False) -> Figure:
    """An ellipsoid at two levels of detail."""
    n, m = (16, 10) if small else (40, 24)
    fine, coarse = (
        minimize_angles(fit_spheres(ellipsoid_mesh(n // k, m // k))) for k in (1, 2)
    )
    flat = fine.report["angles_deg"]["planar"]["mean"]
    angles = [each.report["angles_deg"]["spherical"]["mean"] for each in (fine, coarse)]
    zebra = {"shading": "zebra"}
    return Figure(
        "Fig. 12",
        f"{n * m} planes meet at {flat:.2f}° on average, {n * m} spheres at {angles[0]:.2f}°, "
        f"and {n * m // 4} spheres at {angles[1]:.2f}°.",
        max(angles) < flat,
        [
            View(f"{n * m} planes", cut(face_planes(fine.sphere_mesh.mesh)), options=zebra),
            View(f"{n * m} spheres", cut(fine.sphere_mesh), options=zebra),
            View(f"{n * m // 4} spheres", cut(coarse.sphere_mesh), options=zebra),
        ],
    )


if __name__ == "__main__":
    run(draw)
