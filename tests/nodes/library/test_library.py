"""The library is found by itself, and only when asked for."""

import ast
import builtins
import subprocess
import sys
from doctest import DocTestParser

import pytest

from spheremesh import nodes

LIBRARY = [name for name in nodes.__all__ if name in nodes.REGISTRY]


def run(code: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@pytest.mark.parametrize("name", LIBRARY)
def test_every_node_has_an_example(name: str) -> None:
    """`make test` runs it."""
    example = nodes.find_node(name).help.partition("\nExamples\n--------\n")[2]
    assert f"{name}(" in example
    assert not example.splitlines()[-1].startswith((">>>", "..."))


@pytest.mark.parametrize("name", LIBRARY)
def test_examples_run_wherever_they_are_pasted(name: str) -> None:
    """Doctest lends them the names of the module; the reader has none."""
    parts = DocTestParser().get_examples(nodes.find_node(name).help)
    bound, used = set(dir(builtins)), set[str]()
    for part in ast.walk(ast.parse("".join(example.source for example in parts))):
        match part:
            case ast.Name(id=word, ctx=ast.Load()):
                used.add(word)
            case ast.Name(id=word) | ast.arg(arg=word):
                bound.add(word)
            case ast.Import(names=aliases) | ast.ImportFrom(names=aliases):
                bound |= {(alias.asname or alias.name).partition(".")[0] for alias in aliases}
    assert used <= bound


def test_importing_spheremesh_imports_no_node_and_nothing_heavy() -> None:
    heavy = ("scipy", "igl", "rich", "click", "rhino3dm", "cadquery", "OCP", "ezdxf")
    code = f"""
import sys, spheremesh
print([name for name in sys.modules if name.startswith("spheremesh.nodes.library")])
print([name for name in {heavy} if name in sys.modules])
"""
    assert run(code) == "[]\n[]"


def test_a_star_import_gives_every_node() -> None:
    code = """
from spheremesh.nodes import *
g = Graph()
print(fit_spheres.__module__, g.add(torus_mesh).node.category, node.__name__)
print("load_library" in globals(), "np" in globals())
"""
    assert run(code) == "spheremesh.nodes input node\nFalse False"


def test_a_node_by_name_and_a_name_that_is_none() -> None:
    code = """
import spheremesh.nodes as nodes
print(nodes.fit_spheres.__name__, "fit_spheres" in dir(nodes), hasattr(nodes, "fit_sphere"))
try:
    nodes.Graph().add("fit_sphere")
except ValueError as error:
    print(error)
"""
    assert run(code) == (
        "fit_spheres True False\nunknown node 'fit_sphere'; did you mean 'fit_spheres'?"
    )
