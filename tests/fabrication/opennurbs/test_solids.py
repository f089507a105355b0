"""Solids as Breps: exact, closed, of the volume of their parts; damage is found."""

import base64
import struct
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import rhino3dm

from spheremesh.fabrication.breps.nodes import cylinder_batch
from spheremesh.fabrication.breps.panels import panel_batches
from spheremesh.fabrication.opennurbs.brep_audit import verify_breps
from spheremesh.fabrication.opennurbs.brep_reader import parse_brep
from spheremesh.fabrication.opennurbs.solid_writer import solid_streams
from spheremesh.fabrication.opennurbs.stream_codes import CRC
from spheremesh.kernel.arrays import unit
from spheremesh.kernel.panels.cutting import EdgeMode, cut_panels
from spheremesh.kernel.panels.facts import panel_volumes
from spheremesh.kernel.panels.panels import Panels
from spheremesh.kernel.sphere_meshes.sphere_mesh import SphereMesh
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.kernel.surfaces.circular_nets import vase_net

HEADER = rhino3dm.Point(rhino3dm.Point3d(0, 0, 0)).Encode()


def decode(stream: bytes) -> Any:  # noqa: ANN401
    return rhino3dm.CommonObject.Decode(
        {**HEADER, "data": base64.b64encode(stream).decode("ascii")}
    )


def encoded(geometry: Any) -> bytes:  # noqa: ANN401
    return base64.b64decode(geometry.Encode()["data"])


def moved(stream: bytes, place: int) -> bytes:
    """The stream with a number larger by a millionth, its checksums mended."""
    data = bytearray(stream)
    (value,) = struct.unpack_from("<d", data, place)
    struct.pack_into("<d", data, place, value + 1e-6)
    for checksum in parse_brep(stream).checksums:
        CRC.pack_into(data, checksum.place, checksum.compute(memoryview(bytes(data))))
    return bytes(data)


def thick_panels(edges: EdgeMode, joint_gap: float, shift: float = 0.0) -> Panels:
    """Spheres of both signs and planes, with a thickness."""
    mesh = vase_net(10, 5, 2.0, 6.0, 0.3)
    planes, great_spheres = circle_pencils(face_circles(mesh)[0])
    angles = np.random.default_rng(4).uniform(-0.6, 0.6, mesh.n_faces)
    angles[::7] = 0
    rows = pencil_spheres(planes, great_spheres, angles)
    made, _ = cut_panels(
        SphereMesh.from_local(mesh, rows), edges, joint_gap=joint_gap, thickness=0.05
    )
    assert made.n_panels > 20
    origins = made.origins + shift
    return replace(made, origins=origins)


CASES = {
    "bisector": ("bisector", 0.0, 0.0), "gap": ("bisector", 0.02, 0.0),
    "intersection": ("intersection", 0.0, 0.0), "far": ("bisector", 0.02, 1e5),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_solids_are_closed_and_of_the_volume_of_their_panels(case: str) -> None:
    panels = thick_panels(*CASES[case])
    streams = solid_streams(panel_batches(panels), panels.origins)
    errors = verify_breps(streams, panels.spheres, panels.origins)
    volumes = panel_volumes(panels)
    found = [each.reason(volume) for each, volume in zip(errors, volumes, strict=True)]
    assert found == [""] * panels.n_panels
    np.testing.assert_allclose([each.volume for each in errors], volumes, rtol=1e-7)
    for stream in streams:
        brep = decode(stream)
        assert brep.IsValid, brep.IsValidWithLog
        assert brep.IsSolid
        assert len(brep.Faces) == 6


def test_opennurbs_writes_the_same_solid() -> None:
    panels = thick_panels("bisector", 0.0)
    streams = solid_streams(panel_batches(panels), panels.origins)[:8]
    again = [encoded(decode(stream)) for stream in streams]
    first, second = ([each.volume for each in verify_breps(x)] for x in (streams, again))
    assert first == second


def test_a_cylinder_is_closed_along_its_seam() -> None:
    directions = unit(np.array([[0, 0, 1.0], [1, 2, 3], [0, -1, 0.2]]))
    heights, origins = np.array([1.0, 2, 3]), np.arange(9.0).reshape(3, 3)
    batch = cylinder_batch(0 * origins, directions, heights, 0.3)
    streams = solid_streams([batch], origins)
    errors = verify_breps(streams)
    assert [each.reason() for each in errors] == [""] * 3
    found = [each.volume for each in errors]
    np.testing.assert_allclose(found, np.pi * 0.09 * heights, rtol=1e-9)
    for stream in streams:
        brep = decode(stream)
        assert isinstance(brep, rhino3dm.Brep)
        assert brep.IsValid
        assert brep.IsSolid


def test_a_solid_with_a_moved_corner_is_found() -> None:
    panels = thick_panels("bisector", 0.0)
    stream = solid_streams(panel_batches(panels), panels.origins)[3]
    for face in parse_brep(stream).faces:
        for side in face.sides[:1]:
            (errors,) = verify_breps([moved(stream, side.start)])
            assert "where" in errors.reason()


def test_another_volume_is_found() -> None:
    panels = thick_panels("bisector", 0.0)
    stream = solid_streams(panel_batches(panels), panels.origins)[3]
    (errors,) = verify_breps([stream])
    assert errors.reason(errors.volume) == ""
    assert "volume" in errors.reason(errors.volume * (1 + 1e-5))
