"""Spherical Breps: exact in their own bytes, judged by our reader and by openNURBS."""

import base64
import struct
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np
import pytest
import rhino3dm

from spheremesh.fabrication.opennurbs.brep_audit import BrepErrors, verify_breps
from spheremesh.fabrication.opennurbs.brep_layout import BrepLayout
from spheremesh.fabrication.opennurbs.brep_reader import parse_brep
from spheremesh.fabrication.opennurbs.brep_writer import brep_streams, edge_streams
from spheremesh.fabrication.opennurbs.render_meshes import panel_meshes
from spheremesh.fabrication.opennurbs.stream_codes import CRC
from spheremesh.fabrication.opennurbs.stream_reader import UnreadableError
from spheremesh.kernel.arrays import FloatArray, IntArray
from spheremesh.kernel.meshes.mesh import Mesh
from spheremesh.kernel.panels.cutting import EdgeMode, cut_panels
from spheremesh.kernel.panels.panels import Panels, panel_arcs, panel_areas
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.sphere_mesh import SphereMesh
from spheremesh.kernel.spheres.arcs import arc_points
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.kernel.spheres.incidence import normals, signed_distance
from spheremesh.kernel.surfaces.circular_nets import roof_net, vase_net

Change: TypeAlias = Callable[[FloatArray], FloatArray]
Specimen: TypeAlias = tuple[Panels, bytes]
HEADER = rhino3dm.Point(rhino3dm.Point3d(0, 0, 0)).Encode()


def decode(stream: bytes) -> Any:  # noqa: ANN401
    return rhino3dm.CommonObject.Decode(
        {**HEADER, "data": base64.b64encode(stream).decode("ascii")}
    )


def encoded(geometry: Any) -> bytes:  # noqa: ANN401
    return base64.b64decode(geometry.Encode()["data"])


def random_panels(
    count: int, seed: int, *, shift: float = 0.0, gap: float = 0.0, flattest: float = 3e4
) -> Panels:
    """Single panels of 3 to 8 sides, of both signs, with radii from 0.75 edges on."""
    rng = np.random.default_rng(seed)
    degrees = rng.integers(3, 9, count)
    circumradii = rng.uniform(0.5, 2.0, count)
    corners, sines = [], []
    for k, rho in zip(degrees, circumradii, strict=True):
        angles = 2 * np.pi * (np.arange(k) + rng.uniform(-0.2, 0.2, k)) / k
        flat = rho * np.stack([np.cos(angles), np.sin(angles), 0 * angles], 1)
        frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        corners.append(flat @ (frame * np.linalg.det(frame)).T + rng.uniform(-9, 9, 3) + shift)
        edge = np.linalg.norm(np.roll(flat, -1, 0) - flat, axis=1).max()
        smallest = max(0.75 * edge / rho, 1.05)
        sines.append(1 / np.exp(rng.uniform(np.log(smallest), np.log(flattest))))
    starts = np.cumsum([0, *degrees])
    faces = [range(i, j) for i, j in pairwise(starts)]
    mesh = Mesh(np.concatenate(corners), faces)
    planes, great_spheres = circle_pencils(face_circles(mesh)[0])
    angles = np.arcsin(sines) * rng.choice([-1, 1], count)
    rows = pencil_spheres(planes, great_spheres, angles)
    panels, rejected = cut_panels(SphereMesh.from_local(mesh, rows), joint_gap=gap)
    assert len(rejected) <= count // 10
    return panels


def net_panels(
    mesh: Mesh, seed: int, edges: EdgeMode = "bisector", joint_gap: float = 0.0
) -> Panels:
    """Panels of a circular net with spheres of both signs, every seventh a plane."""
    rng = np.random.default_rng(seed)
    planes, great_spheres = circle_pencils(face_circles(mesh)[0])
    angles = rng.uniform(-0.6, 0.6, mesh.n_faces)
    angles[::7] = 0
    rows = pencil_spheres(planes, great_spheres, angles)
    return cut_panels(SphereMesh.from_local(mesh, rows), edges, joint_gap=joint_gap)[0]


FAMILIES = {
    "single": lambda: random_panels(80, 1),
    "joints": lambda: random_panels(80, 2, gap=0.02),
    "roof": lambda: net_panels(roof_net(10, 8, 40.0), 3, joint_gap=0.01),
    "tilted": lambda: net_panels(vase_net(14, 7, 2.0, 6.0, 0.3), 4, edges="intersection"),
}


@pytest.fixture(params=FAMILIES)
def panels(request: pytest.FixtureRequest) -> Panels:
    return FAMILIES[request.param]()


def test_streams_are_exact(panels: Panels) -> None:
    for streams in (brep_streams(panels), map(encoded, map(decode, brep_streams(panels)))):
        errors = verify_breps(list(streams), panels.spheres, panels.origins)
        assert [e.reason() for e in errors] == [""] * panels.n_panels
        assert max(e.worst / e.scale for e in errors) < 1e-12


def test_opennurbs_agrees(panels: Panels) -> None:
    share = np.linspace(0, 1, 7)
    for i, stream in enumerate(brep_streams(panels)):
        brep = decode(stream)
        assert brep.IsValid, brep.IsValidWithLog
        row, origin = panels.spheres[i], panels.origins[i]
        size = np.ptp(panels.corners[panels.offsets[i] : panels.offsets[i + 1]], 0).max()
        radius = 0.5 / abs(row[0]) if row[0] else size
        surface = brep.Faces[0].UnderlyingSurface()
        assert not brep.Faces[0].OrientationIsReversed
        points = []
        for edge in brep.Edges:
            assert edge.IsArc() == (row[0] != 0)
            assert edge.IsLinear() == (row[0] == 0)
            assert edge.Domain.T0 == 0
            points += [edge.PointAt(t) for t in edge.Domain.T1 * share]
        points += [brep.Vertices[j].Location for j in range(len(brep.Vertices))]
        u, v = surface.Domain(0), surface.Domain(1)
        inside = [surface.PointAt(s * u.T1, t * v.T1) for s in share - 0.5 for t in share - 0.5]
        local = np.array([(p.X, p.Y, p.Z) for p in points + inside]) - origin
        assert np.abs(signed_distance(row, local)).max() <= 1e-12 * radius + 1e-14
        normal = surface.NormalAt(0, 0)
        center = np.array([(p.X, p.Y, p.Z) for p in [surface.PointAt(0, 0)]])[0] - origin
        assert np.dot((normal.X, normal.Y, normal.Z), normals(row, center)) > 1 - 1e-9
        assert surface.IsPlanar() == (row[0] == 0)
        assert row[0] == 0 or radius > 1e3 or surface.IsSphere(1e-6)


def test_trims_enclose_the_area_of_the_panel() -> None:
    """By Green's theorem in (u, v), where areas shrink by (1 + A² ρ²)²."""
    panels = random_panels(40, 9)
    nodes, weights = np.polynomial.legendre.leggauss(100)
    share = (nodes + 1) / 2
    basis = np.stack([(1 - share) ** 2, 2 * share * (1 - share), share**2], 1)
    slope = np.stack([share - 1, 1 - 2 * share, share], 1)
    for i, stream in enumerate(brep_streams(panels)):
        area = 0.0
        for trim in (side.trim for side in parse_brep(stream).faces[0].sides):
            numbers = struct.unpack_from(f"<{3 * trim.n_points}d", stream, trim.points)
            points = np.reshape(numbers, (-1, 3))
            for first in range(0, len(points) - 2, 2):
                x, dx = (values @ points[first : first + 3] for values in (basis, slope))
                u, v = (x[:, :2] / x[:, 2:]).T
                du, dv = ((dx[:, :2] - np.stack([u, v], 1) * dx[:, 2:]) / x[:, 2:]).T
                square = panels.spheres[i, 0] ** 2 * (u**2 + v**2)
                area += weights @ ((u * dv - v * du) / (1 + square)) / 2
        assert area == pytest.approx(panel_areas(panels)[i], rel=1e-13)


def test_edges_are_the_arcs_of_the_panels(panels: Panels) -> None:
    middles = arc_points(panel_arcs(panels), np.zeros(1))[:, 0]
    owners = panels.corner_panels
    for h, stream in enumerate(edge_streams(panels)):
        curve = decode(stream)
        assert curve.IsValid
        is_plane = panels.spheres[owners[h], 0] == 0
        kind = rhino3dm.LineCurve if is_plane else rhino3dm.ArcCurve
        assert isinstance(curve, kind)
        found = [curve.PointAtStart, curve.PointAt(sum((curve.Domain.T0, curve.Domain.T1)) / 2)]
        radius = 1.0 if is_plane else 0.5 / abs(panels.spheres[owners[h], 0])
        wanted = np.stack([panels.corners[h], middles[h]]) + panels.origins[owners[h]]
        found = np.array([(p.X, p.Y, p.Z) for p in found])
        assert np.abs(found - wanted).max() < 1e-12 * max(radius, 1)


def test_far_site() -> None:
    panels = random_panels(60, 5, shift=1e6)
    errors = verify_breps(brep_streams(panels), panels.spheres, panels.origins)
    assert [e.reason() for e in errors] == [""] * panels.n_panels
    assert max(e.worst - 1e-12 * e.scale for e in errors) < 3e-9
    assert all(decode(stream).IsValid for stream in brep_streams(panels))


def test_steep_panels_are_cut_into_spans() -> None:
    panels = random_panels(60, 6, flattest=1.5)
    streams = brep_streams(panels)
    counts = [parse_brep(stream).faces[0].surface.n_points for stream in streams]
    assert set(counts) == {(3, 3), (5, 5)}
    errors = verify_breps(streams, panels.spheres, panels.origins)
    assert [e.reason() for e in errors] == [""] * panels.n_panels
    for stream in streams:
        brep = decode(stream)
        assert brep.IsValid
        assert brep.Faces[0].UnderlyingSurface().IsSphere(1e-6)


def test_without_a_sphere_the_surface_tells_it() -> None:
    panels = FAMILIES["roof"]()
    errors = verify_breps(brep_streams(panels))
    assert [e.reason() for e in errors] == [""] * panels.n_panels
    radii = 0.5 / np.maximum(np.abs(panels.spheres[:, 0]), 1e-300)
    is_sphere = radii < 1e6
    scales = np.array([e.scale for e in errors])
    assert np.allclose(scales[is_sphere], radii[is_sphere], rtol=1e-7)


# What the audit must catch


@pytest.fixture(params=[(3, False), (5, True), (8, False)], scope="module")
def specimen(request: pytest.FixtureRequest) -> Specimen:
    """One panel, its stream with a render mesh of float32 or of float64 vertices."""
    panels = random_panels(200, 7)
    degree, has_doubles = request.param
    is_chosen = (panels.degrees == degree) & (np.abs(panels.spheres[:, 0]) > 0.05)
    ids = np.flatnonzero(is_chosen)[:1]
    panels = select_parts(panels, np.isin(np.arange(panels.n_panels), ids))
    meshes = replace(panel_meshes(panels, 0.002), has_doubles=has_doubles)
    return panels, brep_streams(panels, meshes)[0]


def changed(stream: bytes, place: int, change: Change, count: int = 1) -> bytes:
    """The stream with doubles replaced and all checksums made right again."""
    data = bytearray(stream)
    values = np.array(struct.unpack_from(f"<{count}d", data, place))
    struct.pack_into(f"<{count}d", data, place, *change(values))
    return resealed(bytes(data), parse_brep(stream))


def resealed(stream: bytes, layout: BrepLayout) -> bytes:
    data = bytearray(stream)
    for checksum in layout.checksums:
        CRC.pack_into(data, checksum.place, checksum.compute(memoryview(bytes(data))))
    return bytes(data)


def errors_of(
    stream: bytes, sphere: FloatArray | None = None, origin: FloatArray | None = None
) -> BrepErrors:
    spheres, origins = (None if x is None else x[None] for x in (sphere, origin))
    return verify_breps([stream], spheres, origins)[0]


def reason(panels: Panels, stream: bytes) -> str:
    return errors_of(stream, panels.spheres[0], panels.origins[0]).reason()


def test_specimen_is_sound(specimen: Specimen) -> None:
    panels, stream = specimen
    assert resealed(stream, parse_brep(stream)) == stream
    assert changed(stream, parse_brep(stream).faces[0].sides[0].start, lambda x: x) == stream
    assert errors_of(stream).reason() == ""
    assert errors_of(stream, panels.spheres[0], panels.origins[0]).reason() == ""


def test_moved_vertex(specimen: Specimen) -> None:
    panels, stream = specimen
    radius = 0.5 / abs(panels.spheres[0, 0])
    place = parse_brep(stream).faces[0].sides[1].start
    assert "vert" in reason(panels, changed(stream, place, lambda x: x + 1e-11 * radius))


def test_shifted_surface(specimen: Specimen) -> None:
    panels, stream = specimen
    radius = 0.5 / abs(panels.spheres[0, 0])
    surface = parse_brep(stream).faces[0].surface
    count = 4 * surface.n_points[0] * surface.n_points[1]

    def shift(values: FloatArray) -> FloatArray:
        net = values.reshape(-1, 4).copy()
        net[:, 0] += 1e-11 * radius * net[:, 3]
        return net.ravel()

    assert "trim leaves" in reason(panels, changed(stream, surface.points, shift, count))


def test_shifted_pole(specimen: Specimen) -> None:
    panels, stream = specimen
    surface = parse_brep(stream).faces[0].surface
    count = surface.n_points[0] + 1

    def stretch(knots: FloatArray) -> FloatArray:
        return knots * (1 + 1e-9)

    assert "leaves" in reason(panels, changed(stream, surface.knots[0], stretch, count))


def test_patch_of_another_pole(specimen: Specimen) -> None:
    """The same sphere and domain, projected from a pole beside the right one."""
    panels, stream = specimen
    surface = parse_brep(stream).faces[0].surface
    count = 4 * surface.n_points[0] * surface.n_points[1]
    center = -panels.spheres[0, 1:4] / panels.spheres[0, 0] / -2 + panels.origins[0]
    angle = 1e-9
    turn = np.array([[1, -angle, 0], [angle, 1, 0], [0, 0, 1.0]])

    def turned(values: FloatArray) -> FloatArray:
        net = values.reshape(-1, 4).copy()
        relative = net[:, :3] - net[:, 3:] * center
        net[:, :3] = relative @ turn.T + net[:, 3:] * center
        return net.ravel()

    found = reason(panels, changed(stream, surface.points, turned, count))
    assert "a trim leaves its edge" in found
    errors = errors_of(
        changed(stream, surface.points, turned, count), panels.spheres[0], panels.origins[0]
    )
    assert errors.to_sphere < 1e-14 / abs(panels.spheres[0, 0])


def test_bulging_trim(specimen: Specimen) -> None:
    """A trim with the right ends that bulges a little more, or whose weight is off."""
    panels, stream = specimen
    middle = parse_brep(stream).faces[0].sides[0].trim.points + 24
    for place in (middle, middle + 8, middle + 16):
        assert "a trim leaves its edge" in reason(
            panels, changed(stream, place, lambda x: x + 1e-9)
        )


def test_bulging_surface(specimen: Specimen) -> None:
    panels, stream = specimen
    surface = parse_brep(stream).faces[0].surface
    middle = surface.points + 32 * (surface.n_points[0] * surface.n_points[1] // 2)
    assert reason(panels, changed(stream, middle, lambda x: x * (1 + 1e-9), 4))


@pytest.mark.parametrize("index", [16, 27, 0])
def test_wrong_arc(specimen: Specimen, index: int) -> None:
    """Radius, sweep and centre."""
    panels, stream = specimen
    place = parse_brep(stream).faces[0].sides[0].edge.points + 8 * index
    assert "edge" in reason(panels, changed(stream, place, lambda x: x + 1e-10))


def test_complementary_arc(specimen: Specimen) -> None:
    """The same circle and ends, the other way round."""
    panels, stream = specimen
    circle = parse_brep(stream).faces[0].sides[0].edge.points

    def other_way(values: FloatArray) -> FloatArray:
        values = values.copy()
        values[6:12] *= -1
        values[27] = 2 * np.pi - values[27]
        return values

    assert "trim leaves" in reason(panels, changed(stream, circle, other_way, 28))


def test_open_loop(specimen: Specimen) -> None:
    panels, stream = specimen
    place = parse_brep(stream).faces[0].sides[0].trim.points
    assert reason(panels, changed(stream, place, lambda x: x + 1e-9))
    apart = errors_of(changed(stream, place, lambda x: x + 1e-3))
    assert apart.trim_to_vertex > 1e-4


def test_reversed_trim(specimen: Specimen) -> None:
    panels, stream = specimen
    trim = parse_brep(stream).faces[0].sides[0].trim

    def backwards(values: FloatArray) -> FloatArray:
        return values.reshape(-1, 3)[::-1].ravel()

    found = reason(panels, changed(stream, trim.points, backwards, 3 * trim.n_points))
    assert "open at a vertex" in found


def test_reversed_loop(specimen: Specimen) -> None:
    """All consistent, but N of the row and the loop disagree."""
    panels, _ = specimen
    mirrored = Panels(**{**vars(panels), "spheres": -panels.spheres})
    stream = brep_streams(mirrored)[0]
    assert errors_of(stream).reason() == "the loop runs clockwise"
    assert decode(stream).IsValid


def test_face_that_looks_inwards(specimen: Specimen) -> None:
    panels, stream = specimen
    plain = brep_streams(panels)[0]
    errors = errors_of(plain, -panels.spheres[0], panels.origins[0])
    assert errors.reason() == "the face looks inwards"
    assert errors_of(stream, -panels.spheres[0], panels.origins[0]).reason()


def test_another_sphere(specimen: Specimen) -> None:
    panels, stream = specimen
    row = panels.spheres[0] * (1, 1, 1, 1, 1) + (0, 0, 0, 0, 1e-9)
    assert "not the sphere" in errors_of(stream, row, panels.origins[0]).reason()


def mesh_change(stream: bytes, buffer: str, change: Change, count: int, dtype: str) -> bytes:
    """The stream with some of the numbers of its render mesh replaced."""
    layout = parse_brep(stream)
    start = getattr(layout.faces[0].mesh, buffer).start
    data = bytearray(stream)
    values = np.frombuffer(stream, dtype, count, start)
    raw = change(values.astype(float)).astype(dtype).tobytes()
    data[start : start + len(raw)] = raw
    return resealed(bytes(data), layout)


def test_moved_vertex_of_the_mesh(specimen: Specimen) -> None:
    panels, stream = specimen
    radius = 0.5 / abs(panels.spheres[0, 0])
    has_doubles = parse_brep(stream).faces[0].mesh.points is not None
    buffer, dtype, lift = ("points", "<f8", 1e-11) if has_doubles else ("floats", "<f4", 1e-5)
    same = mesh_change(stream, buffer, lambda x: x, 3, dtype)
    assert same == stream
    normal = normals(panels.spheres[0], panels.corners[0])
    lifted = mesh_change(stream, buffer, lambda x: x + lift * radius * normal, 3, dtype)
    # Rounded to float32, vertices betray a lift by their normals first.
    found = (
        "the render mesh leaves the sphere" if has_doubles else "a normal of the render mesh"
    )
    assert found in reason(panels, lifted)
    rounded = mesh_change(stream, "floats", lambda x: x * (1 + 1e-6) + 1e-6, 3, "<f4")
    assert "the render mesh" in reason(panels, rounded)
    lost = mesh_change(stream, buffer, lambda x: x * np.nan, 3, dtype)
    assert "not finite" in reason(panels, lost)


@pytest.mark.parametrize("has_doubles", [False, True])
def test_moved_vertex_of_a_flat_mesh(has_doubles: bool) -> None:  # noqa: FBT001
    """Where normals tell nothing."""
    panels = FAMILIES["roof"]()
    panels = select_parts(panels, panels.spheres[:, 0] == 0)
    panels = select_parts(panels, np.arange(panels.n_panels) == 1)
    meshes = replace(panel_meshes(panels, 0.002), has_doubles=has_doubles)
    (stream,) = brep_streams(panels, meshes)
    assert reason(panels, stream) == ""
    buffer, dtype, lift = ("points", "<f8", 1e-9) if has_doubles else ("floats", "<f4", 1e-4)
    normal = lift * panels.spheres[0, 1:4]
    lifted = mesh_change(stream, buffer, lambda x: x + normal, 3, dtype)
    errors = errors_of(lifted, panels.spheres[0], panels.origins[0])
    if not has_doubles:
        assert "the render mesh leaves the sphere" in errors.reason()
    assert errors.reason()


def test_wrong_normal_of_the_mesh(specimen: Specimen) -> None:
    panels, stream = specimen
    tilted = mesh_change(stream, "normals", lambda x: x + np.array([1e-5, 0, -1e-5]), 3, "<f4")
    assert "a normal of the render mesh" in reason(panels, tilted)
    count = 3 * int(parse_brep(stream).faces[0].mesh.triangles.max()) + 3
    inside_out = mesh_change(stream, "normals", lambda x: -x, count, "<f4")
    assert "a normal of the render mesh" in reason(panels, inside_out)


def test_wrong_triangles_of_the_mesh(specimen: Specimen) -> None:
    panels, _ = specimen
    meshes = panel_meshes(panels, 0.002)
    triangles = meshes.triangles[0]

    def written(faces: IntArray) -> str:
        return reason(panels, brep_streams(panels, replace(meshes, triangles=(faces,)))[0])

    assert written(triangles) == ""
    assert "the render mesh looks inwards" in written(triangles[:, ::-1])
    stream = brep_streams(panels, meshes)[0]
    count = struct.pack("<ii", triangles.max() + 1, len(triangles))
    for wrong in (
        struct.pack("<ii", triangles.max(), len(triangles)),
        struct.pack("<ii", triangles.max() + 1, len(triangles) - 1),
    ):
        assert stream.count(count) == 1
        assert reason(panels, stream.replace(count, wrong))
    size = 1 if triangles.max() < 255 else 2
    faces = triangles[:, [0, 1, 2, 2]].astype(f"<u{size}").tobytes()
    beyond = np.full(len(faces) // size, triangles.max() + 1, f"<u{size}").tobytes()
    assert stream.count(faces) == 1
    assert "not made of triangles of its vertices" in reason(
        panels, stream.replace(faces, beyond)
    )


def test_missing_trim(specimen: Specimen) -> None:
    panels, stream = specimen
    k = int(panels.degrees[0])
    table = struct.pack(f"<{k + 2}i", 0, k, *range(k))
    twice = struct.pack(f"<{k + 2}i", 0, k, 0, 0, *range(2, k))
    assert stream.count(table) == 1
    assert reason(panels, resealed(stream.replace(table, twice), parse_brep(stream)))


def test_truncated_streams(specimen: Specimen) -> None:
    panels, stream = specimen
    for length in range(0, len(stream), 181):
        assert reason(panels, stream[:length])
        with pytest.raises(UnreadableError):
            parse_brep(stream[:length])
    assert reason(panels, stream + b"\0")


def test_flipped_bits(specimen: Specimen) -> None:
    panels, stream = specimen
    rng = np.random.default_rng(8)
    for place in rng.integers(0, len(stream), 100):
        data = bytearray(stream)
        data[place] ^= 1 << int(rng.integers(8))
        assert errors_of(bytes(data)).reason(), place
    numbers = bytearray(stream)
    place = parse_brep(stream).faces[0].sides[0].start
    numbers[place : place + 8] = struct.pack("<d", np.nan)
    assert "finite" in reason(panels, resealed(bytes(numbers), parse_brep(stream)))


def test_deflated_meshes_are_checked(specimen: Specimen) -> None:
    """As openNURBS writes them."""
    panels, stream = specimen
    written = encoded(decode(stream))
    buffers = parse_brep(written).faces[0].mesh[1:]
    assert all(buffer.is_deflated for buffer in buffers if buffer)
    assert reason(panels, written) == ""
    for buffer in filter(None, buffers):
        for place in (buffer.start + 2, (buffer.start + buffer.stop) // 2, buffer.stop - 1):
            data = bytearray(written)
            data[place] ^= 1
            assert reason(panels, bytes(data))
    moved = panels.origins[0] + 1e-5
    assert errors_of(written, panels.spheres[0], moved).mesh_to_sphere > 1e-7


@pytest.mark.parametrize(("shift", "has_doubles"), [(0.0, False), (1e5, True)])
def test_meshes_are_as_precise_as_their_place_needs(shift: float, has_doubles: bool) -> None:  # noqa: FBT001
    """Rounded to float32, vertices far from the origin would miss their spheres visibly."""
    panels = random_panels(40, 9, shift=shift)
    meshes = panel_meshes(panels, 0.004)
    assert meshes.has_doubles == has_doubles
    streams = brep_streams(panels, meshes)
    errors = verify_breps(streams, panels.spheres, panels.origins)
    assert [e.reason() for e in errors] == [""] * panels.n_panels
    for stream in streams[:4]:
        mesh = decode(stream).Faces[0].GetMesh(rhino3dm.MeshType.Render)
        assert mesh.IsValid


def test_one_bad_stream_does_not_touch_the_others() -> None:
    panels = FAMILIES["roof"]()
    streams = brep_streams(panels)
    streams[3] = streams[3][:-40]
    streams[5] = changed(
        streams[5], parse_brep(streams[5]).faces[0].sides[0].start, lambda x: x + 1
    )
    streams[8] = b""
    errors = verify_breps(streams, panels.spheres, panels.origins)
    assert [i for i, e in enumerate(errors) if e.reason()] == [3, 5, 8]
