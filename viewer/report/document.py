"""The page: before and after, moulds, gaps, what is wrong, how to reproduce it.

One file of text without scripts, which asks for nothing else. What a user has named is escaped.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from typing import Any, Final

import numpy as np

from ...kernel.arrays import FloatArray
from ...kernel.panels.facts import edge_angles
from ...kernel.panels.joints import panel_joints
from ...kernel.panels.panels import Panels
from ...kernel.parts.colors import mould_color
from .charts import histogram
from .diagram import graph_picture
from .faults import MOST_PARTS, faults, verdict
from .pictures import striped_pictures
from .tables import table

PLANES, SPHERES, GAPS = "#a9afb8", "#2c6fa6", "#b7793a"
STYLE: Final = """
body{font:15px/1.5 system-ui,sans-serif;color:#22262b;max-width:60rem;margin:2rem auto;padding:0 1.2rem}
h1{font-size:1.9rem;margin:0}h2{font-size:1.15rem;margin:2.2rem 0 .6rem;border-bottom:1px solid #dfe2e6;padding-bottom:.3rem}
.lead{color:#5b636d;margin:.2rem 0 1rem}.verdict{padding:.6rem .9rem;border-radius:.5rem;background:#eef5ee;border:1px solid #bcd6bd}
.verdict.bad{background:#fbeeec;border-color:#e2b5ae}
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}th,td{text-align:right;padding:.25rem .6rem;border-bottom:1px solid #eceef0}
th:first-child,td:first-child{text-align:left}th{font-weight:600;color:#5b636d}.words td,.words th{text-align:left;vertical-align:top}
.pair{display:grid;grid-template-columns:1fr 1fr;gap:1rem}figure{margin:0}figure img{width:100%;border-radius:.4rem}figcaption{color:#5b636d;font-size:.9rem}
svg{width:100%;height:auto;font:12px system-ui,sans-serif;fill:#3b4149}svg line{stroke:#9aa2ab}.keys{margin:.2rem 0;display:flex;gap:1.2rem}
i{display:inline-block;width:.9em;height:.9em;border-radius:.2em;margin-right:.4em;vertical-align:-.1em}i,.verdict,pre{print-color-adjust:exact;-webkit-print-color-adjust:exact}
details summary{cursor:pointer;margin:.8rem 0}.verdict ol{margin:.4rem 0 0;padding-left:1.2rem}
.graph rect{fill:#f4f5f7;stroke:#c3c8ce}.graph path{fill:none;stroke:#b3bac2}.graph .fine{font-size:9px;fill:#78818b}
code,pre{font:13px/1.45 ui-monospace,monospace;background:#f4f5f7;border-radius:.3rem}pre{padding:.7rem .9rem;white-space:pre-wrap}code{padding:.1rem .3rem}
@media (max-width:40rem){.pair{grid-template-columns:1fr}}
@page{margin:14mm}
@media print{body{margin:0;max-width:none;padding:0;font-size:11pt}h2,figure,svg,.verdict{break-inside:avoid;break-after:auto}h2{break-after:avoid}tr{break-inside:avoid}}
"""  # noqa: E501 - lines of a style sheet


@dataclass(frozen=True)
class ReportFacts:
    """What a report tells.

    Attributes
    ----------
    title : str
        Heading of the page.
    report : mapping
        The report of the panelling, as in report.json.
    angles : (E,) float array
        Angles between the planes of neighbouring faces, in degrees.
    graph : str
        The graph that made it, as JSON; or nothing.
    version : str
        Of spheremesh.
    millimeters : float
        Of a model unit.
    sheets : mapping, optional
        How pieces lie on stock sheets, as `nest_parts` tells it.
    """

    title: str
    report: Mapping[str, Any]
    angles: FloatArray
    graph: str
    version: str
    millimeters: float
    sheets: Mapping[str, Any] | None = None


def report_text(panels: Panels, facts: ReportFacts) -> str:
    """The page as text."""
    report = facts.report
    chapters = [
        verdict(report),
        faults(report),
        _before_and_after(panels, facts),
        _moulds(report, facts.millimeters),
        _sheets(facts.sheets),
        _gaps(panels, report, facts.millimeters),
        _cost(report),
        _reproduction(facts),
    ]
    model = report["input"]
    size = " × ".join(f"{side:.4g}" for side in model["size"])
    lead = (
        f"{report['panels']['written']:,} panels"
        + (f", {report['beams']['written']:,} beams" if report["beams"]["written"] else "")
        + f" on {model['faces']:,} faces, {size} {model['units']}"
    )
    title = escape(facts.title)
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta http-equiv="Content-Security-Policy" content="default-src \'none\'; '
        "style-src 'unsafe-inline'; img-src data:\">\n"
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{title}: report</title>\n<style>{STYLE}</style>\n</head>\n<body>\n"
        f'<h1>{title}</h1>\n<p class="lead">{escape(lead)}</p>\n'
        + "\n".join(chapter for chapter in chapters if chapter)
        + "\n</body>\n</html>\n"
    )


def _before_and_after(panels: Panels, facts: ReportFacts) -> str:
    angles: Mapping[str, Mapping[str, float]] = facts.report["angles_deg"]
    names = {
        "planar": "flat panels",
        "unclustered": "spheres, a radius each",
        "spherical": "spheres as built",
    }
    rows = [
        (escape(name), f"{angles[key]['mean']:.2f}°", f"{angles[key]['max']:.1f}°")
        for key, name in names.items()
        if key in angles
    ]
    built = np.degrees(edge_angles(panels))[panels.edge_ids >= 0]
    chart = histogram(
        [("flat panels", PLANES, facts.angles), ("spheres as built", SPHERES, built)],
        "°",
        label="Angles between neighbouring panels, flat and spherical",
    )
    flat, round_panels = striped_pictures(panels)
    return (
        "<h2>Before and after</h2>"
        + '<div class="pair">'
        + f'<figure><img src="{flat}" alt="Flat panels under stripes">'
        + "<figcaption>Flat panels: mirrored stripes break at every edge</figcaption></figure>"
        + f'<figure><img src="{round_panels}" alt="Spherical panels under stripes">'
        + "<figcaption>The same corners, on spheres</figcaption></figure></div>"
        + "<h2>Angles between neighbours</h2>"
        + table(("", "mean", "largest"), rows)
        + _sharp_edges(facts.report["creases"])
        + chart
    )


def _sharp_edges(creases: Mapping[str, Any]) -> str:
    """What the table of angles leaves out."""
    count = int(creases["count"])
    if not count:
        return ""
    edges, they = (
        ("edge stays", "it is") if count == 1 else (f"{count:,} edges stay", "they are")
    )
    number = "One " if count == 1 else ""
    return (
        f"<p>{number}{edges} sharp, since the design turns there by more than "
        f"{creases['angle_deg']:.0f}°: {they} left out of the table. With "
        f"{'it' if count == 1 else 'them'} the largest angle is "
        f"<b>{creases['max_deg']:.1f}°</b>; the histogram has all.</p>"
    )


def _moulds(report: Mapping[str, Any], millimeters: float) -> str:
    moulds = report["moulds"]
    count = int(moulds["count"])
    if not count:
        return "<h2>Moulds</h2><p>Not asked for: every panel has a radius of its own.</p>"
    blanks: dict[int, Mapping[str, Any]] = {blank["mould"]: blank for blank in moulds["blanks"]}
    total = sum(moulds["panels_per_mould"]) or 1
    rows: list[tuple[str, ...]] = []
    for label, (radius, panels) in enumerate(
        zip(moulds["radii"], moulds["panels_per_mould"], strict=True)
    ):
        red, green, blue = mould_color(label, count)
        blank = blanks.get(label + 1)
        rows.append(
            (
                f'<i style="background:rgb({red},{green},{blue})"></i>{label + 1}',
                "plane" if radius is None else f"{radius * millimeters:,.0f}",
                f"{panels:,}",
                f"{100 * panels / total:.0f} %",
                f"{blank['diameter'] * millimeters:,.0f}" if blank else "–",
                f"{blank['sagitta'] * millimeters:,.1f}" if blank else "–",
                f"{blank['shapes']:,}" if blank else "–",
            )
        )
    heads = ("mould", "radius mm", "panels", "share", "blank mm", "rise mm", "shapes")
    return (
        f"<h2>Moulds: {count} for {total:,} panels</h2>{table(heads, rows)}{_not_made(report)}"
        "<p>A blank is the round sheet that the largest panel of a mould is cut from; "
        "each panel in its blank is drawn in <code>moulds.dxf</code> and "
        "<code>moulds.svg</code>.</p>"
    )


def _not_made(report: Mapping[str, Any]) -> str:
    rejected = len(report["panels"]["rejected"])
    return f"<p>{rejected:,} of these panels cannot be made.</p>" if rejected else ""


def _sheets(sheets: Mapping[str, Any] | None) -> str:
    """How many sheets must be bought, of what is nested."""
    if sheets is None:
        return ""
    oversize: list[str] = sheets["oversize"]
    pieces = len(sheets["pieces"]) - len(oversize)
    names = ", ".join(oversize[:MOST_PARTS]) + (", ..." if len(oversize) > MOST_PARTS else "")
    beyond = (
        f" <b>{len(oversize):,} pieces are larger than a sheet</b> and need one of their own: "
        f"{escape(names)}."
        if oversize
        else ""
    )
    return (
        f"<h2>Sheets: {sheets['sheets']:,} for {pieces:,} pieces</h2>"
        f"<p>By their areas alone they would need {sheets['bound']:,}; "
        f"{100 * sheets['waste']:.0f} % of the sheets is left over.{beyond}</p>"
    )


def _gaps(panels: Panels, report: Mapping[str, Any], millimeters: float) -> str:
    gap = report["edge_gap"]
    joints = panel_joints(panels)
    steps = joints.steps[np.isfinite(joints.steps)] * millimeters
    chart = histogram(
        [("steps at edges", GAPS, steps)], " mm", label="Steps between neighbouring panels"
    )
    largest = gap["max"] * millimeters
    share = 100 * gap["relative_to_edge"]
    return (
        "<h2>Gaps and steps</h2>"
        f"<p>Arcs of neighbours, before the joint, are up to <b>{largest:.3g} mm</b> apart "
        f"({share:.2g} % of an edge), {gap['mean'] * millimeters:.2g} mm in the mean.</p>"
        f"{chart}"
    )


def _cost(report: Mapping[str, Any]) -> str:
    cost = report["cost"]
    if not cost:
        return ""
    rows = [(escape(name), f"{part:,.0f}") for name, part in cost["parts"].items() if part]
    rows.append(("<b>total</b>", f"<b>{cost['total']:,.0f}</b>"))
    return f"<h2>Cost</h2>{table(('', str(cost['currency'])), rows)}"


def _reproduction(facts: ReportFacts) -> str:
    if not facts.graph:
        return (
            "<h2>How to reproduce</h2>"
            f"<p>Made with spheremesh {escape(facts.version)}, outside of a graph.</p>"
        )
    graph: Mapping[str, Any] = json.loads(facts.graph)
    params: Mapping[str, Mapping[str, Any]] = graph.get("params", {})
    values = [(escape(name), escape(str(each["value"]))) for name, each in params.items()]
    sliders = table(("value", ""), values) if values else ""
    return (
        "<h2>How to reproduce</h2>"
        f"<p>Made with spheremesh {escape(facts.version)} by <code>graph.json</code>, which "
        "stands beside this page:</p><pre>spheremesh run graph.json -o again</pre>"
        f"{sliders}<details><summary>The steps as a graph</summary>"
        f"{graph_picture(graph)}</details>"
    )
