"""Clusters of Dask whose workers die: nothing waits for what is lost, workers come back."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from spheremesh.nodes.graphs.sweeps import workers
from spheremesh.nodes.graphs.sweeps.tasks import Outcome, Study


class ClusterFuture:
    """A future of Dask; its states come one after the other as it is looked at."""

    def __init__(self, value: Any, *states: str) -> None:  # noqa: ANN401
        self.value, self.states = value, list(states)

    @property
    def status(self) -> str:
        """What is known of it now."""
        return self.states.pop(0) if len(self.states) > 1 else self.states[0]

    def done(self) -> bool:
        """It was announced, whatever came after."""
        return True

    def result(self, timeout: float) -> Any:  # noqa: ANN401, ARG002
        """What it was made with."""
        return self.value

    def exception(self, timeout: float) -> Exception:
        """Nobody should ask."""
        raise AssertionError(f"waits {timeout} s for what is lost")

    def cancel(self) -> None:
        """Nothing more will come."""
        self.states = ["cancelled"]


class DaskCluster:
    """A cluster that has given up a worker, and starts it when it is scaled."""

    def __init__(self) -> None:
        self.worker_spec, self.workers = {0: {}, 1: {}}, {0: {}}

    def scale(self, count: int) -> None:
        """Start what is missing."""
        self.workers = dict.fromkeys(range(count))


def client_of(cluster: object, *futures: ClusterFuture) -> Any:  # noqa: ANN401
    left = list(futures)

    def submit(function: Callable[..., Any], *args: object, pure: bool) -> object:
        del args, pure
        return left.pop(0) if function is workers.run_task else None

    return SimpleNamespace(
        submit=submit, cluster=cluster, scheduler_info=lambda: {"workers": {"a": {}}}
    )


def outcomes(client: Any, count: int, monkeypatch: pytest.MonkeyPatch) -> list[Any]:  # noqa: ANN401
    library = SimpleNamespace(wait=lambda *_args, **_options: None)
    monkeypatch.setattr(workers, "import_module", lambda _name: library)
    tasks: list[workers.Task] = [(i, {}, "") for i in range(count)]
    found = dict(workers.on_dask(client, Study("", (), (), ""), tasks))
    return [found[i].value for i in range(count)]


def test_what_is_lost_is_not_waited_for_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    lost = [ClusterFuture(Outcome(i), "lost", "pending", "finished") for i in range(3)]
    assert outcomes(client_of(None, *lost), 3, monkeypatch) == [0, 1, 2]


def test_a_worker_that_was_given_up_is_asked_for_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    cluster = DaskCluster()
    future = ClusterFuture(Outcome(1), "pending", "finished")
    assert outcomes(client_of(cluster, future), 1, monkeypatch) == [1]
    assert set(cluster.workers) == {0, 1}
