"""The audit: every code on a panel that deserves it, and on no other."""

import json
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from spheremesh import Mesh, SphereMesh
from spheremesh.fabrication.audit.report import audit_model
from spheremesh.fabrication.audit.subjects import AuditLimits, warning_texts
from spheremesh.fabrication.model import Model
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.panels import Panels, scale_panels
from spheremesh.kernel.parts.findings import Finding, findings_report, rejected_report
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.fit import face_planes


@pytest.fixture(scope="module")
def sound(squares: Callable[..., SphereMesh]) -> Panels:
    return cut_panels(squares(0.2, 0.2, 0.2), thickness=0.05, joint_gap=0.01)[0]


def codes(findings: tuple[Finding, ...]) -> set[tuple[str, str]]:
    return {(finding.code, finding.id) for finding in findings}


def test_sound_panels_have_no_findings(sound: Panels) -> None:
    assert audit_model(Model(sound)) == ()
    assert findings_report(()) == {"counts": {}, "errors": [], "notes": []}


def test_names_numbers_and_refusals_are_errors(
    squares: Callable[..., SphereMesh], sound: Panels
) -> None:
    twice = replace(sound, ids=("A", "B", "A"))
    assert codes(audit_model(Model(twice))) == {("P001", "A")}
    corners = sound.corners.copy()
    corners[5] = np.nan
    broken = audit_model(Model(replace(sound, corners=corners)))
    assert codes(broken) == {("P002", "P0001")}
    for name, row, panel in (
        ("origins", 1, 1), ("design_spheres", 2, 2), ("thicknesses", 0, 0),
        ("plane_offsets", 9, 2), ("inner_corners", 0, 0),
    ):  # fmt: skip
        values = getattr(sound, name).copy()
        values[row] = np.inf
        broken = replace(sound, **{name: values})
        assert codes(audit_model(Model(broken))) == {("P002", f"P000{panel}")}
    panels, rejected = cut_panels(squares(0.2, 1.5, 0.2))
    findings = audit_model(Model(panels), rejected=rejected_report(rejected))
    assert codes(findings) == {("P100", "P0001"), ("P202", "P0000"), ("P202", "P0002")}
    refused = next(finding for finding in findings if finding.code == "P100")
    assert "80 degrees" in refused.message
    assert {f.severity for f in findings if f.code < "P102"} == {"error"}
    assert {f.severity for f in findings if f.code > "P102"} == {"note"}


def test_caps_beyond_80_degrees_are_errors(squares: Callable[..., SphereMesh]) -> None:
    """Cutting refuses them: a cap that grew afterwards."""
    panels, _ = cut_panels(squares(1.2))
    assert audit_model(Model(panels)) == ()
    # The same outline on a sphere as large as its circle.
    steep = squares(1.45).local_spheres
    bad = replace(panels, spheres=steep, inner_spheres=steep, design_spheres=steep)
    (found,) = (f for f in audit_model(Model(bad)) if f.code == "P101")
    assert found.severity == "error"
    assert found.size == pytest.approx(np.degrees(1.45), rel=1e-6)


def test_sharp_corners_and_short_edges_are_notes() -> None:
    points = [[0, 0, 0], [1, 0, 0], [1, 0.01, 0], [0, 0.15, 0.0]]
    panels, _ = cut_panels(face_planes(Mesh(points, [[0, 1, 2, 3]])))
    findings = audit_model(Model(panels))
    assert codes(findings) == {("P103", "P0000")}
    assert findings[0].size == pytest.approx(10.0)
    assert findings[0].message == "an edge of 10 mm, shorter than 20"
    needle = [[0, 0, 0], [1, 0, 0], [1, 0.2, 0.0]]
    panels, _ = cut_panels(face_planes(Mesh(needle, [[0, 1, 2]])))
    findings = audit_model(Model(panels))
    assert codes(findings) == {("P102", "P0000")}
    assert findings[0].size == pytest.approx(np.degrees(np.arctan(0.2)))


def test_thick_panels_and_other_thicknesses_are_notes(
    squares: Callable[..., SphereMesh],
) -> None:
    # Radius sqrt(0.5) / sin(0.2) = 3.56, the smaller one of a dish.
    panels, _ = cut_panels(squares(0.2), thickness=0.8)
    (found,) = audit_model(Model(panels))
    assert (found.code, found.id) == ("P104", "P0000")
    assert found.size == pytest.approx(0.8 * np.sin(0.2) / np.sqrt(0.5), rel=1e-9)
    (dome,) = audit_model(Model(cut_panels(squares(-0.2), thickness=0.8)[0]))
    assert dome.size == pytest.approx(1 / (1 / found.size - 1), rel=1e-9)
    panels, _ = cut_panels(squares(0.2, 0.4), thickness=0.05, layer="power")
    notes = [f for f in audit_model(Model(panels)) if f.code == "P106"]
    assert [f.id for f in notes] == ["P0000", "P0001"]
    np.testing.assert_allclose([f.size for f in notes], 1000 * panels.thicknesses)


def test_tilted_walls_and_large_blanks_are_notes(squares: Callable[..., SphereMesh]) -> None:
    """A single panel is cut by planes through its centre, which the joint moves off it."""
    panels, _ = cut_panels(squares(0.9), joint_gap=0.4)
    radius = np.sqrt(0.5) / np.sin(0.9)
    (found,) = audit_model(Model(panels), AuditLimits(wall_tilt_deg=5))
    assert found.code == "P105"
    assert found.size == pytest.approx(np.degrees(np.arcsin(0.2 / radius)), rel=1e-9)
    # Where spheres of different radii meet, one wall leans and the others stand upright.
    panels, _ = cut_panels(squares(-0.2, -0.6), "intersection")
    leaning = audit_model(Model(panels), AuditLimits(wall_tilt_deg=5))
    assert codes(leaning) == {("P105", "P0000"), ("P105", "P0001")}
    assert leaning[0].size == pytest.approx(leaning[1].size, rel=1e-9)
    panels, _ = cut_panels(squares(0.9))
    assert audit_model(Model(panels), AuditLimits(blank_mm=1415)) == ()
    (found,) = audit_model(Model(panels), AuditLimits(blank_mm=1414))
    assert found.code == "P107"
    assert found.size == pytest.approx(1000 * np.sqrt(2), rel=1e-9)


def test_steps_to_neighbours_are_notes(squares: Callable[..., SphereMesh]) -> None:
    panels, _ = cut_panels(squares(0.1, 0.3, 0.1))
    findings = audit_model(Model(panels))
    assert codes(findings) == {("P201", f"P000{i}") for i in range(3)}
    # Sagittas over a chord of 1 on radii sqrt(0.5) / sin(angle), cut upright.
    radii = np.sqrt(0.5) / np.sin([0.1, 0.3])
    heights = np.sqrt(radii**2 - 0.25) - np.sqrt(radii**2 - 0.5)
    assert findings[0].size == pytest.approx(1000 * abs(heights[1] - heights[0]), rel=1e-6)


@pytest.mark.parametrize(("units", "scale"), [("mm", 1000), ("ft", 1 / 0.3048)])
def test_law_findings_do_not_depend_on_units(
    squares: Callable[..., SphereMesh], units: str, scale: float
) -> None:
    panels, rejected = cut_panels(squares(0.1, 0.35, 1.5), thickness=0.6)
    expected = audit_model(Model(panels), rejected=rejected_report(rejected))
    found = audit_model(
        Model(scale_panels(panels, scale), units=units), rejected=rejected_report(rejected)
    )
    assert codes(found) == codes(expected)
    assert len(expected) > 3
    for a, b in zip(found, expected, strict=True):
        assert a.size == (pytest.approx(b.size, rel=1e-9) if b.size is not None else None)


def test_no_panels_are_audited_too(squares: Callable[..., SphereMesh], sound: Panels) -> None:
    panels, rejected = cut_panels(squares(1.5))
    assert panels.n_panels == 0
    assert codes(audit_model(Model(panels), rejected=rejected_report(rejected))) == {
        ("P100", "P0000")
    }
    assert audit_model(Model(select_parts(sound, np.zeros(3, bool)))) == ()


def test_reports_are_plain_and_sorted(squares: Callable[..., SphereMesh]) -> None:
    panels, rejected = cut_panels(squares(0.1, 0.35, 1.5), thickness=0.6)
    findings = audit_model(Model(panels), rejected=rejected_report(rejected))
    report = findings_report(findings)
    assert json.loads(json.dumps(report, allow_nan=False)) == report
    assert sum(report["counts"].values()) == len(report["errors"]) + len(report["notes"])
    assert [error["code"] for error in report["errors"]] == ["P100", "P201", "P201"]
    texts = warning_texts(findings)
    assert set(texts) == {finding.id for finding in findings}
    assert all(f"{f.code} {f.message}" in texts[f.id].split("; ") for f in findings)
