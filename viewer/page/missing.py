"""Parts that cannot be made: why, where they would be, and what is beside them.

A panel would be on a face of the mesh, a beam on an edge: without the mesh nobody knows where.
"""

from collections.abc import Mapping, Sequence
from typing import TypedDict

import numpy as np

from ...kernel.arrays import FloatArray
from ...kernel.errors import InputError
from ...kernel.meshes.mesh import Mesh
from ...kernel.panels.panels import Panels
from ...kernel.parts.findings import Finding
from ...kernel.parts.records import part_ids

_PREFIX = "cannot be made: "
"""Of what an audit says of rejected parts."""


_Place = tuple[FloatArray, list[str], list[tuple[int, int]]]


class MissingPart(TypedDict):
    """What a page knows of a part that cannot be made.

    Attributes
    ----------
    id, code, reason : str
        Its name, the number of the finding, and why.
    corners : int
        How many points of ``missing`` are its own: of a face, or both ends of an edge.
    beside : list of str
        Names of the panels next to it.
    edges : list of (int, int)
        Panels by row, and their edges, along which it is missing.
    """

    id: str
    code: str
    reason: str
    corners: int
    beside: list[str]
    edges: list[tuple[int, int]]


def missing_parts(
    panels: Panels | None,
    mesh: Mesh | None,
    rejected: Sequence[Mapping[str, str]],
    absent: Sequence[Finding],
) -> tuple[list[MissingPart], FloatArray]:
    """Faces without a panel and whatever else was rejected; the corners (N, 3) of all.

    Beams, and panels that no report names, are known by what an audit found of parts that are
    absent.
    """
    reasons = {
        found.id: (found.code, found.message.removeprefix(_PREFIX))
        for found in absent
        if found.message.startswith(_PREFIX)
    }
    reasons |= {part["id"]: (part["code"], part["reason"]) for part in rejected}
    if mesh is not None and panels is not None:
        if int(panels.face_ids.max(initial=-1)) >= mesh.n_faces:
            raise InputError(
                f"the reference has {mesh.n_faces} faces, too few for the panels: give the "
                "mesh that they were cut from"
            )
        faces: list[int] = np.setdiff1d(np.arange(mesh.n_faces), panels.face_ids).tolist()
        names = part_ids("P", mesh.n_faces)
        without = {names[face]: ("P100", "cannot be made") for face in faces}
        reasons = without | reasons
    found: list[MissingPart] = []
    points = [np.zeros((0, 3))]
    places = _places(mesh, panels) if mesh is not None and reasons else {}
    for name, (code, reason) in reasons.items():
        place = places.get(name, (points[0], [], []))
        points.append(place[0])
        found.append(
            {
                "id": name, "code": code, "reason": reason, "corners": len(place[0]),
                "beside": place[1], "edges": place[2],
            }
        )  # fmt: skip
    return found, np.concatenate(points)


def _places(mesh: Mesh, panels: Panels | None) -> dict[str, _Place]:
    """Corners of the faces and edges of a mesh by the names of parts, and what is beside."""
    around = mesh.topology
    names = part_ids("P", mesh.n_faces)
    sides: list[list[int]] = around.edge_faces.tolist()
    beside: list[list[str]] = [[] for _ in names]
    ends: FloatArray = mesh.vertices[around.edge_vertices]
    places: dict[str, _Place] = {}
    for edge, pair in zip(part_ids("B", len(sides)), sides, strict=True):
        left, right = pair
        if left >= 0 and right >= 0:
            beside[left].append(names[right])
            beside[right].append(names[left])
        places[edge] = ends[len(places)], [names[face] for face in pair if face >= 0], []
    for name, face, others in zip(names, mesh.faces, beside, strict=True):
        places[name] = mesh.vertices[face], others, []
    if panels is not None:
        rows = np.repeat(np.arange(panels.n_panels), panels.degrees)
        numbers = np.arange(len(rows)) - panels.offsets[:-1][rows]
        absent = (panels.neighbors >= 0) & ~np.isin(panels.neighbors, panels.face_ids)
        for k in np.flatnonzero(absent).tolist():
            places[names[panels.neighbors[k]]][2].append((int(rows[k]), int(numbers[k])))
    return places
