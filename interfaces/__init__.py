"""Ways in: the command line, notebooks, Grasshopper.

cache_option    Where commands keep results between runs.
cli             The commands; their docstrings are their help.
console         How commands end and what they say meanwhile: errors, exit codes, progress.
hops            The server for Grasshopper.
notebook        What a notebook shows of meshes, panels and beams.
option_values   Values of options that are more than a number or a word.
panel           The main job.
panel_command   The command panel: the main job, option by option.
node_help       The help of a node on the command line.
serve_command   The command serve: nodes and graphs as components of Grasshopper.
studio          The graph on a canvas in the browser, and the process that runs it.
studio_command  The command studio: the canvas in the browser.
sweep_command   The command sweep: a graph for many values of its sliders.
"""
