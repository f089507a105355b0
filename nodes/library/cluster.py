"""Few moulds for many panels, and their blanks."""

from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

import numpy as np

from ...fabrication.units import millimeters_per
from ...kernel.analysis import angle_summary
from ...kernel.meshes.creases import crease_edges
from ...kernel.optimization import radius_clustering
from ...kernel.panels import congruent
from ...kernel.panels import mould_blanks as blanks
from ...kernel.panels.panels import Panels
from ...kernel.reports import Report
from ...kernel.sphere_meshes.sphere_mesh import SphereMesh
from ...kernel.tolerances import COMMON_VERTEX
from ..graphs.node import node, warn
from ..graphs.ports import Length, Port, Units
from .arrays import CreaseAngle, FaceLabels, MouldRadii


@dataclass(frozen=True, eq=False)
class MouldsReport(Report):
    """Moulds, and what they cost.

    Attributes
    ----------
    count : int
    radii : list of float or None
        None for a flat mould.
    panels_per_mould : list of int
    angles_deg, unrelaxed_angles_deg : dict
        ``mean`` and ``max`` in the end, and before vertices moved, over the edges that are no
        crease.
    reassigned : list of int
        Faces that are too large for the mould nearest to them.
    relaxed : bool
    vertex_move : float
        In mean edges.
    """

    count: int
    radii: list[float | None]
    panels_per_mould: list[int]
    angles_deg: dict[str, float]
    unrelaxed_angles_deg: dict[str, float]
    reassigned: list[int]
    relaxed: bool
    vertex_move: float


class Clusters(NamedTuple):
    """A sphere mesh of few radii."""

    sphere_mesh: SphereMesh
    labels: FaceLabels
    radii: MouldRadii
    report: MouldsReport


@node(version="4")
def cluster_radii(  # noqa: PLR0913, PLR0917 - a node has an input per choice
    sphere_mesh: SphereMesh,
    k: Annotated[int, Port(min=1)],
    relax: bool = True,  # noqa: FBT001, FBT002 - a toggle on the canvas
    tolerance: Annotated[float, Port(min=0)] = 0.0,
    regularity: Annotated[float, Port(min=0)] = 0.0,
    support: Annotated[float, Port(min=0)] = 0.0,
    same_sagitta: Annotated[float, Port(unit="mm", min=0)] = 0.1,
    units: Units = "m",
    crease: CreaseAngle = 40.0,
) -> Clusters:
    """Give all panels at most k radii.

    Parameters
    ----------
    sphere_mesh : SphereMesh
    k : int
        Number of moulds.
    relax : bool
        Whether vertices may move within the tolerance, so that the panels of given radii meet
        more smoothly.
    tolerance : float
        How far vertices may move, in mean edges; at 0 all stay. Pieces that share no vertex
        are relaxed one by one, each in its own mean edges.
    regularity, support : float
        Weights that keep planes upright and nodes free of torsion while vertices move, as in
        `optimize_spheres`.
    same_sagitta : float
        What the workshop cannot tell apart: moulds whose sagittas over the largest blank
        differ by less are one, and panels that bulge by less are flat.
    units : {"mm", "cm", "m", "in", "ft"}
        Model units.
    crease : float
        Edges at which the flat faces turn by more stay sharp, and count in no mean; 180 for no
        creases.

    Returns
    -------
    sphere_mesh : SphereMesh
        Spheres with the radius of their mould: through the same circles, or relaxed, through
        moved vertices.
    labels : (F,) int array
        Mould of each face, 0 the sharpest.
    radii : (k,) float array
        Radii of the moulds, ascending; infinite for a flat one.
    report : MouldsReport
        The moulds, and the angles with them.

    Examples
    --------
    >>> from spheremesh.nodes import cluster_radii, fit_spheres, minimize_angles, vase_mesh
    >>> moulds = cluster_radii(fit_spheres(vase_mesh(12, 6)), k=3, relax=False)
    >>> moulds.report["panels_per_mould"], moulds.radii.round(2)
    ([24, 24, 24], array([1.24, 1.85, 8.07]))
    """
    clustered, clusters = radius_clustering.cluster_radii(
        sphere_mesh, k, same_sagitta / millimeters_per(units)
    )
    result, move = clustered, 0.0
    is_smooth = ~crease_edges(sphere_mesh.mesh, np.radians(crease))
    before = angle_summary(clustered, is_smooth)
    if relax and tolerance > 0:
        relaxed, run = radius_clustering.relax_moulds(
            clustered, clusters, tolerance, regularity=regularity, support=support,
            edge_weights=is_smooth.astype(np.float64),
        )  # fmt: skip
        if run.vertex_miss > COMMON_VERTEX:
            warn(
                f"vertices are not moved: within {tolerance:g} mean edges they do not reach "
                "the spheres of the moulds; allow more tolerance"
            )
        elif angle_summary(relaxed, is_smooth)["mean"] >= before["mean"]:
            warn("vertices are not moved: neighbours would meet no more smoothly")
        else:
            result, move = relaxed, run.vertex_move
            warn(f"the moulds moved vertices by up to {move:.2g} mean edges off the design")
    reassigned = np.flatnonzero(clusters.reassigned).tolist()
    if reassigned:
        warn(f"{len(reassigned)} faces are too large for their mould and moved to a larger one")
    if len(clusters.radii) < k:
        warn(
            f"{len(clusters.radii)} of {k} moulds: no more can be told apart by "
            f"{same_sagitta:g} mm of sagitta over the largest blank"
        )
    report = MouldsReport(
        count=len(clusters.radii),
        radii=[float(r) if np.isfinite(r) else None for r in clusters.radii],
        panels_per_mould=clusters.counts.tolist(),
        angles_deg=angle_summary(result, is_smooth),
        unrelaxed_angles_deg=before,
        reassigned=reassigned,
        relaxed=result is not clustered,
        vertex_move=move,
    )
    return Clusters(result, clusters.labels, clusters.radii, report)


@dataclass(frozen=True, eq=False)
class BlanksReport(Report):
    """Blanks that the moulds must give, lengths in model units.

    Attributes
    ----------
    blanks : list of dict
        ``mould`` (from 1), ``radius`` (None for a flat mould), ``diameter`` (of the rim, as a
        chord), ``sagitta``, ``opening_deg``, ``count`` and ``shapes`` (different panels among
        them).
    without_mould : int
        Panels that belong to none.
    """

    blanks: list[dict[str, Any]]
    without_mould: int


@node
def mould_blanks(panels: Panels, size_step: Length = 0.0) -> BlanksReport:
    """Count the blanks that every mould must give, and how large they are.

    Parameters
    ----------
    panels : Panels
        The panels, with moulds.
    size_step : float
        Blanks come in diameters that are multiples of this length, in model units; 0 for one
        size per mould, that of its largest panel.

    Returns
    -------
    BlanksReport
        Size and number of the blanks of each mould.

    Examples
    --------
    >>> from spheremesh.nodes import cluster_radii, fit_spheres, mould_blanks, panels, vase_mesh
    >>> moulds = cluster_radii(fit_spheres(vase_mesh(12, 6)), k=2, relax=False)
    >>> made = panels(moulds.sphere_mesh, thickness=0.02, labels=moulds.labels)
    >>> [(row["count"], row["shapes"]) for row in mould_blanks(made.panels)["blanks"]]
    [(48, 4), (24, 2)]
    """
    found = blanks.mould_blanks(panels, congruent.congruent_panels(panels), size_step)
    without = int((panels.labels < 0).sum())
    if without:
        warn(f"{without} of {panels.n_panels} panels belong to no mould and need no blank")
    rows = [
        {
            "mould": int(found.labels[i]) + 1,
            "radius": float(found.radii[i]) if np.isfinite(found.radii[i]) else None,
            "diameter": float(found.diameters[i]),
            "sagitta": float(found.sagittas[i]),
            "opening_deg": float(np.degrees(found.openings[i])),
            "count": int(found.counts[i]),
            "shapes": int(found.shapes[i]),
        }
        for i in range(len(found.labels))
    ]
    return BlanksReport(rows, without)
