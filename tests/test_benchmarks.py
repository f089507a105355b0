"""The benchmark tables: peers get right derivatives, the page is what was measured."""

import importlib
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import pytest

from spheremesh.nodes import roof_mesh

Tables: TypeAlias = Callable[[str], Any]
BENCHMARKS = Path(__file__).parents[1] / "benchmarks"


@pytest.fixture
def tables(monkeypatch: pytest.MonkeyPatch) -> Iterator[Tables]:
    """Imports a module of the tables as their command does."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    monkeypatch.syspath_prepend(str(BENCHMARKS / "tables"))
    before = set(sys.modules)
    yield importlib.import_module
    for name in set(sys.modules) - before:
        if not name.startswith(("spheremesh", "numpy", "scipy")):
            del sys.modules[name]


@pytest.mark.parametrize("kind", ["angles", "energy"])
def test_peers_get_the_derivatives_of_what_they_minimise(tables: Tables, kind: str) -> None:
    solvers = tables("solvers")
    problem = (
        solvers.angle_sum(roof_mesh(3, 4)) if kind == "angles" else solvers.energy_sum(3)[0]
    )
    rng = np.random.default_rng(0)
    x = problem.start * (1 + 0.01 * rng.standard_normal(len(problem.start)))
    step = 1e-6 * rng.standard_normal(len(x))
    change = problem.residuals(x + step) - problem.residuals(x - step)
    slope = 2 * problem.jacobian(x) @ step
    assert np.abs(change - slope).max() < 1e-4 * np.abs(slope).max()
    if problem.local is not None:
        for row, share in enumerate(problem.local):
            values, columns = share.evaluate(*x[list(share.unknowns)])
            assert values[0] == pytest.approx(problem.residuals(x)[row], abs=1e-12)
            table = problem.jacobian(x)[[row]].toarray()[0, list(share.unknowns)]
            assert np.ravel(columns) == pytest.approx(table, abs=1e-12)


def test_a_peer_reaches_our_energy(tables: Tables) -> None:
    solvers, peers = tables("solvers"), tables("peers")
    _, energy, _ = solvers.our_energy(5)
    name = "Levenberg-Marquardt with a factorisation"
    found = peers.reach(name, solvers.energy_sum(5)[0], energy, 20.0)
    assert found.energy == pytest.approx(energy, rel=2e-6)


def test_the_page_is_what_was_measured(tables: Tables) -> None:
    run = tables("run")
    assert run.PAGE.read_text(encoding="utf-8") == run.page()
