"""Drawing of the design: where vertices lie, and how far an optimisation moved them."""

import os
from pathlib import Path
from typing import Final

import numpy as np

from ...kernel.arrays import FloatArray, norm
from ...kernel.errors import InputError
from ...kernel.meshes.mesh import Mesh, face_vector_areas, mean_edge_length
from ..files import check_suffix, replacing
from ..model import Written
from ..units import millimeters_per
from .drawing import Circle, Drawing, Text, text_width
from .dxf import format_dxf
from .svg import format_svg

_LAYERS: Final = ("PLAN", "TEXT", "MARK")
"""Edges of the design, the legend, moves."""
_LARGEST_CIRCLE: Final = 0.4
"""Radius of the largest move, in mean edges."""
_LEAST_LETTERS: Final = 60
"""Heights of letters that fit across the drawing, at least."""
_NEARLY_FLAT: Final = 0.5
"""Share of the area of a mesh that is seen from its front, from which it is drawn so."""


def write_move_drawing(
    mesh: Mesh, moved: Mesh, path: str | os.PathLike[str], units: str = "m"
) -> Written:
    """Draw a design and the moves of its vertices into one .dxf or .svg file.

    Raises InputError if the suffix or the units are unknown, the meshes differ in more than
    the places of their vertices, or the file cannot be written.
    """
    target = Path(path)
    check_suffix(target, ".dxf", ".svg")
    drawing = layout_moves(mesh, moved, units)
    is_dxf = target.suffix.lower() == ".dxf"
    text = format_dxf(drawing, _LAYERS) if is_dxf else format_svg(drawing)
    with replacing(target) as temporary:
        temporary.write_text(text, encoding="utf-8")
    return Written(target)


def layout_moves(mesh: Mesh, moved: Mesh, units: str = "m") -> Drawing:
    """Edges of the design in millimetres, and a circle about every vertex that moved.

    Seen from the front, where a mesh has one, else from above. Radii of the circles grow with
    the moves, in one scale that the legend tells with the largest move.
    """
    if not (
        np.array_equal(mesh.corners, moved.corners)
        and np.array_equal(mesh.offsets, moved.offsets)
        and mesh.n_vertices == moved.n_vertices
    ):
        raise InputError("moves are drawn between two places of one mesh, not of two meshes")
    unit = millimeters_per(units)
    flat = unit * (mesh.vertices - mesh.vertices.mean(axis=0)) @ _axes(mesh).T
    lengths = unit * norm(moved.vertices - mesh.vertices)
    edge = unit * mean_edge_length(mesh)
    largest = float(lengths.max(initial=0.0))
    factor = _LARGEST_CIRCLE * edge / largest if largest > 0 else 0.0
    tails, heads = mesh.corners, mesh.corners[mesh.topology.next_corners]
    twins = mesh.topology.twins
    once = (twins < 0) | (np.arange(len(twins)) < twins)
    drawing = Drawing()
    drawing.add_segments(
        "PLAN", *map(tuple, np.hstack([flat[tails[once]], flat[heads[once]]]).tolist())
    )
    drawing.circles += [
        Circle("MARK", float(x), float(y), float(factor * length))
        for (x, y), length in zip(flat, lengths, strict=True)
        if length > 0
    ]
    low, high = flat.min(axis=0) - edge / 2, flat.max(axis=0) + edge / 2
    legend = _legend(lengths, edge, factor)
    height = float(high[0] - low[0]) / max(_LEAST_LETTERS, *map(text_width, legend))
    bottom = float(low[1])
    for text in legend:
        bottom -= 2 * height
        drawing.texts.append(Text("TEXT", text, float(low[0]), bottom, height))
    drawing.low = float(low[0]), bottom - height
    drawing.high = float(high[0]), float(high[1])
    return drawing


def _axes(mesh: Mesh) -> FloatArray:
    """Directions (2, 3) of the paper: to the right, and upwards."""
    areas = face_vector_areas(mesh)
    front = areas.sum(axis=0)
    if norm(front) < _NEARLY_FLAT * norm(areas).sum():
        front = np.array([0.0, 0.0, 1.0])
    front /= norm(front)
    upward = np.array([0.0, 0.0, 1.0]) if abs(front[2]) < np.sqrt(0.5) else np.eye(3)[1]
    right = np.cross(upward, front)
    right /= norm(right)
    return np.stack([right, np.cross(front, right)])


def _legend(lengths: FloatArray, edge: float, factor: float) -> list[str]:
    if factor == 0:
        return ["No vertex was moved."]
    most = int(lengths.argmax())
    share = lengths[most] / edge
    return [
        f"Vertices moved by up to {lengths[most]:.3g} mm ({share:.2g} mean edges, at vertex "
        f"{most}), {lengths.mean():.3g} mm on average.",
        f"Circles have {factor:.3g} times the move as radius.",
    ]
