"""A mesh on a smooth surface, with the exact shape of the surface at its vertices."""

from dataclasses import dataclass

import numpy as np

from ..arrays import BoolArray, FloatArray, read_only
from ..errors import InputError
from ..meshes.mesh import Mesh


@dataclass(frozen=True, eq=False)
class Surface:
    """A mesh whose vertices lie on a smooth surface, and how the surface bends there.

    Attributes
    ----------
    mesh : Mesh
        Quads and triangles with vertices on the surface, facing as the surface does.
    normals : (V, 3) float array
        Unit normals of the surface at the vertices.
    curvatures : (V, 2) float array
        The larger and the smaller principal curvature, positive where the surface bends to
        its normal, in inverse model units.
    directions : (V, 2, 3) float array
        Unit principal directions of the two; first, second and normal are right-handed. At
        an umbilic they are any two.
    is_smooth : (V,) bool array
        False on creases where faces meet, and at apexes: there the normal is a mean of those
        around, the curvature that of one face.

    Raises
    ------
    InputError
        If an array does not fit the mesh or is not finite.

    Examples
    --------
    >>> import numpy as np
    >>> from spheremesh import Mesh, Surface
    >>> square = Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), [[0, 1, 2, 3]])
    >>> axes = np.tile(np.eye(3), (4, 1, 1))
    >>> flat = Surface(square, axes[:, 2], np.zeros((4, 2)), axes[:, :2], np.ones(4, bool))
    >>> flat.curvatures.max()
    np.float64(0.0)
    """

    mesh: Mesh
    normals: FloatArray
    curvatures: FloatArray
    directions: FloatArray
    is_smooth: BoolArray

    def __post_init__(self) -> None:
        shapes = {"normals": (3,), "curvatures": (2,), "directions": (2, 3), "is_smooth": ()}
        for name, shape in shapes.items():
            kind = np.bool_ if name == "is_smooth" else np.float64
            array = np.array(getattr(self, name), kind)
            if array.shape != (self.mesh.n_vertices, *shape):
                raise InputError(
                    f"{name} of a surface have shape {array.shape}, not "
                    f"{(self.mesh.n_vertices, *shape)}: one row for each vertex"
                )
            if not np.isfinite(array).all():
                raise InputError(f"{name} of a surface are not finite")
            object.__setattr__(self, name, read_only(array))
