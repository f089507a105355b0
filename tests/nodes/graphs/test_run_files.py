"""Files of a run: read again when they change, written again when they are gone."""

import os
from collections import Counter
from pathlib import Path
from typing import NamedTuple

import pytest

import spheremesh as sm
from spheremesh.fabrication.output_folder import output_folder
from spheremesh.kernel.errors import InputError
from spheremesh.nodes import (
    GraphError,
    NodeError,
    NodeWarning,
    ReadPath,
    WritePath,
    node,
    warn,
)

calls = Counter[str]()


def add(a: float, b: float = 0.0) -> float:
    calls["add"] += 1
    return a + b


def write_number(value: float, path: WritePath) -> str:
    calls["write_number"] += 1
    Path(path).write_text(f"{value:8.3f}")
    os.utime(path, ns=(0, 0))  # as if the clock stood still
    return os.fspath(path)


def read_number(path: ReadPath) -> float:
    calls["read_number"] += 1
    return float(Path(path).read_text())


def tell_path(folder: str) -> str:
    return f"{folder}/2"


def length(text: str) -> int:
    calls["length"] += 1
    return len(text)


TOYS = (
    add,
    write_number,
    read_number,
    length,
    tell_path,
)


@pytest.fixture(autouse=True)
def toys() -> None:
    """Register the toys for one test."""
    calls.clear()
    for function in TOYS:
        node(function)


# files


def test_a_reader_runs_again_when_its_file_has_changed(tmp_path: Path) -> None:
    path = tmp_path / "number.txt"
    path.write_text("1")
    os.utime(path, ns=(0, 0))
    g = sm.Graph()
    step = g.add("read_number", path=path)
    assert (g.run(step), g.run(step)) == (1, 1)
    assert calls == {"read_number": 1}
    path.write_text("2")
    os.utime(path, ns=(0, 1))
    assert g.run(step) == 2
    path.write_text("33")
    os.utime(path, ns=(0, 1))
    assert g.run(step) == 33, "the size tells too"


def test_a_missing_file_is_asked_for_again(tmp_path: Path) -> None:
    path = tmp_path / "number.txt"
    g = sm.Graph()
    step = g.add("read_number", path=path)
    with pytest.raises(NodeError, match=r"number\.txt"):
        g.run(step)
    path.write_text("1")
    assert g.run(step) == 1


def test_a_writer_runs_again_when_its_file_is_gone_or_changed(tmp_path: Path) -> None:
    path = tmp_path / "out.txt"
    g = sm.Graph()
    step = g.add("write_number", value=1, path=path)
    g.run(step)
    g.run(step)
    assert calls == {"write_number": 1}
    path.unlink()
    g.run(step)
    assert path.read_text() == "   1.000"
    assert calls == {"write_number": 2}
    os.utime(path, ns=(0, 1))
    g.run(step)
    assert calls == {"write_number": 3}


def test_a_writer_goes_back_to_an_old_value(tmp_path: Path) -> None:
    path = tmp_path / "out.txt"
    g = sm.Graph()
    k = g.param("k", 1)
    step = g.add("write_number", value=k, path=path)
    for value in (1, 2, 1, 1):
        g.set(k=value)
        g.run(step)
        assert float(path.read_text()) == value


def test_a_writer_before_a_cached_target_restores_its_file(tmp_path: Path) -> None:
    path = tmp_path / "out.txt"
    g = sm.Graph()
    written = g.add("write_number", value=7, path=path)
    again = g.add("add", a=g.add("read_number", path=written))
    assert g.run(again) == 7
    path.unlink()
    assert g.run(again) == 7
    assert path.exists()
    assert calls["write_number"] == 2
    path.write_text("somebody else's")
    assert g.run(again) == 7


def test_a_writer_before_a_step_that_does_not_read_restores_its_file_too(
    tmp_path: Path,
) -> None:
    path = tmp_path / "out.txt"
    g = sm.Graph()
    length = g.add("length", text=g.add("write_number", value=7, path=path))
    g.run(length)
    path.unlink()
    g.run(length)
    assert path.exists()
    assert calls == {"write_number": 2, "length": 1}


def test_a_writer_that_has_not_written_runs_again(tmp_path: Path) -> None:
    @node
    def forget(path: WritePath) -> str:
        calls["forget"] += 1
        return str(path)

    g = sm.Graph()
    step = g.add(forget, path=tmp_path / "out.txt")
    g.run(step)
    g.run(step)
    assert calls["forget"] == 2


def test_relative_paths_are_written_to_a_folder(tmp_path: Path) -> None:
    g = sm.Graph()
    written = g.add("write_number", value=g.param("k", 7), path="out.txt")
    again = g.add("add", a=g.add("read_number", path=written))
    here = Path.cwd()
    for folder, value in (("first", 7), ("second", 8), ("first", 7)):
        (tmp_path / folder).mkdir(exist_ok=True)
        g.set(k=value)
        assert g.run(written, again, write_to=tmp_path / folder) == ("out.txt", value)
        assert [path.name for path in (tmp_path / folder).iterdir()] == ["out.txt"]
    assert float((tmp_path / "second" / "out.txt").read_text()) == 8
    assert Path.cwd() == here
    assert not Path("out.txt").exists()
    assert calls["write_number"] == 2
    (tmp_path / "first" / "out.txt").unlink()
    g.run(again, write_to=tmp_path / "first")
    assert calls["write_number"] == 3


def test_files_are_read_from_a_folder_and_absolute_ones_from_where_they_are(
    tmp_path: Path,
) -> None:
    for folder in ("in", "out"):
        (tmp_path / folder).mkdir()
    (tmp_path / "in" / "a.txt").write_text("1")
    (tmp_path / "b.txt").write_text("2")
    g = sm.Graph()
    a = g.add("read_number", path="a.txt")
    b = g.add("read_number", path=tmp_path / "b.txt")
    written = g.add("write_number", value=3, path=str(tmp_path / "out" / "c.txt"))
    c = g.add("read_number", path=written)
    folders = {"read_from": tmp_path / "in", "write_to": tmp_path}
    assert g.run(a, b, c, **folders) == (1, 2, 3)
    assert g.run(written, **folders) == str(tmp_path / "out" / "c.txt")


def test_a_file_that_was_written_is_read_there_whatever_else_is_read_from(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in").mkdir()
    g = sm.Graph()
    c = g.add("read_number", path=g.add("write_number", value=3, path="c.txt"))
    assert g.run(c, read_from=tmp_path / "in") == 3


def test_all_paths_that_a_writer_returns_are_as_given(tmp_path: Path) -> None:
    class Files(NamedTuple):
        first: Path
        others: list[str]

    @node
    def write_some(paths: list[str], path: WritePath) -> Files:
        warn(f"wrote {path}")
        Path(path).write_text("")
        return Files(Path(path), [str(path), *paths])

    g = sm.Graph()
    step = g.add(write_some, paths=["a"], path="sub/x.txt")
    (tmp_path / "sub").mkdir()
    with pytest.warns(NodeWarning):
        assert g.run(step, write_to=tmp_path) == (Path("sub/x.txt"), ["sub/x.txt", "a"])
    assert g.messages == {"write_some": (f"wrote {Path('sub/x.txt')}",)}
    mapped = g.add("write_number", value=sm.each([1, 2]), path=sm.each(["a.txt", "b.txt"]))
    assert g.run(mapped, write_to=tmp_path) == ["a.txt", "b.txt"]
    assert (tmp_path / "b.txt").exists()


def test_a_failure_names_the_path_as_given(tmp_path: Path) -> None:
    @node
    def refuse(path: WritePath) -> str:
        raise ValueError(f"cannot write {path}")

    g = sm.Graph()
    with pytest.raises(NodeError, match=r"failed: cannot write out\.txt$") as error:
        g.run(g.add(refuse, path="out.txt"), write_to=tmp_path)
    assert error.value.reason == "cannot write out.txt"


def test_no_step_writes_over_what_another_reads(tmp_path: Path) -> None:
    source = tmp_path / "in.txt"
    source.write_text("2")
    (tmp_path / "hard.txt").hardlink_to(source)
    (tmp_path / "soft.txt").symlink_to(source)
    (tmp_path / "below").mkdir()
    for name in ("in.txt", "hard.txt", "soft.txt", "below/../in.txt", str(source)):
        g = sm.Graph()
        path = g.param("path", name)
        writer = g.add(write_number, "w", value=1.0, path=path)
        reader = g.add(read_number, "r", path="in.txt")
        with pytest.raises(GraphError, match=r"w\.path would write over .*, which r\.path rea"):
            g.run(writer, reader, read_from=tmp_path, write_to=tmp_path)
        assert source.read_text() == "2"
        assert g.run(reader, read_from=tmp_path) == 2.0, "who does not write may read"
    (tmp_path / "out").mkdir()
    g.set(path="in.txt")
    g.run(writer, reader, read_from=tmp_path, write_to=tmp_path / "out")


def test_a_path_that_comes_by_wire_is_no_way_around(tmp_path: Path) -> None:
    source = tmp_path / "2"
    source.write_text("2")
    g = sm.Graph()
    path = g.add(tell_path, folder=str(tmp_path))
    g.add(write_number, "w", value=1.0, path=path)
    g.add(read_number, "r", path=str(source))
    with pytest.raises(GraphError, match=r"w\.path would write over .*, which r\.path reads"):
        g.run("w", "r")
    out = tmp_path / "out"
    with pytest.raises(InputError, match="outside"), output_folder(out) as output:
        g.run("w", write_to=output)
    assert source.read_text() == "2"


def test_an_output_folder_is_written_to_and_read_from(tmp_path: Path) -> None:
    g = sm.Graph()
    written = g.add(write_number, "w", value=1.0, path="a.txt")
    again = g.add(read_number, "r", path=written)
    for value in (1.0, 2.0):
        with output_folder(tmp_path) as output:
            assert g.run(written, again, write_to=output) == ("a.txt", 1.0), value
    (tmp_path / "a.txt").write_text("mine")
    calls.clear()
    with (
        pytest.raises(InputError, match=r"a\.txt: it was changed"),
        output_folder(tmp_path) as output,
    ):
        g.run("r", write_to=output)
    assert not calls, "that is known before anything is run"
    with output_folder(tmp_path, overwrite=True) as output:
        g.run("r", write_to=output)


def test_a_file_that_can_be_none_is_refused_in_one_line() -> None:
    g = sm.Graph()
    g.add(read_number, "r", path="a\0b")
    with pytest.raises(NodeError, match="null"):
        g.run("r")
