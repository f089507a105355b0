"""Ways in: the command line.

cli            The commands; their docstrings are their help.
option_values  Values of options that are more than a number or a word.
node_help      The help of a node on the command line.
panel_graph    The main job as a graph that the user can open again.
panel_job      The main job run, all of its files or none.
panel_options  What the main job is asked to do.
panel_output   What the command line says of a panelling.
support_graph  The beams of the main job: which annuli, and what is made of them.
"""
