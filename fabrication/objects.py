"""Meshes, panels and beams as objects of trimesh, pyvista and CadQuery.

Spheres and beams come as triangles on their exact surfaces, with what each belongs to; the
normals that pyvista gets are exact. Ends of beams are square there, not mitred. Plain meshes
keep their polygons in pyvista. What comes back goes through the constructors of `Mesh`.
"""

from collections.abc import Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..kernel.arrays import FloatArray, IntArray
from ..kernel.beams.beams import Beams
from ..kernel.beams.triangles import beam_triangles
from ..kernel.errors import InputError, MissingLibraryError
from ..kernel.meshes.mesh import Mesh
from ..kernel.panels.cutting import cut_panels
from ..kernel.panels.panels import Panels
from ..kernel.panels.tessellation import tessellate
from ..kernel.sphere_meshes.fit import face_planes
from ..kernel.sphere_meshes.sphere_mesh import SphereMesh
from ..kernel.spheres.arcs import arc_points, sphere_arcs
from ..kernel.support.annuli import Annuli
from .model import Model
from .solids.cadquery_assembly import to_cadquery
from .triangles import fan_triangles

if TYPE_CHECKING:
    import cadquery
    import pyvista
    import trimesh

TOLERANCE = 0.002
"""How far triangles may be off, relative to a part."""

_STEPS = 16
"""Pieces of the arcs of an annulus."""


@dataclass(frozen=True)
class _Surface:
    """Triangles (T, 3) of points (N, 3), normals (N, 3) if known, and a row of facts each."""

    points: FloatArray
    triangles: IntArray
    facts: Mapping[str, NDArray[Any]]
    normals: FloatArray | None = None


def trimesh_object(shape: Mesh | SphereMesh | Panels | Beams | Annuli) -> "trimesh.Trimesh":
    """Triangles as a `trimesh.Trimesh`; parts and their radii stand in ``face_attributes``.

    Raises MissingLibraryError without trimesh, InputError for what has no surface.
    """
    surface = _surface(shape)
    with _library("trimesh", "formats"):
        import trimesh

        return trimesh.Trimesh(
            surface.points,
            surface.triangles,
            vertex_normals=surface.normals,
            face_attributes=dict(surface.facts),
            process=False,
        )


def pyvista_object(shape: Mesh | SphereMesh | Panels | Beams | Annuli) -> "pyvista.PolyData":
    """Surfaces as a `pyvista.PolyData`; parts and their radii stand in ``cell_data``.

    Raises MissingLibraryError without pyvista, InputError for what has no surface.
    """
    if isinstance(shape, Mesh):
        rows = np.insert(shape.corners, shape.offsets[:-1], shape.degrees)
        return _poly_data(_Surface(shape.vertices, rows, {}))
    surface = _surface(shape)
    corners = np.insert(surface.triangles, 0, 3, axis=1).ravel()
    return _poly_data(_Surface(surface.points, corners, surface.facts, surface.normals))


def cadquery_object(
    shape: Mesh | SphereMesh | Panels | Beams | Annuli, units: str = "m"
) -> "cadquery.Assembly":
    """Exact faces or solids as a CadQuery assembly in millimetres.

    Raises InputError for annuli, which have no thickness, and as `to_cadquery`.
    """
    if isinstance(shape, Annuli):
        raise InputError("annuli have no thickness: give them one with the node beams")
    if isinstance(shape, Beams):
        return to_cadquery(Model(beams=shape, units=units)).children[0]
    return to_cadquery(Model(_panels_of(shape), units=units))


def _panels_of(shape: Mesh | SphereMesh | Panels) -> Panels:
    """Panels, or those that a mesh and its spheres are cut into."""
    if isinstance(shape, Panels):
        return shape
    return cut_panels(face_planes(shape) if isinstance(shape, Mesh) else shape)[0]


def _poly_data(surface: _Surface) -> "pyvista.PolyData":
    with _library("pyvista", "vtk"):
        import pyvista

        result = pyvista.PolyData(surface.points, faces=surface.triangles)
    for name, values in surface.facts.items():
        result.cell_data[name] = values
    if surface.normals is not None:
        result.point_data["Normals"] = surface.normals
        result.point_data.active_normals_name = "Normals"
    return result


@contextmanager
def _library(name: str, extra: str) -> Generator[None]:
    """Turn a missing library into an error that names the extra."""
    try:
        yield
    except ModuleNotFoundError as error:
        if error.name != name:
            raise
        raise MissingLibraryError(
            f"{name} is not installed: pip install 'spheremesh[{extra}]'"
        ) from error


def _surface(shape: Mesh | SphereMesh | Panels | Beams | Annuli) -> _Surface:
    if isinstance(shape, Mesh):
        triangles, faces = fan_triangles(shape)
        return _Surface(shape.vertices, triangles, {"face": faces})
    if isinstance(shape, SphereMesh | Panels):
        return _panel_surface(_panels_of(shape))
    if isinstance(shape, Beams):
        return _beam_surface(shape)
    return _annulus_surface(shape)


def _panel_surface(panels: Panels) -> _Surface:
    if not panels.n_panels:
        raise InputError("there are no panels")
    skin = tessellate(panels, TOLERANCE)
    facts = {
        "face": panels.face_ids[skin.panels],
        "mould": panels.labels[skin.panels],
        "radius": panels.radii[skin.panels],
    }
    return _Surface(skin.points + skin.origin, skin.triangles, facts, skin.normals)


def _beam_surface(beams: Beams) -> _Surface:
    if not beams.n_beams:
        raise InputError("there are no beams")
    pieces = list(beam_triangles(beams, TOLERANCE))
    corners: list[IntArray] = []
    count = 0
    for piece in pieces:
        n_beams, size = (int(n) for n in piece.points.shape[:2])
        starts: IntArray = count + size * np.arange(n_beams)
        corners.append((piece.triangles + starts[:, None, None]).reshape(-1, 3))
        count += n_beams * size
    owners = np.concatenate([np.repeat(each.beams, len(each.triangles)) for each in pieces])
    facts = {
        "edge": beams.annuli.edge_ids[owners],
        "radius": beams.radii[owners, 0],
    }
    return _Surface(
        np.concatenate([each.points.reshape(-1, 3) for each in pieces]),
        np.concatenate(corners),
        facts,
        np.concatenate([each.normals.reshape(-1, 3) for each in pieces]),
    )


def _annulus_surface(annuli: Annuli) -> _Surface:
    """Plane strips between the two arcs."""
    if not annuli.n_annuli:
        raise InputError("there are no annuli")
    count, normals = annuli.n_annuli, annuli.frames[:, 2]
    steps = np.linspace(-1.0, 1.0, _STEPS + 1)
    rims = [
        arc_points(
            sphere_arcs(rows, -normals, annuli.corners[:, 0, k], annuli.corners[:, 1, k]), steps
        )
        for k, rows in enumerate((annuli.outer, annuli.inner))
    ]
    points = np.stack(rims, axis=2) + annuli.origins[:, None, None]
    low = 2 * np.arange(_STEPS)
    strip = np.concatenate(
        [np.stack([low, low + 1, low + 2], 1), np.stack([low + 2, low + 1, low + 3], 1)]
    )
    size = 2 * len(steps)
    owners = np.repeat(np.arange(count), len(strip))
    triangles = (strip + size * np.arange(count)[:, None, None]).reshape(-1, 3)
    facts = {"edge": annuli.edge_ids[owners], "radius": annuli.radii[owners, 0]}
    return _Surface(points.reshape(-1, 3), triangles, facts, np.repeat(normals, size, axis=0))
