"""Laws of conjugate directions (F7, F9): from exact derivatives, and from meshes."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from spheremesh import Mesh
from spheremesh.kernel.arrays import FloatArray, dot, norm, unit
from spheremesh.kernel.congruences.curvature_spheres import touching_spheres
from spheremesh.kernel.errors import InputError
from spheremesh.kernel.meshes.curvature import vertex_normals
from spheremesh.kernel.remesh.field.conjugate_directions import conjugate_directions
from spheremesh.kernel.remesh.field.conjugate_form import conjugate_form, form_roots, split_form
from spheremesh.kernel.remesh.field.jets import CongruenceJets, expected_node_axes
from spheremesh.kernel.spheres.mobius_group import inversion, rotation_about, similarity
from spheremesh.kernel.spheres.mobius_images import map_points, map_spheres
from spheremesh.kernel.surfaces.triangulated import SampleShape, triangulated_surface

ORDER = 4
LORENTZ_GROUP = np.random.default_rng(5).normal(size=(5, 5))


class Series:
    """Power series in two variables to fourth order, at many points at once."""

    __array_ufunc__ = None

    def __init__(self, terms: FloatArray) -> None:
        self.terms = terms

    def __add__(self, other: "Series | FloatArray | float") -> "Series":
        terms = self.terms.copy()
        if isinstance(other, Series):
            return Series(terms + other.terms)
        terms[0, 0] += other
        return Series(terms)

    __radd__ = __add__

    def __neg__(self) -> "Series":
        return Series(-self.terms)

    def __sub__(self, other: "Series | FloatArray | float") -> "Series":
        return self + (-other)

    def __mul__(self, other: "Series | FloatArray | float") -> "Series":
        if not isinstance(other, Series):
            return Series(self.terms * other)
        terms = np.zeros_like(self.terms)
        for i in range(ORDER + 1):
            for j in range(ORDER + 1 - i):
                for p in range(i + 1):
                    for q in range(j + 1):
                        terms[i, j] += self.terms[p, q] * other.terms[i - p, j - q]
        return Series(terms)

    __rmul__ = __mul__

    def compose(self, derivatives: list[FloatArray]) -> "Series":
        """A function of the series, by its derivatives at the constant terms."""
        rest = Series(self.terms.copy())
        rest.terms[0, 0] = 0
        result, power = Series(np.zeros_like(self.terms)) + derivatives[0], rest
        for k, derivative in enumerate(derivatives[1:], 1):
            result = result + power * (derivative / np.prod(np.arange(1, k + 1)))
            power = power * rest
        return result

    def power(self, exponent: float) -> "Series":
        """The series to a real power."""
        base, factor, derivatives = self.terms[0, 0], 1.0, []
        for k in range(ORDER + 1):
            derivatives.append(factor * base ** (exponent - k))
            factor *= exponent - k
        return self.compose(derivatives)

    def cos(self) -> "Series":
        """Its cosine."""
        x = self.terms[0, 0]
        return self.compose([np.cos(x), -np.sin(x), -np.cos(x), np.sin(x), np.cos(x)])

    def sin(self) -> "Series":
        """Its sine."""
        return (self - np.pi / 2).cos()

    def along(self, axis: int) -> "Series":
        """Derivative; its highest order is lost."""
        moved = np.moveaxis(self.terms, axis, 0)
        terms = np.zeros_like(moved)
        terms[:-1] = moved[1:] * np.arange(1, ORDER + 1).reshape(-1, 1, 1)
        return Series(np.moveaxis(terms, 0, axis))


Vector = list[Series]


def product(a: Vector, b: Vector) -> Series:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    return [a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3] for i in range(3)]


def torus(u: Series, v: Series) -> Vector:
    reach = 2.0 + 0.7 * v.cos()
    return [reach * u.cos(), reach * u.sin(), 0.7 * v.sin()]


def ellipsoid(u: Series, v: Series) -> Vector:
    return [1.6 * u.cos() * v.cos(), 1.2 * u.sin() * v.cos(), 0.9 * v.sin()]


def bump(u: Series, v: Series) -> Vector:
    hill = 0.5 * (0.9 * u).cos() * (0.7 * v).cos()
    return [u, v, hill + 0.1 * u * v + 0.08 * u * u * u]


class Exact:
    """A tangential congruence with exact derivatives, and the lines of curvature."""

    def __init__(self, surface: Callable[..., Vector], kind: str, count: int = 60) -> None:
        rng = np.random.default_rng(2)
        u, v = (Series(np.zeros((ORDER + 1, ORDER + 1, count))) for _ in range(2))
        u.terms[0, 0], v.terms[0, 0] = rng.uniform(0.3, 1.1, (2, count))
        u.terms[1, 0] = v.terms[0, 1] = 1
        f = surface(u, v)
        f_u, f_v = [c.along(0) for c in f], [c.along(1) for c in f]
        n = cross(f_u, f_v)
        n = [c * product(n, n).power(-0.5) for c in n]
        first = [product(a, b) for a, b in ((f_u, f_u), (f_u, f_v), (f_v, f_v))]
        seconds = [[c.along(i) for c in d] for d, i in ((f_u, 0), (f_u, 1), (f_v, 1))]
        second = [product(s, n) for s in seconds]
        area = first[0] * first[2] - first[1] * first[1]
        mixed = first[0] * second[2] - 2.0 * first[1] * second[1] + first[2] * second[0]
        mean = mixed * (2.0 * area).power(-1)
        one = Series(np.zeros_like(u.terms)) + 1.0
        curvature = {
            "constant": 2.0 * one,
            "plane": -(n[2] + 1.0) * (f[2] + 3.0).power(-1),
            "central": mean,
            "mixed": 0.6 * mean + 0.15 * (1.3 * f[0] + 0.5).sin() * f[1].cos() + 0.3,
        }[kind]
        a = 0.5 * curvature
        b = [curvature * f[i] + n[i] for i in range(3)]
        c = a * product(f, f) + product(n, f)
        self.rows = [a, *b, c]
        self.tangents = np.stack([[c.terms[0, 0] for c in t] for t in (f_u, f_v)]).T
        e, g = [s.terms[0, 0] for s in first], [s.terms[0, 0] for s in second]
        self.lines = np.stack(
            [e[0] * g[1] - e[1] * g[0], e[0] * g[2] - e[2] * g[0], e[1] * g[2] - e[2] * g[1]], 1
        )

    def jets(self) -> CongruenceJets:
        """Exact derivatives in the parameters."""

        def _term(i: int, j: int, factor: float = 1.0) -> FloatArray:
            return np.stack([factor * row.terms[i, j] for row in self.rows], 1)

        return CongruenceJets(
            _term(0, 0), _term(1, 0), _term(0, 1), _term(2, 0, 2), _term(1, 1), _term(0, 2, 2)
        )

    def directions(self, form: FloatArray) -> FloatArray:
        """Unit tangents (n, 2, 3) in which a form of the parameters vanishes."""
        first, second, is_real = form_roots(*split_form(form))
        assert is_real.all()
        angles = np.stack([first, second], 1)
        steps = np.stack([np.cos(angles), np.sin(angles)], -1)
        return unit(np.einsum("nrp,nip->nri", steps, self.tangents))


def sine_between(first: FloatArray, second: FloatArray) -> FloatArray:
    """Largest sine between two pairs of lines (n, 2, 3), in the better of the two orders."""
    straight = norm(np.cross(first, second)).max(axis=1)
    swapped = norm(np.cross(first, second[:, ::-1])).max(axis=1)
    return np.minimum(straight, swapped)


def mapped(jets: CongruenceJets, matrix: FloatArray) -> CongruenceJets:
    return CongruenceJets(*(value @ matrix.T for value in vars(jets).values()))


# F7


@pytest.mark.parametrize(
    ("surface", "kind"),
    [
        (torus, "constant"), (ellipsoid, "constant"), (bump, "constant"),
        (ellipsoid, "plane"), (bump, "plane"), (torus, "central"), (ellipsoid, "central"),
    ],
)  # fmt: skip
def test_law_f7_curvature_lines_are_conjugate(
    surface: Callable[..., Vector], kind: str
) -> None:
    exact = Exact(surface, kind)
    found = exact.directions(conjugate_form(exact.jets()))
    assert sine_between(found, exact.directions(exact.lines)).max() < 1e-9


def test_law_f7_mixed_congruences_follow_other_lines() -> None:
    exact = Exact(bump, "mixed")
    form = conjugate_form(exact.jets())
    first, second, is_real = form_roots(*split_form(form))
    lines = form_roots(*split_form(exact.lines))
    assert is_real.mean() > 0.3
    gap = np.abs(np.sin(first - lines[0]))[is_real]
    assert np.median(np.minimum(gap, np.abs(np.sin(second - lines[0]))[is_real])) > 0.02


def test_law_f7_parameter_lines_of_a_translation_surface() -> None:
    rng = np.random.default_rng(7)
    point, a_u, b_v, a_uu, b_vv = rng.normal(size=(5, 40, 4))
    scale, scale_u, scale_v, scale_uu, scale_uv, scale_vv = rng.normal(size=(6, 40, 1))
    zero, one = np.zeros((40, 4)), np.ones((40, 1))

    def _lift(vector: FloatArray, weight: FloatArray) -> FloatArray:
        return np.concatenate([vector, weight * one], 1)

    x, x_u, x_v = _lift(point, one), _lift(a_u, 0 * one), _lift(b_v, 0 * one)
    x_uu, x_uv, x_vv = _lift(a_uu, 0 * one), _lift(zero, 0 * one), _lift(b_vv, 0 * one)
    jets = CongruenceJets(
        scale * x,
        scale_u * x + scale * x_u,
        scale_v * x + scale * x_v,
        scale_uu * x + 2 * scale_u * x_u + scale * x_uu,
        scale_uv * x + scale_u * x_v + scale_v * x_u + scale * x_uv,
        scale_vv * x + 2 * scale_v * x_v + scale * x_vv,
    )
    form = conjugate_form(jets)
    outer = np.abs(form[:, [0, 2]]).max(axis=1)
    assert (outer / np.abs(form[:, 1])).max() < 1e-9


def test_law_f7_agrees_with_two_second_forms_in_one_parametrisation() -> None:
    exact = Exact(bump, "mixed")
    jets = exact.jets()
    base = np.stack([jets.rows, jets.rows_u, jets.rows_v], 1)
    normals = np.linalg.svd(base)[2][:, 3:]
    forms = [
        np.einsum("nki,ni->nk", normals, second)
        for second in (jets.rows_uu, jets.rows_uv, jets.rows_vv)
    ]
    a, b, c = forms
    matrices = np.stack([np.stack([a, b], 1), np.stack([b, c], 1)], 1).transpose(3, 0, 1, 2)
    values, vectors = np.linalg.eig(np.linalg.solve(matrices[0], matrices[1]))
    is_real = np.abs(values.imag).max(axis=1) < 1e-12
    first, second, real = form_roots(*split_form(conjugate_form(jets)))
    assert (real == is_real).all()
    angles = np.arctan2(vectors[:, 1].real, vectors[:, 0].real)[real]
    roots = np.stack([first, second], 1)[real]
    miss = np.minimum(
        np.abs(np.sin(angles - roots)).max(axis=1),
        np.abs(np.sin(angles - roots[:, ::-1])).max(axis=1),
    )
    assert np.quantile(miss, 0.9) < 1e-9


# F9


def test_law_f9_the_form_needs_no_chart_and_is_a_field() -> None:
    exact = Exact(ellipsoid, "central")
    jets = exact.jets()
    form = unit(conjugate_form(jets))
    for matrix in (LORENTZ_GROUP, np.diag([1.0, -1, 1, 1, 1])):
        sign = np.sign(np.linalg.det(matrix))
        image = unit(conjugate_form(mapped(jets, matrix)))
        np.testing.assert_allclose(image, sign * form, atol=1e-9)


def test_law_f9_rows_may_be_scaled_from_point_to_point() -> None:
    exact = Exact(torus, "central")
    form = unit(conjugate_form(exact.jets()))
    u, v = (Series(np.zeros_like(exact.rows[0].terms)) for _ in range(2))
    u.terms[1, 0] = v.terms[0, 1] = 1
    factor = (0.3 * u - 0.4 * v + 0.8).power(-1) + u * v
    exact.rows = [row * factor for row in exact.rows]
    np.testing.assert_allclose(unit(conjugate_form(exact.jets())), form, atol=1e-10)


@settings(max_examples=30, deadline=None)
@given(st.floats(-3, 3), st.floats(0.01, 3), st.floats(-3, 3))
@example(h=0.98, m=1.0, angle=0.4)
def test_roots_are_where_the_form_vanishes(h: float, m: float, angle: float) -> None:
    # Rounding decides about roots that are one, or just as far apart as asked for.
    assume(min(abs(abs(h) - m), abs(abs(h) - m * np.cos(0.3))) > 1e-9 * m)
    trace, deviator = np.array([h]), np.array([m * np.exp(2j * angle)])
    first, second, is_real = form_roots(trace, deviator)
    assert is_real[0] == (abs(h) < m)
    assert 0 <= second[0] - first[0] <= np.pi
    if is_real[0]:
        for root in (first, second):
            assert abs(h + m * np.cos(2 * (root[0] - angle))) < 1e-12 * (abs(h) + m)
    apart = form_roots(trace, deviator, least_angle=0.3)
    assert np.sin(apart[1] - apart[0]) >= np.sin(0.3) - 1e-12
    # What was moved apart is said.
    assert apart[2][0] == (abs(h) < m * np.cos(0.3))
    if apart[2][0]:
        np.testing.assert_array_equal(apart[:2], (first, second))


# From meshes


@pytest.mark.parametrize(
    ("shape", "kind"),
    [("torus", "constant"), ("hypar", "constant"), ("bump", "constant"), ("bump", "plane")],
)
def test_directions_of_meshes_are_curvature_lines(shape: SampleShape, kind: str) -> None:
    mesh, normals = triangulated_surface(shape, 0.1, seed=1)
    heights = mesh.vertices[:, 2]
    curvatures = 2.0 if kind == "constant" else -(1 + normals[:, 2]) / (heights + 3)
    spheres = touching_spheres(mesh.vertices, normals, curvatures)
    found = conjugate_directions(mesh, spheres)
    assert found.complex_share == 0
    inner = ~mesh.topology.is_boundary_vertex
    # Curvature lines cross at right angles, and the normal turns along them in their direction.
    cosines = dot(found.directions[:, 0], found.directions[:, 1])[inner]
    assert np.degrees(np.median(np.abs(cosines))) < 0.05
    assert np.degrees(np.quantile(np.abs(cosines), 0.95)) < 1


def ellipsoid_curvature(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Curvature lines (V, 2, 3) of the sample ellipsoid, and its mean curvatures."""
    squares = np.array([1.6, 1.2, 0.9]) ** 2
    slopes = points / squares
    across = np.eye(3) - unit(slopes)[:, :, None] * unit(slopes)[:, None]
    lines = np.linalg.eigh(across @ np.diag(1 / squares) @ across)[1]
    mean = dot(points, points) - squares.sum()
    mean /= 2 * squares.prod() * norm(slopes) ** 3
    return lines[..., 1:].transpose(0, 2, 1), mean


def test_law_f7_central_spheres_of_an_ellipsoid_from_a_mesh() -> None:
    mesh, normals = triangulated_surface("ellipsoid", 0.1, seed=1)
    lines, mean = ellipsoid_curvature(mesh.vertices)
    found = conjugate_directions(mesh, touching_spheres(mesh.vertices, normals, mean))
    inner = ~mesh.topology.is_boundary_vertex
    errors = np.degrees(np.arcsin(sine_between(found.directions, lines)[inner]))
    assert np.median(errors) < 0.05
    assert np.quantile(errors, 0.95) < 1


def test_noise_lowers_the_degree_and_spares_the_directions() -> None:
    mesh, normals = triangulated_surface("ellipsoid", 0.15, seed=1)
    lines, _ = ellipsoid_curvature(mesh.vertices)
    inner = ~mesh.topology.is_boundary_vertex
    noise = np.random.default_rng(3).normal(size=normals.shape)
    degrees: list[int] = []
    for size in (0.0, 1e-3, 1e-2):
        rows = touching_spheres(mesh.vertices, unit(normals + size * noise), -2.0)
        runs = {d: conjugate_directions(mesh, rows, d) for d in (None, 3, 5, 7)}
        errors = {
            degree: float(np.median(sine_between(run.directions, lines)[inner]))
            for degree, run in runs.items()
        }
        assert errors[None] < 1.5 * min(errors.values())
        degrees.append(runs[None].degree)
    assert degrees == sorted(degrees, reverse=True)
    assert degrees[0] == 7 > degrees[-1]


def test_directions_commute_with_inversions() -> None:
    mesh, normals = triangulated_surface("bump", 0.1, seed=1)
    curvatures = 0.8 + 0.2 * np.sin(mesh.vertices[:, 0])
    spheres = touching_spheres(mesh.vertices, normals, curvatures)
    center = np.array([0.4, -0.3, 3.0])
    turn = inversion(center=center, radius=2.0)
    image = Mesh(map_points(mesh.vertices, turn), [face[::-1] for face in mesh.faces])
    found = conjugate_directions(mesh, spheres)
    moved = conjugate_directions(image, map_spheres(spheres, turn))
    arms = unit(mesh.vertices - center)[:, None]
    expected = found.directions - 2 * dot(found.directions, arms)[..., None] * arms
    use = found.is_real & moved.is_real & ~mesh.topology.is_boundary_vertex
    assert (found.is_real != moved.is_real).mean() < 0.03
    # The tangent planes of the two meshes agree only to second order.
    sines = sine_between(moved.directions[use], expected[use])
    assert np.median(sines) < 0.01
    assert np.quantile(sines, 0.95) < 0.05


@settings(max_examples=6, deadline=None)
@given(st.sampled_from([1e-3, 1.0, 1e3]), st.sampled_from([0.0, 1e5]))
def test_directions_do_not_depend_on_units_and_place(scale: float, distance: float) -> None:
    mesh, normals = triangulated_surface("hypar", 0.2, seed=1)
    spheres = touching_spheres(mesh.vertices, normals, 2.0)
    found = conjugate_directions(mesh, spheres)
    axis = unit(np.array([1.0, 2, -1]))
    turn = similarity(
        scale=scale,
        rotation=rotation_about(0.7 * axis),
        translation=scale * distance * np.array([1.0, -1, 0.5]),
    )
    image = Mesh(map_points(mesh.vertices, turn), mesh.faces)
    moved = conjugate_directions(image, map_spheres(spheres, turn))
    sine, cosine = np.sin(0.7), np.cos(0.7)
    turned = cosine * found.directions + sine * np.cross(axis, found.directions)
    turned += (1 - cosine) * (found.directions @ axis)[..., None] * axis
    assert np.quantile(sine_between(moved.directions, turned), 0.99) < 1e-4
    np.testing.assert_allclose(moved.curvatures * scale, found.curvatures, rtol=1e-6)


def test_directions_do_not_depend_on_numbers_and_signs() -> None:
    mesh, normals = triangulated_surface("bump", 0.2, seed=1)
    rng = np.random.default_rng(4)
    spheres = touching_spheres(mesh.vertices, normals, 1.3)
    found = conjugate_directions(mesh, spheres)
    order = rng.permutation(mesh.n_vertices)
    place = np.argsort(order)
    faces = place[mesh.corners.reshape(-1, 3)][rng.permutation(mesh.n_faces)]
    scales = rng.uniform(0.1, 10, (mesh.n_vertices, 1)) * rng.choice(
        [-1, 1], (mesh.n_vertices, 1)
    )
    moved = conjugate_directions(Mesh(mesh.vertices[order], faces), (spheres * scales)[order])
    assert sine_between(moved.directions, found.directions[order]).max() < 1e-7


def test_node_axes_of_constant_radius_are_the_normals() -> None:
    mesh, normals = triangulated_surface("torus", 0.2)
    found = conjugate_directions(mesh, touching_spheres(mesh.vertices, normals, -2.0))
    assert np.degrees(np.nanmax(found.axis_angles)) < 1.0
    planes = CongruenceJets(*np.random.default_rng(0).normal(size=(6, 20, 5)))
    planes.rows[:, 0] = planes.rows_u[:, 0] = planes.rows_v[:, 0] = 0
    assert (expected_node_axes(planes) == 0).all()


def test_spheres_that_determine_no_directions_are_refused() -> None:
    mesh, normals = triangulated_surface("hypar", 0.2, seed=1)
    center = np.array([0.3, 0.2, 4.0])
    arms = center - mesh.vertices
    # Planes, and spheres orthogonal to one: power of its centre is the square of its radius.
    power = (dot(arms, arms) - 1) / (2 * dot(arms, normals))
    for curvatures in (np.zeros(len(normals)), 1 / power):
        with pytest.raises(InputError, match="do not determine conjugate directions"):
            conjugate_directions(mesh, touching_spheres(mesh.vertices, normals, curvatures))


def test_complex_directions_are_found_with_their_share() -> None:
    mesh, normals = triangulated_surface("bump", 0.1)
    curvatures = np.sin(3 * mesh.vertices[:, 0]) * np.cos(2 * mesh.vertices[:, 1])
    found = conjugate_directions(mesh, touching_spheres(mesh.vertices, normals, curvatures))
    assert found.complex_share > 0.05
    first, second = found.directions[~found.is_real].transpose(1, 0, 2)
    assert norm(np.cross(first, second)).max() < 1e-6


# Bad input


def test_bad_input_is_refused() -> None:
    mesh, normals = triangulated_surface("hypar", 0.4)
    spheres = touching_spheres(mesh.vertices, normals, 1.0)
    quads = Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    with pytest.raises(InputError, match=r"\[0\] are no triangles: triangulate"):
        conjugate_directions(quads, spheres[:4])
    with pytest.raises(InputError, match=r"shape \(36, 5\)"):
        conjugate_directions(mesh, spheres[:-1])
    imaginary = spheres.copy()
    imaginary[7] = [1, 0, 0, 0, 5]
    with pytest.raises(InputError, match=r"\[7\] are imaginary"):
        conjugate_directions(mesh, imaginary)
    imaginary[7] = np.nan
    with pytest.raises(InputError, match=r"\[7\] are not finite"):
        conjugate_directions(mesh, imaginary)
    twice = Mesh(
        np.concatenate([mesh.vertices, mesh.vertices + 5]),
        np.concatenate([mesh.corners.reshape(-1, 3), mesh.corners.reshape(-1, 3) + 36]),
    )
    with pytest.raises(InputError, match="2 separate pieces"):
        conjugate_directions(twice, np.concatenate([spheres, spheres]))
    flat = mesh.vertices.copy()
    flat[mesh.corners[1]] = flat[mesh.corners[0]]
    with pytest.raises(InputError, match="no area"):
        conjugate_directions(Mesh(flat, mesh.faces), spheres)
    for wrong, words in (({"degree": 9}, "from 2 to 7"), ({"rings": 0}, "1 to 10 rings")):
        with pytest.raises(InputError, match=words):
            conjugate_directions(mesh, spheres, **wrong)
    few, few_normals = triangulated_surface("hypar", 0.7)
    with pytest.raises(InputError, match="28 vertices, the mesh has 16: subdivide"):
        conjugate_directions(few, touching_spheres(few.vertices, few_normals, 1.0), degree=6)


def test_normals_of_the_samples_are_those_of_their_meshes() -> None:
    for shape in ("torus", "annulus", "hypar", "bump", "ellipsoid", "waves"):
        mesh, normals = triangulated_surface(shape, 0.15, seed=2)
        assert dot(vertex_normals(mesh), normals).min() > 0.99
