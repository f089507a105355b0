"""Folders of jobs: what spheremesh wrote is replaced, what the user wrote or changed is not."""

import json
import os
from pathlib import Path

import pytest

from spheremesh.fabrication.output_folder import RECORD, REPORT, output_folder
from spheremesh.kernel.errors import InputError


def write(folder: Path, *names: str, text: str = "new", **options: bool) -> None:
    with output_folder(folder, **options) as output:
        for name in names:
            output.check(name)
            output.place(name).write_text(text)


def panel(folder: Path, *names: str, text: str = "new") -> None:
    """A job with a report."""
    with output_folder(folder) as output:
        for name in (*names, REPORT):
            output.check(name)
        for name in names:
            output.place(name).write_text(text)
        output.write_report({"text": text, "number": 0.1})


def test_what_was_written_is_replaced_and_what_was_changed_is_not(tmp_path: Path) -> None:
    write(tmp_path, "a.txt")
    write(tmp_path, "a.txt", "b.txt", text="newer")
    assert {p.name for p in tmp_path.iterdir()} == {"a.txt", "b.txt", RECORD}
    (tmp_path / "a.txt").write_text("edited")
    with pytest.raises(InputError, match=r"a\.txt: it was changed after spheremesh wrote it"):
        write(tmp_path, "b.txt", "a.txt")
    assert (tmp_path / "b.txt").read_text() == "newer"
    write(tmp_path, "a.txt", overwrite=True)
    write(tmp_path, "a.txt", text="again")


def test_a_file_of_the_user_stays(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("mine")
    with pytest.raises(InputError, match=r"a\.txt: there is a file that spheremesh did not"):
        write(tmp_path, "a.txt")
    with (
        pytest.raises(InputError, match=r"a\.txt: there is a file"),
        output_folder(tmp_path) as output,
    ):
        (output.staging / "a.txt").write_text("not asked before")
    assert (tmp_path / "a.txt").read_text() == "mine"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_jobs_with_a_report_need_no_other_file(tmp_path: Path) -> None:
    panel(tmp_path, "a.txt", "b.txt")
    assert {p.name for p in tmp_path.iterdir()} == {"a.txt", "b.txt", REPORT}
    panel(tmp_path, "a.txt", text="newer")  # b.txt is of an earlier job: it is remembered
    panel(tmp_path, "a.txt", "b.txt", text="newest")
    write(tmp_path, "b.txt", text="of a target")
    panel(tmp_path, "a.txt", "b.txt", text="last")
    report = json.loads((tmp_path / REPORT).read_text())
    assert set(report["files"]) == {"a.txt", "b.txt", REPORT}
    text = (tmp_path / REPORT).read_text()
    (tmp_path / REPORT).write_text(text.replace("0.1", "0.2"))
    with pytest.raises(InputError, match=r"report\.json: there is a file that spheremesh did"):
        panel(tmp_path, "a.txt")


@pytest.mark.parametrize(
    "text", ["", "[]", "{", '{"files": 3}', '{"files": {"a": NaN}}', "\xff", "[" * 9999]
)
def test_a_report_of_something_else_is_the_users(tmp_path: Path, text: str) -> None:
    (tmp_path / REPORT).write_text(text, encoding="latin-1")
    with pytest.raises(InputError, match=r"report\.json: "):
        panel(tmp_path, "a.txt")
    assert (tmp_path / REPORT).read_text(encoding="latin-1") == text


@pytest.mark.parametrize("name", ["../a.txt", "below/../../a.txt", "link/a.txt", "{}/a.txt"])
def test_nothing_is_written_outside(tmp_path: Path, name: str) -> None:
    folder = tmp_path / "out"
    (folder / "below").mkdir(parents=True)
    (folder / "link").symlink_to(tmp_path, target_is_directory=True)
    name = name.format(tmp_path)
    with pytest.raises(InputError, match=r"it is outside of the folder .*--allow-outside"):
        write(folder, name)
    with pytest.raises(InputError, match="outside"), output_folder(folder) as output:
        output.place(name)
    assert not (tmp_path / "a.txt").exists()
    write(folder, name, allow_outside=True)
    write(folder, name, allow_outside=True)
    assert (tmp_path / "a.txt").read_text() == "new"


def test_names_below_and_whole_names_are_inside(tmp_path: Path) -> None:
    (tmp_path / "below").mkdir()
    write(tmp_path, "below/a.txt", str(tmp_path / "b.txt"), "below/../c.txt")
    write(tmp_path, "below/a.txt", str(tmp_path / "b.txt"), "below/../c.txt")
    assert (tmp_path / "below" / "a.txt").read_text() == "new"
    assert {p.name for p in tmp_path.iterdir()} == {"below", "b.txt", "c.txt", RECORD}
    with pytest.raises(InputError, match="there is no folder"):
        write(tmp_path, "none/a.txt")
    for name in ("", ".", "below/..", "below"):
        with pytest.raises(InputError, match="it is a folder"):
            write(tmp_path, name)
    with pytest.raises(InputError, match="spheremesh keeps it"):
        write(tmp_path, RECORD)


def test_an_input_stays_under_all_of_its_names(tmp_path: Path) -> None:
    source = tmp_path / "roof.json"
    source.write_text("mine")
    out = tmp_path / "out"
    out.mkdir()
    (out / "hard.json").hardlink_to(source)
    (out / "soft.json").symlink_to(source)
    for name in ("hard.json", "soft.json"):
        with (
            pytest.raises(InputError, match="it is what the job is made from"),
            output_folder(out, inputs=(source,)) as output,
        ):
            output.check(name)
    with output_folder(out, inputs=(source,), renewed="hard.json") as output:
        output.check("hard.json")
    assert source.read_text() == "mine"
    write(out, "soft.json", overwrite=True)
    assert source.read_text() == "mine", "the link is replaced, not what it leads to"
    assert not (out / "soft.json").is_symlink()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no pipes")
def test_a_pipe_is_no_file_of_ours(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / REPORT)
    os.mkfifo(tmp_path / "a.txt")
    with pytest.raises(InputError, match="spheremesh did not write"):
        write(tmp_path, "a.txt")
