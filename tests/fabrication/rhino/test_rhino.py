"""Rhino files, read back with rhino3dm and from their own bytes."""

import base64
import json
import subprocess
import sys
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
import rhino3dm

from spheremesh import nodes
from spheremesh.fabrication.mesh_files.reader import read_mesh
from spheremesh.fabrication.model import Model
from spheremesh.fabrication.opennurbs.brep_audit import BrepErrors, verify_breps
from spheremesh.fabrication.opennurbs.brep_reader import read_brep_streams
from spheremesh.fabrication.opennurbs.render_meshes import (
    MESH_TOLERANCE,
    RenderMeshes,
    mesh_streams,
    panel_meshes,
)
from spheremesh.fabrication.rhino_models import block_writer, panel_writer
from spheremesh.fabrication.rhino_models.writer import RhinoOptions, write_3dm
from spheremesh.fabrication.schedules.panel_text import TEXT_KEYS, panel_text
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.mesh import Mesh
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.facts import panel_volumes
from spheremesh.kernel.panels.panels import Panels, panel_areas
from spheremesh.kernel.parts.colors import mould_color
from spheremesh.kernel.parts.findings import Finding
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.sphere_mesh import SphereMesh
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.kernel.spheres.incidence import normals, signed_distance
from spheremesh.kernel.surfaces.circular_nets import roof_net
from spheremesh.nodes import NodeWarning

GRAPH = json.dumps({"title": "Dach Ä ✓", "steps": list(range(500))}, ensure_ascii=False)


def roof_panels(
    n_around: int, n_across: int, n_moulds: int = 5, thickness: float = 0.02
) -> Panels:
    """Domes and dishes with joints, every seventh panel a plane, some without mould."""
    mesh = roof_net(n_around, n_across, 80.0)
    planes, great_spheres = circle_pencils(face_circles(mesh)[0])
    angles = np.random.default_rng(1).uniform(-0.5, 0.5, mesh.n_faces)
    angles[::7] = 0
    sphere_mesh = SphereMesh.from_local(mesh, pencil_spheres(planes, great_spheres, angles))
    labels = np.arange(mesh.n_faces) % n_moulds
    labels[3] = -1
    panels, rejected = cut_panels(
        sphere_mesh, thickness=thickness, joint_gap=0.01, labels=labels
    )
    assert not rejected
    return panels


def design() -> Mesh:
    """Two quads and a hexagon."""
    angles = np.pi / 3 * np.arange(6)
    corners = [(np.cos(a), np.sin(a), 0.0) for a in angles]
    corners += [(2.0, 0.0, 0.5), (1.5, np.sqrt(0.75), 0.5), (-2.0, 0.0, 0.5), (-1.5, -0.9, 0.5)]
    return Mesh(np.array(corners), [(0, 1, 2, 3, 4, 5), (1, 0, 6, 7), (4, 3, 8, 9)])


@pytest.fixture(scope="module")
def panels() -> Panels:
    return roof_panels(12, 8)


@pytest.fixture(scope="module")
def path(panels: Panels, tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("rhino") / "Dächer.3dm"
    options = RhinoOptions(
        layers=("Edges", "Centres"), reference=design(), title="Roof", graph_json=GRAPH
    )
    result = write_3dm(Model(panels), target, options)
    assert result.path == target
    assert result.rejected == ()
    return target


@pytest.fixture(scope="module")
def model(path: Path) -> Any:  # noqa: ANN401
    return rhino3dm.File3dm.Read(str(path))


def on_layer(model: Any, name: str) -> list[Any]:  # noqa: ANN401
    """Objects of a layer and its sub-layers, in their order."""
    ids = {layer.Index for layer in model.Layers if layer.FullPath.split("::")[0] == name}
    return [item for item in model.Objects if item.Attributes.LayerIndex in ids]


def test_geometry_in_the_bytes_of_the_file(path: Path, panels: Panels) -> None:
    streams = read_brep_streams(path.read_bytes())
    errors = verify_breps(streams, panels.spheres, panels.origins)
    assert [e.reason() for e in errors] == [""] * panels.n_panels
    assert max(e.worst / e.scale for e in errors) < 1e-12


def test_breps_and_edges(model: Any, panels: Panels) -> None:  # noqa: ANN401
    breps, edges = on_layer(model, "Panels"), on_layer(model, "Edges")
    assert len(breps) == panels.n_panels
    assert len(edges) == len(panels.corners)
    for i, item in enumerate(breps):
        row, brep = panels.spheres[i], item.Geometry
        assert brep.IsValid
        assert brep.IsSolid
        kinds = [e.IsArc() if row[0] else e.IsLinear() for e in brep.Edges]
        assert len(kinds) == 12
        assert all(kinds[:8])
        assert all(brep.Edges[j].IsLinear() for j in range(8, 12))
    middles = [
        e.Geometry.PointAt((e.Geometry.Domain.T0 + e.Geometry.Domain.T1) / 2) for e in edges
    ]
    owners = panels.corner_panels
    local = np.array([(p.X, p.Y, p.Z) for p in middles]) - panels.origins[owners]
    assert np.abs(signed_distance(panels.spheres[owners], local)).max() < 1e-12
    kinds = [isinstance(e.Geometry, rhino3dm.LineCurve) for e in edges]
    assert kinds == (panels.spheres[owners, 0] == 0).tolist()


def test_user_text(model: Any, panels: Panels) -> None:  # noqa: ANN401
    areas, volumes = panel_areas(panels), panel_volumes(panels)
    rows = zip(on_layer(model, "Panels"), panel_text(panels, "m"), strict=True)
    for i, (item, expected) in enumerate(rows):
        text = dict(item.Attributes.GetUserStrings())
        assert set(text) == {*TEXT_KEYS, "volume"}
        assert text == {**expected, "volume": text["volume"]}
        assert float(text["volume"]) == pytest.approx(volumes[i], rel=1e-11)
        assert text["id"] == panels.ids[i] == item.Attributes.Name
        assert float(text["area"]) == pytest.approx(areas[i], rel=1e-11)
        assert float(text["thickness"]) == 0.02
        a, b = panels.spheres[i, 0], panels.spheres[i, 1:4]
        if a == 0:
            assert (text["radius"], text["center"], text["bulge"]) == ("plane", "-", "flat")
        else:
            # From the corner, the centre lies at the radius along N, against it for domes.
            corner = panels.corners[panels.offsets[i]]
            center = np.array(text["center"].split(), float) - panels.origins[i]
            side = {"in": 1.0, "out": -1.0}[text["bulge"]]
            along = corner + side * float(text["radius"]) * (b - 2 * a * corner)
            assert np.abs(center - along).max() < 1e-8


def test_neighbours_are_mutual(panels: Panels) -> None:
    keep = np.arange(panels.n_panels) != 20
    text = {
        row["id"]: row["neighbors"].split()
        for row in panel_text(select_parts(panels, keep), "m")
    }
    assert all(len(names) == 4 for names in text.values())
    pairs = Counter(
        tuple(sorted((name, other)))
        for name, names in text.items()
        for other in names
        if other != "-"
    )
    assert set(pairs.values()) == {2}
    assert panels.ids[20] not in {name for names in text.values() for name in names}


def test_layers_colours_and_materials(model: Any, panels: Panels) -> None:  # noqa: ANN401
    moulds = [f"Panels::Mould {i:02d}" for i in range(1, 6)]
    layers = {layer.FullPath: layer for layer in model.Layers}
    assert set(layers) == {"Panels", *moulds, "Edges", "Centres", "Reference"}
    assert [name for name in layers if not layers[name].Visible] == ["Centres", "Reference"]
    for label, name in enumerate(moulds):
        color = (*mould_color(label, 5), 255)
        assert layers[name].Color == color
        assert model.Materials[layers[name].RenderMaterialIndex].DiffuseColor == color
    for i, item in enumerate(on_layer(model, "Panels")):
        attributes = item.Attributes
        layer = model.Layers[attributes.LayerIndex]
        label = panels.labels[i]
        assert layer.FullPath == ("Panels" if label < 0 else moulds[label])
        assert attributes.MaterialIndex == layer.RenderMaterialIndex
        assert dict(attributes.GetUserStrings())["mould"] == (
            "-" if label < 0 else f"{label + 1:02d}"
        )


def test_document(model: Any, path: Path) -> None:  # noqa: ANN401
    assert model.Settings.ModelUnitSystem == rhino3dm.UnitSystem.Meters
    assert model.Settings.ModelAbsoluteTolerance == pytest.approx(1e-5)
    assert model.Settings.ModelAngleToleranceDegrees == pytest.approx(0.1)
    assert model.Strings["spheremesh::graph"] == GRAPH
    assert model.Strings["spheremesh::title"] == "Roof"
    assert "bulge: out for domes" in model.Strings["spheremesh::note"]
    assert model.Strings["spheremesh::version"]
    assert str(path.parent).encode("utf-16-le") not in path.read_bytes()


def test_bytes_that_are_no_text_do_no_harm(panels: Panels, tmp_path: Path) -> None:
    """Names of files on Linux may be in any encoding, and are in the graph."""
    one = select_parts(panels, np.arange(panels.n_panels) == 0)
    file = write_3dm(
        Model(one), tmp_path / "m.3dm", RhinoOptions(graph_json='{"path": "d\udce4cher.obj"}')
    )
    model: Any = rhino3dm.File3dm.Read(str(file.path))
    assert model.Strings["spheremesh::graph"] == '{"path": "d?cher.obj"}'


def test_centres(model: Any, panels: Panels) -> None:  # noqa: ANN401
    points = on_layer(model, "Centres")
    assert len(points) == np.count_nonzero(panels.spheres[:, 0])


def test_ids_are_stable_and_unique(model: Any, panels: Panels, tmp_path: Path) -> None:  # noqa: ANN401
    ids = [item.Attributes.Id for item in model.Objects]
    assert len(set(ids)) == len(ids)
    fewer = select_parts(panels, np.arange(panels.n_panels) >= 4)
    again = rhino3dm.File3dm.Read(str(write_3dm(Model(fewer), tmp_path / "fewer.3dm").path))
    names = {item.Attributes.Id: item.Attributes.Name for item in model.Objects}
    assert all(names[item.Attributes.Id] == item.Attributes.Name for item in again.Objects)


def test_output_is_the_same_but_for_the_time(panels: Panels, tmp_path: Path) -> None:
    first = write_3dm(Model(panels), tmp_path / "first.3dm").path.read_bytes()
    second = write_3dm(Model(panels), tmp_path / "second.3dm").path.read_bytes()
    assert len(first) == len(second)
    different = np.frombuffer(first, np.uint8) != np.frombuffer(second, np.uint8)
    assert np.count_nonzero(different) < 32
    assert np.flatnonzero(different).max(initial=0) < 1000


@pytest.mark.parametrize("version", [6, 7, 8])
@pytest.mark.parametrize(("units", "name"), [("mm", "Millimeters"), ("ft", "Feet")])
def test_versions_and_units(
    panels: Panels, tmp_path: Path, version: int, units: str, name: str
) -> None:
    few = select_parts(panels, np.arange(panels.n_panels) < 5)
    path = write_3dm(
        Model(few, units=units), tmp_path / "model.3dm", RhinoOptions(version=version)
    ).path
    model = rhino3dm.File3dm.Read(str(path))
    assert model.ArchiveVersion // 10 == version
    assert model.Settings.ModelUnitSystem == getattr(rhino3dm.UnitSystem, name)
    assert len(read_brep_streams(path.read_bytes())) == 5
    assert all(item.Geometry.IsValid for item in model.Objects)


@pytest.fixture
def one_is_off(monkeypatch: pytest.MonkeyPatch) -> None:
    """Write panel 17 with a corner off by a millionth."""
    exact_streams = panel_writer.panel_streams

    def shifted(given: Panels, meshes: RenderMeshes | None = None) -> list[bytes]:
        corners = given.corners.copy()
        if given.n_panels > 17:
            corners[given.offsets[17]] += 1e-6
        return exact_streams(replace(given, corners=corners), meshes)

    monkeypatch.setattr(panel_writer, "panel_streams", shifted)


@pytest.mark.usefixtures("one_is_off")
def test_an_inexact_brep_is_left_out_by_name(panels: Panels, tmp_path: Path) -> None:
    file = write_3dm(Model(panels), tmp_path / "model.3dm")
    (refused,) = file.rejected
    assert (refused.id, refused.element_id) == (panels.ids[17], 17)
    assert "where" in refused.reason
    model = rhino3dm.File3dm.Read(str(file.path))
    names = [item.Attributes.Name for item in on_layer(model, "Panels")]
    assert names == [name for name in panels.ids if name != panels.ids[17]]
    assert panels.ids[17] not in {item.Attributes.Name for item in model.Objects}
    text = " ".join(item.Attributes.GetUserString("neighbors") for item in model.Objects)
    assert panels.ids[17] not in text


@pytest.mark.usefixtures("one_is_off")
def test_the_node_says_what_is_left_out(panels: Panels, tmp_path: Path) -> None:
    with pytest.warns(NodeWarning, match=f"1 panels are not in m.3dm: {panels.ids[17]}: "):
        assert nodes.write_3dm(panels, tmp_path / "m.3dm") == str(tmp_path / "m.3dm")


def test_breps_that_opennurbs_refuses(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    old = tmp_path / "old.3dm"
    old.write_bytes(b"older file")
    zero = [0.0] * 5
    sound = [BrepErrors("", 1.0, 0.0, *zero, is_counter_clockwise=True, is_outward=True)]
    thin = roof_panels(12, 8, thickness=0.0)
    monkeypatch.setattr(panel_writer, "verify_breps", lambda *_: sound * thin.n_panels)
    monkeypatch.setattr(
        panel_writer, "panel_streams", lambda given, _: [b"junk"] * given.n_panels
    )
    with pytest.raises(InputError, match=r"none of the 96 panels has .* openNURBS cannot read"):
        write_3dm(Model(thin), old, RhinoOptions(layers=()))
    assert old.read_bytes() == b"older file"
    assert [file.name for file in tmp_path.iterdir()] == ["old.3dm"]


def test_render_meshes_lie_on_the_spheres(tmp_path: Path) -> None:
    panels = roof_panels(12, 8, thickness=0.0)
    model = rhino3dm.File3dm.Read(str(write_3dm(Model(panels), tmp_path / "m.3dm").path))
    for i, item in enumerate(on_layer(model, "Panels")):
        mesh = item.Geometry.Faces[0].GetMesh(rhino3dm.MeshType.Render)
        count = len(mesh.Vertices)
        points = np.array([(p.X, p.Y, p.Z) for p in map(mesh.Vertices.Point3dAt, range(count))])
        vectors = np.array([(n.X, n.Y, n.Z) for n in mesh.Normals])
        row, local = panels.spheres[i], points - panels.origins[i]
        # The roof spans 80, and the vertices are float32.
        assert np.abs(signed_distance(row, local)).max() < 4e-6
        assert np.abs(vectors - normals(row, local)).max() < 1e-6
        faces = np.array([mesh.Faces[j][:3] for j in range(mesh.Faces.Count)])
        a, b, c = local[faces].transpose(1, 0, 2)
        flat = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
        assert flat == pytest.approx(panel_areas(panels)[i], rel=0.01)


def test_reference_is_the_design(path: Path) -> None:
    mesh = read_mesh(path, "Reference")
    assert mesh.degrees.tolist() == [6, 4, 4]
    assert np.array_equal(mesh.vertices, design().vertices)


def test_a_reference_that_rhino_refuses_is_left_out(panels: Panels, tmp_path: Path) -> None:
    degenerate = Mesh([[0, 0, 0], [1, 0, 0], [1, 0, 0]], [[0, 1, 2]])
    few = select_parts(panels, np.arange(panels.n_panels) < 2)
    file = write_3dm(Model(few), tmp_path / "a.3dm", RhinoOptions(reference=degenerate))
    assert "the reference is left out: Rhino calls the mesh invalid" in file.notes[0]
    assert "Mesh" not in file.counts


def test_groups_and_views(model: Any, panels: Panels) -> None:  # noqa: ANN401
    assert [group.Name for group in model.Groups] == [f"Mould {i:02d}" for i in range(1, 6)]
    for label, item in zip(panels.labels, on_layer(model, "Panels"), strict=True):
        assert list(item.Attributes.GetGroupList() or ()) == ([] if label < 0 else [label])
    views = {view.Name: view.Viewport for view in model.NamedViews}
    assert set(views) == {"Top", "Perspective"}
    assert views["Top"].IsParallelProjection
    assert views["Perspective"].IsPerspectiveProjection
    points = panels.corners + panels.origins[panels.corner_panels]
    for view in views.values():
        assert view.IsValid
        frame = view.GetFrustum()
        eye = np.array([view.CameraLocation.X, view.CameraLocation.Y, view.CameraLocation.Z])
        x, y, z = (
            (points - eye) @ (axis.X, axis.Y, axis.Z)
            for axis in (view.CameraX, view.CameraY, view.CameraZ)
        )
        shrink = -z / frame["near"] if view.IsPerspectiveProjection else 1
        assert np.abs(x / shrink).max() < frame["right"]
        assert np.abs(y / shrink).max() < frame["top"]
        assert frame["near"] < -z.max()
        assert frame["far"] > -z.min()


def torus_panels(
    edges: Literal["bisector", "intersection"] = "bisector", thickness: float = 0.02
) -> Panels:
    """Every kind of panel occurs once in each quarter turn and half.

    Neighbours of this coarse torus fold by more than 40 degrees; at 180 none is a crease.
    """
    spheres = nodes.fit_spheres(nodes.torus_mesh(8, 6))
    optimum = nodes.minimize_angles(spheres, crease=180.0)
    return nodes.panels(optimum.sphere_mesh, edges, thickness, crease=180.0).panels


def test_identical_panels_are_instances(tmp_path: Path) -> None:
    panels = torus_panels()
    # One panel of its own: a kind without a second is no block.
    keep = np.arange(panels.n_panels) != 0
    others = panels.labels.copy()
    others[5] = 0
    panels = select_parts(replace(panels, labels=others), keep)
    path = tmp_path / "torus.3dm"
    file = write_3dm(Model(panels), path, RhinoOptions("blocks", ()))
    assert file.counts == {"Brep": 4, "InstanceReference": 46}
    model = rhino3dm.File3dm.Read(str(path))
    blocks = {block.Id: block for block in model.InstanceDefinitions}
    assert len(blocks) == 3
    for i, item in enumerate(
        sorted(on_layer(model, "Panels"), key=lambda item: item.Attributes.Name)
    ):
        if item.Attributes.IsInstanceDefinitionObject or isinstance(
            item.Geometry, rhino3dm.Brep
        ):
            continue
        assert item.Attributes.Name in panels.ids, i
        panel = panels.ids.index(item.Attributes.Name)
        assert item.Attributes.GetUserString("id") == panels.ids[panel]
        (member,) = blocks[item.Geometry.ParentIdefId].GetObjectIds()
        brep = model.Objects.FindId(str(member)).Geometry.Duplicate()
        assert brep.Transform(item.Geometry.Xform)
        stream = base64.b64decode(brep.Encode()["data"])
        error = verify_breps(
            [stream], panels.spheres[panel : panel + 1], panels.origins[panel : panel + 1]
        )[0]
        assert error.to_sphere < 1e-12
        corners = np.array([(v.Location.X, v.Location.Y, v.Location.Z) for v in brep.Vertices])
        first, last = panels.offsets[panel : panel + 2]
        wanted = panels.corners[first:last] + panels.origins[panel]
        apart = np.linalg.norm(corners - wanted[:, None], axis=2).min(1)
        assert apart.max() < 1e-12
    again = write_3dm(Model(panels), tmp_path / "again.3dm", RhinoOptions("blocks", ()))
    first_ids = {item.Attributes.Id for item in model.Objects} | set(blocks)
    model = rhino3dm.File3dm.Read(str(again.path))
    second_ids = {item.Attributes.Id for item in model.Objects}
    assert first_ids == second_ids | {block.Id for block in model.InstanceDefinitions}


def test_a_block_that_is_not_exact_is_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its panels are written one by one."""
    exact_streams = panel_writer.panel_streams

    def shifted(given: Panels, meshes: RenderMeshes | None = None) -> list[bytes]:
        corners = given.corners.copy()
        if not given.origins.any():
            corners[1] += 1e-6
        return exact_streams(replace(given, corners=corners), meshes)

    panels = torus_panels()
    sound = write_3dm(Model(panels), tmp_path / "a.3dm", RhinoOptions("blocks", ()))
    monkeypatch.setattr(panel_writer, "panel_streams", shifted)
    file = write_3dm(Model(panels), tmp_path / "a.3dm", RhinoOptions("blocks", ()))
    assert file.rejected == ()
    n_instances = sound.counts["InstanceReference"] - file.counts["InstanceReference"]
    assert n_instances > 0
    assert file.counts["Brep"] == sound.counts["Brep"] + n_instances - 1


def test_a_block_for_every_mould(tmp_path: Path) -> None:
    """Set under its panels it is their mould; what stands on it is known by name."""
    sphere_mesh, labels, *_ = nodes.cluster_radii(nodes.fit_spheres(nodes.roof_mesh(4, 5)), k=3)
    panels = nodes.panels(sphere_mesh, thickness=0.1, labels=labels, side="outward").panels
    contents = RhinoOptions(layers=("Moulds",))
    file = write_3dm(Model(panels), tmp_path / "m.3dm", contents)
    assert (file.counts, file.notes) == ({"Brep": 23, "InstanceReference": 20}, ())
    model: Any = rhino3dm.File3dm.Read(str(file.path))
    assert not next(layer for layer in model.Layers if layer.Name == "Moulds").Visible
    names = [f"Mould {i:02d}" for i in range(1, 4)]
    assert [block.Name for block in model.InstanceDefinitions] == names
    blocks = {block.Id: block for block in model.InstanceDefinitions}
    for item in on_layer(model, "Moulds"):
        if item.Attributes.IsInstanceDefinitionObject:
            continue
        i = panels.ids.index(item.Attributes.Name)
        block = blocks[item.Geometry.ParentIdefId]
        assert block.Name == names[panels.labels[i]]
        (member,) = block.GetObjectIds()
        brep = model.Objects.FindId(str(member)).Geometry.Duplicate()
        assert brep.Faces[0].GetMesh(rhino3dm.MeshType.Render) is not None
        assert brep.Transform(item.Geometry.Xform)
        stream = base64.b64decode(brep.Encode()["data"])
        # A mould bulges outwards, whatever lies on it.
        sign = -np.sign(panels.spheres[i, 0])
        (errors,) = verify_breps(
            [stream], sign * panels.design_spheres[[i]], panels.origins[[i]]
        )
        assert errors.to_sphere < 1e-12 * errors.scale + errors.rounding
    read = read_mesh(file.path, "Moulds", n_u=1, n_v=1)
    assert read.n_faces == 20


def test_a_panel_called_like_a_mould_has_a_block_of_its_own(tmp_path: Path) -> None:
    panels = torus_panels()
    panels = replace(
        panels, ids=("Mould 01", *panels.ids[1:]), labels=np.zeros(panels.n_panels, np.int64)
    )
    file = write_3dm(Model(panels), tmp_path / "m.3dm", RhinoOptions("blocks", ("Moulds",)))
    model: Any = rhino3dm.File3dm.Read(str(file.path))
    names = {block.Name: block.Id for block in model.InstanceDefinitions}
    assert {"Mould 01", "Panel Mould 01"} <= set(names)
    assert len(set(names.values())) == len(names)
    assert len({str(item.Attributes.Id) for item in model.Objects}) == len(model.Objects)


def test_no_moulds_have_no_blocks(tmp_path: Path) -> None:
    panels = select_parts(torus_panels(), np.arange(48) < 3)
    file = write_3dm(Model(panels), tmp_path / "m.3dm", RhinoOptions(layers=("Moulds",)))
    assert (file.counts, file.notes) == ({"Brep": 3}, ())


def test_a_mould_that_is_not_exact_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    panels = torus_panels()
    panels = replace(panels, labels=np.arange(48) % 2)
    exact = block_writer.brep_streams

    def shifted(given: Panels, meshes: RenderMeshes | None = None) -> list[bytes]:
        corners = given.corners.copy()
        corners[5] += 1e-6
        return exact(replace(given, corners=corners), meshes)

    monkeypatch.setattr(block_writer, "brep_streams", shifted)
    file = write_3dm(Model(panels), tmp_path / "m.3dm", RhinoOptions(layers=("Moulds",)))
    assert file.counts == {"Brep": 49, "InstanceReference": 24}
    assert "the block of Mould 02 is left out: a trim leaves its edge" in file.notes[0]


def test_shell_joins_what_meets(tmp_path: Path) -> None:
    panels = torus_panels("intersection", thickness=0.0)
    shell = RhinoOptions("shell", ())
    for given, n_edges, n_vertices in (
        (panels, 96, 48),
        (select_parts(panels, np.arange(48) != 7), 96, 48),
    ):
        file = write_3dm(Model(given), tmp_path / "shell.3dm", shell)
        assert (file.counts, file.notes) == ({"Brep": 1}, ())
        (item,) = rhino3dm.File3dm.Read(str(file.path)).Objects
        brep = item.Geometry
        assert brep.IsValid
        assert brep.IsSolid == (given is panels)
        found = len(brep.Faces), len(brep.Edges), len(brep.Vertices)
        assert found == (given.n_panels, n_edges, n_vertices)
        for i, row in enumerate(given.spheres):
            face = brep.Faces[i]
            points = [face.PointAt(u, v) for u in (-0.05, 0.0, 0.05) for v in (-0.05, 0.05)]
            points += [
                brep.Edges[trim.EdgeIndex].PointAt(0.0) for trim in brep.Faces[i].Loops[0].Trims
            ]
            local = np.array([(p.X, p.Y, p.Z) for p in points]) - given.origins[i]
            assert np.abs(signed_distance(row, local)).max() < 1e-12


def test_shell_refuses_panels_with_joints(panels: Panels, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="all neighbours lie more than 1e-05 apart"):
        write_3dm(Model(panels), tmp_path / "shell.3dm", RhinoOptions("shell"))
    assert not list(tmp_path.iterdir())


def test_shell_leaves_wide_edges_open(tmp_path: Path) -> None:
    panels = torus_panels("intersection", thickness=0.0)
    moved = panels.origins.copy()
    moved[7] += (0.0, 0.0, 0.01)
    apart = replace(panels, origins=moved)
    file = write_3dm(Model(apart), tmp_path / "shell.3dm", RhinoOptions("shell"))
    assert file.notes == ("4 edges of neighbours lie apart and stay open",)
    with pytest.warns(NodeWarning, match=r"shell.3dm: 4 edges of neighbours lie apart"):
        nodes.write_3dm(apart, tmp_path / "shell.3dm", shape="shell")


def test_wrong_input(panels: Panels, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="unknown units 'km'"):
        write_3dm(Model(panels, units="km"), tmp_path / "model.3dm")
    with pytest.raises(InputError, match="Rhino version 5"):
        write_3dm(Model(panels), tmp_path / "model.3dm", RhinoOptions(version=5))
    with pytest.raises(InputError, match="no folder"):
        write_3dm(Model(panels), tmp_path / "missing" / "model.3dm")
    wrong: Any = (RhinoOptions(shape="solid"), RhinoOptions(layers=("edges",)))  # type: ignore[arg-type]
    for contents in wrong:
        with pytest.raises(
            InputError, match=r"unknown shape .* use panels, blocks, shell, and"
        ):
            write_3dm(Model(panels), tmp_path / "model.3dm", contents)


def test_an_exporting_process_ends_well(tmp_path: Path) -> None:
    """With render meshes in Breps; `benchmarks/exports.py` does it ten times."""
    code = (
        "import sys; sys.path[:0] = sys.argv[2:]\n"
        "from test_rhino import Model, roof_panels, write_3dm\n"
        "from test_beams import CASES\n"
        "write_3dm(Model(roof_panels(6, 5), CASES['mitred']), sys.argv[1])\n"
    )
    here = Path(__file__).parent
    folders = [str(here), str(here.parent / "step")]
    command = [sys.executable, "-c", code, str(tmp_path / "a.3dm"), *folders]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    model = rhino3dm.File3dm.Read(str(tmp_path / "a.3dm"))
    kinds = Counter(type(item.Geometry).__name__ for item in model.Objects)
    assert kinds["Brep"] > 30 + 20


def test_a_thousand_panels(tmp_path: Path) -> None:
    """A fifth of what 5,000 solid panels may take: 30 s of CPU at the most, and 90 MB."""
    panels = roof_panels(40, 25, 12)
    start = time.process_time()
    options = RhinoOptions(render_meshes=False, graph_json=GRAPH)
    file = write_3dm(Model(panels), tmp_path / "roof.3dm", options)
    assert time.process_time() - start < 6
    assert file.path.stat().st_size < 2e7
    assert file.counts == {"Brep": 1000, "ArcCurve": 3428, "LineCurve": 572}
    start = time.process_time()
    streams = mesh_streams(panel_meshes(panels, MESH_TOLERANCE))
    assert time.process_time() - start < 1.0
    # Deep panels: half openings up to 30 degrees.
    assert sum(map(len, streams)) < 3e6


def test_findings_are_text_a_layer_and_a_colour(panels: Panels, tmp_path: Path) -> None:
    few = select_parts(panels, np.arange(panels.n_panels) < 6)
    found = (
        Finding("P102", few.ids[1], "a sharp corner", 9.0, "note"),
        Finding("P201", few.ids[1], "a step of 6 mm", 6.0),
    )
    lost = [{"id": "P0002", "code": "P100", "reason": "zu groß"}]
    lost += [{"id": "X1", "code": "P100", "reason": "?"}]
    options = RhinoOptions(reference=design(), findings=found, rejected=tuple(lost))
    file = write_3dm(Model(few), tmp_path / "m.3dm", options)
    assert "where 1 parts are missing is not shown, as no mesh has them: X1" in file.notes
    model = rhino3dm.File3dm.Read(str(file.path))
    text = "P102 a sharp corner; P201 a step of 6 mm"
    for item in on_layer(model, "Panels"):
        attributes = item.Attributes
        is_found = attributes.Name == few.ids[1]
        assert dict(attributes.GetUserStrings()).get("findings") == (text if is_found else None)
        source = rhino3dm.ObjectColorSource.ColorFromObject
        assert (attributes.ColorSource == source) == is_found
    (dot,) = on_layer(model, "To check")
    assert dot.Geometry.Text == f"{few.ids[1]} P102 P201"
    outline = on_layer(model, "Rejected")
    assert len(outline) == 4
    assert {item.Attributes.GetUserString("findings") for item in outline} == {"P100 zu groß"}
    colors = {layer.Name: layer.Color for layer in model.Layers}
    assert colors["Rejected"] != colors["To check"]
