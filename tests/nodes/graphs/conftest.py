import sys
from collections.abc import Iterator

import pytest

from spheremesh.nodes import node
from spheremesh.nodes.graphs.node import REGISTRY


@pytest.fixture(autouse=True)
def own_registry(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Toy nodes of a test meet no others, and do not stay."""
    before = dict(REGISTRY)
    REGISTRY.clear()
    # by sys.modules: as an attribute, spheremesh.nodes.graphs.node is the decorator
    monkeypatch.setattr(sys.modules[node.__module__], "load_library", lambda: None)
    yield
    REGISTRY.clear()
    REGISTRY.update(before)
