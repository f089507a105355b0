"""Other meshes of the same shape: triangulated, subdivided, remeshed, repaired."""

import os
from collections.abc import Sequence
from typing import Annotated, Literal, NamedTuple, TypeAlias

import numpy as np

from ...fabrication.mesh_files.reader import read_content
from ...kernel.arrays import FloatArray
from ...kernel.errors import InputError
from ...kernel.meshes import isotropic_remeshing, subdivision, triangulation
from ...kernel.meshes.mesh import Mesh
from ...kernel.repair import description, pipeline
from ...kernel.repair.description import MeshReport
from ...kernel.repair.pipeline import RepairReport
from ...kernel.repair.raw_mesh import RawMesh, raw_from_faces, raw_from_mesh, raw_from_rows
from ...kernel.surfaces.surface import Surface
from ...kernel.tolerances import MOSTLY_EVEN
from ..graphs.node import node, warn
from ..graphs.ports import Length, Port, ReadPath
from .arrays import VertexCurvatures, VertexDirections, VertexMarks, VertexNormals

AnyMesh: TypeAlias = Mesh | ReadPath | tuple[FloatArray, Sequence[Sequence[int]]]
"""A mesh, a mesh file, or points and the vertex ids of each face."""

SCHEMES = {
    "loop": subdivision.subdivide_loop,
    "catmull-clark": subdivision.subdivide_catmull_clark,
    "midpoint": subdivision.subdivide_midpoint,
}


class SurfaceFields(NamedTuple):
    """A mesh on a surface, and the shape of the surface at its vertices."""

    mesh: Mesh
    normals: VertexNormals
    curvatures: VertexCurvatures
    directions: VertexDirections
    is_smooth: VertexMarks


@node
def triangulate(mesh: Mesh) -> Mesh:
    """Cut polygons into triangles along their short diagonals.

    Parameters
    ----------
    mesh : Mesh
        Faces of any degree, convex or not.

    Returns
    -------
    Mesh
        Triangles on the same vertices; those of a face follow each other.

    Examples
    --------
    >>> from spheremesh.nodes import triangulate, vase_mesh
    >>> triangulate(vase_mesh(12, 6)).n_faces
    144
    """
    return triangulation.triangulate(mesh)


@node
def subdivide(
    mesh: Mesh,
    scheme: Literal["loop", "catmull-clark", "midpoint"] | None = None,
    iterations: Annotated[int, Port(min=0, max=8)] = 1,
) -> Mesh:
    """Split every face into smaller ones.

    Parameters
    ----------
    mesh : Mesh
    scheme : {"loop", "catmull-clark", "midpoint"}, optional
        Smooth for triangles, smooth for faces of any degree (quadrilaterals come out), or
        without a change of shape. By default loop for triangles and catmull-clark for others.
    iterations : int
        How often; each multiplies the number of faces by about four.

    Returns
    -------
    Mesh
        The finer mesh; the smooth schemes draw it inwards, its boundary to a smooth curve.

    Examples
    --------
    >>> from spheremesh.nodes import subdivide, vase_mesh
    >>> subdivide(vase_mesh(12, 6)).n_faces
    288
    """
    if scheme is None:
        scheme = "loop" if (mesh.degrees == 3).all() else "catmull-clark"
    for _ in range(iterations):
        mesh = SCHEMES[scheme](mesh)
    return mesh


@node(version=2)
def remesh_triangles(
    mesh: Mesh,
    edge_length: Annotated[float, Port(min=0)],
    iterations: Annotated[int, Port(min=0, max=100)] = 10,
    crease_angle: Annotated[float, Port(unit="deg", min=0, max=180)] = 40.0,
) -> Mesh:
    """Cover the surface of a mesh with triangles whose edges have nearly one length.

    Parameters
    ----------
    mesh : Mesh
        The surface; polygons are cut into triangles first.
    edge_length : float
        Length that edges shall have, in model units.
    iterations : int
        How often all edges are gone over.
    crease_angle : float
        Edges at which the surface turns more sharply are kept, as the boundary is.

    Returns
    -------
    Mesh
        Triangles with their vertices on the surface.

    Examples
    --------
    >>> from spheremesh.nodes import remesh_triangles, vase_mesh
    >>> mesh = remesh_triangles(vase_mesh(12, 6), edge_length=0.6, iterations=3)
    >>> set(mesh.degrees.tolist())
    {3}
    """
    result = isotropic_remeshing.remesh_triangles(
        mesh, edge_length, iterations, float(np.radians(crease_angle))
    )
    share = isotropic_remeshing.even_share(result, edge_length)
    if iterations and share < MOSTLY_EVEN:
        warn(
            f"only {100 * share:.0f} % of the edges are between 0.5 and 1.6 times as long as "
            "asked for: the mesh has finer details, corners or creases; choose shorter "
            "edges or a larger crease angle"
        )
    return result


@node
def surface_fields(surface: Surface) -> SurfaceFields:
    """The mesh of a surface and what is known at its vertices, one by one.

    Parameters
    ----------
    surface : Surface
        A surface, as read by `read_surface`.

    Returns
    -------
    mesh : Mesh
        The mesh on the surface.
    normals : (V, 3) float array
        Unit normals.
    curvatures : (V, 2) float array
        The larger and the smaller principal curvature, positive towards the normal.
    directions : (V, 2, 3) float array
        Principal directions of the two.
    is_smooth : (V,) bool array
        False on creases and at apexes.

    Examples
    --------
    >>> import numpy as np
    >>> from spheremesh import Mesh, Surface
    >>> from spheremesh.nodes import surface_fields
    >>> square = Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), [[0, 1, 2, 3]])
    >>> axes = np.tile(np.eye(3), (4, 1, 1))
    >>> flat = Surface(square, axes[:, 2], np.zeros((4, 2)), axes[:, :2], np.ones(4, bool))
    >>> surface_fields(flat).curvatures.tolist()
    [[0.0, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]]
    """
    return SurfaceFields(
        surface.mesh,
        surface.normals,
        surface.curvatures,
        surface.directions,
        surface.is_smooth,
    )


class RepairedMesh(NamedTuple):
    """A mesh, and what was done to make it one."""

    mesh: Mesh
    report: RepairReport


@node
def repair_mesh(
    mesh: AnyMesh,
    tolerance: Annotated[float, Port(min=0)] | None = None,
    layer: str = "",
    edge_length: Length | None = None,
    n_u: Annotated[int, Port(min=1, max=2000)] = 24,
    n_v: Annotated[int, Port(min=1, max=2000)] = 24,
) -> RepairedMesh:
    """Make a mesh of faces that are none, or that do not hang together, and say what was done.

    Vertices at one place are welded, slivers and repeated faces dropped, T-junctions split,
    faces with a hole or coinciding corners cut into triangles or made smaller, faces where more
    than two meet separated, normals unified. All else stays as it is.

    Parameters
    ----------
    mesh : Mesh, path, or (vertices, faces)
        A mesh, a mesh file, or points and the vertex ids of each face.
    tolerance : float, optional
        Distance within which places are one, in model units; by default a few spacings of the
        numbers that the coordinates were written with, between 1e-6 and 1e-3 mean edges.
    layer : str
        Of a file: only what is on this layer (.3dm) or in this group (OBJ).
    edge_length : float, optional
        Of a .3dm with surfaces: length of the edges on them, instead of numbers of rows.
    n_u, n_v : int
        Rows of faces along u and v of each surface.

    Returns
    -------
    mesh : Mesh
        The repaired mesh; the same, number by number, if it wants nothing.
    report : RepairReport
        What was done, by kind and ids; a warning sums it up.

    Examples
    --------
    >>> import warnings
    >>> from spheremesh.nodes import repair_mesh
    >>> points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0]]
    >>> faces = [[0, 1, 2, 3], [2, 6, 5, 4], [3, 2, 1, 0]]
    >>> with warnings.catch_warnings(action="ignore"):
    ...     mesh, report = repair_mesh((points, faces))
    >>> mesh.n_faces, report.welded_vertices, report.duplicate_faces
    (2, [[1, 4]], [[2, 0]])
    """
    repaired, report = pipeline.repair(_raw_mesh(mesh, layer, n_u, n_v, edge_length), tolerance)
    done = pipeline.repair_words(pipeline.repair_counts(report), is_done=True)
    if done:
        warn(f"the mesh was repaired: {done} (tolerance {report.tolerance:.2g})")
    return RepairedMesh(repaired, report)


@node
def mesh_report(mesh: AnyMesh, layer: str = "") -> MeshReport:
    """Say what a mesh is, what repair_mesh would mend, and what can be done with it.

    Parameters
    ----------
    mesh : Mesh, path, or (vertices, faces)
        A mesh, a mesh file, or points and the vertex ids of each face; valid or not.
    layer : str
        Of a file: only what is on this layer (.3dm) or in this group (OBJ).

    Returns
    -------
    MeshReport
        Degrees, pieces, boundary, creases, planarity, circularity, size, advice.

    Examples
    --------
    >>> from spheremesh.nodes import mesh_report
    >>> report = mesh_report(([[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 1, 2], [2, 1, 0]]))
    >>> report.is_mesh, report.problem
    (False, 'face 1 repeats face 0 turned over; delete it, or repair_mesh (--repair) does')
    """
    return description.describe(_raw_mesh(mesh, layer))


def _raw_mesh(
    mesh: Mesh | str | os.PathLike[str] | tuple[FloatArray, Sequence[Sequence[int]]],
    layer: str,
    n_u: int = 24,
    n_v: int = 24,
    edge_length: float | None = None,
) -> RawMesh:
    """The faces of a mesh, of a file or of a pair, whatever they are."""
    if isinstance(mesh, str | os.PathLike):
        content = read_content(mesh, layer, n_u, n_v, edge_length)
        for remark in content.remarks:
            # What a repair mends its report says itself.
            if "repair_mesh" not in remark:
                warn(remark)
        polygons = content.polygons
        offsets = np.concatenate([np.zeros(1, np.int64), np.cumsum(polygons.degrees)])
        return raw_from_rows(polygons.vertices, polygons.corners, offsets)
    if layer:
        raise InputError(f"layer {layer!r}: only a file has layers; give a path, or no layer")
    return raw_from_mesh(mesh) if isinstance(mesh, Mesh) else raw_from_faces(*mesh)
