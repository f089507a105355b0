"""Solids, surfaces and lines as entities of STEP files, text without a CAD kernel.

Bodies of the same topology differ in their numbers alone (`fabrication.breps`): the text of
those that share their geometry alike is laid out once and filled for each body.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, NamedTuple, TypeAlias

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, norm, unit
from ..breps.panel_geometry import CONFUSION
from ..breps.records import BrepBatch, Ring
from .digits import rounded_numbers
from .parameter_curves import ParameterCurves, arcs_on_faces, spline_degree
from .sharing import Plan, shared_geometry
from .values import capital_exponents, references

_SENSES: Final = {True: ".T.", False: ".F."}

_PLANE_OF_PARAMETERS: Final = (
    "(GEOMETRIC_REPRESENTATION_CONTEXT(2)PARAMETRIC_REPRESENTATION_CONTEXT()"
    "REPRESENTATION_CONTEXT('2D SPACE',''))"
)


@dataclass(frozen=True)
class BodyLayout:
    """Text of bodies of one topology.

    The template is to be filled with numbers and then with the numbers of entities:
    `references`, in the order of the text, the first entity being 0. The representation is the
    type of the shape representation that holds such bodies; the text is the template with the
    numbers of entities in place.
    """

    template: str
    references: IntArray
    n_entities: int
    representation: str
    text: str


def body_layout(text: str, n_entities: int, representation: str) -> BodyLayout:
    """Layout of a text in which entities are numbered from 0; those of the file as ``#!7``."""
    numbers = np.array([int(found) for found in re.findall(r"#(\d+)", text)])
    template = re.sub(r"#\d+", "#%%d", text).replace("#!", "#")
    return BodyLayout(template, numbers, n_entities, representation, text)


@dataclass(frozen=True)
class Body:
    """A body to be written: its numbers are finite, in the unit of the file."""

    layout: BodyLayout
    numbers: FloatArray

    def text(self, first: int) -> str:
        """Entities of the body; every number is read back as the same number.

        The first of them, with the number given, is the solid, surface or set of lines.
        """
        filled = self.layout.template % tuple(self.numbers.tolist())
        # Entities are capitals: what is not belongs to a number.
        if "e" in filled:
            filled = capital_exponents(filled)
        return filled % tuple((self.layout.references + first).tolist())


def step_bodies(
    batches: Iterable[BrepBatch],
    confusion: float = CONFUSION,
    curves: ParameterCurves = "needed",
) -> list[Body]:
    """Bodies of boundary representations, in the order of their rows.

    Places that are nearer than the confusion are one to readers: arcs get curves in the
    parameters of their spheres so that those are (see `parameter_curves`).
    """
    result: dict[int, Body] = {}
    for batch in batches:
        topology = _Topology(
            tuple((edge.start, edge.end) for edge in batch.edges),
            tuple((face.ring, *face.holes) for face in batch.faces),
            batch.is_solid,
        )
        for shared in shared_geometry(batch):
            rounded = rounded_numbers(shared, confusion)
            for arcs in arcs_on_faces(batch, shared, confusion, curves):
                layout = _layout(topology, shared.plan, arcs.pairs, arcs.n_poles)
                # Negative zeros would be written as such.
                numbers = np.concatenate([rounded[arcs.members], arcs.numbers], axis=1) + 0.0
                rows = batch.rows[shared.members[arcs.members]].tolist()
                result.update(
                    (row, Body(layout, own)) for row, own in zip(rows, numbers, strict=True)
                )
    return [result[row] for row in sorted(result)]


def line_body(segments: FloatArray) -> Body:
    """A set of straight lines (n, 2, 3) as one body."""
    changes = segments[:, 1] - segments[:, 0]
    numbers = [segments.reshape(-1, 6), unit(changes), norm(changes)[:, None]]
    return Body(_line_layout(len(segments)), np.concatenate(numbers, axis=1).ravel() + 0.0)


class _Topology(NamedTuple):
    """Corners of edges, rings of faces."""

    edges: tuple[tuple[int, int], ...]
    faces: tuple[tuple[Ring, ...], ...]
    is_solid: bool


_Pairs: TypeAlias = tuple[tuple[int, int], ...]


class _Entities:
    """Entities numbered from 0 as they come, after those whose places are kept for the end."""

    def __init__(self, kept: int) -> None:
        self.lines = [""] * kept

    def add(self, text: str) -> int:
        self.lines.append(f"#{len(self.lines)}={text};\n")
        return len(self.lines) - 1

    def layout(self, representation: str) -> BodyLayout:
        return body_layout("".join(self.lines), len(self.lines), representation)

    def point(self, kind: str = "CARTESIAN_POINT") -> int:
        return self.add(f"{kind}('',(%s,%s,%s))")

    def vector(self, direction: int) -> int:
        return self.add(f"VECTOR('',#{direction},1.)")

    def bound(self, ring: Ring, edges: list[int], kind: str) -> int:
        uses = [
            self.add(f"ORIENTED_EDGE('',*,*,#{edges[edge]},{_SENSES[is_forward]})")
            for edge, is_forward in ring
        ]
        loop = self.add(f"EDGE_LOOP('',({references(uses)}))")
        return self.add(f"{kind}('',#{loop},.T.)")


class _Geometry:
    """Entities of points, curves and surfaces: in the order of the numbers that fill them."""

    def __init__(self, entities: _Entities, topology: _Topology, plan: Plan) -> None:
        add = entities.add
        self.points = [entities.point() for _ in range(plan.n_points)]
        directions = [entities.point("DIRECTION") for _ in range(plan.n_directions)]
        placements = [
            add(
                f"AXIS2_PLACEMENT_3D('',#{self.points[point]},#{directions[axis]},"
                f"#{directions[start]})"
            )
            for point, axis, start in plan.placements
        ]
        vectors = {
            direction: entities.vector(directions[direction])
            for direction in dict.fromkeys(i for kind, i in plan.curves if kind == "LINE")
        }
        self.curves: list[int] = []
        for (kind, i), (start, _) in zip(plan.curves, topology.edges, strict=True):
            if kind == "LINE":
                text = f"LINE('',#{self.points[start]},#{vectors[i]})"
            else:
                radii = "%s,%s" if kind == "ELLIPSE" else "%s"
                text = f"{kind}('',#{placements[i]},{radii})"
            self.curves.append(add(text))
        self.surfaces: list[int] = []
        for kind, i, _ in plan.surfaces:
            radius = "" if kind == "PLANE" else ",%s"
            self.surfaces.append(add(f"{kind}('',#{placements[i]}{radius})"))

    def add_parameter_curves(self, entities: _Entities, pairs: _Pairs, n_poles: int) -> None:
        """Curves in the parameters of surfaces, beside those in space."""
        if not n_poles:
            return
        space = entities.add(_PLANE_OF_PARAMETERS)
        degree = spline_degree(n_poles)
        n_knots = n_poles - degree + 1
        counts = ",".join([f"{degree + 1}", *["1"] * (n_knots - 2), f"{degree + 1}"])
        for edge, face in pairs:
            poles = [entities.add("CARTESIAN_POINT('',(%s,%s))") for _ in range(n_poles)]
            spline = entities.add(
                f"B_SPLINE_CURVE_WITH_KNOTS('',{degree},({references(poles)}),.UNSPECIFIED.,"
                f".F.,.F.,({counts}),({','.join(['%s'] * n_knots)}),.UNSPECIFIED.)"
            )
            flat = entities.add(f"DEFINITIONAL_REPRESENTATION('',(#{spline}),#{space})")
            curve = entities.add(f"PCURVE('',#{self.surfaces[face]},#{flat})")
            self.curves[edge] = entities.add(
                f"SURFACE_CURVE('',#{self.curves[edge]},(#{curve}),.CURVE_3D.)"
            )


@lru_cache(maxsize=1000)
def _layout(topology: _Topology, plan: Plan, pairs: _Pairs, n_poles: int) -> BodyLayout:
    # The body and its shell come first; what they refer to is known at the end.
    entities = _Entities(kept=2)
    geometry = _Geometry(entities, topology, plan)
    geometry.add_parameter_curves(entities, pairs, n_poles)
    corners = dict.fromkeys(corner for edge in topology.edges for corner in edge)
    vertices = {i: entities.add(f"VERTEX_POINT('',#{geometry.points[i]})") for i in corners}
    edges = [
        entities.add(f"EDGE_CURVE('',#{vertices[start]},#{vertices[end]},#{curve},.T.)")
        for (start, end), curve in zip(topology.edges, geometry.curves, strict=True)
    ]
    shell: list[int] = []
    for rings, surface, (_, _, is_along) in zip(
        topology.faces, geometry.surfaces, plan.surfaces, strict=True
    ):
        bounds = [
            entities.bound(ring, edges, "FACE_BOUND" if i else "FACE_OUTER_BOUND")
            for i, ring in enumerate(rings)
        ]
        face = f"ADVANCED_FACE('',({references(bounds)}),#{surface},{_SENSES[is_along]})"
        shell.append(entities.add(face))
    body, shell_kind, representation = (
        ("MANIFOLD_SOLID_BREP('',#1)", "CLOSED_SHELL", "ADVANCED_BREP")
        if topology.is_solid
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
        line = entities.add(
            f"LINE('',#{start},#{entities.vector(entities.point('DIRECTION'))})"
        )
        ends = f"(#{start},PARAMETER_VALUE(0.)),(#{end},PARAMETER_VALUE(%s))"
        lines.append(entities.add(f"TRIMMED_CURVE('',#{line},{ends},.T.,.PARAMETER.)"))
    entities.lines[0] = f"#0=GEOMETRIC_CURVE_SET('',({references(lines)}));\n"
    return entities.layout("GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION")
