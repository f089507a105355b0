"""Ways in: the command line.

cli    The commands; their docstrings are their help.
panel  The main job as a graph that the user can open again.
"""
