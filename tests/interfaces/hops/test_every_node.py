"""Every node as a component gives what its function gives, for the inputs of its example."""

import contextlib
import doctest
import functools
import inspect
import io
import json
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.fabrication.rhino_objects.meshes import mesh_fields, mesh_of_fields
from spheremesh.interfaces.hops.components import Component, Input
from spheremesh.interfaces.hops.parameters import is_file
from spheremesh.nodes import (
    ellipsoid_mesh,
    face_planes,
    model_change,
    panels,
    roof_mesh,
    vase_mesh,
)
from spheremesh.nodes.graphs.annotations import members
from spheremesh.nodes.graphs.kinds import accepts
from spheremesh.nodes.graphs.node import REGISTRY, load_library
from spheremesh.nodes.graphs.stores.digests import digest

pytestmark = pytest.mark.filterwarnings("ignore::spheremesh.nodes.NodeWarning")
Value: TypeAlias = Any


class Call(NamedTuple):
    """What a node was given, and what it returned."""

    inputs: dict[str, Value]
    result: Value


class Kept(tempfile.TemporaryDirectory):
    """A folder for a while that nobody removes."""

    def cleanup(self) -> None:
        """Leave it."""
        self._finalizer.detach()

    def __exit__(self, *_: object) -> None:
        self.cleanup()


OWN_INPUTS: dict[str, Callable[[], dict[str, Value]]] = {
    # Examples that begin with what is no mesh yet, or that take long.
    "repair_mesh": lambda: {"mesh": vase_mesh(8, 4)},
    "mesh_report": lambda: {"mesh": vase_mesh(8, 4)},
    "exact_support": lambda: {"mesh": roof_mesh(2, 2)},
    "cadquery_solids": lambda: {"panels": panels(face_planes(vase_mesh(3, 1))).panels},
    "common_axes": lambda: {"sphere_mesh": model_change(ellipsoid_mesh(8, 4), radius=4.0)},
}

load_library()
NODES = sorted(
    name for name, node in REGISTRY.items() if ".library." in node.function.__module__
)


@pytest.fixture(scope="module")
def folder(shared: Value) -> Path:
    return shared.files


@pytest.fixture(scope="module")
def example(folder: Path) -> Iterator[Callable[[str], Call]]:
    """The first call of a node in its own example, with what was computed before known."""
    known: dict[bytes, Value] = {}

    def recorded(name: str, calls: dict[str, Call]) -> Value:
        function = REGISTRY[name].function

        @functools.wraps(function)
        def call(*several: Value, **named: Value) -> Value:
            inputs = inspect.signature(function).bind(*several, **named).arguments
            key = digest([name, dict(inputs)])
            if key not in known or any(map(is_file, REGISTRY[name].inputs.values())):
                known[key] = function(*several, **named)
            calls.setdefault(name, Call(dict(inputs), known[key]))
            return known[key]

        return call

    def run(name: str) -> Call:
        if name in OWN_INPUTS:
            inputs = OWN_INPUTS[name]()
            return Call(inputs, REGISTRY[name].function(**inputs))
        calls: dict[str, Call] = {}
        original = dict(REGISTRY)
        module = sys.modules[original[name].function.__module__]
        text = inspect.getdoc(original[name].function)
        test = doctest.DocTestParser().get_doctest(text, {}, name, None, 0)
        changed = {n: replace(x, function=recorded(n, calls)) for n, x in original.items()}
        kept = tempfile.TemporaryDirectory
        try:
            # Files of examples stay, and lie in the folder that is served.
            tempfile.TemporaryDirectory = partial(Kept, dir=folder)
            REGISTRY.update(changed)
            names = {**vars(module), name: changed[name].function}
            with contextlib.redirect_stdout(io.StringIO()), contextlib.chdir(folder):
                for part in test.examples:
                    exec(compile(part.source, name, "single"), names)  # noqa: S102
        finally:
            REGISTRY.update(original)
            tempfile.TemporaryDirectory = kept
        return calls[name]

    yield run
    known.clear()


@pytest.mark.usefixtures("in_this_process")
@pytest.mark.parametrize("name", NODES)
def test_a_component_gives_what_its_node_gives(
    name: str, example: Callable[[str], Call], folder: Path, shared: Value
) -> None:
    call, one = example(name), shared
    component = one.service.catalogue.find(name).component
    handles = one.service.solver.handles
    trees = {}
    for port, given in call.inputs.items():
        value = plain(folder, given)
        found = given_as(component, port, value, lambda x: handles.give("value", x))
        if found is not None:
            trees[found[0].name] = found[1]
    if component.node.is_writer:
        (folder / call.inputs["path"]).unlink()
    units = "Millimeters" if name == "read_surface" else "Meters"
    outputs = one.gh.solve(name, units, **trees)
    results = call.result if component.node.has_fields else (call.result,)
    for port, wanted in zip(component.node.outputs.values(), results, strict=True):
        output = next(each for each in component.outputs if each.port is port)
        got = outputs[output.name]
        where = f"{name}.{output.name}"
        if name != "cadquery_solids":
            assert_equal(where, got, wanted, handles, folder)


def plain(folder: Path, value: Value) -> Value:
    """A value as it comes to a server: tables of numbers as the path of a file."""
    if isinstance(value, dict):
        lines = [
            line
            for name, table in value.items()
            for line in (f"[{name}]", *(f"{key} = {number}" for key, number in table.items()))
        ]
        (folder / "tables.toml").write_text("\n".join(lines), encoding="utf-8")
        return "tables.toml"
    if isinstance(value, tuple) and all(isinstance(each, int) for each in value):
        return list(value) or None
    return str(value) if isinstance(value, Path) else value


def given_as(
    component: Component, port: str, value: Value, handle: Callable[[Value], str]
) -> tuple[Input, Value] | None:
    """The input that carries a value, and its items."""
    inputs = [each for each in component.inputs if each.port.name == port]
    if value is None or (isinstance(value, str | tuple) and not value):
        return None
    for each in inputs:
        form = each.carrier.form
        if not any(accepts(member.hint, value) for member in each.carrier.members):
            continue
        if form.param_type == "Mesh" and isinstance(value, Mesh):
            return each, mesh_fields(value)
        if form.is_coded and form.is_list:
            return each, [handle(x) for x in value]
        if form.is_coded:
            return each, handle(np.asarray(value) if isinstance(value, list) else value)
        if form.param_type in ("Point", "Vector"):
            return each, np.asarray(value, float).reshape(-1, 3).tolist()
        if form.param_type not in ("Mesh", "Brep", "Curve", "Plane"):
            return each, value.tolist() if hasattr(value, "tolist") else value
    raise AssertionError(f"{component.name}.{port} takes no {type(value)}: {inputs}")


def assert_equal(where: str, got: Value, wanted: Value, handles: Value, folder: Path) -> None:
    if isinstance(wanted, Mesh):
        assert digest(mesh_of_fields(got[0])) == digest(wanted), where
    elif isinstance(got, list) and len(got) == 1 and str(got[0]).startswith("spheremesh:"):
        assert digest(handles.take(got[0], where)) == digest(wanted), where
    elif isinstance(wanted, np.ndarray) and got and isinstance(got[0], dict):
        rows = [[each[axis] for axis in "XYZ"] for each in got]
        keep = np.isfinite(wanted).all(axis=-1)
        assert np.array_equal(np.reshape(rows, wanted.shape)[keep], wanted[keep]), where
    elif isinstance(wanted, np.ndarray) and wanted.dtype.kind == "f":
        numbers = json.loads(got[0]) if isinstance(got[0], str) else got
        keep = np.isfinite(wanted)
        assert np.array_equal(np.reshape(numbers, wanted.shape)[keep], wanted[keep]), where
    elif isinstance(wanted, np.ndarray):
        assert got == wanted.tolist(), where
    elif isinstance(wanted, str):
        assert got in ([wanted], [str(folder / wanted)]), where
    elif isinstance(wanted, int | float):
        assert got == [wanted], where
    elif isinstance(wanted, list):
        assert got == [json.dumps(each) for each in wanted], where
    elif isinstance(wanted, tuple):
        assert len(got) == len(wanted), where
    else:  # a report
        assert json.loads(got[0]).keys() == dict(wanted).keys(), where
        assert handles.recall(got[0]) is not None, where


def test_every_input_and_output_has_a_parameter(gh: Value) -> None:
    for name in NODES:
        found = gh.describe(name)
        assert found["description"], name
        node = REGISTRY[name]
        for port in node.inputs.values():
            is_there = any(each["Name"] == port.name for each in found["inputs"])
            assert is_there or all(member.kind is type(None) for member in members(port.type))
        assert len(found["outputs"]) >= len(node.outputs)
