"""Build the site: ``python docs/site/build.py out/docs``, what ``make docs`` does.

The pages are those of the repository as they are, with the README in front; the reference of
all nodes is written from the nodes. A warning of Sphinx or a link that leads nowhere ends it.
"""

import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from links import broken_links
from pictures import write_pictures
from reference import library_nodes, reference_pages

SITE = Path(__file__).resolve().parent
ROOT = SITE.parents[1]
GUIDES = (
    "gallery", "panels", "mesh-files", "surfaces", "patterns", "supports", "exact-supports",
    "beams", "drawings", "tables", "assembly", "optimization", "remeshing", "hexagons",
    "models", "graphs", "security", "limits",
)  # fmt: skip
"""Order of the pages of docs/; those that are not named come after them."""
GRASSHOPPER = "grasshopper"
TABLES = ("sphere-geometry", "operations", "laws")
PROJECT = ("ARCHITECTURE", "CONTRIBUTING", "CHANGELOG")


def chapters(source: Path) -> dict[str, list[str]]:
    """The pages of the site by chapter, all of them."""
    pages = {path.stem for path in (source / "docs").glob("*.md")}
    guides = [name for name in GUIDES if name in pages]
    guides += sorted(pages - {*GUIDES, *TABLES, GRASSHOPPER})
    tutorials = sorted(path.stem for path in (source / "docs" / "tutorials").glob("*.md"))
    nodes = sorted(path.stem for path in (source / "docs" / "nodes").glob("*.md"))
    nodes = [name for name in nodes if name not in ("index", "types")]
    return {
        "Tutorials": [*(f"docs/tutorials/{name}" for name in tutorials), f"docs/{GRASSHOPPER}"],
        "Guides": [f"docs/{name}" for name in guides],
        "Nodes": [
            "docs/nodes/index",
            "docs/nodes/types",
            *(f"docs/nodes/{name}" for name in nodes),
        ],
        "Mathematics": [f"docs/{name}" for name in TABLES],
        "The project": list(PROJECT),
    }


def gather(source: Path, *, with_pictures: bool = True) -> None:
    """Put all that the site shows into a folder, laid out as in the repository."""
    shutil.copytree(ROOT / "docs", source / "docs", ignore=shutil.ignore_patterns("site"))
    for name in PROJECT:
        shutil.copy(ROOT / f"{name}.md", source)
    for page in sorted(source.rglob("*.md")):
        copy_linked_files(page, source)
    nodes = source / "docs" / "nodes"
    nodes.mkdir()
    every = [node for several in library_nodes().values() for node in several]
    pictures = write_pictures(every, nodes) if with_pictures else {}
    for name, text in reference_pages(pictures).items():
        (nodes / f"{name}.md").write_text(text, encoding="utf-8")
    front = [(ROOT / "README.md").read_text(encoding="utf-8")]
    for title, pages in chapters(source).items():
        tree = "\n".join(pages)
        front.append(f"```{{toctree}}\n:hidden:\n:caption: {title}\n\n{tree}\n```\n")
    (source / "index.md").write_text("\n".join(front), encoding="utf-8")


def copy_linked_files(page: Path, source: Path) -> None:
    """Put files of the repository that a page offers, such as a script, where it looks."""
    for link in re.findall(r"\]\(([^)#:]+)[)#]", page.read_text(encoding="utf-8")):
        target = (page.parent / link).resolve()
        if target.is_relative_to(source.resolve()) and not target.exists():
            wanted = ROOT / target.relative_to(source.resolve())
            if wanted.is_file():
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(wanted, target)


def build(out: Path) -> Sequence[str]:
    """Build the site into a folder; what is wrong, line by line."""
    shutil.rmtree(out, ignore_errors=True)
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "source"
        source.mkdir()
        gather(source)
        command = [
            sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html",
            "-c", str(SITE), "-d", str(Path(folder) / "doctrees"), str(source), str(out),
        ]  # fmt: skip
        if subprocess.run(command, check=False).returncode:
            return ["Sphinx has warnings"]
    return list(broken_links(out))


def main() -> None:
    """Build, and say what is wrong."""
    out = Path(sys.argv[1]).resolve()
    faults = build(out)
    for fault in faults:
        print(fault, file=sys.stderr)
    if faults:
        sys.exit(1)
    print(out / "index.html")


if __name__ == "__main__":
    main()
