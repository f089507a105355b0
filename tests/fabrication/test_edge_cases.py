"""Whatever goes in is written or refused by name with a reason, by every writer."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rhino3dm
from OCP.BRepCheck import BRepCheck_Analyzer

from spheremesh import Mesh, SphereMesh
from spheremesh.fabrication.audit.report import audit_model
from spheremesh.fabrication.audit.subjects import USUAL_LIMITS, AuditLimits
from spheremesh.fabrication.drawings.beams import write_dxf
from spheremesh.fabrication.drawings.moulds import write_mould_drawings
from spheremesh.fabrication.model import Model, Written
from spheremesh.fabrication.rhino_models.writer import RhinoOptions, write_3dm
from spheremesh.fabrication.schedules.panels import panel_tables
from spheremesh.fabrication.schedules.writer import write_schedule
from spheremesh.fabrication.solids.opencascade_panels import panel_shapes
from spheremesh.fabrication.step.check import check_part21
from spheremesh.fabrication.step.writer import StepOptions, write_step
from spheremesh.kernel.arrays import norm
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.panels import Panels
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import roof_net, torus_net

Writer = Callable[[Model, Path], Written]


def write_rhino(model: Model, path: Path) -> Written:
    return write_3dm(model, path, RhinoOptions(layers=("Edges", "Centres", "Moulds")))


WRITERS: dict[str, Writer] = {
    "p.step": write_step,
    "q.step": lambda model, path: write_step(model, path, StepOptions(copies="instances")),
    "p.3dm": write_rhino,
    "p.csv": write_schedule,
    "p.json": write_schedule,
    "p.dxf": write_mould_drawings,
    "p.svg": write_mould_drawings,
}


# Neighbours of squares of a metre whose spheres differ on purpose step by up to 470 mm.
STEEP = AuditLimits(step_mm=500.0)


def write_all(panels: Panels, folder: Path, limits: AuditLimits = USUAL_LIMITS) -> None:
    """Every file; STEP text is sound, every solid valid, and the audit finds no error."""
    for name, write in WRITERS.items():
        file = write(Model(panels), folder / name)
        path = file.path
        assert file.rejected == file.notes == ()
        assert path.stat().st_size > 0
        if path.suffix == ".step":
            assert check_part21(path) == ()
    shapes = panel_shapes(panels, 1000.0)
    assert len(shapes) == panels.n_panels
    assert all(BRepCheck_Analyzer(shape).IsValid() for shape in shapes)
    assert not [f for f in audit_model(Model(panels), limits) if f.severity == "error"]


def step_names(path: Path) -> set[str]:
    """Names of products, with their letters beyond ASCII."""
    text = path.read_text("ascii").replace("\n", "")
    names = re.findall(r"=PRODUCT\('((?:[^']|'')*)'", text)
    letters = re.compile(r"\\X([24])\\([0-9A-F]+)\\X0\\")

    def decode(found: re.Match[str]) -> str:
        width = 2 * int(found[1])
        return "".join(
            chr(int(found[2][i : i + width], 16)) for i in range(0, len(found[2]), width)
        )

    return {
        letters.sub(decode, name).replace("''", "'").replace("\\\\", "\\") for name in names
    }


@pytest.mark.parametrize("thickness", [0.0, 0.05])
@pytest.mark.parametrize("angle", [-0.4, 0.0, 0.4])
def test_one_panel(
    squares: Callable[..., SphereMesh], tmp_path: Path, thickness: float, angle: float
) -> None:
    panels, rejected = cut_panels(squares(angle), thickness=thickness)
    assert not rejected
    write_all(panels, tmp_path)


@pytest.mark.parametrize("side", ["inward", "outward", "centred"])
def test_planes_and_spheres_of_both_signs(
    squares: Callable[..., SphereMesh], tmp_path: Path, side: str
) -> None:
    found = squares(0.0, 0.3, -0.3, 0.0, 1e-9, -0.02)
    panels, rejected = cut_panels(found, "bisector", 0.03, 0.01, side=side)  # type: ignore[arg-type]
    assert not rejected
    write_all(panels, tmp_path, STEEP)


def test_radii_below_three_quarters_of_an_edge(
    squares: Callable[..., SphereMesh], tmp_path: Path
) -> None:
    panels, rejected = cut_panels(squares(1.25, -1.25, 1.3), thickness=0.02, joint_gap=0.02)
    assert not rejected
    radii = 0.5 / np.abs(panels.spheres[:, 0])
    assert (radii < 0.75).all()
    write_all(panels, tmp_path, STEEP)


@pytest.mark.parametrize("degrees", [1.0, 0.1, 0.01])
@pytest.mark.parametrize("angle", [0.0, 0.2])
@pytest.mark.parametrize("thickness", [0.0, 0.01])
def test_corners_of_a_hundredth_of_a_degree(
    curved: Callable[..., SphereMesh],
    tmp_path: Path,
    degrees: float,
    angle: float,
    thickness: float,
) -> None:
    height = np.tan(np.radians(degrees))
    mesh = Mesh([[0, 0, 0], [1, 0, 0], [1, height, 0]], [[0, 1, 2]])
    panels, rejected = cut_panels(curved(mesh, [angle]), thickness=thickness)
    assert panels.n_panels + len(rejected) == 1
    assert not rejected, rejected[0].reason
    write_all(panels, tmp_path)
    found = {finding.code: finding.size for finding in audit_model(Model(panels))}
    assert found["P102"] == pytest.approx(degrees, rel=0.3)
    # A joint swallows what is thinner than itself.
    _, (refused,) = cut_panels(curved(mesh, [angle]), thickness=thickness, joint_gap=0.02)
    assert refused.id == "P0000"
    assert refused.reason


def test_names_of_any_script(squares: Callable[..., SphereMesh], tmp_path: Path) -> None:
    found = squares(*[0.1] * 8)
    panels, _ = cut_panels(found, thickness=0.05, labels=np.zeros(8, np.int64))
    names = (
        "Täfelchen 1", "面板-2", "<&>\"'; drop", "🏠 👩\u200d🚒", "a\\b \\X2\\ ^J %%c",
        "x" * 300,
        "<>/\\\":;?*|=`", "-1",
    )  # fmt: skip
    named = replace(panels, ids=names)
    write_all(named, tmp_path)
    assert [row["id"] for row in panel_tables(named, "m")["Panels"]] == list(names)
    for name in ("p.csv", "p.json", "p.dxf", "p.svg"):
        assert "面板-2" in (tmp_path / name).read_text("utf-8").replace(
            "\\u9762\\u677f", "面板"
        )
    assert set(names) < step_names(tmp_path / "p.step")
    model: Any = rhino3dm.File3dm.Read(str(tmp_path / "p.3dm"))
    found = [
        each.Attributes for each in model.Objects if isinstance(each.Geometry, rhino3dm.Brep)
    ]
    found = [each for each in found if not each.IsInstanceDefinitionObject]
    assert [each.Name for each in found] == list(names)
    assert [each.GetUserString("id") for each in found] == list(names)


@pytest.mark.parametrize(
    "name",
    ["", " A", "A ", "A\n1", "A\rB", "\t", "A\0",
     "\x07", "A\x85B", "A\u2028", "\ud800", "\ufffe"],
)  # fmt: skip
def test_names_that_files_would_change_are_refused(
    squares: Callable[..., SphereMesh], tmp_path: Path, name: str
) -> None:
    """Rhino trims and cuts them, XML and workbooks break on them, DXF joins their lines."""
    panels, _ = cut_panels(squares(0.1, 0.2), thickness=0.05)
    named = replace(panels, ids=("A", name))
    for file, write in WRITERS.items():
        with pytest.raises(
            InputError, match=r"panel 1 is called .*: a name is one line of text"
        ):
            write(Model(named), tmp_path / file)
    spheres = central_spheres(torus_net(7, 5, 3.0, 1.0))
    beams = cut_beams(annulus_support(spheres, 0.3).annuli, 0.04)[0]
    beams = select_parts(beams, np.arange(beams.n_beams) < 2)
    beams = replace(beams, annuli=replace(beams.annuli, ids=(name, "B")))
    with pytest.raises(InputError, match=r"beam 0 is called .*: a name is one line of text"):
        write_dxf(Model(beams=beams), tmp_path / "b.dxf")
    assert not list(tmp_path.iterdir())


def test_names_of_beams_in_any_script(tmp_path: Path) -> None:
    spheres = central_spheres(torus_net(7, 5, 3.0, 1.0))
    beams = cut_beams(annulus_support(spheres, 0.3).annuli, 0.04)[0]
    beams = select_parts(beams, np.arange(beams.n_beams) < 2)
    names = ("Träger 1", "梁-2")
    beams = replace(beams, annuli=replace(beams.annuli, ids=names))
    path = write_step(Model(beams=beams), tmp_path / "b.step").path
    assert set(names) < step_names(path)
    assert "梁-2" in write_dxf(Model(beams=beams), tmp_path / "b.dxf").path.read_text("utf-8")
    path = write_3dm(Model(beams=beams), tmp_path / "b.3dm").path
    model: Any = rhino3dm.File3dm.Read(str(path))
    found = [
        each.Attributes for each in model.Objects if type(each.Geometry).__name__ == "Brep"
    ]
    assert [each.Name for each in found] == list(names)
    assert [each.GetUserString("id") for each in found] == list(names)


@pytest.mark.parametrize("name", WRITERS)
def test_what_no_file_can_hold_is_refused_by_name(
    squares: Callable[..., SphereMesh], tmp_path: Path, name: str
) -> None:
    panels, _ = cut_panels(squares(0.1, 0.2, 0.3), thickness=0.05)
    write, target = WRITERS[name], tmp_path / name
    with pytest.raises(InputError, match="there are no panels to write to"):
        write(Model(select_parts(panels, np.zeros(3, bool))), target)
    with pytest.raises(InputError, match=r"2 panels are called 'A' \(faces \[0, 2\]\)"):
        write(Model(replace(panels, ids=("A", "B", "A"))), target)
    inner = panels.inner_corners.copy()
    inner[6] = np.inf
    with pytest.raises(InputError, match=r"panel P0001 \(1 in all\) is not finite"):
        write(Model(replace(panels, inner_corners=inner)), target)
    assert not list(tmp_path.iterdir())


def test_caps_and_thicknesses_beyond_reach_are_refused_and_the_rest_is_written(
    squares: Callable[..., SphereMesh], tmp_path: Path
) -> None:
    found = squares(0.2, 1.5, -1.0, 0.0, -0.3)
    # Radius 0.84 on the third: a thickness of 0.84 leaves nothing of it.
    panels, rejected = cut_panels(found, thickness=0.84)
    assert {panel.id: panel.reason.split(":")[0] for panel in rejected} == {
        "P0001": "the outer face reaches more than 80 degrees from its middle",
        "P0002": "the thickness reaches the centre of the sphere",
    }
    assert panels.ids == ("P0000", "P0003", "P0004")
    write_all(panels, tmp_path, STEEP)


def test_law_millimetres_are_the_same_in_every_unit(
    moulded: Callable[..., Panels], tmp_path: Path
) -> None:
    """A roof drawn in metres, millimetres and feet, from the mesh to the files."""
    rows, numbers = [], []
    for units, scale in (("m", 1.0), ("mm", 1000.0), ("ft", 1 / 0.3048)):
        roof = roof_net(6, 7, 30.0)
        spheres = fit_spheres(Mesh(scale * roof.vertices, roof.faces))
        panels = moulded(spheres, 0.05 * scale, 0.01 * scale)
        rows.append(panel_tables(panels, units)["Panels"])
        text = write_step(Model(panels, units=units), tmp_path / "p.step").path.read_text(
            "ascii"
        )
        found = re.findall(r"CARTESIAN_POINT\('',\(([^)]*)\)\)", text.replace("\n", ""))
        # Points of parameter curves have two coordinates, which are angles.
        points = [[float(x) for x in point.split(",")] for point in found]
        numbers.append(np.array([point for point in points if len(point) == 3]))
    for other in (1, 2):
        for a, b in zip(rows[0], rows[other], strict=True):
            assert a["id"] == b["id"]
            assert a["mould"] == b["mould"]
            for name in ("radius_mm", "edge_lengths_mm", "corners_mm", "size_mm"):
                np.testing.assert_allclose(a[name], b[name], rtol=0, atol=1e-9)
            assert a["area_m2"] == pytest.approx(b["area_m2"], rel=1e-9)
        # The last digit written is a picometre, and may be rounded either way.
        assert norm(numbers[0] - numbers[other]).max() < 2e-9  # mm


def test_planes_of_a_whole_roof(tmp_path: Path) -> None:
    panels, rejected = cut_panels(face_planes(roof_net(4, 4, 10.0)), "bisector", 0.05, 0.01)
    assert not rejected
    write_all(panels, tmp_path)
