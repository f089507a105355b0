"""spheremesh turns a design surface into spherical panels that can be built.

The node library is `spheremesh.nodes`; graphs of nodes are run by `Graph`.
"""

from collections.abc import Callable
from importlib import import_module
from typing import Any

from .kernel.display import lend
from .kernel.meshes.mesh import Mesh
from .kernel.sphere_meshes.sphere_mesh import SphereMesh
from .kernel.surfaces.surface import Surface
from .nodes.graphs.graph import Graph
from .nodes.graphs.specification.wires import each
from .nodes.graphs.sweeps.sweep import sweep

__version__ = "0.1.0"
__all__ = ["Graph", "Mesh", "SphereMesh", "Surface", "__version__", "each", "sweep"]


def _of(module: str, name: str) -> Callable[..., Any]:
    """A function whose module is imported when it is called."""

    def call(*arguments: Any) -> Any:  # noqa: ANN401, whatever it takes and gives
        return getattr(import_module(module, __name__), name)(*arguments)

    return call


# What types of the kernel show in notebooks, and what they become in other libraries.
lend("_repr_html_", _of(".interfaces.notebook", "notebook_html"))
lend("to_trimesh", _of(".fabrication.objects", "trimesh_object"))
lend("to_pyvista", _of(".fabrication.objects", "pyvista_object"))
lend("to_cadquery", _of(".fabrication.objects", "cadquery_object"))
