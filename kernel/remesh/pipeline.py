"""From a sphere congruence to a net of spheres that can have a support structure (Sec. 6.4)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import ComplexArray, FloatArray, IntArray
from ..errors import InputError, name_ids
from ..meshes.mesh import Mesh, face_centroids, shortest_edge
from ..meshes.vertex_fans import vertex_fans
from ..solvers.weighted_graphs import piece_labels
from ..sphere_meshes.sphere_mesh import SphereMesh
from ..spheres.minkowski import minkowski
from ..spheres.rows import recenter, rescale
from ..tolerances import UMBILIC
from .field.congruence_mesh import CongruenceMesh, congruence_mesh
from .field.conjugate_directions import expected_axis_angles, umbilic_share
from .field.conjugate_form import (
    UndeterminedError,
    anisotropy,
    conjugate_field,
    form_roots,
)
from .field.frames import comb_frames
from .field.guides import NetWishes, guided_forms, turned_share
from .field.jets import CongruenceJets, fit_jets
from .field.smooth_surface import SmoothSurface, nearest_triangles
from .field.smoothing import orient_forms
from .map.parametrization import parametrize
from .map.seams import find_seams
from .net.extraction import extract_net
from .net.net_mesh import NetMesh, net_mesh

LEAST_CELLS = 4
"""A surface with room for fewer faces is smaller than the edge length."""

FINEST = 0.2
"""An edge length below this, in mean edges of the mesh, asks for a finer mesh."""

NO_WISHES = NetWishes()


@dataclass(frozen=True)
class Remeshing:
    """A quadrilateral net of spheres and how it was reached.

    Attributes
    ----------
    sphere_mesh : SphereMesh
        Mostly quadrilaterals; a sphere of the congruence at each.
    n_irregular : int
        Vertices inside whose valence is not 4.
    shortest_edge : float
        Length, in model units.
    complex_share : float
        Share of the area of the given surface whose directions are complex.
    umbilic_share : float
        Share of the area on which all pairs of orthogonal directions are all but conjugate.
    moved_share : float
        Share of the area whose directions, once smooth, were moved apart to the least angle.
    turned_share : float
        Share of the area whose directions guides turn away from the conjugate ones.
    singular_points : (s, 3) float array
        Where the directions turn, in model coordinates.
    indices : (s,) int array
        How often, in half turns: around -1 lies a face of degree 6, around 1 an edge with ends
        of valence 3.
    n_folded, n_flipped : int
        Triangles folded by the map before and after they were unfolded.
    n_aligned : int
        Sides of the boundary that are lines of the net.
    n_contracted, n_slivers : int
        Short edges at the boundary that were contracted, and cells lost there.
    n_digons : int
        Cells of two corners, which became edges.
    n_covered : int
        Holes of the surface, smaller than the cells, that the net covers.
    axis_angles : (V',) float array
        Angles of the normals with the expected node axes at the given vertices, in radians.
    curvatures : (V',) float array
        Signed curvatures of the given spheres, in inverse model units.
    degree : int
        Degree of the polynomials that were fitted to the spheres.
    surface : SmoothSurface
        The surface between the given vertices.
    """

    sphere_mesh: SphereMesh
    n_irregular: int
    shortest_edge: float
    complex_share: float
    umbilic_share: float
    moved_share: float
    turned_share: float
    singular_points: FloatArray
    indices: IntArray
    n_folded: int
    n_flipped: int
    n_aligned: int
    n_contracted: int
    n_slivers: int
    n_digons: int
    n_covered: int
    axis_angles: FloatArray
    curvatures: FloatArray
    degree: int
    surface: SmoothSurface


def remesh(
    mesh: Mesh,
    spheres: ArrayLike,
    edge_length: float,
    smoothing: float = 0.5,
    least_angle: float = np.radians(20),
    degree: int | None = None,
    rings: int = 4,
    wishes: NetWishes = NO_WISHES,
) -> Remeshing:
    """Remesh a sphere congruence along its conjugate directions.

    Parameters
    ----------
    spheres : (V, 5) array_like of float
        A real sphere or plane for every vertex, in model coordinates.
    edge_length : float
        Length of the edges of the net, in model units.
    smoothing : float
        Distance over which uncertain directions are smoothed, in edge lengths.
    least_angle : float
        Directions that meet at less, or are complex, are moved apart to it, in radians.
    degree : int, optional
        Degree of the polynomials that are fitted to the spheres, from 2 to 7; by default the
        one with the least expected error.
    rings : int
        Rings of neighbours that they are fitted to.
    wishes : NetWishes
        What the net shall follow besides its spheres. Where that is not conjugate, nodes have
        torsion.

    Returns
    -------
    Remeshing
        The net; its nodes lie on the triangles.

    Raises
    ------
    InputError
        If the mesh or the spheres cannot be used, the edge length is out of range, or the
        spheres are too small or too different to blend those of neighbouring vertices.
    ConvergenceError
        If the lines of the map do not match across the edges of the mesh.

    References
    ----------
    Meshes with Spherical Faces, Sec. 6.4.
    """
    surface = congruence_mesh(mesh, spheres)
    step = _checked_step(surface, edge_length)
    jets, heights, fitted = fit_jets(surface, degree, rings)
    trace, deviator = orient_forms(surface, *_forms(jets, wishes))
    is_real = form_roots(trace, deviator)[2]
    fans = vertex_fans(
        surface.topology, surface.triangles.ravel(), np.arange(len(surface.points))
    )
    smooth = guided_forms(surface, trace, deviator, (smoothing * step, step), wishes)
    frames = comb_frames(surface, fans, *smooth, least_angle)
    aligns = wishes.boundary != "free"
    mapped = parametrize(
        surface, fans, frames, find_seams(surface, fans, frames), step, wishes.spacing,
        aligns=aligns,
    )  # fmt: skip
    net = extract_net(surface, fans, frames, mapped)
    if net.n_nodes == 0:
        raise _too_large(edge_length)
    built = net_mesh(net, step)
    if not built.is_node.any():
        raise _too_large(edge_length)
    singular = np.flatnonzero(frames.indices)
    areas = surface.vertex_areas
    moved = surface.face_areas[~frames.is_real].sum() / surface.face_areas.sum()
    sphere_mesh = _interpolated(surface, built)
    return Remeshing(
        sphere_mesh=sphere_mesh,
        n_irregular=_irregular_count(sphere_mesh.mesh),
        shortest_edge=shortest_edge(sphere_mesh.mesh),
        complex_share=float(areas[~is_real].sum() / areas.sum()),
        umbilic_share=umbilic_share(surface, jets),
        moved_share=float(moved),
        turned_share=turned_share(surface, deviator, smooth[1], anisotropy(jets) > UMBILIC)
        if wishes.are_guides
        else 0.0,
        singular_points=mesh.vertices[singular],
        indices=frames.indices[singular],
        n_folded=mapped.n_folded,
        n_flipped=int(mapped.is_flipped.sum()),
        n_aligned=mapped.n_aligned,
        n_contracted=built.n_contracted,
        n_slivers=built.n_slivers,
        n_digons=built.n_digons,
        n_covered=max(_boundary_count(mesh) - _boundary_count(built.mesh), 0),
        axis_angles=expected_axis_angles(surface, jets),
        curvatures=2 * surface.rows[:, 0] / surface.size,
        degree=fitted,
        surface=SmoothSurface(surface, heights),
    )


def _forms(jets: CongruenceJets, wishes: NetWishes) -> tuple[FloatArray, ComplexArray]:
    """Forms of the conjugate directions; none where the spheres leave all to the guides."""
    try:
        return conjugate_field(jets)
    except UndeterminedError:
        if not wishes.are_guides:
            raise
        count = len(jets.rows)
        return np.zeros(count), np.zeros(count, complex)


def _irregular_count(mesh: Mesh) -> int:
    valences = np.bincount(mesh.corners, minlength=mesh.n_vertices)
    return int((valences[~mesh.topology.is_boundary_vertex] != 4).sum())


def _boundary_count(mesh: Mesh) -> int:
    """Number of closed lines that the boundary consists of."""
    outer = np.flatnonzero(mesh.topology.twins < 0)
    ends = mesh.corners[outer], mesh.corners[mesh.topology.next_corners[outer]]
    # Every vertex elsewhere is a component of its own.
    components = int(piece_labels(*ends, mesh.n_vertices).max()) + 1
    return components - (mesh.n_vertices - len(outer))


def _too_large(edge_length: float) -> InputError:
    return InputError(
        f"an edge length of {edge_length:g} is too large for the surface: the net has no room "
        "for its steps; choose a smaller one"
    )


def _checked_step(surface: CongruenceMesh, edge_length: float) -> float:
    """The edge length in mean edges."""
    if not 0 < edge_length < np.inf:
        raise InputError(f"the edge length must be positive, not {edge_length}")
    step = float(edge_length) / surface.size
    if surface.face_areas.sum() < LEAST_CELLS * step**2:
        raise _too_large(edge_length)
    if step < FINEST:
        raise InputError(
            f"an edge length of {edge_length:g} is finer than the mesh, whose edges measure "
            f"{surface.size:.3g}: subdivide the mesh"
        )
    return step


def _interpolated(surface: CongruenceMesh, built: NetMesh) -> SphereMesh:
    """Spheres of the congruence at the points of the triangles nearest to the face centres."""
    centers = face_centroids(built.mesh)
    vertices, weights = nearest_triangles(surface, centers)
    corners = surface.points[vertices]
    rows = recenter(surface.rows[vertices], centers[:, None] - corners)
    mixed = np.einsum("fc,fcr->fr", weights, rows)
    squares = minkowski(mixed, mixed)
    bad = np.unique(vertices[~(squares > 0)])
    if len(bad):
        raise InputError(
            f"the spheres of vertices {name_ids(bad.tolist())} are so small, or so different "
            "from their neighbours, that there is none between them: choose larger spheres of "
            "more even radius, or subdivide the mesh"
        )
    mixed /= np.sqrt(squares)[:, None]
    points = surface.origin + surface.size * built.mesh.vertices
    mesh = Mesh(points, built.mesh.faces)
    return SphereMesh.from_local(mesh, rescale(mixed, surface.size))
