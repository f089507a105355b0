"""Solids, surfaces and lines as entities of STEP files, text without a CAD kernel.

Bodies of the same topology differ in their numbers alone (`fabrication.breps`): the text of a
batch is laid out once and filled for each body. No curve is written in the parameters of a
surface.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, TypeAlias

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, norm, unit
from ..breps.records import BrepBatch, Ring
from .values import real, references

_SENSES: Final = {True: ".T.", False: ".F."}


@dataclass(frozen=True)
class BodyLayout:
    """Text of bodies of one topology.

    The template is to be filled with numbers and then with the numbers of entities:
    `references`, in the order of the text, the first entity being 0. The representation is the
    type of the shape representation that holds such bodies.
    """

    template: str
    references: IntArray
    n_entities: int
    representation: str


@dataclass(frozen=True)
class Body:
    """A body to be written: its numbers are finite, in the unit of the file."""

    layout: BodyLayout
    numbers: FloatArray

    def text(self, first: int) -> str:
        """Entities of the body; every number is read back as the same number.

        The first of them, with the number given, is the solid, surface or set of lines.
        """
        filled = self.layout.template % tuple(map(real, self.numbers.tolist()))
        return filled % tuple((self.layout.references + first).tolist())


def step_bodies(batches: Iterable[BrepBatch]) -> list[Body]:
    """Bodies of boundary representations, in the order of their rows."""
    result: dict[int, Body] = {}
    for batch in batches:
        layout = _layout(
            batch.corners.shape[1],
            tuple((edge.start, edge.end, edge.kind) for edge in batch.edges),
            tuple(
                (face.kind, (face.ring, *face.holes), face.is_along, face.corner)
                for face in batch.faces
            ),
            is_solid=batch.is_solid,
        )
        flat = batch.corners.reshape(len(batch.rows), -1)
        curves = [edge.numbers for edge in batch.edges]
        parts = [flat, *curves, *(face.numbers for face in batch.faces)]
        # Negative zeros would be written as such.
        numbers = np.concatenate(parts, axis=1) + 0.0
        result.update(
            (row, Body(layout, own))
            for row, own in zip(batch.rows.tolist(), numbers, strict=True)
        )
    return [result[row] for row in sorted(result)]


def line_body(segments: FloatArray) -> Body:
    """A set of straight lines (n, 2, 3) as one body."""
    changes = segments[:, 1] - segments[:, 0]
    numbers = [segments.reshape(-1, 6), unit(changes), norm(changes)[:, None]]
    return Body(_line_layout(len(segments)), np.concatenate(numbers, axis=1).ravel() + 0.0)


_Edge: TypeAlias = tuple[int, int, str]
_Face: TypeAlias = tuple[str, tuple[Ring, ...], bool, int]


class _Entities:
    """Entities numbered from 0 as they come, after those whose places are kept for the end."""

    def __init__(self, kept: int) -> None:
        self.lines = [""] * kept

    def add(self, text: str) -> int:
        self.lines.append(f"#{len(self.lines)}={text};\n")
        return len(self.lines) - 1

    def layout(self, representation: str) -> BodyLayout:
        text = "".join(self.lines)
        numbers = np.array([int(found) for found in re.findall(r"#(\d+)", text)])
        template = re.sub(r"#\d+", "#%%d", text)
        return BodyLayout(template, numbers, len(self.lines), representation)

    def point(self, kind: str = "CARTESIAN_POINT") -> int:
        return self.add(f"{kind}('',(%s,%s,%s))")

    def placement(self, origin: int) -> int:
        axis, along = self.point("DIRECTION"), self.point("DIRECTION")
        return self.add(f"AXIS2_PLACEMENT_3D('',#{origin},#{axis},#{along})")

    def curve(self, kind: str, start: int) -> int:
        if kind == "LINE":
            vector = self.add(f"VECTOR('',#{self.point('DIRECTION')},1.)")
            return self.add(f"LINE('',#{start},#{vector})")
        radii = "%s,%s" if kind == "ELLIPSE" else "%s"
        return self.add(f"{kind}('',#{self.placement(self.point())},{radii})")

    def bound(self, ring: Ring, edges: list[int], kind: str) -> int:
        uses = [
            self.add(f"ORIENTED_EDGE('',*,*,#{edges[edge]},{_SENSES[is_forward]})")
            for edge, is_forward in ring
        ]
        loop = self.add(f"EDGE_LOOP('',({references(uses)}))")
        return self.add(f"{kind}('',#{loop},.T.)")

    def surface(self, kind: str, corner: int) -> int:
        if kind == "PLANE":
            return self.add(f"PLANE('',#{self.placement(corner)})")
        return self.add(f"{kind}('',#{self.placement(self.point())},%s)")


@lru_cache(maxsize=1000)
def _layout(
    n_corners: int, edges: tuple[_Edge, ...], faces: tuple[_Face, ...], *, is_solid: bool
) -> BodyLayout:
    # The body and its shell come first; what they refer to is known at the end.
    entities = _Entities(kept=2)
    points = [entities.point() for _ in range(n_corners)]
    vertices = [entities.add(f"VERTEX_POINT('',#{point})") for point in points]
    edge_curves = [
        entities.add(
            f"EDGE_CURVE('',#{vertices[start]},#{vertices[end]},"
            f"#{entities.curve(kind, points[start])},.T.)"
        )
        for start, end, kind in edges
    ]
    shell: list[int] = []
    for kind, rings, is_along, corner in faces:
        bounds = [
            entities.bound(ring, edge_curves, "FACE_BOUND" if i else "FACE_OUTER_BOUND")
            for i, ring in enumerate(rings)
        ]
        surface = entities.surface(kind, points[corner])
        face = f"ADVANCED_FACE('',({references(bounds)}),#{surface},{_SENSES[is_along]})"
        shell.append(entities.add(face))
    body, shell_kind, representation = (
        ("MANIFOLD_SOLID_BREP('',#1)", "CLOSED_SHELL", "ADVANCED_BREP")
        if is_solid
        else ("SHELL_BASED_SURFACE_MODEL('',(#1))", "OPEN_SHELL", "MANIFOLD_SURFACE")
    )
    entities.lines[0] = f"#0={body};\n"
    entities.lines[1] = f"#1={shell_kind}('',({references(shell)}));\n"
    return entities.layout(f"{representation}_SHAPE_REPRESENTATION")


def _line_layout(count: int) -> BodyLayout:
    entities = _Entities(kept=1)
    lines: list[int] = []
    for _ in range(count):
        start, end = entities.point(), entities.point()
        line = entities.curve("LINE", start)
        ends = f"(#{start},PARAMETER_VALUE(0.)),(#{end},PARAMETER_VALUE(%s))"
        lines.append(entities.add(f"TRIMMED_CURVE('',#{line},{ends},.T.,.PARAMETER.)"))
    entities.lines[0] = f"#0=GEOMETRIC_CURVE_SET('',({references(lines)}));\n"
    return entities.layout("GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION")
