"""The tables of docs/benchmarks.md: ours beside general solvers and libraries, in one run.

    python benchmarks/tables/run.py [TABLE ...] [--quick]

The tables are smoothness, angles, energy, paper, files, patterns and jobs. Without names all of
them are measured, which takes half an hour. Every row is measured in a process of its own, so
its memory is its own. Seconds are CPU seconds of one thread and belong to the machine that is
named below each table; what counts are the ratios within a table and the exponents. Each run
adds lines to benchmarks/tables/history.jsonl, with which the next ones can be compared. Ceres
comes with the dependency group "bench".
"""

import json
import os
import platform
import sys
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

from measure import Table
from products import files, jobs, patterns, smoothness
from solvers import angles, energy, paper

from spheremesh import __version__

PAGE = Path(__file__).parents[2] / "docs" / "benchmarks.md"
HISTORY = Path(__file__).with_name("history.jsonl")

TABLES: dict[str, Callable[..., list[Table]]] = {
    "smoothness": smoothness,
    "angles": angles, "energy": energy, "paper": paper, "files": files, "patterns": patterns,
    "jobs": jobs,
}  # fmt: skip


def shown(value: object) -> str:
    """A cell: numbers with three digits."""
    if isinstance(value, float):
        return f"{value:,.3g}" if value < 1000 else f"{value:,.0f}"
    return f"{value:,}" if isinstance(value, int) else str(value)


def markdown(table: Table) -> str:
    """A table with its title and text."""
    lines = [table.columns, tuple("---" for _ in table.columns)]
    lines += [tuple(map(shown, row)) for row in table.rows]
    body = "\n".join(f"| {' | '.join(line)} |" for line in lines)
    return f"## {table.title}\n\n{table.text}\n\n{body}\n"


def machine() -> str:
    """Processor, cores and system."""
    name = platform.processor() or platform.machine()
    facts = Path("/proc/cpuinfo")
    if facts.exists():
        models = [line for line in facts.read_text().splitlines() if "model name" in line]
        name = models[0].partition(":")[2].strip() if models else name
    python = platform.python_version()
    return f"{name}, {os.cpu_count()} cores, {platform.system()}, Python {python}"


def main(options: list[str]) -> None:
    """Measure, write the page and add to the history."""
    is_quick = "--quick" in options
    names = [name for name in options if name != "--quick"] or list(TABLES)
    found: dict[str, list[Table]] = {}
    for name in names:
        found[name] = TABLES[name](is_quick=is_quick)
        for table in found[name]:
            print(markdown(table), flush=True)
    if is_quick:
        return
    today = datetime.now(UTC).date().isoformat()
    note = {"date": today, "version": __version__, "machine": machine()}
    with HISTORY.open("a", encoding="utf-8") as file:
        for name, tables in found.items():
            for table in tables:
                line = {**note, "name": name, **table._asdict()}
                file.write(json.dumps(line) + "\n")
    PAGE.write_text(page(), encoding="utf-8")


def page() -> str:
    """The last figures of each table, from the history."""
    last: dict[str, dict[str, Any]] = {}
    for line in HISTORY.read_text(encoding="utf-8").splitlines():
        entry = json.loads(line)
        last[entry["title"]] = entry
    order = list(TABLES)
    parts = [
        "# Benchmarks\n\nWritten by `python benchmarks/tables.py`. Seconds are CPU seconds of "
        "one thread; what counts are ratios within a table, and exponents. Every row was "
        "measured in a process of its own, whose peak memory is told.\n"
    ]
    for entry in sorted(last.values(), key=lambda entry: order.index(entry["name"])):
        table = Table(entry["title"], entry["text"], (), [])
        parts.append(
            markdown(table._replace(columns=tuple(entry["columns"]), rows=entry["rows"]))
            + f"\n{entry['date']}, version {entry['version']}, {entry['machine']}.\n"
        )
    return "\n".join(parts)


if __name__ == "__main__":
    main(sys.argv[1:])
