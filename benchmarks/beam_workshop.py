"""What the workshop's side of beams costs, and how exact its files are.

    python benchmarks/beam_workshop.py [MESH ...]

Without meshes, on a torus and a vase. For each: processor time per beam for measures, audit,
schedule and marks, what node cylinders and axes add to STEP and .3dm; cylinders read back
from STEP against their closed forms; holes read back from DXF against the kernel. Depth 0.3,
thickness 0.05, node radius 0.1, gap 0.01, holes of 0.03 mean edges.
"""

import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import ezdxf
import numpy as np
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer

from spheremesh import SphereMesh
from spheremesh.fabrication.audit.report import audit_model
from spheremesh.fabrication.model import Model
from spheremesh.fabrication.rhino_models.writer import write_3dm
from spheremesh.fabrication.schedules.writer import write_schedule
from spheremesh.fabrication.step.writer import write_step
from spheremesh.kernel.beams.beams import Beams
from spheremesh.kernel.beams.drilling import drill_beams
from spheremesh.kernel.beams.facts import beam_facts
from spheremesh.kernel.beams.node_cylinders import node_cylinders
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.nodes import (
    annulus_support,
    beams,
    central_spheres,
    fit_spheres,
    minimize_angles,
    read_mesh,
    torus_mesh,
    vase_mesh,
    write_dxf,
)

T = TypeVar("T")


def timed(call: Callable[[], T]) -> tuple[T, float]:
    """Result and processor time in milliseconds."""
    start = time.process_time()
    return call(), 1000 * (time.process_time() - start)


def read_volumes(path: Path) -> tuple[list[float], int]:
    """Volumes of the solids in a STEP file, and how many OpenCASCADE finds valid."""
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    found = TopExp_Explorer(reader.OneShape(), TopAbs_ShapeEnum.TopAbs_SOLID)
    volumes: list[float] = []
    valid = 0
    while found.More():
        properties = GProp_GProps()
        BRepGProp.VolumeProperties_s(found.Current(), properties, 1e-10)
        volumes.append(properties.Mass())
        valid += BRepCheck_Analyzer(found.Current()).IsValid()
        found.Next()
    return volumes, valid


def report_files(made: Beams, folder: Path) -> None:
    """Print what cylinders, axes and marks add to files, and how exact they come back."""
    count, nodes = made.n_beams, node_cylinders(made)
    plain = replace(made, node_radius=0.0, marks=None)
    for name, write in (("STEP", write_step), ("Rhino", write_3dm)):
        suffix = ".step" if name == "STEP" else ".3dm"
        _, bare = timed(lambda: write(Model(beams=plain), folder / f"p{suffix}"))  # noqa: B023
        _, full = timed(lambda: write(Model(beams=made), folder / f"f{suffix}"))  # noqa: B023
        sizes = [(folder / f"{kind}{suffix}").stat().st_size / 1e6 for kind in "pf"]
        print(
            f"  {name}: {bare / count:.2f} ms per beam and {sizes[0]:.1f} MB; with "
            f"{nodes.n_nodes} cylinders and marks {full / count:.2f} ms and {sizes[1]:.1f} MB"
        )
    volumes, valid = read_volumes(folder / "f.step")
    exact = 1e9 * np.pi * nodes.radius**2 * nodes.heights
    error = np.abs(np.array(volumes[count:]) / exact - 1).max()
    print(f"  read back: {valid} of {len(volumes)} solids valid, cylinders within {error:.1e}")
    _, ms = timed(lambda: write_dxf(made, str(folder / "b.dxf")))
    drawing = ezdxf.readfile(folder / "b.dxf")  # pyright: ignore
    holes = len(drawing.modelspace().query("CIRCLE"))
    print(f"  DXF: {ms / count:.2f} ms, {holes} holes, {len(drawing.audit().errors)} errors")


def report(name: str, sphere_mesh: SphereMesh) -> None:
    """Print the figures of one sphere mesh."""
    size = mean_edge_length(sphere_mesh.mesh)
    found = annulus_support(sphere_mesh, depth=0.3 * size)
    cut = beams(found.annuli, 0.05 * size, node_gap=0.01 * size, node_radius=0.1 * size)
    made, count = cut.beams, cut.beams.n_beams
    refusals = [len(each.report["rejected"]) for each in (found, cut)]
    print(f"{name}: {count} beams, {refusals[0]} without annulus, {refusals[1]} without cut")
    (made, refused), marking = timed(lambda: drill_beams(made, 2, 0.03 * size, 0.05 * size))
    _, measuring = timed(lambda: beam_facts(made))
    findings, auditing = timed(lambda: audit_model(Model(beams=made)))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder)
        _, table = timed(lambda: write_schedule(Model(beams=made), path / "b.csv").path)
        _, rows = timed(lambda: write_schedule(Model(beams=made), path / "b.json").path)
        print(
            f"  marks {marking / count:.3f} ms ({len(refused)} refused), measures "
            f"{measuring / count:.3f}, audit {auditing / count:.3f} ({len(findings)} "
            f"findings), schedule {table / count:.3f} .csv, {rows / count:.3f} .json"
        )
        report_files(made, path)


def main() -> None:
    """Figures of all nets."""
    warnings.simplefilter("ignore")
    meshes = [(Path(path).name, read_mesh(path)) for path in sys.argv[1:]]
    if meshes:
        for name, mesh in meshes:
            report(name, minimize_angles(fit_spheres(mesh)).sphere_mesh)
        return
    report("torus", central_spheres(torus_mesh(24, 12)))
    report("vase", central_spheres(vase_mesh(24, 12)))


if __name__ == "__main__":
    main()
