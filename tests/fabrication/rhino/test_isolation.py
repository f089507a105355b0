"""What a damaged file can do to a reader ends in one error, within seconds."""

import importlib
import os
import sys
import threading
import time
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from spheremesh.fabrication.rhino import isolation
from spheremesh.fabrication.rhino.isolation import isolated
from spheremesh.fabrication.rhino.reader import read_3dm
from spheremesh.kernel.errors import InputError

FAILURE = "takes too much time or memory: the file is damaged"


JOBS = """
import os, time
import numpy as np
from spheremesh.fabrication.rhino.isolation import allow_seconds
from spheremesh.kernel.errors import InputError

def spin():
    while True:
        pass

def take_memory():
    return int(np.ones(2**28).sum())

def spin_in_parts(n_parts):
    for _ in range(n_parts):
        allow_seconds(3)
        until = time.process_time() + 1.5
        while time.process_time() < until:
            pass
    return n_parts

def shout(text):
    os.write(1, b"noise on output")
    os.write(2, b"noise on errors")
    return text.upper()

def refuse(text):
    raise InputError(text)

def fail():
    raise UnicodeDecodeError("utf-8", bytes(1), 0, 1, "invalid start byte")
"""


@pytest.fixture
def jobs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """A module that both processes can import."""
    (tmp_path / "isolated_jobs.py").write_text(JOBS)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "isolated_jobs", raising=False)
    return importlib.import_module("isolated_jobs")


def test_results_and_arguments_are_handed_on(
    jobs: ModuleType, capfd: pytest.CaptureFixture[str]
) -> None:
    assert isolated(jobs.shout, "roof") == "ROOF"
    assert isolated(np.linspace, 0, 1, num=10**6).shape == (10**6,)
    assert capfd.readouterr() == ("", "")


def test_errors_are_raised_here(jobs: ModuleType) -> None:
    with pytest.raises(InputError, match=r"^no such thing$"):
        isolated(jobs.refuse, "no such thing")
    with pytest.raises(InputError, match=r"is damaged; .* \(UnicodeDecodeError: "):
        isolated(jobs.fail)


def test_time_is_limited_and_may_be_renewed(jobs: ModuleType) -> None:
    resource = pytest.importorskip("resource")  # not on Windows
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    with pytest.raises(InputError, match=FAILURE):
        isolated(jobs.spin)
    assert resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before < 6
    assert isolated(jobs.spin_in_parts, 4) == 4


def test_the_clock_limits_where_the_processor_time_is_not(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(isolation, "SLOWNESS", 0.3)
    with pytest.raises(InputError, match=FAILURE):
        isolated(time.sleep, 60)


@pytest.mark.skipif(sys.platform != "linux", reason="memory is limited on Linux alone")
def test_memory_is_limited(jobs: ModuleType) -> None:
    with pytest.raises(InputError, match="is damaged"):
        isolated(jobs.take_memory)


def test_a_process_that_dies_is_an_error() -> None:
    with pytest.raises(InputError, match=FAILURE):
        isolated(os.abort)


def test_threads_may_call(jobs: ModuleType) -> None:
    found: list[str] = []
    threads = [
        threading.Thread(target=lambda i=i: found.append(isolated(jobs.shout, f"t{i}")))
        for i in range(3)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(found) == ["T0", "T1", "T2"]


def test_frozen_programs_have_no_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "frozen", True, raising=False)
    assert isolated(os.getpid) == os.getpid()


@pytest.mark.parametrize(
    "data", [b"not Rhino", b"3D Geometry File Format        8" + bytes(99)]
)
def test_damaged_files(data: bytes) -> None:
    with pytest.raises(InputError, match="damaged"):
        read_3dm(data)
