"""Every link within a built site leads to a page, and to a place that is on it."""

from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class _Page(HTMLParser):
    """What a page links to, and the places on it."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.places: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note links and ids."""
        facts = dict(attrs)
        self.places |= {each for each in (facts.get("id"), facts.get("name")) if each}
        link = facts.get("href" if tag in ("a", "link") else "src")
        if link is not None:
            self.links.append(link)


def broken_links(folder: Path) -> Iterator[str]:
    """What leads nowhere: the page and the link. Other sites are not asked.

    Parameters
    ----------
    folder : Path
        With the HTML files.
    """
    pages = {
        path.resolve(): _Page(path.read_text(encoding="utf-8"))
        for path in sorted(folder.rglob("*.html"))
    }
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            places = pages[target].places if target in pages else None
            if not (target.is_file() and target.is_relative_to(folder.resolve())):
                yield f"{path.name}: {link} leads nowhere"
            elif parts.fragment and places and unquote(parts.fragment) not in places:
                yield f"{path.name}: {link}: no such place on that page"
