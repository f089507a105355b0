"""The framework: typed functions as nodes, and the lazy graph that runs them.

annotations  How types are read: alternatives, elements, what arrays hold, and their names.
cache        Structural keys, and the results found by them.
encoding     What steps are given, as JSON: values, wires, sliders, lists to map over.
errors       What can go wrong with graphs, as types, and how a mistyped name is answered.
file         Graphs as JSON: versioned, in a stable order, and without code.
files        The files of a run: where paths lead, and that nothing read is written over.
graph        The lazy graph: nodes wired together, run as far as a target needs.
kinds        The table of types: which values an input takes, and which wires.
mermaid      The picture of a graph, as text.
node         Typed functions as nodes: the signature is the ports, the docstring the help.
ports        Facts of inputs and outputs, and the checks of what inputs are given.
results      Results that nobody can change for others.
run          One run of a graph: keys first, then only the steps whose results are not known.
sweep        Many results from one graph: steps mapped over lists, sliders over ranges.
wires        Sliders, steps, the wires between them, and the checks when they are wired.
"""
