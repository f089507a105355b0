"""The fewest moulds that keep angles below bounds, against every number of moulds.

``python benchmarks/fewest_moulds.py [MESH ...]``: the demo, and files if there are any. Bounds
are spread over what the mesh can reach; `cluster_radii` answers for all k, one by one.
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

warnings.simplefilter("ignore")
for path in (None, *sys.argv[1:]):
    mesh = read_mesh(path) if path else roof_mesh()
    spheres = minimize_angles(fit_spheres(mesh)).sphere_mesh
    angles = [
        cluster_radii(spheres, k, relax=False).report["angles_deg"]
        for k in range(1, mesh.n_faces + 1)
    ]
    means = np.array([each["mean"] for each in angles])
    largest = np.array([each["max"] for each in angles])
    bounds = [float(bound) for bound in np.quantile(means, [0, 0.01, 0.1, 0.5, 1])]
    bounds += [
        float(means[0]) * (1 - share) + float(means.min()) * share for share in (0.5, 0.9)
    ]
    began, found = time.process_time(), []
    for bound in bounds:
        found.append(fewest_moulds(spheres, max_angle=bound).k)
        assert found[-1] == 1 + np.argmax(means <= bound)
    for bound in np.quantile(largest, [0, 0.1, 0.5]):
        k = fewest_moulds(spheres, max_angle_largest=float(bound)).k
        assert k == 1 + np.argmax(largest <= bound)
        both = (means <= means[k - 1]) & (largest <= bound)
        k = fewest_moulds(spheres, float(means[k - 1]), float(bound)).k
        assert k == 1 + np.argmax(both)
    rises = int((np.diff(means) > 0).sum())
    shown = ", ".join(f"{b:.3f}: {k}" for b, k in sorted(zip(bounds, found, strict=True)))
    print(
        f"{path or 'demo'}: {mesh.n_faces} faces; fewest moulds for a mean of {shown} degrees; "
        f"all bounds agree with all k, the mean rises {rises} times; "
        f"{(time.process_time() - began) / 13:.2f} s CPU a search"
    )
