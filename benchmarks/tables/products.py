"""What comes out: smoothness, files beside those of CadQuery, large patterns, whole jobs."""

import importlib
import tempfile
import time
from pathlib import Path
from typing import Any

from hexagons import shifted_grid, torus
from measure import Table, measured

from spheremesh import nodes
from spheremesh.interfaces.panel import PanelOptions, panel_graph, run_job
from spheremesh.kernel.panels.panels import Panels


def smoothness(*, is_quick: bool) -> list[Table]:
    """Mean angles of planes, spheres, and spheres of 8 moulds."""
    nets = {
        "Roof": nodes.roof_mesh, "Ellipsoid": nodes.ellipsoid_mesh, "Vase": nodes.vase_mesh,
        "Torus": nodes.torus_mesh, "Enneper": nodes.enneper_mesh,
    }  # fmt: skip
    rows: list[tuple[Any, ...]] = []
    for name in list(nets)[: 1 if is_quick else None]:
        optimum = nodes.minimize_angles(nodes.fit_spheres(nets[name]()))
        clusters = nodes.cluster_radii(optimum.sphere_mesh, k=8)
        angles = optimum.report["angles_deg"]
        means = angles["planar"], angles["spherical"], clusters.report["angles_deg"]
        rows.append((name, optimum.sphere_mesh.mesh.n_faces, *(each["mean"] for each in means)))
    return [
        Table(
            "Smoothness",
            "Mean angle between neighbouring panels in degrees, on the library's own nets.",
            ("Net", "Faces", "Planes", "Spheres", "8 moulds"),
            rows,
        )
    ]


def roof_panels(rows: int) -> Panels:
    """Panels of a square roof in 8 moulds."""
    optimum = nodes.minimize_angles(nodes.fit_spheres(nodes.roof_mesh(rows, rows)))
    clusters = nodes.cluster_radii(optimum.sphere_mesh, k=8)
    return nodes.panels(clusters.sphere_mesh, labels=clusters.labels, thickness=0.02).panels


def file_row(name: str, rows: int) -> tuple[int, float, float]:
    """Panels, seconds and megabytes of one way to write all panels as solids."""
    made = roof_panels(rows)
    if name == "cadquery":
        importlib.import_module("cadquery")  # before the clock
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / ("model.3dm" if name == "write_3dm" else "panels.step")
        began = time.process_time()
        if name == "write_3dm":
            nodes.write_3dm(made, path)
        elif name == "write_step":
            nodes.write_step(made, path)
        else:
            nodes.write_step(made, path, engine="cadquery")
        return made.n_panels, time.process_time() - began, path.stat().st_size / 1e6


def files(*, is_quick: bool) -> list[Table]:
    """Solids as STEP and .3dm, beside CadQuery and OpenCASCADE."""
    rows: list[tuple[Any, ...]] = []
    for count in (7,) if is_quick else (22, 71):
        first = 0.0
        for name, shown in (
            ("write_step", "STEP by `write_step`"),
            ("cadquery", "STEP by CadQuery's Assembly"),
            ("write_3dm", ".3dm by `write_3dm`"),
        ):
            (n_panels, seconds, size), peak = measured(file_row, name, count)
            first = first or seconds
            rows.append((n_panels, shown, seconds, seconds / first, size, peak))
    return [
        Table(
            "Files of solids",
            "Panels with a thickness in 8 moulds. CadQuery builds its solids from ours and "
            "writes by OpenCASCADE with names, colours and layers (`write_step(engine="
            '"cadquery")`).',
            ("Panels", "File", "Seconds", "Ratio", "MB", "GB"),
            rows,
        )
    ]


def pattern_row(kind: str, size: int) -> tuple[int, int, float]:
    """Triangles, panels and seconds of a pattern from a triangulated torus."""
    for count in (16, size):
        mesh = shifted_grid(torus, 2 * count, count, closed=True, outside=False)
        began = time.process_time()
        if kind == "hexagons":
            grown = nodes.evolve_spheres(mesh, 15.0)
            made = nodes.tangent_sphere_shex(grown.mesh, grown.spheres).sphere_mesh.mesh
        else:
            spheres = nodes.sphere_congruence(mesh)
            made = nodes.p4_remesh(mesh, spheres, 0.25).sphere_mesh.mesh
        seconds = time.process_time() - began
    return mesh.n_faces, made.n_faces, seconds


def patterns(*, is_quick: bool) -> list[Table]:
    """Hexagons and quads with torsion-free nodes from large triangle meshes."""
    rows: list[tuple[Any, ...]] = []
    for kind, shown in (("hexagons", "Hexagons"), ("quads", "Quads (P4 remeshing)")):
        for size in (24,) if is_quick else (71, 158):
            (n_triangles, n_faces, seconds), peak = measured(pattern_row, kind, size)
            rows.append((shown, n_triangles, n_faces, seconds, peak))
    return [
        Table(
            "Patterns from large meshes",
            "A torus of triangles to hexagonal tangent sphere meshes, and to quads of the "
            "orthogonal congruence's net.",
            ("Pattern", "Triangles", "Panels", "Seconds", "GB"),
            rows,
        )
    ]


def job_row(rows: int, *, has_support: bool) -> tuple[int, dict[str, float], float]:
    """Panels, seconds by step, and all seconds of `spheremesh panel` with all files."""
    mesh = nodes.roof_mesh(rows, rows)
    with tempfile.TemporaryDirectory() as name:
        source = Path(name) / "roof.obj"
        nodes.write_mesh(mesh, source)
        options = PanelOptions(
            mesh=source, thickness=0.02, moulds=8, support="axis" if has_support else None,
            depth=0.25,
        )  # fmt: skip
        began, last = time.process_time(), time.process_time()
        steps: dict[str, float] = {}

        def _note(step: str, state: str, *_: object) -> None:
            nonlocal last
            now = time.process_time()
            if state in ("done", "cached"):
                steps[step] = steps.get(step, 0.0) + now - last
            last = now

        run_job(panel_graph(options), Path(name) / "out", _note)
        return mesh.n_faces, steps, time.process_time() - began


def jobs(*, is_quick: bool) -> list[Table]:
    """The command `panel`, end to end."""
    tables: list[Table] = []
    for has_support in (False, True):
        found = [
            measured(_job, rows, has_support) for rows in ((10,) if is_quick else (10, 38, 71))
        ]
        longest = found[-1][0][1]
        steps = sorted(longest, key=lambda step: -longest[step])
        rows: list[tuple[Any, ...]] = [
            (step, *(steps_of.get(step, 0.0) for (_, steps_of, _), _ in found))
            for step in steps
            if longest[step] > 0.005 * sum(longest.values())
        ]
        rows.append(("all", *(total for (_, _, total), _ in found)))
        rows.append(("GB", *(peak for _, peak in found)))
        how = "with beams and their audit" if has_support else "without beams"
        tables.append(
            Table(
                f"`spheremesh panel`, {how}",
                "A roof in 8 moulds with a thickness to all files; seconds by step.",
                ("Step", *(f"{n_faces} panels" for (n_faces, _, _), _ in found)),
                rows,
            )
        )
    return tables


def _job(rows: int, has_support: bool) -> tuple[int, dict[str, float], float]:  # noqa: FBT001
    return job_row(rows, has_support=has_support)
