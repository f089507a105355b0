"""What Rhino shows is what is read; the rest is counted and said."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
import rhino3dm

from spheremesh import nodes
from spheremesh.fabrication.rhino.object_polygons import FileObjects, read_objects
from spheremesh.fabrication.rhino.reader import read_3dm
from spheremesh.fabrication.rhino.surface_reader import GridSize
from spheremesh.kernel.errors import InputError


def square(x: float = 0.0, *, name: str = "", layer: int = -1, **options: Any) -> tuple:  # noqa: ANN401
    """A mesh of one square with its attributes."""
    mesh = rhino3dm.Mesh()
    for corner in ((0, 0), (1, 0), (1, 1), (0, 1)):
        mesh.Vertices.Add(corner[0] + x, corner[1], 0)
    mesh.Faces.AddFace(0, 1, 2, 3)
    return mesh, attributes(name, layer, **options)


def attributes(name: str = "", layer: int = -1, **options: Any) -> rhino3dm.ObjectAttributes:  # noqa: ANN401
    found = rhino3dm.ObjectAttributes()
    found.Name, found.LayerIndex = name, layer
    for option, value in options.items():
        setattr(found, option, value)
    return found


def model_of(*objects: tuple, layers: tuple[tuple[str, str, bool], ...] = ()) -> Any:  # noqa: ANN401
    """A model of objects on layers: name, name of the parent, whether it is on."""
    model: Any = rhino3dm.File3dm()
    for name, parent, is_on in layers:
        layer = rhino3dm.Layer()
        layer.Name, layer.Visible = name, is_on
        if parent:
            layer.ParentLayerId = next(each.Id for each in model.Layers if each.Name == parent)
        model.Layers.Add(layer)
    for geometry, found in objects:
        model.Objects.Add(geometry, found)
    return model


def encoded(model: Any) -> bytes:  # noqa: ANN401
    """The file of a model."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "a.3dm"
        assert model.Write(str(path), 8)
        return path.read_bytes()


def read(model: Any, layer: str = "") -> FileObjects:  # noqa: ANN401
    """Without a process of its own, which takes longer."""
    return read_objects(encoded(model), layer, GridSize(2, 2))


def labels(found: FileObjects) -> list[str]:
    return [each.label for each in found.objects]


TREE = (("Roof", "", True), ("Glass", "Roof", True), ("Old", "", False), ("Frame", "Old", True))


def tree() -> Any:  # noqa: ANN401
    """A square on each of the layers of TREE, and one hidden by itself on Roof."""
    objects = [square(2.0 * i, name=name, layer=i) for i, (name, _, _) in enumerate(TREE)]
    hidden = square(9.0, name="one", layer=0, Visible=False)
    return model_of(*objects, hidden, layers=TREE)


def test_layers_that_are_off_and_hidden_objects_are_left_out() -> None:
    found = read(tree())
    assert labels(found) == [
        "mesh 'Roof' on layer 'Roof'",
        "mesh 'Glass' on layer 'Roof::Glass'",
    ]
    (remark,) = found.remarks
    assert remark.startswith("left out 3 hidden objects: ")
    for reason in (
        "1 on layer 'Old', which is off",
        "1 on layer 'Old::Frame', which is off",
        "1 hidden one by one",
    ):
        assert reason in remark


@pytest.mark.parametrize(
    ("layer", "expected"),
    [
        ("roof", ["Roof", "Glass"]),
        ("ROOF::glass", ["Glass"]),
        ("glass", ["Glass"]),
        ("Glass, old", ["Glass", "Old", "Frame"]),
        ("Old::Frame", ["Frame"]),
    ],
)
def test_layers_by_name(layer: str, expected: list[str]) -> None:
    found = read(tree(), layer)
    assert [label.split("'")[1] for label in labels(found)] == expected
    is_off = any("it is read as it was asked for" in remark for remark in found.remarks)
    assert is_off == ("old" in layer.casefold())


def test_sublayers_that_are_off_by_themselves_stay_off() -> None:
    layers = (("Roof", "", True), ("Old", "Roof", False))
    model = model_of(square(name="a", layer=0), square(2, name="b", layer=1), layers=layers)
    found = read(model, "Roof")
    assert labels(found) == ["mesh 'a' on layer 'Roof'"]
    assert "1 on layer 'Roof::Old', which is off" in found.remarks[0]


def test_names_that_fit_nothing_list_the_layers() -> None:
    with pytest.raises(InputError, match=r"'Wall'.*'Roof', 'Roof::Glass', 'Old' \(off\)"):
        read(tree(), "Wall")


def test_a_name_may_have_commas() -> None:
    layers = (("A", "", True), ("A, B", "", True))
    model = model_of(*(square(2.0 * i, name=str(i), layer=i) for i in range(2)), layers=layers)
    assert labels(read(model, "a, b")) == ["mesh '1' on layer 'A, B'"]


def test_locked_objects_and_groups_are_taken() -> None:
    locked = attributes("locked", 0, Mode=rhino3dm.ObjectMode.Locked)
    grouped = attributes("grouped", 0)
    model = model_of(layers=(("Roof", "", True),))
    model.Layers[0].Locked = True
    model.Groups.Add(rhino3dm.Group())
    grouped.AddToGroup(0)
    model.Objects.Add(square()[0], locked)
    model.Objects.Add(square(3)[0], grouped)
    found = read(model)
    assert len(found.objects) == 2
    assert not found.remarks


def test_what_stands_on_a_layout_is_no_model() -> None:
    page = square(3, ActiveSpace=rhino3dm.ActiveSpace.PageSpace)
    found = read(model_of(square(name="a"), page))
    assert labels(found) == ["mesh 'a'"]
    assert "1 on layouts" in found.remarks[0]


def test_all_hidden_is_an_error_that_says_so() -> None:
    with pytest.raises(InputError, match=r"that are shown.*left out 1 hidden object"):
        read(model_of(square(Visible=False)))


def test_members_of_blocks_on_layers_that_are_off() -> None:
    layers = (("On", "", True), ("Off", "", False))
    model = model_of(layers=layers)
    members = [square(2.0 * i, name=str(i), layer=i) for i in range(2)]
    model.InstanceDefinitions.Add(
        "block", "", "", "", rhino3dm.Point3d(0, 0, 0),
        tuple(each[0] for each in members), tuple(each[1] for each in members),
    )  # fmt: skip
    block = next(each.Id for each in model.InstanceDefinitions)
    for layer in (0, 1):
        moved = rhino3dm.Transform.Translation(0, 3.0 * layer, 0)
        model.Objects.Add(rhino3dm.InstanceReference(block, moved), attributes("", layer))
    found = read(model)
    assert labels(found) == ["mesh '0' on layer 'On'"]
    assert "left out 2 hidden objects" in found.remarks[0]


def test_kinds_side_by_side() -> None:
    ball = rhino3dm.Sphere(rhino3dm.Point3d(9, 0, 0), 1.0).ToNurbsSurface()
    circle = rhino3dm.Circle(1.0).ToNurbsCurve()
    point = rhino3dm.Point(rhino3dm.Point3d(0, 0, 0))
    plain = attributes()
    model = model_of(
        square(name="shell"), (ball, attributes("ball")), (circle, plain), (circle, plain),
        (point, plain), (rhino3dm.TextDot("a", rhino3dm.Point3d(0, 0, 0)), plain),
        (rhino3dm.SubD(), attributes("blob")),
    )  # fmt: skip
    found = read(model)
    assert labels(found) == ["mesh 'shell'", "surface 'ball'"]
    subd, others = found.remarks
    assert "SubD 'blob'" in subd
    assert "ToNURBS" in subd
    assert others == "left out what has no faces: 2 curves, 1 point, 1 text dot"


def test_one_object_that_cannot_be_read_does_not_take_the_others_along() -> None:
    broken = rhino3dm.Mesh()
    for x in (0.0, 1.0, np.nan):
        broken.Vertices.Add(x, x * x, 0)
    broken.Faces.AddFace(0, 1, 2)
    found = read(model_of((broken, attributes("broken")), square(name="good")))
    assert labels(found) == ["mesh 'good'"]
    assert found.remarks == (
        "left out mesh 'broken': its coordinates are not finite; delete it or export it again",
    )
    with pytest.raises(InputError, match="mesh 'broken': its coordinates"):
        read(model_of((broken, attributes("broken"))))


def test_sources_count_faces_and_slivers_are_said() -> None:
    mesh, found = square(name="wall")
    mesh.Vertices.Add(0, 0, 0)
    mesh.Vertices.Add(2, 2, 2)
    mesh.Faces.AddFace(0, 4, 5)
    content = read_3dm(encoded(model_of((mesh, found), square(5, name="roof"))))
    assert content.sources == (("mesh 'wall'", 1), ("mesh 'roof'", 1))
    assert content.remarks == ("left out 1 faces of no area of mesh 'wall'",)
    assert len(content.polygons.vertices) == 8


def test_a_mesh_made_from_a_surface_beside_it_is_doubted() -> None:
    mesh = rhino3dm.Mesh()
    for x, z in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        mesh.Vertices.Add(x, x, z)
    mesh.Faces.AddFace(0, 1, 2, 3)
    ball = rhino3dm.Sphere(rhino3dm.Point3d(0, 0, 0), 1.0).ToNurbsSurface()
    model = model_of((mesh, attributes("mesh")), (ball, attributes("ball")))
    model_remarks = read_3dm(encoded(model)).remarks
    assert any("fills the same box as mesh 'mesh'" in remark for remark in model_remarks)


def test_remarks_reach_the_warnings_of_the_node(tmp_path: Path) -> None:
    model = tree()
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Meters
    (tmp_path / "a.3dm").write_bytes(encoded(model))
    with pytest.warns(UserWarning, match="left out 3 hidden objects"):
        nodes.read_mesh(tmp_path / "a.3dm")
