"""Semi-regular patterns of triangles, squares, hexagons and octagons."""

from typing import NamedTuple

from ....kernel.meshes.mesh import Mesh
from ....kernel.patterns import semiregular as patterns
from ....kernel.patterns.expected_angles import mixed_angles, smoothest
from ....kernel.patterns.gain_report import turn_p95
from ....kernel.patterns.panel_scale import at_panel_scale
from ....kernel.patterns.semiregular import SemiregularKind
from ....kernel.sphere_meshes.sphere_mesh import SphereMesh
from ....kernel.surfaces.surface import Surface
from ...graphs.node import node
from .reports import (
    EdgeLength,
    Expected,
    Outcome,
    PatternReport,
    flaw_reason,
    mesh_of,
    neighbor_distance,
    pattern_report,
)


class SemiregularPattern(NamedTuple):
    """A semi-regular pattern on a surface, and what it is good for."""

    sphere_mesh: SphereMesh
    report: PatternReport


@node
def semiregular_pattern(
    mesh: Mesh | Surface, edge_length: EdgeLength, kind: SemiregularKind = "3.6.3.6"
) -> SemiregularPattern:
    """Cover a surface with two or three kinds of faces, and spheres that meet smoothly.

    Cells end at the boundary, so that the whole surface is covered. Nodes have torsion: beams
    stand upright before node cylinders (`bisector_support`).

    Parameters
    ----------
    mesh : Mesh or Surface
        A dense mesh of any faces, or a surface as `read_surface` gives it.
    edge_length : float
        Length of the edges, in model units.
    kind : {"3.6.3.6", "3.4.6.4", "4.8.8"}
        Degrees of the faces around a vertex: triangles and hexagons; triangles, squares and
        hexagons; squares and octagons along the lines of curvature.

    Returns
    -------
    sphere_mesh : SphereMesh
        Faces with their vertices on the surface.
    report : PatternReport
        Angles against planes and against what curvatures foretell, deviation, and flaws.

    Examples
    --------
    >>> from spheremesh.nodes import ellipsoid_mesh, semiregular_pattern
    >>> report = semiregular_pattern(ellipsoid_mesh(24, 12), 0.3).report
    >>> report["status"], report["gain"]["measured"] > 0.4
    ('usable', True)
    """
    net, judgement = patterns.semiregular_pattern(mesh, edge_length, kind)
    found = at_panel_scale(mesh, edge_length).curvatures
    distance, first, second = neighbor_distance(net.mesh), found.first, found.second
    expected = Expected(
        found.mean(mixed_angles(first, second, distance, 0.0)),
        found.mean(mixed_angles(first, second, distance, smoothest(first, second))),
        turn_p95(found, edge_length),
    )
    outcome = Outcome("usable" if judgement.is_usable else "flawed", flaw_reason(judgement), [])
    report = pattern_report(mesh_of(mesh), edge_length, net, judgement, expected, outcome)
    return SemiregularPattern(net, report)
