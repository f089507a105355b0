from collections.abc import Iterator

import pytest

from spheremesh.nodes.node import REGISTRY


@pytest.fixture(autouse=True)
def own_registry() -> Iterator[None]:
    """Toy nodes of a test do not stay."""
    before = dict(REGISTRY)
    yield
    REGISTRY.clear()
    REGISTRY.update(before)
