"""Solids and surfaces of STEP files as IFC spells them, and triangles."""

import re
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...kernel.arrays import FloatArray, IntArray, dot, norm, unit
from ..step.bodies import Body, BodyLayout, body_layout
from ..step.values import real
from .entities import Entities
from .patches import Patch, PatchKind, patch_for, patch_lines, patch_numbers

IfcSpheres = Literal["polynomial", "rational", "spherical"]


@dataclass(frozen=True)
class _Sphere:
    """Columns of a sphere among the numbers of a body: centre, axes z and x, radius."""

    center: int
    z: int
    x: int
    radius: int


@dataclass(frozen=True)
class _Layout:
    """Layout of bodies, with the spheres that it has as patches."""

    body: BodyLayout
    spheres: tuple[_Sphere, ...]


class BodyWriter:
    """Writes solids and surfaces: spheres by their name, or as patches (see `patches`)."""

    def __init__(self, entities: Entities, spheres: IfcSpheres) -> None:
        self._entities = entities
        self._spheres: IfcSpheres = spheres
        self._layouts: dict[tuple[int, Patch | None], _Layout] = {}

    def add(self, body: Body) -> int:
        """Number of a solid, surface or set of surfaces."""
        layout, numbers = body.layout, body.numbers
        if self._spheres != "spherical":
            layout, numbers = self._with_patches(body, self._spheres)
        else:
            layout = self._layout(body, None).body
        text = Body(layout, numbers).text(self._entities.count + 1)
        return self._entities.append(text, layout.n_entities)

    def _with_patches(self, body: Body, kind: PatchKind) -> tuple[BodyLayout, FloatArray]:
        spheres = self._layout(body, patch_for(kind, 0.0)).spheres
        corners = body.numbers[: 3 * body.layout.text.count("=VERTEX_POINT(")].reshape(-1, 3)
        halves = [_half_angle(body.numbers, sphere, corners) for sphere in spheres]
        patch = patch_for(kind, max(halves, default=0.0))
        numbers = body.numbers
        for sphere, half in zip(reversed(spheres), reversed(halves), strict=True):
            own = patch_numbers(
                patch, half, *_axes(body.numbers, sphere), body.numbers[sphere.radius]
            )
            numbers = np.concatenate(
                [numbers[: sphere.radius], own, numbers[sphere.radius + 1 :]]
            )
        return self._layout(body, patch).body, numbers

    def _layout(self, body: Body, patch: Patch | None) -> _Layout:
        key = id(body.layout), patch
        if key not in self._layouts:
            self._layouts[key] = self._spelled(body.layout, patch)
        return self._layouts[key]

    def _spelled(self, layout: BodyLayout, patch: Patch | None) -> _Layout:
        """The entities of geometry and topology have the names of STEP without underscores.

        They have no names of their own, which are the first parameter in STEP.
        """
        text = layout.text.replace("MANIFOLD_SOLID_BREP", "ADVANCED_BREP")
        text = re.sub(
            r"=([A-Z0-9_]+)\('',?", lambda name: f"=IFC{name[1].replace('_', '')}(", text
        )
        if patch is None:
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
                made = patch_lines(patch, number, count)
                lines += made
                count += len(made) - 1
            else:
                lines.append(line)
            column += line.count("%s")
        return _Layout(
            body_layout("".join(lines), count, layout.representation), tuple(spheres)
        )


def _axes(numbers: FloatArray, sphere: _Sphere) -> tuple[FloatArray, FloatArray]:
    """Centre of a sphere; unit vectors across a patch, along it, and out to its middle."""
    center, z, x = (numbers[i : i + 3] for i in (sphere.center, sphere.z, sphere.x))
    z = unit(z)
    out = -unit(x - dot(x, z) * z)
    return center, np.stack([np.cross(z, out), z, out])


def _half_angle(numbers: FloatArray, sphere: _Sphere, corners: FloatArray) -> float:
    """How far the farthest corner is from the middle of a patch, in radians."""
    center, (_, _, out) = _axes(numbers, sphere)
    # By chords: of nearly flat panels cosines would be rounded to 1.
    chords = norm((corners - center) / numbers[sphere.radius] - out)
    # The inner and the outer face have corners of their own: the sharper is the wider.
    return float(2 * np.arcsin(np.clip(chords / 2, 0, 1)).max())


def add_triangles(
    entities: Entities, points: FloatArray, triangles: IntArray, *, is_closed: bool
) -> int:
    """Number of a triangulated face set."""
    places = "),(".join(",".join(map(real, point)) for point in points.tolist())
    corners = "),(".join(",".join(map(str, each)) for each in (triangles + 1).tolist())
    sense = ".T." if is_closed else ".F."
    listed = entities.add(f"IFCCARTESIANPOINTLIST3D((({places})))")
    return entities.add(f"IFCTRIANGULATEDFACESET(#{listed},$,{sense},(({corners})),$)")
