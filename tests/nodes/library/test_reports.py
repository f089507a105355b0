"""Reports are records of their own kinds, and mappings: a wrong wire is refused when wired."""

import json
import pickle
from collections.abc import Mapping

import pytest

import spheremesh as sm
from spheremesh.kernel.reports import Report
from spheremesh.nodes import GraphError, find_node, fit_spheres, minimize_angles, roof_mesh

# The node behind each report, how its inputs are wired, and its output.
SOURCES = {
    "minimize_angles": ({"sphere_mesh": "fit_spheres.result"}, "report"),
    "optimize_spheres": ({"sphere_mesh": "fit_spheres.result"}, "report"),
    "panels": ({"sphere_mesh": "fit_spheres.result"}, "report"),
    "cluster_radii": ({"sphere_mesh": "fit_spheres.result", "k": 3}, "report"),
    "mould_blanks": ({"panels": "panels.panels"}, "result"),
    "identical_panels": ({"panels": "panels.panels"}, "report"),
    "cost": ({"panels": "panels.panels", "prices": {"panels": {"each": 1.0}}}, "result"),
    "support_structure": ({"sphere_mesh": "fit_spheres.result"}, "report"),
    "annulus_support": ({"sphere_mesh": "fit_spheres.result"}, "report"),
    "land_nodes": ({"sphere_mesh": "fit_spheres.result"}, "report"),
    "beams": ({"annuli": "annulus_support.annuli"}, "report"),
    "drilling_marks": ({"beams": "beams.beams"}, "report"),
    "audit": ({"panels": "panels.panels"}, "report"),
    "angle_histogram": ({"sphere_mesh": "fit_spheres.result"}, "result"),
}
FITTING = {
    "optimum": ("minimize_angles", "optimize_spheres"),
    "cut": ("panels",),
    "moulds": ("cluster_radii",),
    "blanks": ("mould_blanks",),
    "audit": ("audit",),
    "nodes": ("support_structure",),
    "annuli": ("annulus_support",),
    "beams": ("beams",),
    "landing": ("land_nodes",),
    "annuli_report": ("annulus_support",),
    "beams_report": ("beams", "drilling_marks"),  # older graphs wire either
    "feasibility": (),
    "plain": ("panels",),
    "cost": ("cost",),
}
PLACES = [
    (node, name)
    for node in ("audit", "panel_report")
    for name, port in find_node(node).inputs.items()
    if "Report" in str(port.type)
]


@pytest.fixture
def graph() -> sm.Graph:
    graph = sm.Graph()
    graph.add("fit_spheres", mesh=graph.add("roof_mesh"))
    for node, (inputs, _) in SOURCES.items():
        wired = {
            name: _wire(graph, given) if isinstance(given, str) else given
            for name, given in inputs.items()
        }
        graph.add(node, **wired)
    return graph


def _wire(graph: sm.Graph, target: str) -> object:
    step, _, output = target.partition(".")
    return getattr(graph.steps[step], output)


def test_every_input_that_is_a_report_is_tried() -> None:
    assert {name for _, name in PLACES} == set(FITTING)
    assert len(PLACES) == 3 + 12


@pytest.mark.parametrize(("node", "name"), PLACES)
def test_only_its_own_kind_of_report_is_wired(graph: sm.Graph, node: str, name: str) -> None:
    needed = {
        "sphere_mesh": _wire(graph, "fit_spheres.result"),
        "optimum": _wire(graph, "minimize_angles.report"),
        "cut": _wire(graph, "panels.report"),
    }
    for i, (source, (_, output)) in enumerate(SOURCES.items()):
        inputs = (needed if node == "panel_report" else {}) | {
            name: _wire(graph, f"{source}.{output}")
        }
        if source in FITTING[name]:
            graph.add(node, f"fits{i}", **inputs)
        else:
            with pytest.raises(GraphError, match=rf"cannot wire {source}.*\.{name} "):
                graph.add(node, f"fails{i}", **inputs)


def test_no_output_is_just_a_mapping() -> None:
    for name in sm.nodes.__all__:
        if name in sm.nodes.REGISTRY:
            for port in find_node(name).outputs.values():
                kind = port.type
                if isinstance(kind, type) and issubclass(kind, Mapping):
                    assert issubclass(kind, Report), name
                    assert kind is not Report, name


def test_a_report_reads_like_a_dictionary_and_cannot_be_changed() -> None:
    report = minimize_angles(fit_spheres(roof_mesh(6, 8))).report
    names = [
        "converged", "iterations", "energies", "angles_deg", "vertex_error", "creases",
        "circle_miss", "taken_back",
    ]  # fmt: skip
    assert list(report) == list(report.keys()) == list(dict(report)) == names
    assert len(report) == 8
    assert "angles_deg" in report
    assert "__len__" not in report
    assert report.get("stages") is None
    with pytest.raises(KeyError, match="stages"):
        report["stages"]
    assert report == dict(report)
    assert json.loads(json.dumps(dict(report))) == report == pickle.loads(pickle.dumps(report))  # noqa: S301
    with pytest.raises(AttributeError):
        report.converged = False
    with pytest.raises(TypeError):
        report["converged"] = False


def test_a_graph_of_before_the_reports_had_types_runs() -> None:
    graph = sm.Graph()
    fitted = graph.add("face_planes", mesh=graph.add("torus_mesh", n_around=8, n_across=6))
    annuli = graph.add("annulus_support", sphere_mesh=fitted, depth=0.3)
    cut = graph.add("beams", annuli=annuli.annuli, thickness=0.05)
    marked = graph.add("drilling_marks", beams=cut.beams)
    graph.add("audit", beams=marked.beams, beams_report=marked.report)
    graph.add("audit", "same", beams=marked.beams)
    again = sm.Graph.from_json(graph.to_json())
    assert again.run("audit.report") == again.run("same.report")


def test_a_report_may_be_given_as_plain_values() -> None:
    graph = sm.Graph()
    fitted = graph.add("fit_spheres", mesh=graph.add("vase_mesh", n_around=8, n_across=3))
    made = graph.add("panels", sphere_mesh=fitted)
    report = graph.run(made.report)
    plain = json.loads(json.dumps(dict(report)))
    graph.add("audit", "wired", panels=made.panels, cut=made.report)
    graph.add("audit", "plain", panels=made.panels, cut=plain)
    graph.add("audit", "record", panels=made.panels, cut=report)
    again = sm.Graph.from_json(graph.to_json())
    results = again.run("wired.report", "plain.report", "record.report")
    assert results[0] == results[1] == results[2]
    wrong = {**plain, "wirtten": plain["written"]}
    del wrong["written"]
    with pytest.raises(
        GraphError,
        match=r"audit\.cut = .*: must be CutReport or None: CutReport misses 'written', has no "
        "entry 'wirtten'",
    ):
        graph.add("audit", panels=made.panels, cut=wrong)
