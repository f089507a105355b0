"""What is shown of a value: a picture, a table, a histogram or a text, as bytes."""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final, cast

import numpy as np
import xxhash
from numpy.typing import NDArray

from ...kernel.arrays import FloatArray
from ...kernel.beams.beams import Beams
from ...kernel.beams.cutting import cut_beams
from ...kernel.errors import SpheremeshError
from ...kernel.meshes.mesh import Mesh
from ...kernel.panels.panels import Panels
from ...kernel.reports import Report
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...kernel.spheres.arcs import Arcs, arc_points
from ...kernel.support.annuli import Annuli
from ...kernel.surfaces.surface import Surface
from ...nodes.graphs.annotations import Value, members
from ...nodes.graphs.node import Node
from ...nodes.graphs.ports import Port
from ...viewer.page.container import pack_arrays
from ..hops.values_out import plain
from .scenes import (
    Colors,
    Scene,
    beams_scene,
    counted,
    edge_scene,
    lines_scene,
    mesh_polygons,
    mesh_scene,
    packed_scene,
    panels_scene,
    row_scene,
    vertex_scene,
)

MOST_ROWS: Final = 400
"""Rows of a table, and numbers of a list, that are sent."""
MOST_IN_ROW: Final = 8
MOST_TEXT: Final = 20_000

_PICTURES: Final = {".png": "image/png", ".svg": "image/svg+xml"}

Carriers = Sequence[Mesh | SphereMesh | Panels]


def preview(value: Value, carriers: Carriers = (), name: str = "", unit: str = "") -> bytes:
    """What is shown of a value.

    Parameters
    ----------
    carriers : sequence of Mesh, SphereMesh or Panels
        What arrays may be shown on, the nearest first.
    name, unit : str
        Of the output.

    Returns
    -------
    bytes
        For `unpack_arrays`; the entry ``kind`` of the head says what it is: ``model``,
        ``numbers``, ``table`` or ``text``.
    """
    maker = next((make for kind, make in _SCENES.items() if isinstance(value, kind)), None)
    if maker is not None:
        return packed_scene(maker(value, carriers))
    if isinstance(value, list) and value:
        items = cast("list[Any]", value)
        if all(isinstance(item, Mesh | SphereMesh) for item in items):
            return packed_scene(row_scene(items[:MOST_IN_ROW], f"{len(items)} side by side"))
    if isinstance(value, np.ndarray):
        return _array(cast("NDArray[Any]", value), carriers, name, unit)
    return _words(value)


def file_preview(file: Path) -> bytes:
    """What is shown of a file that was written: a picture, or its text."""
    if file.suffix.lower() in _PICTURES:
        head = {"kind": "picture", "type": _PICTURES[file.suffix.lower()], "name": file.name}
        return pack_arrays(head, {"data": np.frombuffer(file.read_bytes(), np.uint8)})
    with file.open(encoding="utf-8", errors="replace") as lines:
        return pack_arrays({"kind": "text", "text": lines.read(MOST_TEXT)}, {})


def preview_node(port: Port, n_carriers: int, written: Path | None = None) -> Node:
    """The node that makes the preview of an output: its results are kept as all others are.

    Of a step that writes a file into a folder the file is shown.
    """

    def _preview(value: Value, **carriers: Value) -> NDArray[Any]:
        data = (
            file_preview(written / value)
            if written is not None
            else preview(value, tuple(carriers.values()), port.name, port.unit)
        )
        return np.frombuffer(data, np.uint8)

    inputs = {"value": Port("value")} | {f"on_{i}": Port(f"on_{i}") for i in range(n_carriers)}
    version = f"{port.name} {port.unit} {_origin()}"
    result = Port("result", type=np.ndarray)
    # A function of this place has a module whose code the store knows.
    return Node(
        "preview", _preview, version, "", "", "", inputs, {"result": result}, np.ndarray
    )


def _origin() -> str:
    """A digest of what pictures are made by."""
    state = xxhash.xxh3_64()
    for name in ("previews.py", "scenes.py"):
        state.update(Path(__file__).with_name(name).read_bytes())
    return state.hexdigest()


def _panels_of(carriers: Carriers) -> Panels | None:
    return next((each for each in carriers if isinstance(each, Panels)), None)


def _net_of(carriers: Carriers) -> Mesh | None:
    for each in carriers:
        if isinstance(each, SphereMesh):
            return each.mesh
        if isinstance(each, Mesh):
            return each
    return None


def _counted(mesh: Mesh) -> str:
    return f"{mesh.n_faces:,} faces · {mesh.n_vertices:,} vertices"


def _mesh(value: Mesh, _: Carriers) -> Scene:
    return mesh_scene(value, _counted(value))


def _spheres(value: SphereMesh, _: Carriers) -> Scene:
    return mesh_scene(value, counted(value.mesh.n_faces, "sphere"), [_radii(value)])


def _radii(value: SphereMesh) -> Colors:
    # Twice A is the signed curvature: flat faces have one as well, which radii have not.
    return Colors("Curvature", 2 * value.local_spheres[:, 0])


def _surface(value: Surface, _: Carriers) -> Scene:
    return mesh_scene(value.mesh, _counted(value.mesh))


def _beams(value: Beams, carriers: Carriers) -> Scene:
    return beams_scene(value, _panels_of(carriers), counted(value.n_beams, "beam"))


def _annuli(value: Annuli, carriers: Carriers) -> Scene:
    count = len(value.ids)
    sizes = np.abs(value.corners[:, :, 0] - value.corners[:, :, 1]).max(axis=(1, 2))
    thin, _ = cut_beams(value, thickness=0.02 * float(np.median(sizes)))
    return beams_scene(thin, _panels_of(carriers), f"{count:,} annuli")


def _arcs(value: Arcs, carriers: Carriers) -> Scene:
    points = arc_points(value, np.linspace(-1, 1, 9))
    starts, ends = points[:, :-1].reshape(-1, 3), points[:, 1:].reshape(-1, 3)
    return _lines(starts, ends, carriers, counted(len(points), "arc"))


def _lines(starts: FloatArray, ends: FloatArray, carriers: Carriers, words: str) -> Scene:
    net = _net_of(carriers)
    return lines_scene(starts, ends, None if net is None else mesh_polygons(net), words)


_SCENES: Final[dict[type, Callable[[Any, Carriers], Scene]]] = {
    Panels: lambda value, _: panels_scene(value),
    SphereMesh: _spheres,
    Mesh: _mesh,
    Surface: _surface,
    Beams: _beams,
    Annuli: _annuli,
    Arcs: _arcs,
}


def _array(array: NDArray[Any], carriers: Carriers, name: str, unit: str) -> bytes:
    """Values on the mesh that has as many faces, edges or vertices; else as numbers."""
    try:
        if array.dtype.kind in "biuf":
            scene = _array_scene(array, carriers, name, unit)
            if scene is not None:
                return packed_scene(scene)
    except (SpheremeshError, ValueError, IndexError):
        pass  # what cannot be drawn is told in numbers
    return _numbers(array, name, unit)


def _array_scene(array: NDArray[Any], carriers: Carriers, name: str, unit: str) -> Scene | None:
    words = f"{len(array):,} {name.replace('_', ' ')}" if array.ndim else name
    if array.ndim == 3 and array.shape[1:] == (2, 3) and len(array):
        return _lines(array[:, 0], array[:, 1], carriers, words)
    if array.ndim == 2 and array.shape[1] == 3 and len(array) and np.isfinite(array).all():
        return _lines(*_point_stars(array.astype(float)), carriers, words)
    if array.ndim != 1:
        return None
    values = array.astype(np.int64) if array.dtype.kind in "biu" else array.astype(float)
    if values.dtype.kind == "i" and len(np.unique(values)) > 40:
        values = values.astype(float)
    colors = Colors(name.replace("_", " ") if name != "result" else "Value", values, unit)
    for carrier in carriers:
        scene = _colored(carrier, colors, words)
        if scene is not None:
            return scene
    return None


def _colored(carrier: Mesh | SphereMesh | Panels, colors: Colors, words: str) -> Scene | None:
    count = len(colors.values)
    if isinstance(carrier, Panels):
        return (
            Scene(carrier, colors=[colors], ids=carrier.ids, words=words)
            if count == carrier.n_panels
            else None
        )
    net = carrier.mesh if isinstance(carrier, SphereMesh) else carrier
    if count == net.n_faces:
        return mesh_scene(carrier, words, [colors])
    if count == net.n_vertices:
        return vertex_scene(net, colors, words)
    if count == len(net.topology.edge_corners):
        return edge_scene(net, colors, words)
    return None


def _point_stars(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Points as three short rods each: starts and ends (3 N, 3)."""
    reach = 0.004 * (float(np.ptp(points, axis=0).max()) or 1.0) * np.eye(3)
    starts = (points[:, None] - reach).reshape(-1, 3)
    return starts, (points[:, None] + reach).reshape(-1, 3)


def _numbers(array: NDArray[Any], name: str, unit: str) -> bytes:
    """A histogram of numbers, and the first of them as they are."""
    flat = array.ravel()
    head: dict[str, Any] = {
        "kind": "numbers", "name": name, "unit": unit, "shape": list(array.shape),
        "rows": plain(array[:MOST_ROWS]) if array.ndim else [plain(array)],
    }  # fmt: skip
    if flat.dtype.kind not in "biuf":
        return pack_arrays(
            {**head, "kind": "text", "text": "\n".join(map(str, flat[:MOST_ROWS]))}, {}
        )
    finite = flat[np.isfinite(flat)].astype(float)
    return pack_arrays(head, {"values": finite[:200_000]})


def _words(value: Value) -> bytes:
    content = plain(value)
    if isinstance(value, Report | Mapping):
        return pack_arrays({"kind": "table", "table": _shortened(content)}, {})
    if isinstance(content, list) and content and isinstance(content[0], dict):
        rows = cast("list[Any]", content)
        return pack_arrays({"kind": "table", "table": {"": _shortened(rows)}}, {})
    text = content if isinstance(content, str) else json.dumps(content, ensure_ascii=False)
    return pack_arrays({"kind": "text", "text": text[:MOST_TEXT]}, {})


def _shortened(content: Value) -> Value:
    """Plain values, long lists cut."""
    if isinstance(content, dict):
        items = cast("dict[str, Value]", content)
        return {name: _shortened(item) for name, item in items.items()}
    if isinstance(content, list):
        several = cast("list[Value]", content)
        return [_shortened(item) for item in several[:MOST_ROWS]]
    return content


def carrier_types(hint: Value) -> tuple[type, ...]:
    """What values of a type are shown on: beams under panels, arrays on what they measure."""
    kinds = [member.kind for member in members(hint)]
    if Beams in kinds or Annuli in kinds:
        return (Panels,)
    if np.ndarray in kinds or Arcs in kinds:
        return (Mesh, SphereMesh, Panels)
    return ()


def has_kind(hint: Value, kinds: tuple[type, ...]) -> bool:
    """Whether a value of a type is of some of the classes."""
    return any(member.kind in kinds for member in members(hint))
