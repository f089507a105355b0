"""Landing: what the descent leaves of the conditions, met to rounding."""

from ..meshes.mesh import mean_edge_length
from ..remesh.planar.conditions import must_be_planar
from ..sphere_meshes.sphere_mesh import SphereMesh, vertex_error
from ..support.node_axes import support_structure
from ..tolerances import NODE_LANDED, NODE_ON_SPHERES
from .descent import meet_conditions
from .setting import NetState, Setting, assembled, farthest

NEAR = 0.05
"""Mean edges by which landing may move a vertex."""


def land(setting: Setting, state: NetState) -> tuple[SphereMesh, bool]:
    """Meet all conditions to rounding; also whether that was near.

    If not, the sphere mesh is the one of the state.

    Notes
    -----
    Flat beams are a condition even where the descent did without: `planarize_near`, which does
    not ask for them, leaves neighbours that became one sphere with beams twisted by degrees.
    """
    landed = meet_conditions(setting, state)
    result = assembled(setting, landed)
    if farthest(landed.shifts - state.shifts) <= NEAR and _is_landed(result):
        return result, True
    return assembled(setting, state), False


def _is_landed(sphere_mesh: SphereMesh) -> bool:
    """Whether beams meet to rounding."""
    miss = vertex_error(sphere_mesh).max() / mean_edge_length(sphere_mesh.mesh)
    torsion = support_structure(sphere_mesh).torsion[must_be_planar(sphere_mesh.mesh)]
    return bool(miss <= NODE_ON_SPHERES and torsion.max(initial=0.0) <= NODE_LANDED)
