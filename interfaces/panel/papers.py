"""Tables and drawings of the main job that are asked for besides."""

from collections.abc import Mapping

from ...fabrication.schedules.data_dictionary import TABLES
from ...nodes.graphs.graph import Graph
from ...nodes.graphs.specification.wires import Wire
from .options import PanelOptions


def add_papers(
    graph: Graph, options: PanelOptions, made: Mapping[str, Wire], *, has_moulds: bool
) -> None:
    """Add the writers of tidy tables and of a set of drawings, where they are asked for.

    Parameters
    ----------
    graph : Graph
        The main job.
    options : PanelOptions
        Which tables and what paper.
    made : mapping of str to Wire
        The ``panels``, and the ``beams`` if there are any.
    has_moulds : bool
        Whether there are moulds to list.
    """
    if options.tables == "xlsx":
        graph.add("write_tables", "tables", **made, path="tables.xlsx")
    elif options.tables:
        for table in TABLES:
            parts = "panels" if table in {"panels", "panel_edges", "moulds"} else "beams"
            if parts in made and (table != "moulds" or has_moulds):
                graph.add(
                    "write_tables", f"table_{table}", **{parts: made[parts]},
                    path=f"tables_{table}.{options.tables}",
                )  # fmt: skip
    if options.drawings:
        for suffix in ("pdf", "dxf"):
            graph.add(
                "write_drawings", f"drawing_set_{suffix}", **made, paper=options.drawings,
                project=graph.title, path=f"drawings.{suffix}",
            )  # fmt: skip
