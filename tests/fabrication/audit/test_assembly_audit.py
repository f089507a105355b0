"""Planted faults of an assembly: each is found, by its code, on the parts that have it."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from spheremesh import SphereMesh
from spheremesh.fabrication.audit.report import audit_model
from spheremesh.fabrication.audit.subjects import AuditLimits
from spheremesh.fabrication.model import Model
from spheremesh.kernel.arrays import FloatArray, unit
from spheremesh.kernel.beams.beams import Beams, scale_beams
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.beams.layers import beams_under_panels
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.panels import Panels, corner_points, scale_panels
from spheremesh.kernel.parts.findings import Finding
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.model_change import change_model
from spheremesh.kernel.spheres.rows import normalize, offset
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net

LIMITS = AuditLimits(step_mm=1, gap_mm=1)
NET = ellipsoid_net(10, 6, 3.0, 4.5, np.radians(70))
SPHERES = change_model(NET, "hyperbolic", 12.0, np.zeros(3), "inner")
Fault = Callable[[Panels, Beams], tuple[Panels, Beams]]


@cache
def assembly(joint: float = 0.004, radius: float = 0.0) -> tuple[Panels, Beams]:
    """An ellipsoid of exact nodes, in metres: panels of 12 mm on beams of 20 mm."""
    panels, refused = cut_panels(SPHERES, "intersection", 0.012, joint)
    annuli = annulus_support(SPHERES, depth=0.12).annuli
    beams, rejected = beams_under_panels(annuli, panels, 0.02, node_radius=radius)
    assert refused == rejected == ()
    return panels, beams


def found(panels: Panels, beams: Beams) -> tuple[Finding, ...]:
    return audit_model(Model(panels, beams), LIMITS)


def outwards(panels: Panels, row: int) -> FloatArray:
    return unit(panels.spheres[row, 1:4])


def moved_panel(panels: Panels, row: int, shift: FloatArray) -> Panels:
    origins = panels.origins.copy()
    origins[row] += shift
    return replace(panels, origins=origins)


def moved_beam(beams: Beams, row: int, shift: FloatArray) -> Beams:
    origins = beams.annuli.origins.copy()
    origins[row] += shift
    return replace(beams, annuli=replace(beams.annuli, origins=origins))


def turned_beam(beams: Beams, row: int, degrees: float) -> Beams:
    """A beam turned about its length."""
    x = beams.annuli.frames[row, 0]
    angle = np.radians(degrees)
    cross = np.cross(np.eye(3), x)
    turn = np.eye(3) + np.sin(angle) * -cross + (1 - np.cos(angle)) * cross @ cross
    annuli = beams.annuli
    rows: dict[str, FloatArray] = {}
    for name in ("frames", "corners", "end_directions"):
        rows[name] = getattr(annuli, name).copy()
        rows[name][row] = rows[name][row] @ turn.T
    for name in ("outer", "inner"):
        rows[name] = getattr(annuli, name).copy()
        rows[name][row, 1:4] = turn @ rows[name][row, 1:4]
    corners, sections = beams.corners.copy(), beams.sections.copy()
    corners[row], sections[row] = corners[row] @ turn.T, sections[row] @ turn.T
    return replace(beams, annuli=replace(annuli, **rows), corners=corners, sections=sections)


def along_edge(panels: Panels, row: int) -> FloatArray:
    """Across the first edge of a panel, away from its middle."""
    return -panels.plane_normals[panels.offsets[row]]


def raised(panels: Panels, beams: Beams) -> tuple[Panels, Beams]:
    return moved_panel(panels, 7, 0.003 * outwards(panels, 7)), beams


def lowered(panels: Panels, beams: Beams) -> tuple[Panels, Beams]:
    return moved_panel(panels, 7, -0.003 * outwards(panels, 7)), beams


def shifted(panels: Panels, beams: Beams) -> tuple[Panels, Beams]:
    return moved_panel(panels, 7, 0.003 * along_edge(panels, 7)), beams


def pushed_in(panels: Panels, beams: Beams) -> tuple[Panels, Beams]:
    return moved_panel(panels, 7, 0.007 * along_edge(panels, 7)), beams


def turned(panels: Panels, beams: Beams) -> tuple[Panels, Beams]:
    return panels, turned_beam(beams, 11, 1.0)


def beam_aside(panels: Panels, beams: Beams) -> tuple[Panels, Beams]:
    return panels, moved_beam(beams, 11, 0.003 * beams.annuli.frames[11, 2])


def beam_up(panels: Panels, beams: Beams) -> tuple[Panels, Beams]:
    return panels, moved_beam(beams, 11, 0.003 * beams.annuli.frames[11, 1])


def beam_along(panels: Panels, beams: Beams) -> tuple[Panels, Beams]:
    return panels, moved_beam(beams, 11, 0.003 * beams.annuli.frames[11, 0])


def thick(panels: Panels, beams: Beams) -> tuple[Panels, Beams]:
    """All beams thicker than what they were lowered for."""
    return panels, cut_beams(beams.annuli, 0.04)[0]


def recut(panels: Panels, **changes: FloatArray) -> Panels:
    """Panels of other spheres or planes, corners where these meet."""
    other = replace(panels, **changes)
    owners = other.corner_panels
    planes = other.plane_normals, other.plane_offsets, other.offsets
    outer, inner = (
        corner_points(rows[owners], *planes, near)[0]
        for rows, near in (
            (other.spheres, panels.corners),
            (other.inner_spheres, panels.inner_corners),
        )
    )
    return replace(other, corners=outer, inner_corners=inner)


def other_mould(panels: Panels, beams: Beams) -> tuple[Panels, Beams]:
    """A panel of another radius between the same walls."""
    rows = panels.spheres.copy()
    rows[7] = normalize(rows[7] * [2, 1, 1, 1, 1])
    inner = panels.inner_spheres.copy()
    inner[7] = offset(rows[7], -panels.thickness)
    return recut(panels, spheres=rows, inner_spheres=inner), beams


def skew_spheres(panels: Panels, beams: Beams) -> tuple[Panels, Beams]:
    """A panel of another sphere, cut where it meets its neighbours: nodes have no line."""
    local = SPHERES.local_spheres.copy()
    local[7] = normalize(local[7] * [0.8, 1, 1, 1, 1])
    spheres = SphereMesh.from_local(SPHERES.mesh, local)
    return cut_panels(spheres, "intersection", 0.012, panels.joint_gap)[0], beams


def hole(panels: Panels, beams: Beams) -> tuple[Panels, Beams]:
    """Cutting planes of one panel that miss a node by 4 mm."""
    offsets = panels.plane_offsets.copy()
    first = panels.offsets[7]
    offsets[first : first + 2] += 0.004
    return recut(panels, plane_offsets=offsets), beams


FAULTS: list[tuple[Fault, set[str], set[str]]] = [
    (raised, {"P201"}, {"P0007"}),
    (lowered, {"P201", "P207"}, {"P0007"}),
    (shifted, {"P203", "P204", "P205"}, {"P0007"}),
    (pushed_in, {"P203", "P204", "P205", "P206"}, {"P0007"}),
    (turned, {"B202", "B102"}, {"B0011"}),
    (beam_aside, {"B203", "B209", "B102"}, {"B0011"}),
    (beam_up, {"B203", "P207"}, {"B0011"}),
    (beam_along, {"B203", "B102"}, {"B0011"}),
    (thick, {"P207"}, set()),
    (other_mould, {"P201"}, {"P0007"}),
    (skew_spheres, {"P204", "P205"}, {"P0007"}),
    (hole, {"P203", "P204", "P205"}, {"P0007"}),
]


def test_a_sound_assembly_has_no_findings() -> None:
    assert found(*assembly()) == ()
    assert found(*assembly(0.0)) == ()
    assert found(*assembly(0.004, 0.03)) == ()


@pytest.mark.parametrize(("fault", "codes", "parts"), FAULTS)
def test_planted_faults_are_found_by_their_codes(
    fault: Fault, codes: set[str], parts: set[str]
) -> None:
    findings = found(*fault(*assembly()))
    assert codes <= {finding.code for finding in findings}
    assert parts <= {finding.id for finding in findings}
    errors = {finding.code for finding in findings if finding.severity == "error"}
    assert codes <= errors
    for finding in findings:
        assert finding.size is not None
        assert f"{finding.size:.3g}" in finding.message


def test_sizes_are_how_much_is_wrong() -> None:
    panels, beams = assembly()
    sizes = {(f.code, f.id): f.size for f in found(*raised(panels, beams))}
    assert sizes["P201", "P0007"] == pytest.approx(3, rel=0.2)
    sizes = {(f.code, f.id): f.size for f in found(*pushed_in(panels, beams))}
    assert sizes["P206", "P0007"] == pytest.approx(7 - 4, rel=1e-6)
    assert sizes["P203", "P0007"] == pytest.approx(7, rel=0.1)
    sizes = {(f.code, f.id): f.size for f in found(*turned(panels, beams))}
    assert sizes["B202", "B0011"] == pytest.approx(1, rel=0.05)


def test_a_panel_on_another_far_away_is_found() -> None:
    """Panels that are no neighbours: a wing that folds back onto the model."""
    panels, beams = assembly()
    origins = panels.origins.copy()
    origins[7] = origins[30] + 0.01 * outwards(panels, 30)
    codes = {(f.code, f.id) for f in found(replace(panels, origins=origins), beams)}
    assert {("P206", "P0007"), ("P206", "P0030")} <= codes


def test_a_beam_in_a_node_cylinder_is_found() -> None:
    panels, beams = assembly(0.004, 0.03)
    codes = {(f.code, f.id) for f in found(*beam_along(panels, beams))}
    assert ("B103", "B0011") in codes
    # Cylinders take twisted beams as they are.
    codes = {(f.code, f.severity) for f in found(*turned(panels, beams))}
    assert "B202" not in {code for code, _ in codes}
    lower = replace(beams, cylinder_tops=np.full((beams.n_beams, 2), -0.02))
    assert "P208" in {f.code for f in found(panels, lower)}


@pytest.mark.parametrize(("units", "scale"), [("mm", 1000.0), ("ft", 1 / 0.3048)])
def test_law_units_do_not_matter(units: str, scale: float) -> None:
    panels, beams = lowered(*assembly())
    expected = found(panels, beams)
    model = Model(scale_panels(panels, scale), scale_beams(beams, scale), units)
    other = audit_model(model, LIMITS)
    assert [(f.code, f.id) for f in other] == [(f.code, f.id) for f in expected]
    for a, b in zip(other, expected, strict=True):
        assert a.size == pytest.approx(b.size, rel=1e-5)


def test_law_the_place_on_the_site_does_not_matter() -> None:
    panels, beams = lowered(*assembly())
    shift = np.array([4.1e5, -2.3e5, 1.2e3])
    far = (
        replace(panels, origins=panels.origins + shift),
        replace(beams, annuli=replace(beams.annuli, origins=beams.annuli.origins + shift)),
    )
    expected = [(f.code, f.id) for f in found(panels, beams)]
    assert [(f.code, f.id) for f in found(*far)] == expected


def test_some_parts_alone() -> None:
    panels, beams = assembly()
    some = select_parts(panels, np.arange(panels.n_panels) % 3 > 0)
    assert "P202" in {f.code for f in found(some, beams)} <= {"P105", "P202"}
    few = select_parts(beams, np.arange(beams.n_beams) % 3 > 0)
    assert found(panels, few) == ()
