"""Hexagonal sphere meshes: spheres that touch a triangulation, met by their neighbours."""

from dataclasses import dataclass
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np

from ...kernel.congruences import curvature_spheres as congruence
from ...kernel.errors import name_ids
from ...kernel.hexagons import dual_sphere_mesh as shex
from ...kernel.hexagons import evolution, face_shapes
from ...kernel.hexagons import shifted_rows as grids
from ...kernel.meshes.mesh import Mesh, mean_edge_length
from ...kernel.reports import Report
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...kernel.sphere_meshes.sphere_mesh import vertex_error as vertex_errors
from ...kernel.tolerances import AXIS_SLACK
from ..graphs.node import node, warn
from ..graphs.ports import Port
from .arrays import FaceShapes, Names, Numbers, VertexDistances, VertexSpheres


@dataclass(frozen=True, eq=False)
class EvolutionReport(Report):
    """How spheres grew.

    Attributes
    ----------
    converged : bool
    iterations, flips : int
    side : {"plus", "minus"}
    axis_angle_deg : dict
        Between node axes and normals: ``median``, ``p95`` and ``max``.
    lambda_over_rho : dict
        Share of the smallest curvature radius that the spheres reach: ``mean`` and ``min``.
    valences, irregular : dict
        Number of the inner vertices of each valence, and the ids of those that are not of 6.
    bad_faces : list of dict
        ``vertex`` and ``reason`` of each face that is missing or not convex.
    tilted_triangles : list of int
        Those whose axis is beyond the bound.
    outer_vertices : list of int
        Where the surface bends away from the centres.
    """

    converged: bool
    iterations: int
    flips: int
    side: str
    axis_angle_deg: dict[str, float]
    lambda_over_rho: dict[str, float]
    valences: dict[str, int]
    irregular: dict[str, list[int]]
    bad_faces: list[dict[str, Any]]
    tilted_triangles: list[int]
    outer_vertices: list[int]


@dataclass(frozen=True, eq=False)
class HexagonsReport(Report):
    """Faces of a dual sphere mesh, and those that cannot be made.

    Attributes
    ----------
    faces, convex, bow_tie, crossing : int
        Number of all faces and of each shape.
    imaginary : int
        Vertices that are not real.
    degrees : dict
        Number of faces of each degree.
    left_out : list of dict
        ``vertex`` and ``reason`` of each face that cannot be made.
    crossing_faces, far_corners : list of dict
        ``face`` and ``vertex``; corners are far from their triangle beyond an obtuse one on
        the boundary.
    vertex_error : dict
        ``max`` in model units and ``relative_to_edge``, the mean edge.
    vertex_ids : list of int
        The vertex of each face.
    """

    faces: int
    convex: int
    bow_tie: int
    crossing: int
    imaginary: int
    degrees: dict[str, int]
    left_out: list[dict[str, Any]]
    crossing_faces: list[dict[str, int]]
    far_corners: list[dict[str, int]]
    vertex_error: dict[str, float]
    vertex_ids: list[int]


class EvolvedSpheres(NamedTuple):
    """A triangulation with flipped edges, spheres at its vertices, and how they grew."""

    mesh: Mesh
    spheres: VertexSpheres
    report: EvolutionReport


class Hexagons(NamedTuple):
    """A sphere mesh dual to a triangulation, and what was found while making it."""

    sphere_mesh: SphereMesh
    report: HexagonsReport


@node
def shifted_rows(mesh: Mesh, along: Literal["first", "second"] = "first") -> Mesh:
    """Nearly regular triangles from every second vertex of a quadrilateral grid.

    Parameters
    ----------
    mesh : Mesh
        Quadrilaterals, four around every inner vertex, as the nets of this library.
    along : {"first", "second"}
        Rows run along the first sides of the faces or across. Rows along the larger curvature
        give the best hexagons.

    Returns
    -------
    Mesh
        Triangles, equilateral where the steps across rows are √3 times those along them.

    Examples
    --------
    >>> from spheremesh.nodes import shifted_rows, torus_mesh
    >>> mesh = shifted_rows(torus_mesh(24, 12))
    >>> set(mesh.degrees.tolist()), mesh.n_faces
    ({3}, 288)
    """
    return grids.shifted_rows(mesh, along)


@node
def tangent_spheres(mesh: Mesh, offset: float | VertexDistances) -> VertexSpheres:
    """Spheres that touch a surface at the vertices of its mesh.

    Parameters
    ----------
    mesh : Mesh
    offset : float or (V,) float array
        Signed distance of the centres along the vertex normals, not zero; infinite for
        tangent planes.

    Returns
    -------
    (V, 5) float array
        Rows (A, Bx, By, Bz, C); N agrees with the normals of the mesh.

    Examples
    --------
    >>> from spheremesh.nodes import tangent_spheres, torus_mesh
    >>> tangent_spheres(torus_mesh(12, 6), offset=0.9).shape
    (72, 5)
    """
    return congruence.sphere_congruence(mesh, "tangent", offset)[0]


@node(version="2")
def evolve_spheres(
    mesh: Mesh,
    max_axis_angle: Annotated[float, Port(unit="deg", min=0, max=90)] = 15.0,
    side: Literal["auto", "plus", "minus"] = "auto",
    *,
    flips: bool = True,
) -> EvolvedSpheres:
    """Grow tangent spheres towards the curvature spheres, with upright node axes.

    Parameters
    ----------
    mesh : Mesh
        Triangles.
    max_axis_angle : float
        Largest angle of a node axis with the surface normal, between 0 and 90. Of the fixed
        bounds below, 3, 5, 10, 15, 20 degrees and so on, the one with the largest spheres is
        taken, so that a looser one never gives less.
    side : {"auto", "plus", "minus"}
        Centres on the side of the normals, beyond, or where the surface bends to on average.
    flips : bool
        Whether edges may be flipped so that faces stay convex.

    Returns
    -------
    mesh : Mesh
        The triangles, with flipped edges.
    spheres : (V, 5) float array
        Spheres at the vertices.
    report : EvolutionReport
        How large the spheres are, how upright the axes, and which faces are bad.

    Examples
    --------
    >>> from spheremesh.nodes import ellipsoid_mesh, evolve_spheres, shifted_rows
    >>> grown = evolve_spheres(shifted_rows(ellipsoid_mesh(24, 12)))
    >>> grown.report["converged"], grown.report["bad_faces"]
    (True, [])
    """
    angle = float(np.radians(max_axis_angle))
    found = evolution.evolve_best(mesh, angle, side, flips=flips)
    angles = np.degrees(found.axis_angles)
    shares = found.offsets / found.radii
    tilted = np.flatnonzero(found.axis_angles > angle + AXIS_SLACK).tolist()
    outer = np.flatnonzero(found.is_outer).tolist()
    valences = _by_valence(found.mesh)
    report = EvolutionReport(
        converged=found.converged,
        iterations=found.iterations,
        flips=found.n_flips,
        side="plus" if found.side == 1 else "minus",
        axis_angle_deg={
            "median": float(np.median(angles)),
            "p95": float(np.percentile(angles, 95)),
            "max": float(angles.max()),
        },
        lambda_over_rho={"mean": float(shares.mean()), "min": float(shares.min())},
        valences={valence: len(ids) for valence, ids in valences.items()},
        irregular={valence: ids for valence, ids in valences.items() if valence != "6"},
        bad_faces=[
            {"vertex": vertex, "reason": reason}
            for vertex, reason in shex.bad_faces(found.mesh, found.spheres)
        ],
        tilted_triangles=tilted,
        outer_vertices=outer,
    )
    if tilted:
        warn(
            f"{len(tilted)} node axes tilt by more than {max_axis_angle:g} degrees, up to "
            f"{float(angles.max()):.3g}: allow a larger angle or use a finer mesh"
        )
    elif not found.converged:
        warn("the spheres did not converge: they may be smaller than possible")
    if outer:
        warn(
            f"the surface bends away from the centres at {len(outer)} vertices "
            f"{name_ids(outer)}: faces bulge against it there"
        )
    return EvolvedSpheres(found.mesh, found.spheres, report)


def _by_valence(mesh: Mesh) -> dict[str, list[int]]:
    """Inner vertices by the number of their triangles: the degrees of the dual faces."""
    valences = np.bincount(mesh.corners, minlength=mesh.n_vertices)
    valences[mesh.topology.is_boundary_vertex] = 0
    return {
        str(valence): np.flatnonzero(valences == valence).tolist()
        for valence in np.unique(valences[valences > 0]).tolist()
    }


@node
def tangent_sphere_shex(
    mesh: Mesh, spheres: VertexSpheres, boundary: Literal["drop", "clip"] = "drop"
) -> Hexagons:
    """Sphere mesh with a face for every vertex of a triangulation: hexagons where regular.

    Parameters
    ----------
    mesh : Mesh
        Triangles.
    spheres : (V, 5) float array
        Spheres at the vertices, planes included.
    boundary : {"drop", "clip"}
        Faces of inner vertices only; or those of the boundary as well, cut off by planes that
        stand on its edges.

    Returns
    -------
    sphere_mesh : SphereMesh
        Three spheres meet in each vertex. Faces with a vertex that is not real are left out.
    report : HexagonsReport
        Shapes of the faces, and those that cannot be made.

    Examples
    --------
    >>> from spheremesh.nodes import ellipsoid_mesh, shifted_rows, tangent_sphere_shex
    >>> from spheremesh.nodes import tangent_spheres
    >>> mesh = shifted_rows(ellipsoid_mesh(24, 12))
    >>> report = tangent_sphere_shex(mesh, tangent_spheres(mesh, -0.5)).report
    >>> report["faces"], report["convex"], report["degrees"]
    (132, 132, {'6': 132})
    """
    dual = shex.dual_sphere_mesh(mesh, spheres, boundary)
    result = dual.sphere_mesh
    shapes = face_shapes.face_shapes(result)
    crossing = np.flatnonzero(shapes == face_shapes.CROSSING_FACE).tolist()
    far = np.flatnonzero(dual.has_far_corner).tolist()
    miss = float(vertex_errors(result).max())
    degrees, counts = np.unique(result.mesh.degrees, return_counts=True)
    report = HexagonsReport(
        faces=result.mesh.n_faces,
        convex=int((shapes == face_shapes.CONVEX).sum()),
        bow_tie=int((shapes == face_shapes.BOW_TIE).sum()),
        crossing=len(crossing),
        imaginary=dual.n_imaginary,
        degrees={str(d): n for d, n in zip(degrees.tolist(), counts.tolist(), strict=True)},
        left_out=[{"vertex": vertex, "reason": reason} for vertex, reason in dual.left_out],
        crossing_faces=_name_faces(dual, crossing),
        far_corners=_name_faces(dual, far),
        vertex_error={"max": miss, "relative_to_edge": miss / mean_edge_length(result.mesh)},
        vertex_ids=dual.vertex_ids.tolist(),
    )
    if dual.left_out:
        warn(
            f"{len(dual.left_out)} faces are left out, at vertices "
            f"{name_ids([vertex for vertex, _ in dual.left_out])} ({dual.left_out[0][1]})"
        )
    if crossing:
        warn(
            f"{len(crossing)} faces cross themselves: {name_ids(crossing)}; use smaller "
            "spheres or let evolve_spheres flip edges"
        )
    if far:
        warn(
            f"{len(far)} faces reach far beyond the boundary: {name_ids(far)}; triangles on it "
            "are too obtuse"
        )
    return Hexagons(result, report)


def _name_faces(dual: shex.DualSpheres, faces: list[int]) -> list[dict[str, int]]:
    return [{"face": face, "vertex": int(dual.vertex_ids[face])} for face in faces]


@node
def classify_hexagons(sphere_mesh: SphereMesh) -> FaceShapes:
    """Tell convex faces from bow-ties and from those that cross themselves.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh, of any face degrees.

    Returns
    -------
    (F,) str array
        ``"convex"`` seen along the direction of its largest shadow, ``"bow-tie"`` with reflex
        corners, or ``"crossing"``: two of its arcs meet, or it is folded over.

    Examples
    --------
    >>> from spheremesh.nodes import classify_hexagons, ellipsoid_mesh, shifted_rows
    >>> from spheremesh.nodes import tangent_sphere_shex, tangent_spheres
    >>> mesh = shifted_rows(ellipsoid_mesh(24, 12))
    >>> hexagons = tangent_sphere_shex(mesh, tangent_spheres(mesh, -0.5)).sphere_mesh
    >>> set(classify_hexagons(hexagons).tolist())
    {'convex'}
    """
    return face_shapes.face_shapes(sphere_mesh)


@node
def pencil_positions(curvatures: Numbers, first: Numbers, second: Numbers) -> Names:
    """Where touching spheres lie among the curvature spheres: faces are convex or bow-ties.

    Parameters
    ----------
    curvatures : (N,) float array
        Curvatures of the spheres, one over the signed distances of their centres.
    first, second : (N,) float array
        Principal curvatures of the surface, the larger ones first.

    Returns
    -------
    (N,) str array
        "empty" (the sphere does not meet the surface: neighbours cut out convex faces),
        "principal", or "central" (between the curvature spheres: bow-ties).

    Examples
    --------
    >>> import numpy as np
    >>> from spheremesh.nodes import pencil_positions
    >>> pencil_positions(*np.array([[3.0, 2, 1], [2, 2, 2], [0, 0, 0]])).tolist()
    ['empty', 'principal', 'central']
    """
    names = np.array([position.name.lower() for position in face_shapes.PencilPosition])
    return names[face_shapes.pencil_positions(curvatures, first, second)]
