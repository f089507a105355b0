"""What a mesh is, whether or not it is one yet, and what can be done with it."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Final

import numpy as np

from ..arrays import FloatArray, IntArray
from ..errors import InputError
from ..meshes.creases import crease_edges, edge_turns
from ..meshes.curvature import principal_curvatures
from ..meshes.mesh import Mesh, mean_edge_length, shortest_edge
from ..meshes.triangulation import triangulate
from ..reports import Report
from ..solvers.weighted_graphs import piece_labels
from ..sphere_meshes.planarity_circularity import circularity, planarity
from ..tolerances import CIRCULAR, CREASE, PLANAR
from .faces import usable_faces
from .pipeline import RepairReport, repair, repair_counts, repair_words
from .raw_mesh import RawMesh, keep_faces

_POLYGONS: Final = {
    "3": ("triangle", "triangles"),
    "4": ("quad", "quads"),
    "5": ("pentagon", "pentagons"),
    "6": ("hexagon", "hexagons"),
}


@dataclass(frozen=True, eq=False)
class MeshReport(Report):
    """What a mesh is. Lengths are in model units.

    Attributes
    ----------
    is_mesh : bool
        Whether the faces are an orientable manifold mesh as they are.
    problem : str
        Why they are none; empty if they are. What follows is then of the repaired mesh.
    repair : dict
        How often each kind of repair has something to do, as named in `RepairReport`.
    vertices, faces : int
        As they are given.
    faces_by_degree : dict
        Number of faces by their number of corners, as text.
    unwelded_vertices : int
        Vertices that lie on others within the tolerance.
    t_junctions : int
        Vertices on an edge of a face that are no corner of it.
    size : list of float
        Extent along x, y and z.
    pieces, boundary_loops : int
        Connected parts, and closed lines of edges with one face.
    lone_faces : int
        Faces without a neighbour.
    mean_edge, shortest_edge : float
    planarity, circularity : dict or None
        ``max`` and ``mean`` distance of the corners of faces from a plane and a circle, and
        ``relative_to_edge``, the largest in mean edges; None if a face has no area.
    umbilicity : float or None
        Median over the vertices of ``|k1 - k2| / max(|k1|, |k2|)``: 0 on spheres, 1 on
        cylinders, 2 on minimal surfaces; None if no vertex has curvatures.
    crease_edges : int
        Edges at which the faces meet at more than 40 degrees.
    sharpest_edge_deg : float
    suits : list of str
        Nodes that take this mesh as it is, or as `repair_mesh` returns it.
    advice : list of str
        What cannot be done with it, why, and what else would do.
    """

    is_mesh: bool
    problem: str
    repair: dict[str, int]
    vertices: int
    faces: int
    faces_by_degree: dict[str, int]
    unwelded_vertices: int
    t_junctions: int
    size: list[float]
    pieces: int
    boundary_loops: int
    lone_faces: int
    mean_edge: float
    shortest_edge: float
    planarity: dict[str, float] | None
    circularity: dict[str, float] | None
    umbilicity: float | None
    crease_edges: int
    sharpest_edge_deg: float
    suits: list[str]
    advice: list[str]


def describe(raw: RawMesh) -> MeshReport:
    """What faces are, and what they want.

    Returns
    -------
    MeshReport
        Of faces of which no repair makes a mesh only the counts and the problem are known.
    """
    usable = keep_faces(raw, usable_faces(raw))
    mesh, problem = _as_it_is(raw)
    repaired, done, failure = _repaired(raw)
    if mesh and usable.n_faces < raw.n_faces:
        mesh, problem = None, "coordinates are beyond 1e100; export the mesh again"
    points = usable.vertices[usable.corners]
    size = np.ptp(points, axis=0).tolist() if len(points) else [0.0, 0.0, 0.0]
    degrees, counts = np.unique(raw.degrees, return_counts=True)
    measured = mesh or repaired
    facts = _NO_FACTS if measured is None else _facts(measured)
    return MeshReport(
        is_mesh=mesh is not None,
        problem=problem or ("" if mesh else failure),
        repair={} if done is None else repair_counts(done),
        vertices=len(raw.vertices),
        faces=raw.n_faces,
        faces_by_degree={
            str(degree): count
            for degree, count in zip(degrees.tolist(), counts.tolist(), strict=True)
        },
        unwelded_vertices=_unwelded(done),
        t_junctions=0 if done is None else len(done.t_junctions),
        size=size,
        **asdict(facts),
        suits=[] if measured is None else _suits(measured),
        advice=[failure] if measured is None else _advice(measured, facts, done),
    )


def size_words(report: Mapping[str, Any], unit: str) -> str:
    """How large a mesh is, in a unit.

    Parameters
    ----------
    report : mapping
        A `MeshReport`, or what was read of one from a file.
    unit : str
        The unit that is assumed.

    Returns
    -------
    str
        Such as ``38.2 x 12.1 x 6.4 m, mean edge 1.21 m``.
    """
    extents = " x ".join(f"{length:.3g}" for length in report["size"])
    return f"{extents} {unit}, mean edge {report['mean_edge']:.3g} {unit}"


def describe_lines(report: Mapping[str, Any]) -> tuple[str, ...]:
    """What a mesh is in a line, and what a repair would do in another.

    Parameters
    ----------
    report : mapping
        A `MeshReport`, or what was read of one from a file.
    """
    kinds = [
        _number(count, *_POLYGONS.get(degree, ("face", "faces")))
        + ("" if degree in _POLYGONS else f" of {degree} corners")
        for degree, count in report["faces_by_degree"].items()
    ]
    parts = [
        ", ".join(kinds[:4]) + (" and others" if len(kinds) > 4 else ""),
        _number(report["pieces"], "piece", "pieces"),
        _number(report["boundary_loops"], "boundary loop", "boundary loops"),
    ]
    if report["crease_edges"]:
        parts.append(_number(report["crease_edges"], "crease edge", "crease edges"))
    lines = ["; ".join(parts)]
    if report["repair"]:
        lines.append(f"--repair would {repair_words(report['repair'], is_done=False)}")
    return tuple(lines)


def _number(count: int, one: str, more: str) -> str:
    return f"{count or 'no'} {one if count == 1 else more}"


def _as_it_is(raw: RawMesh) -> tuple[Mesh | None, str]:
    try:
        return Mesh(raw.vertices, np.split(raw.corners, raw.offsets[1:-1])), ""
    except InputError as error:
        return None, str(error)


def _repaired(raw: RawMesh) -> tuple[Mesh | None, RepairReport | None, str]:
    try:
        mesh, report = repair(raw)
    except InputError as error:
        return None, None, str(error)
    return mesh, report, ""


def _unwelded(done: RepairReport | None) -> int:
    return 0 if done is None else sum(len(group) - 1 for group in done.welded_vertices)


@dataclass(frozen=True)
class _Facts:
    """Measures of a mesh, as in `MeshReport`."""

    pieces: int
    boundary_loops: int
    lone_faces: int
    mean_edge: float
    shortest_edge: float
    planarity: dict[str, float] | None
    circularity: dict[str, float] | None
    umbilicity: float | None
    crease_edges: int
    sharpest_edge_deg: float


_NO_FACTS = _Facts(0, 0, 0, 0.0, 0.0, None, None, None, 0, 0.0)


def _facts(mesh: Mesh) -> _Facts:
    topology, edge = mesh.topology, mean_edge_length(mesh)
    has_neighbour = np.zeros(mesh.n_faces, bool)
    has_neighbour[topology.edge_faces] = True
    turns = edge_turns(mesh)
    rim = np.flatnonzero(topology.twins < 0)
    rim_ends = np.stack([mesh.corners, mesh.corners[topology.next_corners]], 1)[rim]
    return _Facts(
        pieces=_n_components(mesh.n_faces, topology.edge_faces),
        boundary_loops=_n_components(mesh.n_vertices, rim_ends)
        - (mesh.n_vertices - len(np.unique(rim_ends))),
        lone_faces=int((~has_neighbour).sum()),
        mean_edge=edge,
        shortest_edge=shortest_edge(mesh),
        planarity=_distances(planarity(mesh), edge),
        circularity=_circularity(mesh, edge),
        umbilicity=_umbilicity(mesh) if edge else None,
        crease_edges=int(crease_edges(mesh, CREASE).sum()),
        sharpest_edge_deg=float(np.degrees(turns.max(initial=0.0))),
    )


def _n_components(size: int, links: IntArray) -> int:
    return int(piece_labels(links[:, 0], links[:, 1], size).max(initial=-1)) + 1


def _distances(values: FloatArray, edge: float) -> dict[str, float] | None:
    if not edge or not np.isfinite(values).all():
        return None
    largest = float(values.max())
    mean = float(values.mean())
    return {"max": largest, "mean": mean, "relative_to_edge": largest / edge}


def _circularity(mesh: Mesh, edge: float) -> dict[str, float] | None:
    try:
        return _distances(circularity(mesh), edge)
    except InputError:
        return None


def _umbilicity(mesh: Mesh) -> float | None:
    try:
        surface = mesh if (mesh.degrees <= 4).all() else triangulate(mesh)
        first, second, is_fitted = principal_curvatures(surface)
    except InputError:
        return None
    largest = np.maximum(np.abs(first), np.abs(second))
    is_curved = is_fitted & (largest > 0)
    if not is_curved.any():
        return None
    return float(np.median((first - second)[is_curved] / largest[is_curved]))


def _suits(mesh: Mesh) -> list[str]:
    """Nodes for a mesh of these faces."""
    result = ["fit_spheres", "minimize_angles", "panels", "triangulate", "subdivide"]
    degrees = set(mesh.degrees.tolist())
    if degrees == {3}:
        result += ["remesh_triangles", "evolve_spheres", "model_change", "sphere_bundle"]
    else:
        result += ["optimize_spheres", "support_structure"]
    return result


def _advice(mesh: Mesh, facts: _Facts, done: RepairReport | None) -> list[str]:
    found: list[str] = []
    if done is not None and repair_counts(done):
        counts = repair_counts(done)
        found.append(f"repair_mesh (--repair) would {repair_words(counts, is_done=False)}")
    if facts.lone_faces:
        found.append(
            f"faces without a neighbour: {facts.lone_faces} of {mesh.n_faces}; their panels "
            "are flat, and no beams run between them"
        )
    if (mesh.degrees == 3).all() and mesh.n_faces > 1:
        found.append(
            "triangles cannot carry torsion-free supports (Lemma 5.1): use quads (p4_remesh), "
            "hexagons (tangent_sphere_shex), model_change or sphere_bundle for beams"
        )
    flat, round_ = facts.planarity, facts.circularity
    if flat is None or round_ is None:
        found.append("faces without area have no sphere: remove them")
    elif flat["relative_to_edge"] > PLANAR:
        found.append("faces are not planar: corners of panels leave the design a little")
    elif round_["relative_to_edge"] > CIRCULAR:
        found.append("faces are planar but have no circle: spheres miss some of their corners")
    if facts.crease_edges:
        found.append(
            f"edges that turn by more than 40 degrees: {facts.crease_edges}; they stay sharp, "
            "and spheres are smooth up to them (--crease)"
        )
    return found
