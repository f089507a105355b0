"""The code that a result comes from: results on disk do not outlive it."""

import importlib
import sys
from pathlib import Path

import pytest

from spheremesh.nodes.graphs.node import REGISTRY
from spheremesh.nodes.graphs.stores import origins
from spheremesh.nodes.graphs.stores.origins import code_origin, library_origin

MODULE = """
from spheremesh.nodes import node

FACTOR = {factor}

@node
def scaled_by_a_user(a: float) -> float:
    return FACTOR * a
"""


def test_another_source_is_another_origin(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "origin_of_a_user.py"
    monkeypatch.syspath_prepend(tmp_path)
    found: list[str] = []
    for factor in ("2", "30", "2"):
        path.write_text(MODULE.format(factor=factor))
        importlib.invalidate_caches()
        sys.modules.pop("origin_of_a_user", None)
        REGISTRY.pop("scaled_by_a_user", None)
        origins._module_origin.cache_clear()
        module = importlib.import_module("origin_of_a_user")
        found.append(code_origin(module.scaled_by_a_user))
    assert found[0] == found[2] != found[1]
    assert library_origin() in found[0]


def test_the_library_is_known_by_versions_and_sources() -> None:
    origin = library_origin()
    assert origin.startswith("spheremesh 0.1.0 numpy ")
    from spheremesh.kernel.meshes.mesh import Mesh

    assert code_origin(Mesh.__init__) == origin


def test_what_has_no_source_has_no_origin() -> None:
    function = eval("lambda a: a")  # noqa: S307
    function.__module__ = "nowhere"
    assert code_origin(function) == ""
