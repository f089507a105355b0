"""The audit of beams: every code on a beam that deserves it, and on no other."""

import json
from dataclasses import replace

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.fabrication.audit.report import audit_model
from spheremesh.fabrication.audit.subjects import AuditLimits
from spheremesh.fabrication.model import Model
from spheremesh.fabrication.schedules.beams import beam_tables
from spheremesh.kernel.beams.beams import Beams, scale_beams
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.beams.drilling import drill_beams
from spheremesh.kernel.beams.facts import beam_facts
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.parts.findings import Finding, findings_report, rejected_report
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import roof_net, torus_net

NET = torus_net(12, 8, 10.0, 4.0)
ANNULI = annulus_support(face_planes(NET), depth=0.5).annuli


def sound() -> Beams:
    return cut_beams(ANNULI, 0.05, 0.01)[0]


def codes(findings: tuple[Finding, ...]) -> set[str]:
    return {finding.code for finding in findings}


def of(code: str, findings: tuple[Finding, ...]) -> dict[str, float | None]:
    """Sizes of the findings of a code by beam."""
    return {finding.id: finding.size for finding in findings if finding.code == code}


def test_sound_beams_have_no_findings() -> None:
    assert audit_model(Model(beams=sound())) == ()


def test_names_numbers_and_refusals_are_errors() -> None:
    beams = sound()
    twice = replace(beams, annuli=replace(ANNULI, ids=("B9", "B9", *ANNULI.ids[2:])))
    (found,) = audit_model(Model(beams=twice))
    assert (found.code, found.id, found.severity) == ("B001", "B9", "error")
    outer = ANNULI.outer.copy()
    outer[7] = np.inf
    (found,) = audit_model(Model(beams=replace(beams, annuli=replace(ANNULI, outer=outer))))
    assert (found.code, found.id, found.severity) == ("B002", "B0007", "error")
    insets = beams.insets.copy()
    insets[4] = np.nan
    assert of("B002", audit_model(Model(beams=replace(beams, insets=insets)))) == {
        "B0004": None
    }
    support = annulus_support(central_spheres(NET), depth=0.5)
    made, rejected = cut_beams(support.annuli, 0.4, node_radius=1.3)
    assert support.rejected
    assert rejected
    findings = audit_model(
        Model(beams=made), rejected=rejected_report((*rejected, *support.rejected))
    )
    refused = [f for f in findings if f.severity == "error"]
    assert {f.id for f in refused if f.code == "B100"} == {b.id for b in support.rejected}
    assert {f.id for f in refused if f.code == "B101"} == {b.id for b in rejected}
    assert [f.code for f in refused] == sorted(f.code for f in refused)
    assert all(f.message.startswith("cannot be made: ") for f in refused)
    # Every edge is a beam or listed with a code.
    edges = {f"B{i:04d}" for i in range(192)}
    assert {f.id for f in refused} | set(made.annuli.ids) == edges


def test_tilts_twists_and_mismatches_are_found() -> None:
    roof = minimize_angles(central_spheres(roof_net(6, 5, 40.0)))[0]
    beams = cut_beams(annulus_support(roof, depth=0.5).annuli, 0.05)[0]
    facts = beam_facts(beams)
    measured = {
        "B201": np.degrees(facts.tilts),
        "B202": np.degrees(facts.twists).max(axis=1),
        "B203": 1000 * facts.mismatches.max(axis=1),
    }
    tilt, twist, step = (float(np.median(sizes)) for sizes in measured.values())
    limits = AuditLimits(wall_tilt_deg=tilt, twist_deg=twist, step_mm=step, depth_share=0)
    findings = [f for f in audit_model(Model(beams=beams), limits) if f.code in measured]
    severities = {(f.code, f.severity) for f in findings}
    assert severities == {("B201", "note"), ("B202", "error"), ("B203", "error")}
    for (code, sizes), limit in zip(measured.items(), (tilt, twist, step), strict=True):
        found = of(code, findings)
        worse = sizes > limit
        assert 0 < worse.sum() < beams.n_beams
        assert list(found) == [beams.annuli.ids[i] for i in np.flatnonzero(worse)]
        np.testing.assert_allclose(list(found.values()), sizes[worse], rtol=1e-9)  # pyright: ignore


def test_the_sharpest_bevel_counts() -> None:
    """On the rim of a roof, one side of a beam is cut square or beyond."""
    roof = face_planes(roof_net(6, 5, 40.0))
    beams = cut_beams(annulus_support(roof, depth=0.5).annuli, 0.05)[0]
    bevels = np.degrees(beam_facts(beams).bevels)
    sharpest = bevels.min(axis=(1, 2))
    assert (bevels.max(axis=(1, 2)) > 80).sum() > 10
    found = of("B206", audit_model(Model(beams=beams), AuditLimits(corner_deg=50)))
    assert list(found) == [beams.annuli.ids[i] for i in np.flatnonzero(sharpest < 50)]
    np.testing.assert_allclose(list(found.values()), sharpest[sharpest < 50], rtol=1e-9)  # pyright: ignore


def test_shallow_short_sharp_and_long_beams_are_notes() -> None:
    beams = cut_beams(ANNULI, 0.3, 0.01)[0]
    findings = audit_model(Model(beams=beams))
    assert codes(findings) == {"B204"}
    assert set(of("B204", findings)) == set(beams.annuli.ids)
    assert findings[0].message.endswith(" mm deep, less than 600")
    facts = beam_facts(beams)
    depths = 1000 * np.minimum(facts.depths.min(axis=1), facts.widths)
    np.testing.assert_allclose([finding.size for finding in findings], depths, rtol=1e-9)  # pyright: ignore
    chords = 1000 * beam_facts(sound()).chords
    limit = float(np.median(chords)) + 1
    findings = audit_model(Model(beams=sound()), AuditLimits(edge_mm=limit))
    assert set(of("B205", findings)) == {
        name for name, chord in zip(ANNULI.ids, chords, strict=True) if chord < limit
    }
    findings = audit_model(Model(beams=sound()), AuditLimits(corner_deg=46))
    assert codes(findings) == {"B206"}
    sizes = 1000 * beam_facts(sound()).sizes.max(axis=1)
    limit = float(sizes.mean())
    findings = audit_model(Model(beams=sound()), AuditLimits(beam_mm=limit))
    assert list(of("B207", findings)) == [ANNULI.ids[i] for i in np.flatnonzero(sizes > limit)]


def test_marks_that_do_not_fit_are_notes() -> None:
    drilled, refused = drill_beams(sound(), 1, 0.1, 1.5)
    findings = audit_model(Model(beams=drilled))
    assert set(of("B208", findings)) == {finding.id for finding in refused}
    assert 0 < len(refused) < drilled.n_beams
    assert codes(audit_model(Model(beams=drill_beams(sound(), 2, 0.05, 0.1)[0]))) == set()


@pytest.mark.parametrize(("units", "scale"), [("mm", 1000), ("ft", 1 / 0.3048)])
def test_law_findings_do_not_depend_on_units(units: str, scale: float) -> None:
    annuli = annulus_support(central_spheres(NET), depth=0.5).annuli
    beams, rejected = cut_beams(annuli, 0.4, node_radius=1.3)
    assert rejected
    expected = audit_model(Model(beams=beams), rejected=rejected_report(rejected))
    found = audit_model(
        Model(beams=scale_beams(beams, scale), units=units), rejected=rejected_report(rejected)
    )
    assert [(f.code, f.id) for f in found] == [(f.code, f.id) for f in expected]
    assert len(expected) > 3
    for a, b in zip(found, expected, strict=True):
        assert a.size == (pytest.approx(b.size, rel=1e-9) if b.size is not None else None)


def test_no_beams_are_audited_too() -> None:
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]], [[0, 1, 2, 3]])
    support = annulus_support(face_planes(mesh), kappa=0.1)
    assert support.annuli.n_annuli == 0
    none = cut_beams(support.annuli, 0.1)[0]
    findings = audit_model(Model(beams=none), rejected=rejected_report(support.rejected))
    assert [(f.code, f.id) for f in findings] == [("B100", f"B000{i}") for i in range(4)]
    report = findings_report(findings)
    assert json.loads(json.dumps(report, allow_nan=False)) == report
    assert audit_model(Model(beams=select_parts(sound(), np.zeros(192, bool)))) == ()


def test_the_worse_end_counts() -> None:
    beams, turn = sound(), np.radians(2)
    axes, normal = ANNULI.node_axes.copy(), ANNULI.frames[3, 2]
    axes[3, 1] = np.cos(turn) * axes[3, 1] + np.sin(turn) * normal
    findings = audit_model(Model(beams=replace(beams, annuli=replace(ANNULI, node_axes=axes))))
    (found,) = (finding for finding in findings if finding.code == "B202")
    assert (found.code, found.id) == ("B202", "B0003")
    assert found.size == pytest.approx(2, rel=1e-9)
    corners = ANNULI.corners.copy()
    corners[5, 0] += 0.02 * ANNULI.frames[5, 2]
    apart = audit_model(Model(beams=replace(beams, annuli=replace(ANNULI, corners=corners))))
    sizes = of("B203", apart)
    # Of four ends at a node, one is 20 mm off: 15 mm from their mean, the others 5.
    assert sizes["B0005"] == pytest.approx(15, rel=1e-9)
    assert all(size == pytest.approx(5) for name, size in sizes.items() if name != "B0005")


def test_beams_that_run_into_each_other_are_errors() -> None:
    """Four beams of 50 mm thickness a node, some at less than right angles."""
    assert audit_model(Model(beams=cut_beams(ANNULI, 0.05, node_radius=0.05)[0])) == ()
    some = audit_model(Model(beams=cut_beams(ANNULI, 0.05, node_radius=0.026)[0]))
    assert 0 < len(some) < len(ANNULI.ids)
    beams = cut_beams(ANNULI, 0.05, node_radius=0.015)[0]
    findings = audit_model(Model(beams=beams))
    assert {(f.code, f.severity) for f in findings} == {("B102", "error")}
    assert {f.id for f in findings} == set(ANNULI.ids)
    # Two ends at a right angle have a bar in common, as wide as half of the thickness is more
    # than the radius; at sharper angles it is wider.
    sizes = np.array([f.size for f in findings], float)
    assert sizes.min() == pytest.approx(25 - 15, rel=1e-6)
    assert ((sizes > 10.1) == (beam_facts(beams).clearances.min(axis=1) < -0.0145)).all()
    assert audit_model(Model(beams=cut_beams(ANNULI, 0.05)[0])) == ()


def test_a_beam_that_is_left_alone_runs_into_nobody() -> None:
    """Mitres between beams of which all others at the node cannot be made."""
    turns = np.arange(6) * np.pi / 3
    rim = np.stack([np.cos(turns), np.sin(turns), 0 * turns], 1)
    fan = Mesh(np.vstack([np.zeros(3), rim]), [[0, i + 1, (i + 1) % 6 + 1] for i in range(6)])
    beams = cut_beams(annulus_support(face_planes(fan), depth=0.2).annuli, 0.05)[0]
    # On the rim the next beam is 240 degrees away on one side: mitres reach beyond the node.
    assert beams.insets.min() < -0.01
    assert codes(audit_model(Model(beams=beams))) == set()
    np.testing.assert_allclose(beam_facts(beams).clearances, 0, atol=1e-12)
    for row in range(beams.n_beams):
        alone = select_parts(beams, np.arange(beams.n_beams) == row)
        assert codes(audit_model(Model(beams=alone))) == set()
        assert np.isinf(beam_facts(alone).clearances).all()
        assert beam_tables(alone, "m")["Beams"][0]["clearances_mm"] == [None, None]
