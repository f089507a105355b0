"""The site: every node stands in the reference, every page is found, broken links are told."""

import re
import sys
from doctest import DocTestParser
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import pytest

from spheremesh import nodes
from spheremesh.interfaces.node_help import port_facts
from spheremesh.nodes import find_node

ROOT = Path(__file__).parents[1]


class Site(NamedTuple):
    """The scripts that build it."""

    build: ModuleType
    links: ModuleType
    pictures: ModuleType
    reference: ModuleType


@pytest.fixture
def site(monkeypatch: pytest.MonkeyPatch) -> Site:
    monkeypatch.syspath_prepend(ROOT / "docs" / "site")
    import build  # pyright: ignore[reportMissingImports]

    found = Site(build, *(sys.modules[name] for name in Site._fields[1:]))
    for module in found:
        monkeypatch.delitem(sys.modules, module.__name__)
    return found


def library_names() -> set[str]:
    return set(dir(nodes)) - set(nodes._FRAMEWORK)


def examples(text: str) -> list[tuple[str, str]]:
    return [(each.source, each.want) for each in DocTestParser().get_examples(text)]


def test_the_reference_has_every_node_with_its_ports_and_its_example(site: Site) -> None:
    pages = site.reference.reference_pages()
    sections: dict[str, str] = {}
    for page in pages.values():
        title, *parts = page.split("\n\n## ")
        if title.startswith(("# The nodes", "# What goes by wire")):
            continue
        sections.update({part.partition("\n")[0]: part for part in parts})
    assert set(sections) == library_names()
    for name, section in sections.items():
        node = find_node(name)
        plain = re.sub(r"\[(\w+)\]\(types\.md#\w+\)", r"\1", section.replace("\\", ""))
        for port in (*node.inputs.values(), *node.outputs.values()):
            assert f"- **{port.name}**: {port_facts(port)}\n" in f"{plain}\n", name
        shown = re.findall(r"```pycon\n(.*?)\n```", section, re.DOTALL)
        assert examples(shown[0]) == examples(node.help), name
        assert any(want for _, want in examples(node.help)), f"{name} shows no result"


def test_links_of_the_reference_lead_to_nodes(site: Site) -> None:
    pages = site.reference.reference_pages()
    for text in pages.values():
        for page, name in re.findall(r"\]\((\w+)\.md#(\w+)\)", text):
            assert f"\n## {name}\n" in (pages[page].lower() if page == "types" else pages[page])
    assert all(f"#{name})" in pages["index"] for name in library_names())
    assert "[`axis_support`](support.md#axis_support)" in pages["fabricate"]
    assert "- **result**: [SphereMesh](types.md#spheremesh)\n" in pages["spheres"]
    for name in ("Mesh", "SphereMesh", "Panels", "Beams", "Surface"):
        assert f"\n## {name}\n" in pages["types"]


def test_text_of_docstrings_is_no_markup(site: Site) -> None:
    text = site.reference._text(
        "a * b_c < ``d_e`` [f] `panels` `g`", {"panels": "fabricate.md#panels"}
    )
    assert text == r"a \* b\_c \< `d_e` \[f\] [`panels`](fabricate.md#panels) `g`"


def test_what_a_node_makes_in_its_example_is_drawn(site: Site) -> None:
    image = site.pictures.picture(find_node("fit_spheres"))
    assert image.size == site.pictures.SIZE
    assert len(image.getcolors(image.width * image.height)) > 1000
    assert site.pictures.picture(find_node("sphere_rows")) is None
    picture = site.reference.reference_pages({"fit_spheres": "fit.png"})["spheres"]
    assert picture.count("](fit.png)") == 1


def test_every_page_has_its_place(site: Site, tmp_path: Path) -> None:
    site.build.gather(tmp_path, with_pictures=False)
    pages = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.md")}
    listed = [name for names in site.build.chapters(tmp_path).values() for name in names]
    assert sorted([*listed, "index"]) == sorted(page.removesuffix(".md") for page in pages)
    front = (tmp_path / "index.md").read_text(encoding="utf-8")
    assert front.startswith((ROOT / "README.md").read_text(encoding="utf-8"))
    assert all(f"\n{name}\n" in front for name in listed)
    assert (tmp_path / "interfaces" / "hops" / "client.py").is_file(), "a page offers it"


def test_broken_links_are_told(site: Site, tmp_path: Path) -> None:
    (tmp_path / "below").mkdir()
    (tmp_path / "a.html").write_text(
        '<h1 id="top">A</h1><a href="below/b.html#there">b</a> <a href="#top">up</a>'
        '<a href="https://example.org/none">other</a> <img src="none.png?v=1">'
        '<a href="below/b.html#nowhere">b</a>'
    )
    (tmp_path / "below" / "b.html").write_text(
        '<p id="there"></p><a href="../a.html?x=1#top">a</a><a href="../../outside.html">c</a>'
    )
    (tmp_path.parent / "outside.html").write_text("")
    assert list(site.links.broken_links(tmp_path)) == [
        "a.html: none.png?v=1 leads nowhere",
        "a.html: below/b.html#nowhere: no such place on that page",
        "b.html: ../../outside.html leads nowhere",
    ]
