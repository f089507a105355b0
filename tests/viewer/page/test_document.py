"""The page as a file: what is in it, how exact and how large it is."""

import base64
import gzip
import hashlib
import itertools
import json
import re
import time
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from spheremesh.fabrication.schedules.columns import beam_columns, panel_columns
from spheremesh.fabrication.schedules.panels import panel_tables
from spheremesh.kernel.arrays import dot, norm, unit
from spheremesh.kernel.beams.beams import Beams
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.panels.panels import Panels, opposite_corners
from spheremesh.kernel.parts.findings import Finding
from spheremesh.kernel.parts.records import select_parts
from spheremesh.kernel.sphere_meshes.fit import face_planes, fit_spheres
from spheremesh.kernel.spheres.rows import center_radius
from spheremesh.kernel.surfaces.circular_nets import ellipsoid_net, vase_net
from spheremesh.nodes import beams as cut_beams
from spheremesh.nodes import bisector_support
from spheremesh.viewer.page.container import unpack_arrays
from spheremesh.viewer.page.document import PageTexts, page_data, page_text
from spheremesh.viewer.page.faces import panel_faces
from spheremesh.viewer.page.grid import STEPS, grid_about

PAGE = Path(__file__).parents[3] / "viewer" / "page"


def texts(panels: Panels | None, beams: Beams | None = None, **more: object) -> PageTexts:
    columns = panel_columns(panels, "m"), beam_columns(beams, panels, "m")
    return PageTexts(more.pop("title", "Roof"), *columns, **more)


def vase(**options: object) -> Panels:
    return cut_panels(fit_spheres(vase_net(12, 6, 1.0, 2.0, 0.3)), **options)[0]


def field(page: str, name: str) -> bytes:
    text = re.search(f'<script id="{name}" [^>]*>([^<]*)</script>', page)
    assert text is not None
    return gzip.decompress(base64.b64decode(text[1]))


def model_of(page: str) -> tuple[dict, dict[str, np.ndarray]]:
    return unpack_arrays(field(page, "model"))


def test_bundle_was_made_of_this_source() -> None:
    digest = hashlib.sha256()
    source = PAGE / "source"
    names = sorted(
        path.name
        for path in source.iterdir()
        if path.suffix in {".js", ".mjs", ".css", ".html", ".json"}
    )
    for name in names:
        digest.update(f"{name}\n{(source / name).read_text(encoding='utf-8')}\n".encode())
    known = (PAGE / "bundle" / "source.sha256").read_text(encoding="utf-8").strip()
    assert digest.hexdigest() == known, "run `npm run build` in viewer/page/source"


def test_sources_name_no_registry() -> None:
    lock = json.loads((PAGE / "source" / "package-lock.json").read_text(encoding="utf-8"))
    assert all("resolved" not in package for package in lock["packages"].values())


def test_script_keeps_the_licence_of_three() -> None:
    script = (PAGE / "bundle" / "page.js").read_text(encoding="utf-8")
    assert "The MIT License" in script[:400]
    assert "three.js authors" in script[:400]
    assert "</script" not in script.lower()


def test_page_asks_for_nothing() -> None:
    page = page_text(vase(), None, texts(vase()))
    assert "default-src 'none'" in page
    shell = re.sub(r"<script id=[^>]*>[^<]*</script>", "", page)
    for word in ("http:", "https:", "src=", "url(", "@import", "<link", "fetch("):
        assert word not in shell, word
    assert "{{" not in shell


def test_names_cannot_leave_their_place() -> None:
    title = '"><script>alert(1)</script> Dächer & {{model}} 屋根'
    made = vase()
    found = [Finding("P201", made.ids[0], "</script><b>'\"")]
    page = page_text(made, None, texts(made, title=title, findings=found))
    assert "alert(1)</script>" not in page
    assert page.count("<script") == 3
    head, _ = model_of(page)
    assert head["title"] == title
    assert head["findings"] == [["P201", made.ids[0], "error", "</script><b>'\"", None]]


def test_equal_models_give_equal_pages() -> None:
    assert page_text(vase(), None, texts(vase())) == page_text(vase(), None, texts(vase()))


@pytest.mark.parametrize("thickness", [0.0, 0.05])
@pytest.mark.parametrize("place", [0.0, 1e6])
def test_normals_of_a_page_are_those_of_the_spheres(thickness: float, place: float) -> None:
    """The formula of the shader, in single precision, against centres of spheres."""
    net = ellipsoid_net(16, 10, 2.0, 1.5, 1.2)
    moved = type(net)(net.vertices + place, net.faces)
    made, _ = cut_panels(fit_spheres(moved), thickness=thickness)
    _, arrays = unpack_arrays(page_data(made, None, texts(made)))
    centers = center_radius(made.spheres)[0] + made.origins
    for side in ("outer", "inner") if thickness else ("outer",):
        points = (arrays[f"{side}_points"] / STEPS).astype(np.float32)
        counts = arrays[f"{side}_sizes"][arrays[f"{side}_kinds"], 0]
        owners = np.repeat(np.arange(made.n_panels), counts)
        outer = (arrays["outer_points"] / STEPS).astype(np.float32)
        sizes = arrays["outer_sizes"][arrays["outer_kinds"], 0]
        first = outer[np.cumsum(sizes) - sizes][owners]
        bend = 2 * arrays["curvatures"][owners, None]
        found = unit((arrays["normals"][owners] - bend * (points - first)).astype(float))
        grid = grid_about(*(each.points for each in panel_faces(made)))
        exact = points * grid.size + (grid.center - centers[owners])
        exact = unit(exact) * -np.sign(made.spheres[owners, :1])
        assert float(norm(np.cross(found, exact)).max()) < 1e-5
        assert (dot(found, exact) > 0).all()


def test_neighbours_meet_to_the_bit() -> None:
    """Points along a common edge are those of the neighbour, in whole steps of the grid."""
    made = vase(edges="intersection", thickness=0.03)
    _, arrays = unpack_arrays(page_data(made, None, texts(made)))
    sizes, kinds = arrays["outer_sizes"][:, 0], arrays["outer_kinds"]
    ends = np.cumsum(sizes[kinds])
    steps = arrays["outer_rims"].reshape(len(sizes), 4)[kinds]
    points = arrays["outer_points"].tolist()
    rims: list[list[tuple[int, ...]]] = []
    for end, counts in zip(ends.tolist(), steps.tolist(), strict=True):
        ring = [tuple(point) for point in points[end - sum(counts) : end]]
        starts = np.cumsum([0, *counts]).tolist()
        ring.append(ring[0])
        rims += [ring[a : b + 1] for a, b in itertools.pairwise(starts)]
    known = {tuple(rim) for rim in rims}
    twins = [tuple(reversed(rim)) in known for rim in rims]
    assert twins == (opposite_corners(made) >= 0).tolist()


def test_a_page_is_small_and_soon_written() -> None:
    net = ellipsoid_net(60, 30, 2.0, 1.5, 1.2)
    spheres = fit_spheres(net)
    made, _ = cut_panels(spheres, thickness=0.01)
    carried = cut_beams(bisector_support(spheres, depth=0.02).annuli, thickness=0.004).beams
    began = time.process_time()
    page = page_text(made, carried, texts(made, carried))
    assert time.process_time() - began < 2
    # A share for the script, and for each panel with its beams that of 4 MB for 5,000.
    assert len(page) < 250_000 + 800 * made.n_panels
    script = base64.b64encode(gzip.compress(field(page, "code"), 6))
    assert len(script) < 250_000


def test_missing_panels_are_outlined_and_named() -> None:
    net = vase_net(12, 6, 1.0, 2.0, 0.3)
    made, _ = cut_panels(fit_spheres(net))
    keep = np.ones(made.n_panels, bool)
    keep[[3, 40]] = False
    left = select_parts(made, keep)
    rejected = [{"id": "P0003", "code": "P100", "reason": "crosses itself"}]
    found = [
        Finding("P100", "P0003", "cannot be made: crosses itself"),
        Finding("B101", "B0007", "cannot be made: its ends cross"),
    ]
    about = texts(left, rejected=rejected, findings=found)
    head, arrays = unpack_arrays(page_data(left, None, about, net))
    missing = {part["id"]: part for part in head["missing"]}
    assert {name: (m["code"], m["reason"], m["corners"]) for name, m in missing.items()} == {
        "P0003": ("P100", "crosses itself", 4),
        "P0040": ("P100", "cannot be made", 4),
        "B0007": ("B101", "its ends cross", 2),
    }
    assert arrays["missing"].shape == (10, 3)
    # Beside it are the panels that miss it, each along one edge.
    for name in ("P0003", "P0040"):
        edges = missing[name]["edges"]
        assert {left.ids[row] for row, _ in edges} == set(missing[name]["beside"])
        for row, edge in edges:
            neighbor = left.neighbors[left.offsets[row] + edge]
            assert name == f"P{neighbor:04d}"
    sides = net.topology.edge_faces[7]
    assert missing["B0007"]["beside"] == [f"P{face:04d}" for face in sides if face >= 0]


def test_planes_and_few_panels_make_pages() -> None:
    made, _ = cut_panels(face_planes(vase_net(6, 4, 1.0, 2.0, 0.3)), thickness=0.1)
    head, arrays = unpack_arrays(page_data(made, None, texts(made)))
    assert_allclose(arrays["curvatures"], 0)
    assert head["panels"]["radius_mm"] == [None] * made.n_panels


def test_columns_are_those_of_the_schedule() -> None:
    made = vase(thickness=0.05, labels=np.arange(72) % 3)
    found = panel_columns(made, "m")
    rows = panel_tables(made, "m")["Panels"]
    for key in ("id", "mould", "bulge"):
        assert found[key] == [row[key] for row in rows]
    for key in ("radius_mm", "area_m2", "size_mm", "edge_lengths_mm"):
        assert_allclose(found[key], [row[key] for row in rows], rtol=1e-3)
    names = [[None if i is None else made.ids[i] for i in each] for each in found["neighbors"]]
    assert names == [row["neighbors"] for row in rows]


def test_nothing_to_show_is_refused() -> None:
    with pytest.raises(InputError, match="no panels or beams to show"):
        page_data(None, None, texts(None))


def test_a_mesh_of_other_panels_is_refused() -> None:
    other = vase_net(4, 3, 1.0, 2.0, 0.3)
    with pytest.raises(InputError, match="too few for the panels"):
        page_data(vase(), None, texts(vase()), other)
