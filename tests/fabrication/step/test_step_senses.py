"""Which way faces look, from the text of STEP files alone.

OpenCASCADE turns loops and faces round when it reads a file, so it proves nothing here.
"""

import re
from pathlib import Path

import numpy as np
import pytest

from spheremesh import Mesh
from spheremesh.fabrication.model import Model
from spheremesh.fabrication.step.writer import write_step
from spheremesh.kernel.arrays import FloatArray
from spheremesh.kernel.beams.cutting import cut_beams
from spheremesh.kernel.meshes.mesh import mean_edge_length
from spheremesh.kernel.panels.cutting import cut_panels
from spheremesh.kernel.sphere_meshes.central_spheres import central_spheres
from spheremesh.kernel.sphere_meshes.fit import face_planes
from spheremesh.kernel.support.annulus_construction import annulus_support
from spheremesh.kernel.surfaces.circular_nets import roof_net, torus_net

NET = torus_net(7, 5, 3.0, 1.0)
KINDS = {
    "outwards": central_spheres(NET),
    "inwards": central_spheres(Mesh(NET.vertices, [face[::-1] for face in NET.faces])),
    "planes": face_planes(roof_net(6, 5, 40.0)),
}


class Text:
    """Entities by number: types, references, real numbers, and whether they end in .T."""

    def __init__(self, path: Path) -> None:
        data = path.read_text("ascii").partition("DATA;")[2].replace("\n", "")
        found = re.findall(r"#(\d+)=([A-Z0-9_]+)(\(.*?\));", data)
        self.types = {int(number): kind for number, kind, _ in found}
        self.parameters = {int(number): values for number, _, values in found}

    def ids(self, kind: str) -> list[int]:
        """Entities of a type."""
        return [number for number, found in self.types.items() if found == kind]

    def references(self, entity: int) -> list[int]:
        """Entities that an entity refers to."""
        return [int(found) for found in re.findall(r"#(\d+)", self.parameters[entity])]

    def numbers(self, entity: int) -> FloatArray:
        """Real numbers among its parameters."""
        pattern = r"[-+]?\d+\.\d*(?:E[-+]?\d+)?"
        return np.array(re.findall(pattern, self.parameters[entity]), float)

    def is_true(self, entity: int) -> bool:
        """Its last parameter."""
        return self.parameters[entity].endswith(".T.)")

    def ring(self, face: int) -> FloatArray:
        """Corners of a face in the order of its loop."""
        bound = self.references(face)[0]
        points: list[FloatArray] = []
        for use in self.references(self.references(bound)[0]):
            edge = self.references(use)[0]
            vertex = self.references(edge)[0 if self.is_true(use) else 1]
            points.append(self.numbers(self.references(vertex)[0]))
        return np.array(points if self.is_true(bound) else points[::-1])

    def circles(self, face: int) -> list[tuple[FloatArray, FloatArray, FloatArray]]:
        """Centre, a point and the direction there of each full circle in the loop of a face."""
        bound = self.references(face)[0]
        found: list[tuple[FloatArray, FloatArray, FloatArray]] = []
        for use in self.references(self.references(bound)[0]):
            edge = self.references(use)[0]
            start, end, curve = self.references(edge)
            if start == end:
                assert self.is_true(edge)
                assert self.is_true(bound)
                center, axis, x = map(self.numbers, self.references(self.references(curve)[0]))
                along = np.cross(axis, x) * (1 if self.is_true(use) else -1)
                found.append((center, center + self.numbers(curve)[0] * x, along))
        return found

    def normal(self, face: int, point: FloatArray) -> FloatArray:
        """Normal of a face at a point of it."""
        surface = self.references(face)[1]
        placement = self.references(surface)[0]
        origin, axis, _ = map(self.numbers, self.references(placement))
        away = point - origin
        away = away - (away @ axis) * axis if self.types[surface][0] == "C" else away
        normal = axis if self.types[surface] == "PLANE" else away / np.linalg.norm(away)
        return normal if self.is_true(face) else -normal


def area_vector(ring: FloatArray) -> FloatArray:
    return np.cross(ring, np.roll(ring, -1, axis=0)).sum(axis=0) / 2


def judge_cylinder(text: Text, faces: list[int]) -> None:
    """Faces look away from the middle, and lie to the left of their circles."""
    middles = [np.mean([c for c, _, _ in text.circles(face)], axis=0) for face in faces]
    for face, middle in zip(faces, middles, strict=True):
        for _, point, along in text.circles(face):
            normal = text.normal(face, point)
            assert normal @ (point - np.mean(middles, axis=0)) > 0
            assert np.cross(normal, along) @ (middle - point) > 0


def judge(path: Path) -> tuple[Text, int]:
    """Every loop runs counter-clockwise about the normal of its face; solids look outwards."""
    text = Text(path)
    faces = text.ids("ADVANCED_FACE")
    for face in faces:
        ring = text.ring(face)
        if not text.circles(face):
            area = area_vector(ring - ring[0])
            assert area @ text.normal(face, ring.mean(axis=0)) > 0.5 * np.linalg.norm(area)
    for shell in text.ids("CLOSED_SHELL"):
        members = text.references(shell)
        if any(text.circles(face) for face in members):
            judge_cylinder(text, members)
            continue
        rings = [text.ring(face) for face in members]
        assert sum(area_vector(ring) @ ring.mean(axis=0) for ring in rings) > 0
    return text, len(faces)


@pytest.mark.parametrize("thickness", [0.0, 0.02])
@pytest.mark.parametrize("kind", KINDS)
def test_law_panels_look_outwards(tmp_path: Path, thickness: float, kind: str) -> None:
    made = cut_panels(KINDS[kind], "intersection", thickness=thickness)[0]
    text, count = judge(write_step(Model(made), tmp_path / "p.step").path)
    assert count == made.n_panels if thickness == 0 else count == 6 * made.n_panels
    # Faces look along N, whatever the side to which their spheres bulge.
    for face, panel in zip(text.ids("ADVANCED_FACE"), range(made.n_panels), strict=False):
        if thickness == 0:
            ring = text.ring(face)
            normal = made.spheres[panel, 1:4]
            assert area_vector(ring - ring[0]) @ normal > 0


@pytest.mark.parametrize("ends", [{}, {"node_radius": 0.1, "node_gap": 0.01}])
@pytest.mark.parametrize("kind", KINDS)
def test_law_beams_look_outwards(tmp_path: Path, ends: dict[str, float], kind: str) -> None:
    sphere_mesh = KINDS[kind]
    size = mean_edge_length(sphere_mesh.mesh)
    for depth in (0.3, -0.2):
        options = {"depth": depth * size} if depth > 0 else {"kappa": depth * size**2}
        if kind == "planes" and depth < 0:
            continue
        annuli = annulus_support(sphere_mesh, **options).annuli
        scaled = {name: value * size for name, value in ends.items()}
        beams, _ = cut_beams(annuli, 0.05 * size, **scaled)
        assert beams.n_beams > 10
        judge(write_step(Model(beams=beams), tmp_path / "b.step").path)
