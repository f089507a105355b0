"""The nodes of the category Support."""

import json
import warnings
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.arrays import FloatArray, dot, norm, unit
from spheremesh.kernel.beams.beams import Beams
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.tolerances import VERTEX_MISS
from spheremesh.nodes import (
    Graph,
    annulus_support,
    axis_support,
    beams,
    bisector_support,
    cadquery_solids,
    central_spheres,
    drilling_marks,
    ellipsoid_mesh,
    equal_radii,
    face_planes,
    fit_spheres,
    keep_spheres,
    land_nodes,
    least_joint,
    least_node_radius,
    minimize_angles,
    node_axes,
    optimize_spheres,
    panels,
    render_assembly,
    roof_mesh,
    support_feasibility,
    support_structure,
    torus_mesh,
    triangulate,
    vase_mesh,
    vertex_error,
    write_3dm,
    write_dxf,
)


def test_support_structure_gives_degrees_and_a_plain_report() -> None:
    found = support_structure(face_planes(torus_mesh()))
    assert found.is_valid.all()
    assert found.torsion.max() < 1e-9
    assert found.axes.shape == (len(found.torsion), 2, 3)
    assert json.loads(json.dumps(dict(found.report), allow_nan=False)) == found.report


def test_support_structure_warns_of_invalid_nodes() -> None:
    sphere_mesh = minimize_angles(central_spheres(roof_mesh())).sphere_mesh
    with pytest.warns(UserWarning, match="nodes are not valid"):
        found = support_structure(sphere_mesh)
    inside = ~sphere_mesh.mesh.topology.is_boundary_vertex
    assert found.report["torsion_deg"]["max"] == found.torsion[inside].max()
    assert found.report["valid"] == int(np.sum(found.is_valid))


@pytest.mark.filterwarnings("ignore:for nodes without torsion spheres flatten")
@pytest.mark.parametrize("mesh", [vase_mesh(9, 7), roof_mesh(10, 14)])
def test_beams_of_landed_nodes_meet(mesh: Mesh) -> None:
    start = minimize_angles(central_spheres(mesh)).sphere_mesh
    optimum = optimize_spheres(start, regularity=3.5, support=1.0).sphere_mesh
    landed = land_nodes(optimum)
    assert json.loads(json.dumps(dict(landed.report), allow_nan=False)) == landed.report
    assert landed.report["landed"]
    edge = mean_edge_length(mesh)
    moves = norm(landed.sphere_mesh.mesh.vertices - mesh.vertices) / edge
    np.testing.assert_allclose(moves.max(), landed.report["moved"]["max"], rtol=1e-6)
    assert vertex_error(landed.sphere_mesh).max() < 1e-8 * edge
    before, after = (ends_apart(found) / edge for found in (optimum, landed.sphere_mesh))
    assert after < 1e-8
    assert after < 1e-5 * before


def test_misses_that_landing_takes_away_are_no_warning() -> None:
    mesh = roof_mesh(6, 8)
    noise = 0.01 * mean_edge_length(mesh) * np.random.default_rng(0).normal(size=(63, 3))
    rough = Mesh(mesh.vertices + noise, [list(face) for face in mesh.faces])
    start = minimize_angles(fit_spheres(rough)).sphere_mesh
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        optimum = optimize_spheres(start, regularity=3.5, support=1.0)
        landed = land_nodes(optimum.sphere_mesh)
    assert optimum.report["vertex_error"]["relative_to_edge"] > VERTEX_MISS
    assert landed.report["landed"]
    assert vertex_error(landed.sphere_mesh).max() < 1e-9
    assert not [each for each in caught if "miss" in str(each.message)]


def test_nodes_without_torsion_that_flatten_spheres_say_so() -> None:
    start = minimize_angles(fit_spheres(roof_mesh(10, 14))).sphere_mesh
    with pytest.warns(UserWarning, match=r"spheres flatten to \d+ % .* take axis_support"):
        optimize_spheres(start, regularity=3.5, support=1.0)


def ends_apart(sphere_mesh: SphereMesh) -> float:
    """Largest distance of the ends of two beams at a node, inside or on a side with corners."""
    annuli = annulus_support(sphere_mesh, depth=0.1).annuli
    ends = (annuli.corners + annuli.origins[:, None, None]).reshape(-1, 2, 3)
    vertices = annuli.edge_vertices.ravel()
    valences = np.bincount(vertices)
    inner = ~sphere_mesh.mesh.topology.is_boundary_vertex
    judged = np.flatnonzero(inner | (valences.min() == 2))
    return max(float(np.ptp(ends[vertices == vertex], axis=0).max()) for vertex in judged)


def test_nodes_that_are_far_stay_where_they_are() -> None:
    start = minimize_angles(central_spheres(roof_mesh(8, 12))).sphere_mesh
    with pytest.warns(UserWarning, match=r"beams do not meet exactly: .* 1e-06 are allowed"):
        found = land_nodes(start, max_move=1e-6)
    assert found.sphere_mesh is start
    assert not found.report["landed"]


def test_spheres_that_are_built_as_planes_do_not_land_by_their_far_centers() -> None:
    """They share two points, one of them beyond a billion edges: no beam knows of that."""
    rows = vase_mesh(9, 7).vertices
    sheared = rows * [1, 1.2, 1] + 0.3 * rows[:, 2:] ** 2 * [1, 0, 0]
    mesh = Mesh(sheared, [list(face) for face in vase_mesh(9, 7).faces])
    nearly_plane = planes_on_far_centers(face_planes(mesh))
    with pytest.warns(UserWarning, match="too large to tell from planes"):
        found = land_nodes(nearly_plane)
    assert found.sphere_mesh is nearly_plane
    assert ends_apart(found.sphere_mesh) > 1e-3 * mean_edge_length(mesh)


def planes_on_far_centers(planes: SphereMesh) -> SphereMesh:
    """The planes bent to spheres of a billion edges."""
    rows = planes.local_spheres.copy()
    rows[:, 0] = 1e-10 / mean_edge_length(planes.mesh)
    return SphereMesh.from_local(planes.mesh, rows)


def test_annulus_support_reports_and_warns() -> None:
    sphere_mesh = minimize_angles(central_spheres(roof_mesh())).sphere_mesh
    with pytest.warns(UserWarning, match="annuli cannot be made"):
        found = annulus_support(sphere_mesh, depth=0.2)
    assert json.loads(json.dumps(dict(found.report), allow_nan=False)) == found.report
    assert found.report["made"] == found.annuli.n_annuli
    with pytest.raises(InputError, match="either a depth or a power"):
        annulus_support(sphere_mesh, depth=0.2, kappa=0.1)


def test_beams_reports_and_warns() -> None:
    sphere_mesh = face_planes(torus_mesh())
    annuli = annulus_support(sphere_mesh, depth=0.1).annuli
    made = beams(annuli, 0.02, node_gap=0.005)
    assert json.loads(json.dumps(dict(made.report), allow_nan=False)) == made.report
    assert made.report["written"] == made.beams.n_beams == annuli.n_annuli
    assert 0 < made.report["volume"] < annuli.n_annuli * made.report["longest"] * 0.1 * 0.02
    with pytest.warns(UserWarning, match="beams cannot be made"):
        thick = beams(annuli, 0.3)
    assert len(thick.report["rejected"]) + thick.report["written"] == annuli.n_annuli


def test_a_graph_from_spheres_to_drawings(tmp_path: Path) -> None:
    graph = Graph("support")
    mesh = graph.add(torus_mesh, n_around=8, n_across=6)
    spheres = graph.add(face_planes, mesh=mesh)
    annuli = graph.add(annulus_support, sphere_mesh=spheres, depth=0.1)
    cut = graph.add(beams, annuli=annuli.annuli, thickness=0.02)
    drawing = graph.add(write_dxf, beams=cut.beams, path=str(tmp_path / "b.dxf"))
    model = graph.add(write_3dm, beams=cut.beams, path=str(tmp_path / "b.3dm"))
    assert graph.run(drawing) == str(tmp_path / "b.dxf")
    assert graph.run(model) == str(tmp_path / "b.3dm")
    small = graph.add(
        write_dxf, beams=cut.beams, path=str(tmp_path / "s.dxf"), sheet=(500.0, 300.0)
    )
    with pytest.warns(UserWarning, match="larger than the sheet"):
        graph.run(small)


def test_drilling_marks_report_and_warn(tmp_path: Path) -> None:
    annuli = annulus_support(face_planes(torus_mesh(8, 6)), depth=0.3).annuli
    cut = beams(annuli, 0.05).beams
    drilled = drilling_marks(cut, 3)
    assert drilled.report == {
        "marked": cut.n_beams, "diameter": pytest.approx(0.025), "inset": pytest.approx(0.0375),
        "counts": {}, "notes": [],
    }  # fmt: skip
    with pytest.warns(UserWarning, match="beams get no drilling marks: B0000"):
        crowded = drilling_marks(cut, 2, diameter=0.2, inset=0.2)
    assert json.loads(json.dumps(dict(crowded.report), allow_nan=False)) == crowded.report
    assert crowded.report["counts"] == {"B208": cut.n_beams}
    assert crowded.report["marked"] == 0
    assert [note["id"] for note in crowded.report["notes"]] == list(cut.annuli.ids)
    # Nothing to draw is no error.
    for path in (
        write_dxf(crowded.beams, str(tmp_path / "d.dxf")),
        write_3dm(beams=crowded.beams, path=str(tmp_path / "d.3dm")),
    ):
        assert Path(path).stat().st_size > 1000


def test_rejected_beams_have_codes_in_reports() -> None:
    sphere_mesh = minimize_angles(central_spheres(roof_mesh())).sphere_mesh
    with pytest.warns(UserWarning, match="annuli cannot be made"):
        found = annulus_support(sphere_mesh, depth=0.2)
    assert {entry["code"] for entry in found.report["rejected"]} == {"B100"}
    annuli = annulus_support(face_planes(torus_mesh()), depth=0.1).annuli
    with pytest.warns(UserWarning, match="beams cannot be made"):
        thick = beams(annuli, 0.3)
    assert {entry["code"] for entry in thick.report["rejected"]} == {"B101"}


# Beams in the walls of the panels


def test_beams_on_axes_carry_their_panels() -> None:
    smooth = minimize_angles(fit_spheres(roof_mesh(6, 8))).sphere_mesh
    annuli, axes, report = axis_support(smooth, depth=0.2)
    assert axes.shape == (smooth.mesh.n_vertices, 2, 3)
    np.testing.assert_array_equal(axes[:, 0], smooth.mesh.vertices)
    np.testing.assert_allclose(norm(axes[:, 1] - axes[:, 0]), mean_edge_length(smooth.mesh))
    assert json.loads(json.dumps(dict(report), allow_nan=False)) == report
    cut = panels(smooth, edges="axis", axes=axes)
    assert cut.report["rejected"] == report["rejected"] == []
    edge = mean_edge_length(smooth.mesh)
    np.testing.assert_allclose(
        cut.report["edge_gap"]["middle_max"] / edge, report["gap"]["max"]
    )
    np.testing.assert_allclose(
        cut.report["edge_gap"]["corner_max"] / edge, report["gap"]["corner_max"]
    )
    assert report["torsion_deg"]["max"] < 0.05
    drilled = drilling_marks(beams(annuli, thickness=0.02).beams, diameter=0.01)
    assert drilled.report["marked"] == annuli.n_annuli


def test_axes_may_be_given() -> None:
    smooth = minimize_angles(fit_spheres(roof_mesh(6, 8))).sphere_mesh
    axes = node_axes(smooth)
    given = axis_support(smooth, depth=0.2, axes=axes)
    np.testing.assert_array_equal(
        given.annuli.frames, axis_support(smooth, depth=0.2).annuli.frames
    )
    # mirror points of support_structure may lie on the outer side
    turned = np.where(np.arange(len(axes))[:, None, None] % 2, axes, axes[:, ::-1])
    np.testing.assert_allclose(
        axis_support(smooth, depth=0.2, axes=turned).annuli.frames, given.annuli.frames
    )
    with pytest.raises(InputError, match=r"two points for each of the 63 vertices"):
        axis_support(smooth, axes=axes[1:])
    axes = axes.copy()
    axes[3, 1] = axes[3, 0]
    with pytest.raises(InputError, match=r"axes of vertices \[3\] have no direction"):
        axis_support(smooth, axes=axes)


def test_panels_want_axes_for_edges_on_axes_alone() -> None:
    smooth = fit_spheres(roof_mesh(6, 8))
    with pytest.raises(InputError, match="edges='axis' needs axes"):
        panels(smooth, edges="axis")
    with pytest.raises(InputError, match="axes are for edges='axis'"):
        panels(smooth, axes=node_axes(smooth))


def test_flat_beams_end_clear_of_each_other_in_closed_form() -> None:
    """Six triangles in a plane: strips of half width w at 60 degrees touch at w / tan 30°."""
    turns = np.pi / 3 * np.arange(6)
    points = np.stack([np.cos(turns), np.sin(turns), 0 * turns], 1)
    faces = [[0, 1 + i, 1 + (i + 1) % 6] for i in range(6)]
    flat = face_planes(Mesh(np.concatenate([np.zeros((1, 3)), points]), faces))
    annuli = bisector_support(flat, depth=0.1).annuli
    expected = 0.02 / np.tan(np.pi / 6)
    assert least_node_radius(annuli, thickness=0.04) == pytest.approx(expected)
    assert least_node_radius(annuli, thickness=0.04, node_gap=0.01) == pytest.approx(
        expected - 0.01
    )


def test_twisted_beams_end_clear_of_each_other_at_the_least_radius() -> None:
    """The nearest solids just miss each other, and a tenth less is not enough."""
    triangles = face_planes(triangulate(roof_mesh(2, 4)))
    support = bisector_support(triangles, depth=0.5, thickness=0.05)
    radius = least_node_radius(support.annuli, thickness=0.05)
    assert radius == support.report["node_radius"] > 0.03
    for share in (0.9, 1.0):
        made = beams(support.annuli, thickness=0.05, node_radius=share * radius).beams
        if share < 1:
            pair = nearest_beams(made)
        two = select_parts(made, np.isin(np.arange(made.n_beams), pair))
        solids = [shape for shape, *_ in cadquery_solids(beams=two)]
        volume = solids[0].intersect(solids[1]).Volume()  # in cubic millimetres
        assert volume < 1e-3 if share == 1 else volume > 1


def test_joints_keep_panels_in_their_sectors() -> None:
    """Corners of the inner faces, seen along the axis, do not pass the planes through it."""
    triangles = face_planes(triangulate(roof_mesh(4, 6)))
    mesh, axes = triangles.mesh, bisector_support(triangles).axes
    down = unit(axes[:, 1] - axes[:, 0])
    with pytest.warns(UserWarning, match="joints are .* wide, so that panels"):
        joint = least_joint(triangles, axes, thickness=0.1)
    assert least_joint(triangles, axes) == 0
    assert least_joint(triangles, axes, thickness=0.1, joint_gap=1.0) == 1.0
    farthest: list[float] = []
    for width in (0.0, joint):
        cut = panels(triangles, thickness=0.1, joint_gap=width).panels
        assert cut.n_panels == mesh.n_faces
        chords = mesh.vertices[mesh.corners[cut.next_corners]] - mesh.vertices[mesh.corners]
        points = cut.inner_corners + cut.origins[cut.corner_panels]
        inner = ~mesh.topology.is_boundary_vertex[mesh.corners]
        walls = unit(np.cross(down[mesh.corners], chords))
        farthest.append(float(dot(walls, points - mesh.vertices[mesh.corners])[inner].max()))
    assert farthest[0] > 1e-3
    assert farthest[1] < 1e-9


def nearest_beams(made: Beams) -> list[int]:
    """The two whose ends overlap most, seen by their corners at levels across the thickness."""
    corners = made.corners + made.annuli.origins[:, None, None, None]
    flat = corners.reshape(-1, 12, 3)
    apart = norm(flat[:, None, :, None] - flat[None, :, None]).min(axis=(2, 3))
    apart[np.tril_indices(len(apart))] = np.inf
    return [int(i) for i in np.unravel_index(apart.argmin(), apart.shape)]


@pytest.mark.parametrize(
    ("name", "verdict", "reason"),
    [
        ("roof", "feasible", "15 is good, 28 the limit"),
        ("saddle", "feasible", "nearly minimal"),
        ("steep triangles", "no", "Lemma 5.1"),
        ("ridge", "feasible", "creases of more than 40 degrees"),
        ("crumpled", "no", "vertices miss their spheres"),
    ],
)
def test_feasibility_says_why(name: str, verdict: str, reason: str) -> None:
    x, y = np.meshgrid(np.arange(9.0) - 4, np.arange(9.0) - 4, indexing="ij")
    heights = {
        "saddle": 0.02 * x * y,
        "steep triangles": 5 * np.exp(-(x * x + y * y) / 4),
        "ridge": -np.abs(x - 0.0) - 0.01 * y * y,
        "crumpled": 1.5 * np.random.default_rng(3).normal(size=x.shape),
    }
    mesh = roof_mesh(6, 8) if name == "roof" else height_field(heights[name])
    if "triangles" in name:
        mesh = triangulate(mesh)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = support_feasibility(minimize_angles(fit_spheres(mesh)).sphere_mesh)
    assert found.verdict == verdict
    assert reason in found.reason
    bound = {"feasible": 15, "doubtful": 28, "no": 90}[verdict]
    assert found.tilt_deg_p95 <= bound
    assert json.loads(json.dumps(dict(found), allow_nan=False)) == found


def height_field(heights: FloatArray) -> Mesh:
    n, m = heights.shape
    x, y = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    ids = np.arange(n * m).reshape(n, m)
    faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], 2)
    return Mesh(np.stack([x, y, heights], 2).reshape(-1, 3), faces.reshape(-1, 4))


def test_kept_spheres_that_are_rougher_than_planes_say_so() -> None:
    mesh = vase_mesh(9, 7)
    rough = central_spheres(mesh)
    rows = rough.local_spheres * [-1, 1, 1, 1, 1]
    with pytest.warns(UserWarning, match="which stay: neighbours meet at"):
        assert keep_spheres(SphereMesh.from_local(mesh, rows)).report["converged"]


def test_assemblies_are_drawn_whole_and_near_a_node(tmp_path: Path) -> None:
    smooth = fit_spheres(triangulate(vase_mesh(8, 4)))
    support = bisector_support(smooth)
    made = beams(support.annuli, node_radius=support.report["node_radius"]).beams
    cut = panels(smooth).panels
    paper: list[float] = []
    for near in (None, 12):
        path = render_assembly(cut, made, tmp_path / "roof.png", near=near, width=90, height=60)
        pixels = np.asarray(Image.open(path)).reshape(-1, 3)
        paper.append(float((pixels > 225).all(axis=1).mean()))
        assert len(np.unique(pixels, axis=0)) > 20
    assert paper[1] < paper[0] < 1
    with pytest.raises(InputError, match="no beam ends at vertex 99"):
        render_assembly(cut, made, tmp_path / "roof.png", near=99)


def test_equal_radii_start_supports_on_vertices_that_slide() -> None:
    """The optimum is the same as from smallest angles; pieces have radii of their own."""
    net = ellipsoid_mesh(10, 5)
    start = equal_radii(net)
    curvatures = np.abs(2 * start.local_spheres[:, 0])
    assert np.ptp(curvatures) < 1e-12 * curvatures.max()
    assert vertex_error(start).max() < 1e-9
    found = [
        optimize_spheres(spheres, regularity=3.5, support=1, tolerance=0.3)
        for spheres in (start, minimize_angles(fit_spheres(net)).sphere_mesh)
    ]
    means = [each.report.angles_deg["spherical"]["mean"] for each in found]
    assert means[0] == pytest.approx(means[1], rel=1e-3)
    assert support_structure(found[0].sphere_mesh).torsion.max() < 1e-5
    both = Mesh(
        np.vstack([net.vertices, 3 * net.vertices + 40]),
        [*net.faces, *(face + net.n_vertices for face in net.faces)],
    )
    small, large = np.split(np.abs(equal_radii(both).local_spheres[:, 0]), 2)
    np.testing.assert_allclose(small, 3 * large, rtol=1e-9)
