"""The command ``panel``: a mesh in, spherical panels and their files out."""

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import click

from .cache_option import cache_options, chosen_store
from .console import GATE_FAILED, shown_progress, told_errors
from .option_values import SUPPORTS, joined_option, rows_option, spell_support, vector_option

UNITS: Final = ("mm", "cm", "m", "in", "ft")


class _PanelCommand(click.Command):
    """A command whose option --support may stand without a word."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Give --support its word before the arguments are told apart."""
        return super().parse_args(ctx, spell_support(args))


@click.command(cls=_PanelCommand)
@click.argument("mesh", required=False, type=click.Path(path_type=Path))
@click.option("-o", "--out", required=True, type=click.Path(path_type=Path), help="Folder.")
@click.option("--moulds", type=int, help="Number of mould radii; by default one per panel.")
@click.option(
    "--max-angle",
    metavar="DEG",
    type=click.FloatRange(0, 180),
    help="The fewest moulds with which neighbours meet at no more degrees in the mean.",
)
@click.option(
    "--max-angle-largest",
    metavar="DEG",
    type=click.FloatRange(0, 180),
    help="The fewest moulds with which no neighbours meet at more degrees; both bounds hold if "
    "both are given.",
)
@click.option(
    "--flat-below",
    metavar="MM",
    type=click.FloatRange(min=0),
    default=0.0,
    help="Panels that bulge by less are flat and need no mould, in millimetres.",
)
@click.option("--ifc", is_flag=True, help="Write model.ifc as well, a curtain wall in IFC4.")
@click.option(
    "--prices",
    type=click.Path(path_type=Path),
    help="Price file in TOML; the cost is in the report then.",
)
@click.option("--thickness", type=float, default=0.0, help="Thickness, in model units.")
@click.option("--joint-gap", type=float, default=0.0, help="Joint width, in model units.")
@click.option(
    "--side",
    type=click.Choice(["inward", "outward", "centred"]),
    default="inward",
    help="Where the thickness goes from the spheres, which are those of the moulds.",
)
@click.option(
    "--offset",
    type=click.Choice(["constant", "power"]),
    default="constant",
    help="The same thickness everywhere, or the same difference of squared radii: neighbours "
    "that bulge alike then meet on both faces.",
)
@click.option(
    "--units",
    type=click.Choice(UNITS),
    help="Model units; those of the file by default, and m for files that name none.",
)
@click.option(
    "--layer",
    multiple=True,
    callback=joined_option,
    help="Only this layer (.3dm) or group (OBJ); several with commas or repeated.",
)
@click.option(
    "--repair",
    is_flag=True,
    help="Repair the mesh first: weld, drop slivers and repeated faces, split T-junctions, "
    "unify normals; what was done is in the report.",
)
@click.option(
    "--pattern",
    type=click.Choice(["quads", "hexagons", "triangles", "as-is"]),
    default="as-is",
    help="Cover the MESH, or the surfaces of a .3dm, with a pattern of --edge-length; or take "
    "its faces for the panels, as they are.",
)
@click.option(
    "--edge-length",
    type=click.FloatRange(min=0, min_open=True),
    help="Length of the edges of a --pattern, or on surfaces of a .3dm, in model units.",
)
@click.option(
    "--direction",
    metavar="X,Y,Z",
    callback=vector_option,
    help="Lines of --pattern quads run along this vector, not along those of curvature.",
)
@click.option(
    "--density",
    type=click.FloatRange(0, 1),
    default=0.0,
    help="Edges of --pattern quads are shorter where the surface bends: 0 not at all, 1 as "
    "its radius of curvature, at most 1.6 times.",
)
@click.option(
    "--insist",
    is_flag=True,
    help="Make nodes of --pattern quads free of torsion even on all but a sphere, or along a "
    "direction.",
)
@click.option(
    "--rows",
    metavar="U,V",
    callback=rows_option,
    help="Rows of faces along u and v of each surface of a .3dm; 24,24 by default.",
)
@click.option(
    "--edges",
    type=click.Choice(["bisector", "intersection"]),
    help="Cut panels by planes that bisect the faces, or where the spheres meet; with "
    "--support the beams say where.",
)
@click.option(
    "--tolerance",
    type=click.FloatRange(min=0),
    help="How far vertices may move, in mean edges; 0 insists on circular faces.",
)
@click.option(
    "--target-angle",
    type=click.FloatRange(0, 90),
    default=0.0,
    help="Angle at which neighbours shall meet, in degrees.",
)
@click.option(
    "--crease",
    type=click.FloatRange(0, 180),
    default=40.0,
    show_default=True,
    help="Edges at which flat faces turn by more degrees stay sharp; 180 for none.",
)
@click.option(
    "--support",
    type=click.Choice(SUPPORTS),
    metavar="[axis|exact|bisector]",
    help="Beams under the edges: on node axes, vertices and spheres stay (axis, the default); "
    "on exact nodes, vertices move (exact); upright with node cylinders, for any mesh "
    "(bisector).",
)
@click.option("--depth", type=float, help="Depth of the beams; a quarter of the mean edge.")
@click.option(
    "--beam-thickness", type=float, help="Thickness of the beams; a tenth of the depth."
)
@click.option(
    "--node-radius",
    type=click.FloatRange(min=0),
    default=0.0,
    help="Radius of cylinders at the nodes, before which beams end square; 0 for mitres.",
)
@click.option(
    "--max-height",
    type=click.FloatRange(min=0),
    help="How far vertices may leave the surface for --support exact, in mean edges; 0.06.",
)
@click.option(
    "--max-slide",
    type=click.FloatRange(min=0),
    help="How far vertices may slide in the surface for --support exact, in mean edges; 0.7.",
)
@click.option(
    "--bearing",
    type=click.FloatRange(min=0),
    default=0.0,
    help="Clear distance from panel to beam, in model units; panels rest on beams at 0.",
)
@click.option(
    "--allow-step",
    metavar="MM",
    type=click.FloatRange(min=0),
    default=5.0,
    help="Highest step between neighbours, in millimetres; 5 by default.",
)
@click.option(
    "--allow-gap",
    metavar="MM",
    type=click.FloatRange(min=0),
    default=5.0,
    help="Widest gap in a joint and hole at a node, in millimetres; 5 by default.",
)
@click.option(
    "--allow-torsion",
    metavar="DEG",
    type=click.FloatRange(0, 180),
    default=0.1,
    help="Largest angle between a beam and a node axis, in degrees; 0.1 by default.",
)
@click.option(
    "--tables",
    type=click.Choice(["xlsx", "csv", "parquet"]),
    help="Tidy tables besides: a row a panel, edge, mould, beam, end, hole and node.",
)
@click.option(
    "--drawings",
    type=click.Choice(["A4", "A3", "A2", "A1", "A0"]),
    help="A set of drawings besides, on paper of that size: drawings.pdf and drawings.dxf.",
)
@click.option("--nest", is_flag=True, help="Beams in beams.dxf on as few sheets as found.")
@click.option("--overwrite", is_flag=True, help="Replace files that spheremesh did not write.")
@click.option("--strict", is_flag=True, help="Exit with 5 if the audit finds errors.")
@click.option("--json", "as_json", is_flag=True, help="Print the report alone.")
@cache_options
def panel(  # numpydoc ignore=PR01
    out: Path,
    *,
    overwrite: bool,
    strict: bool,
    as_json: bool,
    cache: Path | None,
    no_cache: bool,
    **options: Any,  # noqa: ANN401
) -> None:
    """Panel a MESH with spheres and write CAD files, schedule and report.

    Reads OBJ, OFF, PLY, STL and .3dm, and others with spheremesh[formats]. Without MESH, a
    demonstration roof is panelled. Files in the folder are replaced only if spheremesh wrote
    them and nobody changed them since.
    """
    from ..fabrication.costs.prices import read_prices
    from .panel import (
        PanelOptions,
        feasible_panel_graph,
        model_units,
        panel_graph,
        run_job,
        say_gain,
    )
    from .panel.output import has_errors, print_report

    if options["rows"] and options["edge_length"]:
        raise click.UsageError("--rows and --edge-length exclude each other; drop one")
    if options["edges"] and options["support"]:
        raise click.UsageError(
            "--edges and --support exclude each other: panels are cut where their beams stand; "
            "drop one"
        )
    has_pattern = options["pattern"] != "as-is"
    if has_pattern and not options["edge_length"]:
        raise click.UsageError(
            f"--pattern {options['pattern']} needs the length of its edges: add --edge-length"
        )
    _check_wishes(options)
    _check_moulds(options)
    _check_exact(options)
    _warn_of_no_beams(options)
    with told_errors(), shown_progress() as progress:
        if options["prices"] is not None:
            read_prices(options["prices"])  # its faults are told before anything is computed
        options["units"], is_assumed = model_units(PanelOptions(**options))
        store = chosen_store(cache, no_cache=no_cache)
        if has_pattern:
            say_gain(panel_graph(PanelOptions(**options)), store)
        graph = feasible_panel_graph(PanelOptions(**options), store)
        report, files = run_job(graph, out, progress, overwrite=overwrite)
    print_report(report, out, files, as_json=as_json, is_assumed=is_assumed)
    if strict and has_errors(report):
        sys.exit(GATE_FAILED)


def _check_wishes(options: Mapping[str, Any]) -> None:
    """Only quads have lines that can be told where to run."""
    given = [f"--{name}" for name in ("direction", "density", "insist") if options[name]]
    if given and options["pattern"] != "quads":
        raise click.UsageError(
            f"{' and '.join(given)} need lines of quads: add --pattern quads, or drop them"
        )


def _check_moulds(options: Mapping[str, Any]) -> None:
    """The number of moulds is given, or found for bounds on angles."""
    bounds = ("max_angle", "max_angle_largest")
    given = [f"--{name.replace('_', '-')}" for name in bounds if options[name] is not None]
    if given and options["moulds"] is not None:
        raise click.UsageError(
            f"--moulds and {' and '.join(given)} exclude each other: the bound says how many "
            "moulds there are; drop one"
        )
    if options["flat_below"] and options["moulds"] == 1:
        raise click.UsageError(
            "--flat-below and --moulds 1 exclude each other: flat panels count as a mould; ask "
            "for 2"
        )


def _check_exact(options: dict[str, Any]) -> None:
    """Options of exact supports go with no other support, and others not with them."""
    given = {name: options.pop(name) for name in ("max_height", "max_slide")}
    asked = {name: value for name, value in given.items() if value is not None}
    if options["support"] != "exact":
        if asked:
            names = ", ".join(f"--{name.replace('_', '-')}" for name in asked)
            raise click.UsageError(f"{names} bounds --support exact; add it, or drop the bound")
        return
    options.update(asked)
    if options["tolerance"] is not None:
        raise click.UsageError(
            "--tolerance does not go with --support exact: bound the moves of vertices by "
            "--max-height and --max-slide"
        )
    if options["target_angle"]:
        raise click.UsageError(
            "--target-angle does not go with --support exact, where neighbours meet as "
            "smoothly as they can; drop one"
        )


def _warn_of_no_beams(options: Mapping[str, Any]) -> None:
    """Options of beams say nothing where no beams are asked for."""
    of_beams = ("depth", "beam_thickness", "node_radius", "bearing", "nest")
    names = [name for name in of_beams if options[name]]
    if names and not options["support"]:
        given = ", ".join(f"--{name.replace('_', '-')}" for name in names)
        click.echo(f"warning: without --support there are no beams: {given} unused", err=True)
