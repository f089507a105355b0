"""All figures, and the page of the docs that shows them.

``python examples/figures/gallery.py`` writes docs/images/figures/*.png and docs/gallery.md.
"""

import importlib
import sys
import warnings
from pathlib import Path

from figure import Figure, paint

HERE = Path(__file__).resolve().parent
DOCS = HERE.parents[1] / "docs"
SCRIPTS = sorted(path.stem for path in HERE.glob("fig[0-9]*.py"))

HEAD = """# Gallery

The figures of *Meshes with Spherical Faces*, remade: each by a short script of
[`examples/figures`](../examples/figures/figure.py), which prints the number that it proves.
`make figures` draws all pictures of these pages anew; `python examples/figures/fig12.py` writes
one. The shapes are our own.
"""


def title(script: str) -> str:
    """What a script says that it shows, its figure first."""
    return (importlib.import_module(script).__doc__ or "").strip().partition("\n")[0]


def page(figures: dict[str, Figure]) -> str:
    """The text of the gallery."""
    parts = [HEAD]
    for script, figure in figures.items():
        name, _, words = title(script).partition(": ")
        says = figure.says[0].upper() + figure.says[1:]
        parts.append(
            f"## {name}\n\n{words[0].upper()}{words[1:]}\n\n![{words.rstrip('.')}]"
            f"(images/figures/{script}.png)\n\n"
            f"{says} ([`{script}.py`](../examples/figures/{script}.py))\n"
        )
    return "\n".join(parts)


def main() -> None:
    """Draw all, and write the page; ends with 1 if a figure does not hold."""
    warnings.simplefilter("ignore")
    (DOCS / "images" / "figures").mkdir(exist_ok=True)
    figures: dict[str, Figure] = {}
    for script in SCRIPTS:
        figures[script] = importlib.import_module(script).draw()
        holds = "" if figures[script].holds else " THIS DOES NOT HOLD"
        print(f"{figures[script].name}: {figures[script].says}{holds}", flush=True)
        path = DOCS / "images" / "figures" / f"{script}.png"
        paint(figures[script]).quantize(192).save(path, optimize=True)
    (DOCS / "gallery.md").write_text(page(figures), encoding="utf-8")
    sys.exit(not all(figure.holds for figure in figures.values()))


if __name__ == "__main__":
    main()
