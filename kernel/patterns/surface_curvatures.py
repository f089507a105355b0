"""Principal curvatures of a mesh or surface, and the area that each stands for."""

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, norm, sum_by
from ..errors import InputError
from ..meshes.curvature import principal_curvatures
from ..meshes.mesh import Mesh, face_vector_areas
from ..surfaces.surface import Surface


@dataclass(frozen=True)
class SurfaceCurvatures:
    """Principal curvatures at the vertices of a surface.

    Attributes
    ----------
    first, second : (V,) float array
        The larger and the smaller one, positive where the surface bends to its normal.
    weights : (V,) float array
        Share of the area around each vertex; 0 where the curvature is not known.
    """

    first: FloatArray
    second: FloatArray
    weights: FloatArray

    def quantile(self, values: FloatArray, share: float) -> float:
        """Value (of V) that a share of the area does not exceed."""
        used = self.weights > 0
        return float(
            np.quantile(values[used], share, weights=self.weights[used], method="inverted_cdf")
        )

    def mean(self, values: FloatArray) -> float:
        """Mean of values (V,) over the area."""
        return float(values @ self.weights)

    @property
    def best(self) -> float:
        """The one curvature K that minimises the mean of ``|K - k1| + |K - k2|``.

        Returns
        -------
        float
            The median of all k1 and k2.
        """
        both = np.concatenate([self.first, self.second])
        twice = np.concatenate([self.weights, self.weights])
        used = twice > 0
        found = np.quantile(both[used], 0.5, weights=twice[used], method="inverted_cdf")
        return float(found)


def surface_curvatures(source: Mesh | Surface) -> SurfaceCurvatures:
    """Principal curvatures: exact ones of a surface, estimates of a mesh.

    Parameters
    ----------
    source : Mesh or Surface
        A dense mesh of any faces, or a surface with its exact shape.

    Raises
    ------
    InputError
        If the curvature is known nowhere.
    """
    if isinstance(source, Surface):
        mesh, (first, second) = source.mesh, source.curvatures.T
        is_known = source.is_smooth
    else:
        mesh = source
        first, second, is_known = principal_curvatures(mesh)
    areas = np.where(is_known, vertex_areas(mesh), 0.0)
    total = areas.sum()
    if not total > 0:
        raise InputError(
            "the curvature of this surface is known nowhere: it has too few faces, or nothing "
            "but creases; subdivide the mesh"
        )
    return SurfaceCurvatures(first, second, areas / total)


def vertex_areas(mesh: Mesh) -> FloatArray:
    """Area (V,) around each vertex, an equal part of each of its faces."""
    shares = norm(face_vector_areas(mesh)) / mesh.degrees
    return sum_by(mesh.corners, np.repeat(shares, mesh.degrees), mesh.n_vertices)
