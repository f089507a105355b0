"""The main job: a mesh in, spherical panels out, as a graph that the user can open again.

graph    The job as a graph.
job      The job run: all of its files, or none.
options  What the job is asked to do.
output   What the command line says of it.
"""

from .graph import panel_graph
from .job import is_panel_job, run_job
from .options import PanelOptions, model_units

__all__ = ["PanelOptions", "is_panel_job", "model_units", "panel_graph", "run_job"]
