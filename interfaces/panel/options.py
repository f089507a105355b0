"""What the main job is asked to do."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from ...fabrication.mesh_files.reader import read_content
from ...kernel.errors import InputError

SupportKind = Literal["axis", "exact", "bisector"]
TableFormat = Literal["xlsx", "csv", "parquet"]
Paper = Literal["A4", "A3", "A2", "A1", "A0"]
PatternKind = Literal["quads", "hexagons", "triangles", "as-is"]


@dataclass(frozen=True)
class PanelOptions:
    """What the main job is asked to do.

    Attributes
    ----------
    mesh : Path or None
        Mesh file; the demo roof if None.
    layer : str
        Layers or groups of the file to use, several with commas.
    repair : bool
        Whether to repair the mesh first.
    edge_length : float or None
        Length of the edges of a pattern, or of faces on surfaces, in model units.
    pattern : {"quads", "hexagons", "triangles", "as-is"}
        Whether the mesh is a surface to be covered by panels of that length, or its faces are
        the panels.
    direction : (float, float, float) or None
        Lines of quads run along it; along those of curvature if None.
    density : float
        From 0 to 1: how much edges of quads are shorter where the surface bends more.
    insist : bool
        Whether quads are made free of torsion even on all but a sphere, or along a direction.
    rows : (int, int) or None
        Rows of faces along u and v of each surface; neither: as `read_mesh` has it.
    units : str or None
        Model units; None for those of the file, and metres if it names none.
    moulds : int or None
        Number of moulds; None for a radius per panel, or as many as bounds ask for.
    max_angle, max_angle_largest : float or None
        The fewest moulds keep the mean and the largest angle between neighbours below, in
        degrees.
    flat_below : float
        Panels that rise by less over their edges are flat, in millimetres.
    prices : Path or None
        Price file.
    ifc : bool
        Whether to write a building model.
    thickness, joint_gap : float
        In model units.
    side : {"inward", "outward", "centred"}
        Where the thickness goes from the spheres.
    offset : {"constant", "power"}
        Whether the thickness is the same everywhere, or the difference of squared radii.
    edges : {"bisector", "intersection"} or None
        How panels are cut without a support; upright by default. With one, its beams say.
    tolerance : float or None
        How far vertices may move, in mean edges; at 0 the faces have to lie on circles, and by
        default they need not.
    target_angle : float
        Angle at which neighbours shall meet, in degrees.
    crease : float
        Edges at which flat faces turn by more, in degrees, stay sharp; 180 for none.
    support : {"axis", "exact", "bisector"} or None
        Which beams to write: on node axes, on exact nodes, or upright; None for none.
    depth, beam_thickness : float or None
        Of the beams, in model units; by default a quarter of the mean edge, and a tenth of the
        depth.
    node_radius : float
        Radius of the node cylinders, in model units; 0 for mitred beams.
    max_height, max_slide : float
        How far vertices may move for an exact support, off the surface and within it, in mean
        edges.
    bearing : float
        Clear distance from panel to beam, in model units.
    allow_step, allow_gap : float
        What the workshop allows between neighbours, in millimetres.
    allow_torsion : float
        What it allows between beams and node axes, in degrees.
    tables : {"xlsx", "csv", "parquet"} or None
        Which tidy tables to write; None for none.
    drawings : {"A4", "A3", "A2", "A1", "A0"} or None
        The paper of a set of drawings; None for none.
    nest : bool
        Whether beams are nested on as few sheets as a short search finds.
    """

    mesh: Path | None = None
    layer: str = ""
    repair: bool = False
    edge_length: float | None = None
    pattern: PatternKind = "as-is"
    direction: tuple[float, float, float] | None = None
    density: float = 0.0
    insist: bool = False
    rows: tuple[int, int] | None = None
    units: str | None = None
    moulds: int | None = None
    max_angle: float | None = None
    max_angle_largest: float | None = None
    flat_below: float = 0.0
    prices: Path | None = None
    ifc: bool = False
    thickness: float = 0.0
    joint_gap: float = 0.0
    side: Literal["inward", "outward", "centred"] = "inward"
    offset: Literal["constant", "power"] = "constant"
    edges: Literal["bisector", "intersection"] | None = None
    tolerance: float | None = None
    target_angle: float = 0.0
    crease: float = 40.0
    support: SupportKind | None = None
    depth: float | None = None
    beam_thickness: float | None = None
    node_radius: float = 0.0
    max_height: float = 0.06
    max_slide: float = 0.7
    bearing: float = 0.0
    allow_step: float = 5.0
    allow_gap: float = 5.0
    allow_torsion: float = 0.1
    tables: TableFormat | None = None
    drawings: Paper | None = None
    nest: bool = False


def model_units(options: PanelOptions) -> tuple[str, bool]:
    """Model units of a job, and whether they are assumed: neither given nor in the file.

    Raises
    ------
    InputError
        If the file cannot be read, or has other units than asked for.
    """
    found = ""
    if options.mesh is not None and options.mesh.suffix.lower() == ".3dm":
        path = options.mesh.resolve()
        found = read_content(path, options.layer, **fineness(options)).units
    if options.units and found not in ("", options.units):
        raise InputError(
            f"{options.mesh} is drawn in {found}, which contradicts --units {options.units}; "
            "leave that out, or change the units in Rhino (Units) and save"
        )
    units = options.units or found
    return units or "m", options.mesh is not None and not units


def fineness(options: PanelOptions) -> dict[str, Any]:
    """How finely surfaces are divided, as inputs of `read_mesh`."""
    if options.edge_length is not None and options.pattern == "as-is":
        return {"edge_length": options.edge_length}
    return dict(zip(("n_u", "n_v"), options.rows or (), strict=False))
