"""Remeshed congruences are built: panels, beams, and files that other readers open."""

import warnings
from collections import Counter
from functools import cache
from pathlib import Path
from typing import Any

import ezdxf
import pytest
import rhino3dm

from spheremesh.fabrication.step.check import check_part21
from spheremesh.kernel.beams.beams import Beams
from spheremesh.kernel.panels.panels import Panels
from spheremesh.nodes import (
    annulus_support,
    audit,
    beams,
    evolve_spheres,
    p4_remesh,
    panels,
    shifted_rows,
    sphere_congruence,
    support_structure,
    torus_mesh,
    triangulated_surface,
    write_3dm,
    write_dxf,
    write_step,
)
from spheremesh.nodes.library.remesh import Remeshed


@cache
def remeshed_torus(kind: str) -> Remeshed:
    """Spheres of constant radius, or grown towards the curvature spheres."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        if kind == "grown":
            start = shifted_rows(torus_mesh(n_around=64, n_across=20, minor_radius=0.9))
            grown = evolve_spheres(start, max_axis_angle=15)
            return p4_remesh(grown.mesh, grown.spheres, 0.9)
        surface = triangulated_surface("torus", 0.16, seed=1)
        return p4_remesh(surface.mesh, sphere_congruence(surface.mesh, "tangent", -0.5), 0.45)


@cache
def built(kind: str) -> tuple[Panels, Beams, list[Any]]:
    """Panels, beams, and all that was rejected on the way."""
    net = remeshed_torus(kind).sphere_mesh
    cut = panels(net, edges="intersection", thickness=0.02, joint_gap=0.01)
    annuli = annulus_support(net, depth=0.1)
    made = beams(annuli.annuli, thickness=0.02)
    rejected = [r for found in (cut, annuli, made) for r in found.report["rejected"]]
    return cut.panels, made.beams, rejected


@pytest.mark.parametrize("kind", ["constant", "grown"])
def test_law_f8_a_remeshed_torus_has_a_support_structure(kind: str) -> None:
    net, report = remeshed_torus(kind)
    assert report["irregular_nodes"] == report["flipped"] == 0
    assert report["planarized"]["real_nodes"]["after"] == 1
    nodes = support_structure(net).report
    assert nodes["invalid"] == []
    assert nodes["torsion_deg"]["max"] < 1e-5
    assert nodes["axes_without_mirror"] == nodes["edges_without_circle"] == 0


@pytest.mark.parametrize("kind", ["constant", "grown"])
def test_nothing_of_a_remeshed_torus_is_rejected(kind: str) -> None:
    shells, bars, rejected = built(kind)
    mesh = remeshed_torus(kind).sphere_mesh.mesh
    assert rejected == []
    assert shells.n_panels == mesh.n_faces > 60
    assert bars.n_beams == 2 * mesh.n_faces
    assert audit(shells).report["errors"] == []


def test_files_of_a_remeshed_torus_open_elsewhere(tmp_path: Path) -> None:
    shells, bars, _ = built("grown")
    step = write_step(shells, tmp_path / "torus.step", beams=bars)
    assert check_part21(Path(step)) == ()
    model: Any = rhino3dm.File3dm.Read(write_3dm(shells, tmp_path / "torus.3dm", beams=bars))
    solids: list[Any] = [o.Geometry for o in model.Objects if hasattr(o.Geometry, "IsSolid")]
    kinds = Counter(type(solid).__name__ for solid in solids)
    assert kinds == {"Brep": shells.n_panels + bars.n_beams}
    assert all(solid.IsValid for solid in solids)
    reader: Any = ezdxf
    drawing = reader.readfile(write_dxf(bars, tmp_path / "torus.dxf"))
    assert not drawing.audit().errors
    outlines = Counter(item.dxftype() for item in drawing.modelspace())
    assert outlines["LWPOLYLINE"] >= bars.n_beams
