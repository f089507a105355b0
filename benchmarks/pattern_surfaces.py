"""Ten design surfaces of varied shape, none of which is a net of panels already."""

import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from spheremesh import Mesh, Surface
from spheremesh.kernel.arrays import FloatArray
from spheremesh.nodes import read_surface

Heights = Callable[[FloatArray, FloatArray], FloatArray]


def grid(points: FloatArray, *, closed: tuple[bool, bool] = (False, False)) -> Mesh:
    """Quads between points (n, m, 3); opposite sides may be glued."""
    ids = np.arange(points.shape[0] * points.shape[1]).reshape(points.shape[:2])
    for axis in range(2):
        if closed[axis]:
            ids = np.concatenate([ids, ids.take([0], axis)], axis)
    faces = np.stack([ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]], -1)
    return Mesh(points.reshape(-1, 3), faces.reshape(-1, 4))


def sheet(height: Heights, width: float = 4.0, depth: float = 2.8, askew: float = 0.0) -> Mesh:
    """A graph over a rectangle, whose sides may lean over and be turned."""
    u, v = np.meshgrid(
        np.linspace(-width / 2, width / 2, 81), np.linspace(-depth / 2, depth / 2, 57),
        indexing="ij",
    )  # fmt: skip
    x, y = u + askew * v, v + 0.3 * askew * u
    return grid(np.stack([x, y, height(x, y)], -1))


def bowl(u: FloatArray, v: FloatArray) -> FloatArray:
    """Bends more than twice as much one way as the other."""
    return -0.16 * u**2 - 0.06 * v**2


def pipe_bend() -> Mesh:
    """The outside of a bent pipe, cut slantwise."""
    u, v = np.meshgrid(np.linspace(0, 1.3, 81), np.linspace(-1.0, 1.0, 57), indexing="ij")
    turn, tube = u + 0.25 * v, v + 0.2 * u
    reach = 3.0 + np.cos(tube)
    points = [reach * np.cos(turn), reach * np.sin(turn), np.sin(tube)]
    return grid(np.stack(points, -1)[:, ::-1])


def minimal() -> Mesh:
    """A catenoid, slightly out of shape."""
    u, v = np.meshgrid(np.linspace(0, 2.2, 81), np.linspace(-0.9, 0.9, 57), indexing="ij")
    reach = np.cosh(v) + 0.03 * np.sin(2 * u) * v
    return grid(np.stack([reach * np.cos(u), reach * np.sin(u), v], -1)[:, ::-1])


def ellipsoid() -> Mesh:
    """A triaxial ellipsoid, closed and without poles: a rounded cube blown up."""
    n = 24
    angles = np.tan(np.linspace(-np.pi / 4, np.pi / 4, n + 1))
    u, v = np.meshgrid(angles, angles, indexing="ij")
    points: list[FloatArray] = []
    faces: list[FloatArray] = []
    for axis in range(3):
        for side in (1.0, -1.0):
            patch = np.roll(np.stack([np.full_like(u, side), side * u, v], -1), axis, axis=-1)
            ids = len(points) * (n + 1) ** 2 + np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
            points.append(patch.reshape(-1, 3))
            around = [ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:]]
            faces.append(np.stack(around, -1).reshape(-1, 4))
    stacked = np.concatenate(points)
    stacked /= np.linalg.norm(stacked, axis=1)[:, None]
    places = np.rint(stacked * 1e6).astype(np.int64)
    _, first, ids = np.unique(places, axis=0, return_index=True, return_inverse=True)
    stretched = stacked[first] * [1.5, 1.0, 0.75]
    return Mesh(stretched, ids.ravel()[np.concatenate(faces)])


def ring() -> Mesh:
    """A dome over an ellipse with a hole in its crown."""
    u, v = np.meshgrid(
        np.linspace(0, 2 * np.pi, 120, endpoint=False), np.linspace(0.35, 1, 30), indexing="ij"
    )
    x, y = 2.2 * v * np.cos(u), 1.5 * v * np.sin(u)
    points = np.stack([x, y, -0.18 * x**2 - 0.12 * y**2], -1)
    return grid(points[:, ::-1], closed=(True, False))


def drawn(folder: Path) -> Surface:
    """A cubic NURBS surface, read from a file of Rhino."""
    import rhino3dm

    surface = rhino3dm.NurbsSurface.Create(
        dimension=3, isRational=False, order0=4, order1=4, controlPointCount0=6,
        controlPointCount1=5,
    )  # fmt: skip
    for knots, values in ((surface.KnotsU, [0, 0, 0, 1, 2, 3, 3, 3]),
                          (surface.KnotsV, [0, 0, 0, 1, 2, 2, 2])):  # fmt: skip
        for i, value in enumerate(values):
            knots[i] = value
    for i in range(6):
        for j in range(5):
            x, y = 10 * i / 5 - 5, 7 * j / 4 - 3.5
            height = -0.06 * x**2 - 0.03 * y**2 + 0.3 * np.sin(0.5 * x + 0.3 * y)
            surface.Points[i, j] = rhino3dm.Point4d(x, y, float(height), 1)
    model = rhino3dm.File3dm()
    model.Objects.AddSurface(surface)
    path = folder / "drawn.3dm"
    model.Write(str(path), 8)
    return read_surface(path, edge_length=0.12)


def scan() -> Mesh:
    """A bowl as a scanner sees it: off by up to a thousandth of its width."""
    found = sheet(bowl)
    noise = np.random.default_rng(4).normal(scale=1.2e-3, size=found.n_vertices)
    return Mesh(found.vertices + noise[:, None] * [0, 0, 1], found.faces)


def own_surfaces() -> dict[str, Mesh | Surface]:
    """The ten surfaces by name."""
    with tempfile.TemporaryDirectory() as folder:
        nurbs = drawn(Path(folder))
    return {
        "askew bowl": sheet(bowl, askew=0.5),
        "askew pipe bend": pipe_bend(),
        "three ridges": sheet(lambda u, v: -0.1 * (u**2 + v**2) + 0.04 * (u**3 - 3 * u * v**2)),
        "two hills": sheet(lambda u, v: 0.5 * np.exp(-((u - 1) ** 2 + v**2))
                           + 0.4 * np.exp(-((u + 1) ** 2) - 1.5 * v**2)),
        "closed ellipsoid": ellipsoid(),
        "dome with a hole": ring(),
        "ribbed vault": sheet(lambda u, v: -0.25 * v**2 + 0.03 * np.cos(3.5 * u)),
        "nearly minimal": minimal(),
        "drawn": nurbs,
        "noisy scan": scan(),
    }  # fmt: skip
