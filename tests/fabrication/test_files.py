"""Whole files or none, and what killed processes leave."""

import errno
import os
import time
from pathlib import Path

import pytest

from spheremesh.fabrication.files import check_target, replacing, replacing_all
from spheremesh.kernel.errors import InputError

DAY = 86400


def leave(path: Path, age: float) -> Path:
    """Something of an age, as a killed process left it; a folder if it has no suffix."""
    if path.suffix:
        path.write_text("half")
    else:
        path.mkdir()
        (path / "model.3dm").write_text("half")
    then = time.time() - age
    os.utime(path, (then, then))
    return path


def test_what_killed_processes_left_goes_after_a_day(tmp_path: Path) -> None:
    target = tmp_path / "panels [1].step"
    old = leave(tmp_path / ".panels [1]-spheremesh-abc_12ef.step", 2 * DAY)
    kept = [
        leave(tmp_path / ".panels [1]-spheremesh-abcdefgh.step", 0.5 * DAY),
        leave(tmp_path / ".panels [1]-spheremesh-abcdefgh.stp", 2 * DAY),
        leave(tmp_path / ".panels [1]-original.step", 2 * DAY),
        leave(tmp_path / ".roof-spheremesh-abcdefgh.step", 2 * DAY),
        leave(tmp_path / ".spheremesh-abcdefgh", 2 * DAY),
    ]
    with replacing(target) as temporary:
        assert temporary.suffix == ".step"
        temporary.write_text("new")
    assert target.read_text() == "new"
    assert not old.exists()
    assert set(tmp_path.iterdir()) == {target, *kept}


def test_folders_that_killed_processes_left_go_after_a_day(tmp_path: Path) -> None:
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


def test_a_target_that_cannot_be(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="it is a folder"):
        check_target(tmp_path)
    with pytest.raises(InputError, match="no folder"):
        check_target(tmp_path / "none" / "p.step")
    check_target(tmp_path / "p.step")


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


def test_windows_syncs_only_what_is_open_for_writing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fcntl = pytest.importorskip("fcntl", reason="this may be Windows itself")
    fsync = os.fsync
    synced: list[int] = []

    def fsync_there(descriptor: int) -> None:
        if fcntl.fcntl(descriptor, fcntl.F_GETFL) & os.O_ACCMODE == os.O_RDONLY:
            raise OSError(errno.EBADF, os.strerror(errno.EBADF))
        fsync(descriptor)
        synced.append(os.fstat(descriptor).st_ino)

    monkeypatch.setattr(os, "fsync", fsync_there)
    target = tmp_path / "p.step"
    for text in ("old", "new"):
        with replacing(target) as temporary:
            temporary.write_text(text)
        assert target.read_text() == text
        assert synced.pop() == target.stat().st_ino


def test_names_that_no_file_can_have(tmp_path: Path) -> None:
    for name in ("a\0.step", "x" * 300 + ".step"):
        with (
            pytest.raises(InputError, match=r"cannot write .*check the name"),
            replacing(tmp_path / name),
        ):
            pass
    longest = tmp_path / ("ä" * 125 + ".step")
    with replacing(longest) as temporary:
        temporary.write_text("new")
    assert longest.read_text() == "new"
    assert list(tmp_path.iterdir()) == [longest]


def test_a_read_only_file_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "p.step"
    target.write_text("released")
    target.chmod(0o444)

    def access(path: Path, _: int) -> bool:
        """Nothing is read-only for an administrator, who may run this."""
        return bool(path.stat().st_mode & 0o200)

    monkeypatch.setattr(os, "access", access)
    with pytest.raises(InputError, match="it is read-only"), replacing(target):
        pass
    assert target.read_text() == "released"


@pytest.mark.parametrize("place", ["write_bytes", "replace"])
def test_a_full_disk_and_a_file_that_is_held_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: str
) -> None:
    target = tmp_path / "p.step"
    target.write_text("old")

    def fail(*_: object) -> None:
        raise PermissionError(13, "The process cannot access the file")

    monkeypatch.setattr(Path, place, fail)
    with (
        pytest.raises(InputError, match=r"cannot write .*p\.step: The process cannot access"),
        replacing(target) as temporary,
    ):
        temporary.write_bytes(b"new")
    assert [path.read_text() for path in tmp_path.iterdir()] == ["old"]


def test_a_temporary_file_that_is_held_is_no_other_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Windows neither renames nor removes what a scanner has open."""

    def fail(*_: object, **__: object) -> None:
        raise PermissionError(13, "The process cannot access the file")

    monkeypatch.setattr(Path, "replace", fail)
    monkeypatch.setattr(Path, "unlink", fail)
    with (
        pytest.raises(InputError, match=r"cannot write .*p\.step: The process cannot access"),
        replacing(tmp_path / "p.step") as temporary,
    ):
        temporary.write_bytes(b"new")
