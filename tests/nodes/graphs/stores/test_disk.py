"""The disk store: shared, bounded, and right whatever happens to its files."""

import os
import random
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import spheremesh as sm
from spheremesh.nodes import GraphError, NodeWarning, ReadPath, WritePath, node, warn
from spheremesh.nodes.graphs.stores import disk
from spheremesh.nodes.graphs.stores.disk import DiskStore, user_cache_folder
from spheremesh.nodes.graphs.stores.entries import Entry

calls = Counter[str]()


def ramp(n: int) -> NDArray[np.float64]:
    calls["ramp"] += 1
    if n > 10_000:
        warn(f"{n} is large")
    return np.arange(float(n))


def mean(values: NDArray[np.float64]) -> float:
    calls["mean"] += 1
    return float(values.mean())


def opaque(n: int) -> object:
    calls["opaque"] += 1
    return iter(range(n))


def read_text(path: ReadPath) -> str:
    calls["read_text"] += 1
    return Path(path).read_text()


def write_text(text: str, path: WritePath) -> str:
    calls["write_text"] += 1
    Path(path).write_text(text)
    return str(path)


@pytest.fixture(autouse=True)
def toys() -> None:
    """Register the toys for one test."""
    calls.clear()
    for function in (ramp, mean, opaque, read_text, write_text):
        node(function)


def graph(folder: Path, n: int = 1000) -> sm.Graph:
    """A graph as another process would have it."""
    g = sm.Graph(cache=folder)
    g.add("mean", values=g.add("ramp", n=g.param("n", n)))
    return g


def files(folder: Path, room: str) -> list[Path]:
    return sorted(path for path in (folder / room).rglob("*") if path.is_file())


def test_another_process_finds_the_results(tmp_path: Path) -> None:
    assert graph(tmp_path).run("mean") == 499.5
    again = graph(tmp_path)
    assert again.run("mean") == 499.5
    assert again.run("ramp").tolist() == list(range(1000))
    assert calls == {"ramp": 1, "mean": 1}
    again.set(n=2)
    assert again.run("mean") == 0.5
    assert calls == {"ramp": 2, "mean": 2}
    assert files(tmp_path, "locks") == []


def test_messages_are_found_without_the_result(tmp_path: Path) -> None:
    with pytest.warns(NodeWarning):
        graph(tmp_path, 20_000).run("mean")
    again = graph(tmp_path, 20_000)
    again.run("mean")
    assert again.messages == {"ramp": ("20000 is large",)}
    assert calls == {"ramp": 1, "mean": 1}


def test_what_has_no_form_on_disk_stays_in_memory(tmp_path: Path) -> None:
    g = sm.Graph(cache=tmp_path)
    step = g.add("opaque", n=3)
    assert g.run(step) is g.run(step)
    again = sm.Graph(cache=tmp_path)
    again.run(again.add("opaque", n=3))
    assert calls == {"opaque": 2}


def test_files_are_known_by_content(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("one")
    os.utime(path, ns=(5, 5))

    def text() -> str:
        g = sm.Graph(cache=tmp_path / "cache")
        return g.run(g.add("read_text", path=path))

    assert text() == "one"
    os.utime(path, ns=(7, 7))
    assert text() == "one"
    assert calls == {"read_text": 1}
    path.write_text("two")
    os.utime(path, ns=(7, 7))
    assert text() == "two", "same size, same time"


def test_a_writer_is_not_asked_while_its_file_is_as_it_left_it(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"

    def write(text: str) -> None:
        g = sm.Graph(cache=tmp_path / "cache")
        g.run(g.add("write_text", text=text, path=path))

    for text, count in (("a", 1), ("a", 1), ("b", 2), ("a", 3), ("a", 3)):
        write(text)
        assert path.read_text() == text
        assert calls["write_text"] == count
    path.unlink()
    write("a")
    assert path.read_text() == "a"


def test_another_version_of_a_node_has_other_results(tmp_path: Path) -> None:
    graph(tmp_path).run("mean")
    node(version="2")(ramp)
    graph(tmp_path).run("mean")
    assert calls == {"ramp": 2, "mean": 2}


@pytest.mark.parametrize("room", ["entries", "blocks"])
@pytest.mark.parametrize("damage", ["empty", "cut", "flipped", "text", "folder"])
def test_what_is_damaged_is_made_again(tmp_path: Path, room: str, damage: str) -> None:
    graph(tmp_path).run("ramp")
    for path in files(tmp_path, room):
        data = path.read_bytes()
        path.unlink()
        if damage == "folder":
            path.mkdir()
            continue
        middle = len(data) // 2
        changed = bytes([data[middle] ^ 1])
        path.write_bytes({
            "empty": b"",
            "cut": data[:middle],
            "flipped": data[:middle] + changed + data[middle + 1 :],
            "text": b"spheremesh result 1 \n{}",
        }[damage])  # fmt: skip
    assert graph(tmp_path).run("ramp").tolist() == list(range(1000))
    assert calls["ramp"] == 2
    assert graph(tmp_path).run("ramp").tolist() == list(range(1000))
    assert calls["ramp"] == (3 if damage == "folder" else 2), "and mended"


def test_the_folder_stays_within_its_bound(tmp_path: Path) -> None:
    store = DiskStore(tmp_path, most_bytes=100_000)
    for number in range(100):
        key = number.to_bytes(16, "big")
        store.put(key, Entry(np.full(1000, float(number))))
        past = time.time() - 1000 + number
        for path in (store._entry_path(key), *files(tmp_path, "blocks")[:0]):
            os.utime(path, (past, past))
        total = sum(path.stat().st_size for path in tmp_path.rglob("*") if path.is_file())
        assert total <= 110_000
    fresh = DiskStore(tmp_path, most_bytes=100_000)
    found = [fresh.get(number.to_bytes(16, "big")) for number in range(100)]
    assert found[99] is not None
    assert found[0] is None
    for number, entry in enumerate(found):
        assert entry is None or entry.value.tolist() == [number] * 1000


def test_what_killed_processes_leave_is_removed(tmp_path: Path) -> None:
    store = DiskStore(tmp_path)
    left = tmp_path / "entries" / f"{disk._UNFINISHED}abc"
    young = tmp_path / "entries" / f"{disk._UNFINISHED}def"
    for path in (left, young):
        path.write_bytes(b"half")
    os.utime(left, (0, 0))
    store.put(b"k" * 16, Entry(1))
    assert not left.exists()
    assert young.exists()


def test_a_folder_that_cannot_be_is_told(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text("")
    with pytest.raises(GraphError, match=r"cannot keep results in .*file: .*; choose another"):
        sm.Graph(cache=path)


def test_a_folder_that_goes_away_costs_nothing_but_time(tmp_path: Path) -> None:
    g = graph(tmp_path / "cache")
    g.run("mean")
    for path in sorted((tmp_path / "cache").rglob("*"), reverse=True):
        path.rmdir() if path.is_dir() else path.unlink()
    (tmp_path / "cache").rmdir()
    (tmp_path / "cache").write_text("")
    g.set(n=3)
    assert g.run("mean") == 1


def test_the_user_chooses_the_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SPHEREMESH_CACHE", str(tmp_path / "mine"))
    assert user_cache_folder() == tmp_path / "mine"
    monkeypatch.delenv("SPHEREMESH_CACHE")
    assert user_cache_folder().is_absolute()


def test_random_bytes_are_never_a_result(tmp_path: Path) -> None:
    store = DiskStore(tmp_path)
    key = b"k" * 16
    store.put(key, Entry({"a": [1, 2.5, np.arange(50.0)]}))
    path = store._entry_path(key)
    data = path.read_bytes()
    chance = random.Random(0)  # noqa: S311
    for _ in range(200):
        changed = bytearray(data)
        for _ in range(chance.randrange(1, 4)):
            changed[chance.randrange(len(data))] = chance.randrange(256)
        path.write_bytes(changed)
        found = DiskStore(tmp_path).get(key)
        assert found is None or bytes(changed) == data
