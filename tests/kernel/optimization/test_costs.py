"""What will take long is said before it begins."""

import pytest

from spheremesh.interfaces.panel.job import said_to
from spheremesh.kernel.optimization import costs
from spheremesh.nodes import fit_spheres, optimize_spheres, vase_mesh
from spheremesh.nodes.graphs.graph import Graph
from spheremesh.nodes.graphs.running.events import Event


def test_costs_grow_with_the_faces() -> None:
    few, many = (costs.expected_cost(n, moves=False) for n in (20_000, 200_000))
    assert many[0] == pytest.approx(10 * few[0])
    assert few[1] < many[1] < 10 * few[1]
    assert costs.expected_cost(20_000, moves=True)[0] > few[0]


def test_a_large_job_says_beforehand_what_it_takes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(costs, "WORTH_SAYING", 40)
    graph = Graph("large")
    spheres = graph.add(fit_spheres, mesh=graph.add(vase_mesh, n_around=8, n_across=6))
    optimum = graph.add(optimize_spheres, sphere_mesh=spheres)
    events: list[Event] = []
    graph.run(optimum, on_event=events.append)
    first = next(event for event in events if event.step == "optimize_spheres" and event.text)
    assert first.share == 0
    assert "48 faces take about 0 s and" in first.text
    told: list[tuple[str, str]] = []
    for event in events:
        said_to(lambda step, text: told.append((step, text)))(event)
    assert told == [("optimize_spheres", first.text)]


def test_small_jobs_say_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    texts: list[str] = []
    monkeypatch.setattr(costs, "tell_progress", lambda _done, _most, text: texts.append(text))
    costs.tell_cost(9_999, moves=True)
    assert not texts
    costs.tell_cost(50_000, moves=True)
    assert texts == ["50,000 faces take about 10 min and 2,150 MB"]
