"""spheremesh turns a design surface into spherical panels that can be built.

The node library is `spheremesh.nodes`; graphs of nodes are run by `Graph`.
"""

from .kernel.meshes.mesh import Mesh
from .kernel.sphere_meshes.sphere_mesh import SphereMesh
from .kernel.surfaces.surface import Surface
from .nodes.graphs.graph import Graph
from .nodes.graphs.specification.wires import each
from .nodes.graphs.sweeps.sweep import sweep

__version__ = "0.1.0"
__all__ = ["Graph", "Mesh", "SphereMesh", "Surface", "__version__", "each", "sweep"]
