"""Laws of the measures of beams (E6): closed forms, quadrature, and what must not matter."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, IntArray, dot, norm
from spheremesh.kernel.beams.beams import (
    Beams,
    beam_volumes,
    cut_corners,
    insets_at,
    inward_directions,
    scale_beams,
    side_arcs,
)
from spheremesh.kernel.beams.cutting import cut_beams, mitre_angles, neighbor_angles
from spheremesh.kernel.beams.facts import BeamFacts, beam_facts
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.spheres.arcs import Arcs, arc_points, arc_reaches
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import roof_net, torus_net, vase_net
from spheremesh.kernel.tolerances import MITRE_LIMIT


def made(sphere_mesh: SphereMesh, **ends: float) -> Beams:
    """Beams of 0.2 edges depth and 0.05 edges thickness."""
    size = mean_edge_length(sphere_mesh.mesh)
    annuli = annulus_support(sphere_mesh, depth=0.2 * size).annuli
    scaled = {name: value * size for name, value in ends.items()}
    return cut_beams(annuli, 0.05 * size, **scaled)[0]


TORUS = central_spheres(torus_net(9, 6, 3.0, 1.0))
BEAMS = made(TORUS, node_gap=0.02)


def test_law_e6_measures_of_a_ring_are_those_of_its_sector(ball: Mesh) -> None:
    """Square cut beams along meridians of a ball of radius 2."""
    annuli = annulus_support(central_spheres(ball), depth=0.2).annuli
    facts = beam_facts(cut_beams(annuli, 0.05, node_radius=1e-12)[0])
    chords = norm(annuli.corners[:, 0, 0] - annuli.corners[:, 1, 0])
    half = np.arcsin(chords / 4)
    expected = {
        "outer_radii": np.full(len(half), 2.0),
        "inner_radii": np.full(len(half), 1.8),
        "outer_lengths": 4 * half,
        "inner_lengths": 3.6 * half,
        "chords": chords,
        "sagittas": 2 - 2 * np.cos(half),
        "depths": np.full((len(half), 2), 0.2),
        "widths": np.full(len(half), 0.2),
        "volumes": half * (2.0**2 - 1.8**2) * 0.05,
        "sizes": np.stack([chords, 2 - 1.8 * np.cos(half)], 1),
        "bevels": np.full((len(half), 2, 2), np.pi / 2),
    }
    # The longest chord crosses the thickness, between outer corners or down to an inner one.
    across = (3.8 * np.sin(half)) ** 2 + (0.2 * np.cos(half)) ** 2
    expected["lengths"] = np.sqrt(np.maximum(chords**2, across) + 0.05**2)
    for name, values in expected.items():
        np.testing.assert_allclose(getattr(facts, name), values, rtol=1e-9, err_msg=name)
    assert facts.twists.max() < 1e-7
    assert facts.mismatches.max() < 1e-12


def test_law_e6_lengths_by_quadrature() -> None:
    facts = beam_facts(BEAMS)
    nodes, weights = np.polynomial.legendre.leggauss(30)
    step = 1e-5
    for level_arcs, lengths in zip(
        _contour_arcs(BEAMS), (facts.outer_lengths, facts.inner_lengths), strict=True
    ):
        change = arc_points(level_arcs, nodes + step) - arc_points(level_arcs, nodes - step)
        np.testing.assert_allclose(norm(change) / (2 * step) @ weights, lengths, rtol=1e-9)


def _contour_arcs(beams: Beams) -> tuple[Arcs, Arcs]:
    """Arcs of the contour, as those of the upper side of beams without thickness."""
    flat = beams.corners.copy()
    flat[:, :, :, 2] = beams.sections
    levels = 0 * beams.levels
    return side_arcs(Beams(**(vars(beams) | {"corners": flat, "levels": levels})), 2)


@pytest.mark.parametrize("ends", [{}, {"node_gap": 0.03}, {"node_radius": 0.1}])
def test_law_e6_volumes_by_integrating_over_the_faces(ends: dict[str, float]) -> None:
    """The theorem of Gauss for (0, 0, z): the two sides, and the cuts that lean."""
    beams = made(TORUS, **ends)
    half = beams.thickness / 2
    total = np.zeros(beams.n_beams)
    for level in (0, 2):
        outer, inner = (
            arc_points(a, np.linspace(-1, 1, 2001)) for a in side_arcs(beams, level)
        )
        ring = np.concatenate([inner, outer[:, ::-1]], 1)
        area = np.cross(ring, np.roll(ring, -1, axis=1)).sum(axis=1) / 2
        total += half * dot(area, beams.annuli.frames[:, 2])
    nodes, weights = np.polynomial.legendre.leggauss(40)
    for low, high in ((0, 1), (1, 2)):
        bounds = beams.levels[..., low], beams.levels[..., high]
        for end in (0, 1):
            span = bounds[1][:, end] - bounds[0][:, end]
            change = beams.insets[:, end, high] - beams.insets[:, end, low]
            slope = np.divide(change, span, out=np.zeros_like(span), where=span != 0)
            for node, weight in zip(nodes, weights, strict=True):
                heights = bounds[0][:, end] + (node + 1) / 2 * span
                insets = insets_at(beams.levels, beams.insets, heights)
                lines = cut_corners(beams.annuli, insets[..., None])[0][:, end, :, 0]
                length = norm(lines[:, 1] - lines[:, 0])
                total += weight * span / 2 * heights * slope * length
    np.testing.assert_allclose(total, beam_volumes(beams), rtol=1e-6)
    assert np.abs(beam_facts(beams).volumes - beam_volumes(beams)).max() == 0


@pytest.mark.parametrize("sphere_mesh", [TORUS, face_planes(roof_net(6, 5, 40.0))])
@pytest.mark.parametrize("ends", [{}, {"node_radius": 0.1}])
def test_rectangles_are_tight(sphere_mesh: SphereMesh, ends: dict[str, float]) -> None:
    beams = made(sphere_mesh, **ends)
    sizes = beam_facts(beams).sizes
    points = [beams.corners.reshape(beams.n_beams, -1, 3)]
    for level in (0, 2):
        points += [arc_points(a, np.linspace(-1, 1, 3001)) for a in side_arcs(beams, level)]
    flat = np.einsum("bij,bnj->bni", beams.annuli.frames[:, :2], np.concatenate(points, 1))
    extents = flat.max(axis=1) - flat.min(axis=1)
    assert (sizes >= extents - 1e-12).all()
    np.testing.assert_allclose(sizes, extents, rtol=1e-6)


@given(st.floats(-1.0, 1.0), st.floats(0, 2 * np.pi))
def test_law_reaches_of_arcs_are_largest_coordinates(bulge: float, turn: float) -> None:
    arcs = Arcs(*(np.array([v]) for v in ([1.0, 2, 0], [3.0, 2, 0], [0.0, 1, 0], bulge)))
    direction = np.array([[np.cos(turn), np.sin(turn), 0.0]])
    sampled = dot(arc_points(arcs, np.linspace(-1, 1, 4001)), direction[:, None]).max()
    assert abs(arc_reaches(arcs, direction)[0] - sampled) < 1e-6


def _bare(facts: BeamFacts) -> dict[str, FloatArray]:
    """Measures without places; what belongs to ends and sides without their order."""
    return {
        name: np.sort(values.reshape(len(values), -1), axis=1)
        for name, values in vars(facts).items()
        if name != "ends"
    }


POWERS = {"volumes": 3, "bevels": 0, "tilts": 0, "twists": 0}


def assert_alike(found: BeamFacts, expected: BeamFacts, scale: float, error: float) -> None:
    sized = _bare(found)
    for name, values in _bare(expected).items():
        power = POWERS.get(name, 1)
        unit = scale**power
        largest = max(np.abs(values[np.isfinite(values)]).max(initial=0.0), 1.0)
        np.testing.assert_allclose(
            sized[name] / unit, values, rtol=error, atol=error * largest, err_msg=name
        )


@pytest.mark.parametrize("exponent", [-3.0, -1.3, 0.4, 3.0])
def test_law_e6_measures_do_not_depend_on_scale(exponent: float) -> None:
    scale = 10.0**exponent
    facts = beam_facts(BEAMS)
    assert_alike(beam_facts(scale_beams(BEAMS, scale)), facts, scale, 1e-9)
    mesh = Mesh(scale * TORUS.mesh.vertices, TORUS.mesh.faces)
    assert_alike(beam_facts(made(central_spheres(mesh), node_gap=0.02)), facts, scale, 1e-8)


def test_law_e6_measures_do_not_depend_on_place() -> None:
    size = mean_edge_length(TORUS.mesh)
    shift = 1e6 * size * np.array([0.6, -0.7, 0.4])
    moved = Mesh(TORUS.mesh.vertices + shift, TORUS.mesh.faces)
    far = made(SphereMesh.from_local(moved, TORUS.local_spheres), node_gap=0.02)
    facts, found = beam_facts(BEAMS), beam_facts(far)
    # The coordinates themselves are rounded to 1e-10 edges there.
    assert_alike(found, facts, 1.0, 1e-8)
    assert np.abs(found.ends - shift - facts.ends).max() < 1e-8


def test_law_e6_measures_do_not_depend_on_numbering(
    renumber: Callable[[Mesh], tuple[Mesh, IntArray]],
) -> None:
    mesh, new = renumber(TORUS.mesh)
    rows = np.empty_like(TORUS.local_spheres)
    rows[new] = TORUS.local_spheres
    other = made(SphereMesh.from_local(mesh, rows), node_gap=0.02)
    old = np.empty_like(new)
    old[new] = np.arange(len(new))
    order = np.argsort(_face_keys(BEAMS.annuli.edge_faces, np.arange(len(new))))
    others = np.argsort(_face_keys(other.annuli.edge_faces, old))
    assert_alike(
        beam_facts(_ordered(other, others)), beam_facts(_ordered(BEAMS, order)), 1.0, 1e-9
    )


def _face_keys(edge_faces: IntArray, names: IntArray) -> IntArray:
    """One number for the pair of faces beside each edge."""
    pairs = np.sort(names[edge_faces], axis=1)
    return pairs[:, 0] * len(names) + pairs[:, 1]


def _ordered(beams: Beams, order: IntArray) -> Beams:
    single = [select_parts(beams, np.arange(beams.n_beams) == i) for i in order.tolist()]
    joined = {
        name: np.concatenate([getattr(one, name) for one in single])
        for name in ("levels", "insets", "is_flat", "corners", "sections")
    }
    annuli = {
        name: np.concatenate([getattr(one.annuli, name) for one in single])
        for name, value in vars(beams.annuli).items()
        if isinstance(value, np.ndarray)
    }
    kept = vars(beams.annuli) | annuli
    return Beams(**(vars(beams) | joined | {"annuli": type(beams.annuli)(**kept)}))


def test_bevels_of_mitres_and_panels_beside() -> None:
    facts = beam_facts(BEAMS)
    np.testing.assert_allclose(facts.bevels, mitre_angles(BEAMS.annuli), atol=1e-12)
    names = BEAMS.annuli.panel_ids
    faces = BEAMS.annuli.edge_faces
    assert names == tuple((f"P{a:04d}", f"P{b:04d}") for a, b in faces.tolist())
    roof = made(face_planes(roof_net(6, 5, 40.0)))
    is_rim = roof.annuli.edge_faces[:, 1] < 0
    assert [pair[1] is None for pair in roof.annuli.panel_ids] == is_rim.tolist()


def test_twist_and_mismatch_tell_torsion() -> None:
    """A roof of least angles alone has torsion; central spheres of a torus have none."""
    roof = made(minimize_angles(central_spheres(roof_net(6, 5, 40.0)))[0])
    facts = beam_facts(roof)
    assert facts.twists.max() > 1e-3
    assert facts.mismatches.max() > 1e-6
    assert beam_facts(BEAMS).twists.max() < 1e-9


@pytest.mark.parametrize("gap", [0.0, 0.03])
def test_law_e6_mitres_leave_the_gap_between_neighbours(gap: float) -> None:
    vase = central_spheres(vase_net(9, 6, 1.0, 3.0, 0.3))
    for sphere_mesh in (TORUS, vase, face_planes(roof_net(6, 5, 40.0))):
        beams = made(sphere_mesh, node_gap=gap)
        clearances = beam_facts(beams).clearances
        is_alone = (neighbor_angles(beams.annuli) > MITRE_LIMIT).all(axis=2)
        assert (np.isinf(clearances) == is_alone).all()
        assert is_alone.sum() <= len(clearances) / 8
        # The vase and the roof have a little torsion, which opens the gap.
        apart = clearances[~is_alone] - beams.node_gap
        assert apart.min() > -1e-9
        assert apart.max() < (1e-12 if sphere_mesh is TORUS else 1e-3)


@pytest.mark.parametrize("radius", [0.005, 0.02, 0.03, 0.06])
def test_law_e6_beams_that_lack_clearance_run_into_each_other(radius: float) -> None:
    """Corners of square cut ends against the bodies of the others at their nodes."""
    beams = made(face_planes(torus_net(9, 6, 3.0, 1.0)), node_radius=radius)
    annuli, half = beams.annuli, beams.thickness / 2
    clearances = beam_facts(beams).clearances
    assert radius != 0.03 or 0 < (clearances < 0).sum() < clearances.size
    corners = beams.corners[:, :, 0, ::2] + annuli.origins[:, None, None]
    inward = inward_directions(annuli)
    tops = annuli.corners[:, :, 0] + annuli.origins[:, None]
    hits = np.zeros((beams.n_beams, 2), bool)
    for i, nodes in enumerate(annuli.edge_vertices.tolist()):
        for end, node in enumerate(nodes):
            for j, other in np.argwhere(annuli.edge_vertices == node).tolist():
                points = corners[i, end] - tops[j, other]
                depth = points @ inward[j, other] - beams.insets[j, other, 1]
                across = np.abs(points @ annuli.frames[j, 2])
                inside = ((depth > 0) & (across < half)).any()
                hits[i, end] |= bool(inside and j != i)
    assert (hits == (clearances < 0)).all()


def test_no_beams_have_no_measures() -> None:
    none = select_parts(BEAMS, np.zeros(BEAMS.n_beams, bool))
    assert all(len(values) == 0 for values in vars(beam_facts(none)).values())
