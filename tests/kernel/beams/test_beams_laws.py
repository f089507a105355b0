"""Laws of beams and their contours (E6): ends meet at the nodes, volumes, drawings."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, dot, norm, unit
from spheremesh.kernel.beams.beams import (
    Beams,
    beam_lengths,
    beam_volumes,
    inward_directions,
    node_axis_segments,
    scale_beams,
    section_arcs,
    side_arcs,
)
from spheremesh.kernel.beams.contours import beam_contours, contour_boxes, shelves
from spheremesh.kernel.beams.cutting import cut_beams, mitre_angles, mitre_normals, node_points
from spheremesh.kernel.beams.facts import beam_facts
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.spheres.arcs import Arcs, arc_circles, arc_points, segment_areas
from spheremesh.kernel.spheres.incidence import evaluate
from spheremesh.kernel.support.annuli import Annuli
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import torus_net


@pytest.fixture(scope="module")
def annuli() -> Annuli:
    sphere_mesh = central_spheres(torus_net(24, 12, 3.0, 1.0))
    return annulus_support(sphere_mesh, depth=0.15).annuli


def end_planes(beams: Beams) -> tuple[FloatArray, ...]:
    """Half planes of the ends (4B): normals out of the beam, points, directions, nodes."""
    ridge = beams.corners[:, :, 0, 1:2]
    rims = beams.corners[:, :, 0, ::2]
    normals = unit(np.cross(rims - ridge, beams.annuli.end_directions[:, :, None]))
    inward = inward_directions(beams.annuli)[:, :, None]
    normals = np.where(dot(normals, inward)[..., None] > 0, -normals, normals)
    points = ridge + beams.annuli.origins[:, None, None] + 0 * rims
    nodes = np.repeat(beams.annuli.edge_vertices[:, :, None], 2, axis=2)
    down = beams.annuli.end_directions[:, :, None]
    across = rims - ridge
    across = unit(across - dot(across, down)[..., None] * down)
    return tuple(part.reshape(-1, *part.shape[3:]) for part in (normals, points, across, nodes))


@pytest.mark.parametrize("gap", [0.0, 0.01])
def test_law_e6_neighbours_face_each_other_across_the_gap(annuli: Annuli, gap: float) -> None:
    beams, rejected = cut_beams(annuli, 0.03, node_gap=gap)
    assert rejected == ()
    normals, points, directions, nodes = end_planes(beams)
    assert len(np.unique(nodes)) == 288
    for node in range(0, 288, 7):
        here = np.flatnonzero(nodes == node)
        assert len(here) == 8
        apart = norm(normals[here][:, None] + normals[here][None])
        apart = apart + norm(directions[here][:, None] - directions[here][None])
        partner = apart.argmin(axis=1)
        assert (partner[partner] == np.arange(8)).all()
        assert apart.min(axis=1).max() < 1e-11
        across = dot(points[here][partner] - points[here], normals[here])
        assert np.abs(across - gap).max() < 1e-12


def test_law_e6_all_beams_of_a_node_meet_in_its_axis(annuli: Annuli) -> None:
    beams, _ = cut_beams(annuli, 0.03)
    vertices, segments = node_axis_segments(beams)
    ridges = beams.corners[:, :, :, 1] + beams.annuli.origins[:, None, None]
    assert vertices == tuple(range(288))
    assert np.abs(ridges - segments[beams.annuli.edge_vertices]).max() < 1e-13
    assert np.abs(beams.levels[..., 1]).max() < 1e-13


def test_corners_lie_on_the_faces_of_the_beam(annuli: Annuli) -> None:
    beams, _ = cut_beams(annuli, 0.03, node_gap=0.01)
    for k, rows in enumerate((beams.annuli.outer, beams.annuli.inner)):
        lift = beams.levels[..., None] * beams.annuli.frames[:, None, None, 2]
        flat = beams.corners[:, :, k] - lift
        assert np.abs(evaluate(rows[:, None, None], flat)).max() < 1e-13
        assert np.abs(dot(flat, beams.annuli.frames[:, None, None, 2])).max() < 1e-13
    for level in (0, 2):
        for k, arcs in enumerate(side_arcs(beams, level)):
            assert np.abs(arcs.starts - beams.corners[:, 0, k, level]).max() == 0
            assert (arc_circles(arcs).radii < 20).all()


def test_law_e6_half_angles_sum_to_a_full_turn(annuli: Annuli) -> None:
    half = mitre_angles(annuli)
    total = np.zeros(288)
    np.add.at(total, annuli.edge_vertices, half.sum(axis=2))
    assert np.abs(total - 2 * np.pi).max() < 1e-12


def test_a_single_beam_ends_square(annuli: Annuli) -> None:
    alone = cut_beams(annuli, 0.03)[0]
    alone = select_parts(alone, np.arange(alone.n_beams) == 5).annuli
    assert np.abs(mitre_angles(alone) - np.pi / 2).max() == 0
    beams, _ = cut_beams(alone, 0.03)
    assert beams.is_flat.all()
    assert np.abs(beams.insets).max() < 1e-15


def test_before_a_node_cylinder_ends_are_square(annuli: Annuli) -> None:
    beams, _ = cut_beams(annuli, 0.03, node_gap=0.005, node_radius=0.05)
    assert beams.is_flat.all()
    assert np.abs(beams.insets - 0.055).max() < 1e-15


@pytest.mark.parametrize("options", [{}, {"node_gap": 0.02}, {"node_radius": 0.03}])
def test_law_e6_volumes_of_straight_beams_are_those_of_their_hulls(
    nets: dict[str, Mesh], options: dict[str, float]
) -> None:
    annuli = annulus_support(face_planes(nets["egg"]), depth=0.1).annuli
    beams, rejected = cut_beams(annuli, 0.04, **options)
    assert rejected == ()
    volumes = beam_volumes(beams)
    for i in range(0, beams.n_beams, 9):
        hull = ConvexHull(beams.corners[i].reshape(-1, 3))
        assert abs(volumes[i] / hull.volume - 1) < 1e-12


def test_law_e6_volume_of_a_square_cut_ring(ball: Mesh) -> None:
    """Beams along meridians of a ball: sectors of rings, less the triangles at the nodes."""
    annuli = annulus_support(central_spheres(ball), depth=0.2).annuli
    beams, _ = cut_beams(annuli, 0.05, node_radius=1e-12)
    outer, inner = section_arcs(beams)
    sweep = arc_circles(outer).sweeps
    expected = sweep / 2 * (2.0**2 - 1.8**2) * 0.05
    assert np.abs(arc_circles(outer).radii - 2).max() < 1e-10
    assert np.abs(arc_circles(inner).radii - 1.8).max() < 1e-10
    assert np.abs(beam_volumes(beams) / expected - 1).max() < 1e-9


@pytest.mark.parametrize("exponent", [-3.0, -1.3, 0.4, 3.0])
def test_law_e6_nothing_depends_on_scale(exponent: float) -> None:
    scale = 10**exponent
    mesh = torus_net(10, 6, 3.0, 1.0)
    sphere_mesh = central_spheres(mesh)
    large = central_spheres(Mesh(scale * mesh.vertices, mesh.faces))
    first, _ = cut_beams(annulus_support(sphere_mesh, depth=0.1).annuli, 0.05, 0.01)
    second, _ = cut_beams(
        annulus_support(large, depth=0.1 * scale).annuli, 0.05 * scale, 0.01 * scale
    )
    assert np.abs(second.corners / scale - first.corners).max() < 1e-10
    assert np.abs(beam_volumes(second) / scale**3 / beam_volumes(first) - 1).max() < 1e-10
    scaled = scale_beams(first, scale)
    assert np.abs(scaled.corners / scale - first.corners).max() < 1e-14
    assert np.abs(beam_volumes(scaled) / beam_volumes(second) - 1).max() < 1e-10


def test_a_power_to_the_outer_side_turns_the_beam_over() -> None:
    sphere_mesh = central_spheres(torus_net(24, 12, 3.0, 1.0))
    annuli = annulus_support(sphere_mesh, kappa=-0.1).annuli
    beams, rejected = cut_beams(annuli, 0.02)
    assert rejected == ()
    down = beams.corners[:, :, 1, 1] - beams.corners[:, :, 0, 1]
    assert (dot(down, beams.annuli.end_directions) > 0).all()
    assert (beam_volumes(beams) > 0).all()


# what cannot be made


def test_beams_that_cannot_be_cut_are_listed(annuli: Annuli) -> None:
    beams, rejected = cut_beams(annuli, 0.9)
    assert 0 < len(rejected) < annuli.n_annuli
    assert beams.n_beams + len(rejected) == annuli.n_annuli
    assert {beam.reason.split(":")[0] for beam in rejected} <= {
        "the cuts of the two ends cross",
        "the cut of an end misses a circle",
    }
    for beam in rejected:
        assert beam.id == f"B{beam.element_id:04d}"


def test_a_gap_that_cuts_off_one_mitre_leaves_one_plane(annuli: Annuli) -> None:
    beams, _ = cut_beams(annuli, 0.01, node_gap=0.2)
    assert beams.is_flat.any()
    assert (np.abs(beams.levels[..., 1]) < beams.thickness / 2).all()
    gaps = beam_facts(beams).clearances
    assert gaps.min() > 0.2 - 1e-12


def test_law_twisted_beams_stay_behind_their_mitres() -> None:
    """Planes that miss the node axes, in direction and in place, leave gaps, no overlaps."""
    torus = central_spheres(torus_net(12, 8, 3.0, 1.0))
    annuli = annulus_support(torus, depth=0.15).annuli
    rng = np.random.default_rng(3)
    tilt = 0.02 * rng.standard_normal((annuli.n_annuli, 1))
    x, y, z = np.moveaxis(annuli.frames, 1, 0)
    turned = np.stack(
        [x, y * np.cos(tilt) + z * np.sin(tilt), z * np.cos(tilt) - y * np.sin(tilt)], 1
    )
    moved = annuli.origins + 0.002 * rng.standard_normal((annuli.n_annuli, 1)) * z

    def _turn(vectors: FloatArray) -> FloatArray:
        local = np.einsum("bij,b...j->b...i", annuli.frames, vectors)
        return np.einsum("bij,b...i->b...j", turned, local)

    rows = {
        name: np.concatenate([row[:, :1], _turn(row[:, 1:4]), row[:, 4:]], 1)
        for name, row in (("outer", annuli.outer), ("inner", annuli.inner))
    }
    twisted = replace(
        annuli, origins=moved, frames=turned, corners=_turn(annuli.corners),
        end_directions=_turn(annuli.end_directions), **rows,
    )  # fmt: skip
    beams, rejected = cut_beams(twisted, 0.03)
    assert rejected == ()
    facts = beam_facts(beams)
    assert np.degrees(facts.twists).max() > 1
    assert facts.clearances.min() > -1e-8
    mitres = mitre_normals(twisted, mitre_angles(twisted))
    apart = beams.corners - node_points(twisted)[:, :, None, None]
    for side, levels in ((0, (0, 1)), (1, (1, 2))):
        behind = dot(mitres[:, :, side, None, None], apart[:, :, :, list(levels)])
        assert behind.min() > -1e-8


def test_beams_in_the_same_direction_are_listed(annuli: Annuli) -> None:
    once = select_parts(annuli, np.arange(annuli.n_annuli) == 0)
    arrays: dict[str, FloatArray] = {
        name: value for name, value in vars(once).items() if isinstance(value, np.ndarray)
    }
    twice = replace(
        once,
        ids=once.ids * 2,
        panel_ids=once.panel_ids * 2,
        **{name: np.concatenate([array, array]) for name, array in arrays.items()},
    )
    beams, rejected = cut_beams(twice, 0.01)
    assert beams.n_beams == 0
    assert all("same direction" in beam.reason for beam in rejected)


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"thickness": 0.0}, "thickness must be a length above 0"),
        ({"thickness": np.nan}, "thickness must be a length above 0"),
        ({"thickness": 0.1, "node_gap": -1.0}, "node gap must be a length"),
        ({"thickness": 0.1, "node_radius": np.inf}, "node radius must be a length"),
    ],
)
def test_bad_options_are_refused(annuli: Annuli, options: dict[str, float], match: str) -> None:
    with pytest.raises(InputError, match=match):
        cut_beams(annuli, **options)


def test_no_annuli_make_no_beams(nets: dict[str, Mesh]) -> None:
    none = annulus_support(face_planes(nets["egg"]), kappa=0.1).annuli
    beams, rejected = cut_beams(none, 0.1)
    assert beams.n_beams == len(rejected) == 0
    assert len(beam_volumes(beams)) == len(beam_lengths(beams)) == 0
    assert node_axis_segments(beams)[0] == ()


# contours


@pytest.mark.parametrize("spheres", [central_spheres, face_planes])
def test_contours_are_the_sections_in_their_plane(
    nets: dict[str, Mesh], spheres: Callable[[Mesh], SphereMesh]
) -> None:
    size = mean_edge_length(nets["egg"])
    annuli = annulus_support(spheres(nets["egg"]), depth=0.2 * size).annuli
    beams, _ = cut_beams(annuli, 0.05 * size, node_radius=0.02 * size)
    contours = beam_contours(beams)
    x, y = np.moveaxis(contours.corners, -1, 0)
    following = np.roll(contours.corners, -1, axis=1)
    polygon = (x * following[..., 1] - y * following[..., 0]).sum(axis=1) / 2
    # a positive bulge adds area to a counter-clockwise contour
    half = norm(following - contours.corners) / 2
    flat = np.zeros_like(contours.corners[..., :1])
    arcs = Arcs(
        np.concatenate([contours.corners, flat], -1).reshape(-1, 3),
        np.concatenate([following, flat], -1).reshape(-1, 3),
        np.zeros((contours.bulges.size, 3)),
        (contours.bulges * half).ravel(),
    )
    area = polygon + segment_areas(arcs).reshape(-1, 4).sum(axis=1)
    assert np.abs(area * beams.thickness / beam_volumes(beams) - 1).max() < 1e-12
    boxes = contour_boxes(contours)
    assert (boxes[:, 1] > boxes[:, 0]).all()
    for section in section_arcs(beams):
        points = arc_points(section, np.linspace(-1, 1, 21))
        axes = beams.annuli.frames
        flat = np.stack([dot(points, axes[:, None, i]) for i in (0, 1)], -1)
        assert (flat > boxes[:, None, 0] - 1e-12).all()
        assert (flat < boxes[:, None, 1] + 1e-12).all()
    assert np.abs(contours.bevels - np.pi / 2).max() < 1e-12
    assert (beam_lengths(beams) >= (boxes[:, 1] - boxes[:, 0])[:, 0] - 1e-12).all()


def test_bevels_are_the_half_angles(annuli: Annuli) -> None:
    beams, _ = cut_beams(annuli, 0.03, node_gap=0.004)
    assert np.abs(beam_contours(beams).bevels - mitre_angles(annuli)).max() < 1e-12


@given(st.integers(0, 100))
def test_law_pieces_on_shelves_do_not_touch(seed: int) -> None:
    rng = np.random.default_rng(seed)
    sizes = rng.uniform(0.1, 5, (40, 2))
    sizes[7] = [12, 1]
    places, sheets, oversize = shelves(sizes, (10.0, 8.0), 0.2)
    assert oversize == [7]
    assert sheets[7] == max(sheets)
    assert sheets.count(sheets[7]) == 1
    assert sorted(set(sheets)) == list(range(max(sheets) + 1))
    ends = places + sizes
    fits = np.arange(40) != 7
    assert (places[fits] >= 0.2 - 1e-12).all()
    assert (ends[fits] <= np.array([9.8, 7.8]) + 1e-12).all()
    for i in range(40):
        for j in range(i):
            if sheets[i] == sheets[j]:
                gap = np.maximum(places[i] - ends[j], places[j] - ends[i]).max()
                assert gap >= 0.2 - 1e-12


def test_areas_between_arcs_and_chords() -> None:
    bulges = np.array([1e-6, 1e-3, 0.0199999, 0.0200001, 0.3, 1.0, -0.5, 0.0])
    starts, ends = np.zeros((8, 3)), np.tile([2.0, 0, 0], (8, 1))
    arcs = Arcs(starts, ends, np.tile([0.0, 1, 0], (8, 1)), bulges)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    points = arc_points(arcs, nodes)
    square = bulges[:, None] ** 2
    speed = (1 + square) * (1 - square * nodes**2) / (1 + square * nodes**2) ** 2
    expected = (points[..., 1] * speed) @ weights
    assert np.abs(segment_areas(arcs) - expected).max() < 3e-14
    assert np.abs(segment_areas(arcs)[:-1] / expected[:-1] - 1).max() < 1e-11
