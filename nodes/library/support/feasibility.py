"""Whether a mesh can have beams on node axes."""

from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ....kernel.support import feasibility
from ...graphs.node import node


@node
def support_feasibility(sphere_mesh: SphereMesh) -> feasibility.FeasibilityReport:
    """Judge whether beams on node axes can stand, before anything is optimised.

    Parameters
    ----------
    sphere_mesh : SphereMesh

    Returns
    -------
    FeasibilityReport
        The verdict ("feasible", "doubtful" or "no"), the tilt that decides it, and the reason.

    Examples
    --------
    >>> from spheremesh.nodes import fit_spheres, support_feasibility, vase_mesh
    >>> support_feasibility(fit_spheres(vase_mesh(12, 6)))["verdict"]
    'feasible'
    """
    return feasibility.judge_support(sphere_mesh)
