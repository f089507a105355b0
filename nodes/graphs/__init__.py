"""
The framework: typed functions as nodes, and the lazy graph that runs them.

cache    Structural keys, and the results found by them.
errors   What can go wrong with graphs, as types, and how a mistyped name is answered.
file     Graphs as JSON: versioned, in a stable order, and without code.
graph    The lazy graph: nodes wired together, run as far as a target needs.
mermaid  The picture of a graph, as text.
node     Typed functions as nodes: the signature is the ports, the docstring the help.
ports    Ports: what an input or output of a node accepts, and the checks made when it is
         wired.
run      One run of a graph: keys first, then only the steps whose results are not known.
sweep    Many results from one graph: steps mapped over lists, and sliders moved over ranges.
wires    What a graph is made of: sliders, steps, and the wires between them.
wiring   The checks made when a step is added to a graph.
"""
