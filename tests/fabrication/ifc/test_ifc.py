"""IFC files, read and judged by IfcOpenShell where it is there."""

import re
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from OCP.BRep import BRep_Builder
from OCP.BRepGProp import BRepGProp
from OCP.BRepTools import BRepTools
from OCP.GProp import GProp_GProps
from OCP.TopoDS import TopoDS_Shape
from scipy.special import comb

from spheremesh import SphereMesh
from spheremesh.fabrication.breps.beam_geometry import beam_geometry
from spheremesh.fabrication.ifc.bodies import IfcSpheres
from spheremesh.fabrication.ifc.entities import global_id
from spheremesh.fabrication.ifc.patches import patch_for, patch_numbers
from spheremesh.fabrication.ifc.triangles import Triangles, beam_triangles, panel_triangles
from spheremesh.fabrication.ifc.writer import IfcOptions, write_ifc
from spheremesh.fabrication.model import Model
from spheremesh.kernel.arrays import norm
from spheremesh.kernel.beams.beams import Beams, beam_volumes
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.facts import panel_volumes
from spheremesh.kernel.panels.panels import Panels
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import torus_net

TORUS: SphereMesh = central_spheres(torus_net(6, 4, 3.0, 1.0))


SPHERES: tuple[IfcSpheres, ...] = ("polynomial", "rational", "spherical")


@cache
def cut(thickness: float = 0.02) -> Panels:
    labels = np.arange(TORUS.mesh.n_faces) % 3
    panels, rejected = cut_panels(TORUS, thickness=thickness, labels=labels)
    assert not rejected
    return panels


@cache
def support() -> Beams:
    annuli = annulus_support(TORUS, 0.2).annuli
    return cut_beams(annuli, 0.02, node_gap=0.01, node_radius=0.05)[0]


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("ifc") / "torus.ifc"
    return write_ifc(Model(cut(), support()), target, IfcOptions(title="Dach's Höhe")).path


@pytest.fixture(scope="module")
def model(path: Path) -> Any:  # noqa: ANN401 - of a library that may be missing
    return pytest.importorskip("ifcopenshell", reason="ifcopenshell").open(str(path))


def test_the_schema_is_kept(path: Path) -> None:
    validate = pytest.importorskip("ifcopenshell.validate", reason="ifcopenshell")
    panels = select_parts(cut(), np.arange(TORUS.mesh.n_faces) == 0)
    for spheres in SPHERES:
        small = write_ifc(
            Model(panels), path.parent / "s.ifc", IfcOptions(spheres=spheres)
        ).path
        log = validate.json_logger()
        validate.validate(str(small), log)
        assert log.statements == []


def test_parts_have_names_types_and_quantities(model: Any) -> None:  # noqa: ANN401
    panels, beams = cut(), support()
    (project,), (wall,) = model.by_type("IfcProject"), model.by_type("IfcCurtainWall")
    assert project.Name == "Dach's Höhe"
    parts = wall.IsDecomposedBy[0].RelatedObjects
    assert len(parts) == len(set(wall.IsDecomposedBy[0].RelatedObjects))
    plates, members = model.by_type("IfcPlate"), model.by_type("IfcMember")
    assert [plate.Name for plate in plates] == list(panels.ids)
    assert [member.Name for member in members] == list(beams.annuli.ids)
    names = [plate.IsTypedBy[0].RelatingType.Name for plate in plates]
    assert names == [f"Mould {label + 1:02d}" for label in panels.labels.tolist()]
    for found, volumes in ((plates, panel_volumes(panels)), (members, beam_volumes(beams))):
        for part, volume in zip(found, volumes, strict=True):
            sets = [x.RelatingPropertyDefinition for x in part.IsDefinedBy]
            (own,) = (x for x in sets if x.is_a("IfcPropertySet"))
            assert own.Name.startswith("Spheremesh_")
            (amounts,) = (x for x in sets if x.is_a("IfcElementQuantity"))
            values = {x.Name: x for x in amounts.Quantities}
            assert abs(values["NetVolume"].VolumeValue / volume - 1) < 1e-12
    roots = [root.GlobalId for root in model.by_type("IfcRoot")]
    assert len(roots) == len(set(roots))


def test_global_ids_stay(path: Path, tmp_path: Path) -> None:
    found = re.findall(r"=IFCPLATE\('([^']*)'", path.read_text("ascii"))
    assert found[3] == global_id("Dach's Höhe", "IFCPLATE", "P0003")
    other = write_ifc(Model(cut()), tmp_path / "o.ifc", IfcOptions(title="Other")).path
    assert not {*re.findall(r"=IFCPLATE\('([^']*)'", other.read_text("ascii"))} & {*found}


def read_volumes(model: Any, kind: str) -> list[float]:  # noqa: ANN401
    """Of parts, in cubic metres, as the geometry engine of IfcOpenShell has them."""
    import ifcopenshell.geom as geometry

    settings = geometry.settings()
    settings.set("iterator-output", geometry.ifcopenshell_wrapper.SERIALIZED)
    result: list[float] = []
    for part in model.by_type(kind):
        shape, facts = TopoDS_Shape(), GProp_GProps()
        text = geometry.create_shape(settings, part).geometry.brep_data
        BRepTools.Read_s(shape, BytesIO(text.encode()), BRep_Builder())
        BRepGProp.VolumeProperties_s(shape, facts, 1e-9)
        result.append(facts.Mass())
    return result


@pytest.mark.parametrize("units", ["mm", "m"])
def test_law_volumes_in_a_reader_are_those_of_the_parts(tmp_path: Path, units: Any) -> None:  # noqa: ANN401
    """The sharply curved panels of a torus, and its beams."""
    library = pytest.importorskip("ifcopenshell", reason="ifcopenshell")
    panels, beams = (
        select_parts(parts, np.arange(len(parts.ids)) % 5 == 0) for parts in (cut(), support())
    )
    options = IfcOptions(units, shapes="exact")
    model = library.open(str(write_ifc(Model(panels, beams), tmp_path / "m.ifc", options).path))
    for kind, expected in (
        ("IfcPlate", panel_volumes(panels)), ("IfcMember", beam_volumes(beams)),
    ):  # fmt: skip
        np.testing.assert_allclose(read_volumes(model, kind), expected, rtol=1e-6)


@given(half=st.floats(1e-3, 1.4))
@settings(max_examples=20)
def test_law_polynomials_keep_to_their_sphere(half: float) -> None:
    patch = patch_for("polynomial", half)
    numbers = patch_numbers(patch, half, np.array([1.0, 2.0, 3.0]), np.eye(3), 5.0)
    side = patch.degree + 1
    poles = numbers[: 3 * side**2].reshape(side, side, 3)
    t, i = np.linspace(0, 1, 9)[:, None], np.arange(side)
    basis = comb(patch.degree, i) * t**i * (1 - t) ** (patch.degree - i)
    points = np.einsum("ai,bj,ijk->abk", basis, basis, poles) - [1.0, 2.0, 3.0]
    np.testing.assert_allclose(norm(points), 5.0, rtol=4e-9 * half + 1e-13)
    # It reaches beyond the corners.
    assert np.arccos(points[..., 2].min() / 5.0) > half


def test_law_patches_are_pieces_of_spheres(tmp_path: Path) -> None:
    """From the text alone: poles, weights, and the corners of the spherical file."""
    panels = cut()
    texts = {
        spheres: write_ifc(
            Model(panels), tmp_path / "p.ifc", IfcOptions(shapes="exact", spheres=spheres)
        ).path.read_text("ascii")
        for spheres in SPHERES[1:]
    }
    radii = re.findall(r"=IFCSPHERICALSURFACE\(#\d+,([^)]*)\)", texts["spherical"])
    entities = dict(re.findall(r"#(\d+)=([^;]*);", texts["rational"]))
    patches = re.findall(r"IFCRATIONALBSPLINESURFACEWITHKNOTS\([^;]*;", texts["rational"])
    assert len(patches) == len(radii) == 2 * panels.n_panels
    real = r"-?\d+\.\d*(?:E-?\d+)?"
    for text, radius in zip(patches, radii, strict=True):
        numbers = re.findall(r"#(\d+)", text)
        poles = np.array([re.findall(real, entities[n]) for n in numbers], float)
        weights = np.array(re.findall(r"\d+\.\d+", text.rsplit("((", 1)[1]), float)
        side = int(np.sqrt(len(poles)))
        grid, weight = poles.reshape(side, side, 3)[:3, :3], weights.reshape(side, side)[:3, :3]
        t = np.linspace(0, 1, 7)
        basis = np.stack([(1 - t) ** 2, 2 * t * (1 - t), t**2])
        bottom = np.einsum("ia,jb,ij->ab", basis, basis, weight)
        top = np.einsum("ia,jb,ij,ijk->abk", basis, basis, weight, grid)
        points = (top / bottom[..., None]).reshape(-1, 3)
        # The centre: where all distances are equal.
        system = np.column_stack([2 * points, np.ones(len(points))])
        center = np.linalg.lstsq(system, (points**2).sum(axis=1), rcond=None)[0][:3]
        np.testing.assert_allclose(norm(points - center), float(radius), rtol=1e-9)
        assert (weights > 0).all()


def check_closed(made: Triangles) -> float:
    """Volume of a triangulation in which every edge is used once each way."""
    sides = [made.triangles[:, [i, (i + 1) % 3]] for i in range(3)]
    edges = {tuple(edge) for edge in np.concatenate(sides).tolist()}
    assert len(edges) == 3 * len(made.triangles)
    assert all((end, start) in edges for start, end in edges)
    corners = made.points[made.triangles]
    return float(
        np.einsum("ti,ti->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    )


def test_law_triangles_are_closed() -> None:
    panels, annuli = cut(), annulus_support(TORUS, 0.2).annuli
    volumes = [check_closed(made) for made in panel_triangles(panels)]
    np.testing.assert_allclose(volumes, panel_volumes(panels), rtol=0.02)
    for ends in ({}, {"node_gap": 0.01, "node_radius": 0.05}):
        beams, _ = cut_beams(annuli, 0.02, **ends)
        made = beam_triangles(beam_geometry(beams))
        volumes = [check_closed(each) for each in made]
        np.testing.assert_allclose(volumes, beam_volumes(beams), rtol=0.05)


def test_surfaces_and_choices(tmp_path: Path) -> None:
    panels = select_parts(cut(), np.arange(TORUS.mesh.n_faces) == 0)
    text = write_ifc(Model(cut(0.0)), tmp_path / "s.ifc").path.read_text("ascii")
    assert "'SurfaceModel'" in text
    assert "NetVolume" not in text
    for each in SPHERES:
        options = IfcOptions(shapes="triangles", spheres=each)
        text = write_ifc(Model(panels), tmp_path / "t.ifc", options).path.read_text("ascii")
        assert "IFCADVANCEDBREP" not in text
    with pytest.raises(InputError, match="spheres of an IFC file must be one of"):
        write_ifc(Model(panels), tmp_path / "t.ifc", IfcOptions(spheres="x"))  # type: ignore
    with pytest.raises(InputError, match="ifc"):
        write_ifc(Model(panels), tmp_path / "t.step")
