"""Readers to be fuzzed, and small whole files of each to start from."""

import struct
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from spheremesh import Graph, Mesh
from spheremesh.fabrication.mesh_files.reader import content_mesh, read_content
from spheremesh.fabrication.mesh_files.writer import write_mesh

POINTS = [
    (0, 0, 0),
    (1, 0, 0.25),
    (2, 0, 0),
    (0, 1, 1 / 3),
    (1, 1, 0.5),
    (2, 1, 0),
    (1, 2, 0.1),
]
FACES = [(0, 1, 4, 3), (1, 2, 5, 4), (3, 4, 6), (4, 5, 6)]
TRIANGLES = [(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (3, 4, 6), (4, 5, 6)]


@dataclass(frozen=True)
class Reader:
    """What is read: the suffix of its files, whole files to start from, and how."""

    suffix: str
    seeds: Callable[[], list[bytes]]
    read: Callable[[Path], Any]


def read_a_mesh(path: Path) -> Any:  # noqa: ANN401
    """What a mesh file holds; and its mesh, which may be refused."""
    content = read_content(path)
    content_mesh(content, path)
    return content


def read_a_graph(path: Path) -> Any:  # noqa: ANN401
    """A graph file, loaded and drawn, not run."""
    return Graph.load(path).mermaid()


def _written(suffix: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = write_mesh(Mesh(POINTS, FACES), f"{folder}/a{suffix}")
        return path.read_bytes()


def _obj_seeds() -> list[bytes]:
    points = "".join("v {:g} {:g} {:g}\n".format(*each) for each in POINTS)
    rich = "# a roof\nmtllib a.mtl\no Roof\n" + points + "vt 0 0\nvn 0 0 1\ng North Glass\n"
    rich += "usemtl steel\ns off\nf 1/1/1 2/1/1 \\\n 5/1/1 4/1/1\nf -6//1 -5//1 -2//1 -3//1\n"
    rich += "g South\nf 4 5 7\nf 5 6 7\nl 1 2 3\np 4\ncstype bezier\ndeg 1 1\n"
    soup = "".join(
        f"v {x} {y} {z}\n" for face in FACES for x, y, z in (POINTS[i] for i in face)
    )
    soup += "f 1 2 3 4\nf 5 6 7 8\nf 9 10 11\nf 12 13 14\n"
    return [_written(".obj"), rich.encode(), soup.encode()]


def _off_seeds() -> list[bytes]:
    head = f"{len(POINTS)} {len(FACES)} 0\n"
    rows = [" ".join(map(str, (len(face), *face))) for face in FACES]
    colored = "".join("{} {} {} 255 0 0 255\n".format(*each) for each in POINTS)
    broken = " ".join(str(x) for each in POINTS for x in each).replace(" 1 ", "\n1 ")
    painted = "".join(f"{row} 0.5 0.5 0.5\n" for row in rows)
    return [
        _written(".off"),
        f"COFF\n# c\n{head}{colored}{painted}".encode(),
        f"OFF{head}{broken}\n{' '.join(rows)}\n".encode(),
    ]


def _ply_seeds() -> list[bytes]:
    def head(order: str, extra: str = "") -> bytes:
        return (
            f"ply\nformat {order} 1.0\ncomment c\nelement vertex {len(POINTS)}\n{extra}"
            "property float x\nproperty float y\nproperty float z\n"
            f"element face {len(FACES)}\nproperty list uchar int vertex_indices\n"
            "property list uchar float texcoord\nend_header\n"
        ).encode()

    text = "".join("{} {} {}\n".format(*each) for each in POINTS)
    text += "".join(" ".join(map(str, (len(f), *f))) + " 2 0 0\n" for f in FACES)
    binary = b"".join(struct.pack(">B3f", 9, *each) for each in POINTS)
    for face in FACES:
        binary += struct.pack(f">B{len(face)}iB2f", len(face), *face, 2, 0, 0)
    order = "binary_big_endian"
    return [
        _written(".ply"),
        head("ascii") + text.encode(),
        head(order, "property uchar red\n") + binary,
    ]


def _stl_seeds() -> list[bytes]:
    facets = "".join(
        "facet normal 0 0 1\nouter loop\n"
        + "".join("vertex {:g} {:g} {:g}\n".format(*POINTS[i]) for i in triangle)
        + "endloop\nendfacet\n"
        for triangle in TRIANGLES
    )
    return [_written(".stl"), f"solid roof\n{facets}endsolid roof\n".encode()]


def other_seeds(suffix: str) -> list[bytes]:
    """Of a format that meshio or trimesh writes."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"a{suffix}"
        if suffix == ".glb":
            import trimesh

            trimesh.Trimesh(POINTS, TRIANGLES, process=False).export(path)
        else:
            import meshio

            meshio.Mesh(np.array(POINTS), [("quad", FACES[:2]), ("triangle", FACES[2:])]).write(
                path
            )
        return [path.read_bytes()]


def _rhino_seeds() -> list[bytes]:
    import rhino3dm

    sphere = rhino3dm.Sphere(rhino3dm.Point3d(0, 0, 0), 2.0)
    seeds = [_written(".3dm")]
    with tempfile.TemporaryDirectory() as folder:
        for add, what in (
            ("AddBrep", sphere.ToBrep()),
            ("AddSurface", sphere.ToNurbsSurface()),
        ):
            model = rhino3dm.File3dm()
            getattr(model.Objects, add)(what)
            model.Write(f"{folder}/a.3dm", 8)
            seeds.append((Path(folder) / "a.3dm").read_bytes())
    return seeds


def _graph_seeds() -> list[bytes]:
    graph = Graph("roof", units="m")
    count = graph.param("moulds", 3, min=1, max=9)
    mesh = graph.add("roof_mesh", n_span=4, n_length=6)
    spheres = graph.add("fit_spheres", mesh=mesh)
    graph.add("cluster_radii", sphere_mesh=spheres, k=count)
    with tempfile.TemporaryDirectory() as folder:
        graph.save(f"{folder}/a.json")
        return [(Path(folder) / "a.json").read_bytes()]


READERS: dict[str, Reader] = {
    "obj": Reader(".obj", _obj_seeds, read_a_mesh),
    "off": Reader(".off", _off_seeds, read_a_mesh),
    "ply": Reader(".ply", _ply_seeds, read_a_mesh),
    "stl": Reader(".stl", _stl_seeds, read_a_mesh),
    "3dm": Reader(".3dm", _rhino_seeds, read_a_mesh),
    "graph": Reader(".json", _graph_seeds, read_a_graph),
    "vtk": Reader(".vtk", lambda: other_seeds(".vtk"), read_a_mesh),
    "vtu": Reader(".vtu", lambda: other_seeds(".vtu"), read_a_mesh),
    "msh": Reader(".msh", lambda: other_seeds(".msh"), read_a_mesh),
    "bdf": Reader(".bdf", lambda: other_seeds(".bdf"), read_a_mesh),
    "inp": Reader(".inp", lambda: other_seeds(".inp"), read_a_mesh),
    "glb": Reader(".glb", lambda: other_seeds(".glb"), read_a_mesh),
}
