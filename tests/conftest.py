import os
import signal
from collections.abc import Generator

import pytest

# No test finds what another one, or a run of the user, has kept.
os.environ["SPHEREMESH_CACHE"] = "off"


@pytest.fixture(autouse=True)
def interruptible() -> Generator[None]:
    """No test, and no library that it calls, leaves another handler of Ctrl+C."""
    before = signal.getsignal(signal.SIGINT)
    yield
    after = signal.getsignal(signal.SIGINT)
    signal.signal(signal.SIGINT, before)
    assert after is before
