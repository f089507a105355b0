"""Nodes called as plain functions: arguments are checked, and the right call is named."""

import pickle
import timeit
from collections.abc import Callable
from dataclasses import replace
from functools import cache, wraps
from time import process_time
from types import SimpleNamespace as Space
from typing import Any

import numpy as np
import pytest

from spheremesh import Graph, Mesh
from spheremesh.kernel.errors import ArgumentError, InputError
from spheremesh.nodes import (
    audit,
    axis_support,
    beams,
    cluster_radii,
    deviation,
    find_node,
    fit_spheres,
    minimize_angles,
    panels,
    read_mesh,
    render,
    torus_mesh,
    write_mesh,
    write_step,
    write_view,
)
from spheremesh.nodes.direct_calls import checked
from spheremesh.nodes.library.spheres import fit_spheres as unchecked


@cache
def things() -> Space:
    mesh = torus_mesh(8, 6)
    spheres = fit_spheres(mesh)
    support = axis_support(spheres, depth=0.1)
    return Space(
        mesh=mesh, spheres=spheres, cut=panels(spheres), support=support,
        made=beams(support.annuli, thickness=0.02),
    )  # fmt: skip


MISTAKES: list[tuple[Callable[[Any], object], str]] = [
    (
        lambda t: write_step(t.cut),
        "write_step: panels must be Panels or None, not PanelSet: give its .panels",
    ),
    (
        lambda t: write_step(t.made.beams),
        "write_step: panels must be Panels or None, not Beams: give it as beams=...",
    ),
    (
        lambda t: write_step(t.made),
        "write_step: panels must be Panels or None, not BeamSet: give its .beams as beams=...",
    ),
    (
        lambda t: fit_spheres(t.spheres),
        "fit_spheres: mesh must be Mesh, not SphereMesh: give its .mesh",
    ),
    (
        lambda t: deviation(t.spheres, t.spheres),
        "deviation: mesh must be Mesh, not SphereMesh: give its .mesh",
    ),
    (
        lambda t: panels(t.mesh),
        "panels: sphere_mesh must be SphereMesh, not Mesh: make one with face_planes(...) or "
        "central_spheres(...) or smoothed_spheres(...) or principal_spheres(...).first",
    ),
    (
        lambda _: fit_spheres("roof.obj"),
        "fit_spheres: mesh must be Mesh, not 'roof.obj': make one with read_mesh(...) or "
        "repair_mesh(...).mesh",
    ),
    (
        lambda _: fit_spheres(pytest.importorskip("trimesh").creation.box()),
        "fit_spheres: mesh must be Mesh, not Trimesh: make a mesh of it with "
        "Mesh.from_trimesh(...)",
    ),
    (
        lambda _: fit_spheres(([[0, 0, 0]], [[0, 1, 2]])),
        "fit_spheres: mesh must be Mesh, not ([[0, 0, 0]], [[0, 1, 2]]): make a mesh of it "
        "with Mesh(vertices, faces)",
    ),
    (
        lambda _: fit_spheres(torus_mesh),
        "fit_spheres: mesh must be Mesh, not function: torus_mesh itself was given, call it: "
        "torus_mesh(...)",
    ),
    (
        lambda _: fit_spheres(Mesh),
        "fit_spheres: mesh must be Mesh, not type: Mesh itself was given, call it: Mesh(...)",
    ),
    (
        lambda t: beams(t.support, 0.02),
        "beams: annuli must be Annuli, not AxisSupport: give its .annuli",
    ),
    (
        lambda t: beams(t.support.annuli, "0.02"),
        "beams: thickness must be float or None, not '0.02'",
    ),
    (
        lambda t: panels(t.spheres, "bisect"),
        "panels: edges must be one of 'bisector', 'intersection', 'axis', not 'bisect': did "
        "you mean 'bisector'?",
    ),
    (
        lambda t: panels(t.spheres, thicknes=0.02),
        "panels has no input 'thicknes'; did you mean 'thickness'?",
    ),
    (lambda _: panels(thickness=0.02), "panels misses sphere_mesh (SphereMesh)"),
    (
        lambda t: panels(t.spheres, sphere_mesh=t.spheres),
        "panels: sphere_mesh is given twice, in place and by name",
    ),
    (
        lambda t: panels(t.spheres, labels="moulds"),
        "panels: labels must be labels of faces (F,) or None, not 'moulds'",
    ),
    (
        lambda t: minimize_angles(t.spheres, edge_weights=np.ones((3, 3))),
        "minimize_angles: edge_weights must be weights of edges (E,) or None, not float64 "
        "array of shape (3, 3)",
    ),
    (lambda t: cluster_radii(t.spheres, k=2.5), "cluster_radii: k must be int, not 2.5"),
    (
        lambda t: cluster_radii(t.spheres, k=Graph().param("k", 3)),
        "cluster_radii: k must be int, not Param: in a graph call graph.add(cluster_radii, "
        "k=...)",
    ),
    (
        lambda t: panels(t.spheres, thickness=-0.02),
        "panels: thickness = -0.02: must be at least 0",
    ),
    (
        lambda t: audit(t.spheres),
        "audit: panels must be Panels or None, not SphereMesh: make one with "
        "panels(...).panels",
    ),
    (
        lambda t: write_view(t.spheres),
        "write_view: panels must be Panels or None, not SphereMesh: give it as reference=..., "
        "or make one with panels(...).panels",
    ),
    (
        lambda t: write_mesh(t.cut.panels, "panels.obj"),
        "write_mesh: mesh must be Mesh or SphereMesh, not Panels",
    ),
    (lambda _: read_mesh(3), "read_mesh: path must be"),
]


@pytest.mark.parametrize(("call", "said"), MISTAKES, ids=[said for _, said in MISTAKES])
def test_a_wrong_argument_is_one_line_that_names_the_right_call(
    call: Callable[[Any], object], said: str
) -> None:
    with pytest.raises(ArgumentError) as caught:
        call(things())
    assert str(caught.value).startswith(said)
    assert "\n" not in str(caught.value)
    if not said.endswith("must be"):
        assert str(caught.value) == said
    assert isinstance(caught.value, TypeError)
    assert isinstance(caught.value, InputError)


def test_there_are_at_least_twenty() -> None:
    assert len(MISTAKES) >= 20


def test_too_many_arguments_are_told_by_name() -> None:
    with pytest.raises(
        ArgumentError, match=r"fit_spheres takes at most 2 inputs without a name"
    ):
        fit_spheres(things().mesh, 1, 2)
    with pytest.raises(
        ArgumentError, match=r"not \d+: panels, path, .*; by name only: .*legend"
    ):
        render(things().cut.panels, *range(30))


def test_lists_become_the_arrays_that_functions_expect() -> None:
    labels = [0, 1] * 24
    made = panels(things().spheres, labels=labels).panels
    assert made.labels.tolist() == labels
    assert panels(things().spheres, thickness=np.float64(0.5)).panels.thickness == 0.5


def test_the_function_is_the_one_of_the_library_with_checks_around_it() -> None:
    assert fit_spheres.__wrapped__ is unchecked
    assert find_node(fit_spheres) is find_node(unchecked) is find_node("fit_spheres")
    assert pickle.loads(pickle.dumps(fit_spheres)) is fit_spheres  # noqa: S301
    assert fit_spheres.__doc__ == unchecked.__doc__


def test_the_checks_take_microseconds() -> None:
    """Some five of the processor's on a quiet machine."""
    record = find_node("panels")

    @wraps(record.function)
    def nothing(*_: object, **__: object) -> None: ...

    call = checked(replace(record, function=nothing))
    spheres = things().spheres

    def seconds(function: Callable[..., object]) -> float:
        run = timeit.Timer(
            lambda: function(spheres, edges="bisector", thickness=0.02), timer=process_time
        )
        return min(run.repeat(9, 500)) / 500

    assert seconds(call) < 60e-6 + 200 * seconds(nothing)
