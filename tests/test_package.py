"""The package as it is installed."""

import re
import subprocess
import sys
import tomllib
from importlib import metadata
from pathlib import Path

import spheremesh

ROOT = Path(__file__).parents[1]


def test_packages_are_the_folders() -> None:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    listed = settings["tool"]["setuptools"]["packages"]
    mapping = settings["tool"]["setuptools"]["package-dir"]
    tops = ("kernel", "nodes", "fabrication", "viewer", "interfaces")
    folders = {
        ".".join(("spheremesh", *path.parent.relative_to(ROOT).parts))
        for top in tops
        for path in (ROOT / top).rglob("__init__.py")
    }
    assert set(listed) == folders | {"spheremesh"}
    assert set(mapping) == set(listed)


def test_the_version_stands_in_one_place() -> None:
    assert metadata.version("spheremesh") == spheremesh.__version__
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    latest = re.search(r"^## (?!Unreleased)(\S+)", changelog, re.MULTILINE)
    assert latest is None or latest[1] == spheremesh.__version__
    assert f"\nversion: {spheremesh.__version__}\n" in citation


def test_import_leaves_heavy_libraries_alone() -> None:
    heavy = ("scipy", "igl", "OCP", "cadquery", "rhino3dm", "PIL", "click", "rich")
    code = (
        "import sys, spheremesh, spheremesh.interfaces\n"
        f"print([name for name in {heavy!r} if name in sys.modules])"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert result.stdout.strip() == "[]"
