"""The pictures of README and docs, each drawn by one function.

python examples/pictures.py docs/images
"""

import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, Literal

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.beams.beams import Beams
from spheremesh.kernel.meshes.mesh import face_centroids, mean_edge_length
from spheremesh.kernel.panels.panels import Panels
from spheremesh.kernel.spheres.circles import circle_pencils, face_circles, pencil_spheres
from spheremesh.nodes import (
    apply_mobius,
    axis_support,
    beams,
    bisector_support,
    catenoid_mesh,
    cluster_radii,
    common_axes,
    cost_curve,
    ellipsoid_mesh,
    evolve_spheres,
    exact_support,
    face_planes,
    fit_spheres,
    inversion,
    least_joint,
    least_node_radius,
    minimize_angles,
    model_change,
    panels,
    remesh_triangles,
    roof_mesh,
    shifted_rows,
    sphere_bundle,
    tangent_sphere_shex,
    tangent_spheres,
    torus_mesh,
    triangulate,
    vase_mesh,
)
from spheremesh.viewer.assembly import assembly_image
from spheremesh.viewer.render import compare_image, render_image

Side = Literal["inward", "centred", "outward"]


def roof() -> Image.Image:
    """The roof of 1440 spherical panels, made on eight moulds."""
    smooth = minimize_angles(fit_spheres(roof_mesh()))
    clusters = cluster_radii(smooth.sphere_mesh, 8)
    made = panels(clusters.sphere_mesh, labels=clusters.labels)
    return render_image(made.panels, direction=(0.5, -0.85, 0.5), height=800, legend=True)


def roof_zebra() -> Image.Image:
    """Reflected stripes on plane panels, and on spherical ones with the same corners."""
    planes = face_planes(roof_mesh())
    smooth = minimize_angles(planes)
    angles = smooth.report["angles_deg"]
    return compare_image(
        panels(planes).panels,
        panels(smooth.sphere_mesh).panels,
        captions=(
            f"plane panels: {angles['planar']['mean']:.1f}° between neighbours, on average",
            f"spherical panels: {angles['spherical']['mean']:.1f}°, on the same mesh",
        ),
        direction=(0.72, -0.7, 0.55),
        height=560,
    )


def pencil() -> Image.Image:
    """Halves of nine spheres through one circle, from a dome over the plane to a bowl."""
    turns = np.linspace(0, np.pi, 49)
    half = np.stack([np.cos(turns), np.sin(turns), np.zeros(49)], axis=1)
    angles = np.linspace(-1.2, 1.2, 9)
    points = np.tile(half, (len(angles), 1))
    mesh = Mesh(points, np.arange(len(points)).reshape(len(angles), 49))
    rows = pencil_spheres(*circle_pencils(face_circles(mesh)[0]), angles)
    spheres = SphereMesh.from_local(mesh, rows)
    made = panels(spheres, labels=np.arange(len(angles)))
    return render_image(
        made.panels, direction=(0.25, -1.0, 0.3), width=1000, height=700, legend=False
    )


def lights() -> Image.Image:
    """A vase on its beams by the angle at edges, from below, and under a sky over houses."""
    spheres = minimize_angles(fit_spheres(vase_mesh(16, 10))).sphere_mesh
    support = axis_support(spheres)
    carried = beams(support.annuli, thickness=0.02, node_radius=0.05).beams
    cut = panels(spheres, edges="axis", axes=support.axes, thickness=0.02).panels
    sheet = Image.new("RGB", (1500, 560))
    views: list[dict[str, Any]] = [
        {"beams": carried, "color_by": "angle"},
        {"beams": carried, "direction": "below", "color_by": "none"},
        {"shading": "mirror", "color_by": "none"},
    ]
    for place, view in enumerate(views):
        sheet.paste(render_image(cut, width=500, height=560, **view), (500 * place, 0))
    return sheet


def mobius() -> Image.Image:
    """A panelled torus, and its image in an inversion."""
    start = fit_spheres(torus_mesh(n_around=48, n_across=24))
    torus = minimize_angles(start).sphere_mesh
    image = apply_mobius(torus, inversion(center=[4.2, 1.0, 1.5], radius=4.0))
    sheet = Image.new("RGB", (1600, 560))
    for place, shape in enumerate((torus, image)):
        made = panels(shape).panels
        picture = render_image(made, color_by="radius", width=800, height=560, legend=False)
        sheet.paste(picture, (800 * place, 0))
    return sheet


def models() -> Image.Image:
    """A vase of plane triangles, and its image in each of the three models."""
    vase = remesh_triangles(vase_mesh(48, 36, amplitude=0.35), 0.42)
    middle = vase.vertices.mean(axis=0)
    shapes = (
        face_planes(vase),
        model_change(vase, "hyperbolic", 2.0, middle),
        model_change(vase, "elliptic", 1.0, middle),
        sphere_bundle(vase, middle + np.array([-2.4, -2.4, 1.2]), 3.0),
    )
    sheet = Image.new("RGB", (1600, 560))
    for place, shape in enumerate(shapes):
        made = panels(shape).panels
        picture = render_image(
            made,
            color_by="radius",
            direction=(0.3, -1.0, 0.35),
            width=400,
            height=560,
            legend=False,
        )
        sheet.paste(picture, (400 * place, 0))
    return sheet


def hexagons() -> Image.Image:
    """A torus and a catenoid in convex hexagons, and a catenoid in plane bow-ties."""
    torus = evolve_spheres(shifted_rows(torus_mesh(72, 20, minor_radius=0.8)))
    saddle = evolve_spheres(shifted_rows(catenoid_mesh(64, 24, height=1.2)), side="minus")
    plain = shifted_rows(catenoid_mesh(80, 24, height=1.2))
    designs = [
        (torus.mesh, torus.spheres, 0.008),
        (saddle.mesh, saddle.spheres, 0.008),
        (plain, tangent_spheres(plain, np.inf), 0.0),
    ]
    sheet = Image.new("RGB", (1350, 420))
    for place, (mesh, spheres, gap) in enumerate(designs):
        made = tangent_sphere_shex(mesh, spheres)
        cut = panels(made.sphere_mesh, edges="intersection", joint_gap=gap).panels
        picture = render_image(cut, color_by="radius", width=450, height=420, legend=False)
        sheet.paste(picture, (450 * place, 0))
    return sheet


def _pictures_of(example: str, *pictures: str) -> list[Image.Image]:
    """Pictures that an example writes, half as large."""
    with tempfile.TemporaryDirectory() as folder:
        script = Path(__file__).with_name(f"{example}.py").resolve()
        subprocess.run([sys.executable, "-W", "ignore", script], cwd=folder, check=True)  # noqa: S603
        images = [Image.open(Path(folder) / picture) for picture in pictures]
        return [image.convert("RGB").reduce(2) for image in images]


def _made_by(example: str, picture: str) -> Image.Image:
    """The picture that an example writes, half as large."""
    return _pictures_of(example, picture)[0]


def _beside(*images: Image.Image) -> Image.Image:
    """Images of one size in a row."""
    width, height = images[0].size
    sheet = Image.new("RGB", (len(images) * width, height))
    for place, image in enumerate(images):
        sheet.paste(image, (place * width, 0))
    return sheet


def hybrid_dome() -> Image.Image:
    """A dome of triangles and quadrilaterals with nodes free of torsion."""
    return _made_by("04_hybrid_roof", "dome.png")


def facade() -> Image.Image:
    """Cushions that meet at sixty degrees."""
    return _made_by("05_facade", "facade.png")


def strips() -> Image.Image:
    """Reflections on strips around a catenoid."""
    return _made_by("06_strips", "strips_0.png")


def few_moulds() -> Image.Image:
    """484 panels on six moulds."""
    return _made_by("09_few_moulds", "few_moulds.png")


def remeshed_torus() -> Image.Image:
    """Spheres of Section 7 as hexagons, and along their conjugate directions (Fig. 29)."""
    names = ("torus_hexagons.png", "torus_remeshed.png")
    return _beside(*_pictures_of("10_torus_remeshed", *names))


def remeshed_roof() -> Image.Image:
    """A freeform roof with singular points."""
    return _made_by("11_freeform_remeshed", "roof_remeshed.png")


def quad_pattern() -> Image.Image:
    """Quads on a design surface: flat panels, and spheres on a few moulds."""
    names = ("canopy_planes.png", "canopy_spheres.png")
    return _beside(*_pictures_of("15_quad_pattern", *names))


def patterns() -> Image.Image:
    """One canopy in six patterns."""
    return _made_by("16_patterns", "patterns.png")


def pattern_lines() -> Image.Image:
    """Lines of quads that follow curvature, the boundary, a direction, a curve; density."""
    return _made_by("17_pattern_lines", "pattern_lines.png").quantize(128)


def pattern_scales() -> Image.Image:
    """One pattern without every second line, as it is, and split."""
    return _made_by("18_pattern_scales", "pattern_scales.png").quantize(128)


def supports() -> Image.Image:
    """Beams on node axes from below, one of their nodes, and upright beams at a cylinder."""
    mesh = roof_mesh(12, 18)
    cut, frame = _on_axes(_smooth(mesh))
    skin, joined = _upright(_smooth(triangulate(mesh)))
    middle = int(np.argmax(mesh.vertices[:, 2]))
    below = (0.5, -0.7, -0.8)
    return _beside(
        assembly_image(cut, frame, (0.5, -0.85, -0.35), width=480, height=420),
        assembly_image(cut, frame, below, middle, width=480, height=420),
        assembly_image(skin, joined, below, middle, width=480, height=420),
    )


PRICES = {
    "currency": "EUR",
    "moulds": [
        {"min_radius_m": 5, "max_diameter_m": 3, "each": 900, "per_m2": 350},
        {"each": 2400, "per_m2": 800},
    ],
    "blanks": {"per_m2": 95, "flat_per_m2": 45},
    "panels": {"per_m2": 140, "flat_per_m2": 90},
}
"""The prices of `14_cost.py` and docs/cost.md; yours are others."""


def cost_against_smoothness() -> Image.Image:
    """Cost over the mean angle of the roof, for every number of moulds."""
    smooth = minimize_angles(fit_spheres(roof_mesh())).sphere_mesh
    found = cost_curve(smooth, PRICES, flat_below=5.0, thickness=0.02)
    image = Image.new("RGB", (1280, 760), "white")
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(size=22)
    (left, right), (bottom, top) = (2.28, 2.80), (600, 820)

    def place(mean: float, cost: float) -> tuple[float, float]:
        x = 110 + 1120 * (mean - left) / (right - left)
        return x, 660 - 600 * (cost / 1000 - bottom) / (top - bottom)

    for cost in range(bottom, top + 1, 40):
        x, y = place(left, 1000 * cost)
        draw.line([(x, y), (1230, y)], "#dddddd")
        draw.text((x - 12, y), str(cost), "#444444", font, anchor="rm")
    for mean in np.arange(2.3, right, 0.1):
        x, y = place(float(mean), 1000 * bottom)
        draw.line([(x, y), (x, 60)], "#dddddd")
        draw.text((x, y + 12), f"{mean:.1f}", "#444444", font, anchor="mt")
    draw.text((20, 16), "cost in 1,000 EUR", "#444444", font)
    draw.text((1230, 715), "mean angle between neighbours, degrees", "#444444", font, "rt")
    curves = (
        (found["rows"][:-1], "#1f5fa8", "all panels curved", 1),
        (found["flat_rows"][:-1], "#c25a12", "flat below 5 mm", -1),
    )
    for i, (rows, color, name, side) in enumerate(curves):
        points = [place(row["mean_deg"], row["total"]) for row in rows]
        draw.line(points, color, 3)
        for row, (x, y) in zip(rows, points, strict=True):
            draw.ellipse([x - 5, y - 5, x + 5, y + 5], color)
            if row["moulds"] <= 4:
                draw.text((x, y + 14), str(row["moulds"]), color, font, anchor="mt")
            elif row["moulds"] in {5, 16, 24, 32, 48, 64}:
                anchor = "lm" if side > 0 else "rm"
                draw.text((x + 14 * side, y), str(row["moulds"]), color, font, anchor=anchor)
        draw.text((820, 90 + 34 * i), f"number of moulds, {name}", color, font)
    return image


def assemblies() -> Image.Image:
    """Six assemblies from below, and below each one of its nodes."""
    roof, dome = roof_mesh(12, 18), _cut_open(ellipsoid_mesh(16, 9))
    vase, funnel = _cut_open(vase_mesh(20, 9)), _cut_open(catenoid_mesh(24, 9))
    exact = exact_support(dome).sphere_mesh
    moulds = cluster_radii(_smooth(roof), 6).sphere_mesh
    made = [
        _on_axes(moulds),
        _on_axes(exact, common_axes(exact)),
        _on_axes(_smooth(funnel), side="outward"),
        _on_axes(_smooth(vase), side="centred"),
        _upright(_smooth(triangulate(vase))),
        _upright(_smooth(triangulate(roof))),
    ]
    rows = [_beside(*map(_views_from_below, made[k : k + 3])) for k in (0, 3)]
    sheet = Image.new("RGB", (rows[0].width, sum(row.height for row in rows)))
    for k, row in enumerate(rows):
        sheet.paste(row, (0, k * row.height))
    return sheet.quantize(96)


def _cut_open(mesh: Mesh) -> Mesh:
    """The half of a closed shape that is seen from within, from the front."""
    middle = np.median(face_centroids(mesh)[:, 1])
    faces = [
        face
        for face, center in zip(mesh.faces, face_centroids(mesh), strict=True)
        if center[1] > middle
    ]
    used, corners = np.unique(np.concatenate(faces), return_inverse=True)
    ends = np.cumsum([len(face) for face in faces])
    return Mesh(mesh.vertices[used], np.split(corners, ends[:-1]))


def _smooth(mesh: Mesh) -> SphereMesh:
    return minimize_angles(fit_spheres(mesh)).sphere_mesh


def _on_axes(
    spheres: SphereMesh, axes: np.ndarray | None = None, side: Side = "inward"
) -> tuple[Panels, Beams]:
    """Panels that rest on beams between node axes; sizes in mean edges."""
    edge = mean_edge_length(spheres.mesh)
    support = axis_support(spheres, depth=0.25 * edge, axes=axes)
    cut = panels(
        spheres, edges="axis", axes=support.axes, thickness=0.02 * edge, side=side,
        joint_gap=0.01 * edge,
    ).panels  # fmt: skip
    return cut, beams(support.annuli, thickness=0.04 * edge, panels=cut).beams


def _upright(spheres: SphereMesh) -> tuple[Panels, Beams]:
    """Panels that rest on upright beams before node cylinders; sizes in mean edges."""
    edge = mean_edge_length(spheres.mesh)
    upright = bisector_support(spheres, depth=0.25 * edge)
    sizes: dict[str, Any] = {"axes": upright.axes, "thickness": 0.02 * edge}
    joint = least_joint(spheres, joint_gap=0.01 * edge, **sizes)
    cut = panels(spheres, thickness=0.02 * edge, joint_gap=joint).panels
    below: dict[str, Any] = {"thickness": 0.04 * edge, "panels": cut}
    radius = least_node_radius(upright.annuli, **below)
    return cut, beams(upright.annuli, node_radius=radius, **below).beams


def _views_from_below(made: tuple[Panels, Beams]) -> Image.Image:
    """An assembly from below, and the node that is seen best from there."""
    cut, frame = made
    annuli = frame.annuli
    whole = np.array([0.25, -0.9, -0.35])
    nodes, axes = annuli.edge_vertices.ravel(), annuli.node_axes.reshape(-1, 3)
    counts = np.bincount(nodes)
    inside = counts[nodes] == np.median(counts[counts > 0])
    end = np.argmax(np.where(inside, axes @ whole, -2.0))
    aside = np.cross(axes[end], [0.6, 0.0, 0.8])
    node, near = int(nodes[end]), axes[end] + 0.8 * aside / np.linalg.norm(aside)
    size = {"width": 400, "height": 300}
    views = (
        assembly_image(cut, frame, whole, **size),
        assembly_image(cut, frame, near, node, **size),
    )
    sheet = Image.new("RGB", (400, 600))
    for k, view in enumerate(views):
        sheet.paste(view, (0, 300 * k))
    return sheet


PICTURES = {
    "roof": roof,
    "roof-zebra": roof_zebra,
    "pencil": pencil,
    "render": lights,
    "mobius": mobius,
    "models": models,
    "hexagons": hexagons,
    "hybrid-dome": hybrid_dome,
    "facade": facade,
    "strips": strips,
    "few-moulds": few_moulds,
    "remeshed-torus": remeshed_torus,
    "remeshed-roof": remeshed_roof,
    "quad-pattern": quad_pattern,
    "patterns": patterns,
    "pattern-lines": pattern_lines,
    "pattern-scales": pattern_scales,
    "supports": supports,
    "cost-curve": cost_against_smoothness,
    "assemblies": assemblies,
}


def main(folder: Path) -> None:
    """Draw and write every picture."""
    for name, draw in PICTURES.items():
        path = folder / f"{name}.png"
        draw().save(path, optimize=True)
        print(f"{path}: {path.stat().st_size // 1000} kB")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "docs/images"))
