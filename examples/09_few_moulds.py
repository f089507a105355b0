"""484 panels, no two alike, made on six moulds (Figs. 13 and 14)."""

from spheremesh.nodes import (
    apply_mobius,
    cluster_radii,
    fit_spheres,
    inversion,
    minimize_angles,
    panels,
    render,
    vase_mesh,
)

net = apply_mobius(vase_mesh(22, 22), inversion(center=(-3.6, -2.7, 1.1), radius=3.0))
smooth = minimize_angles(fit_spheres(net))
angles = smooth.report["angles_deg"]
print(f"{net.n_faces} faces: {angles['planar']['mean']:.2f} degrees between planes,")
print(f"{angles['spherical']['mean']:.2f} between spheres with a radius each")
for count in (12, 6, 3, 1):
    moulds = cluster_radii(smooth.sphere_mesh, count, tolerance=0.05)
    report = moulds.report
    print(
        f"{report['count']:2d} moulds: {report['unrelaxed_angles_deg']['mean']:.2f}, relaxed "
        f"{report['angles_deg']['mean']:.2f}; vertices move {report['vertex_move']:.3f} edges"
    )

moulds = cluster_radii(smooth.sphere_mesh, 6, tolerance=0.05)
cut = panels(moulds.sphere_mesh, labels=moulds.labels)
print(render(cut.panels, "few_moulds.png"))
