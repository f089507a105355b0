"""Varied mesh files of several libraries: read right, repaired right, or refused in one line.

    python benchmarks/varied_files.py [FOLDER] [--markdown]

Writes files with trimesh, meshio, rhino3dm, libigl, ezdxf and by hand, reads each in a process
of its own and compares faces and vertices with what was written. The meshes of FOLDER are
compared with what trimesh reads. A row is a file: how it ended, CPU seconds, megabytes, and
what was said. The exit code counts rows that are wrong.
"""

import argparse
import multiprocessing
import resource
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import damaged_meshes
import numpy as np
from library_files import Case, Faces, library_cases

from spheremesh import Mesh, nodes
from spheremesh.kernel.errors import SpheremeshError

MOST_CPU, MOST_MEGABYTES = 5.0, 1000


def corner_points(mesh: Mesh) -> Faces:
    """The corners of each face."""
    points = mesh.vertices[mesh.corners]
    return [points[start:end] for start, end in pairwise(mesh.offsets.tolist())]


def same_faces(found: Faces, wanted: Faces, tolerance: float) -> str:
    """What differs between two lists of faces, in any order and from any first corner."""
    if len(found) != len(wanted):
        return f"{len(found)} faces instead of {len(wanted)}"
    degrees = [Counter(len(face) for face in faces) for faces in (found, wanted)]
    if degrees[0] != degrees[1]:
        return f"degrees {dict(degrees[0])} instead of {dict(degrees[1])}"
    from scipy.spatial import KDTree

    centres = np.array([face.mean(axis=0) for face in wanted])
    distances, nearest = KDTree(centres).query([face.mean(axis=0) for face in found])
    if len(set(nearest.tolist())) < len(found) or distances.max() > tolerance:
        return f"faces {distances.max():.2g} off"
    for face, i in zip(found, nearest.tolist(), strict=True):
        gaps = [np.abs(np.roll(face, k, axis=0) - wanted[i]).max() for k in range(len(face))]
        if min(gaps) > tolerance:
            return f"corners {min(gaps):.2g} off or turned over"
    return ""


def judged(mesh: Mesh, case: Case) -> str:
    """What is wrong with a mesh that was read, or nothing."""
    if case.check is not None:
        return case.check(mesh)
    if case.faces is None:
        return "read, though it should be refused"
    fault = same_faces(corner_points(mesh), case.faces, case.tolerance)
    used = len(np.unique(mesh.corners))
    if not fault and case.n_vertices and used != case.n_vertices:
        fault = f"{used} vertices instead of {case.n_vertices}"
    return fault


def one_line(error: Exception) -> str:
    """An error of our own is a line; any other is a fault."""
    text = str(error)
    if not isinstance(error, SpheremeshError) or "\n" in text:
        return f"FAULT {type(error).__name__}: {text}"
    return text


def read(case: Case) -> tuple[str, str]:
    """How reading ended, and what was said."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        fault = ""
        try:
            mesh = nodes.read_mesh(str(case.path), case.layer)
        except Exception as error:  # noqa: BLE001
            fault = one_line(error)
        else:
            wrong = judged(mesh, case)
            said = "; ".join(str(each.message) for each in caught)
            if not wrong and case.remark not in said:
                wrong = f"does not say {case.remark!r}"
            if not wrong:
                return "read right", said
            fault = f"WRONG {wrong}; {said}"
    if repaired := repair(case) if case.may_be_repaired else "":
        return ("repaired right" if repaired == "right" else "WRONG"), f"{repaired}: {fault}"
    is_refused = not fault.startswith(("WRONG", "FAULT")) and case.refusal in fault
    is_right = is_refused and bool(case.refusal or case.may_be_repaired)
    return ("refused" if is_right else "WRONG"), fault


def repair(case: Case) -> str:
    """The same with the node that repairs, where there is one: "right" or what is wrong."""
    if not hasattr(nodes, "repair_mesh"):
        return ""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            found = nodes.repair_mesh(str(case.path))
        except Exception as error:  # noqa: BLE001
            return one_line(error)
    return judged(found.mesh, case) or "right"


def in_a_process(case: Case) -> tuple[str, str, float, float]:
    """Outcome, what was said, CPU seconds and megabytes of a process."""

    def work(pipe: Any) -> None:  # noqa: ANN401
        before = resource.getrusage(resource.RUSAGE_SELF)
        outcome, said = read(case)
        own, children = (
            resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
        )
        cpu = own.ru_utime + own.ru_stime - before.ru_utime - before.ru_stime
        cpu += children.ru_utime + children.ru_stime
        pipe.send((outcome, said, cpu, max(own.ru_maxrss, children.ru_maxrss) / 1024))

    ours, theirs = multiprocessing.Pipe()
    process = multiprocessing.get_context("fork").Process(target=work, args=(theirs,))
    process.start()
    theirs.close()
    try:
        answer = ours.recv() if ours.poll(60) else ("WRONG", "hangs", 60.0, 0.0)
    except EOFError:
        answer = ("WRONG", "the process ended", 0.0, 0.0)
    process.kill()
    process.join()
    return answer


def folder_cases(folder: Path) -> Iterator[Case]:
    """The meshes of a folder, as trimesh reads them: points, and triangles in fans."""
    import trimesh

    for path in sorted(folder.iterdir()):
        if path.suffix.lower() not in (".obj", ".off", ".ply", ".stl"):
            continue
        other = trimesh.load_mesh(path, process=False, maintain_order=True)
        points, n_triangles = np.asarray(other.vertices), len(other.faces)
        yield Case(f"{path.name}", path, check=as_trimesh(points, n_triangles))


def as_trimesh(points: Any, n_triangles: int) -> Callable[[Mesh], str]:  # noqa: ANN401
    """Whether a mesh has these points and so many triangles if cut."""

    def check(mesh: Mesh) -> str:
        from scipy.spatial import KDTree

        if (mesh.degrees - 2).sum() != n_triangles:
            return f"{(mesh.degrees - 2).sum()} triangles instead of {n_triangles}"
        off = max(KDTree(mesh.vertices).query(points)[0].max(),
                  KDTree(points).query(mesh.vertices)[0].max())  # fmt: skip
        return f"points {off:.2g} off" if off > 1e-9 * np.abs(points).max() else ""

    return check


@dataclass(frozen=True)
class Row:
    """A line of the table."""

    name: str
    outcome: str
    said: str
    cpu: float
    megabytes: float

    @property
    def is_wrong(self) -> bool:
        """Whether the row is against what is asked."""
        slow = self.cpu > MOST_CPU or self.megabytes > MOST_MEGABYTES
        return slow or self.outcome.startswith("WRONG")


def main() -> None:
    """Write, read, compare, print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", nargs="?", type=Path, help="more meshes")
    parser.add_argument("--markdown", action="store_true", help="print the table as Markdown")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    rows: list[Row] = []
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        cases = [*library_cases(folder), *damaged_meshes.cases(folder)]
        cases += list(folder_cases(options.folder)) if options.folder else []
        for case in cases:
            outcome, said, cpu, megabytes = in_a_process(case)
            row = Row(case.name, outcome, said.replace(place + "/", ""), cpu, megabytes)
            rows.append(row)
            cells = (row.name, row.outcome, f"{row.cpu:.2f}", f"{row.megabytes:.0f}", row.said)
            line = "{:38} {:14} {:>6} s {:>5} MB  {}".format(*cells)
            if options.markdown:
                line = f"| {' | '.join(cells)} |"
            print(line, flush=True)
    counts = Counter(row.outcome for row in rows)
    print(f"{len(rows)} files: " + ", ".join(f"{n} {what}" for what, n in counts.items()))
    print(f"most: {max(r.cpu for r in rows):.2f} s, {max(r.megabytes for r in rows):.0f} MB")
    sys.exit(sum(row.is_wrong for row in rows))


if __name__ == "__main__":
    main()
