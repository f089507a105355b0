"""Every Python block of README and docs runs; blocks of a page share their names.

A block that begins with the name of a file, ``# daylight.py``, is that file.
"""

import re
import sys
import warnings
from pathlib import Path

import pytest

from spheremesh import nodes
from spheremesh.nodes import NodeWarning

ROOT = Path(__file__).parents[1]
TABLES = {"benchmarks.md", "gallery.md", "laws.md", "operations.md"}
"""Pages without code."""
PAGES = [
    ROOT / "README.md",
    *sorted((ROOT / "docs").glob("*.md")),
    *sorted((ROOT / "docs" / "tutorials").glob("*.md")),
]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_page_runs(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    blocks = re.findall(r"^```python\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
    assert blocks or page.name in TABLES, f"{page.name} shows no code"
    names: dict[str, object] = {"__name__": "docs"}
    with warnings.catch_warnings():
        warnings.simplefilter("default", NodeWarning)
        for block in blocks:
            file = re.match(r"# (\w+)\.py\n", block)
            if file:
                (tmp_path / f"{file[1]}.py").write_text(block, encoding="utf-8")
                monkeypatch.delitem(sys.modules, file[1], raising=False)
                continue
            exec(compile(block, str(page), "exec"), names)  # noqa: S102


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#]+)[^)]*\)", page.read_text(encoding="utf-8")):
        assert "://" in target or (page.parent / target).exists(), target


def test_readme_tells_the_angles_that_come_out() -> None:
    table = re.findall(
        r"^\| `(\w+_mesh)` \| ([\d.]+) \| ([\d.]+) \| ([\d.]+) \|$",
        (ROOT / "README.md").read_text(encoding="utf-8"),
        re.M,
    )
    assert len(table) >= 5
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NodeWarning)
        for name, *printed in table:
            optimum = nodes.minimize_angles(nodes.fit_spheres(getattr(nodes, name)()))
            clusters = nodes.cluster_radii(optimum.sphere_mesh, k=8)
            angles = optimum.report["angles_deg"]
            means = [
                angles["planar"]["mean"],
                angles["spherical"]["mean"],
                clusters.report["angles_deg"]["mean"],
            ]
            assert [f"{mean:.2f}" for mean in means] == printed, name
