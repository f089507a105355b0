"""Meshes to start from: read from files, or exactly circular nets."""

import os
from typing import Annotated, Literal, NamedTuple

import numpy as np

from ...fabrication.mesh_files import reader, surface_files, writer
from ...fabrication.sizes import doubt_size
from ...kernel.errors import InputError
from ...kernel.meshes.mesh import Mesh
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...kernel.surfaces import circular_nets as surfaces
from ...kernel.surfaces import triangulated
from ...kernel.surfaces.surface import Surface
from ..graphs.node import node, warn
from ..graphs.ports import Length, Port, ReadPath, WritePath
from .arrays import VertexNormals

FileUnits = Annotated[Literal["", "mm", "cm", "m", "in", "ft"], Port(graph_units=True)]
Count = Annotated[int, Port(min=1, max=2000)]


class SampledSurface(NamedTuple):
    """A triangle mesh on a smooth surface, and the normals of that surface."""

    mesh: Mesh
    normals: VertexNormals


@node(version="2")
def read_mesh(
    path: ReadPath,
    layer: str = "",
    n_u: Count = 24,
    n_v: Count = 24,
    edge_length: Length | None = None,
    units: FileUnits = "",
) -> Mesh:
    """Read a mesh from a file.

    Parameters
    ----------
    path : path
        An OBJ, OFF, PLY, STL or Rhino .3dm file; with ``spheremesh[formats]`` also VTK, VTU,
        Gmsh, Nastran, glTF and others. Polygons are kept as they are. What was mended or left
        out is a warning.
    layer : str
        Only what is on this layer (.3dm) or in this group (OBJ), and below; several with
        commas.
    n_u, n_v : int
        Rows of faces along u and v of each surface in a .3dm.
    edge_length : float, optional
        Length of the edges of faces on surfaces in a .3dm, instead of numbers of rows.
    units : str
        Units that the file must have, if it names any; in a graph, those of the graph.

    Returns
    -------
    Mesh
        The mesh, in the units of the file.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from spheremesh.nodes import read_mesh, vase_mesh, write_mesh
    >>> with TemporaryDirectory() as folder:
    ...     read_mesh(write_mesh(vase_mesh(12, 6), f"{folder}/vase.obj")).n_faces
    72
    """
    content = reader.read_content(path, layer, n_u, n_v, edge_length)
    _check_units(path, content.units, units)
    mesh = reader.content_mesh(content, path)
    actual = content.units or units
    for remark in (*content.remarks, doubt_size(mesh, actual) if actual else ""):
        if remark:
            warn(remark)
    return mesh


def _check_units(path: str | os.PathLike[str], found: str, asked: str) -> None:
    if asked and found not in ("", asked):
        raise InputError(
            f"cannot read {path}: it is drawn in {found}, not in {asked}; use units {found!r}"
        )


@node
def read_surface(
    path: ReadPath,
    layer: str = "",
    edge_length: Length | None = None,
    n_u: Count = 24,
    n_v: Count = 24,
    units: FileUnits = "",
) -> Surface:
    """Read the surfaces of a Rhino file with their exact normals and curvatures.

    Parameters
    ----------
    path : path
        A .3dm file with surfaces, polysurfaces or extrusions.
    layer : str
        Only what is on this layer, and below.
    edge_length : float, optional
        Length of the edges of the mesh on the surfaces, instead of numbers of rows.
    n_u, n_v : int
        Rows of faces along u and v of each surface.
    units : str
        Units that the file must have, if it names any; in a graph, those of the graph.

    Returns
    -------
    Surface
        A mesh whose vertices lie on the surfaces, with the normals, principal curvatures and
        directions of the surfaces there, in the units of the file.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> import rhino3dm
    >>> from spheremesh.nodes import read_surface
    >>> ball = rhino3dm.Sphere(rhino3dm.Point3d(0, 0, 0), 2.0).ToNurbsSurface()
    >>> model = rhino3dm.File3dm()
    >>> with TemporaryDirectory() as folder:
    ...     _ = model.Objects.AddSurface(ball), model.Write(f"{folder}/ball.3dm", 8)
    ...     surface = read_surface(f"{folder}/ball.3dm", edge_length=0.5)
    >>> surface.mesh.n_faces, surface.curvatures.mean().round(9)
    (325, np.float64(-0.5))
    """
    content = surface_files.read_surface(path, layer, n_u, n_v, edge_length)
    _check_units(path, content.units, units)
    for remark in content.remarks:
        warn(remark)
    return content.surface


@node
def write_mesh(mesh: Mesh | SphereMesh, path: WritePath) -> str:
    """Write a mesh to a file.

    Parameters
    ----------
    mesh : Mesh or SphereMesh
        The mesh; of a sphere mesh its vertices and faces.
    path : path
        Ends in .obj, .off, .ply, .stl or .3dm.

    Returns
    -------
    str
        The path.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from spheremesh.nodes import vase_mesh, write_mesh
    >>> with TemporaryDirectory() as folder:
    ...     Path(write_mesh(vase_mesh(12, 6), f"{folder}/vase.ply")).read_bytes()[:3]
    b'ply'
    """
    if isinstance(mesh, SphereMesh):
        mesh = mesh.mesh
    return str(writer.write_mesh(mesh, path))


@node
def torus_mesh(
    n_around: Count = 48, n_across: Count = 24, major_radius: Length = 2.0,
    minor_radius: Length = 1.0,
) -> Mesh:  # fmt: skip
    """Closed circular net on a torus.

    Parameters
    ----------
    n_around, n_across : int
        Faces along the large and the small circles.
    major_radius, minor_radius : float
        Radius of the core circle and of the tube.

    Returns
    -------
    Mesh
        Quadrilaterals.

    Examples
    --------
    >>> from spheremesh.nodes import torus_mesh
    >>> mesh = torus_mesh(n_around=12, n_across=6)
    >>> mesh.n_faces, mesh.n_vertices
    (72, 72)
    """
    return surfaces.torus_net(n_around, n_across, major_radius, minor_radius)


@node
def ellipsoid_mesh(
    n_around: Count = 32,
    n_across: Count = 16,
    radius: Length = 1.0,
    height: Length = 1.5,
    latitude: Annotated[float, Port(unit="deg", min=0, max=90)] = 70.0,
) -> Mesh:
    """Circular net on an ellipsoid of revolution, cut off below its poles.

    Parameters
    ----------
    n_around, n_across : int
        Faces along the parallels and the meridians.
    radius, height : float
        Half axes across and along z.
    latitude : float
        Reduced latitude at which the caps are cut off, below 90.

    Returns
    -------
    Mesh
        Quadrilaterals.

    Examples
    --------
    >>> from spheremesh.nodes import ellipsoid_mesh
    >>> ellipsoid_mesh(n_around=12, n_across=6).vertices.max(axis=0).round(2)
    array([1.  , 1.  , 1.41])
    """
    angle = float(np.radians(latitude))
    return surfaces.ellipsoid_net(n_around, n_across, radius, height, angle)


@node
def catenoid_mesh(
    n_around: Count = 32, n_across: Count = 16, waist: Length = 1.0, height: Length = 1.0
) -> Mesh:
    """Circular net on a catenoid.

    Parameters
    ----------
    n_around, n_across : int
        Faces along the parallels and the meridians.
    waist : float
        Smallest radius.
    height : float
        Half of the height.

    Returns
    -------
    Mesh
        Quadrilaterals.

    Examples
    --------
    >>> from spheremesh.nodes import catenoid_mesh
    >>> catenoid_mesh(n_around=12, n_across=6).n_faces
    72
    """
    return surfaces.catenoid_net(n_around, n_across, waist, height)


@node
def enneper_mesh(n: Count = 16, size: Length = 0.9) -> Mesh:
    """Circular net that is a discrete Enneper surface.

    Parameters
    ----------
    n : int
        Faces along each side.
    size : float
        Half width of the parameter square; below 1 the surface does not meet itself.

    Returns
    -------
    Mesh
        Quadrilaterals.

    Examples
    --------
    >>> from spheremesh.nodes import enneper_mesh
    >>> enneper_mesh(n=8).n_faces
    64
    """
    return surfaces.enneper_net(n, size)


@node
def vase_mesh(
    n_around: Count = 32,
    n_across: Count = 16,
    radius: Length = 1.0,
    height: Length = 3.0,
    amplitude: Annotated[float, Port(min=-1, max=1)] = 0.3,
) -> Mesh:
    """Circular net on a vase: a cylinder whose radius swings by a sine.

    Parameters
    ----------
    n_around, n_across : int
        Faces along the parallels and the meridians.
    radius, height : float
        Mean radius and height.
    amplitude : float
        Swing of the radius relative to the mean one.

    Returns
    -------
    Mesh
        Quadrilaterals.

    Examples
    --------
    >>> from spheremesh.nodes import vase_mesh
    >>> mesh = vase_mesh(n_around=12, n_across=6)
    >>> mesh.n_faces, mesh.n_vertices
    (72, 84)
    """
    return surfaces.vase_net(n_around, n_across, radius, height, amplitude)


@node
def roof_mesh(n_span: Count = 24, n_length: Count = 60, length: Length = 80.0) -> Mesh:
    """Circular net of a freeform hall roof, to try things on.

    Parameters
    ----------
    n_span, n_length : int
        Faces across and along the hall.
    length : float
        Length of the hall.

    Returns
    -------
    Mesh
        Quadrilaterals with exact circumcircles, of both signs of Gaussian curvature.

    Examples
    --------
    >>> from spheremesh.nodes import roof_mesh
    >>> roof_mesh(n_span=6, n_length=12).n_faces
    72
    """
    return surfaces.roof_net(n_span, n_length, length)


@node
def triangulated_surface(
    shape: triangulated.SampleShape = "bump",
    edge_length: Annotated[float, Port(min=0)] = 0.1,
    seed: Annotated[int, Port(min=0)] | None = None,
) -> SampledSurface:
    """A triangulated sample surface with exact normals, to try remeshing on.

    Parameters
    ----------
    shape : {"torus", "annulus", "hypar", "bump", "ellipsoid", "waves"}
        A torus, a ring of revolution, a saddle, a hill, a triaxial ellipsoid without its
        poles, a wavy sheet; all measure about 2.
    edge_length : float
        Mean length of the edges along the parameter lines.
    seed : int, optional
        Moves the vertices along the surface at random; a regular grid without.

    Returns
    -------
    mesh : Mesh
        Triangles.
    normals : (V, 3) float array
        Unit normals of the smooth surface.

    Examples
    --------
    >>> from spheremesh.nodes import triangulated_surface
    >>> surface = triangulated_surface("torus", edge_length=0.5)
    >>> surface.mesh.n_faces, surface.normals.shape
    (450, (225, 3))
    """
    return SampledSurface(*triangulated.triangulated_surface(shape, edge_length, seed))
