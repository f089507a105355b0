"""Files of a job move together: one job at a time, whole if killed, signals wait."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from spheremesh.fabrication.folders import finish_moves, replacing_all
from spheremesh.kernel.errors import InputError

DAY = 86400


def test_folders_that_killed_processes_left_go_after_a_day(
    tmp_path: Path, leave: Callable[[Path, float], Path]
) -> None:
    old = leave(tmp_path / ".spheremesh-abc_12ef", 2 * DAY)
    kept = [
        leave(tmp_path / ".spheremesh-abcdefgh", 0.5 * DAY),
        leave(tmp_path / ".panels-spheremesh-abcdefgh.step", 2 * DAY),
    ]
    with replacing_all(tmp_path) as staging:
        (staging / "a.txt").write_text("new")
    assert not old.exists()
    assert set(tmp_path.iterdir()) == {tmp_path / "a.txt", *kept}


def test_files_of_a_folder_move_as_they_were_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A report that is written last tells, if it is new, that all files are."""
    moved: list[str] = []
    replace = Path.replace

    def note(self: Path, target: Path) -> Path:
        moved.append(target.name)
        return replace(self, target)

    monkeypatch.setattr(Path, "replace", note)
    names = ["b.txt", "c.txt", "a.txt"]
    with replacing_all(tmp_path) as staging:
        for i, name in enumerate(names):
            (staging / name).write_text("new")
            os.utime(staging / name, ns=(10**9 * i, 10**9 * i))
    assert moved == names


def write_both(folder: Path) -> None:
    for name in ("a.txt", "b.txt"):
        (folder / name).write_text("new")


def test_files_of_a_folder_move_only_if_all_can(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("old")
    (tmp_path / "b.txt").mkdir()
    with (
        pytest.raises(InputError, match=r"cannot write .*b\.txt: it is a folder"),
        replacing_all(tmp_path) as staging,
    ):
        write_both(staging)
    assert (tmp_path / "a.txt").read_text() == "old"
    assert {path.name for path in tmp_path.iterdir()} == {"a.txt", "b.txt"}


def test_a_file_of_a_folder_that_is_held_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise PermissionError(13, "The process cannot access the file")

    monkeypatch.setattr(Path, "replace", fail)
    with (
        pytest.raises(InputError, match=r"cannot write .*a\.txt: The process cannot access"),
        replacing_all(tmp_path) as staging,
    ):
        (staging / "a.txt").write_text("new")
    assert not list(tmp_path.iterdir())


def test_a_folder_in_the_place_of_one_file_keeps_all_others(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("old")
    (tmp_path / "b.txt").mkdir()

    def _write() -> None:
        with replacing_all(tmp_path) as staging:
            for name in ("a.txt", "b.txt"):
                (staging / name).write_text("new")

    with pytest.raises(InputError, match=r"b\.txt: it is a folder"):
        _write()
    assert (tmp_path / "a.txt").read_text() == "old"
    assert {path.name for path in tmp_path.iterdir()} == {"a.txt", "b.txt"}


def interrupt(folder: Path, moves: int) -> None:
    """Write three files over older ones in a process that dies after so many moves."""
    code = """
import os, sys
from pathlib import Path
from spheremesh.fabrication.folders import replacing_all

folder, left = Path(sys.argv[1]), int(sys.argv[2])
replace = Path.replace

def die(self, target):
    global left
    if not left:
        os._exit(9)
    left -= 1
    return replace(self, target)

Path.replace = die
with replacing_all(folder) as staging:
    for i, name in enumerate(("a.txt", "b.txt", "report.json")):
        (staging / name).write_text("new")
        os.utime(staging / name, ns=(10**18 + i, 10**18 + i))
"""
    for name in ("a.txt", "b.txt", "report.json"):
        (folder / name).write_text("old")
        os.utime(folder / name, ns=(10**17, 10**17))
    done = subprocess.run([sys.executable, "-c", code, str(folder), str(moves)], check=False)
    assert done.returncode == 9


def contents(folder: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in folder.iterdir() if path.suffix}


def test_the_next_job_finishes_what_a_killed_one_began(tmp_path: Path) -> None:
    interrupt(tmp_path, 1)
    assert sorted(contents(tmp_path).values()) == ["new", "old", "old"]
    finish_moves(tmp_path)
    assert len(list(tmp_path.iterdir())) == 3
    assert contents(tmp_path) == {"a.txt": "new", "b.txt": "new", "report.json": "new"}


def test_what_was_changed_after_a_kill_stays(tmp_path: Path) -> None:
    whole = tmp_path / ".spheremesh-whole-abcdefgh"
    whole.mkdir()
    for name in ("b.txt", "report.json"):
        (whole / name).write_text("new")
    (tmp_path / "b.txt").write_text("mine")
    later = time.time() + 10
    os.utime(tmp_path / "b.txt", (later, later))
    with replacing_all(tmp_path) as staging:
        (staging / "c.txt").write_text("next")
    assert contents(tmp_path) == {"b.txt": "mine", "report.json": "new", "c.txt": "next"}


def test_jobs_in_one_folder_win_whole(tmp_path: Path) -> None:
    begun = threading.Barrier(4)
    names = [f"{letter}.txt" for letter in "abcdef"]

    def job(word: str) -> None:
        for _ in range(10):
            with replacing_all(tmp_path) as staging:
                for name in names:
                    (staging / name).write_text(word)
                begun.wait(30)

    threads = [threading.Thread(target=job, args=(word,)) for word in ("1", "2", "3")]
    for thread in threads:
        thread.start()
    for _ in range(10):
        begun.wait(30)
    for thread in threads:
        thread.join()
    assert len(set(contents(tmp_path).values())) == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == names


@pytest.mark.skipif(sys.platform == "win32", reason="signals of Windows are others")
def test_signals_wait_until_all_files_have_moved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    replace = Path.replace

    def signalled(self: Path, target: Path) -> Path:
        signal.raise_signal(signal.SIGINT)
        return replace(self, target)

    monkeypatch.setattr(Path, "replace", signalled)
    # Who runs the tests in the background has Ctrl+C ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt), replacing_all(tmp_path) as staging:
            write_both(staging)
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)
    assert contents(tmp_path) == {"a.txt": "new", "b.txt": "new"}
