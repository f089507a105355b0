"""A roof drawn in metres, millimetres and feet gives the same millimetres in every file."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import ezdxf
import numpy as np
import pytest
import rhino3dm

from spheremesh import Mesh, SphereMesh
from spheremesh.fabrication.drawings.beams import write_dxf
from spheremesh.fabrication.drawings.moulds import write_mould_drawings
from spheremesh.fabrication.model import Model
from spheremesh.fabrication.rhino_models.writer import RhinoOptions, write_3dm
from spheremesh.fabrication.schedules.panels import panel_tables
from spheremesh.fabrication.step.writer import write_step
from spheremesh.fabrication.units import millimeters_per
from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.beams.beams import Beams
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.optimization.energies.table import EnergyWeights
from spheremesh.kernel.optimization.radius_clustering import cluster_radii
from spheremesh.kernel.optimization.whole_energy import Conditions, optimize_spheres
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.panels import Panels
from spheremesh.kernel.remesh.planar.landing import planarize_near
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import fit_spheres
from spheremesh.kernel.spheres.rows import rescale
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import roof_net

PRECISION = 1e-9
"""Of the largest number in a file."""


class Job(NamedTuple):
    """Panels and beams, and the unit they are in."""

    panels: Panels
    beams: Beams
    units: str


@pytest.fixture(scope="module")
def jobs() -> list[Job]:
    """From the mesh on, every step is done in the unit."""
    return [roof("m", 1.0), roof("mm", 1000.0), roof("ft", 1 / 0.3048)]


def roof(units: str, scale: float) -> Job:
    net = roof_net(6, 7, 30.0)
    found = minimize_angles(fit_spheres(Mesh(scale * net.vertices, net.faces)))[0]
    beams = cut_beams(annulus_support(found, 0.4 * scale).annuli, 0.05 * scale, 0.01 * scale)[0]
    assert beams.n_beams > 20
    found, clusters = cluster_radii(found, 3)
    lengths = 0.05 * scale, 0.01 * scale
    panels = cut_panels(found, "bisector", *lengths, clusters.labels, "centred")[0]
    assert panels.n_panels == 42
    return Job(panels, beams, units)


def test_landed_nodes_are_the_same_in_all_units() -> None:
    """Neighbours that are nearly one sphere hardly say where their nodes shall be."""
    net = roof_net(16, 40, 60.0)
    start = minimize_angles(central_spheres(net))[0]
    weights = EnergyWeights(regularity=3.5, support=1.0)
    optimum = optimize_spheres(start, weights, Conditions())[0]
    found = [landed(optimum, scale) for scale in (1.0, 1000.0, 1 / 0.3048)]
    for vertices, rows in found[1:]:
        assert np.abs(vertices - found[0][0]).max() < PRECISION * np.abs(vertices).max()
        np.testing.assert_allclose(rows, found[0][1], atol=1e-8)


def landed(optimum: SphereMesh, scale: float) -> tuple[FloatArray, FloatArray]:
    """Vertices, and spheres in mean edges, that land in other units."""
    mesh = Mesh(scale * optimum.mesh.vertices, optimum.mesh.faces)
    start = SphereMesh.from_local(mesh, rescale(optimum.local_spheres, scale))
    result, is_near = planarize_near(start, 0.05)
    assert is_near
    edge = mean_edge_length(result.sphere_mesh.mesh)
    rows = rescale(result.sphere_mesh.local_spheres, 1 / edge)
    return result.sphere_mesh.mesh.vertices / scale, rows


def numbers(values: Any) -> list[float]:  # noqa: ANN401
    """All numbers in nested rows, in order."""
    if isinstance(values, dict):
        values = list(values.values())
    if isinstance(values, list):
        return [x for value in values for x in numbers(value)]
    return [float(values)] if isinstance(values, int | float) else []


def schedule(job: Job, _: Path) -> FloatArray:
    return np.array(numbers([panel_tables(job.panels, job.units)["Panels"]]))


def moulds(job: Job, _: Path) -> FloatArray:
    return np.array(numbers([panel_tables(job.panels, job.units)["Moulds"]]))


def step(job: Job, folder: Path) -> FloatArray:
    path = write_step(Model(job.panels, job.beams, job.units), folder / "p.step").path
    text = path.read_text("ascii").replace("\n", "")
    points = re.findall(r"CARTESIAN_POINT\('',\(([^)]*)\)\)", text)
    radii = re.findall(
        r"(?:SPHERICAL_SURFACE|CIRCLE|CYLINDRICAL_SURFACE)\('',#\d+,([^)]*)", text
    )
    return np.array([float(x) for x in ",".join([*points, *radii]).split(",")])


def rhino(job: Job, folder: Path) -> FloatArray:
    """Corners and radii of everything, in millimetres."""
    contents = RhinoOptions(layers=("Edges", "Centres", "Moulds"))
    path = write_3dm(Model(job.panels, job.beams, job.units), folder / "p.3dm", contents).path
    model: Any = rhino3dm.File3dm.Read(str(path))
    found: list[float] = []
    for item in model.Objects:
        geometry = item.Geometry
        if isinstance(geometry, rhino3dm.Brep):
            found += [x for v in geometry.Vertices for x in coordinates(v.Location)]
        elif isinstance(geometry, rhino3dm.ArcCurve):
            found += [geometry.Radius, *coordinates(geometry.PointAtStart)]
        elif isinstance(geometry, rhino3dm.LineCurve):
            found += [*coordinates(geometry.PointAtStart), *coordinates(geometry.PointAtEnd)]
        elif isinstance(geometry, rhino3dm.InstanceReference):
            found += [getattr(geometry.Xform, f"M{i}3") for i in range(3)]
        else:
            found += coordinates(geometry.Location)
    scale = millimeters_per(job.units)
    assert model.Settings.ModelAbsoluteTolerance * scale == pytest.approx(0.01)
    return scale * np.array(found)


def coordinates(point: Any) -> list[float]:  # noqa: ANN401
    return [point.X, point.Y, point.Z]


def cutting(job: Job, folder: Path) -> FloatArray:
    """Rings from their lower left corner: where they lie on the sheet is of no matter."""
    path = write_dxf(Model(beams=job.beams, units=job.units), folder / "b.dxf").path
    found: list[FloatArray] = []
    for ring in ezdxf.readfile(path).modelspace().query("LWPOLYLINE[layer=='CUT']"):
        points = np.array(list(ring.get_points("xyb")))
        found.append((points - [*points[:, :2].min(0), 0]).ravel())
    return np.concatenate(found)


def drawing(job: Job, folder: Path) -> FloatArray:
    path = write_mould_drawings(Model(job.panels, units=job.units), folder / "m.dxf").path
    model = ezdxf.readfile(path).modelspace()
    rings = [np.array(list(each.get_points("xy"))) for each in model.query("LWPOLYLINE")]
    rims = [[*each.dxf.center, each.dxf.radius] for each in model.query("CIRCLE")]
    return np.concatenate([*(ring.ravel() for ring in rings), np.ravel(rims)])


FILES: list[Callable[[Job, Path], FloatArray]] = [
    schedule, moulds, step, rhino, cutting, drawing,
]  # fmt: skip


@pytest.mark.parametrize("read", FILES)
def test_law_millimetres_are_the_same_in_every_unit(
    jobs: list[Job], tmp_path: Path, read: Callable[[Job, Path], FloatArray]
) -> None:
    first, *others = (read(job, tmp_path) for job in jobs)
    assert len(first) > 10
    for other in others:
        assert len(other) == len(first)
        assert np.abs(other - first).max() < PRECISION * np.abs(first).max()
