"""Mesh files that other libraries write, with the faces that they hold; for varied_files.py."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spheremesh import Mesh, nodes
from spheremesh.fabrication.mesh_files.writer import write_mesh

Faces = list[NDArray[np.float64]]
"""Corners of each face."""


@dataclass(frozen=True)
class Case:
    """A file, and what reading it must give.

    `faces` are the corners of each face, None where the file must be refused; `refusal` and
    `remark` are words that must be said; `check` judges where faces cannot be listed.
    """

    name: str
    path: Path
    faces: Faces | None = None
    n_vertices: int = 0
    tolerance: float = 1e-12
    refusal: str = ""
    remark: str = ""
    layer: str = ""
    check: Callable[[Mesh], str] | None = None
    may_be_repaired: bool = False


def faces_of(mesh: Mesh) -> Faces:
    """Corners of each face."""
    return [mesh.vertices[face] for face in mesh.faces]


def net(n: int = 6, m: int = 8, side: float = 1.5) -> Mesh:
    """A net of quads, as a roof has."""
    x, y = np.meshgrid(side * np.arange(n + 1.0), side * np.arange(m + 1.0), indexing="ij")
    points = np.stack([x, y, 3 * np.sin(x / 5) + y**2 / 40], axis=-1).reshape(-1, 3)
    ids = np.arange(len(points)).reshape(n + 1, m + 1)
    quads = [ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]]
    return Mesh(points, np.stack(quads, axis=-1).reshape(-1, 4))


def mixed() -> Mesh:
    """Triangles, quads and a hexagon."""
    mesh = net(4, 4)
    faces: list[Any] = [face.tolist() for face in mesh.faces]
    a, b = faces[5], faces[6]  # neighbours along y become a hexagon
    hexagon = [a[0], a[1], a[2], b[2], b[3], b[0]]
    triangles = [[faces[0][0], *faces[0][1:3]], [faces[0][0], *faces[0][2:]]]
    return Mesh(mesh.vertices, [hexagon, *triangles, *faces[1:5], *faces[7:]])


def triangles_of(mesh: Mesh) -> Mesh:
    """Each quad as two triangles."""
    quads = mesh.corners.reshape(-1, 4)
    return Mesh(mesh.vertices, np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]]))


def case(name: str, path: Path, mesh: Mesh, tolerance: float = 1e-12, **more: Any) -> Case:  # noqa: ANN401
    """A file that must be read as this mesh."""
    return Case(
        name, path, faces_of(mesh), len(np.unique(mesh.corners)),
        tolerance * float(np.abs(mesh.vertices).max()), **more,
    )  # fmt: skip


def library_cases(folder: Path) -> Iterator[Case]:
    """Files of all libraries."""
    closed = triangles_of(nodes.torus_mesh(12, 8))
    shapes = {"roof": triangles_of(net()), "torus": closed}
    for library in (_own, _igl, _trimesh, _meshio, _ezdxf, _rhino):
        (folder / library.__name__).mkdir()
        yield from library(folder / library.__name__, shapes)


def _own(folder: Path, _: dict[str, Mesh]) -> Iterator[Case]:
    far = Mesh(net().vertices + np.array([450_000 / 7, 5_400_000, 300]), net().faces)
    tiny = Mesh(net().vertices * 1e-3, net().faces)
    for name, mesh in {"quads": net(), "polygons": mixed(), "far": far, "tiny": tiny}.items():
        for suffix in (".obj", ".off", ".ply", ".3dm"):
            path = write_mesh(mesh, folder / f"{name}{suffix}")
            # .3dm gives numbers back to the last digits; its meshes are welded.
            yield case(f"spheremesh {name}{suffix}", path, mesh)


def _igl(folder: Path, shapes: dict[str, Mesh]) -> Iterator[Case]:
    import igl

    for name, mesh in shapes.items():
        triangles = mesh.corners.reshape(-1, 3)
        tolerances = {".obj": 1e-9, ".off": 1e-9, ".ply": 1e-5, ".stl": 1e-6}
        for suffix, tolerance in tolerances.items():
            path = folder / f"{name}{suffix}"
            igl.write_triangle_mesh(str(path), mesh.vertices, triangles)
            yield case(f"libigl {name}{suffix}", path, mesh, tolerance)


def _trimesh(folder: Path, shapes: dict[str, Mesh]) -> Iterator[Case]:
    import trimesh

    for name, mesh in shapes.items():
        other = trimesh.Trimesh(mesh.vertices, mesh.corners.reshape(-1, 3), process=False)
        kinds: dict[str, dict[str, Any]] = {
            ".obj": {}, ".off": {}, ".ply": {}, ".stl": {}, "-text.ply": {"encoding": "ascii"},
            "-text.stl": {"file_type": "stl_ascii"},
        }  # fmt: skip
        for suffix, options in kinds.items():
            path = folder / f"{name}{suffix}"
            other.export(path, **options)
            yield case(f"trimesh {name}{suffix}", path, mesh, 1e-6)
        colored = other.copy()
        colored.visual.vertex_colors = np.full((mesh.n_vertices, 4), 200, np.uint8)
        colored.export(folder / f"{name}-colors.ply")
        yield case(f"trimesh {name}-colors.ply", folder / f"{name}-colors.ply", mesh, 1e-6)
        turn = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
        for suffix in (".glb", ".gltf"):
            place = folder / f"{name}{suffix[1:]}"
            place.mkdir()
            scene = trimesh.Scene()
            scene.add_geometry(other, geom_name=name, transform=turn)
            if suffix == ".glb":
                scene.export(place / f"{name}.glb")
            else:
                for file, data in scene.export(file_type="gltf").items():
                    (place / file.replace("model", name)).write_bytes(data)
            path = place / f"{name}{suffix}"
            yield case(f"trimesh {name}{suffix}", path, mesh, 1e-6, remark="y upwards")


def _meshio(folder: Path, shapes: dict[str, Mesh]) -> Iterator[Case]:
    import meshio

    quads, roof = net(), shapes["roof"]
    cells = [("quad", quads.corners.reshape(-1, 4))]
    kinds: dict[str, dict[str, Any]] = {
        ".obj": {}, ".vtu": {}, ".vtk": {}, "-text.vtk": {"binary": False}, ".mesh": {},
        "-2.msh": {"file_format": "gmsh22"}, "-4.msh": {"file_format": "gmsh"}, ".inp": {},
        ".bdf": {}, ".ply": {}, "-text.ply": {"binary": False}, ".avs": {},
    }  # fmt: skip
    for suffix, options in kinds.items():
        path = folder / f"quads{suffix}"
        meshio.Mesh(quads.vertices, cells).write(path, **options)
        tolerance = 1e-4 if suffix == ".bdf" else 1e-8
        yield case(f"meshio quads{suffix}", path, quads, tolerance)
    triangles = meshio.Mesh(roof.vertices, [("triangle", roof.corners.reshape(-1, 3))])
    for suffix in (".off", ".stl", ".obj", ".vtu"):
        path = folder / f"roof{suffix}"
        triangles.write(path)
        yield case(f"meshio roof{suffix}", path, roof, 1e-6)
    cells = [("polygon", face[None]) for face in mixed().faces]
    meshio.Mesh(mixed().vertices, cells).write(folder / "polygons.vtu")
    yield case("meshio polygons.vtu", folder / "polygons.vtu", mixed())
    meshio.Mesh(roof.vertices, [("tetra", [[0, 1, 9, 10]])]).write(folder / "tets.vtu")
    yield Case("meshio tets.vtu", folder / "tets.vtu", refusal="tetra")


def _ezdxf(folder: Path, _: dict[str, Mesh]) -> Iterator[Case]:
    from ezdxf.addons import meshex
    from ezdxf.math import Vec3
    from ezdxf.render import MeshBuilder

    for name, mesh in {"polygons": mixed(), "roof": triangles_of(net())}.items():
        builder = MeshBuilder()
        builder.vertices.extend(map(Vec3, mesh.vertices.tolist()))
        builder.faces.extend(tuple(face.tolist()) for face in mesh.faces)
        files: dict[str, Any] = {
            ".obj": meshex.obj_dumps, ".off": meshex.off_dumps, ".ply": meshex.ply_dumpb,
        }  # fmt: skip
        if name == "roof":
            files |= {"-text.stl": meshex.stl_dumps, ".stl": meshex.stl_dumpb}
        for suffix, dump in files.items():
            content = dump(builder)
            path = folder / f"{name}{suffix}"
            path.write_bytes(content if isinstance(content, bytes) else content.encode())
            yield case(f"ezdxf {name}{suffix}", path, mesh, 1e-6)


def _rhino(folder: Path, _: dict[str, Mesh]) -> Iterator[Case]:
    import rhino3dm

    rhino: Any = rhino3dm

    def mesh_of(mesh: Mesh) -> Any:  # noqa: ANN401
        result = rhino.Mesh()
        for point in mesh.vertices.tolist():
            result.Vertices.Add(*point)
        for face in mesh.faces:
            result.Faces.AddFace(*face.tolist())
        return result

    def saved(name: str, *objects: Any) -> Path:  # noqa: ANN401
        model = rhino.File3dm()
        for each in objects:
            model.Objects.Add(each)
        model.Write(str(folder / name), 8)
        return folder / name

    quads = net()
    yield case("rhino3dm quads.3dm", saved("quads.3dm", mesh_of(quads)), quads, 1e-6)
    soup = Mesh(quads.vertices[quads.corners], np.arange(len(quads.corners)).reshape(-1, 4))
    yield case("rhino3dm unwelded.3dm", saved("unwelded.3dm", mesh_of(soup)), quads, 1e-6)
    halves = [
        Mesh(quads.vertices, quads.corners.reshape(-1, 4)[part])
        for part in (slice(0, 24), slice(24, None))
    ]
    path = saved("halves.3dm", *map(mesh_of, halves))
    yield case("rhino3dm two meshes.3dm", path, quads, 1e-6)
    sphere = rhino.Sphere(rhino.Point3d(1, 2, 3), 2.0)

    def on_sphere(mesh: Mesh) -> str:
        off = np.abs(np.linalg.norm(mesh.vertices - [1, 2, 3], axis=1) - 2).max()
        return f"{off:.2g} off the sphere" if off > 1e-9 else ""

    for name, each in {"surface": sphere.ToNurbsSurface(), "brep": sphere.ToBrep()}.items():
        path = saved(f"{name}.3dm", each)
        yield Case(f"rhino3dm {name}.3dm", path, check=on_sphere)
    curve = rhino.LineCurve(rhino.Point3d(0, 0, 0), rhino.Point3d(1, 0, 0))
    yield Case("rhino3dm curve.3dm", saved("curve.3dm", curve), refusal="no meshes")
