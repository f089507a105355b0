"""Ways in: the command line.

cli            The commands; their docstrings are their help.
option_values  Values of options that are more than a number or a word.
node_help      The help of a node on the command line.
panel          The main job as a graph that the user can open again.
"""
