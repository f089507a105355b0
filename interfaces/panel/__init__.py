"""The main job: a mesh in, spherical panels out, as a graph that the user can open again.

graph    The job as a graph.
job      The job run: all of its files, or none.
options  What the job is asked to do.
output   What the command line says of it.
papers   Tables and drawings that are asked for besides.
pattern  From a design surface to the net that is panelled.
support  The beams of the job: which annuli, and what is made of them.
verdict  Whether the model can be built; if not, why not, and what would do.
"""

from .graph import feasible_panel_graph, panel_graph
from .job import is_panel_job, run_job, said_to
from .options import PanelOptions, model_units
from .pattern import say_gain

__all__ = [
    "PanelOptions",
    "feasible_panel_graph",
    "is_panel_job",
    "model_units",
    "panel_graph",
    "run_job",
    "said_to",
    "say_gain",
]
