"""Landing: what the descent leaves of the conditions, met to rounding."""

from ..meshes.mesh import mean_edge_length
from ..remesh.planar.conditions import must_be_planar
from ..remesh.planar.landing import planarize_near
from ..sphere_meshes.sphere_mesh import SphereMesh, vertex_error
from ..support.node_axes import support_structure
from ..tolerances import NODE_LANDED, NODE_ON_SPHERES
from .descent import meet_conditions
from .setting import NetState, Setting, assembled, farthest

NEAR = 0.05
"""Mean edges by which landing may move a vertex."""


def land(setting: Setting, state: NetState) -> tuple[SphereMesh, bool]:
    """Meet the conditions to rounding; also whether that was near.

    If not, the sphere mesh is the one of the state.

    Notes
    -----
    Spheres with radii of their own whose beams need not be flat are planarised: that turns
    neighbours apart which became one sphere, so that they tell the plane of their beam.
    """
    near = assembled(setting, state)
    if not (setting.has_one_radius or setting.is_flat):
        landing, is_near = planarize_near(near, NEAR)
        return (landing.sphere_mesh, True) if is_near else (near, False)
    landed = meet_conditions(setting, state)
    result = assembled(setting, landed)
    if farthest(landed.shifts - state.shifts) <= NEAR and _is_landed(result):
        return result, True
    return near, False


def _is_landed(sphere_mesh: SphereMesh) -> bool:
    """Whether beams meet to rounding."""
    miss = vertex_error(sphere_mesh).max() / mean_edge_length(sphere_mesh.mesh)
    torsion = support_structure(sphere_mesh).torsion[must_be_planar(sphere_mesh.mesh)]
    return bool(miss <= NODE_ON_SPHERES and torsion.max(initial=0.0) <= NODE_LANDED)
