"""How many moulds a roof is worth, and what flat panels save, by the prices of a workshop."""

from pathlib import Path

from spheremesh.nodes import (
    cluster_radii,
    cost,
    cost_curve,
    fewest_moulds,
    fit_spheres,
    flat_panels,
    minimize_angles,
    panels,
    roof_mesh,
)

Path("prices.toml").write_text(
    """currency = "EUR"

[[moulds]]              # the first row that a mould fits is its price
min_radius_m = 5
max_diameter_m = 3
each = 900
per_m2 = 350

[[moulds]]
each = 2400
per_m2 = 800

[blanks]
per_m2 = 95
flat_per_m2 = 45

[panels]
per_m2 = 140
flat_per_m2 = 90
""",
    encoding="utf-8",
)

smooth = minimize_angles(fit_spheres(roof_mesh(12, 20))).sphere_mesh
curve = cost_curve(smooth, "prices.toml", (1, 2, 4, 8, 16), flat_below=20.0, thickness=0.02)
for row, flat in zip(curve["rows"], curve["flat_rows"], strict=True):
    print(
        f"{row['moulds']:4d} moulds: {row['mean_deg']:.2f} degrees, {row['total']:9,.0f} EUR; "
        f"with {flat['flat_panels']} flat panels {flat['mean_deg']:.2f}, {flat['total']:9,.0f}"
    )

fewest = fewest_moulds(smooth, max_angle=1.03 * curve["rows"][-1]["mean_deg"])
print(f"{fewest.k} moulds are within 3 % of the smoothest")
level = flat_panels(smooth, flat_below=20.0)
few = cluster_radii(level.sphere_mesh, fewest.k + 1)  # and the flat one
made = panels(few.sphere_mesh, thickness=0.02, labels=few.labels)
found = cost(made.panels, prices="prices.toml")
print(f"{found['total']:,.0f} {found['currency']}, {found['per_m2']:.0f} a square metre")
for mould in found["moulds"]:
    print(f"  mould {mould['mould']}: {mould['panels']} panels, {mould['cost']:,.0f}")
