"""The page itself: one file of text that asks for nothing else.

A policy in its head forbids every request. Whatever a user has named stands in compressed data
or is escaped; scripts run by a nonce that only this page has.
"""

import base64
import gzip
import hashlib
import html
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from ...kernel.arrays import FloatArray
from ...kernel.beams.beams import Beams
from ...kernel.beams.node_cylinders import NodeCylinders, node_cylinders
from ...kernel.errors import InputError
from ...kernel.meshes.mesh import Mesh
from ...kernel.panels.panels import Panels
from ...kernel.parts.findings import Finding
from ..light import sky_maps
from .beams import beam_arrays, beam_points, node_arrays
from .container import pack_arrays
from .faces import Faces, cover, face_arrays, panel_faces
from .grid import Grid, grid_about
from .missing import missing_parts
from .sky import GROUND, REACH, ground_openness, panel_openness, point_sky, point_spacing

_BUNDLE: Final = "bundle"
"""Folder of what `source/build.mjs` makes."""

_LEVEL: Final = 6
"""Of compression: what more would save is not worth its time."""

Columns = Mapping[str, Sequence[Any]]


@dataclass(frozen=True)
class PageTexts:
    """What a page says of its parts.

    Attributes
    ----------
    title : str
        Heading of the page.
    panels, beams : mapping
        Columns of the schedule, see `fabrication.schedules.columns`.
    findings : sequence of Finding
        What an audit found, by the names of parts.
    rejected : sequence of mapping
        ``id``, ``code`` and ``reason`` of each panel that cannot be made; others are
        known by what an audit found of them.
    millimeters : float
        Of a model unit.
    """

    title: str
    panels: Columns
    beams: Columns
    findings: Sequence[Finding] = ()
    rejected: Sequence[Mapping[str, str]] = ()
    millimeters: float = 1000.0


def page_text(
    panels: Panels | None, beams: Beams | None, texts: PageTexts, mesh: Mesh | None = None
) -> str:
    """The page of a model as text; with its mesh, faces without a panel are drawn as well.

    Raises InputError if there is nothing to show, or the mesh has too few faces for the panels.
    """
    data = page_data(panels, beams, texts, mesh)
    code = _asset("page.js").encode()
    nonce = hashlib.sha256(data + code).hexdigest()[:24]
    fields = {
        "nonce": nonce, "title": html.escape(texts.title),
        "model": _compressed(data), "code": _compressed(code),
    }  # fmt: skip
    # Pieces are joined, not replaced in turn: a title may look like a field.
    first, *rest = _asset("page.html").split("{{")
    pieces = [first]
    for piece in rest:
        name, text = piece.split("}}", 1)
        pieces += [fields[name], text]
    return "".join(pieces)


def page_data(
    panels: Panels | None, beams: Beams | None, texts: PageTexts, mesh: Mesh | None = None
) -> bytes:
    """What a page is filled with, as `unpack_arrays` reads it."""
    faces = panel_faces(panels) if panels is not None and panels.n_panels else []
    beams = beams if beams is not None and beams.n_beams else None
    if not faces and beams is None:
        raise InputError("there are no panels or beams to show")
    nodes = node_cylinders(beams) if beams is not None else None
    points = [side.points for side in faces]
    if beams is not None:
        points.append(beam_points(beams))
    grid = grid_about(*points)
    arrays: dict[str, NDArray[Any]] = {}
    if panels is not None and faces:
        arrays |= face_arrays(panels, faces, grid)
    if beams is not None:
        arrays |= beam_arrays(beams, grid)
    if nodes is not None:
        arrays |= node_arrays(nodes, grid)
    ground = _add_light(arrays, faces, points, grid)
    known = {*texts.panels["id"], *texts.beams["id"], *(nodes.ids if nodes is not None else ())}
    absent = [found for found in texts.findings if found.id not in known]
    missing, outlines = missing_parts(panels, mesh, texts.rejected, absent)
    arrays["missing"] = grid.steps(outlines)
    low = (np.min([each.min(axis=0) for each in points], axis=0) - grid.center) / grid.size
    nothing: Columns = dict.fromkeys(texts.panels, ())
    head: dict[str, Any] = {
        "title": texts.title,
        "solid": len(faces) == 2,
        "tight": panels is not None and panels.joint_gap == 0,
        "size_mm": grid.size * texts.millimeters,
        "low": low.tolist(),
        "high": (-low).tolist(),
        "home": [0.5, -0.8, 0.5] if low[0] <= low[1] else [0.8, 0.5, 0.5],
        "ground": ground,
        "panels": texts.panels if faces else nothing,
        "beams": texts.beams,
        "beam_thickness": beams.thickness / grid.size if beams is not None else 0.0,
        "nodes": _node_texts(nodes, texts.millimeters),
        "node_radius": nodes.radius / grid.size if nodes is not None else 0.0,
        "findings": [[f.code, f.id, f.severity, f.message, f.size] for f in texts.findings],
        "missing": missing,
    }
    return pack_arrays(head, arrays)


def _node_texts(nodes: NodeCylinders | None, millimeters: float) -> dict[str, Any]:
    if nodes is None:
        return {"id": [], "radius_mm": 0.0}
    return {"id": list(nodes.ids), "radius_mm": round(nodes.radius * millimeters, 2)}


def _add_light(
    arrays: dict[str, NDArray[Any]], faces: list[Faces], points: list[FloatArray], grid: Grid
) -> dict[str, Any]:
    """Light of the sky at the points of panels and on the ground; where that lies."""
    seen = faces[0].points if faces else points[0]
    sky = sky_maps(seen, cover(faces[0])) if faces else point_sky(seen, point_spacing(seen))
    for name, side in zip(("outer", "inner"), faces, strict=False):
        # Both sides count from the outer face, on which the light falls.
        normals = side.normals if name == "outer" else -side.normals
        arrays[f"{name}_light"] = panel_openness(side.points, normals, sky).astype(np.uint8)
    arrays["ground"] = ground_openness(seen, sky).astype(np.uint8)
    low, high = seen.min(axis=0), seen.max(axis=0)
    middle = (np.array([*(low + high)[:2] / 2, low[2]]) - grid.center) / grid.size
    size = REACH * float((high - low).max()) / grid.size
    return {"points": GROUND, "size": size, "middle": middle.tolist()}


def _asset(name: str) -> str:
    folder = resources.files(__package__ or "spheremesh.viewer.page") / _BUNDLE
    return (folder / name).read_text(encoding="utf-8")


def _compressed(data: bytes) -> str:
    return base64.b64encode(gzip.compress(data, _LEVEL, mtime=0)).decode()
