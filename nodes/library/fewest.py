"""The fewest moulds with which panels still meet smoothly enough."""

from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from ...fabrication.units import millimeters_per
from ...kernel.analysis import angle_summary
from ...kernel.errors import InputError
from ...kernel.meshes.creases import crease_edges
from ...kernel.optimization.radius_clustering import each_clustering
from ...kernel.reports import Report
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ..graphs.node import node, progress
from ..graphs.ports import Port, Units
from .arrays import CreaseAngle

AngleBound = Annotated[float, Port(unit="deg", min=0, max=180)]


@dataclass(frozen=True, eq=False)
class FewestReport(Report):
    """The fewest moulds, and what fewer would cost.

    Attributes
    ----------
    count : int
    max_angle, max_angle_largest : float or None
        What was asked for, in degrees.
    angles_deg : dict
        ``mean`` and ``max`` with so many moulds.
    mean_deg, max_deg : list of float
        The same with 1, 2, ... moulds up to these.
    """

    count: int
    max_angle: float | None
    max_angle_largest: float | None
    angles_deg: dict[str, float]
    mean_deg: list[float]
    max_deg: list[float]


class Fewest(NamedTuple):
    """A number of moulds."""

    k: int
    report: FewestReport


@node
def fewest_moulds(
    sphere_mesh: SphereMesh,
    max_angle: AngleBound | None = None,
    max_angle_largest: AngleBound | None = None,
    same_sagitta: Annotated[float, Port(unit="mm", min=0)] = 0.1,
    units: Units = "m",
    crease: CreaseAngle = 40.0,
) -> Fewest:
    """Find the fewest moulds with which neighbours meet at no more than given angles.

    Every number is tried, from one upwards: the mean angle may rise with a mould more, so that
    halving could miss the smallest. Vertices stay; with vertices that move, as many suffice.

    Parameters
    ----------
    sphere_mesh : SphereMesh
    max_angle : float, optional
        Largest mean angle between neighbours; this or the next is needed, both hold if both
        are given.
    max_angle_largest : float, optional
        Largest angle of all.
    same_sagitta : float
        Moulds that differ by less over the largest blank are one, as in `cluster_radii`.
    units : {"mm", "cm", "m", "in", "ft"}
        Model units.
    crease : float
        Edges at which the flat faces turn by more do not count; 180 for no creases.

    Returns
    -------
    k : int
        The number of moulds, for `cluster_radii`.
    report : FewestReport
        Angles with this number and all smaller ones.

    Examples
    --------
    >>> from spheremesh.nodes import fewest_moulds, fit_spheres, minimize_angles, vase_mesh
    >>> vase = minimize_angles(fit_spheres(vase_mesh(12, 6))).sphere_mesh
    >>> fewest_moulds(vase, max_angle=15.5).k
    2
    """
    if max_angle is None and max_angle_largest is None:
        raise InputError("fewest_moulds needs max_angle, max_angle_largest, or both")
    is_smooth = ~crease_edges(sphere_mesh.mesh, np.radians(crease))
    means: list[float] = []
    maxima: list[float] = []
    for clustered, _ in each_clustering(sphere_mesh, same_sagitta / millimeters_per(units)):
        found = angle_summary(clustered, is_smooth)
        means.append(found["mean"])
        maxima.append(found["max"])
        if _holds(means[-1], max_angle) and _holds(maxima[-1], max_angle_largest):
            report = FewestReport(
                len(means), max_angle, max_angle_largest, found, means, maxima
            )
            return Fewest(len(means), report)
        progress(len(means) / sphere_mesh.mesh.n_faces)
    raise InputError(_out_of_reach(means, maxima, max_angle, max_angle_largest))


def _holds(angle: float, bound: float | None) -> bool:
    return bound is None or angle <= bound


def _out_of_reach(
    means: list[float], maxima: list[float], mean: float | None, largest: float | None
) -> str:
    """What can be reached where the bounds cannot."""
    parts = [
        (f"{bound:g} degrees {what}", f"{angles[-1]:.4g} degrees {what}", min(angles))
        for bound, angles, what in ((mean, means, "in the mean"), (largest, maxima, "at most"))
        if bound is not None
    ]
    asked, reached, least = zip(*parts, strict=True)
    return (
        f"no number of moulds keeps neighbours at {' and '.join(asked)}: even with a mould per "
        f"panel they meet at {' and '.join(reached)} (the least of all numbers of moulds: "
        f"{' and '.join(f'{angle:.4g}' for angle in least)}); allow more, let vertices move "
        "(--tolerance 0.1), or make the faces smaller"
    )
