"""The same job gives the same bytes: whatever the clock, the hash seed, the threads."""

import json
import os
import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path

import pytest
import rhino3dm

from spheremesh.fabrication.dates import source_date
from spheremesh.fabrication.mesh_files.writer import write_mesh
from spheremesh.kernel.errors import InputError
from spheremesh.nodes.library.input import ellipsoid_mesh


def files(folder: Path) -> dict[str, bytes]:
    """The files of a job but for what its report says of its own time."""
    found = {path.name: path.read_bytes() for path in folder.iterdir()}
    report = json.loads(found["report.json"])
    del report["seconds"], report["files"]["report.json"]
    return {**found, "report.json": json.dumps(report).encode()}


def test_the_same_job_gives_the_same_bytes(tmp_path: Path) -> None:
    mesh, made = tmp_path / "dome.obj", list[dict[str, bytes]]()
    write_mesh(ellipsoid_mesh(8, 4), mesh)
    for run in (1, 2):
        command = [
            sys.executable, "-W", "ignore", "-m", "spheremesh", "panel", str(mesh), "-o",
            str(tmp_path / str(run)), "--moulds", "3", "--thickness", "0.02", "--support",
            "--depth", "0.2", "--ifc", "--no-cache",
        ]  # fmt: skip
        settings = {"PYTHONHASHSEED": str(run), "OPENBLAS_NUM_THREADS": str(run)}
        environment = {**os.environ, **settings}
        subprocess.run(command, env=environment, check=True, capture_output=True)
        made.append(files(tmp_path / str(run)))
    assert (
        made[0].keys()
        == made[1].keys()
        >= {"model.3dm", "model.ifc", "panels.step", "view.html"}
    )
    assert [name for name, data in made[0].items() if data != made[1][name]] == []
    model = rhino3dm.File3dm.Read(str(tmp_path / "1" / "model.3dm"))
    assert model.Created.year == model.LastEdited.year == 1970
    assert b"'1970-01-01T00:00:00'" in made[0]["panels.step"][:999]


def test_the_date_is_that_of_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    assert source_date() is None
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86399")
    assert source_date() == datetime(1970, 1, 1, 23, 59, 59, tzinfo=UTC)
    for wrong in ("today", "1e99", "9" * 30):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", wrong)
        with pytest.raises(InputError, match="SOURCE_DATE_EPOCH is"):
            source_date()
