"""Ways in: the command line.

cli            The commands; their docstrings are their help.
option_values  Values of options that are more than a number or a word.
panel          The main job.
node_help      The help of a node on the command line.
"""
