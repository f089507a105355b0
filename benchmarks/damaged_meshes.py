"""Files as people have them: dialects, cut off, unwelded, flipped; for varied_files.py."""

import gzip
import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from library_files import Case, case, faces_of, net, triangles_of

from spheremesh import Mesh
from spheremesh.fabrication.mesh_files.writer import write_mesh


def obj_text(mesh: Mesh, number: str = "{!r}") -> str:
    """An OBJ file whose numbers are written so."""
    rows = ["v " + " ".join(map(number.format, row)) for row in mesh.vertices.tolist()]
    rows += ["f " + " ".join(map(str, face + 1)) for face in mesh.faces]
    return "\n".join(rows) + "\n"


def cases(folder: Path) -> Iterator[Case]:
    """All of them."""
    place = folder / "by hand"
    place.mkdir()
    yield from _dialects(place)
    yield from _mended(place)
    yield from _refused(place)
    yield from _for_repair(place)


def _saved(folder: Path, name: str, content: str | bytes) -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def _dialects(folder: Path) -> Iterator[Case]:
    mesh = net()
    text = obj_text(mesh)
    off = write_mesh(mesh, folder / "plain.off").read_text()
    words = off.split()[1:]
    broken = "\n".join(" ".join(words[i : i + 7]) for i in range(0, len(words), 7))
    facets = write_mesh(triangles_of(mesh), folder / "plain.stl").read_bytes()
    negative = text.splitlines()
    negative = [
        "f " + " ".join(str(int(word) - 1 - mesh.n_vertices) for word in line.split()[1:])
        if line[0] == "f" else line for line in negative
    ]  # fmt: skip
    files = {
        "wrapped.off": "OFF\n" + broken + "\n",
        "modelnet.off": "OFF" + off.split("\n", 1)[1],
        "fortran.obj": obj_text(mesh, "{:.17E}").replace("E", "D"),
        "negative.obj": "\n".join(negative) + "\n",
        "slashes.obj": text.replace("\nf ", "\nvt 0 0\nvn 0 0 1\nf ").replace(" ", "  "),
        "old-mac.obj": text.replace("\n", "\r"),
        "mark.obj": b"\xef\xbb\xbf" + text.encode(),
    }
    for name, content in files.items():
        yield case(f"by hand {name}", _saved(folder, name, content), mesh)
    path = _saved(folder, "solid.stl", b"solid lies".ljust(80) + facets[80:])
    yield case("by hand binary solid.stl", path, triangles_of(mesh), 1e-6)
    upper = "SOLID X\n" + "".join(
        "FACET NORMAL 0 0 1\nOUTER LOOP\n"
        + "".join("VERTEX {!r} {!r} {!r}\n".format(*row) for row in face.tolist())
        + "ENDLOOP\nENDFACET\n"
        for face in faces_of(triangles_of(mesh))
    )
    path = _saved(folder, "upper.stl", upper + "ENDSOLID X\n")
    yield case("by hand upper.stl", path, triangles_of(mesh))
    grouped = text.replace("f 1 ", "g Roof\nf 1 ", 1) + "g RoofEdge\nv 90 0 0\nv 91 0 0\n"
    path = _saved(folder, "groups.obj", grouped + "v 90 1 0\nf -3 -2 -1\n")
    yield case("by hand groups.obj --layer Roof", path, mesh, layer="Roof")


def _mended(folder: Path) -> Iterator[Case]:
    mesh = net()
    soup = Mesh(mesh.vertices[mesh.corners], np.arange(len(mesh.corners)).reshape(-1, 4))
    for suffix in (".obj", ".off", ".ply"):
        path = write_mesh(soup, folder / f"soup{suffix}")
        yield case(f"by hand unwelded{suffix}", path, mesh, remark="vertices of its own")
    path = _saved(folder, "slivers.obj", obj_text(mesh) + "f 1 2 2\nf 5 5 6\n")
    yield case("by hand slivers.obj", path, mesh, remark="2 triangles have equal corners")
    path = _saved(folder, "lines.obj", obj_text(mesh) + "l 1 2 3\np 4\n")
    yield case("by hand lines.obj", path, mesh, remark="1 line element and 1 point element")
    path = _saved(folder, "no-end.obj", obj_text(mesh)[:-1])
    yield case("by hand no-end.obj", path, mesh, remark="no end")
    path = _saved(folder, "unused.obj", obj_text(mesh) + "v 9 9 9\n")
    yield case("by hand unused.obj", path, mesh, remark="1 vertex belongs to no face")


def _refused(folder: Path) -> Iterator[Case]:
    mesh, text = net(), obj_text(net())
    triangles = triangles_of(mesh)
    binary = write_mesh(triangles, folder / "whole.stl").read_bytes()
    ply = write_mesh(mesh, folder / "whole.ply").read_bytes()
    far = Mesh(mesh.vertices + np.array([450_000, 5_400_000, 300]), mesh.faces)
    free = "v 0 0 0\nv 4 0 1\nv 0 4 1\nv 4 4 0\ncstype bspline\n"
    free += "deg 1 1\nsurf 0 1 0 1 1 2 3 4\nend\n"
    files: dict[str, tuple[str | bytes, str]] = {
        "cut.stl": (binary[: len(binary) // 2], "cut short"),
        "cut-text.stl": ("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "line 4"),
        "cut.ply": (ply[: len(ply) // 2], "cut short"),
        "cut.off": ("OFF\n4 1 0\n0 0 0\n1 0 0\n", "the file ends after"),
        "cut.obj": (text[: text.rindex("f ") + 5], "cut off"),
        "misspelt.ply": (ply.replace(b"property double x", b"proprety double x"), "line 4"),
        "free-form.obj": (free, "free-form surface"),
        "wide.obj": (text.encode("utf-16"), "UTF-8"),
        "packed.obj": (gzip.compress(text.encode()), "unpack"),
        "page.stl": ("<!DOCTYPE html><html></html>", "web page"),
        "renamed.obj": (ply, ".ply"),
        "six-digits.obj": (obj_text(far, "{:.6g}"), "6 significant digits"),
        "comma.obj": (text.replace("v 0.0 1.5", "v 0,0 1,5"), "decimal point"),
        "empty.obj": ("", "empty"),
        "no-faces.obj": ("v 0 0 0\n", "no faces"),
        "words.off": ("hello world\n", "expected OFF"),
        "damaged.3dm": (b"3D Geometry File Format        8" + bytes(200), "damaged"),
    }
    for name, (content, refusal) in files.items():
        yield Case(f"by hand {name}", _saved(folder, name, content), refusal=refusal)
    os.mkfifo(folder / "pipe.obj")
    yield Case("by hand pipe.obj", folder / "pipe.obj", refusal="a pipe")
    (folder / "folder.ply").mkdir()
    yield Case("by hand folder.ply", folder / "folder.ply", refusal="folder")
    yield Case("by hand missing.off", folder / "missing.off", refusal="no such file")


def _for_repair(folder: Path) -> Iterator[Case]:
    """What only a repair reads right; without the node, it must be refused or read as it is."""
    mesh = net()
    text = obj_text(mesh)
    first = text.splitlines()[mesh.n_vertices]
    turned = "f " + " ".join(reversed(first.split()[1:]))
    files = {
        "duplicate.obj": text + first + "\n",
        "duplicate-turned.obj": text + turned + "\n",
        "flipped.obj": text.replace(first + "\n", turned + "\n"),
    }
    for name, content in files.items():
        path = _saved(folder, name, content)
        yield case(f"by hand {name}", path, mesh, may_be_repaired=True)
