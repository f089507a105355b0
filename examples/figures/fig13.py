"""Fig. 13: three line lights mirrored in spheres of all radii, of six radii, and in planes."""

from figure import Figure, View, cut, run

from spheremesh.nodes import cluster_radii, face_planes, fit_spheres, minimize_angles, roof_mesh


def draw(*, small: bool = False) -> Figure:
    """A roof of 484 faces."""
    net = roof_mesh(8, 8, 24.0) if small else roof_mesh(22, 22, 24.0)
    smooth = minimize_angles(fit_spheres(net))
    six = cluster_radii(smooth.sphere_mesh, 6, tolerance=0.02)
    flat = smooth.report["angles_deg"]["planar"]["mean"]
    free = smooth.report["angles_deg"]["spherical"]["mean"]
    few = six.report["angles_deg"]["mean"]
    lamps = {"shading": "lamps", "direction": (0.5, -0.8, 0.9)}
    return Figure(
        "Fig. 13",
        f"{net.n_faces} spheres of as many radii meet at {free:.2f}° on average, on six radii "
        f"at {few:.2f}°, planes at {flat:.2f}°.",
        free < flat and few < flat,
        [
            View("every sphere its own radius", cut(smooth.sphere_mesh), options=lamps),
            View("spheres of six radii", cut(six.sphere_mesh), options=lamps),
            View("planes", cut(face_planes(net)), options=lamps),
        ],
        shape=0.75,
    )


if __name__ == "__main__":
    run(draw)
