"""What is told of a run, and how it is called off."""

import threading
import time
from collections import Counter

import numpy as np
import pytest
from numpy.typing import NDArray

import spheremesh as sm
from spheremesh.nodes import Event, NodeError, RunCancelledError, node, progress

calls = Counter[str]()


def ramp(n: int) -> NDArray[np.float64]:
    calls["ramp"] += 1
    return np.arange(float(n))


def patient(a: float, count: int = 4) -> float:
    calls["patient"] += 1
    for i in range(count):
        time.sleep(0.001)
        progress((i + 1) / count, f"part {i}")
    return a


def add(a: float, b: float) -> float:
    calls["add"] += 1
    return a + b


def refuse(a: float) -> float:
    raise ValueError(f"not {a}")


@pytest.fixture(autouse=True)
def toys() -> None:
    """Register the toys for one test."""
    calls.clear()
    for function in (ramp, patient, add, refuse):
        node(function)


def test_all_that_happens_is_told() -> None:
    g = sm.Graph()
    target = g.add("add", a=g.add("patient", a=1), b=2)
    events: list[Event] = []
    g.run(target, on_event=events.append)
    assert [(e.step, e.state) for e in events] == [
        ("patient", "queued"),
        ("add", "queued"),
        ("patient", "running"),
        *[("patient", "progress")] * 4,
        ("patient", "done"),
        ("add", "running"),
        ("add", "done"),
    ]
    assert [e.share for e in events if e.state == "progress"] == [0.25, 0.5, 0.75, 1]
    assert events[3].text == "part 0"
    assert events[7].seconds > 0.004
    seconds = events[7].seconds
    events.clear()
    g.run("patient", "add", on_event=events.append)
    assert {(e.step, e.state) for e in events} == {("patient", "cached"), ("add", "cached")}
    assert seconds in [e.seconds for e in events], "what it took when it was made"


def test_bytes_of_results_are_told() -> None:
    g = sm.Graph()
    events: list[Event] = []
    g.run(g.add("ramp", n=1000), on_event=events.append)
    assert 8000 <= events[-1].bytes < 8300


def test_failures_are_told() -> None:
    g = sm.Graph()
    events: list[Event] = []
    with pytest.raises(NodeError):
        g.run(g.add("refuse", a=1), on_event=events.append)
    assert [(e.state, e.text) for e in events[1:]] == [
        ("running", ""),
        ("failed", "step 'refuse' failed: not 1"),
    ]


def test_items_of_lists_are_progress() -> None:
    g = sm.Graph()
    events: list[Event] = []
    g.run(g.add("add", a=sm.each([1, 2]), b=1), on_event=events.append)
    assert [e.share for e in events if e.state == "progress"] == [0.5, 1]


def test_a_run_is_cancelled_between_steps() -> None:
    g = sm.Graph()
    first = g.add("patient", a=1)
    target = g.add("add", a=g.add("add", a=first, b=2), b=3)
    cancel, events = threading.Event(), list[tuple[str, str]]()

    def watch(event: Event) -> None:
        events.append((event.step, event.state))
        if events[-1] == ("patient", "done"):
            cancel.set()

    with pytest.raises(RunCancelledError, match="cancelled"):
        g.run(target, on_event=watch, cancel=cancel)
    assert events[-2:] == [("add", "cancelled"), ("add_2", "cancelled")]
    assert calls == {"patient": 1}
    assert g.run(target) == 6
    assert calls == {"patient": 1, "add": 2}, "what is done is kept"


def test_a_run_is_cancelled_inside_a_step() -> None:
    g = sm.Graph()
    step = g.add("patient", a=1, count=100_000)
    cancel, states = threading.Event(), list[str]()
    errors: list[BaseException] = []

    def run() -> None:
        try:
            g.run(step, cancel=cancel, on_step=lambda _, state: states.append(state))
        except RunCancelledError as error:
            errors.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    while not states:
        time.sleep(0.001)
    cancel.set()
    thread.join(5)
    assert not thread.is_alive()
    assert len(errors) == 1
    assert states == ["running", "cancelled"]


def test_a_node_that_is_interrupted_ends_the_run_and_the_next_is_right() -> None:
    interrupts = [KeyboardInterrupt, SystemExit]

    @node
    def interrupted(a: int) -> int:
        if interrupts:
            raise interrupts.pop()
        return a

    g = sm.Graph()
    target = g.add("add", a=g.add(interrupted, a=1), b=1)
    states: list[str] = []
    for kind in reversed(interrupts.copy()):
        with pytest.raises(kind):
            g.run(target, on_step=lambda step, state: states.append(f"{step} {state}"))
    assert states == 2 * ["interrupted running", "interrupted cancelled", "add cancelled"]
    assert g.run(target) == 2


def test_progress_outside_of_a_graph_says_nothing() -> None:
    assert patient(3.0) == 3.0


def test_a_graph_is_run_and_edited_by_many_threads() -> None:
    g = sm.Graph()
    k = g.param("k", 1.0)
    step = g.add("add", a=k, b=1)
    faults: list[object] = []

    def work(number: int) -> None:
        for i in range(30):
            g.set(k=float(number * 100 + i))
            g.add("add", a=k, b=float(i))
            value = g.run(step)
            if value != int(value) or not 1 <= value <= 831:
                faults.append(value)

    threads = [threading.Thread(target=work, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert faults == []
    assert len(g.steps) == 241
    assert g.run("add_100") == g.run("add_100")
