"""Sweeps in many processes: equal to serial ones, and nothing is lost."""

import csv
import importlib
import multiprocessing
import sys
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import spheremesh as sm
from spheremesh.nodes import GraphError, NodeWarning
from spheremesh.nodes.graphs.sweeps.rows import Row, Sweep

N, T = [3, 30, 300], [0.05, 0.1, 0.15, 0.2]


@pytest.fixture(autouse=True)
def _nodes(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[None]:
    folder = str(Path(__file__).parent)
    monkeypatch.syspath_prepend(folder)
    monkeypatch.setenv("PYTHONPATH", folder)
    monkeypatch.setenv("STUDY_CALLS", str(tmp_path))
    importlib.import_module("study_nodes")
    yield
    sys.modules.pop("study_nodes")


def study(**sliders: float) -> sm.Graph:
    g = sm.Graph("study")
    n, t = g.param("n", 10, min=1), g.param("t", 0.1)
    base = g.add("study_base", n=n)
    measured = g.add("study_measure", base=base, t=t)
    g.add("study_write", values=measured.values, path="numbers.txt")
    g.set(**sliders)
    return g


def calls(folder: Path) -> Counter[str]:
    path = folder / "calls"
    found = Counter(path.read_text().splitlines()) if path.exists() else Counter[str]()
    path.unlink(missing_ok=True)
    return found


def check_files(found: Sweep, out: Path) -> None:
    texts = [(Path(row.folder) / "numbers.txt").read_text() for row in found]
    assert len(set(texts)) == len({row.folder for row in found}) == len(found)
    for row, text in zip(found, texts, strict=True):
        wanted = np.sqrt(np.arange(1.0, row.point["n"] + 1)) * row.point["t"]
        assert text == " ".join(map(str, wanted))
        assert Path(row.folder).parent == out


def same(one: Sweep, other: Sweep) -> bool:
    return all(
        a.point == b.point
        and a.error == b.error
        and a.warnings == b.warnings
        and a.value[0] == b.value[0]
        and np.array_equal(a.value[1], b.value[1])
        for a, b in zip(one, other, strict=True)
    )


TARGETS = ("study_measure.report", "study_measure.values", "study_write")


def test_processes_equal_one_and_share_what_they_have_in_common(tmp_path: Path) -> None:
    serial = sm.sweep(study(), *TARGETS, n=N, t=T)
    assert calls(tmp_path).total() == 3 + 12 + 12
    Path("numbers.txt").unlink()
    options: dict[str, Any] = {"write_to": tmp_path / "out", "cache": tmp_path / "cache"}
    found = sm.sweep(study(), *TARGETS, workers=2, n=N, t=T, **options)
    assert same(found, serial)
    check_files(found, tmp_path / "out")
    counts = calls(tmp_path)
    assert counts.total() == 3 + 12 + 12, counts
    again = sm.sweep(study(), *TARGETS, workers=2, n=N, t=T, **options)
    assert same(again, serial)
    assert calls(tmp_path).total() == 0, "all is known, the files as well"
    (Path(found[3].folder) / "numbers.txt").write_text("somebody else's")
    check_files(sm.sweep(study(), *TARGETS, n=N, t=[*T, 0.25], **options), tmp_path / "out")
    counts = calls(tmp_path)
    assert counts.total() == 1 + 3 + 3, "a file that was changed, and one more value"


def test_failures_stand_beside_successes(tmp_path: Path) -> None:
    with pytest.warns(NodeWarning, match="3 of 15 points failed; at n = 3, t = -1: "):
        found = sm.sweep(
            study(), "study_measure.report", n=N, t=[*T, -1], write_to=tmp_path / "out"
        )
    assert len(found) == 15
    assert [row.point["t"] for row in found.failures] == [-1, -1, -1]
    assert found[4].error == "step 'study_measure' failed: t must not be negative"
    record = (tmp_path / "out" / "n=3_t=-1" / "point.json").read_text()
    assert "must not be negative" in record


def test_a_killed_process_costs_its_own_point_alone(tmp_path: Path) -> None:
    g = sm.Graph()
    g.add("study_die", t=g.param("t", 0.0), folder=str(tmp_path))
    with pytest.warns(NodeWarning, match="1 of 6 points failed; at t = 0.3: the process that"):
        found = sm.sweep(g, "study_die", workers=2, t=[0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    assert [row.value for row in found] == [0.1, 0.2, None, 0.4, 0.5, 0.6]


def test_a_pool_that_breaks_is_replaced(tmp_path: Path) -> None:
    g = sm.Graph()
    g.add("study_die", t=g.param("t", 0.0), folder=str(tmp_path))
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=context) as pool:
        found = sm.sweep(g, "study_die", executor=pool, t=[0.1, 0.2, 0.4])
    assert [row.value for row in found] == [0.1, 0.2, 0.4]


def test_threads_and_rows_as_they_are_done(tmp_path: Path) -> None:
    seen: list[tuple[Row, int, int]] = []
    with ThreadPoolExecutor(4) as executor:
        found = sm.sweep(
            study(), "study_measure.report", executor=executor, n=N, t=T,
            on_row=lambda *row: seen.append(row),
        )  # fmt: skip
    assert [done for _, done, _ in seen] == list(range(1, 13))
    assert {total for _, _, total in seen} == {12}
    assert sorted(row.value["sum"] for row in found) == sorted(r.value["sum"] for r, *_ in seen)
    assert [row.point for row in found] == [{"n": n, "t": t} for n in N for t in T]
    assert calls(tmp_path)["base 300"] == 1


def test_relative_paths_stay_in_their_folders(tmp_path: Path) -> None:
    g = study()
    g.rewire("study_write", path="../numbers.txt")
    with pytest.warns(NodeWarning, match="1 of 1 points failed"):
        found = sm.sweep(g, "study_write", write_to=tmp_path / "out", n=[3])
    assert "outside of the folder" in found[0].error
    assert not (tmp_path / "out" / "numbers.txt").exists()


def test_the_table(tmp_path: Path) -> None:
    with pytest.warns(NodeWarning, match="1 of 4 points failed"):
        found = sm.sweep(study(), *TARGETS[:2], n=[2], t=[0.1, 0.2, 0.4, -1])
    records = found.table()
    assert records[0]["study_measure.report.t"] == 0.1
    assert records[0]["study_measure.values"].startswith("0.1 0.1414")
    assert records[2]["warnings"] == "0.4 is thick"
    assert records[3]["error"] == "step 'study_measure' failed: t must not be negative"
    assert list(found.table(["report.sum"])[0]) == [
        "n", "t", "study_measure.report.sum", "steps_run", "seconds", "warnings", "error",
        "folder",
    ]  # fmt: skip
    with pytest.raises(GraphError, match="no result has a field 'summ'; there are study_mea"):
        found.table(["summ"])
    found.save(tmp_path / "a.csv")
    with (tmp_path / "a.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["t"] for row in rows] == ["0.1", "0.2", "0.4", "-1"]
    assert rows[3]["study_measure.report.sum"] == ""
    with pytest.raises(ValueError, match=r"end the name in \.csv or \.parquet"):
        found.save(tmp_path / "a.xls")


def test_data_frames(tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    found = sm.sweep(study(), TARGETS[0], n=[2], t=T)
    frame = found.to_pandas()
    assert list(frame["t"]) == T
    pytest.importorskip("pyarrow")
    found.save(tmp_path / "a.parquet")
    assert list(pandas.read_parquet(tmp_path / "a.parquet")["t"]) == T


def test_without_pandas_it_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(GraphError, match="pip install pandas"):
        Sweep([], ["a"]).to_pandas()


def test_who_runs_it_must_be_clear() -> None:
    g = study()
    with pytest.raises(GraphError, match="workers = 0: must be at least 1"):
        sm.sweep(g, TARGETS[0], workers=0, n=[1])
    with ThreadPoolExecutor(1) as pool, pytest.raises(GraphError, match="not both"):
        sm.sweep(g, TARGETS[0], workers=1, executor=pool, n=[1])
    with pytest.raises(GraphError, match="sweep needs a target"):
        sm.sweep(g, n=[1])


@pytest.mark.filterwarnings("ignore")
def test_a_cluster_equals_one_process(tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    n, t = [3, 30, 300], [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, -1]
    serial = sm.sweep(study(), *TARGETS, n=n, t=t)
    Path("numbers.txt").unlink()
    calls(tmp_path)
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        options: dict[str, Any] = {"write_to": tmp_path / "out", "cache": tmp_path / "cache"}
        found = sm.sweep(study(), *TARGETS, executor=client, n=n, t=t, **options)
        counts = calls(tmp_path)
        again = sm.sweep(study(), *TARGETS, executor=client, n=n, t=t, **options)
        counts_again = calls(tmp_path)
    assert [row.error for row in found] == [row.error for row in serial]
    assert len(found.failures) == 3
    good = Sweep([row for row in found if not row.error], TARGETS)
    assert same(good, Sweep([row for row in serial if not row.error], TARGETS))
    check_files(good, tmp_path / "out")
    assert {text for text, count in counts.items() if count > 1} <= {
        f"measure {size} -1" for size in n
    }
    assert counts.total() == 3 + 24 + 21
    assert set(counts_again) == {f"measure {size} -1" for size in n}, "only what failed"
    assert [row.error for row in again] == [row.error for row in found]
