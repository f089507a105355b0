"""Limits that keep the house in order: names, rooms, files, functions, door plates, tables."""

import ast
import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

from spheremesh import nodes

ROOT = Path(__file__).parents[1]
PACKAGES = ("kernel", "nodes", "fabrication", "viewer", "interfaces")
SOURCES = [path for name in PACKAGES for path in sorted((ROOT / name).rglob("*.py"))]
ROOMS = sorted({path.parent for path in SOURCES if path.name != "__init__.py"})
MOST_FILES, MOST_LINES, MOST_FUNCTION_LINES = 15, 400, 60

TERMS_OF_ENERGY = {"blocks", "residuals", "jacobian", "second_derivatives"}
"""What every module of a term of energy (6) gives."""
SHARED_NAMES: dict[str, str] = {}
"""Other names that two modules may give, with the reason; five at most."""


def parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def name_of(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def public_names(path: Path) -> Iterator[str]:
    """Functions, classes and constants that a module defines."""
    for node in parsed(path).body:
        match node:
            case ast.FunctionDef() | ast.ClassDef():
                names = [node.name]
            case ast.AnnAssign(target=ast.Name(id=name)):
                names = [name]
            case ast.Assign():
                targets = [each for target in node.targets for each in ast.walk(target)]
                names = [each.id for each in targets if isinstance(each, ast.Name)]
            case _:
                names = []
        yield from (name for name in names if not name.startswith("_"))


@pytest.mark.parametrize("hall", ["kernel", "fabrication"])
def test_a_public_name_stands_in_one_module(hall: str) -> None:
    homes: dict[str, set[str]] = defaultdict(set)
    for path in sorted((ROOT / hall).rglob("*.py")):
        for name in public_names(path):
            homes[name].add(name_of(path))
    twice = {name for name, modules in homes.items() if len(modules) > 1}
    assert len(SHARED_NAMES) <= 5
    excepted = {*SHARED_NAMES, *TERMS_OF_ENERGY}
    assert twice - excepted == set(), {n: homes[n] for n in twice - excepted}
    for name in TERMS_OF_ENERGY & twice:
        assert all("optimization/energies" in module for module in homes[name])


@pytest.mark.parametrize("room", ROOMS, ids=name_of)
def test_rooms_have_few_files_and_a_door_plate_that_names_them(room: Path) -> None:
    files = {path.stem for path in room.glob("*.py") if path.name != "__init__.py"}
    doors = {path.parent.name for path in room.glob("*/__init__.py")}
    assert len(files) <= MOST_FILES
    plate = ast.get_docstring(parsed(room / "__init__.py"))
    assert plate, f"{name_of(room)} has no door plate"
    named = set(re.findall(r"^(\w+)  +\S", plate, re.MULTILINE))
    assert named == files | doors


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_files_and_functions_are_short(path: Path) -> None:
    lines = len(path.read_text(encoding="utf-8").splitlines())
    assert lines <= MOST_LINES, lines
    for node in ast.walk(parsed(path)):
        if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            continue
        length = (node.end_lineno or node.lineno) - node.lineno + 1
        if ast.get_docstring(node) is not None:
            docstring = node.body[0]
            length -= (docstring.end_lineno or 0) - docstring.lineno + 1
        assert length <= MOST_FUNCTION_LINES, f"{node.name}: {length} lines"


def rows_of(page: str) -> list[list[str]]:
    """Cells of the table of a page, without its head."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if line.startswith("| ")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[1:]]


def test_operations_have_their_files_and_nodes() -> None:
    rows = rows_of("operations.md")
    counts = {"A": 9, "B": 6, "C": 8, "D": 17, "E": 10, "F": 9}
    codes = [f"{letter}{i + 1}" for letter, count in counts.items() for i in range(count)]
    assert [row[0] for row in rows] == codes
    offered = set(dir(nodes))
    for code, _, file, names in rows:
        assert (ROOT / file.strip("`")).is_file(), code
        assert set(re.findall(r"`(\w+)`", names)) <= offered, code
        assert "`" in names, code


def test_every_law_has_its_row_and_every_row_its_law() -> None:
    proved: dict[str, set[str]] = defaultdict(set)
    for path in (ROOT / "tests").rglob("test_*.py"):
        text = path.read_text(encoding="utf-8")
        for codes in re.findall(r"^def test_law_((?:[a-f]\d+_)+)", text, re.MULTILINE):
            for code in codes.strip("_").split("_"):
                proved[code].add(name_of(path))
    listed = {row[0]: set(re.findall(r"`([^`]+)`", row[2])) for row in rows_of("laws.md")}
    assert listed == proved
