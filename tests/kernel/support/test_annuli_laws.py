"""Laws of the annuli under the edges of a sphere mesh (E5, E6)."""

import json
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, IntArray, dot, norm
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.optimization.angle_minimization import minimize_angles
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.spheres.arcs import Arcs, arc_points, sphere_arcs
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.kernel.spheres.incidence import evaluate, normals, signed_distance
from spheremesh.kernel.spheres.rows import center_radius, from_center_radius, normalize, rescale
from spheremesh.kernel.support.annuli import Annuli, corner_mismatch
from spheremesh.kernel.support.annulus_construction import annulus_report, annulus_support
from spheremesh.kernel.support.node_axes import support_structure
from spheremesh.kernel.surfaces.circular_nets import roof_net, torus_net


def annulus_arcs(annuli: Annuli) -> tuple[Arcs, Arcs]:
    """Outer and inner arcs in local coordinates, from the first to the second end."""
    planes = -annuli.frames[:, 2]
    outer, inner = (
        sphere_arcs(rows, planes, annuli.corners[:, 0, k], annuli.corners[:, 1, k])
        for k, rows in enumerate((annuli.outer, annuli.inner))
    )
    return outer, inner


@pytest.fixture(scope="module")
def torus() -> SphereMesh:
    return central_spheres(torus_net(24, 12, 3.0, 1.0))


def through_two_points(n_faces: int) -> SphereMesh:
    """A closed chain: spheres through the origin and a point below, around one node."""
    rng = np.random.default_rng(n_faces)
    turns = 2 * np.pi * (np.arange(n_faces) + rng.uniform(-0.2, 0.2, n_faces)) / n_faces
    across = np.stack([np.cos(turns), np.sin(turns), 0 * turns], 1)
    centers = rng.uniform(0.3, 0.8, n_faces)[:, None] * across + [0, 0, -2.0]
    squares = dot(centers, centers)
    rows = -normalize(from_center_radius(centers, squares))
    following = np.roll(np.arange(n_faces), 1)
    # rim vertices where three spheres' circles go on: on the circle of both neighbours
    apart = centers - centers[following]
    other = np.stack([apart[:, 1], -apart[:, 0], 0 * turns], 1)
    other *= np.sign(dot(other, across + across[following]))[:, None]
    other /= norm(other)[:, None]
    middle = centers - dot(centers, other)[:, None] * other
    middle = np.stack([0 * turns, 0 * turns, middle[:, 2]], 1)
    rim = middle + 0.5 * other
    steps = np.sqrt(
        squares - dot(middle + 0.5 * other - centers, middle + 0.5 * other - centers)
    )
    rim = rim + steps[:, None] * [0, 0, 1.0]
    ids = np.arange(n_faces)
    faces = np.stack([0 * ids, 1 + ids, 1 + (ids + 1) % n_faces], 1)
    return SphereMesh(Mesh(np.concatenate([np.zeros((1, 3)), rim]), faces), rows)


def radii_squared(rows: FloatArray) -> FloatArray:
    return center_radius(rows)[1]


# E5


@pytest.mark.parametrize("share", [-1.0, 0.2, 0.9])
def test_law_e5_constant_power_keeps_planes_and_centers(
    torus: SphereMesh, share: float
) -> None:
    limit = annulus_support(torus, depth=0.01).kappa_max
    kappa = share * limit
    annuli = annulus_support(torus, kappa=kappa).annuli
    assert annuli.n_annuli == 2 * torus.mesh.n_faces
    outer, inner = center_radius(annuli.outer)[0], center_radius(annuli.inner)[0]
    size = np.sqrt(radii_squared(annuli.outer))
    assert (norm(outer - inner) / size).max() < 1e-15
    drop = radii_squared(annuli.outer) - radii_squared(annuli.inner)
    assert (np.abs(drop - kappa) / radii_squared(annuli.outer)).max() < 1e-14
    structure = support_structure(torus)
    half = norm(structure.axes[:, 1] - structure.axes[:, 0]) / 2
    steps = dot(annuli.corners[:, :, 1] - annuli.corners[:, :, 0], annuli.end_directions)
    inner_half = half[annuli.edge_vertices] - steps
    change = half[annuli.edge_vertices] ** 2 - inner_half**2 - kappa
    assert (np.abs(change) / half.max() ** 2).max() < 1e-13


def test_law_e5_the_inner_corners_lie_on_the_concentric_spheres(torus: SphereMesh) -> None:
    kappa = 0.1
    annuli = annulus_support(torus, kappa=kappa).annuli
    centers, squares = center_radius(torus.spheres)
    concentric = normalize(from_center_radius(centers, squares - kappa))
    corners = annuli.corners[:, :, 1] + annuli.origins[:, None]
    for faces in annuli.edge_faces.T:
        for end in (0, 1):
            assert np.abs(signed_distance(concentric[faces], corners[:, end])).max() < 1e-13


@pytest.mark.parametrize("n_faces", [3, 4, 6])
def test_law_e5_a_closed_chain_of_annuli_meets_in_the_same_two_points(n_faces: int) -> None:
    sphere_mesh = through_two_points(n_faces)
    for kappa in (-1.0, 1.0, 3.9):
        annuli = annulus_support(sphere_mesh, kappa=kappa).annuli
        spokes = np.flatnonzero((annuli.edge_vertices == 0).any(axis=1))
        assert len(spokes) == n_faces
        step = 2 - np.sqrt(4 - kappa)
        for height in (-step, step - 4):
            point = np.array([0, 0, height]) - annuli.origins[spokes]
            assert np.abs(evaluate(annuli.inner[spokes], point)).max() < 1e-12


def test_law_e5_the_range_of_the_power(torus: SphereMesh) -> None:
    structure = support_structure(torus)
    half = norm(structure.axes[:, 1] - structure.axes[:, 0]) / 2
    found = annulus_support(torus, depth=0.01)
    assert abs(found.kappa_max / (half.min() ** 2) - 1) < 1e-12
    assert found.kappa_max < radii_squared(found.annuli.outer).min()
    annulus_support(torus, kappa=found.kappa_max * (1 - 1e-12))
    with pytest.raises(InputError, match=r"admissible range: at most 2\.6418"):
        annulus_support(torus, kappa=found.kappa_max * (1 + 1e-9))


# E6


@pytest.mark.parametrize("name", ["torus", "egg", "catenoid", "vase"])
@pytest.mark.parametrize("spheres", [central_spheres, face_planes])
def test_law_e6_annuli_share_their_ends_at_nodes_without_torsion(
    nets: dict[str, Mesh], name: str, spheres: Callable[[Mesh], SphereMesh]
) -> None:
    sphere_mesh = spheres(nets[name])
    size = mean_edge_length(nets[name])
    found = annulus_support(sphere_mesh, depth=0.2 * size)
    assert found.annuli.n_annuli > 0.3 * len(nets[name].corners) / 2
    assert corner_mismatch(found.annuli).max() < 1e-11 * size
    if spheres is central_spheres:
        found = annulus_support(sphere_mesh, kappa=0.5 * found.kappa_max)
        assert corner_mismatch(found.annuli).max() < 1e-10 * size


def test_law_e6_the_depth_is_that_on_the_node_axis(torus: SphereMesh) -> None:
    annuli = annulus_support(torus, depth=0.15).annuli
    structure = support_structure(torus)
    for end in (0, 1):
        vertices = annuli.edge_vertices[:, end]
        points = annuli.corners[:, end] + annuli.origins[:, None]
        expected = torus.mesh.vertices[vertices]
        assert norm(points[:, 0] - expected).max() < 1e-13
        expected = expected + 0.15 * structure.directions[vertices]
        assert norm(points[:, 1] - expected).max() < 1e-13


def test_law_e6_the_arcs_join_the_corners(torus: SphereMesh) -> None:
    for annuli in (
        annulus_support(torus, depth=0.15).annuli,
        annulus_support(torus, kappa=0.1).annuli,
    ):
        for rows, arcs in zip((annuli.outer, annuli.inner), annulus_arcs(annuli), strict=True):
            points = arc_points(arcs, np.linspace(-1, 1, 7))
            assert np.abs(evaluate(rows[:, None], points)).max() < 1e-13
            assert np.abs(dot(points, annuli.frames[:, None, 2])).max() < 1e-13
        # the outer arc lies on both spheres
        model = arc_points(annulus_arcs(annuli)[0], np.linspace(-1, 1, 7))
        model = model + annuli.origins[:, None]
        for faces in annuli.edge_faces.T:
            rows = torus.spheres[faces][:, None]
            assert np.abs(signed_distance(rows, model)).max() < 1e-12


def test_law_e6_equal_ends_make_concentric_arcs(torus: SphereMesh) -> None:
    annuli = annulus_support(torus, depth=0.15).annuli
    along = annuli.corners[:, 1, 0] - annuli.corners[:, 0, 0]
    leans = [dot(along, annuli.end_directions[:, end]) for end in (0, 1)]
    equal = np.abs(leans[0] + leans[1]) < 1e-12
    assert 0.4 < equal.mean() < 0.9
    shift = norm(center_radius(annuli.outer)[0] - center_radius(annuli.inner)[0])
    assert shift[equal].max() < 1e-11
    assert shift[~equal].min() > 1e-6
    # elsewhere the center is the nearest possible: it moves along the inner chord
    chord = annuli.corners[:, 1, 1] - annuli.corners[:, 0, 1]
    moved = center_radius(annuli.inner)[0] - center_radius(annuli.outer)[0]
    assert norm(np.cross(moved, chord)).max() < 1e-12


def test_straight_annuli_have_straight_inner_edges(nets: dict[str, Mesh]) -> None:
    annuli = annulus_support(face_planes(nets["egg"]), depth=0.1).annuli
    for arcs in annulus_arcs(annuli):
        assert (arcs.sagittas == 0).all()
    assert (annuli.inner[:, 0] == 0).all()


# invariance


@given(st.floats(-3, 3), st.integers(0, 3))
def test_law_e6_nothing_depends_on_scale_and_turn(exponent: float, seed: int) -> None:
    sphere_mesh = central_spheres(torus_net(10, 6, 3.0, 1.0))
    scale = 10**exponent
    turn = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    rows = rescale(sphere_mesh.spheres, scale)
    rows[:, 1:4] = rows[:, 1:4] @ turn.T
    mesh = Mesh(scale * sphere_mesh.mesh.vertices @ turn.T, sphere_mesh.mesh.faces)
    for key, power in (("depth", 1), ("kappa", 2)):
        expected = annulus_support(sphere_mesh, **{key: 0.1}).annuli
        actual = annulus_support(SphereMesh(mesh, rows), **{key: 0.1 * scale**power}).annuli
        assert np.abs(actual.corners / scale - expected.corners @ turn.T).max() < 1e-11
        assert np.abs(actual.tilt - expected.tilt).max() < 1e-11


def test_law_e6_nothing_depends_on_the_site(torus: SphereMesh) -> None:
    mesh = torus.mesh
    shift = 1e6 * mean_edge_length(mesh) * np.array([0.6, -0.64, 0.48])
    moved = Mesh(mesh.vertices + shift, mesh.faces)
    far = annulus_support(SphereMesh.from_local(moved, torus.local_spheres), depth=0.1)
    near = annulus_support(torus, depth=0.1)
    # the vertices themselves are rounded by 1e-10 edges there
    assert np.abs(far.annuli.corners - near.annuli.corners).max() < 1e-8
    assert corner_mismatch(far.annuli).max() < 1e-8


def test_law_e6_nothing_depends_on_the_numbering(
    nets: dict[str, Mesh], renumber: Callable[[Mesh], tuple[Mesh, IntArray]]
) -> None:
    sphere_mesh = minimize_angles(fit_spheres(nets["roof"]), 0.0, None)[0]
    shuffled, new = renumber(sphere_mesh.mesh)
    local = np.empty_like(sphere_mesh.local_spheres)
    local[new] = sphere_mesh.local_spheres

    def measures(annuli: Annuli) -> FloatArray:
        middles = annuli.corners.mean(axis=(1, 2)) + annuli.origins
        table = np.column_stack([middles, annuli.tilt, annuli.inner[:, 0]])
        return table[np.lexsort(np.round(middles, 6).T)]

    first = annulus_support(sphere_mesh, depth=0.3)
    second = annulus_support(SphereMesh.from_local(shuffled, local), depth=0.3)
    assert len(first.rejected) == len(second.rejected) > 0
    assert np.abs(measures(first.annuli) - measures(second.annuli)).max() < 1e-9


# limits


def test_annuli_that_cannot_stand_are_listed(nets: dict[str, Mesh]) -> None:
    found = annulus_support(central_spheres(nets["vase"]), depth=0.05)
    reasons = {beam.reason.split(" ")[1] for beam in found.rejected}
    assert {"plane", "node"} <= reasons
    assert found.annuli.tilt.max() <= np.radians(60)
    total = len(nets["vase"].corners) - len(nets["vase"].topology.edge_corners)
    assert found.annuli.n_annuli + len(found.rejected) == total
    assert not {beam.id for beam in found.rejected} & set(found.annuli.ids)
    strict = annulus_support(central_spheres(nets["vase"]), depth=0.05, max_tilt=0.2)
    assert strict.annuli.tilt.max() <= 0.2
    assert len(strict.rejected) > len(found.rejected)


def test_where_no_annulus_stands_all_are_listed() -> None:
    arch = [[x, y, -0.02 * (x - 2) ** 2] for x in range(5) for y in range(5)]
    corners = [5 * i + j for i in range(4) for j in range(4)]
    faces = [[c, c + 5, c + 6, c + 1] for c in corners]
    sphere_mesh = minimize_angles(face_planes(Mesh(arch, faces)), 0.0, None)[0]
    for options in ({"depth": 0.1}, {"kappa": 0.1}):
        found = annulus_support(sphere_mesh, max_tilt=1e-3, **options)
        assert found.annuli.n_annuli < 20
        assert found.annuli.n_annuli + len(found.rejected) == 40
        report = annulus_report(found, 1.0)
        assert report["made"] == found.annuli.n_annuli
        assert json.loads(json.dumps(dict(report), allow_nan=False)) == report


def test_annuli_deeper_than_their_radius_are_listed(ball: Mesh) -> None:
    found = annulus_support(fit_spheres(ball), depth=1.99)
    assert found.annuli.n_annuli > 0
    found = annulus_support(fit_spheres(ball), depth=2.01)
    assert found.annuli.n_annuli == 0
    assert all(
        "not less than the radius" in beam.reason or "cross" in beam.reason
        for beam in found.rejected
    )


def test_annuli_whose_axes_lean_across_their_arcs_are_listed() -> None:
    """Their outline would cross itself, though no solid modeller says so."""
    quads = roof_net(5, 4, 10.0)
    halves = [
        half
        for a, b, c, d in (face.tolist() for face in quads.faces)
        for half in ((a, b, c), (a, c, d))
    ]
    mesh = Mesh(quads.vertices, halves)
    angles = np.random.default_rng(6).uniform(-0.7, 0.7, mesh.n_faces)
    pencils = circle_pencils(face_circles(mesh)[0])
    rough = SphereMesh.from_local(mesh, pencil_spheres(*pencils, angles))
    found = annulus_support(rough, 0.1 * mean_edge_length(mesh))
    assert any("leans across the arc" in beam.reason for beam in found.rejected)
    annuli = found.annuli
    for k, rows in enumerate((annuli.outer, annuli.inner)):
        upright = normals(rows[:, None], annuli.corners[:, :, k])
        assert (dot(upright, annuli.end_directions) < 0).all()


def test_constant_power_has_no_depth_on_straight_arcs(nets: dict[str, Mesh]) -> None:
    found = annulus_support(face_planes(nets["egg"]), kappa=0.1)
    assert found.annuli.n_annuli == 0
    assert all("give a depth" in beam.reason for beam in found.rejected)
    report = annulus_report(found, 1.0)
    assert report["kappa_max"] is None


def test_the_boundary_has_annuli(nets: dict[str, Mesh]) -> None:
    annuli = annulus_support(central_spheres(nets["catenoid"]), depth=0.05).annuli
    rim = annuli.edge_faces[:, 1] < 0
    assert rim.sum() == 32
    assert (annuli.edge_faces[:, 0] >= 0).all()


def test_the_report_is_plain(torus: SphereMesh) -> None:
    report = annulus_report(annulus_support(torus, depth=0.1), 1.0)
    assert json.loads(json.dumps(dict(report), allow_nan=False)) == report
    assert abs(report["end_depth"]["max"] - 0.1) < 1e-12
    assert report["corner_mismatch"]["max"] < 1e-12


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({}, "either a depth or a power"),
        ({"depth": 0.1, "kappa": 0.1}, "either a depth or a power"),
        ({"depth": 0.0}, "depth must be a length above 0"),
        ({"depth": np.nan}, "depth must be a length above 0"),
        ({"kappa": 0.0}, "kappa must be a number other than 0"),
        ({"depth": 0.1, "max_tilt": 0.0}, "max_tilt"),
    ],
)
def test_bad_options_are_refused(
    torus: SphereMesh, options: dict[str, float], match: str
) -> None:
    with pytest.raises(InputError, match=match):
        annulus_support(torus, **options)
