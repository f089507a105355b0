"""Rhino files, read back with rhino3dm and from their own bytes."""

import json
import subprocess
import sys
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rhino3dm

from spheremesh.fabrication import rhino
from spheremesh.fabrication.brep_audit import verify_breps
from spheremesh.fabrication.brep_layout import read_brep_streams
from spheremesh.fabrication.rhino import TEXT_KEYS, panel_text, refused_breps, write_3dm
from spheremesh.kernel.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.kernel.colors import mould_color
from spheremesh.kernel.cutting import cut_panels
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.panels import Panels, panel_areas, select_panels
from spheremesh.kernel.sphere_mesh import SphereMesh
from spheremesh.kernel.spheres import signed_distance
from spheremesh.kernel.surfaces import roof_net

GRAPH = json.dumps({"title": "Dach Ä ✓", "steps": list(range(500))}, ensure_ascii=False)


def roof_panels(n_around: int, n_across: int, n_moulds: int = 5) -> Panels:
    """Domes and dishes with joints, every seventh panel a plane, some without mould."""
    mesh = roof_net(n_around, n_across, 80.0)
    planes, great_spheres = circle_pencils(face_circles(mesh)[0])
    angles = np.random.default_rng(1).uniform(-0.5, 0.5, mesh.n_faces)
    angles[::7] = 0
    sphere_mesh = SphereMesh.from_local(mesh, pencil_spheres(planes, great_spheres, angles))
    labels = np.arange(mesh.n_faces) % n_moulds
    labels[3] = -1
    panels, rejected = cut_panels(sphere_mesh, thickness=0.02, joint_gap=0.01, labels=labels)
    assert not rejected
    return panels


@pytest.fixture(scope="module")
def panels() -> Panels:
    return roof_panels(12, 8)


@pytest.fixture(scope="module")
def path(panels: Panels, tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("rhino") / "Dächer.3dm"
    result = write_3dm(panels, target, graph_json=GRAPH, title="Roof", centers=True)
    assert result == target
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
        assert all(e.IsArc() if row[0] else e.IsLinear() for e in brep.Edges)
    middles = [
        e.Geometry.PointAt((e.Geometry.Domain.T0 + e.Geometry.Domain.T1) / 2) for e in edges
    ]
    owners = panels.corner_panels
    local = np.array([(p.X, p.Y, p.Z) for p in middles]) - panels.origins[owners]
    assert np.abs(signed_distance(panels.spheres[owners], local)).max() < 1e-12
    kinds = [isinstance(e.Geometry, rhino3dm.LineCurve) for e in edges]
    assert kinds == (panels.spheres[owners, 0] == 0).tolist()


def test_user_text(model: Any, panels: Panels) -> None:  # noqa: ANN401
    areas = panel_areas(panels)
    rows = zip(on_layer(model, "Panels"), panel_text(panels, "m"), strict=True)
    for i, (item, expected) in enumerate(rows):
        text = dict(item.Attributes.GetUserStrings())
        assert set(text) == set(TEXT_KEYS)
        assert text == expected
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
        for row in panel_text(select_panels(panels, keep), "m")
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
    assert set(layers) == {"Panels", *moulds, "Edges", "Centres"}
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


def test_centres(model: Any, panels: Panels) -> None:  # noqa: ANN401
    points = on_layer(model, "Centres")
    assert len(points) == np.count_nonzero(panels.spheres[:, 0])


def test_ids_are_stable_and_unique(model: Any, panels: Panels, tmp_path: Path) -> None:  # noqa: ANN401
    ids = [item.Attributes.Id for item in model.Objects]
    assert len(set(ids)) == len(ids)
    fewer = select_panels(panels, np.arange(panels.n_panels) >= 4)
    again = rhino3dm.File3dm.Read(str(write_3dm(fewer, tmp_path / "fewer.3dm")))
    names = {item.Attributes.Id: item.Attributes.Name for item in model.Objects}
    assert all(names[item.Attributes.Id] == item.Attributes.Name for item in again.Objects)


def test_output_is_the_same_but_for_the_time(panels: Panels, tmp_path: Path) -> None:
    first = write_3dm(panels, tmp_path / "first.3dm").read_bytes()
    second = write_3dm(panels, tmp_path / "second.3dm").read_bytes()
    assert len(first) == len(second)
    different = np.frombuffer(first, np.uint8) != np.frombuffer(second, np.uint8)
    assert np.count_nonzero(different) < 32
    assert np.flatnonzero(different).max(initial=0) < 1000


@pytest.mark.parametrize("version", [6, 7, 8])
@pytest.mark.parametrize(("units", "name"), [("mm", "Millimeters"), ("ft", "Feet")])
def test_versions_and_units(
    panels: Panels, tmp_path: Path, version: int, units: str, name: str
) -> None:
    few = select_panels(panels, np.arange(panels.n_panels) < 5)
    path = write_3dm(few, tmp_path / "model.3dm", units, version=version)
    model = rhino3dm.File3dm.Read(str(path))
    assert model.ArchiveVersion // 10 == version
    assert model.Settings.ModelUnitSystem == getattr(rhino3dm.UnitSystem, name)
    assert len(read_brep_streams(path.read_bytes())) == 5
    assert all(item.Geometry.IsValid for item in model.Objects)


def test_no_panels(panels: Panels, tmp_path: Path) -> None:
    none = select_panels(panels, np.zeros(panels.n_panels, bool))
    assert write_3dm(none, tmp_path / "empty.3dm").stat().st_size > 0


def test_inexact_breps_are_refused_by_name(
    panels: Panels, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    old = tmp_path / "old.3dm"
    old.write_bytes(b"older file")
    assert refused_breps(panels) == ()

    exact_streams = rhino.brep_streams

    def shifted(given: Panels) -> list[bytes]:
        corners = given.corners.copy()
        corners[given.offsets[17]] += 1e-6
        return exact_streams(replace(given, corners=corners))

    monkeypatch.setattr(rhino, "brep_streams", shifted)
    (refused,) = refused_breps(panels)
    assert refused.id == panels.ids[17]
    assert refused.face_id == 17
    with pytest.raises(InputError, match=f"1 panels are not exact: {panels.ids[17]}: "):
        write_3dm(panels, old)
    assert old.read_bytes() == b"older file"
    assert [file.name for file in tmp_path.iterdir()] == ["old.3dm"]


def test_breps_that_opennurbs_refuses(
    panels: Panels, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(rhino, "_judge", lambda *_: ())
    monkeypatch.setattr(rhino, "brep_streams", lambda given: [b"junk"] * given.n_panels)
    with pytest.raises(InputError, match="openNURBS cannot read"):
        write_3dm(panels, tmp_path / "model.3dm")
    assert not list(tmp_path.iterdir())


def test_wrong_input(panels: Panels, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="unknown units 'km'"):
        write_3dm(panels, tmp_path / "model.3dm", "km")
    with pytest.raises(InputError, match="Rhino version 5"):
        write_3dm(panels, tmp_path / "model.3dm", version=5)
    with pytest.raises(InputError, match="no folder"):
        write_3dm(panels, tmp_path / "missing" / "model.3dm")


def test_an_exporting_process_ends_well(tmp_path: Path) -> None:
    code = (
        "import sys; sys.path.insert(0, sys.argv[1])\n"
        "from test_rhino import roof_panels, write_3dm\n"
        "write_3dm(roof_panels(6, 5), sys.argv[2], centers=True)\n"
    )
    command = [sys.executable, "-c", code, str(Path(__file__).parent), str(tmp_path / "a.3dm")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert len(rhino3dm.File3dm.Read(str(tmp_path / "a.3dm")).Objects) > 150


def test_five_thousand_panels(tmp_path: Path) -> None:
    panels = roof_panels(100, 50, 12)
    start = time.process_time()
    path = write_3dm(panels, tmp_path / "roof.3dm", graph_json=GRAPH)
    assert time.process_time() - start < 12
    assert path.stat().st_size < 40e6
    assert len(read_brep_streams(path.read_bytes())) == 5000
