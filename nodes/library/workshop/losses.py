"""What moulds and a support cost, and what became of the support, said in warnings."""

from collections.abc import Mapping

from ....kernel.arrays import norm
from ....kernel.meshes.mesh import Mesh, face_vector_areas
from ....kernel.support.annulus_construction import AnnuliReport
from ....kernel.support.beam_supports import SupportReport
from ....kernel.support.feasibility import FeasibilityReport
from ....kernel.tolerances import DOWNWARD, ROUGHER, WIDER_GAP
from ...graphs.node import warn
from ..fabricate import CutReport


def warn_of_losses(
    angles: Mapping[str, Mapping[str, float]],
    cut: CutReport,
    plain: CutReport | None,
    annuli: AnnuliReport | None,
    asked: str | None,
) -> None:
    """Say where flat panels, or panels without moulds and support, would be better.

    Parameters
    ----------
    angles : mapping
        Of planes and of spheres, as in the report.
    cut, plain : CutReport
        Panels as they are built, and as they would be without moulds and support, if these
        were asked for.
    annuli : AnnuliReport or None
        Of the support, if there is one.
    asked : str or None
        The kind of support that was asked for.
    """
    spherical, planar = angles["spherical"]["mean"], angles["planar"]["mean"]
    if spherical > planar * (1 + ROUGHER):
        warn(
            f"rougher than flat panels: neighbours meet at {spherical:.3g} degrees in the "
            f"mean, flat ones at {planar:.3g}; more moulds, or none, may be smoother"
        )
    if plain is None:
        return
    # Beams of another kind would only help where these stand on node axes.
    is_axis = asked == "axis" and isinstance(annuli, SupportReport) and annuli.kind == "axis"
    if cut["written"] < plain["written"]:
        instead = ", or --support bisector," if is_axis else ""
        warn(
            f"{cut['written']} panels instead of {plain['written']} without moulds and "
            f"support: more moulds{instead} may keep them"
        )
    wide, usual = cut["edge_gap"]["relative_to_edge"], plain["edge_gap"]["relative_to_edge"]
    if wide > usual + WIDER_GAP:
        instead = ", or --support exact," if is_axis else ""
        warn(
            f"gaps between edges are up to {100 * wide:.2g} % of an edge, and without moulds "
            f"and support {100 * usual:.2g} %: more moulds{instead} may close them"
        )


def warn_of_support(
    annuli: SupportReport, feasibility: FeasibilityReport | None, asked: str | None
) -> None:
    """Say what became of beams on node axes where they were asked for and are not good.

    Parameters
    ----------
    annuli : SupportReport
        What was made.
    feasibility : FeasibilityReport or None
        Whether beams on node axes can stand.
    asked : str or None
        The kind of support that was asked for.
    """
    if feasibility is None or asked != "axis" or feasibility.verdict == "feasible":
        return
    instead = (
        "upright beams with node cylinders instead (--support bisector); for axes in common "
        "remesh to quadrilaterals or hexagons"
        if annuli.kind == "bisector"
        else "remesh, or take upright beams (--support bisector)"
    )
    warn(f"support {feasibility.verdict}: {feasibility.reason}: {instead}")


def warn_of_side(mesh: Mesh) -> None:
    """Say that beams stand on top of panels where the normals of a roof point down.

    Parameters
    ----------
    mesh : Mesh
        What panels are cut from.
    """
    vectors = face_vector_areas(mesh)
    if vectors[:, 2].sum() < -DOWNWARD * norm(vectors).sum():
        warn(
            "the normals of the mesh point down, and beams lie on the side against them: here "
            "on top of the panels; turn the faces over to have beams below"
        )
