"""The list of components for the browser: one page, no scripts."""

import html
from collections.abc import Iterable, Mapping
from typing import Any, Final

POLICY: Final = "default-src 'none'; style-src 'unsafe-inline'; frame-ancestors 'none'"

_STYLE: Final = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto;
  padding: 0 1rem; color: #222; background: #fff }
h2 { margin: 2rem 0 .5rem }
article { border-top: 1px solid #ccc; padding: .5rem 0 }
h3 { margin: 0; font: bold 1rem ui-monospace, monospace }
p { margin: .2rem 0 }
table { border-collapse: collapse; margin: .3rem 0 .3rem 1rem }
td { padding: 0 1rem 0 0; vertical-align: top }
td:first-child { font-family: ui-monospace, monospace; white-space: nowrap }
td:nth-child(2) { color: #555; white-space: nowrap }
.fault { color: #a00 }
@media (prefers-color-scheme: dark) {
  body { color: #ddd; background: #181818 }
  a { color: #8bf }
  td:nth-child(2) { color: #aaa }
  .fault { color: #f88 }
  article { border-color: #444 }
}
"""


def components_page(descriptions: Iterable[Mapping[str, Any]], address: str) -> str:
    """The page.

    Parameters
    ----------
    descriptions : iterable of mapping
        Of all components, as Grasshopper gets them.
    address : str
        Of the server, as the browser calls it.

    Returns
    -------
    str
        HTML.
    """
    chapters: dict[str, list[Mapping[str, Any]]] = {}
    for each in descriptions:
        chapters.setdefault(str(each["Subcategory"]), []).append(each)
    links = " · ".join(f'<a href="#{_text(name)}">{_text(name)}</a>' for name in chapters)
    body = "".join(
        f'<h2 id="{_text(name)}">{_text(name)}</h2>' + "".join(map(_component, several))
        for name, several in chapters.items()
    )
    example = f"{address}/fit_spheres"
    return f"""<!doctype html>
<html lang="en">
<head><meta charset="utf-8"><title>spheremesh: components for Grasshopper</title>
<meta name="viewport" content="width=device-width"><style>{_STYLE}</style></head>
<body>
<h1>spheremesh in Grasshopper</h1>
<p>Set a Hops component on the canvas, double-click it, and give it the address of a component,
such as <code>{_text(example)}</code>. All of them are listed in its menu when
<code>{_text(address)}</code> is a function source in the preferences of Hops.
For Rhino's own Python there is <a href="/client.py">client.py</a>.</p>
<p>{links}</p>
{body}
</body>
</html>
"""


def _component(each: Mapping[str, Any]) -> str:
    name = _text(each["Name"])
    faults = "".join(f'<p class="fault">{_text(fault)}</p>' for fault in each["Errors"])
    rows = "".join(_row("in", port) for port in each["Inputs"])
    rows += "".join(_row("out", port) for port in each["Outputs"])
    return (
        f'<article><h3><a href="/{name}">{name}</a></h3><p>{_text(each["Description"])}</p>'
        f"{faults}<table>{rows}</table></article>"
    )


def _row(way: str, port: Mapping[str, Any]) -> str:
    default = f" = {port['Default']}" if "Default" in port else ""
    return (
        f"<tr><td>{way} {_text(port['Name'])}</td><td>{_text(port['ParamType'] + default)}</td>"
        f"<td>{_text(port['Description'])}</td></tr>"
    )


def _text(value: object) -> str:
    return html.escape(str(value))
