"""Long nodes of the library tell how far they are, and can be called off."""

import threading

import pytest

import spheremesh as sm
from spheremesh.nodes import Event, RunCancelledError, node


@pytest.fixture(autouse=True)
def _library(own_registry: None) -> None:
    del own_registry
    from spheremesh.nodes.library import input as nets
    from spheremesh.nodes.library import spheres
    from spheremesh.nodes.library.optimise import energy

    for module in (nets, energy, spheres):
        for name in ("roof_mesh", "fit_spheres", "optimize_spheres"):
            if hasattr(module, name):
                node(getattr(module, name))


def test_an_optimisation_tells_its_progress_and_ends_when_called_off() -> None:
    g = sm.Graph()
    mesh = g.add("roof_mesh", n_span=6, n_length=8)
    start = g.add("fit_spheres", mesh=mesh)
    best = g.add("optimize_spheres", sphere_mesh=start)
    cancel, shares = threading.Event(), list[float]()

    def watch(event: Event) -> None:
        if event.state == "progress":
            shares.append(event.share)
            cancel.set()

    with pytest.raises(RunCancelledError):
        g.run(best, on_event=watch, cancel=cancel)
    assert len(shares) == 1
    cancel.clear()
    g.run(start, cancel=cancel)
