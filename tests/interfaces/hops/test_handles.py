"""Handles: equal for equal values, good after a restart where the store is on disk."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import pytest

from spheremesh.interfaces.hops import solving
from spheremesh.interfaces.hops.handles import Handles
from spheremesh.nodes import DiskStore, MemoryStore, fit_spheres, vase_mesh
from spheremesh.nodes.graphs.stores.digests import digest

pytestmark = pytest.mark.filterwarnings("ignore::spheremesh.nodes.NodeWarning")
Value: TypeAlias = Any


def test_equal_values_have_equal_handles() -> None:
    handles = Handles(MemoryStore())
    first, second = (handles.give("sphere_mesh", fit_spheres(vase_mesh(n, 4))) for n in (6, 7))
    assert first != second
    assert first == handles.give("sphere_mesh", fit_spheres(vase_mesh(6, 4)))
    assert digest(handles.take(first, "here")) == digest(fit_spheres(vase_mesh(6, 4)))


def test_a_handle_is_good_after_a_restart(opened: Callable[..., Any], tmp_path: Path) -> None:
    before = opened(DiskStore(tmp_path / "cache"))
    mesh = before.gh.solve("vase_mesh", n_around=8, n_across=4)["mesh"]
    handle = before.gh.solve("fit_spheres", mesh=mesh)["sphere_mesh"]
    assert before.gh.status == 200  # so the client may keep it
    wanted = before.gh.solve("minimize_angles", sphere_mesh=handle)["report"]
    before.service.jobs.close()
    after = opened(DiskStore(tmp_path / "cache"))
    report = after.gh.solve("minimize_angles", sphere_mesh=handle)["report"]
    assert report == wanted


def test_without_a_disk_an_answer_with_handles_is_not_kept(gh: Value) -> None:
    mesh = gh.solve("vase_mesh", n_around=8, n_across=4)["mesh"]
    assert gh.status == 200
    gh.solve("fit_spheres", mesh=mesh)
    assert gh.status == 203
    gh.solve("show", handle="[[0, 1, 2], [3, 4, 5]]")
    assert gh.status == 200


def test_only_what_lasts_may_be_kept(opened: Callable[..., Any], tmp_path: Path) -> None:
    one = opened(DiskStore(tmp_path / "cache"))
    lasting = one.service.solver.handles
    assert lasting.lasts(lasting.give("sphere_mesh", fit_spheres(vase_mesh(6, 4))))
    assert not lasting.lasts(lasting.give("object", object()))
    assert not Handles(MemoryStore()).lasts("spheremesh:sphere_mesh:0")


def test_reports_keep_what_json_has_no_word_for(opened: Callable[..., Any]) -> None:
    one = opened()
    sphere_mesh = fit_spheres(vase_mesh(8, 4))
    handle = one.service.solver.handles.give("sphere_mesh", sphere_mesh)
    made = one.gh.solve("panels", sphere_mesh=handle)
    audit = one.gh.solve("audit", panels=made["panels"], cut=made["report"])
    other = opened()  # where the text is all that there is
    panels = other.gh.solve("panels", sphere_mesh=other.service.solver.handles.give(
        "sphere_mesh", sphere_mesh))["panels"]  # fmt: skip
    assert (
        other.gh.solve("audit", panels=panels, cut=made["report"])["report"] == audit["report"]
    )


def test_what_has_no_content_is_known_by_its_number() -> None:
    handles = Handles(MemoryStore())
    thing = object()
    text = handles.give("object", thing)
    assert text == "spheremesh:object:here-1"
    assert handles.take(text, "here") is thing
    for _ in range(300):
        handles.give("object", object())
    with pytest.raises(ValueError, match="here: this handle is no longer known"):
        handles.take(text, "here")


def test_a_handle_shows_all_that_it_stands_for(
    opened: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(solving, "Exchange", partial(solving.Exchange, most_shown=30))
    one = opened()
    give = one.service.solver.handles.give
    mesh = vase_mesh(8, 4)
    many = one.gh.solve("face_planes", mesh=one.gh.solve(
        "vase_mesh", n_around=8, n_across=4)["mesh"])  # fmt: skip
    assert many["spheres"] == []
    assert "32 panels are not shown unasked (30 at most)" in one.gh.warnings[0]
    shown = one.gh.solve("show", handle=many["sphere_mesh"])
    assert (len(shown["breps"]), len(shown["mesh"])) == (mesh.n_faces, 1)
    assert one.gh.warnings == []
    points = one.gh.solve("show", handle=give("points", np.eye(3)))
    assert len(points["points"]) == 3
    assert points["breps"] == points["curves"] == points["mesh"] == []
