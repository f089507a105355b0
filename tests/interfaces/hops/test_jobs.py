"""Long runs: joined by who asks again, some at once, all answered before clients give up."""

import json
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeAlias

import pytest

from spheremesh.interfaces.hops.jobs import Answer, BusyError, Jobs, StillRunningError, Watcher
from spheremesh.nodes import node, progress
from spheremesh.nodes.graphs.node import REGISTRY
from spheremesh.nodes.graphs.running.events import Event

pytestmark = pytest.mark.filterwarnings("ignore::spheremesh.nodes.NodeWarning")
Value: TypeAlias = Any


@pytest.fixture
def gate() -> Iterator[threading.Event]:
    """A node `wait_for_gate` that ends when the gate opens."""
    opened, calls = threading.Event(), []

    @node
    def wait_for_gate(number: float = 0.0) -> float:
        """A number, when the gate is open."""
        calls.append(number)
        while not opened.wait(0.01):
            progress(0.5, "waits")
        return number

    opened.calls = calls
    yield opened
    opened.set()
    del REGISTRY["wait_for_gate"]


def test_who_asks_again_joins_the_run(
    opened: Callable[..., Any], gate: Value, error_of: type[Exception]
) -> None:
    one = opened(patience=0.2)
    for _ in range(2):
        with pytest.raises(error_of, match=r"wait_for_gate: still running \(0 s, 50% of"):
            one.gh.solve("wait_for_gate", number=3.0)
        assert one.gh.status == 500
    assert not one.gh.kept
    gate.set()
    time.sleep(0.1)
    assert one.gh.solve("wait_for_gate", number=3.0) == {"number": [3.0]}
    assert one.gh.status == 200
    assert gate.calls == [3.0]


def test_64_requests_at_once_are_all_answered(served: Callable[..., Any], gate: Value) -> None:
    address, one = served()
    name, ports = "vase_mesh", ["mesh"]

    def ask(number: int) -> Value:
        sizes = [{"type": "System.Int32", "data": str(3 + number % 16)}]
        values = [{"ParamName": "n_around", "InnerTree": {f"{{{number}}}": sizes}}]
        client = type(one.gh)(one.gh.send)
        return client.ask(name, values, ports)["mesh"][0]["data"]

    with ThreadPoolExecutor(64) as pool:
        found = list(pool.map(ask, range(64)))
    assert len(set(found)) == 16
    assert all(found[i] == found[i % 16] for i in range(64))
    # While 64 wait for runs that go on, components are described.
    with ThreadPoolExecutor(64) as pool:
        waiting = [
            pool.submit(one.gh.solve, "wait_for_gate", number=float(i)) for i in range(64)
        ]
        while len(gate.calls) < 4:
            time.sleep(0.01)
        assert one.gh.describe("fit_spheres")
        assert told_to_wait(one.gh)
        assert len(gate.calls) == 4
        gate.set()
        assert sorted(each.result()["number"][0] for each in waiting) == list(range(64))
    assert address


def told_to_wait(gh: Value) -> bool:
    """Whether one of some more requests is not let in."""
    for number in range(64):
        try:
            gh.solve("wait_for_gate", number=100.0 + number)
        except Exception as error:  # noqa: BLE001 - what stands on the component
            if "too many requests wait" in str(error):
                return True
    return False


def answer(text: str) -> Answer:
    return Answer(200, text.encode())


def test_a_failure_is_told_and_forgotten() -> None:
    jobs = Jobs()
    calls: list[int] = []

    def fail(_: Watcher) -> Answer:
        calls.append(1)
        raise ValueError("no")

    for _ in range(2):
        with pytest.raises(ValueError, match="no"):
            jobs.answer(b"key", fail)
    assert len(calls) == 2
    jobs.close()


def test_a_time_out_of_the_run_itself_is_a_failure() -> None:
    jobs = Jobs()

    def fail(_: Watcher) -> Answer:
        raise TimeoutError("the disk")

    with pytest.raises(TimeoutError, match="the disk"):
        jobs.answer(b"key", fail)
    jobs.close()


def test_what_waits_its_turn_says_so_and_the_end_calls_all_off() -> None:
    jobs = Jobs(at_once=1, patience=0.05)
    ended = threading.Event()

    def run(watcher: Watcher) -> Answer:
        watcher.note(Event("step", "progress", share=0.25))
        watcher.cancel.wait(10)
        ended.set()
        return answer("over")

    with pytest.raises(StillRunningError, match="25% of step"):
        jobs.answer(b"first", run)
    with pytest.raises(StillRunningError, match="waits for others"):
        jobs.answer(b"second", lambda _: answer("never"))
    jobs.close()
    assert ended.wait(5)


def test_only_so_many_wait() -> None:
    jobs = Jobs(patience=5, most_waiting=1)
    begun, ends = threading.Event(), threading.Event()

    def run(_: Watcher) -> Answer:
        begun.set()
        ends.wait(5)
        return answer("over")

    with ThreadPoolExecutor(1) as pool:
        first = pool.submit(jobs.answer, b"first", run)
        assert begun.wait(5)
        with pytest.raises(BusyError):
            jobs.answer(b"second", run)
        ends.set()
        assert first.result() == answer("over")
    jobs.close()


def test_a_run_is_called_off_with_the_server(opened: Callable[..., Any], gate: Value) -> None:
    others = set(threading.enumerate())
    one = opened(patience=0.1)
    with pytest.raises(Exception, match="still running"):
        one.gh.solve("wait_for_gate")
    one.service.jobs.close()
    ends = time.monotonic() + 60
    while any(t.name.startswith("spheremesh") for t in set(threading.enumerate()) - others):
        assert time.monotonic() < ends
        time.sleep(0.01)
    assert not gate.is_set()
    assert json.dumps(gate.calls) == "[0.0]"
