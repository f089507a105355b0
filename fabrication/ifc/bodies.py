"""Solids and surfaces of STEP files as IFC spells them, and triangles."""

import re
from dataclasses import dataclass
from typing import Final

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, dot, unit
from ..step.bodies import Body, BodyLayout, body_layout
from ..step.values import real
from .entities import Entities

_WIDER: Final = 1.5
"""How far a patch reaches beyond the farthest corner of its face."""

_WIDEST: Final = 0.6
"""Patches that reach farther, as tangents of a quarter of their opening, have four spans."""


@dataclass(frozen=True)
class _Sphere:
    """Columns of a sphere among the numbers of a body: centre, axes z and x, radius."""

    center: int
    z: int
    x: int
    radius: int


@dataclass(frozen=True)
class _Layout:
    """Layout of bodies, with the spheres that it has as rational patches."""

    body: BodyLayout
    spheres: tuple[_Sphere, ...]


class BodyWriter:
    """Writes solids and surfaces: spheres by their name, or as rational patches.

    IfcOpenShell, and what is built on it, has no spherical surfaces (0.9: it crashes) and takes
    the far side of a surface of revolution for the near one. A rational patch of degree two is
    as exact as either.
    """

    def __init__(self, entities: Entities, *, has_spheres: bool) -> None:
        self._entities, self._has_spheres = entities, has_spheres
        self._layouts: dict[tuple[int, int], _Layout] = {}

    def add(self, body: Body) -> int:
        """Number of a solid, surface or set of surfaces."""
        spheres = self._layout(body, 1).spheres
        corners = body.numbers[: 3 * body.layout.text.count("=VERTEX_POINT(")].reshape(-1, 3)
        reaches = [_reach(body.numbers, sphere, corners) for sphere in spheres]
        n_spans = 1 if max(reaches, default=0.0) < _WIDEST else 2
        layout, numbers = self._layout(body, n_spans), body.numbers
        for sphere, reach in zip(reversed(spheres), reversed(reaches), strict=True):
            patch = _patch(body.numbers, sphere, reach, n_spans)
            numbers = np.concatenate(
                [numbers[: sphere.radius], patch, numbers[sphere.radius + 1 :]]
            )
        text = Body(layout.body, numbers).text(self._entities.count + 1)
        return self._entities.append(text, layout.body.n_entities)

    def _layout(self, body: Body, n_spans: int) -> _Layout:
        key = id(body.layout), n_spans
        if key not in self._layouts:
            self._layouts[key] = self._spelled(body.layout, n_spans)
        return self._layouts[key]

    def _spelled(self, layout: BodyLayout, n_spans: int) -> _Layout:
        """The entities of geometry and topology have the names of STEP without underscores.

        They have no names of their own, which are the first parameter in STEP.
        """
        text = layout.text.replace("MANIFOLD_SOLID_BREP", "ADVANCED_BREP")
        text = re.sub(
            r"=([A-Z0-9_]+)\('',?", lambda name: f"=IFC{name[1].replace('_', '')}(", text
        )
        if self._has_spheres:
            return _Layout(body_layout(text, layout.n_entities, layout.representation), ())
        entities = dict(re.findall(r"#(\d+)=([^;]*);\n", text))
        columns: dict[str, int] = {}
        lines: list[str] = []
        spheres: list[_Sphere] = []
        count, column = layout.n_entities, 0
        for line in text.splitlines(keepends=True):
            number = line[1 : line.index("=")]
            columns[number] = column
            sphere = re.fullmatch(r"#\d+=IFCSPHERICALSURFACE\(#(\d+),%s\);\n", line)
            if sphere:
                parts = re.findall(r"#(\d+)", entities[sphere[1]])
                center, z, x = (columns[part] for part in parts)
                spheres.append(_Sphere(center, z, x, column))
                made = _patch_lines(number, count, n_spans)
                lines += made
                count += len(made) - 1
            else:
                lines.append(line)
            column += line.count("%s")
        return _Layout(
            body_layout("".join(lines), count, layout.representation), tuple(spheres)
        )


def _patch_lines(number: str, first: int, n_spans: int) -> list[str]:
    """Poles and surface of a patch, the latter with a number of its own."""
    side = 2 * n_spans + 1
    poles = [f"#{first + i}=IFCCARTESIANPOINT((%s,%s,%s));\n" for i in range(side**2)]
    rows = [",".join(f"#{first + side * i + j}" for j in range(side)) for i in range(side)]
    weights = "),(".join(",".join(["%s"] * side) for _ in range(side))
    counts = "(3,3)" if n_spans == 1 else "(3,2,3)"
    knots = ",".join(["%s"] * (n_spans + 1))
    surface = (
        f"#{number}=IFCRATIONALBSPLINESURFACEWITHKNOTS(2,2,(({'),('.join(rows)})),"
        f".UNSPECIFIED.,.F.,.F.,.F.,{counts},{counts},({knots}),({knots}),.UNSPECIFIED.,"
        f"(({weights})));\n"
    )
    return [*poles, surface]


def _axes(numbers: FloatArray, sphere: _Sphere) -> tuple[FloatArray, FloatArray]:
    """Centre of a sphere; unit vectors across a patch, along it, and out to its middle."""
    center, z, x = (numbers[i : i + 3] for i in (sphere.center, sphere.z, sphere.x))
    z = unit(z)
    out = -unit(x - dot(x, z) * z)
    return center, np.stack([np.cross(z, out), z, out])


def _reach(numbers: FloatArray, sphere: _Sphere, corners: FloatArray) -> float:
    """How far a patch has to reach: the tangent of a quarter of its opening."""
    center, (_, _, out) = _axes(numbers, sphere)
    heights = dot(corners - center, out) / numbers[sphere.radius]
    # The inner and the outer face have corners of their own: the sharper is the wider.
    half = np.arccos(np.clip(heights, -1, 1)).max()
    return _WIDER * float(np.tan(half / 2))


def _patch(numbers: FloatArray, sphere: _Sphere, reach: float, n_spans: int) -> FloatArray:
    """Poles, knots and weights of a patch, by stereographic projection from its far side."""
    center, axes = _axes(numbers, sphere)
    # Poles of the square and of the parameter itself, span by span.
    squares, values = {
        1: (np.array([1.0, -1.0, 1.0]), np.array([-1.0, 0.0, 1.0])),
        2: (np.array([1.0, 0.0, 0.0, 0.0, 1.0]), np.array([-1.0, -0.5, 0.0, 0.5, 1.0])),
    }[n_spans]
    squares, values = squares * reach**2, values * reach
    p, q = np.meshgrid(values, values, indexing="ij")
    rises = squares[:, None] + squares
    weights = 1 + rises
    local = np.stack([2 * p, 2 * q, 1 - rises], axis=-1) / weights[..., None]
    poles = center + numbers[sphere.radius] * (local @ axes)
    knots = np.linspace(-reach, reach, n_spans + 1)
    return np.concatenate([poles.ravel(), knots, knots, weights.ravel()])


def add_triangles(
    entities: Entities, points: FloatArray, triangles: IntArray, *, is_closed: bool
) -> int:
    """Number of a triangulated face set."""
    places = "),(".join(",".join(map(real, point)) for point in points.tolist())
    corners = "),(".join(",".join(map(str, each)) for each in (triangles + 1).tolist())
    sense = ".T." if is_closed else ".F."
    listed = entities.add(f"IFCCARTESIANPOINTLIST3D((({places})))")
    return entities.add(f"IFCTRIANGULATEDFACESET(#{listed},$,{sense},(({corners})),$)")
