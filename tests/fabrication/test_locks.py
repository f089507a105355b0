"""One process at a time, also where the file system knows no locks."""

import errno
from pathlib import Path

import pytest

from spheremesh.fabrication import locks
from spheremesh.fabrication.locks import locked_file


class StopWaitingError(Exception):
    """Raised by a check."""


def stop() -> None:
    raise StopWaitingError


def test_who_waits_can_give_up(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    with (
        locked_file(path, stop),
        pytest.raises(StopWaitingError),
        locked_file(path, stop),
    ):
        pass
    assert not path.exists()
    with locked_file(path, stop):
        assert path.exists()


def test_a_file_system_without_locks_stops_nobody(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_: int) -> None:
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(locks, "_lock", refuse)
    with locked_file(tmp_path / "lock", stop):
        assert (tmp_path / "lock").exists()
    assert not list(tmp_path.iterdir())
