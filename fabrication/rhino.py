"""
Panels as a Rhino model: exact trimmed spheres, edges as arcs, and what a workshop must know.

The Breps are written by `fabrication.opennurbs` and judged by `fabrication.brep_audit` before
they are added; rhino3dm makes the file around them. No render meshes are stored: Rhino makes
its own, and the setters for them crash rhino3dm at exit.
"""

import base64
import os
from collections.abc import Callable
from importlib.metadata import version as installed_version
from itertools import pairwise
from pathlib import Path
from typing import Any, Final, NamedTuple, TypeAlias
from uuid import NAMESPACE_URL, UUID, uuid5

import numpy as np

from ..kernel.arrays import FloatArray
from ..kernel.beams import Beams
from ..kernel.colors import BEAM, UNLABELLED, mould_color
from ..kernel.errors import InputError
from ..kernel.panel_checks import RejectedPanel
from ..kernel.panels import Panels, neighbor_ids, panel_areas
from ..kernel.spheres import center_radius
from .brep_audit import verify_breps
from .brep_layout import read_brep_streams
from .files import check_suffix, replacing
from .opennurbs import brep_streams, edge_streams
from .rhino_beams import axis_lines, beam_extrusions, beam_text
from .units import millimeters_per

VERSIONS: Final = (6, 7, 8)
"""Versions of Rhino whose files can be written."""

TEXT_KEYS: Final = (
    "id", "face", "mould", "bulge", "radius", "center", "area", "thickness", "neighbors",
    "units",
)  # fmt: skip
"""Keys of the user text of every panel, see `panel_text`."""

_UNIT_SYSTEMS: Final = {
    "mm": "Millimeters", "cm": "Centimeters", "m": "Meters", "in": "Inches", "ft": "Feet",
}  # fmt: skip
_TOLERANCE = 0.01
"""Model tolerance in millimetres."""

_ANGLE_TOLERANCE = 0.1
"""Model tolerance of angles in degrees."""

_BLACK = (0, 0, 0)
_NAMESPACE = uuid5(NAMESPACE_URL, "urn:spheremesh:3dm")
_NOTE = (
    "bulge: out for domes, in for dishes, seen along the panel's outward normal. "
    "neighbors: beyond each edge in order, - where there is no panel."
)


def write_3dm(
    panels: Panels | None,
    path: str | os.PathLike[str],
    units: str = "m",
    graph_json: str = "",
    version: int = 8,
    title: str = "",
    beams: Beams | None = None,
    *,
    centers: bool = False,
) -> Path:
    """
    Write panels and beams to a Rhino file.

    Parameters
    ----------
    panels : Panels or None
        The panels; their outer faces are written. None only if there are beams.
    path : path
        The file; an older one is replaced when the new one is whole.
    units : str
        Model units: ``mm``, ``cm``, ``m``, ``in`` or ``ft``.
    graph_json : str
        The graph that made the panels, kept in the document string ``spheremesh::graph``.
    version : int
        Version of Rhino: 6, 7 or 8.
    title : str
        Title of the model, kept in the document string ``spheremesh::title``.
    beams : Beams, optional
        Beams, written as capped extrusions of their flat contours on the layer ``Beams``, with
        the node axes as lines on the layer ``Axes``.
    centers : bool
        Whether the centres of the spheres are added as points, on the layer ``Centres``.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If there are neither panels nor beams, units or version are not known, the file cannot
        be written, or Breps do not pass `refused_breps`: then the message names the panels and
        nothing is written.

    Notes
    -----
    Layers: ``Panels`` with a sub-layer ``Mould 01``, ... for every label (panels without a
    mould lie on ``Panels`` itself), ``Edges`` with one arc or line for every edge of every
    panel: neighbours' arcs differ by the joint and the edge gap, so both are there. Each mould
    has its colour on its layer and as a material. User text: `panel_text`. Object ids depend
    on the panel's id and the object's role only. Two runs differ in the time of day alone.
    """
    check_suffix(path, ".3dm")
    if version not in VERSIONS:
        raise InputError(f"unknown Rhino version {version}: use one of {VERSIONS}")
    if panels is None and beams is None:
        raise InputError(f"there are no panels or beams to write to {path}")
    rhino = _new_model(units, _TOLERANCE / millimeters_per(units))
    _set_strings(rhino, graph_json, title)
    if panels is not None:
        streams = brep_streams(panels)
        _refuse(_judge(panels, streams))
        _add_panels(rhino, panels, streams, units)
        _add_edges(rhino, panels)
        if centers:
            _add_centers(rhino, panels)
    if beams is not None:
        _add_beams(rhino, beams, units)
    data = _encode(rhino, version)
    if len(read_brep_streams(data)) != (panels.n_panels if panels is not None else 0):
        raise InputError(f"cannot write {path}: rhino3dm did not encode the model")
    target = Path(path)
    with replacing(target) as temporary:
        temporary.write_bytes(data)
    return target


def refused_breps(panels: Panels) -> tuple[RejectedPanel, ...]:
    """
    Panels whose Breps are not exact, so that `write_3dm` refuses them.

    Parameters
    ----------
    panels : Panels
        The panels.

    Returns
    -------
    tuple of RejectedPanel
        Each with its reason; leave them out with `select_panels` to write the others.
    """
    return _judge(panels, brep_streams(panels))


def _judge(panels: Panels, streams: list[bytes]) -> tuple[RejectedPanel, ...]:
    reasons = (e.reason() for e in verify_breps(streams, panels.spheres, panels.origins))
    faces: list[int] = panels.face_ids.tolist()
    return tuple(
        RejectedPanel(name, face, reason)
        for name, face, reason in zip(panels.ids, faces, reasons, strict=True)
        if reason
    )


def _refuse(refused: tuple[RejectedPanel, ...]) -> None:
    if refused:
        shown = "; ".join(f"{panel.id}: {panel.reason}" for panel in refused[:8])
        more = f"; {len(refused) - 8} more" if len(refused) > 8 else ""
        raise InputError(f"the Breps of {len(refused)} panels are not exact: {shown}{more}")


def panel_text(panels: Panels, units: str) -> list[dict[str, str]]:
    """
    User text of panels: what a workshop needs without measuring.

    Parameters
    ----------
    panels : Panels
        P panels.
    units : str
        Model units.

    Returns
    -------
    list of dict of str to str
        P mappings with the keys `TEXT_KEYS`. ``bulge`` is out, in or flat, seen along the
        outward normal; ``radius`` is ``plane`` for planes, which have the center ``-``.
        ``mould`` counts from 01, as the layers do; ``-`` without mould. ``neighbors`` are the
        panels beyond each edge, in order; ``-`` where there is none. Lengths and areas are in
        model units.
    """
    centers, radii = _spheres(panels)
    neighbors = [name or "-" for name in neighbor_ids(panels)]
    signs: list[float] = np.sign(panels.spheres[:, 0]).tolist()
    starts: list[int] = panels.offsets.tolist()
    lines = zip(
        panels.ids,
        map(str, panels.face_ids.tolist()),
        map(_mould_name, panels.labels.tolist()),
        [{-1.0: "out", 0.0: "flat", 1.0: "in"}[sign] for sign in signs],
        [f"{r:.12g}" if np.isfinite(r) else "plane" for r in radii.tolist()],
        [" ".join(f"{x:.12g}" for x in c) if c[0] < np.inf else "-" for c in centers.tolist()],
        [f"{area:.12g}" for area in panel_areas(panels).tolist()],
        [f"{panels.thickness:.12g}"] * panels.n_panels,
        [" ".join(neighbors[i:j]) for i, j in pairwise(starts)],
        [units] * panels.n_panels,
        strict=True,
    )
    return [dict(zip(TEXT_KEYS, line, strict=True)) for line in lines]


def _spheres(panels: Panels) -> tuple[FloatArray, FloatArray]:
    """Centres in model coordinates and radii; infinite for planes."""
    centers, squares = center_radius(panels.spheres)
    return centers + panels.origins, np.sqrt(squares)


def _mould_name(label: int) -> str:
    return f"{label + 1:02d}" if label >= 0 else "-"


# What comes from rhino3dm is not typed: its stub lacks setters, indices and overloads.
_Untyped: TypeAlias = Any


class _Rhino(NamedTuple):
    """The library rhino3dm, a model under construction, and how streams become objects."""

    library: _Untyped
    model: _Untyped
    decode: Callable[[bytes], _Untyped]


class _Place(NamedTuple):
    """Indices of a layer and of the material of its objects."""

    layer: int
    material: int


def _new_model(units: str, tolerance: float) -> _Rhino:
    import rhino3dm

    library: _Untyped = rhino3dm
    model = library.File3dm()
    model.ApplicationName = "spheremesh"
    settings = model.Settings
    settings.ModelUnitSystem = getattr(library.UnitSystem, _UNIT_SYSTEMS[units])
    settings.ModelAbsoluteTolerance = tolerance
    settings.ModelAngleToleranceDegrees = _ANGLE_TOLERANCE
    # The versions that go with a stream are those of any object.
    header: dict[str, object] = library.Point(library.Point3d(0, 0, 0)).Encode()

    def decode(stream: bytes) -> _Untyped:
        header["data"] = base64.b64encode(stream).decode("ascii")
        return library.CommonObject.Decode(header)

    return _Rhino(library, model, decode)


def _encode(rhino: _Rhino, version: int) -> bytes:
    options = rhino.library.File3dmWriteOptions()
    options.Version = version
    # File3dm.Write would store the path of the temporary file in the model.
    return base64.b64decode(rhino.model.Encode(options) or "")


def _set_strings(rhino: _Rhino, graph_json: str, title: str) -> None:
    version = installed_version("spheremesh")
    strings = {"version": version, "title": title, "note": _NOTE, "graph": graph_json}
    for key, text in strings.items():
        if text:
            rhino.model.Strings[f"spheremesh::{key}"] = text


def _object_id(name: str, role: str) -> UUID:
    return uuid5(_NAMESPACE, f"{name}/{role}")


def _add_layer(
    rhino: _Rhino, name: str, color: tuple[int, int, int], parent: _Place | None = None
) -> _Place:
    model = rhino.model
    material = rhino.library.Material()
    material.Id = _object_id(name, "material")
    material.Name = name
    material.DiffuseColor = (*color, 255)
    layer = rhino.library.Layer()
    layer.Id = _object_id(name, "layer")
    layer.Name = name
    layer.Color = (*color, 255)
    layer.RenderMaterialIndex = model.Materials.Add(material)
    if parent:
        layer.ParentLayerId = model.Layers[parent.layer].Id
    return _Place(model.Layers.Add(layer), layer.RenderMaterialIndex)


def _attributes(rhino: _Rhino, panel: str, role: str, place: _Place) -> _Untyped:
    """Attributes with a stable id: the colour of the layer, and its material."""
    attributes = rhino.library.ObjectAttributes()
    attributes.Id = _object_id(panel, role)
    attributes.Name = panel
    attributes.LayerIndex = place.layer
    # Many viewers know materials of objects only, and show others in white.
    attributes.MaterialSource = rhino.library.ObjectMaterialSource.MaterialFromObject
    attributes.MaterialIndex = place.material
    return attributes


def _mould_places(rhino: _Rhino, labels: list[int]) -> dict[int, _Place]:
    """Layers of the moulds by label, under that of the panels without mould, -1."""
    root = _add_layer(rhino, "Panels", UNLABELLED)
    places = {-1: root}
    count = max(labels, default=-1) + 1
    for label in range(count):
        name, color = f"Mould {_mould_name(label)}", mould_color(label, count)
        places[label] = _add_layer(rhino, name, color, root)
    return places


def _add_panels(rhino: _Rhino, panels: Panels, streams: list[bytes], units: str) -> None:
    labels: list[int] = panels.labels.tolist()
    faces: list[int] = panels.face_ids.tolist()
    places = _mould_places(rhino, labels)
    refused: list[RejectedPanel] = []
    rows = zip(panels.ids, labels, faces, panel_text(panels, units), streams, strict=True)
    for name, label, face, text, stream in rows:
        brep = rhino.decode(stream)
        if brep is None or not brep.IsValid:
            reason = "openNURBS cannot read the Brep or finds it invalid"
            refused.append(RejectedPanel(name, face, reason))
            continue
        attributes = _attributes(rhino, name, "panel", places[label])
        for key, value in text.items():
            attributes.SetUserString(key, value)
        rhino.model.Objects.AddBrep(brep, attributes)
    _refuse(tuple(refused))


def _add_edges(rhino: _Rhino, panels: Panels) -> None:
    place = _add_layer(rhino, "Edges", _BLACK)
    owners: list[int] = panels.corner_panels.tolist()
    sides: list[int] = (np.arange(len(owners)) - panels.offsets[owners]).tolist()
    for stream, owner, side in zip(edge_streams(panels), owners, sides, strict=True):
        attributes = _attributes(rhino, panels.ids[owner], f"edge {side}", place)
        rhino.model.Objects.AddCurve(rhino.decode(stream), attributes)


def _add_beams(rhino: _Rhino, beams: Beams, units: str) -> None:
    place = _add_layer(rhino, "Beams", BEAM)
    solids = beam_extrusions(rhino.library, beams)
    for name, solid, text in zip(
        beams.annuli.ids, solids, beam_text(beams, units), strict=True
    ):
        attributes = _attributes(rhino, name, "beam", place)
        for key, value in text.items():
            attributes.SetUserString(key, value)
        rhino.model.Objects.AddExtrusion(solid, attributes)
    place = _add_layer(rhino, "Axes", _BLACK)
    for name, line in axis_lines(rhino.library, beams):
        rhino.model.Objects.AddCurve(line, _attributes(rhino, name, "axis", place))


def _add_centers(rhino: _Rhino, panels: Panels) -> None:
    place = _add_layer(rhino, "Centres", UNLABELLED)
    centers, radii = _spheres(panels)
    for name, center, radius in zip(panels.ids, centers.tolist(), radii.tolist(), strict=True):
        if np.isfinite(radius):
            attributes = _attributes(rhino, name, "centre", place)
            rhino.model.Objects.AddPoint(rhino.library.Point3d(*center), attributes)
