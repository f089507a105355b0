"""Numbers that tell how good a sphere mesh is."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np

from ...kernel import analysis
from ...kernel.meshes.mesh import Mesh
from ...kernel.panels import cutting
from ...kernel.sphere_meshes import planarity_circularity as flatness
from ...kernel.sphere_meshes import sphere_mesh as measures
from ...kernel.sphere_meshes.fit import face_planes
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...kernel.spheres.arcs import Arcs
from ...kernel.support import beam_tilt as tilt
from ..graphs.node import node
from ..graphs.ports import Port
from .arrays import EdgeAngles, EdgeDistances, FaceDistances, FaceMarks, VertexDistances


@node
def intersection_angles(
    sphere_mesh: SphereMesh, reference: Literal["spheres", "planes"] = "spheres"
) -> EdgeAngles:
    """
    Angle at which neighbouring faces meet.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.
    reference : {"spheres", "planes"}
        Measure between the spheres, or between the planes of the faces, to compare.

    Returns
    -------
    (E,) float array
        Degrees over the interior edges: 0 smooth, 180 a spike.
    """
    subject = sphere_mesh if reference == "spheres" else face_planes(sphere_mesh.mesh)
    return np.degrees(measures.intersection_angles(subject))


@node
def vertex_error(sphere_mesh: SphereMesh) -> VertexDistances:
    """
    Distance of each vertex from the spheres of its faces.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.

    Returns
    -------
    (V,) float array
        The largest distance of each vertex, in model units.
    """
    return measures.vertex_error(sphere_mesh)


@node
def planarity(sphere_mesh: SphereMesh | Mesh) -> FaceDistances:
    """
    How far the corners of each face lie off its plane.

    Parameters
    ----------
    sphere_mesh : SphereMesh or Mesh
        The mesh.

    Returns
    -------
    (F,) float array
        Largest distance of a corner of each face, in model units.
    """
    return flatness.planarity(_mesh(sphere_mesh))


@node
def circularity(sphere_mesh: SphereMesh | Mesh) -> FaceDistances:
    """
    How far the corners of each face lie off its best-fit circle.

    Parameters
    ----------
    sphere_mesh : SphereMesh or Mesh
        The mesh.

    Returns
    -------
    (F,) float array
        Largest distance of a corner of each face, in model units.
    """
    return flatness.circularity(_mesh(sphere_mesh))


@node
def beam_tilt(sphere_mesh: SphereMesh) -> EdgeAngles:
    """
    Tilt of the beams that lie in the planes where neighbouring spheres meet.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.

    Returns
    -------
    (E,) float array
        Degrees over the interior edges: 0 upright, 90 tangential to the surface.
    """
    return np.degrees(tilt.beam_tilt(sphere_mesh))


@node
def deviation(sphere_mesh: SphereMesh, mesh: Mesh) -> FaceDistances:
    """
    How far the panels stand off a reference surface.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.
    mesh : Mesh
        The surface to compare with.

    Returns
    -------
    (F,) float array
        Largest distance of each panel, in model units.
    """
    return analysis.deviation(sphere_mesh, mesh)


@node
def spiky_faces(sphere_mesh: SphereMesh) -> FaceMarks:
    """
    Faces that bulge to the wrong side.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.

    Returns
    -------
    (F,) bool array
        True where a face bulges against its surroundings and makes an edge sharper than the
        planes of the faces would.
    """
    return analysis.spiky_faces(sphere_mesh)


@node
def angle_histogram(
    sphere_mesh: SphereMesh, n_bins: Annotated[int, Port(min=1, max=1000)] = 20
) -> Mapping[str, Any]:
    """
    Count the angles between neighbours, for the spheres and for the planes of the faces.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.
    n_bins : int
        Number of bins.

    Returns
    -------
    mapping
        ``bounds_deg`` of the bins, and the numbers of edges ``spheres`` and ``planes`` in them.
    """
    counts = analysis.angle_histogram(sphere_mesh, n_bins)
    return {
        "bounds_deg": np.degrees(counts.bounds).tolist(),
        "spheres": counts.spheres.tolist(),
        "planes": counts.planes.tolist(),
    }


class EdgeArcs(NamedTuple):
    """Arcs of the edges, and how far those of neighbours differ."""

    arcs: Arcs
    gap: EdgeDistances


@node
def edge_arcs(
    sphere_mesh: SphereMesh, mode: Literal["intersection", "bisector"] = "intersection"
) -> EdgeArcs:
    """
    Arcs along the edges: where spheres meet, or where planes that bisect the faces cut them.

    Parameters
    ----------
    sphere_mesh : SphereMesh
        The sphere mesh.
    mode : {"intersection", "bisector"}
        Circles in which neighbouring spheres meet, or the two circles in the bisecting plane.

    Returns
    -------
    arcs : Arcs
        One arc per half-edge (H of them, in the order of the corners), in model coordinates.
    gap : (E,) float array
        Largest distance of the two arcs of each interior edge, in model units.
    """
    arcs = cutting.edge_arcs(sphere_mesh, mode)
    return EdgeArcs(arcs, cutting.edge_gaps(sphere_mesh, mode))


def _mesh(source: SphereMesh | Mesh) -> Mesh:
    return source.mesh if isinstance(source, SphereMesh) else source
