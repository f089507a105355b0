"""The fewest moulds that keep angles below bounds, against every smaller number of moulds.

``python benchmarks/fewest_moulds.py [MESH ...]``: the demo, and files if there are any. Bounds
lie between the angles with one mould and with many; `cluster_radii` answers for every number
up to the one found, one by one: all smaller ones must break a bound.
"""

import sys
import time
import warnings

import numpy as np

from spheremesh.nodes import (
    cluster_radii,
    fewest_moulds,
    fit_spheres,
    minimize_angles,
    read_mesh,
    roof_mesh,
)

MOST = 60
"""Numbers of moulds that are tried one by one."""

warnings.simplefilter("ignore")
for path in (None, *sys.argv[1:]):
    mesh = read_mesh(path) if path else roof_mesh()
    spheres = minimize_angles(fit_spheres(mesh)).sphere_mesh
    angles = [
        cluster_radii(spheres, k, relax=False).report["angles_deg"] for k in range(1, MOST + 1)
    ]
    means = np.array([each["mean"] for each in angles])
    largest = np.array([each["max"] for each in angles])
    asked: list[tuple[float, float]] = []
    for share in (0.0, 0.3, 0.6, 0.8, 0.9, 0.95, 1.0):
        mean = float(means[0] + share * (means.min() - means[0]))
        most = float(largest[0] + share * (largest.min() - largest[0]))
        asked += [(mean, 180.0), (180.0, most)]
        if ((means <= mean) & (largest <= most)).any():
            asked.append((mean, most))
    began, found = time.process_time(), []
    for mean, most in asked:
        k = fewest_moulds(spheres, max_angle=mean, max_angle_largest=most).k
        assert k == 1 + np.argmax((means <= mean) & (largest <= most)), (mean, most, k)
        found.append(f"{mean:.3f}/{most:.3f}: {k}")
    seconds = (time.process_time() - began) / len(asked)
    rises = int((np.diff(means) > 0).sum())
    print(
        f"{path or 'demo'}: {mesh.n_faces} faces; mean/largest: moulds {', '.join(found)}; "
        f"{len(asked)} searches agree with all numbers up to {MOST}, between which the mean "
        f"rises {rises} times; {seconds:.2f} s CPU a search",
        flush=True,
    )
