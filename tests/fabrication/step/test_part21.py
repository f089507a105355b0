"""The structural check of STEP files: silent on what the library writes, loud on any defect."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.fabrication.model import Model
from spheremesh.fabrication.step.assembly import StepSchema
from spheremesh.fabrication.step.check import SHOWN, check_part21
from spheremesh.fabrication.step.writer import StepCopies, StepOptions, write_step
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.panels import Panels
from spheremesh.kernel.sphere_meshes.fit import fit_spheres
from spheremesh.kernel.surfaces.circular_nets import torus_net


def ring(thickness: float) -> Panels:
    mesh: Mesh = torus_net(8, 6, 10.0, 3.0)
    labels = np.arange(mesh.n_faces) % 4 - 1
    return cut_panels(fit_spheres(mesh), thickness=thickness, labels=labels)[0]


@pytest.fixture(scope="module")
def text(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("part21") / "p.step"
    return write_step(Model(ring(0.1)), path, StepOptions(title="Dächer 'Süd'")).path.read_text(
        "ascii"
    )


@pytest.mark.parametrize("thickness", [0.0, 0.1])
@pytest.mark.parametrize("copies", ["shapes", "instances"])
@pytest.mark.parametrize(
    ("schema", "unit"), [("AP214IS", "mm"), ("AP242DIS", "m"), ("AP242DIS", "ft")]
)
def test_what_the_library_writes_is_sound(
    tmp_path: Path, thickness: float, copies: StepCopies, schema: StepSchema, unit: str
) -> None:
    panels = ring(thickness)
    path = write_step(
        Model(panels),
        tmp_path / "p.step",
        StepOptions(units=unit, schema=schema, copies=copies),
    ).path
    assert check_part21(path) == ()


def test_names_of_any_script_are_sound(tmp_path: Path) -> None:
    names = ["Täfelchen Ⅷ", "面板-7", "l'été; #12=('", "a\\b", "𝔘"]
    panels = ring(0.0)
    ids = (*names, *panels.ids[len(names) :])
    path = write_step(
        Model(replace(panels, ids=ids)), tmp_path / "p.step", StepOptions(title="屋根")
    ).path
    assert check_part21(path) == ()


def swap(pattern: str, change: str) -> tuple[str, str]:
    return pattern, change


DEFECTS = {
    "S101": [swap("ENDSEC;\nEND-ISO", "END-ISO"), swap("ISO-10303-21;\nHEADER", "HEADER")],
    "S102": [swap("AUTOMOTIVE_DESIGN", "CONFIG_CONTROL"), swap("FILE_NAME", "NAME")],
    "S103": [swap("'Panels','Panels'", "'Pänels','Panels'"), swap(r"\\X2\\0", r"\\X2\\")],
    "S104": [
        swap(r"CIRCLE\('',(#\d+),([^)]*)\)", r"CIRCLE('',\1,\2"),
        swap(r"DIRECTION\('',\(([^,]*),([^,]*),", r"DIRECTION('',(nan,\2,"),
        swap(r"ORIENTED_EDGE\('',\*", "ORIENTED_EDGE('',?"),
        swap(r"PLANE\('',(#\d+)\)", r"PLANE(''\1)"),
        swap(r"\nENDSEC;\nEND", r"\n#9999999=PLANE('',#1)\nENDSEC;\nEND"),
    ],
    "S105": [swap(r"PLANE\(''", "TOROIDAL_SURFACE(''"), swap("SI_UNIT", "IMPERIAL_UNIT")],
    "S106": [swap(r"PLANE\('',", "PLANE("), swap(r"SI_UNIT\(", r"SI_UNIT($,")],
    "S201": [swap(r"#(\d+)=(PLANE\('',#\d+\);)", r"#\1=\2\n#\1=\2")],
    "S202": [swap(r"PLANE\('',#\d+\)", "PLANE('',#99999999)")],
    "S203": [swap(r"#(\d+)=(PLANE\('',#\d+\);)", r"#\1=\2\n#99999999=\2")],
    "S301": [swap(r"EDGE_LOOP\('',\((#\d+),(#\d+),", r"EDGE_LOOP('',(\2,\1,")],
    "S302": [
        swap(r"FACE_OUTER_BOUND\('',(#\d+),\.T\.", r"FACE_OUTER_BOUND('',\1,.F."),
        swap(r"CLOSED_SHELL\('',\(#\d+,", "CLOSED_SHELL('',("),
    ],
}  # fmt: skip


@pytest.mark.parametrize(
    ("code", "pattern", "change"),
    [(code, *defect) for code, defects in DEFECTS.items() for defect in defects],
)
def test_every_defect_is_found(
    text: str, tmp_path: Path, code: str, pattern: str, change: str
) -> None:
    path = tmp_path / "broken.step"
    broken, count = re.subn(pattern, change, text, count=1)
    assert count == 1
    path.write_text(broken, "utf-8")
    findings = check_part21(path)
    assert code in {finding.code for finding in findings}
    assert all(finding.severity == "error" and finding.message for finding in findings)


def test_every_edge_of_a_missing_face_is_named(text: str, tmp_path: Path) -> None:
    path = tmp_path / "open.step"
    path.write_text(re.sub(r"CLOSED_SHELL\('',\(#\d+,", "CLOSED_SHELL('',(", text, count=1))
    findings = check_part21(path)
    assert sorted(finding.code for finding in findings) == ["S203"] + 4 * ["S302"]


def test_a_file_without_geometry_is_no_model(text: str, tmp_path: Path) -> None:
    path = tmp_path / "empty.step"
    header, _, _ = text.partition("DATA;")
    body = "#1=APPLICATION_PROTOCOL_DEFINITION('','',2000,#2);#2=APPLICATION_CONTEXT('');"
    path.write_text(f"{header}DATA;\n{body}\nENDSEC;\nEND-ISO-10303-21;\n")
    assert [finding.code for finding in check_part21(path)] == ["S303"]


@pytest.mark.parametrize(
    ("code", "old", "new"),
    [("S105", "=CIRCLE(", "=KREIS("), ("S103", "=CIRCLE('", "=CIRCLE('\\Q")],
)
def test_many_findings_of_one_kind_are_counted(
    text: str, tmp_path: Path, code: str, old: str, new: str
) -> None:
    path = tmp_path / "broken.step"
    count = text.count("=CIRCLE(")
    path.write_text(text.replace(old, new))
    findings = [finding for finding in check_part21(path) if finding.code == code]
    assert len(findings) == SHOWN + 1
    assert findings[-1].size == count - SHOWN
    assert findings[-1].message.startswith(f"{count - SHOWN} more: ")


def test_garbage_is_judged_and_missing_files_are_named(tmp_path: Path) -> None:
    for content in (b"", b"\x00\xff" * 50, b"solid STL", b"ISO-10303-21;"):
        path = tmp_path / "x.step"
        path.write_bytes(content)
        assert "S101" in {finding.code for finding in check_part21(path)}
    with pytest.raises(InputError, match="cannot read"):
        check_part21(tmp_path / "none.step")
