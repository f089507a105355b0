"""What a graph is made of, as records that nobody changes, and as a file.

connections  The checks of what is wired: both ends are named, and what would fit.
encoding     What steps are given, as JSON: values, wires, sliders, lists to map over.
file         Graphs as JSON: versioned, in a stable order, and without code.
mermaid      The picture of a graph, as text.
wires        Sliders, steps, the wires between them, lists to map over.
"""
