"""No room or no right: every writer says so in one error and keeps the older file."""

import os
import sys
import tempfile
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path

import pytest

from spheremesh import nodes
from spheremesh.kernel.errors import InputError
from spheremesh.nodes.graphs.node import REGISTRY, load_library

if sys.platform != "win32":
    import resource


@contextmanager
def room(n_bytes: int) -> Generator[None]:
    """No file can grow beyond so many bytes, as on a disk that is full then."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (n_bytes, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@contextmanager
def read_only(folder: Path) -> Generator[None]:
    """No file of a folder can be made or replaced; root, who may all, is nobody meanwhile."""
    folder.chmod(0o555)
    is_root = os.geteuid() == 0
    if is_root:
        os.seteuid(65534)
    try:
        yield
    finally:
        if is_root:
            os.seteuid(0)
        folder.chmod(0o755)


def writers() -> dict[str, Callable[[Path], object]]:
    """A call for each kind of file that each writer writes, by name of the node and suffix."""
    mesh = nodes.ellipsoid_mesh(6, 3)
    spheres = nodes.fit_spheres(mesh)
    cut = nodes.panels(spheres, thickness=0.02)
    panels = cut.panels
    beams = nodes.beams(nodes.annulus_support(spheres, depth=0.25).annuli, 0.025).beams
    smooth = nodes.minimize_angles(spheres)
    report = nodes.panel_report(smooth.sphere_mesh, smooth.report, cut.report)
    small = {"width": 160, "height": 100}
    return {
        "write_step.step": lambda path: nodes.write_step(panels, path, beams=beams),
        "write_3dm.3dm": lambda path: nodes.write_3dm(panels, path, beams=beams),
        "write_dxf.dxf": lambda path: nodes.write_dxf(beams, path),
        "write_schedule.csv": lambda path: nodes.write_schedule(panels, path),
        "write_schedule.json": lambda path: nodes.write_schedule(panels, path, beams=beams),
        "write_schedule.xlsx": lambda path: nodes.write_schedule(panels, path, beams=beams),
        "write_mould_drawings.dxf": lambda path: nodes.write_mould_drawings(panels, path),
        "write_mould_drawings.svg": lambda path: nodes.write_mould_drawings(panels, path),
        "render.png": lambda path: nodes.render(panels, path, **small),
        "render_assembly.png": lambda path: nodes.render_assembly(panels, beams, path, **small),
        "write_view.html": lambda path: nodes.write_view(panels, path, beams=beams),
        "write_ifc.ifc": lambda path: nodes.write_ifc(panels, beams, path),
        "write_report.html": lambda path: nodes.write_report(report, panels, spheres, path),
        "write_move_drawing.svg": lambda path: nodes.write_move_drawing(mesh, spheres, path),
        "write_tables.xlsx": lambda path: nodes.write_tables(panels, path, beams=beams),
        "write_drawings.pdf": lambda path: nodes.write_drawings(panels, path, beams=beams),
        "write_drawings.dxf": lambda path: nodes.write_drawings(panels, path, beams=beams),
        **{
            f"write_mesh.{kind}": lambda path: nodes.write_mesh(mesh, path)
            for kind in ("obj", "off", "ply", "stl", "3dm")
        },
    }


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no bound on sizes of files")
def test_every_writer_on_a_full_disk_and_in_a_folder_that_is_read_only() -> None:
    calls = writers()
    load_library()
    writing = {node.name for node in REGISTRY.values() if node.is_writer}
    assert {name.split(".")[0] for name in calls} >= writing
    # The folder of pytest is closed to nobody.
    with tempfile.TemporaryDirectory() as folder:
        for name, write in calls.items():
            path = Path(folder) / name
            write(path)
            size = path.stat().st_size
            path.write_bytes(b"old")
            for n_bytes in (0, size // 2, size - 1):
                with room(n_bytes), pytest.raises(InputError, match=f"cannot write .*{name}"):
                    write(path)
                assert path.read_bytes() == b"old"
            with read_only(path.parent), pytest.raises(InputError, match=f"cannot .*{name}"):
                write(path)
            assert path.read_bytes() == b"old"
        assert {path.name for path in Path(folder).iterdir()} == set(calls)
