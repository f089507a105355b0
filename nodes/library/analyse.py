"""Numbers that tell how good a sphere mesh is."""

from dataclasses import dataclass
from typing import Annotated, Literal, NamedTuple

import numpy as np

from ...kernel import analysis
from ...kernel.meshes.mesh import Mesh
from ...kernel.panels import cutting
from ...kernel.reports import Report
from ...kernel.sphere_meshes import planarity_circularity as flatness
from ...kernel.sphere_meshes import sphere_mesh as measures
from ...kernel.sphere_meshes.fit import face_planes
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...kernel.spheres import incidence
from ...kernel.spheres.arcs import Arcs
from ...kernel.support import beam_tilt as tilt
from ..graphs.node import node
from ..graphs.ports import Port
from .arrays import (
    EdgeAngles,
    EdgeDistances,
    FaceDistances,
    FaceMarks,
    Numbers,
    Points,
    Spheres,
    VertexDistances,
)


@node
def intersection_angles(
    sphere_mesh: SphereMesh, reference: Literal["spheres", "planes"] = "spheres"
) -> EdgeAngles:
    """Angle at which neighbouring faces meet.

    Parameters
    ----------
    sphere_mesh : SphereMesh
    reference : {"spheres", "planes"}
        Measure between the spheres, or between the planes of the faces, to compare.

    Returns
    -------
    (E,) float array
        Degrees over the interior edges: 0 smooth, 180 a spike.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, intersection_angles, vase_mesh
    >>> sphere_mesh = fit_spheres(vase_mesh(12, 6))
    >>> for reference in ("spheres", "planes"):
    ...     print(intersection_angles(sphere_mesh, reference).mean().round(1))
    15.1
    24.9
    """
    subject = sphere_mesh if reference == "spheres" else face_planes(sphere_mesh.mesh)
    return np.degrees(measures.intersection_angles(subject))


@node
def vertex_error(sphere_mesh: SphereMesh) -> VertexDistances:
    """Distance of each vertex from the spheres of its faces.

    Parameters
    ----------
    sphere_mesh : SphereMesh

    Returns
    -------
    (V,) float array
        The largest distance of each vertex, in model units.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, vase_mesh, vertex_error
    >>> distances = vertex_error(fit_spheres(vase_mesh(12, 6)))
    >>> distances.shape, bool((distances < 1e-12).all())
    ((84,), True)
    """
    return measures.vertex_error(sphere_mesh)


@node
def planarity(sphere_mesh: SphereMesh | Mesh) -> FaceDistances:
    """How far the corners of each face lie off its plane.

    Parameters
    ----------
    sphere_mesh : SphereMesh or Mesh

    Returns
    -------
    (F,) float array
        Largest distance of a corner of each face, in model units.

    Examples
    --------
    >>> from spheremesh.nodes import planarity, vase_mesh
    >>> mesh = vase_mesh(12, 6)
    >>> planarity(mesh).shape, bool((planarity(mesh) < 1e-12).all())
    ((72,), True)
    """
    return flatness.planarity(_mesh(sphere_mesh))


@node
def circularity(sphere_mesh: SphereMesh | Mesh) -> FaceDistances:
    """How far the corners of each face lie off its best-fit circle.

    Parameters
    ----------
    sphere_mesh : SphereMesh or Mesh

    Returns
    -------
    (F,) float array
        Largest distance of a corner of each face, in model units.

    Examples
    --------
    >>> from spheremesh.nodes import circularity, vase_mesh
    >>> mesh = vase_mesh(12, 6)
    >>> circularity(mesh).shape, bool((circularity(mesh) < 1e-12).all())
    ((72,), True)
    """
    return flatness.circularity(_mesh(sphere_mesh))


@node
def beam_tilt(sphere_mesh: SphereMesh) -> EdgeAngles:
    """Tilt of the beams that lie in the planes where neighbouring spheres meet.

    Parameters
    ----------
    sphere_mesh : SphereMesh

    Returns
    -------
    (E,) float array
        Degrees over the interior edges: 0 upright, 90 tangential to the surface.

    Examples
    --------
    >>> from spheremesh.nodes import beam_tilt, ellipsoid_mesh, model_change
    >>> tilt = beam_tilt(model_change(ellipsoid_mesh(12, 6), radius=4.0))
    >>> float(tilt.max().round(1))
    24.5
    """
    return np.degrees(tilt.beam_tilt(sphere_mesh))


@node
def deviation(sphere_mesh: SphereMesh, mesh: Mesh) -> FaceDistances:
    """How far the panels stand off a reference surface.

    Parameters
    ----------
    sphere_mesh : SphereMesh
    mesh : Mesh
        The surface to compare with.

    Returns
    -------
    (F,) float array
        Largest distance of each panel, in model units.

    Examples
    --------
    >>> from spheremesh.nodes import deviation, face_planes, vase_mesh
    >>> coarse, fine = face_planes(vase_mesh(12, 6)), vase_mesh(48, 24)
    >>> round(float(deviation(coarse, fine).max()), 3)
    0.083
    """
    return analysis.deviation(sphere_mesh, mesh)


@node
def spiky_faces(sphere_mesh: SphereMesh) -> FaceMarks:
    """Faces that bulge to the wrong side.

    Parameters
    ----------
    sphere_mesh : SphereMesh

    Returns
    -------
    (F,) bool array
        True where a face bulges against its surroundings and makes an edge sharper than the
        planes of the faces would.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, spiky_faces, vase_mesh
    >>> int(spiky_faces(fit_spheres(vase_mesh(12, 6))).sum())
    0
    """
    return analysis.spiky_faces(sphere_mesh)


@dataclass(frozen=True, eq=False)
class HistogramReport(Report):
    """Numbers of edges by the angle between neighbours.

    Attributes
    ----------
    bounds_deg : list of float
        Bounds of the bins.
    spheres, planes : list of int
        Edges in each bin, for the spheres and for the planes of the faces.
    """

    bounds_deg: list[float]
    spheres: list[int]
    planes: list[int]


@node
def angle_histogram(
    sphere_mesh: SphereMesh, n_bins: Annotated[int, Port(min=1, max=1000)] = 20
) -> HistogramReport:
    """Count the angles between neighbours, for the spheres and for the planes of the faces.

    Parameters
    ----------
    sphere_mesh : SphereMesh
    n_bins : int
        Number of bins.

    Returns
    -------
    HistogramReport
        Bounds of the bins, and the numbers of edges in them.

    Examples
    --------
    >>> from spheremesh.nodes import angle_histogram, fit_spheres, vase_mesh
    >>> counts = angle_histogram(fit_spheres(vase_mesh(12, 6)), n_bins=3)
    >>> counts["spheres"], counts["planes"]
    ([60, 60, 12], [12, 96, 24])
    """
    counts = analysis.angle_histogram(sphere_mesh, n_bins)
    return HistogramReport(
        np.degrees(counts.bounds).tolist(), counts.spheres.tolist(), counts.planes.tolist()
    )


class EdgeArcs(NamedTuple):
    """Arcs of the edges, and how far those of neighbours differ."""

    arcs: Arcs
    gap: EdgeDistances


@node
def edge_arcs(
    sphere_mesh: SphereMesh, mode: Literal["intersection", "bisector"] = "intersection"
) -> EdgeArcs:
    """Arcs along the edges: where spheres meet, or where planes that bisect the faces cut them.

    Parameters
    ----------
    sphere_mesh : SphereMesh
    mode : {"intersection", "bisector"}
        Circles in which neighbouring spheres meet, or the two circles in the bisecting plane.

    Returns
    -------
    arcs : Arcs
        One arc per half-edge (H of them, in the order of the corners), in model coordinates.
    gap : (E,) float array
        Largest distance of the two arcs of each interior edge, in model units.

    Examples
    --------
    >>> from spheremesh.nodes import edge_arcs, fit_spheres, vase_mesh
    >>> sphere_mesh = fit_spheres(vase_mesh(12, 6))
    >>> bool((edge_arcs(sphere_mesh, "intersection").gap < 1e-12).all())
    True
    >>> float(edge_arcs(sphere_mesh, "bisector").gap.max().round(3))
    0.018
    """
    arcs = cutting.edge_arcs(sphere_mesh, mode)
    return EdgeArcs(arcs, cutting.edge_gaps(sphere_mesh, mode))


def _mesh(source: SphereMesh | Mesh) -> Mesh:
    return source.mesh if isinstance(source, SphereMesh) else source


@node
def signed_distance(spheres: Spheres, points: Points) -> Numbers:
    """Distances of points from spheres and planes.

    Parameters
    ----------
    spheres : (N, 5) float array
        Unit rows.
    points : (N, 3) float array
        One for each sphere.

    Returns
    -------
    (N,) float array
        Positive on the side to which the normal of the sphere points.

    Examples
    --------
    >>> import numpy as np
    >>> from spheremesh.nodes import signed_distance, sphere_rows
    >>> ball = sphere_rows(np.zeros((1, 3)), 2.0)
    >>> signed_distance(ball, np.array([[0.0, 0.0, 5.0]])).tolist()
    [-3.0]
    """
    return incidence.signed_distance(spheres, points)
