"""How fast, how large, how smooth: one line per figure.

Seconds are those of this machine now, and noisy: what counts are the ratios, taken within one
run, and the sizes of files. Every stage runs in a process of its own, so that its memory is
its own.
"""

import itertools
import json
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

Figures = dict[str, float]


def optimise(n_span: int, n_length: int) -> Figures:
    """Net, start and angle minimisation of a roof."""
    from spheremesh.kernel.optimization.angle_minimization import minimize_angles
    from spheremesh.kernel.sphere_meshes.fit import fit_spheres
    from spheremesh.nodes import roof_mesh

    minimize_angles(fit_spheres(roof_mesh(4, 4)))  # load scipy outside of the clock
    times = [time.process_time()]
    mesh = roof_mesh(n_span, n_length)
    times.append(time.process_time())
    start = fit_spheres(mesh)
    times.append(time.process_time())
    _, report = minimize_angles(start)
    times.append(time.process_time())
    net, fit, angles = (b - a for a, b in itertools.pairwise(times))
    return {
        "faces": mesh.n_faces, "net_s": net, "fit_s": fit, "angles_s": angles,
        "all_s": times[-1] - times[0], "newton_steps": sum(report.iterations),
    }  # fmt: skip


def write(kind: str) -> Figures:
    """One file of 5,000 panels."""
    from spheremesh.fabrication.model import Model
    from spheremesh.fabrication.rhino_models.writer import RhinoOptions, write_3dm
    from spheremesh.fabrication.step.writer import write_step
    from spheremesh.nodes import cluster_radii, fit_spheres, minimize_angles, panels, roof_mesh

    optimum = minimize_angles(fit_spheres(roof_mesh(50, 100)))
    clusters = cluster_radii(optimum.sphere_mesh, k=8)
    cut = panels(clusters.sphere_mesh, thickness=0.02, labels=clusters.labels).panels
    path = Path(tempfile.mkdtemp()) / ("panels.step" if kind == "step" else "model.3dm")
    began = time.process_time()
    if kind == "step":
        write_step(Model(cut), path)
    else:
        write_3dm(Model(cut), path, RhinoOptions(render_meshes=kind == "3dm"))
    return {
        "panels": cut.n_panels,
        "write_s": time.process_time() - began,
        "mb": path.stat().st_size / 1e6,
    }


def smoothness() -> Figures:
    """Mean angles in degrees: planes, spheres, spheres of 8 moulds."""
    from spheremesh import nodes

    nets = {
        "roof": nodes.roof_mesh(),
        "ellipsoid": nodes.ellipsoid_mesh(),
        "vase": nodes.vase_mesh(),
        "torus": nodes.torus_mesh(),
        "enneper": nodes.enneper_mesh(),
    }
    figures: Figures = {}
    for name, net in nets.items():
        optimum = nodes.minimize_angles(nodes.fit_spheres(net))
        clusters = nodes.cluster_radii(optimum.sphere_mesh, k=8)
        angles = optimum.report["angles_deg"]
        figures[f"{name}_planes"] = angles["planar"]["mean"]
        figures[f"{name}_spheres"] = angles["spherical"]["mean"]
        figures[f"{name}_8_moulds"] = clusters.report["angles_deg"]["mean"]
    return figures


STAGES: dict[str, Callable[[], Figures]] = {
    "smoothness": smoothness,
    "optimise_5k": lambda: optimise(50, 100),
    "optimise_50k": lambda: optimise(160, 320),
    "optimise_500k": lambda: optimise(500, 1000),
    "step_5k": lambda: write("step"),
    "3dm_5k": lambda: write("3dm"),
    "3dm_5k_bare": lambda: write("3dm without render meshes"),
}


def main() -> None:
    """Run one stage, or each in its own process."""
    if len(sys.argv) > 1:
        import warnings

        warnings.simplefilter("ignore")
        figures = STAGES[sys.argv[1]]()
        figures["peak_gb"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
        print(json.dumps(figures))
        return
    results: dict[str, Figures] = {}
    for stage in STAGES:
        command = [sys.executable, __file__, stage]
        output = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        results[stage] = json.loads(output.splitlines()[-1])
        line = "  ".join(f"{name} {value:.4g}" for name, value in results[stage].items())
        print(f"{stage:16s}{line}", flush=True)
    for small, large in (("optimise_5k", "optimise_50k"), ("optimise_50k", "optimise_500k")):
        faces = results[large]["faces"] / results[small]["faces"]
        seconds = results[large]["all_s"] / results[small]["all_s"]
        print(f"{large} / {small}: {faces:.1f} times the faces, {seconds:.1f} times the time")


if __name__ == "__main__":
    main()
