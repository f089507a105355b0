"""Pictures of what nodes make in their examples: meshes, sphere meshes, panels, beams."""

import contextlib
import inspect
import io
import warnings
from collections.abc import Iterable, Iterator
from doctest import DocTestParser
from pathlib import Path
from typing import Any

from PIL import Image

from spheremesh import Mesh, SphereMesh
from spheremesh.kernel.beams.beams import Beams
from spheremesh.kernel.errors import SpheremeshError
from spheremesh.kernel.panels.panels import Panels
from spheremesh.nodes import Node, face_planes, panels
from spheremesh.viewer.assembly import assembly_image
from spheremesh.viewer.render import render_image

SIZE = (480, 320)
FROM_BELOW = (0.6, -0.8, -0.7)
DRAWN = (Beams, Panels, SphereMesh, Mesh)
"""Types that have a picture, the most telling first."""


def write_pictures(nodes: Iterable[Node], folder: Path) -> dict[str, str]:
    """Draw what there is to see into a folder; the name of the file by node."""
    names: dict[str, str] = {}
    for node in nodes:
        image = picture(node)
        if image is not None:
            names[node.name] = f"{node.name}.png"
            image.save(folder / names[node.name], optimize=True)
    return names


def picture(node: Node) -> Image.Image | None:
    """What a node makes in its example, or writes into a file, if it is something to see."""
    results, others = example_results(node)
    shown = [value for value in others if isinstance(value, Panels)]
    shown += [panels(value).panels for value in others if isinstance(value, SphereMesh)]
    for kind in DRAWN:
        found = [value for value in results if isinstance(value, kind)]
        if found:
            return _drawn(found[-1], shown)
    return _drawn(shown[0], []) if node.is_writer and shown else None


def example_results(node: Node) -> tuple[list[Any], list[Any]]:
    """What a node gives in its example and what else there is; of both also the fields."""
    names: dict[str, Any] = {"__name__": "docs"}
    results: list[Any] = []

    def _noted(*arguments: Any, **options: Any) -> Any:  # noqa: ANN401
        result = node.function(*arguments, **options)
        results.append(result)
        return result

    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
        warnings.simplefilter("ignore")
        for example in DocTestParser().get_examples(node.help):
            exec(compile(example.source, node.name, "single"), names)  # noqa: S102
            # As `spheremesh.nodes` hands it out, with checks of its arguments around it.
            if inspect.unwrap(names.get(node.name, print)) is node.function:
                names[node.name] = _noted
    return list(_with_fields(results)), list(_with_fields(names.values()))


def _with_fields(values: Iterable[Any]) -> Iterator[Any]:
    for value in values:
        yield value
        yield from value if isinstance(value, tuple) else ()


def _drawn(value: Any, others: list[Panels]) -> Image.Image | None:  # noqa: ANN401
    """A picture; None of what cannot be cut into panels, and of beams without panels."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            if isinstance(value, Beams):
                if not others:
                    return None
                return assembly_image(others[0], value, FROM_BELOW, None, *SIZE)
            if isinstance(value, Mesh):
                value = face_planes(value)
            if isinstance(value, SphereMesh):
                value = panels(value).panels
            return render_image(value, width=SIZE[0], height=SIZE[1])
        except SpheremeshError:
            return None
