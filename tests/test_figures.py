"""Every figure of the paper is drawn on a small model, and what it says holds."""

import importlib
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "examples" / "figures"
SCRIPTS = sorted(path.stem for path in FOLDER.glob("fig[0-9]*.py"))
SHOWN = {1, 3, *range(5, 18), *range(19, 30), 31, 32}
"""Figures of the paper that show something which can be computed."""


@pytest.fixture
def load(monkeypatch: pytest.MonkeyPatch) -> Any:  # noqa: ANN401, a function
    """Import as a script does, from its own folder."""
    monkeypatch.syspath_prepend(str(FOLDER))
    yield importlib.import_module
    for name in {*SCRIPTS, "figure", "gallery"} & sys.modules.keys():
        del sys.modules[name]


def test_there_is_a_script_for_every_figure_that_shows_something() -> None:
    assert {int(name.removeprefix("fig")) for name in SCRIPTS} >= SHOWN


@pytest.mark.filterwarnings("ignore::spheremesh.nodes.NodeWarning")
@pytest.mark.parametrize("script", SCRIPTS)
def test_a_figure_holds_and_is_drawn(script: str, load: Any) -> None:  # noqa: ANN401
    module, common = load(script), load("figure")
    figure = module.draw(small=True)
    assert figure.holds, figure.says
    assert figure.name == f"Fig. {int(script.removeprefix('fig'))}"
    assert module.__doc__.startswith(f"{figure.name}: ")
    assert re.search(r"\d", figure.says)
    picture = np.asarray(common.paint(figure, 240))
    across = 240 // (figure.columns or len(figure.views))
    for place in range(len(figure.views)):
        column = place % (240 // across)
        assert np.ptp(picture[:, column * across : (column + 1) * across]) > 60


def test_the_gallery_shows_them_all() -> None:
    page = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
    for script in SCRIPTS:
        assert f"](images/figures/{script}.png)" in page
        assert (ROOT / "docs" / "images" / "figures" / f"{script}.png").is_file()
        assert f"](../examples/figures/{script}.py)" in page
