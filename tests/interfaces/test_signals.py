"""Signals end commands as errors do: with the shell's exit code, and nothing half made."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import spheremesh as sm

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals of Windows are others")


@pytest.fixture
def graph(tmp_path: Path) -> Path:
    """A graph that writes for a while: meshes of n rows."""
    study = sm.Graph("study")
    n = study.param("n", 300)
    mesh = study.add("roof_mesh", "mesh", n_span=n, n_length=n)
    for name in ("first.obj", "second.obj", "third.obj"):
        study.add("write_mesh", name[:-4], mesh=mesh, path=name)
    path = tmp_path / "study.json"
    study.save(path)
    return path


def started(*words: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", "spheremesh", *words, "--no-cache"]
    # Who runs the tests in the background has Ctrl+C ignored, and processes inherit that.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    finally:
        signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_in_the_middle_leaves_nothing(
    graph: Path, number: signal.Signals, code: int
) -> None:
    out = graph.parent / "out"
    process = started("run", str(graph), "-o", str(out))
    while not list(out.glob(".spheremesh-*/*")):  # the first file is on its way
        assert process.poll() is None
        time.sleep(0.005)
    process.send_signal(number)
    said, _ = process.communicate()
    assert (process.returncode, said) == (code, b"")
    assert list(graph.parent.iterdir()) == [graph]


def test_a_study_that_is_ended_ends_its_workers(graph: Path) -> None:
    out = graph.parent / "out"
    values = ",".join(str(n) for n in range(50, 450))
    process = started(
        "sweep", str(graph), "--set", f"n={values}", "--target", "third", "-o", str(out),
        "--workers", "2",
    )  # fmt: skip
    while not list(out.glob("*/third.obj")):
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGTERM)
    said, _ = process.communicate(timeout=60)  # it ends when its workers have
    assert process.returncode == 143, said.decode()
    assert not list(out.rglob(".spheremesh-*"))


def test_a_reader_that_goes_away_ends_a_command_in_silence() -> None:
    command = [sys.executable, "-m", "spheremesh", "nodes"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        said = process.stderr.read()
    assert (process.returncode, said) == (1, b"")
